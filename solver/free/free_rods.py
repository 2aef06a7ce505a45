"""The shapes of rods beside a wall that only pushes: from a curve to a minimum on fine enough edges, and its error."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import Array, Integers
from ..problem.case import Case
from ..problem.limits import OUT_OF_RANGE, units_held
from ..problem.reduced import EndsProblem
from ..problem.trajectory import SOLVED, Trajectory
from .beginnings import curve_of, string_curve
from .free_problem import BeginningCurve, Beside, problems_of
from .free_shape import Along, FreeShape
from .minimum import minimise

FREE_TOLERANCE = 1e-4  # of the place of a rod, over its length
FEWEST, EACH = 24, (2.0, 4.0)  # edges of the coarsest mesh: for each length on which the shape changes; for each radian
MOST_EDGES = 16_384
MESHES = 3  # at least, of which each has twice the edges of that before: they say which order the errors have
FINEST = 8192  # edges, up to which a mesh is refined for the tolerance, if errors of order 2 would then be within it
LEAST_STEP = 1 / 64  # of the way of the ends from those of a curve to where they are held
ORDER = (3.0, 5.5)  # of a change to the next one, on edges of half the length: the order 2 is seen
LARGEST = 1e12  # of a number of a rod in units of A and rho
FOUND = "a stable equilibrium, found from {}; others may exist"


@dataclass(frozen=True, eq=False)
class Answer:
    """The shapes of one rod on meshes of twice as many edges each; none where it has none.

    error: of the last one, of a place over the length. steps: in all. begun: from where it was continued. why: why no
    shape was found.
    """

    shapes: tuple[FreeShape, ...] = ()
    error: float = np.inf
    steps: int = 0
    begun: str = ""
    why: str = ""


@dataclass(frozen=True, eq=False)
class FreeRods:
    """The rods of B problems. answers: of each. along: at the stations, (B, n) each, vectors (B, n, 3)."""

    answers: Sequence[Answer]
    along: Along

    def take(self, rows: Integers) -> "FreeRods":
        """The rods of the problems `rows`, (b,)."""
        return FreeRods([self.answers[i] for i in rows], Along(*(part[rows] for part in self.along)))

    @classmethod
    def unknown(cls, size: int, n: int) -> "FreeRods":
        """So many rods without a shape, at n stations."""
        return cls([Answer()] * size, Along(*(np.stack([part] * size) for part in Along.unknown(n))))


def continue_from(beside: Beside, curves: Sequence[BeginningCurve], tol: float) -> Answer:
    """The shape that continues from a curve, of several the one of least energy; of none from the straight rod."""
    rod = beside.rod
    if not curves:
        string = string_curve(rod)
        if isinstance(string, str):
            return Answer(why=string)
        curves = [string]
    changes = beside.changes, max(curve.turning for curve in curves)
    edges = int(max(FEWEST, np.ceil(np.multiply(EACH, changes)).max()))
    if not max(rod.span, 1 / rod.span, *np.abs([*rod.loads, *rod.weight, *rod.radius, rod.tension])) < LARGEST:
        return Answer(why=f"loads, radii or L/rho are beyond {LARGEST:g} in units of A and rho")
    if 2 ** (MESHES - 1) * edges > MOST_EDGES:
        many = f"{max(changes):.3g} times along the rod, and at most {MOST_EDGES} edges are computed"
        return Answer(why=f"the shape may change {many}")
    ways = [reach(beside, curve, edges) for curve in curves]
    steps, best = sum(way.steps for way in ways), min(ways, key=lambda way: way.energy)
    moves = "" if beside.meets(best.curve) else ", whose ends move to where they are held"
    begun = f"{best.curve.name}{moves}{' while its loads grow' * best.curve.grows}"
    if best.share < 1 or best.shape is None:
        return Answer(steps=steps, begun=begun, why=f"no minimum of the energy was found beyond {best.share:.3g} of "
                      f"the way from {begun}")  # fmt: skip
    shapes, error = [best.shape], np.inf
    while len(shapes) < MESHES or tol < error <= tol * (FINEST // shapes[-1].rod.edges) ** 2:
        known = curve_of(shapes[-1])
        finer = beside.rod_on(known, 1.0, 2 * shapes[-1].rod.edges)
        forces = shapes[-1].rod.finer_multipliers(shapes[-1].multipliers)
        minimum = minimise(finer, known.on(finer), beside.sizes(known), forces)
        if minimum is None:
            return Answer(steps=steps, begun=begun, why=f"no minimum of the energy was found on {finer.edges} edges")
        steps += minimum.steps
        shapes.append(FreeShape(finer, minimum.y, minimum.multipliers))
        error = estimate([distance(*pair) for pair in pairwise(shapes[-MESHES:])])[1]
    return Answer(tuple(shapes), error, steps, begun)


class Way(NamedTuple):
    """From a curve to a shape on the coarsest mesh. share: how much of it was gone, 1 to the end. steps: to there."""

    curve: BeginningCurve
    shape: FreeShape | None
    share: float
    steps: int

    @property
    def energy(self) -> float:
        """The energy of the shape; infinite where the way has no end."""
        return np.inf if self.shape is None or self.share < 1 else self.shape.rod.energy(self.shape.y)


def reach(beside: Beside, curve: BeginningCurve, edges: int) -> Way:
    """The way from a curve to the shape of a rod."""
    sizes, steps = beside.sizes(curve), 0
    shape, share, step = None, 0.0, beside.first_step(curve)
    while share < 1:
        ahead = min(1.0, share + step)
        rod = beside.rod_on(curve, ahead, edges)
        minimum = minimise(rod, curve.on(rod) if shape is None else shape.y, sizes)
        if minimum is None:
            step /= 2
            if step < LEAST_STEP:
                break
            continue
        share, steps = ahead, steps + minimum.steps
        shape = FreeShape(rod, minimum.y, minimum.multipliers)
    return Way(curve, shape, share, steps)


def distance(coarse: FreeShape, fine: FreeShape) -> float:
    """The largest distance of common nodes, over the length."""
    return float(np.linalg.norm(fine.x[::2] - coarse.x, axis=1).max()) / fine.rod.span


def estimate(changes: Sequence[float]) -> tuple[float, float]:
    """What is left to the limit, and its error, from the changes of a number on meshes of twice as many edges each.

    Loads are of order 1 where an edge of contact passes from node to node as the ends move.
    """
    if len(changes) > 1 and changes[-1] != 0 and ORDER[0] < changes[-2] / changes[-1] < ORDER[1]:
        return changes[-1] / 3, abs(changes[-1]) / 3
    return 0.0, max(abs(changes[-1]), max(map(abs, changes[:-1]), default=0.0) / 2)


def limit(numbers: Sequence[Array]) -> Array:
    """Numbers (k,) on several meshes, with what is left to the limit."""
    rest = [estimate([after - before for before, after in pairwise(column)])[0] for column in np.array(numbers).T]
    return np.asarray(numbers[-1] + np.array(rest))


def answers_beside(
    case: Case, curves: Sequence[Sequence[BeginningCurve] | str], t: Array, tol: float
) -> tuple[EndsProblem, Trajectory]:
    """The rods of a case, with the dead loads that hold them, at stations t (B, n).

    curves: those from which each may continue, none for a straight rod, or a text that says why there is no shape.
    """
    answers = [
        Answer(why=each) if isinstance(each, str) else continue_from(beside, each, tol)
        for beside, each in zip(problems_of(case), curves, strict=True)
    ]
    return trajectory_of(case, answers, t, tol)


def trajectory_of(case: Case, answers: Sequence[Answer], t: Array, tol: float) -> tuple[EndsProblem, Trajectory]:
    """The dead loads of the answers, and the answers at stations t (B, n)."""
    alongs, loads = [], []
    for answer, times in zip(answers, t, strict=True):
        alongs.append(answer.shapes[-1].at(times) if answer.shapes else Along.unknown(times.size))
        loads.append(limit([shape.far_loads for shape in answer.shapes[-MESHES:]]) if answer.shapes else [np.nan] * 6)
    along = Along(*(np.stack(parts) for parts in zip(*alongs, strict=True)))
    lam, mu, phi, span, first, last = np.array(loads).T
    error = np.array([answer.error for answer in answers])
    why = np.array([answer.why for answer in answers], dtype=object)
    alpha, beta, _, gamma = np.moveaxis(along.turned, 1, 0)
    short = (error > tol) & (why == "")
    words = [
        f"failed: {reason}" if reason else f"{SOLVED}; {FOUND.format(answer.begun)}"
        for reason, answer in zip(why, answers, strict=True)
    ]
    for i in np.flatnonzero(short):
        most = answers[int(i)].shapes[-1].rod.edges
        words[i] = f"failed: error {error[i]:.1e} of the length above the tolerance {tol:.1e} on {most} edges, the most"
    outcome = np.where(units_held(case), np.array(words, dtype=object), OUT_OF_RANGE)
    ratio = np.reshape(np.broadcast_to(case.rod.stiffness_ratio, case.shape), -1)
    solved = (why == "") & ~short & units_held(case)
    return EndsProblem(lam, mu, phi, span, first, last), Trajectory(
        beta=beta, dbeta=along.rate, alpha=alpha - alpha[:, :1], z=along.x[..., 2],
        swirl=partial(np.asarray, (ratio * mu)[:, None] * t - (gamma - gamma[:, :1])),
        solved=solved, outcome=outcome, error=error, condition=np.ones(error.size),
        evaluations=np.array([answer.steps for answer in answers]),
        begun=np.array([answer.begun for answer in answers], dtype=object),
        held_index=np.where(solved, 0.0, np.nan), free=FreeRods(answers, along),
    )  # fmt: skip
