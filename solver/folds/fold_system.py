"""The equations of fold and pitchfork curves in the plane of two fields, and their roots by Newton's rule.

B(v; p) = beta(L) - beta(L) given, of the rod that starts with v = beta_t(0): its zeros are the equilibria. At a fold
its derivative E = dB/dv, the Jacobi field at the far end, vanishes too, and at a cusp d^2B/dv^2. B is smooth wherever
an end of the rod passes a turning point, where the length T(h) of a path is not: there one path changes into another
of one turn more or less. So a curve is traced in one set of unknowns (v, p1, p2), without charts. B is known to
rounding, so its derivatives are taken from a polynomial through seven values of v.

Where the problem has a symmetry, two equilibria split off a third in a pitchfork: B, E and d^2B/dv^2 vanish together on
a curve. A fourth unknown e, a change of the given beta(L), makes this system regular (B = e); on the curve e = 0.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..levels.line_point import LinePoint
from ..levels.transit_times import fall
from ..mechanics.potential import load_size
from ..numerics.arclength import FOLD, PITCHFORK
from ..numerics.arrays import Array
from ..numerics.chebyshev import polynomial_rates
from ..numerics.roots import null_vector, root
from ..orbit.periodic_orbit import TIGHT, solve_orbit
from ..problem.reduced import EndsProblem
from .parameter_plane import MARGIN, ParameterPlane

_SHARE = 0.015  # of the distance over which B changes its form: the step of the values of v
_NUDGE = 1e-5  # of the ranges: the step of the derivatives by the fields
DEEP = 3e-4  # of the gap between the level and a saddle
_OFFSETS = np.arange(-3, 4)
_WEIGHTS = polynomial_rates(_OFFSETS, 4)[1:]  # d/dv, d^2/dv^2, d^3/dv^3 from seven values, of order 6, 6 and 4
_ROUGH = _WEIGHTS[0] - np.pad(polynomial_rates(_OFFSETS[1:-1], 2)[1], 1)  # dB/dv of order 6 less that of order 4
_SMOOTH, _REDUCTIONS = 1e-6, 8  # of the change of B: how large that may be; how often the reach is reduced


@dataclass(frozen=True, eq=False)
class Expansion:
    """B at one point (v, p): its derivatives by v of order 0 to 3, (4,), and of these by the two shares, (2, 4)."""

    along: Array
    across: Array


def expansion(plane: ParameterPlane, v: float, shares: Array, reach: float) -> Expansion:
    """B about one point. reach: a distance in v over which B changes its form; it is reduced where B shows a smaller
    one, as where the rod nears a place at which beta almost rests."""
    nudges = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]]) * _NUDGE
    problems = plane.problems(np.repeat(shares + nudges, _OFFSETS.size, axis=0))
    step, off = _values(problems, v, reach)
    for _ in range(_REDUCTIONS):
        if abs(_ROUGH @ off[0]) <= _SMOOTH * np.abs(off[0] - off[0, 3]).max():
            break
        reach /= 4
        step, off = _values(problems, v, reach)
    rates = np.concatenate([off[:, 3:4], off @ (_WEIGHTS / step ** np.arange(1, 4)[:, None]).T], axis=1)
    return Expansion(rates[0], (rates[1::2] - rates[2::2]) / (2 * _NUDGE))


def _values(problems: EndsProblem, v: float, reach: float) -> tuple[float, Array]:
    """The step of v, and B at its values in rows of problems, (rows, 7)."""
    step = _SHARE * reach
    slopes = np.tile(v + step * _OFFSETS, problems.size // _OFFSETS.size)
    return step, misses(problems, slopes).reshape(-1, _OFFSETS.size)


def misses(problem: EndsProblem, slopes: Array) -> Array:
    """beta(L) of rods that start with beta_t(0) = slopes (N,), less the beta(L) given, (N,)."""
    orbit = solve_orbit(problem.with_start(slopes), TIGHT)
    return np.asarray(orbit.at(problem.span[:, None])[0][:, 0] - problem.betaL)


def reach_of(plane: ParameterPlane, v: float, shares: Array) -> float:
    """The distance in v over which B changes its form: to a separatrix, or a radian of the far end's phase."""
    problem = plane.problems(shares)
    place = LinePoint(problem)
    speed2 = v * v
    size = float(np.sqrt(load_size(problem)[0] + 1))
    reach = 3 * max(abs(v), 0.3 * size) / (size * max(float(problem.span[0]), 1.0))
    for saddle in place.saddles:
        gap = abs(speed2 - fall(problem, float(saddle), place.start, True))
        reach = min(reach, float(np.sqrt(speed2 + gap)) - abs(v))
    return max(reach, 1e-12)


def is_deep(plane: ParameterPlane, v: float, shares: Array) -> bool:
    """Whether an end lies at a turning point next to a separatrix, so that v tells little."""
    place = LinePoint(plane.problems(shares))
    near = min(v * v, abs(v * v + place.fall(place.start, place.end))) < 1e-4
    return near and any(abs(v * v - place.fall(float(s), place.start)) < DEEP for s in place.saddles)


def turns_at(plane: ParameterPlane, v: float, shares: Array) -> int:
    """The turning points that the rod passes."""
    return int(solve_orbit(plane.problems(shares).with_start(np.array([v])), TIGHT).turns[0])


