"""Newton's method for a rod on nodes: each stretch is marched with its variations, and the system is banded."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..core.weight_friction import BY_STATE, ORDER, SIZE, march, solve_chain
from ..numerics.arrays import ALIKE, FAINT, NEGLIGIBLE, Array, whole_turns
from ..numerics.roots import DIVERGED, REACH, Ending, lead_away, newton
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q
from .varying_shapes import Shape

# the order of the series of the derivatives by which Newton's method goes. x10: it leaves the range of floats
DEEP = 13
WILD = 1e6  # of the scales: no equilibrium is sought from larger numbers. x10: marches that take seconds, to no end
SOFT = 1e-14  # springs that hardly change the equations, in the scales. x10: as good
# of steps away from known shapes; the goal is where Newton's method takes over. More rounds x10: 3.1 times the time, as
# those that fail take them
DEFLATED = Ending(rounds=30, goal=0.1)
# of the scales: a correction below this is rounding. x10: a digit less, which no answer shows
ENDING = Ending(rounds=40, goal=FAINT, small=1e-7, stall=0.25)


@dataclass(frozen=True, eq=False)
class Linear:
    """The equations at a shape, scaled.

    open: (8 N,), what is left open at the start, by the stretches and at the far end. transfer: (N - 1, 8, 8), of the
    stretches. stiffness: (N, 2), of springs, or None.
    """

    rod: LoadedRod
    open: Array
    transfer: Array
    stiffness: Array | None = None

    def solve(self, right: Array, soft: bool = False) -> Array | None:
        """The changes of the states, in their scales, for right sides (8 N, m); None where there are no finite ones.

        soft: whether springs that hardly change the equations are put in where a pivot vanishes, as at a fold.
        """
        if not np.isfinite(right).all():
            return None
        start, _, end, _ = self.rod.conditions()
        for stiffness in (self.stiffness, *([np.full((len(self.transfer) + 1, 2), SOFT)] * soft)):
            columns = solve_chain(self.transfer, self.rod.scale, start, end, stiffness, right)
            if columns is not None and np.isfinite(columns).all():
                return columns
        return None

    def newton_change(self) -> Array | None:
        """The change (N, 8), in the scales, that leaves nothing open; None where there is none."""
        column = self.solve(self.open)
        return None if column is None else -column.reshape(-1, SIZE)


def march_of(shape: Shape, shorter: float = 1.0, deep: int = ORDER) -> tuple[Array, Array]:
    """The ends (N, 8) of the stretches and their transfer matrices (N, 8, 8): heights and rotations only add."""
    rod = shape.rod
    marched = march(rod.numbers, rod.scale, shape.y[:-1], np.diff(shape.t), BY_STATE, shorter=shorter, deep=deep)
    columns = marched.columns
    whole = np.zeros((columns.shape[0], SIZE, SIZE))
    whole[:, :, :BY_STATE] = columns
    whole[:, SHORT, SHORT] = whole[:, ROUND, ROUND] = 1
    return marched.end, whole


def linear_at(
    shape: Shape,
    anchor: Array | None = None,
    stiffness: Array | None = None,
    shorter: float = 1.0,
    deep: int = ORDER,
) -> Linear:
    """The equations of a shape and their derivatives, scaled.

    anchor, stiffness: (N, 8) and (N, 2): springs at the nodes that pull beta and alpha towards those of the anchor.
    deep: the order of the series of the derivatives.
    """
    pulled, transfer = march_of(shape, shorter, deep)
    if stiffness is not None and anchor is not None:
        for k, (angle, moment) in enumerate(((BETA, SPEED), (ALPHA, Q))):
            pulled[:-1, moment] += stiffness[1:-1, k] * (shape.y[1:-1, angle] - anchor[1:-1, angle])
    return Linear(shape.rod, gaps_after(shape, pulled), transfer, stiffness)


def gaps_after(shape: Shape, after: Array) -> Array:
    """What is open, (8 N,), where the stretches end in the states `after` (N - 1, 8)."""
    start, near, end, far = shape.rod.conditions()
    gap = (shape.y[1:] - after) / shape.rod.scale
    return np.concatenate([start @ shape.y[0] - near, gap.reshape(-1), end @ shape.y[-1] - far])


def open_at(shape: Shape) -> Array:
    """What is left open in the equations of a shape, scaled, as of `Linear`."""
    return gaps_after(shape, march(shape.rod.numbers, shape.rod.scale, shape.y[:-1], np.diff(shape.t)).end)


def with_known_loads(shape: Shape) -> Shape:
    """A solved shape without the rounding of what is given at its ends, and of loads that vary in a known way."""
    rod, y = shape.rod, shape.y.copy()
    y[0, BETA if "beta0" in rod.held else SPEED] = rod.near[0]
    y[-1, BETA if "betaL" in rod.held else SPEED] = rod.far[0]
    if not rod.has_friction and "rotation" not in rod.held:
        y[:, MU] = rod.far[3]
    if not rod.has_friction and "height" not in rod.held:
        y[:, PHI] = rod.far[2] - rod.along * (rod.span - shape.t)
    return replace(shape, y=y)


def is_same(shape: Shape, other: Shape) -> bool:
    """Whether two shapes of a rod are one, whose beta may differ by whole turns where no end angle is given."""
    change = shape.y - other.y
    if shape.rod.turns_freely:
        change[:, BETA] -= whole_turns(change[0, BETA])
    return bool((np.abs(change) / shape.rod.scale)[:, [BETA, SPEED, ALPHA]].max() < ALIKE)


def turns_above(beta: float) -> float:
    """The whole turns [rad] by which an angle lies above the one in (-pi, pi], to rounding."""
    # an angle as near to -pi, as of a rod that points back, is pi, whatever its last digits
    return float(whole_turns(beta - NEGLIGIBLE))


def within_a_turn(shape: Shape) -> Shape:
    """The shape itself, or where no end angle is given the one with beta(0) in (-pi, pi], to rounding."""
    turns = turns_above(float(shape.y[0, BETA])) if shape.rod.turns_freely else 0
    if not turns:
        return shape
    y = shape.y.copy()
    y[:, BETA] -= turns
    return replace(shape, y=y)


def marks_of(shape: Shape) -> Array:
    """Numbers that tell a shape from others: the angles at the nodes in their scales, such that the length of a
    difference is its mean size; sine and cosine of beta in place of beta where no end angle is given."""
    return _marks(shape, shape.y[:, ALPHA], _sine_and_cosine(shape) if shape.rod.turns_freely else [shape.y[:, BETA]])


def change_of_marks(shape: Shape, change: Array) -> Array:
    """How the marks of a shape answer a small change (N, 8), in the scales."""
    moved = change * shape.rod.scale
    beta = [moved[:, BETA]]
    if shape.rod.turns_freely:
        sin, cos = _sine_and_cosine(shape)
        beta = [cos * moved[:, BETA], -sin * moved[:, BETA]]
    return _marks(shape, moved[:, ALPHA], beta)


def _sine_and_cosine(shape: Shape) -> list[Array]:
    return [np.sin(shape.y[:, BETA]), np.cos(shape.y[:, BETA])]


def _marks(shape: Shape, alpha: Array, beta: list[Array]) -> Array:
    scale = shape.rod.scale
    columns = [alpha / scale[ALPHA], *(column / scale[BETA] for column in beta)]
    return np.concatenate(columns) / np.sqrt(shape.t.size)


def correct(
    shape: Shape,
    anchor: Array | None = None,
    stiffness: Array | None = None,
    most: int = ENDING.rounds,
    enough: float = FAINT,
) -> Shape | None:
    """The equilibrium that Newton's method reaches from a shape; None where it reaches none.

    enough: a correction, in the scales, that ends the steps; Newton's next one would be about its square.
    """

    def step(now: Shape) -> tuple[Shape, float] | str:
        if np.abs(now.y / now.rod.scale)[:, [BETA, SPEED, Q, PHI]].max() > WILD:  # whose march would take seconds
            return DIVERGED
        return newton_move(now, linear_at(now, anchor, stiffness, deep=DEEP).newton_change())

    corrected = newton(replace(shape, steps=0), step, replace(ENDING, rounds=most, goal=enough))
    return None if isinstance(corrected, str) else with_known_loads(corrected)


def newton_move(shape: Shape, change: Array | None) -> tuple[Shape, float] | str:
    """The shape after a step of Newton's method, and the size of the step.

    change: (N, 8), in the scales, of which the share within reach is taken; None where the equations have no solution.
    """
    if change is None:
        return DIVERGED
    y = shape.y + change * shape.rod.scale * share_within(change)
    return replace(shape, y=y, steps=shape.steps + 1), size_of(change)


def deflate(
    start: Shape,
    known: Sequence[Array],
    marks: Callable[[Shape], Array],
    change_of: Callable[[Shape, Array], Array],
    reach: float,
) -> Shape | None:
    """The equilibrium to which Newton's method leads from a shape, away from known ones; None where it leads to none.

    marks: numbers that tell a shape from others; known: those of each known one. change_of: how they answer a small
    change (N, 8), in the scales. reach: the longest step of an angle, in its scale.
    """

    def newton_step(shape: Shape) -> tuple[Array, Array, Array] | None:
        change = linear_at(shape, deep=DEEP).newton_change()
        return None if change is None else (marks(shape), change_of(shape, change), change)

    def move(shape: Shape, change: Array, factor: float) -> tuple[Shape, float]:
        turn = largest_turn(change)
        share = np.clip(factor, -reach / turn, reach / turn) if turn else 0.0
        return replace(shape, y=shape.y + share * change * shape.rod.scale), size_of(change)

    near = lead_away(start, newton_step, move, known, DEFLATED)
    return None if near is None else correct(near, most=15)


def share_within(change: Array) -> float:
    """The share of a change (N, 8), in the scales, by which no angle moves farther than `REACH`."""
    size = largest_turn(change)
    return min(1.0, REACH / size) if size else 1.0


def largest_turn(change: Array) -> float:
    """The largest change of an angle in a change (N, 8), in the scales."""
    return float(np.abs(change[:, [BETA, ALPHA]]).max())


def size_of(change: Array) -> float:
    """The size of a change (N, 8), in the scales: forces that vary in a known way do not count."""
    return float(np.abs(change[:, :PHI]).max())
