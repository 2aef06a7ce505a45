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

Long rods have their folds next to a separatrix: the level is nearly the height of a saddle, and the numbers of the
start do not tell the gap g between the two. There log |g| is unknown too, and one more equation is beta_t(0)^2 = g +
G(saddle) - G(beta(0)). The determinant of all derivatives is -g times the other one, and regular however small g is.
Equal end angles reach a turning point together, where the equation for the far one says what that for the level says;
there beta_t(L) = -beta_t(0) is met instead.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NamedTuple, TypeVar

import numpy as np

from ..numerics.arclength import PITCHFORK, Lengths, Node, node_at
from ..numerics.arrays import ALIKE, ASIDE, NEGLIGIBLE, ROUGHLY, SQUARE_LOST, Array
from ..numerics.roots import REACH
from ..orbits.boundary import boundary_of, nearest_angle
from ..orbits.periodic_orbit import TIGHT, Pin, helix_half_waves, solve_orbit
from ..orbits.potential import load_size, slope
from ..problem.dimensionless import StartProblem
from .family import as_given, numbers_with_names
from .fold_tracing import Ahead, LinePoint, Point, change_within, point_on_line, with_no_side
from .given_numbers import FREE, Given, values_of
from .held_index import lower_index
from .orbit_rates import NUMBERS, OrbitRates, rates_of_helices, start_rates
from .parameter_plane import ParameterPlane, reflect
from .path_correction import state_from_start

GivenAt = Callable[[Array], Given]
Level = tuple[float, float, float]  # the angle of a saddle, and the sign and the log of the gap above its height
# of steps, in the sizes of the unknowns and of z. x10: a curve is drawn by chords that one sees, or steps to another
LENGTHS = Lengths(first=0.01, longest=0.05, least=2e-6)
START = ("beta0", "dbeta0", "lam", "mu", "phi")  # the numbers with which an orbit starts
# of log gap in the metric of a curve: log gap runs to -575 where other unknowns are near 1. x10: steps change the gap
# by powers of e
UNIT = 20.0
# gaps to a saddle below which log gap is unknown, and above which it no longer is: apart, so that the form does not
# change at each step. x10: it is kept where log gap has an extremum
DEEP, SHALLOW = 1e-3, 4e-3
# gap of a guess, and distance of an end from a saddle: its logarithm and square are floats. x10: no change
_LEAST = 1e-100
# of beta_t(0), in its size: for the second derivative of the Jacobi field by differences, whose rounding is 1e-8 of it.
# x10: an error of order 2, 4e-6
_BEND = 2e-4
_SIDES = 2.0**-25  # of a step: how closely a change of side is enclosed. x10: its place has a digit less
# of beta_t(0), in its size: where a fold curve may meet pitchforks. x10: only time, as what is tried is solved for
_CROSSING = 0.02
_SAME = 0.02  # largest distance between a point and itself in another form. x10: the step may go on along another curve


def numbers_on(plane: ParameterPlane) -> GivenAt:
    """The given numbers at z in the unit square, a little beyond its border too."""
    names, numbers = numbers_with_names(plane.case, *plane.names)

    def at(z: Array) -> Given:
        return as_given(names, numbers(*plane.values(z).tolist()))

    return partial(reflect, at, names=("values", "ratio"))


def mark_of(numbers: Array, loads: float, span: float) -> Array:
    """The `NUMBERS` but the level, (10,), in units of which they change by about 1. loads: the size of the loads."""
    return np.asarray(numbers / np.array([1, 1, *[np.sqrt(1 + loads)] * 2, *[1 + span] * 3, *[1 + loads] * 3]))


OrbitPoints = TypeVar("OrbitPoints", bound="OrbitPoint")


class Saddle(NamedTuple):
    """A saddle whose height the level nears.

    angle: about where it lies. sign: of the gap g. even: whether two equal end angles reach a turning point together.
    """

    angle: float
    sign: float
    even: bool


