"""The shapes of rods beside a wall that only pushes: from a curve to a minimum on fine enough edges, and its error."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..numerics.arrays import ALIKE, FAINT, Array, Integers
from ..problem.case import Case
from ..problem.dimensionless import EndsProblem
from ..problem.limits import OUT_OF_RANGE, TAUT, units_held
from ..problem.outcomes import SOLVED, fewer_digits
from ..problem.trajectory import Trajectory
from .free_problem import BeginningCurve, Beside, problems_of
from .free_shape import Along, FreeShape
from .minimum import free_motion, minimise
from .program import Effort
from .starting_curves import curve_of, curve_of_string, is_taut

# of the place of a rod, over its length: finer than a drawing shows. x10: places off by a thousandth of the length
FREE_TOLERANCE = 1e-4
# edges of the coarsest mesh: for each length on which the shape changes; for each radian. x10: time; the digits differ
# within the error
FEWEST, EACH = 24, (2.0, 4.0)
MOST_EDGES = 16_384  # of the finest mesh of a rod. x10: ten times the time before it is refused
# at least, of which each has twice the edges of that before: they say how far limits of order 2 are off. x10: edges by
# the thousand
MESHES = 3
# edges, up to which a mesh is refined for the tolerance, if errors of order 2 would then be within it. x10: ten times
# the time of rods whose tolerance is too small
FINEST = 8192
# of the length: a finer mesh that moves a rod so far leads to another minimum, and meshes count anew. x10: another
# minimum counts as the same
APART = 0.05
GROWTH = 8.0  # steps in which the loads of a rod without loads grow. x10: only time
# of the way of the ends from those of a curve to where they are held. x10: ends that are moved far are given up
LEAST_STEP = 1 / 64
# steps of the search for a rod, for each of its curves, on the coarsest mesh; edges that this counts for at least. x10:
# ten times the time before a search ends without its digits
STEPS, LEAST = 600, 500
LARGEST = 1e12  # of a number of a rod in units of A and rho, far beyond any rod. x10: as good
MOVED = ", moved by some waves"
# of the size of angles: how far a shape is moved from a minimum to find others; twelve times. x10: starts from tangles
SHAKES = (1.0, 0.3) * 6
WAVES = 6  # half waves of the shortest part of such a motion. x10: motions that only straighten again


@dataclass(frozen=True, eq=False)
class FreeAnswer:
    """The shapes of one rod on meshes, each of twice as many edges as the one before; empty where none was found.

    error: of a place on the last shape, over the length; NaN of a rod that moves. steps: of the search, in all. begun:
    from which curve the rod was continued. why: why there is no shape, or no more accurate one. line: the motion that
    leads to other rods of the same energy, "" where there is none. minima: how many were compared; 0 where no others
    were looked for.
    """

    shapes: tuple[FreeShape, ...] = ()
    error: float = np.inf
    steps: int = 0
    begun: str = ""
    why: str = ""
    line: str = ""
    minima: int = 0

    @property
    def energy(self) -> float:
        """The energy of the last shape; infinite where there is none."""
        return self.shapes[-1].rod.energy(self.shapes[-1].y) if self.shapes else np.inf

    def within(self, tol: float) -> bool:
        """Whether there is a shape, with an error within the tolerance, or at least so small that it leaves a shape."""
        return bool(self.shapes) and not self.error > max(tol, APART)

    def outcome(self, tol: float) -> str:
        """Whether the rod is solved, to how many digits, and what its shape is; or why it is not solved."""
        if not self.within(tol):
            leaves = f"error {self.error:.1e} of the length leaves no shape, as " if self.shapes else ""
            return f"failed: {leaves}{self.why}"
        if np.isnan(self.error):
            return f"{SOLVED}; {self.begun}"
        least = ("", "the only minimum ", f"the least of {self.minima} minima ")[min(self.minima, 2)]
        line = self.line and f"; one of a line of equal ones, as {self.line}"
        shape = f"a stable equilibrium, {least}found from {self.begun}{line}; others may exist"
        digits = SOLVED if self.error <= tol else fewer_digits(tol, f"{self.error:.1e} of the length", self.why)
        return f"{digits}; {shape}"


@dataclass(frozen=True, eq=False)
class FreeRods:
    """The rods of B problems. answers: of each. along: at the stations, (B, n) each, vectors (B, n, 3)."""

    answers: Sequence[FreeAnswer]
    along: Along

    def take(self, rows: Integers) -> "FreeRods":
        """The rods of the problems `rows`, (b,)."""
        return FreeRods([self.answers[i] for i in rows], Along(*(part[rows] for part in self.along)))

    @classmethod
    def blank(cls, size: int, n: int) -> "FreeRods":
        """So many rods without a shape, at n stations."""
        return cls([FreeAnswer()] * size, Along(*(np.stack([part] * size) for part in Along.blank(n))))


def continue_from(beside: Beside, curves: Sequence[BeginningCurve], tol: float, lowest: bool = False) -> FreeAnswer:
    """The shape that continues from a curve, of several the one of least energy; without a curve from the straight rod.

    lowest: whether others of less energy are looked for, from the straight rod too, and beside the minima.
    """
    rod = beside.rod
    if is_taut(rod):
        return FreeAnswer(why=TAUT)
    if lowest or not curves:
        string = curve_of_string(rod)
        if isinstance(string, BeginningCurve):
            curves = [*curves, string]
        elif not curves:
            return FreeAnswer(why=string)
    changes = beside.changes, max(curve.total_turn for curve in curves)
    edges = int(max(FEWEST, np.ceil(np.multiply(EACH, changes)).max()))
    if not max(rod.span, 1 / rod.span, *np.abs([*rod.loads, *rod.weight, *rod.radius, rod.tension])) < LARGEST:
        return FreeAnswer(why=f"loads, radii or L/rho are beyond {LARGEST:g} in units of A and rho")
    if 2 ** (MESHES - 1) * edges > MOST_EDGES:
        many = f"{max(changes):.3g} times along the rod, and at most {MOST_EDGES} edges are computed"
        return FreeAnswer(why=f"the shape may change {many}")
    beside = beside._replace(effort=Effort((len(curves) + lowest * len(SHAKES)) * STEPS * max(edges, LEAST)))
    ways = [reach(beside, curve, edges) for curve in curves]
    best = min(ways, key=lambda way: way.energy)
    for seed, far in enumerate(SHAKES if lowest and best.shapes else ()):
        ways += [way_beside(beside, best, far, seed)]
        if best.energy - ways[-1].energy > ALIKE * abs(best.energy):
            best = ways[-1]
    steps = sum(way.steps for way in ways)
    if not best.shapes:
        return replace(best, steps=steps)
    answer = refine(beside, best.shapes[0], tol)
    return replace(answer, steps=steps + answer.steps, begun=best.begun, minima=count_of(ways) if lowest else 0)


def reach(beside: Beside, curve: BeginningCurve, edges: int) -> FreeAnswer:
    """The shape on a coarse mesh to which the way from a curve leads."""
    way = beside.way(curve)
    moves = ", whose ends move to where they are held" * (curve.grows or way >= ALIKE)
    begun = f"{curve.name}{moves}{' while its loads grow' * curve.grows}"
    shape, steps, share, step = None, 0, 0.0, 1 / max(GROWTH if curve.grows else 1.0, np.ceil(way))
    while share < 1:
        ahead = min(1.0, share + step)
        further = beside.minimum(curve, ahead, edges, shape)
        if further is not None:
            share, steps, shape = ahead, steps + further.steps, further
            continue
        step /= 2
        if step < LEAST_STEP:
            why = f"no minimum of the energy was found beyond {share:.3g} of the way from {begun}{beside.effort.why}"
            return FreeAnswer(steps=steps, begun=begun, why=why)
    assert shape is not None
    return FreeAnswer((shape,), steps=steps, begun=begun)


def way_beside(beside: Beside, way: FreeAnswer, far: float, seed: int) -> FreeAnswer:
    """A minimum of the same rod beside one, which is moved by a few half waves; without a shape where none is found."""
    (shape,), begun = way.shapes, way.begun.removesuffix(MOVED) + MOVED
    rod, sizes, y = shape.rod, beside.sizes(curve_of(shape)), shape.y.copy()
    middles, waves = (np.arange(rod.edges)[:, None] + 0.5) / rod.edges, np.arange(1, WAVES + 1)
    parts = np.random.default_rng(seed).normal(size=(WAVES, 4)) / waves[:, None]
    rod.parts(y)[0][:] += far * sizes.turned * np.sin(np.pi * middles * waves) @ parts
    beyond = minimise(rod, y, sizes, effort=beside.effort)
    return FreeAnswer(begun=begun) if beyond is None else FreeAnswer((beyond,), steps=beyond.steps, begun=begun)


def count_of(ways: Sequence[FreeAnswer]) -> int:
    """The number of minima to which ways have led; those of different energy are different."""
    energies = np.sort([way.energy for way in ways if way.shapes])
    # minima whose energies differ by less count as one, as mirror images do
    return 1 + int((np.diff(energies) > ALIKE * np.abs(energies).max()).sum())


def refine(beside: Beside, shape: FreeShape, tol: float) -> FreeAnswer:
    """The minima that continue from a shape on meshes of twice as many edges each, and the error.

    A tolerance that is out of reach leads to the default one. Where a finer mesh has no minimum, or another one, the
    others remain.
    """
    if not shape.rod.lead.any():  # as it was not known before
        shape = beside.minimum(curve_of(shape), 1.0, shape.rod.edges) or shape
    shapes: tuple[FreeShape, ...] = (shape,)
    error, steps, line, why = np.inf, 0, "", f"the tolerance needs a mesh of more than {FINEST} edges"
    aims = np.array([tol, max(tol, FREE_TOLERANCE)])
    while are_few(shapes) or ((aims < error) & (error <= aims * (FINEST // shapes[-1].rod.edges) ** 2)).any():
        curve, edges = curve_of(shapes[-1]), 2 * shapes[-1].rod.edges
        finer = beside.minimum(curve, 1.0, edges)
        anew = edges <= FINEST >> MESHES  # so that finer meshes can tell the error of another minimum
        if finer is None:
            why = f"no minimum of the energy was found on {edges} edges{beside.effort.why}"
            break
        steps += finer.steps
        another = distance(shapes[-1], finer) > APART
        if another and not anew and shapes[1:]:
            why = f"{edges} edges lead to another minimum"
            break
        shapes = (finer,) if another and anew else (*shapes, finer)
        error = error_of(shapes)
        if len(shapes) == MESHES and (motion := free_motion(finer, beside.sizes(curve))) is not None:
            line = shapes[-1].name_of(motion)
    return FreeAnswer(shapes if np.isfinite(error) else (), error, steps, why=why, line=line)


def are_few(shapes: Sequence[FreeShape]) -> bool:
    """Whether shapes tell no error yet: fewer than `MESHES`, or as many, of which the last two differ in contacts."""
    differ = len({len(shape.contacts) for shape in shapes[-2:]}) > 1 and shapes[-1].rod.edges < FINEST
    return len(shapes) < MESHES + differ


def distance(coarse: FreeShape, fine: FreeShape) -> float:
    """The largest distance of common nodes of shapes on as many edges, or on multiples, over the length."""
    common = fine.x[:: fine.rod.edges // coarse.rod.edges]
    return float(np.linalg.norm(common - coarse.x, axis=1).max()) / fine.rod.span


def estimate(numbers: Sequence[Array] | Sequence[float]) -> tuple[Array, Array]:
    """What is left to the limit, and its error, of numbers (...) on meshes of twice as many edges each.

    Errors of order 2 leave a third of the last change, and the limit stays where it is. So by how much it moved from
    mesh to mesh says what else may be left: a fourth of that for each mesh since. The sum is at least what errors of
    any order from 1 to 2 leave, and holds where they change as an edge of contact passes from node to node. Of two
    meshes it is their whole difference; one mesh tells nothing.
    """
    changes = np.diff(numbers, axis=0)
    if not len(changes):
        return np.zeros_like(numbers[0]), np.full_like(numbers[0], np.inf)
    limits = np.asarray(numbers)[1:] + changes / 3
    moves = np.diff(limits, axis=0) if len(limits) > 1 else 2 / 3 * changes
    return changes[-1] / 3, np.abs(changes[-1]) / 3 + largest_left(moves, 4.0)


def largest_left(changes: Array, factor: float) -> Array:
    """The largest size of changes (k, ...) from mesh to mesh, each of them less by a factor for each mesh since."""
    return np.asarray((np.abs(changes).T * factor ** np.arange(1.0 - len(changes), 1.0)).T.max(axis=0))


def error_of(shapes: Sequence[FreeShape]) -> float:
    """The error of the places of the last of several shapes, over the length, from the nodes that all of them have."""
    common = [shape.x[:: shape.rod.edges // shapes[0].rod.edges] for shape in shapes]
    return float(np.linalg.norm(estimate(common)[1], axis=1).max()) / shapes[0].rod.span


def limit(numbers: Sequence[Array]) -> Array:
    """Numbers (k,) on several meshes, with what is left to the limit."""
    return np.asarray(numbers[-1] + estimate(numbers)[0])


def answers_beside(
    case: Case, curves: Sequence[Sequence[BeginningCurve] | str], t: Array, tol: float, lowest: bool = False
) -> tuple[EndsProblem, Trajectory]:
    """The rods of a case, with the dead loads that hold them, at stations t (B, n).

    curves: those from which each may continue, none for a straight rod, or a text that says why there is no shape.
    lowest: as of `continue_from`.
    """
    answers = [
        FreeAnswer(why=each) if isinstance(each, str) else continue_from(beside, each, tol, lowest)
        for beside, each in zip(problems_of(case), curves, strict=True)
    ]
    return trajectory_of(case, answers, t, tol)


def trajectory_of(case: Case, answers: Sequence[FreeAnswer], t: Array, tol: float) -> tuple[EndsProblem, Trajectory]:
    """The dead loads of the answers, and the answers at stations t (B, n)."""
    alongs, loads = [], []
    for answer, times in zip(answers, t, strict=True):
        alongs.append(answer.shapes[-1].at_stations(times) if answer.shapes else Along.blank(times.size))
        loads.append(limit([shape.far_loads for shape in answer.shapes]) if answer.shapes else [np.nan] * 6)
    along = Along(*(np.stack(parts) for parts in zip(*alongs, strict=True)))
    numbers = np.array(loads)
    lam, mu, phi, span, beta0, betaL = np.where(np.abs(numbers) < FAINT, 0.0, numbers).T  # rounding is no load
    error = np.array([answer.error for answer in answers])
    alpha, beta, _, gamma = np.moveaxis(along.turned, 1, 0)
    outcome = np.array([answer.outcome(tol) for answer in answers], dtype=object)
    outcome = np.where(units_held(case), outcome, OUT_OF_RANGE)
    ratio = np.reshape(np.broadcast_to(case.rod.stiffness_ratio, case.shape), -1)
    solved = np.array([answer.within(tol) for answer in answers], dtype=bool) & units_held(case)
    return EndsProblem(lam, mu, phi, span, beta0, betaL), Trajectory(
        beta=beta,
        dbeta=along.rate,
        alpha=alpha - alpha[:, :1],
        z=along.x[..., 2],
        swirl=partial(np.asarray, (ratio * mu)[:, None] * t - (gamma - gamma[:, :1])),
        solved=solved,
        outcome=outcome,
        error=error,
        condition=np.ones(error.size),
        evaluations=np.array([answer.steps for answer in answers]),
        begun=np.array([answer.begun for answer in answers], dtype=object),
        held_index=np.where(solved & np.isfinite(error), 0.0, np.nan),
        free=FreeRods(answers, along),
    )
