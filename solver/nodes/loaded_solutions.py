"""The answers to cases whose loads vary along the rod: start problems by one march, ends problems one by one."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from ..branches.parameter_plane import reflect
from ..core.tuning import MOST_STEPS, SAFETY
from ..core.weight_friction import BY_ANGLE, SIZE, TRUNCATION, March, march
from ..numerics.arrays import FAINT, SQUARE_LOST, Array
from ..orbits.forces import circumferential_force, surface_forces
from ..problem.case import ALONG_AXIS, IN_PLACE, Case
from ..problem.dimensionless import EndsProblem, StartProblem, flat
from ..problem.errors import InputError
from ..problem.limits import unreachable
from ..problem.outcomes import verdicts
from ..problem.trajectory import Trajectory, blank
from .banded_newton import correct
from .buckling import straight_shape
from .constant_loads import dead_indices
from .growth import STRAIGHT, GrowthWay
from .loaded_rod import (
    ALPHA,
    BETA,
    MU,
    PHI,
    SPEED,
    VARYING,
    LoadedRod,
    Q,
    densest_nodes,
    rod_over,
    rods_of,
    starts_of,
)
from .node_branch import NodeCurve
from .pipe_states import LEAVES, RUBS
from .shape_error import ROUNDING, estimate
from .shape_index import index_at, index_of_any, shape_like
from .straight_branch import find_shape
from .varying_shapes import Marched, Shape, VaryingShapes, read_starts

# of start problems: what all steps leave out of beta, as a share of the tolerance; the most that one does, of the
# scales. x10: a tenth of the tolerance; the most x10: 1.9 times the time, and errors nearer to what is allowed
SHARE, COARSEST = 0.01, 1e-12
# of a number of a rod in units of A and rho; of L/rho between two ends. x10: as good; sums of fourth powers overflow
# from 1e77 on
LARGEST, SHORTEST = 1e30, 1e-15
# coefficient of friction: rubber on rubber has 1 to 4, and the time to lose a march grows with it. x10: seconds for a
# rod that is lost
ROUGHEST = 10.0
# of an ends problem: as many as of 30 km of pipe. x10: ten times the time and memory before it is refused
MOST_CHANGES = 20_000


@np.errstate(over="ignore", divide="ignore", invalid="ignore")  # what is out of range is said in the outcome
def answer_starts(case: Case, t: Array, tol: float) -> tuple[StartProblem, Trajectory]:
    """The start problems at stations t (B, n); the problem has the loads of the far end.

    The error is what the steps leave out and round off, carried along the rod by their own derivatives.
    """
    problem, numbers, begin, scale = starts_of(case)
    friction = numbers[:, 3].copy()
    rough = np.abs(friction) > ROUGHEST
    numbers[rough, 3] = 0.0  # another rod in its place
    marched, error, condition = _march_to_tolerance(problem.span, numbers, begin, scale, t, tol)
    y, end = marched.out.reshape(SIZE, *t.shape), marched.end
    read = read_starts(y, t, begin[:, ALPHA], numbers[:, 0] * end[:, MU])
    solved, outcome = verdicts(read["beta"], error, condition, tol)
    for i in np.flatnonzero(~(condition < 1 / SQUARE_LOST)):
        endless = marched.steps[i] > MOST_STEPS
        load = "weight" if np.any(numbers[i, 1:3]) else "friction"
        why = f"failed: the march did not end within {MOST_STEPS} steps" if endless else outcome[i]
        outcome[i] = f"{why}; a long rod with {load} is an ends problem: give Ends in place of Start"
    shapes = VaryingShapes(Marched(numbers, scale, begin, problem.span, marched.steps), *np.full((2, len(t)), np.nan))
    far = StartProblem(end[:, Q] + end[:, MU], end[:, MU], end[:, PHI], problem.span, problem.beta0, problem.dbeta0)
    answer = Trajectory(
        **read,
        solved=solved,
        outcome=with_undelivered(outcome, solved, case, numbers, begin, end),
        error=error,
        condition=condition,
        evaluations=marched.steps,
        shapes=shapes,
    )
    if rough.any():
        why = [f"failed: {why_too_rough(value)}" for value in friction.tolist()]
        answer = blank(answer, ~rough, np.array(why, dtype=object))
    return far, answer


def _march_to_tolerance(
    span: Array, numbers: Array, begin: Array, scale: Array, t: Array, tol: float
) -> tuple[March, Array, Array]:
    """The march of start problems to stations t (B, n), their errors and their condition numbers, (B,) each.

    A rod whose error is above the tolerance is marched again, with shorter steps.
    """
    n, weight = t.shape[1], np.sqrt(np.abs(begin[:, SPEED]) + scale[:, 4])

    def march_with_errors(rows: Any, truncation: Array) -> tuple[March, Array, Array]:
        rods, stations = (numbers[rows], scale[rows], begin[rows], span[rows]), t[rows].reshape(-1)
        first = n * np.arange(len(rods[0]) + 1)
        marched = march(*rods, BY_ANGLE, first, stations, judge=True, truncation=truncation[:, None])
        with np.errstate(invalid="ignore"):
            condition = np.maximum(1, np.maximum(marched.growth[:, BETA], weight[rows] * marched.growth[:, SPEED]))
            off = np.maximum(marched.errors[:, 0], marched.errors[:, 1] / np.maximum(1, span[rows]))
        error = SAFETY * off + ROUNDING * (condition + span[rows] * scale[rows, SPEED])
        return marched, np.where(np.isfinite(error), error, np.inf), condition

    left_out = np.clip(SHARE * tol / np.maximum(1, span * scale[:, MU]), TRUNCATION, COARSEST)
    marched, error, condition = march_with_errors(slice(None), left_out)
    rows = np.flatnonzero((error > tol) & (left_out > TRUNCATION))
    if rows.size:
        enough = np.maximum(TRUNCATION, 0.2 * left_out[rows] * tol / error[rows])
        finer, error[rows], condition[rows] = march_with_errors(rows, enough)
        marched.out.reshape(SIZE, -1, n)[:, rows] = finer.out.reshape(SIZE, -1, n)
        marched.end[rows], marched.steps[rows] = finer.end, finer.steps
    return marched, error, condition


def answer_ends(case: Case, t: Array, tol: float, seeds: Sequence[Any] | None = None) -> tuple[EndsProblem, Trajectory]:
    """The ends problems at stations t (B, n), each from a seed.

    seeds: of each rod "straight", a shape or None where its seed has none, or the way that is its answer.
    """
    rods = rods_of(case)
    alpha0 = flat(case.given.alpha, case.shape)
    ways = [branch_of(rod) for rod in rods] if seeds is None else list(map(way_to, rods, seeds))
    estimates = [(np.inf, np.inf) if way.shape is None else estimate(way.shape) for way in ways]
    index = np.array([np.nan if way.shape is None or way.shape.rod.has_friction else way.index for way in ways])
    critical = np.array([np.nan if way.buckled is None else way.buckled for way in ways])
    shapes = VaryingShapes([way.shape for way in ways], index, critical)
    begin, end = shapes.ends()
    error, condition = np.array(estimates).T
    read = shapes.read(t, alpha0)
    size = unit_force(case)
    rubbed = case.cylinder.friction
    friction = flat(0.0 if rubbed is None else rubbed, case.shape)
    reasons = zip(ways, size, friction, strict=True)
    why = np.array(["" if way.shape is not None else failure(way, *numbers) for way, *numbers in reasons], dtype=object)
    solved, outcome = verdicts(read["beta"], error, condition, tol).with_failures(why)
    spans = np.array([rod.span for rod in rods])
    problem = EndsProblem(end[:, Q] + end[:, MU], end[:, MU], end[:, PHI], spans, begin[:, BETA], end[:, BETA])
    work = np.array([0 if way.shape is None else way.shape.t.size * way.shape.steps for way in ways])
    begun = np.array([words_of(way) for way in ways], dtype=object)
    outcome = with_undelivered(outcome, solved, case, np.array([rod.numbers for rod in rods]), begin, end)
    if not case.varies:
        read |= {"loads": None, "dead_index": dead_indices(shapes.each(len(rods)))}
    return problem, Trajectory(
        **read,
        solved=solved,
        outcome=outcome,
        error=error,
        condition=condition,
        evaluations=work,
        begun=begun,
        held_index=index,
        shapes=shapes,
    )


def curve_over(case: Case, shape: Shape, name: str, low: float, high: float) -> tuple[NodeCurve, Shape]:
    """The curve of equilibria of a case over one field, from low to high, and a shape of it.

    Raises `InputError` where no rod is computed at an end of the range.
    """
    rod_at = partial(reflect, rod_over(case, name), names=VARYING, low=low, high=high)
    for value in (low, high):
        if why := why_unsolved(rod_at(value), seeded=True):
            raise InputError(f"the equilibrium cannot be followed to {name} = {value:g}: {why}")
    rod = rods_of(case)[0]
    u, scale = densest_nodes((rod_at(low), rod, rod_at(high))), rod.scale
    if not case.varies:  # the loads alone do not say how the shape changes
        u, scale = max(u, shape.t / shape.t[-1], key=len), shape.rod.scale
    return NodeCurve(rod_at, high - low, scale), shape_like(rod, shape, u * rod.span)


def way_of(shape: Shape, index: int) -> GrowthWay:
    """A shape that is known, as a seed of `answer_ends`."""
    return GrowthWay(shape, index, why="seed")


def way_near(guess: Shape) -> GrowthWay:
    """An equilibrium that is known, as a seed of `answer_ends`; one that is not determined is as good as it is."""
    shape = correct(guess) or guess
    return way_of(shape, index_at(shape))


def why_too_rough(friction: float) -> str:
    """Why no shape is computed with a friction of either sign, or nothing."""
    rough = abs(friction)
    if not rough > ROUGHEST:
        return ""
    return (
        f"the coefficient of friction is {rough:g}, and at most {ROUGHEST:g} is computed: in a radian a force grows by "
        f"exp({rough:g})"
    )


def why_unsolved(rod: LoadedRod, seeded: bool = False) -> str:
    """Why no shape of a rod is computed, or nothing; seeded: whether it has a seed."""
    if not SHORTEST < rod.span < LARGEST or not all((abs(v) < LARGEST).all() for v in (rod.numbers, rod.near, rod.far)):
        return (
            "loads, ends or L/rho of a rod with weight, friction or a hinge are beyond 1e30 in units of A and rho, or "
            "L/rho below 1e-15"
        )
    if why := why_too_rough(rod.numbers[3]):
        return why
    height, azimuth = (float(rod.far[k]) if name in rod.held else 0.0 for k, name in ((2, "height"), (1, "azimuth")))
    if why := unreachable(height, azimuth, rod.span, seeded):
        return why
    rubbed = 0.0 if rod.rotates else abs(rod.numbers[3]) * rod.across * rod.span  # of a straight rod, at most
    changes = float(rod.changes(rubbed)[1][-1])
    if not changes > MOST_CHANGES:
        return ""
    may = f"the shape of this rod may change {changes:.3g} times along it"
    return f"{may}, and at most {MOST_CHANGES:,} changes are computed"


def branch_of(rod: LoadedRod) -> GrowthWay:
    """The shape of a rod without a seed."""
    why = why_unsolved(rod)
    return GrowthWay(None, why=why) if why else find_shape(rod)


def way_to(rod: LoadedRod, seed: Any) -> GrowthWay:
    """The shape of a rod that a seed, as of `answer_ends`, means."""
    if isinstance(seed, GrowthWay):
        return seed
    if why := why_unsolved(rod, seeded=True):
        return GrowthWay(None, why=why)
    if isinstance(seed, str):
        if not rod.straight:
            return GrowthWay(None, why="the straight rod is no equilibrium of this case")
        shape = straight_shape(rod, rod.nodes())
        return GrowthWay(shape, index_of_any(shape))
    if seed is None:
        return GrowthWay(None, why="the seed has no shape")
    corrected = correct(shape_like(rod, seed, rod.nodes()))
    if corrected is None:
        return GrowthWay(None, why="Newton's method did not converge from the seed")
    return GrowthWay(corrected, index_of_any(corrected), why="seed")


def failure(way: GrowthWay, size: float, friction: float) -> str:
    """Why a rod has no shape, and with which load or friction it has one. size: of forces."""
    said = f"failed: {way.why}"
    if way.share:
        said += f". There is an answer at least with friction from 0 to {way.share * friction:.3g}"
    if way.limit is None:
        return said
    load = way.limit * size
    if way.share is None:  # locked up
        beyond = f"a tension of more than {load:.4g}" if load > 0 else f"less than {-load:.4g}"
        return f"{said}. It still does with {beyond} at s = L (FZ = {load:.4g})"
    load = round_up(load)
    bound = f"tension above {load:.4g}" if load > 0 else f"compression up to {-load:.4g}"
    return f"{said}. The rod can be straight at least with a {bound} at s = L (FZ = {load:.4g})"


def round_up(load: float) -> float:
    """A load of four digits that is no less."""
    unit = 10.0 ** (np.floor(np.log10(abs(load) or 1.0)) - 3)
    return float(np.ceil(load / unit) * unit)


def unit_force(case: Case) -> Array:
    """A/rho^2 of each rod, (B,) [force]; infinite where it overflows, NaN where A and rho^2 do."""
    with np.errstate(over="ignore", invalid="ignore"):
        return flat(case.rod.bending_stiffness / np.asarray(case.rho) ** 2, case.shape)


def with_undelivered(outcome: Any, solved: Any, case: Case, numbers: Array, begin: Array, end: Array) -> Any:
    """The outcomes (B,), with a remark on each push that friction takes before it reaches the other end.

    The rod slides away from the end that is pushed, and is in tension at the end ahead: something has to pull it there.
    That force is along the way of the rod: F3 where it slides along itself, FZ where it moves as a whole.
    numbers: (B, 7). begin, end: states at both ends, (B, 8).
    """
    forward, sizes = numbers[:, 3] > 0, np.abs(np.stack([begin, end]))[:, :, [Q, PHI]].max(axis=(0, 2))
    whole, slides = numbers[:, 4] == ALONG_AXIS, (numbers[:, 3] != 0) & (numbers[:, 4] != IN_PLACE)
    start, far = (np.where(whole, y[:, PHI], _tangential_force(y)) for y in (begin, end))
    behind, ahead = np.where(forward, start, far), np.where(forward, far, start)
    pushed, pulled = behind < -FAINT * sizes, ahead > FAINT * sizes  # an axial force of a hoop is rounding
    words, size = np.array(outcome, dtype=object), unit_force(case)
    for i in np.flatnonzero(solved & slides & pushed & pulled).tolist():
        first, last = ("0", "L") if forward[i] else ("L", "0")
        load = f"{'FZ' if whole[i] else 'F3'} = {ahead[i] * size[i]:.4g}"
        words[i] = (
            f"{words[i]}; the push at s = {first} does not arrive at s = {last}, where a tension must pull the "
            f"rod ({load})"
        )
    return words


def _tangential_force(y: Array) -> Array:
    """F3 in states (B, 8), in units of A/rho^2, (B,)."""
    beta, mu = y[:, BETA], y[:, MU]
    return surface_forces(circumferential_force(1.0, y[:, Q] + mu, mu, 1.0, beta), y[:, PHI], beta)[1]


def words_of(way: GrowthWay) -> str:
    """How a shape was reached, in words."""
    if way.shape is None:
        return ""
    if way.why == "seed":
        return "the seed"
    said, of = [way.begun], "times them" if way.begun == STRAIGHT else "of the way"
    if way.wound:
        said.append(f"{LEAVES} where its sinusoid would lift off the wall, for a helix")
    if way.buckled is not None:
        said.append(f"which buckles at {way.buckled:.6g} times these loads")
    said += [f"{LEAVES} at {share:.3g} {of} for another shape" for share in way.jumped if share]
    if way.rubbed:
        said.append(f"{RUBS} raises its compression")
    return ", ".join([*said, *([way.why] * bool(way.why))])