class _StartedOrbit(NamedTuple):
    """An orbit from its start on. pin: the level, where its saddle counts. over: by how much beta_t(0)^2 is too large
    for that level."""

    given: Given
    rates: OrbitRates
    pin: Pin | None = None
    over: float = 0.0

    @property
    def dbeta0(self) -> float:
        """beta_t(0)."""
        return float(self.rates.values[0, NUMBERS.index("dbeta0")])

    @property
    def level(self) -> Level:
        """As beta_t(0) tells it."""
        boundary = boundary_of(self.rates.problem)
        gaps = {float(s): self.dbeta0**2 - boundary.fall(float(s), boundary.start) for s in boundary.saddles}
        angle, gap = min(gaps.items(), key=lambda item: self.depth(*item))
        return angle, 1.0 if gap > 0 else -1.0, float(np.log(max(abs(gap), _LEAST)))

    def depth(self, angle: float, gap: float) -> float:
        """The size of the gap to a saddle, over the square of the angle between it and the nearer end: an end that lies
        there tells the gap, which may pass through 0 then."""
        problem = self.rates.problem
        apart = min(2 * abs(float(np.sin((end[0] - angle) / 2))) for end in (problem.beta0, problem.betaL))
        return abs(gap) / max(apart, _LEAST) ** 2


@dataclass(frozen=True, eq=False, kw_only=True)
class OrbitPoint(LinePoint):
    """A fold or pitchfork.

    w: the unknown numbers of the start over `scales`, next to a saddle log gap over `UNIT`, and z.
    """

    numbers_at: GivenAt
    scales: Array
    saddle: Saddle | None = None
    nudge = 1e-7  # of derivatives of the determinant

    @property
    def dbeta0(self) -> float:
        """beta_t(0)."""
        return self.own.dbeta0

    @property
    def mark(self) -> Array:
        """What tells this equilibrium from others nearby, by `mark_of`."""
        rates = self.own.rates
        return mark_of(rates.values[0, :-1], float(load_size(rates.problem)[0]), float(rates.problem.span[0]))

    @cached_property
    def own(self) -> _StartedOrbit:
        """The orbit."""
        orbit = self.at(self.w)
        assert orbit is not None
        return orbit

    def at(self, w: Array) -> _StartedOrbit | None:
        """The orbit at w; None where its saddle no longer exists."""
        numbers, rest = np.split(w, [w.size - (2 if self.saddle is None else 3)])
        given, unknown = self.numbers_at(w[-2:]), iter((numbers * self.scales).tolist())
        start = {name: given.number(name, 0.0) if name in given.names else next(unknown, 0.0) for name in START}
        problem = StartProblem(span=np.array([given.span]), **{name: np.array([v]) for name, v in start.items()})
        if self.saddle is not None:
            return _orbit_beside(self.saddle, problem, float(rest[0]) * UNIT, given)
        if start["dbeta0"] == 0 and float(slope(problem, problem.beta0)[0]) == 0:
            return _StartedOrbit(given, rates_of_helices(problem.with_end(problem.beta0)))
        return _StartedOrbit(given, start_rates(problem))

    def equations(self, w: Array) -> Array:
        """The numbers to be met at the far end less the given ones; next to a saddle the square of beta_t(0) less that
        of the level; and the determinant of their derivatives. NaN where there is no orbit."""
        orbit = self.at(w)
        if orbit is None:
            return np.full(w.size, np.nan)
        given, rates = orbit.given, orbit.rates
        fixed = [name for name in START if name in given.names]
        free = [name for name in START if name not in given.names]
        met = [name for name in given.names if name not in START]
        off = values_of(rates.values[0], given.span, given) - given.values
        off = off[[given.names.index(name) for name in met]]
        start, far = (rates.rows_of([*fixed, *names], given.ratio)[0][0] for names in (free, met))
        if self.saddle is not None and self.saddle.even:
            k, speeds = met.index("betaL"), [NUMBERS.index(name) for name in ("dbeta0", "dbetaL")]
            off[k], far[len(fixed) + k] = rates.values[0, speeds].sum(), rates.rows[0, speeds].sum(axis=0)
        with np.errstate(all="ignore"):
            determinant = np.linalg.det(far) / np.linalg.det(start) * self.scales.prod()
        if orbit.pin is None:
            return np.append(off, determinant)
        return np.append(off, [orbit.over, -orbit.pin[1][0] * determinant])

    def after(self: "OrbitPoints", node: Node) -> "Ahead[OrbitPoints] | None":
        """The point a step ahead (`LinePoint.after`); the saddle is looked for where it is now."""
        ahead = super().after(node)
        if ahead is None or self.saddle is None:
            return ahead
        point, pin = ahead[0], ahead[0].own.pin
        assert pin is not None
        return replace(point, saddle=self.saddle._replace(angle=float(pin[0][0]))), node