_LONGEST = 0.5  # change of an unknown in a step of Newton's rule
_UNFOLDED = 1e-8  # rad: the largest change of beta(L) at which a point counts as a pitchfork
_STRAYS = 1e-4  # of that change along the curve, in units of its length


@dataclass(frozen=True, eq=False)
class CurvePoint:
    """A point of a curve.

    x: (v / scale, u, w), u and w the shares of the two fields; of a pitchfork curve with the change e of beta(L) as a
    fourth. tangent: of the same size, of length 1. bend: d^2B/dv^2 at a fold, d^3B/dv^3 at a pitchfork. more: (2,),
    towards the side, in the plane of shares, where two more equilibria exist.
    """

    x: Array
    tangent: Array
    bend: float
    more: Array

    @property
    def shares(self) -> Array:
        return self.x[1:3]


class CurveSystem(Protocol):
    """The equations of one curve in a plane of fields, FOLD or PITCHFORK; scale: unit of beta_t(0)."""

    @property
    def plane(self) -> ParameterPlane: ...

    @property
    def kind(self) -> str: ...

    @property
    def scale(self) -> float: ...

    @property
    def size(self) -> int:
        """The number of unknowns."""
        ...

    def equations(self, x: Array) -> tuple[Array, Array, float, Array]:
        """Values, derivatives, `bend` and `more` (as of `CurvePoint`) at x."""
        ...

    def leaves(self, x: Array) -> bool:
        """Whether other equations suit the curve better from x on."""
        ...

    def start_rate(self, x: Array) -> float:
        """beta_t(0) at x."""
        ...


def correct_curve_point(system: CurveSystem, x: Array, row: Array, value: float) -> CurvePoint | None:
    """The point of the curve near x at which row . x = value; None where Newton's rule does not converge."""
    last: list[tuple[Array, Array, float, Array]] = []

    def equations(x: Array) -> tuple[Array, Array] | None:
        if not _is_inside(x):
            return None
        last[:] = [system.equations(x)]
        return np.append(last[0][0], row @ x - value), np.vstack([last[0][1], row])

    found = root(equations, x, _LONGEST)
    if found is None:
        return None
    _, rates, bend, more = last[0]
    return CurvePoint(found, tangent_of(rates, row), bend, more)


def _is_inside(x: Array) -> bool:
    return bool(np.abs(x[1:3] - 0.5).max() <= 0.5 + MARGIN)


@dataclass(frozen=True)
class FoldSystem:
    """The equations in v = beta_t(0), in units of `scale`, and the two shares; kind: FOLD or PITCHFORK."""

    plane: ParameterPlane
    kind: str
    scale: float

    @property
    def size(self) -> int:
        return 3 if self.kind == FOLD else 4

    def equations(self, x: Array) -> tuple[Array, Array, float, Array]:
        """Values, derivatives, `bend` and `more` (as of `CurvePoint`) at x."""
        a, p = self._expansion(x)
        if self.kind == FOLD:
            values = a[:2].copy()
            rates = np.array([[a[1], *p[:, 0]], [a[2], *p[:, 1]]])
            return values, rates, float(a[2]), -p[:, 0] * np.sign(a[2])
        values = a[:3] - np.array([x[3], 0, 0])
        rates = np.array([[a[1], *p[:, 0], -1], [a[2], *p[:, 1], 0], [a[3], *p[:, 2], 0]])
        return values, rates, float(a[3]), -p[:, 1] * np.sign(a[3])

    def cusp(self, x: Array) -> Array | None:
        """The cusp of a fold curve near x."""

        def equations(x: Array) -> tuple[Array, Array] | None:
            if not _is_inside(x):
                return None
            a, p = self._expansion(x)
            return a[:3], np.column_stack([a[1:4], p[:, :3].T])

        return root(equations, x, _LONGEST)

    def _expansion(self, x: Array) -> tuple[Array, Array]:
        """The derivatives of B by v, (4,), and of these by the shares, (2, 4), in units of `scale`."""
        v, shares = float(x[0]) * self.scale, x[1:3]
        found = expansion(self.plane, v, shares, reach_of(self.plane, v, shares))
        return found.along * self.scale ** np.arange(4), found.across * self.scale ** np.arange(4)

    def leaves(self, x: Array) -> bool:
        return is_deep(self.plane, float(x[0]) * self.scale, x[1:3])

    def start_rate(self, x: Array) -> float:
        return float(x[0]) * self.scale

    def has_index(self, point: CurvePoint, lower: int) -> bool:
        """Whether two equilibria of index lower and lower + 1 meet in the point of a fold: at turning points of beta
        the Jacobi field has a zero between each two, and it begins and ends with one."""
        v = float(point.x[0]) * self.scale
        return self.kind == PITCHFORK or turns_at(self.plane, v, point.shares) == lower + 1

    def is_true(self, point: CurvePoint) -> bool:
        """Whether the point belongs to the problem itself: a pitchfork on a curve of e = 0, a fold that moves with the
        fields. Where e changes along the curve the fields break the symmetry, and folds meet in a cusp there."""
        if self.kind == PITCHFORK:
            return bool(abs(point.x[3]) < _UNFOLDED and abs(point.tangent[3]) < _STRAYS)
        return bool(np.abs(point.more).max() > 1e-6)


def tangent_of(rates: Array, along: Array) -> Array:
    """The direction in which the equations hold, of length 1, on the side of `along`."""
    direction = null_vector(rates)
    return np.asarray(direction if direction @ along >= 0 else -direction)
