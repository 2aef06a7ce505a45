"""Integrals and extremes along each rod, in units of A and rho, with their errors, (B,) each.

They are computed on the panels of the orbit where the method knows it. Elsewhere they are computed on polynomials
between the stations, and the error is the change when every other station is left out; it is NaN where the stations
do not resolve every bend or do not cover the whole rod.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..core.measures import LONGEST, measure
from ..mechanics.potential import steepest
from ..numerics.arrays import EPS, Array
from ..numerics.chebyshev import means, primitive, series_at
from ..orbit.marched_orbit import MarchedOrbit
from ..problem.errors import InputError
from ..problem.reduced import flat
from ..shape import Shape
from ..shooting.loaded_rod import ALPHA, SHORT, SPEED
from . import densities
from .peaks import first_peak
from .quadrature import Resolved, resolve
from .rod_pieces import Pieces
from .solution_pieces import blocks, is_resolved, off_between, pieces_of

_FINEST = 1e-14  # relative: smallest goal of a series
SPREAD = 10  # times the error of a marched orbit, which is a standard deviation: a bound in every test
_SHARE = 1e-3  # of the tolerance, for the series of the densities
_SAFETY = 2.0
BARELY = 64 * EPS  # of the size of its terms: a push below this is rounding

Pair = tuple[Any, Any]  # values and errors, (B,) each


@dataclass(frozen=True)
class Group:
    """The numbers that are computed from one density.

    measured: takes pieces, the sign of push (B,), the error of beta (B,) and a relative goal, and returns name ->
    values and errors (B,) in units of A and rho.
    """

    names: tuple[str, ...]
    measured: Callable[[Pieces, Array, Array, float], dict[str, Pair]]


def _angles(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    if not pieces.monotone:
        beta = resolve(pieces, densities.angle, np.inf)
        return {"low": (beta.smallest(), error), "high": (beta.largest(), error)}
    ends = pieces.at(np.array([-1.0, 1.0]))[0]
    low, high = (np.full(pieces.problem.size, side * np.inf) for side in (1, -1))
    np.fmin.at(low, pieces.case, ends.min(axis=1))
    np.fmax.at(high, pieces.case, ends.max(axis=1))
    return {"low": (low, error), "high": (high, error)}


def _curvatures(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    kappa = resolve(pieces, densities.curvature, goal)
    doubt = _doubt(kappa, error)
    return {
        "curvature": (kappa.integral, kappa.left_out + kappa.integral_of(doubt)),
        "tightest": (kappa.largest(), _worst(kappa, doubt)),
    }


def _energy(density: Callable[..., densities.Density], name: str) -> Group:
    def energy(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
        found = resolve(pieces, density, goal, extremes=False)
        return {name: (found.integral, found.left_out + found.integral_of(_doubt(found, error)))}

    return Group((name,), energy)


def _resolve_push(pieces: Pieces, sign: Array, error: Array, goal: float) -> tuple[Resolved, Array]:
    """The push, and the error of its values at the nodes, (Q, m)."""
    push = resolve(pieces, lambda some: densities.push(some, sign), goal, signs=True)
    return push, _doubt(push, error) + 2 * push.tail[:, None] + BARELY * push.size


def _pushes(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    push, doubt = _resolve_push(pieces, sign, error, goal)
    wrong, worst = push.integral_of(doubt), _worst(push, doubt)
    pushed, pulled, share, unsure = _part(push, doubt)
    return {
        "pushed": (pushed, wrong),
        "pulled": (pulled, wrong),
        "share": (share, unsure),
        "least": (push.smallest(), worst),
        "most": (push.largest(), worst),
    }


def _pushes_alone(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    push, doubt = _resolve_push(pieces, sign, error, goal)
    return {"push": (_part(push, doubt)[0], push.integral_of(doubt))}


def _lift_offs(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    """The least t at which the cylinder would have to pull by more than rounding; the whole length where it nowhere
    has to. Its error: how far that t moves where the push is less or more by its doubt."""
    push, doubt = _resolve_push(pieces, sign, error, goal)
    span = pieces.problem.span
    below = (push.less(of).first_below() for of in (-BARELY * push.size, doubt, -doubt))
    first, early, late = (np.minimum(one, span) for one in below)
    return {"lifts": (first, np.maximum(late - first, first - early) + 8 * EPS * span)}


def _peaks(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    """The least t at which the push is largest."""
    push, doubt = _resolve_push(pieces, sign, error, goal)
    same = push.most(BARELY * push.size.max(axis=1) + 4 * push.tail)
    return {"peak": first_peak(push, _worst(push, doubt), same)}


def _directions(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    found = {}
    for name, density in (("turned", densities.across), ("risen", densities.along)):
        one = resolve(pieces, density, goal, extremes=False)
        found[name] = one.integral, one.left_out + one.integral_of(_doubt(one, error))
    return found


def _tensions(pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    tension = resolve(pieces, densities.tension, goal)
    worst = _worst(tension, _doubt(tension, error))
    return {"tension": (np.maximum(np.abs(tension.largest()), np.abs(tension.smallest())), worst)}


def _part(push: Resolved, doubt: Array) -> tuple[Array, Array, Array, Array]:
    """Integrals of push alone and of pull alone, the length on which the cylinder pushes, and its error, (B,) each."""
    beyond = push.less(BARELY * push.size)
    q, x, sign = beyond.crossings()
    first, Q = beyond.values[:, 0] > 0, push.values.shape[0]
    whole, mine = push.coefficients @ means(push.values.shape[1]), primitive(push.coefficients)[q]
    left = series_at(mine, np.ones(q.size)) - series_at(mine, x)
    area = np.where(first, whole, 0) + np.bincount(q, weights=sign * left, minlength=Q) / 2
    share = np.where(first, 1.0, 0) + np.bincount(q, weights=sign * (1 - x), minlength=Q) / 2
    # an uncertain push has uncertain zeros, or may vanish on the whole piece
    moved = doubt.max(axis=1)[q] / np.abs(beyond.rate_at(q, x))
    moved = np.bincount(q, weights=np.where(moved < 1, moved, 1), minlength=Q)
    faint = ((np.abs(push.values) < doubt) & (push.values != 0)).mean(axis=1)
    unsure = np.minimum(np.maximum(moved, faint), 1) + EPS
    return push.over(area), push.over(area - whole), push.over(np.clip(share, 0, 1)), push.over(unsure)


def _doubt(found: Resolved, error: Array) -> Array:
    """The error of the values at the nodes, (Q, m), by the error of beta (B,)."""
    return found.spread * (_SAFETY * error[found.pieces.case, None])


def _worst(found: Resolved, doubt: Array) -> Array:
    return found.most(doubt.max(axis=1) + 2 * found.tail + EPS * found.size.max(axis=1))


PEAK = Group(("peak",), _peaks)
GROUPS = (
    Group(("low", "high"), _angles),
    Group(("curvature", "tightest"), _curvatures),
    _energy(densities.bending, "bending"),
    _energy(densities.potential, "potential"),
    Group(("pushed", "pulled", "share", "least", "most"), _pushes),
    Group(("push",), _pushes_alone),
    Group(("lifts",), _lift_offs),
    Group(("tension",), _tensions),
    Group(("turned", "risen"), _directions),
    PEAK,
)
MIDDLE = (1 / 3, 2 / 3)  # the middle third of the length


def _of_groups(groups: list[Group], pieces: Pieces, sign: Array, error: Array, goal: float) -> dict[str, Pair]:
    """The numbers of some groups, (B,) each; by the core, but of longer series than it takes, and of varying loads."""
    if pieces.varying is not None or pieces.series.shape[2] > LONGEST:
        return reference_groups(groups, pieces, sign, error, goal)
    found = measure(pieces, {"sign": sign, "error": error}, [GROUPS.index(group) for group in groups], goal)
    return {name: found[name] for group in groups for name in group.names}


def reference_groups(groups: list[Group], pieces: Pieces, *given: Any) -> dict[str, Pair]:
    """The same in NumPy."""
    found: dict[str, Pair] = {}
    with np.errstate(all="ignore"):  # replacement rods of refused cases, and numbers next to the range of a float
        for group in groups:
            found |= group.measured(pieces, *given)
    return found


class Reading:
    """A solution and the numbers measured on it; each density is computed once for all observables."""

    def __init__(self, sol: Shape) -> None:
        self.sol = sol
        self._known: dict[str, Pair] = {}
        self._middle: dict[str, Pair] = {}

    def measure(self, wanted: Iterable[str]) -> None:
        """Compute every group that contains one of the names, on the same pieces."""
        missing = {name for name in wanted if name not in self._known}
        if groups := [group for group in GROUPS if missing & set(group.names)]:
            self._known.update(self._measure(groups))

    def middle(self, name: str) -> Pair:
        """An integral in t over the middle third of the length, and its error, (B,) each."""
        if name not in self._middle:
            groups = [group for group in GROUPS if name in group.names]
            low, high = (self._measure(groups, until) for until in MIDDLE)
            for key in low:
                self._middle[key] = high[key][0] - low[key][0], high[key][1] + low[key][1]
        return self._middle[name]

    def over(self, name: str, until: float) -> Pair:
        """A number measured over the first share `until` of the length, and its error, (B,) each."""
        return self._measure([group for group in GROUPS if name in group.names], until)[name]

    def _measure(self, groups: list[Group], until: float = 1.0) -> dict[str, Pair]:
        """The numbers of some groups over the first share `until` of the length."""
        sol = self.sol
        sign = flat(sol.case.outward, sol.case.shape)
        error = np.where(np.isfinite(sol.trajectory.error), sol.trajectory.error, 1.0)
        error = np.maximum(error, 4 * EPS) * (SPREAD if isinstance(sol.trajectory.orbit, MarchedOrbit) else 1)
        goal = max(_SHARE * sol.tol, _FINEST)
        names = [name for group in groups for name in group.names]
        found = {name: (np.full(sol.problem.size, np.nan), np.full(sol.problem.size, np.nan)) for name in names}
        for some in blocks(sol):
            pieces = pieces_of(sol, some, until)
            measured = _of_groups(groups, pieces, sign[some], error[some], goal)
            if sol.trajectory.orbit is None and sol.trajectory.shapes is None:
                if PEAK in groups:  # at each bend the maximum is off by another amount
                    wide = error[some] + off_between(sol, some)
                    measured |= _of_groups([PEAK], pieces_of(sol, some, until), sign[some], wide, goal)
                fewer = pieces_of(sol, some, until, 2)
                coarse = _of_groups(groups, fewer, sign[some], error[some], goal)
                dense, shapeless = is_resolved(sol)[some], np.zeros(coarse[names[0]][0].size, dtype=bool)
                shapeless[pieces.case[np.isnan(pieces.series[pieces.row]).any(axis=(1, 2))]] = True
                for name, (value, doubt) in measured.items():
                    with np.errstate(invalid="ignore"):  # of a case without a shape
                        doubt = np.where(dense, doubt + np.abs(value - coarse[name][0]), np.nan)
                        measured[name] = np.where(shapeless, np.nan, value), doubt
            for name, pair in measured.items():
                for whole, part in zip(found[name], pair, strict=True):
                    whole[some] = part
        return found

    def know(self, name: str, values: Array, errors: Array) -> None:
        """Take a number that is known already, and its error, (B,) each, in place of what would be measured."""
        self._known[name] = values, errors

    def get(self, name: str) -> Pair:
        """A number measured along the rod and its error, (B,) each."""
        self.measure([name])
        return self._known[name]

    def value(self, name: str) -> Array:
        """A number measured along the rod, (B,)."""
        found: Array = self.get(name)[0]
        return found

    def error_of(self, name: str) -> Array:
        """Its error, (B,)."""
        found: Array = self.get(name)[1]
        return found

    def scale(self, name: str, factor: Array) -> Pair:
        """A number and its error in other units, (B,) each."""
        value, error = self.get(name)
        with np.errstate(over="ignore", invalid="ignore"):
            return value * factor, error * factor

    def each(self, values: Any) -> Any:
        """Values (B,) in the shape of the cases."""
        return self.sol._each(values)

    @cached_property
    def error(self) -> Array:
        """Estimated error of beta, and of alpha and z over max(1, L/rho), (B,)."""
        return np.asarray(self.sol.trajectory.error)

    @cached_property
    def rho(self) -> Array:
        return flat(self.sol.case.rho, self.sol.case.shape)

    @cached_property
    def A(self) -> Array:
        return flat(self.sol.case.rod.bending_stiffness, self.sol.case.shape)

    @cached_property
    def E(self) -> Array:
        """Young's modulus, (B,). Raises `InputError` for a rod that has none."""
        if self.sol.case.rod.E is None:
            raise InputError("bending_stress_max is E a kappa_max, and a rod with EI and GJ has no E; omit it")
        return flat(self.sol.case.rod.E, self.sol.case.shape)

    @cached_property
    def a(self) -> Array:
        return flat(self.sol.case.rod.a, self.sol.case.shape)

    @cached_property
    def ratio(self) -> Array:
        """A/C, (B,)."""
        return flat(self.sol.case.rod.stiffness_ratio, self.sol.case.shape)

    @property
    def mu(self) -> Array:
        """M3 rho/A, (B,)."""
        return self.sol.problem.mu

    @cached_property
    def gain(self) -> tuple[Array, Array]:
        """alpha(L) - alpha(0) [rad] and z(L)/rho, (B,)."""
        shape = self.sol.trajectory
        if shape.shapes is not None:
            first, last = shape.shapes.ends()
            return last[:, ALPHA] - first[:, ALPHA], self.sol.problem.span - last[:, SHORT]
        if shape.orbit is None or (self.sol.t[:, -1] == self.sol.problem.span).all():
            return shape.alpha[:, -1], shape.z[:, -1]
        _, _, alpha, z = shape.orbit.at(shape.orbit.problem.span[:, None])
        return alpha[:, 0], z[:, 0]

    @cached_property
    def loads(self) -> tuple[Any, Any, Any]:
        """FZ [force], MZ and M3 [force length], under which the rod is in equilibrium, (B,)."""
        FZ, MZ, M3 = (flat(load, self.sol.case.shape) for load in self.sol.loads)
        return FZ, MZ, M3

    @cached_property
    def end_rates(self) -> tuple[Any, Any]:
        """beta_t at the start and at the far end, (B,); NaN where the method knows no orbit and no station is there."""
        sol, orbit = self.sol, self.sol.trajectory.orbit
        if sol.trajectory.shapes is not None:
            first, last = sol.trajectory.shapes.ends()
            return first[:, SPEED], last[:, SPEED]
        found = []
        for k, t in ((0, np.zeros_like(sol.problem.span)), (-1, sol.problem.span)):
            if (sol.t[:, k] == t).all():
                found.append(sol.trajectory.dbeta[:, k])
            else:
                found.append(np.full(t.size, np.nan) if orbit is None else orbit.at(t[:, None])[1][:, 0])
        return found[0], found[1]

    @property
    def steepness(self) -> Array:
        """The largest change of beta_t by a unit of beta, about, (B,)."""
        return np.sqrt(np.asarray(steepest(self.sol.problem)))

    @cached_property
    def length(self) -> Array:
        """Length of the rod in t, (B,); where no orbit is known, the length between the first and the last station."""
        t = self.sol.t
        known = self.sol.trajectory.orbit is not None or self.sol.trajectory.shapes is not None
        if known or t.shape[1] < 2:
            return self.sol.problem.span
        return t[:, -1] - t[:, 0]