def _orbit_beside(saddle: Saddle, problem: StartProblem, y: float, given: Given) -> _StartedOrbit | None:
    """The orbit whose level is exp(y) above or below the saddle; None where this no longer exists."""
    boundary = boundary_of(problem.with_end(problem.beta0))
    if not boundary.saddles.size:
        return None
    (angle, apart), deepest = nearest_angle(boundary.saddles, saddle.angle), boundary.deepest
    if apart > np.sin(REACH / 2):
        return None
    gap = saddle.sign * float(np.exp(max(y, deepest)))
    pin = np.array([angle]), np.array([gap]), np.array([max(deepest - y, 0.0)])
    over = float(problem.dbeta0[0]) ** 2 - gap - boundary.fall(angle, boundary.start)
    return _StartedOrbit(given, start_rates(problem, pin), pin, over)


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
        return bool(np.abs(self.more).max() > ALIKE)  # where z changes its equations less, it stays

    @cached_property
    def lower(self) -> int:
        """The lower Morse index of the two equilibria that meet; 0 where it is not decided.

        Under dead loads the Jacobi field has a zero between each two turning points of beta, and begins and ends with
        one. Next to a saddle the rod passes a turning point at one of its ends where the gap is positive: the length
        falls with the square of beta_t there and must rise with beta_t, which rounding hides.
        """
        given, rates, pin, _ = self.own
        if given.names != FREE:
            return lower_index(state_from_start(rates, self.dbeta0, pin), given)
        orbit = solve_orbit(rates.problem.with_start(np.array([self.dbeta0])), TIGHT, pin)
        if pin is None:
            return int(orbit.turns[0]) - 1
        apart, span = float(orbit.period[0]) / 2, given.span
        times = float(orbit.ahead[0]) + apart * np.arange(-1, span // apart + 2)
        at_ends = np.minimum(np.abs(times), np.abs(times - span)) < ROUGHLY  # next to a saddle
        inside = (times > 0) & (times < span) & ~at_ends
        return int(inside.sum() + at_ends.sum() * (pin[1][0] > 0)) - 1


@dataclass(frozen=True, eq=False, kw_only=True)
class OrbitPitchfork(OrbitPoint):
    """A pitchfork under dead loads: of the rod that starts at rest. w: log gap over `UNIT` next to a saddle, and z."""

    kind: str = PITCHFORK

    def value(self, w: Array) -> Array | None:
        """The Jacobi field at the far end, (1,); next to a saddle beta_t at the far end and the level instead, (2,)."""
        values = self.equations(w)[:-1] if self.saddle is not None else self.equations(w)[1:]
        return values if np.isfinite(values).all() else None

    def side_of(self, node: Node) -> Array:
        """The direction to the side of two more equilibria (`LinePoint.side_of`).

        The miss of beta(L) is E v + B v^3/6: the two others exist where E B < 0. Next to a saddle the length does not
        depend on v, and v^2 is what the level lies above that of rest.
        """
        if self.saddle is not None:
            return -node.jacobian[1, 1:]
        v = _BEND * np.sqrt(1 + float(load_size(self.own.rates.problem)[0]))
        low, middle, high = (self.equations(np.append(offset, node.w))[1] for offset in (-v, 0.0, v))
        return np.asarray(-np.sign(low + high - 2 * middle) * node.jacobian[0])

    @property
    def is_true(self) -> bool:
        """Whether the rod at rest is an equilibrium along the curve; else the fields break the symmetry, and folds meet
        in a cusp there."""
        if self.saddle is not None:
            return True
        return all(abs(float(self.equations(z)[0])) < SQUARE_LOST for z in (self.w, self.w + ASIDE * self.way))

    @cached_property
    def lower(self) -> int:
        """The lower Morse index of the two equilibria that meet: the half waves that the rod is long, less one."""
        problem, pin = self.own.rates.problem, self.own.pin
        orbit = solve_orbit(problem.with_start(np.zeros(1)), TIGHT, pin)
        half_waves = 2 * problem.span / orbit.period if np.isfinite(orbit.period[0]) else helix_half_waves(problem)
        return int(np.round(half_waves[0])) - 1


def guess_at(kind: str, numbers_at: GivenAt, z: Array, numbers: Mapping[str, float]) -> "OrbitFold | OrbitPitchfork":
    """A guess of a fold or pitchfork at z; numbers: of the start of an equilibrium nearby, those that are not given."""
    given = numbers_at(z)
    start = {name: given.number(name, numbers.get(name, 0.0)) for name in START}
    loads = sum(abs(start[name]) for name in START[2:])
    sizes = dict(zip(START, (1.0, np.sqrt(1 + loads), *[1 + loads] * 3), strict=True))
    if kind == PITCHFORK:
        return OrbitPitchfork(numbers_at=numbers_at, scales=np.ones(1), w=z)
    free = [name for name in START if name not in given.names]
    scales = np.array([sizes[name] for name in free])
    w = np.append([start[name] / sizes[name] for name in free], z)
    return OrbitFold(numbers_at=numbers_at, scales=scales, w=w)


def in_log_gap(point: OrbitPoints, largest: float, level: Level | None = None) -> OrbitPoints | None:
    """A point next to a saddle with log gap as one more unknown; None where the `depth` is larger.

    level: default: as beta_t(0) tells it.
    """
    orbit = point.own
    angle, sign, y = orbit.level if level is None else level
    even = is_even(orbit)
    if orbit.depth(angle, float(np.exp(y))) > largest or (point.kind == PITCHFORK and not even):
        return None
    return replace(point, saddle=Saddle(angle, sign, even), w=np.insert(point.w, point.w.size - 2, y / UNIT))


def is_even(orbit: _StartedOrbit) -> bool:
    """Whether the rod next to a saddle equals its own reversal: at equal end angles, and under dead loads at rest."""
    given, (v, vL) = orbit.given, orbit.rates.values[0, 2:4]
    equal = given.number("beta0", np.nan) == given.number("betaL", np.nan)
    return bool(equal and (given.names == FREE or v * vL < 0))


def in_start_numbers(point: OrbitPoints) -> OrbitPoints:
    """A point without log gap among its unknowns."""
    return replace(point, saddle=None, w=np.delete(point.w, -3))


def mirror_image(fold: OrbitFold) -> OrbitFold:
    """The fold of the mirror image at the same z, under dead loads next to a pitchfork."""
    return replace(fold, w=fold.w * [-1, 1, 1])


def meets_pitchforks(fold: OrbitFold, node: Node) -> bool:
    """Whether a curve of folds is about to meet one of pitchforks, where its equations are singular and it goes on with
    the mirror image.

    With B the miss of beta(L) and E the Jacobi field, B is about v E there, v being beta_t(0).
    """
    v = float(fold.w[0])
    if fold.own.given.names != FREE or not abs(v) < _CROSSING or node.tangent[0] * v > 0:
        return False
    of_miss, of_field = np.abs(node.jacobian[:, 1:]).max(axis=1)
    image = fold.value(mirror_image(fold).w) if of_miss < 2 * abs(v) * of_field else None
    return image is not None and bool(np.abs(image).max() < NEGLIGIBLE * of_field)


def in_other_form(point: OrbitPoint, node: Node, stuck: bool) -> Iterator[Ahead[OrbitPoint]]:
    """Other forms of a point (`fold_tracing.Others`): with log gap, or without it, or the mirror image."""
    way, guess = node.tangent[-2:], None
    pin = point.own.pin
    if pin is not None:
        if stuck or point.own.depth(float(pin[0][0]), float(pin[1][0])) > SHALLOW:
            guess = in_start_numbers(point)
    elif isinstance(point, OrbitFold) and meets_pitchforks(point, node):
        guess, way = mirror_image(point), -way
    else:
        guess = in_log_gap(point, SHALLOW if stuck else DEEP)
    other = None if guess is None else point_on_line(guess, int(np.argmin(np.abs(way))))
    if other is None or np.abs(other.z - point.z).max() > _SAME or other.lower != point.lower:
        return
    begin = node_at(other, other.w, np.append(np.zeros(other.w.size - 2), way))
    if not isinstance(begin, str):
        yield other, begin


def sides_between(point: Point, node: Node, step: float, taken: Ahead[Point]) -> list[Point] | None:
    """Pitchforks within a step (`fold_tracing.Between`): where a fold curve ends on the line, and the side of two more
    equilibria changes."""

    def is_left(ahead: Ahead[Point]) -> bool:
        way, more = ahead[1].tangent[-2:], ahead[0].more
        return bool(way[0] * more[1] > way[1] * more[0])

    return [with_no_side(side) for side in change_within(point, node, step, taken, is_left, _SIDES * step)[:1]]
