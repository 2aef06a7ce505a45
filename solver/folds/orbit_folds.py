"""Folds and pitchforks of a rod without weight over two numbers z, in the numbers with which its orbit starts.

An orbit starts with beta, beta_t and three loads. Those of them that are given are read from the problem at z, the
others are unknown, and as many given numbers must be met at the far end. At a fold the determinant of their
derivatives by the unknown ones vanishes too; a fold curve is that system over z. The far end is where the orbit is
after the length of the rod, so the equations are smooth wherever an end of the rod passes a turning point, where the
length of a path is not. All derivatives at the far end are exact (`orbit_rates.start_rates`).

Under dead loads beta_t(0) is the one unknown, beta(L) is the number to be met, and the determinant is the Jacobi field
at the far end, d beta(L)/d beta_t(0). Where the problem equals its own mirror image, two equilibria split off a third
in a pitchfork: the symmetric one is at rest at both ends, or a helix, so a pitchfork curve is where the Jacobi field of
the rod that starts at rest vanishes at the far end.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from ..branches.family import given_of, given_over
from ..equilibrium.given_numbers import FREE, Given, values_of
from ..equilibrium.held_index import index_of
from ..equilibrium.orbit_rates import NUMBERS, OrbitRates, rates_of_helices, start_rates
from ..equilibrium.system import corner_state
from ..mechanics.potential import load_size, slope
from ..numerics.arclength import FOLD, PITCHFORK, Lengths, Node
from ..numerics.arrays import Array
from ..numerics.roots import solve
from ..orbit.periodic_orbit import TIGHT, helix_half_waves, solve_orbit
from ..problem.reduced import StartProblem
from .parameter_plane import ParameterPlane, reflect
from .special_line import BESIDE, Ahead, Point, SpecialPoint, change_within, point_on_line, with_no_side, zero_on

GivenAt = Callable[[Array], Given]
LENGTHS = Lengths(first=0.01, longest=0.05, least=2e-6)  # of steps, in the sizes of the unknowns and of z
START = ("beta0", "dbeta0", "lam", "mu", "phi")  # the numbers with which an orbit starts
_STEP = 1e-7  # of derivatives of the determinant, in the sizes of the unknowns and of z
_BEND = 2e-4  # of beta_t(0), in its size: of the second derivative of the Jacobi field by it
_SIDES = 2.0**-25  # of a step: how closely a change of side is enclosed
_MOVES = 1e-6  # least change of the equations of a fold by z
_UNFOLDED, _STRAY = 1e-8, 1e-3  # rad: the largest miss of beta(L) at a pitchfork; how far along its curve too
_CROSSING, _MIRRORED = 0.02, 1e-9  # of beta_t(0), in its size: where a fold curve may meet pitchforks; of an image


def given_on(plane: ParameterPlane) -> GivenAt:
    """The given numbers at z in the unit square, a little beyond its border too."""
    names, numbers = given_over(plane.case, *plane.names)

    def at(z: Array) -> Given:
        return given_of(names, numbers(*plane.values(z).tolist()))

    return partial(reflect, at, names=("values", "span", "ratio"))


def mark_of(numbers: Array, loads: float, span: float) -> Array:
    """The `NUMBERS` but the level, (10,), in units of which they change by about 1. loads: the size of the loads."""
    return np.asarray(numbers / np.array([1, 1, *[np.sqrt(1 + loads)] * 2, *[1 + span] * 3, *[1 + loads] * 3]))


def orbit_at(given_at: GivenAt, free: Array, z: Array) -> tuple[Given, OrbitRates]:
    """The given numbers at z, and the orbit there; free: those of its start that are not given."""
    given, unknown = given_at(z), iter(free.tolist())
    start = {name: given.number(name, 0.0) if name in given.names else next(unknown) for name in START}
    problem = StartProblem(span=np.array([given.span]), **{name: np.array([v]) for name, v in start.items()})
    if start["dbeta0"] == 0 and float(slope(problem, problem.beta0)[0]) == 0:
        return given, rates_of_helices(problem.with_end(problem.beta0))
    return given, start_rates(problem)


@dataclass(frozen=True, eq=False, kw_only=True)
class OrbitPoint(SpecialPoint):
    """A fold or pitchfork. w: the unknown numbers of the start over `scales`, and z."""

    given_at: GivenAt
    scales: Array
    nudge = _STEP

    @property
    def slope(self) -> float:
        """beta_t(0)."""
        return float(self.own[1].values[0, NUMBERS.index("dbeta0")])

    @property
    def mark(self) -> Array:
        """As of `mark_of`."""
        rates = self.own[1]
        return mark_of(rates.values[0, :-1], float(load_size(rates.problem)[0]), float(rates.problem.span[0]))

    @cached_property
    def own(self) -> tuple[Given, OrbitRates]:
        """The given numbers, and the orbit."""
        return self.at(self.w)

    def at(self, w: Array) -> tuple[Given, OrbitRates]:
        """The same at w."""
        return orbit_at(self.given_at, np.append(w[:-2] * self.scales, 0.0), w[-2:])

    def equations(self, w: Array) -> Array:
        """The numbers to be met at the far end less the given ones, and the determinant of their derivatives."""
        given, rates = self.at(w)
        off = values_of(rates.values[0], given.span, given) - given.values
        met = [k for k, name in enumerate(given.names) if name not in START]
        free = [k for k, name in enumerate(START) if name not in given.names]
        start = rates.rows[0][[NUMBERS.index(name) for name in START]]
        by_start = rates.rows_of(given.names, given.ratio)[0][0] @ solve(start[None], np.eye(5)[None])[0]
        return np.append(off[met], np.linalg.det(by_start[np.ix_(met, free)] * self.scales))


@dataclass(frozen=True, eq=False, kw_only=True)
class OrbitFold(OrbitPoint):
    """A fold."""

    def value(self, w: Array) -> Array | None:
        """All equations."""
        values = self.equations(w)
        return values if np.isfinite(values).all() else None

    @property
    def is_true(self) -> bool:
        """Whether it moves with z."""
        return bool(np.abs(self.more).max() > _MOVES)

    @cached_property
    def lower(self) -> int:
        """The lower Morse index of the two equilibria that meet.

        Under dead loads the Jacobi field has a zero between each two turning points of beta, and begins and ends with
        one. With held ends it is read on the branch across the curve.
        """
        given, rates = self.own
        if given.names == FREE:
            return int(solve_orbit(rates.problem.with_start(np.array([self.slope])), TIGHT).turns[0]) - 1
        sides = [self._index_beside(a) for a in (BESIDE, -BESIDE)]
        return int(min((index for index in sides if np.isfinite(index)), default=0))

    def _index_beside(self, a: float) -> float:
        """The index of the equilibrium at a distance along the branch across the curve; NaN where it is not decided."""
        jacobian = self.jacobian(self.w)
        assert jacobian is not None
        along = np.append(np.linalg.svd(jacobian[:-1, :-2])[2][-1], [0.0, 0.0])
        w = zero_on(self, self.w + a * along, np.vstack([along, np.append(0 * self.w[:-2], self.way)]))
        if w is None:
            return np.nan
        given, rates = self.at(w)
        return index_of(corner_state(rates, float(rates.values[0, NUMBERS.index("dbeta0")])), given)


def fold_near(given_at: GivenAt, z: Array, axis: int, numbers: Array) -> OrbitFold | None:
    """The fold near z on the line along number `axis`; None where Newton's rule reaches none.

    numbers: the `NUMBERS` of an equilibrium nearby, but for the level.
    """
    given, loads = given_at(z), np.abs(numbers[[NUMBERS.index(name) for name in START[2:]]]).sum()
    sizes = dict(zip(START, (1.0, np.sqrt(1 + loads), *[1 + loads] * 3), strict=True))
    free = [name for name in START if name not in given.names]
    scales = np.array([sizes[name] for name in free])
    w = np.append(numbers[[NUMBERS.index(name) for name in free]] / scales, z)
    return point_on_line(OrbitFold(given_at=given_at, scales=scales, w=w), axis)


def point_near(
    kind: str, given_at: GivenAt, scale: float, slope: float, z: Array, axis: int
) -> "OrbitFold | OrbitPitchfork | None":
    """The fold or pitchfork under dead loads near z on the line along number `axis`; None where there is none.

    scale, slope: of beta_t(0), and its value at a fold.
    """
    if kind == FOLD:
        fold = OrbitFold(given_at=given_at, scales=np.array([scale]), w=np.append(slope / scale, z))
        return point_on_line(fold, axis)
    return point_on_line(OrbitPitchfork(given_at=given_at, scales=np.ones(1), w=z), axis)


@dataclass(frozen=True, eq=False, kw_only=True)
class OrbitPitchfork(OrbitPoint):
    """A pitchfork under dead loads: of the rod that starts at rest. w: z."""

    kind: str = PITCHFORK

    def value(self, w: Array) -> Array | None:
        """The Jacobi field at the far end, (1,)."""
        values = self.equations(w)[1:]
        return values if np.isfinite(values).all() else None

    def side_of(self, node: Node) -> Array:
        """As of `SpecialPoint`. The miss of beta(L) is E v + B v^3/6: the two others exist where E B < 0."""
        v = _BEND * np.sqrt(1 + float(load_size(self.own[1].problem)[0]))
        low, middle, high = (self.equations(np.append(offset, node.w))[1] for offset in (-v, 0.0, v))
        return np.asarray(-np.sign(low + high - 2 * middle) * node.jacobian[0])

    @property
    def is_true(self) -> bool:
        """Whether the rod at rest is an equilibrium along the curve; else the fields break the symmetry, and folds meet
        in a cusp there."""
        return all(abs(float(self.equations(z)[0])) < _UNFOLDED for z in (self.w, self.w + _STRAY * self.way))

    @cached_property
    def lower(self) -> int:
        """The lower Morse index of the two equilibria that meet: the half waves that the rod is long, less one."""
        problem = self.own[1].problem
        orbit = solve_orbit(problem.with_start(np.zeros(1)), TIGHT)
        half_waves = 2 * problem.span / orbit.period if np.isfinite(orbit.period[0]) else helix_half_waves(problem)
        return int(np.round(half_waves[0])) - 1


def mirror_image(fold: OrbitFold) -> OrbitFold:
    """The fold of the mirror image at the same z, under dead loads next to a pitchfork."""
    return replace(fold, w=fold.w * [-1, 1, 1])


def meets_pitchforks(fold: OrbitFold, node: Node) -> bool:
    """Whether a curve of folds is about to meet one of pitchforks, where its equations are singular and it goes on with
    the mirror image.

    With B the miss of beta(L) and E the Jacobi field, B is about v E there, v being beta_t(0).
    """
    v = float(fold.w[0])
    if fold.own[0].names != FREE or not abs(v) < _CROSSING or node.tangent[0] * v > 0:
        return False
    of_miss, of_field = np.abs(node.jacobian[:, 1:]).max(axis=1)
    image = fold.value(mirror_image(fold).w) if of_miss < 2 * abs(v) * of_field else None
    return image is not None and bool(np.abs(image).max() < _MIRRORED * of_field)


def sides_between(point: Point, node: Node, step: float, taken: Ahead[Point]) -> list[Point] | None:
    """As of `special_line.Between`, of pitchforks: where a fold curve ends on the line, and the side of two more
    equilibria changes."""

    def is_left(there: Ahead[Point]) -> bool:
        way, more = there[1].tangent[-2:], there[0].more
        return bool(way[0] * more[1] > way[1] * more[0])

    return [with_no_side(side) for side in change_within(point, node, step, taken, is_left, _SIDES * step)[:1]]
