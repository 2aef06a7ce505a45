"""The motions of the solved cases of a solution: how each orbit answers a unit of its end values and of its loads."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..equilibrium.orbit_rates import helix_change, rates_of_helices, rates_of_variations
from ..equilibrium.system import parts_by_given, settle
from ..levels.line_point import LinePoint, Path, path_of
from ..levels.path_orbits import path_from_start, variations_of
from ..numerics.arrays import Array, Integers
from ..observe.measurement import MIDDLE
from ..orbit import helix_variations
from ..orbit.periodic_orbit import Orbit
from ..orbit.pieces import HELIX
from ..orbit.variations import Change, Place, Variations, change_between, directions, orbits_to_vary, variations_on
from ..problem.held_ends import given_numbers
from ..problem.reduced import EndsProblem, Reduced, StartProblem, flat
from ..shape import Shape

NO_PATH = "failed: no orbit with beta(0) and beta'(0) of this solution ends at beta(L), so it has no derivatives"
_BLOCK = 256  # cases at once
MARKS = np.array([*MIDDLE, 1.0])  # shares of the length that observables need


@dataclass(frozen=True, eq=False)
class VariedOrbits:
    """How b orbits move that are no helices.

    varied: their variations. a0 (b, 5), e (b, 5, 4): the directions as in `orbit.variations`. start, end: the places of
    the two ends, (b,).
    """

    varied: Variations
    a0: Array
    e: Array
    start: Place
    end: Place


@dataclass(frozen=True, eq=False)
class Motion:
    """The motions of b cases, the `rows` of a solution, in five directions.

    The directions of a start problem are a unit of beta(0), of beta_t(0), and of lam, mu and phi, each with the others
    held; those of an ends problem are the five parts of a change of its orbit (`equilibrium.orbit_rates`), the last
    three those of the loads.

    problem: the start problems of the orbits. along: at the stations, (b, n, 5). marks: at the shares `MARKS`
    of the length, (b, 3, 5). ends: of beta_t at the start and at the far end, (b, 2, 5). rate: beta_t at the far end,
    (b,). orbits: what moves; None for helices. parts: (b, 5, 6), how much of each direction a unit of each given number
    of an ends problem makes, and last of the length; None for a start problem.
    """

    rows: Integers
    problem: StartProblem
    along: Change
    marks: Change
    ends: Array
    rate: Array
    orbits: VariedOrbits | None = None
    parts: Array | None = None


def motions(sol: Shape, outcome: Array) -> Iterator[Motion]:
    """The motions of the solved cases, some at a time. outcome: (B,), set where a solved case has none."""
    solved = np.flatnonzero(sol.trajectory.solved)
    if isinstance(sol.problem, EndsProblem):
        for i in solved:
            one = sol.problem.take(slice(i, i + 1))
            path = _path(sol, one, int(i))
            if path is None:
                outcome[i] = NO_PATH
            else:
                yield _of_equilibrium(sol, one, path, int(i))
        return
    for block in (solved[k : k + _BLOCK] for k in range(0, solved.size, _BLOCK)):
        problem = sol.problem.take(block)
        assert isinstance(problem, StartProblem)
        orbit = orbits_to_vary(problem)
        still = orbit.kind == HELIX
        if not still.any():
            yield _of_orbits(sol, block, orbit)
            continue
        yield _of_helices(sol, block[still], problem.take(still))
        if not still.all():
            yield _of_orbits(sol, block[~still], orbits_to_vary(problem.take(~still)))


def _of_orbits(sol: Shape, rows: Integers, orbit: Orbit) -> Motion:
    varied = variations_on(orbit, orbit.arcs)
    return _move(varied, rows, orbit.problem, sol.t[rows], *directions(varied.start))


def _move(varied: Variations, rows: Integers, problem: StartProblem, t: Array, a0: Array, e: Array) -> Motion:
    start, places = varied.start, varied.at(marks_of(problem))
    ends = varied.at(_ends_of(problem))
    along, marks, at_ends = (change_between(start, there, a0, e) for there in (varied.at(t), places, ends))
    end = places.take((slice(None), -1))
    return Motion(rows, problem, along, marks, at_ends.rate, end.v, VariedOrbits(varied, a0, e, start, end))


def marks_of(problem: Reduced) -> Array:
    """t at the shares `MARKS` of the length, (b, 3)."""
    return np.asarray(problem.span[:, None] * MARKS)


def _ends_of(problem: Reduced) -> Array:
    """t at the two ends, (b, 2)."""
    return np.asarray(problem.span[:, None] * np.array([0.0, 1.0]))


def _of_helices(sol: Shape, rows: Integers, problem: StartProblem) -> Motion:
    places = sol.t[rows], marks_of(problem), _ends_of(problem)
    along, marks, ends = (helix_variations.start(problem, t) for t in places)
    return Motion(rows, problem, along, marks, ends.rate, np.zeros(rows.size))


def _of_equilibrium(sol: Shape, one: EndsProblem, path: Path, i: int) -> Motion:
    rows, t = np.array([i]), sol.t[i : i + 1]
    names, ratio = given_numbers(sol.case), float(flat(sol.case.rod.stiffness_ratio, sol.case.shape)[i])
    problem = one.with_start(sol.trajectory.dbeta[i : i + 1, 0])
    if path.helix:
        parts = parts_by_given(rates_of_helices(one), names, ratio)[None]
        along, marks, ends = (helix_change(one, where) for where in (t, marks_of(one), _ends_of(one)))
        return Motion(rows, problem, along, marks, ends.rate, np.zeros(1), parts=parts)
    varied = variations_of(one, path, LinePoint(one))
    parts = parts_by_given(rates_of_variations(one, varied, np.full((3, 1), np.nan)), names, ratio)[None]
    each = np.eye(5)[None]
    return replace(_move(varied, rows, problem, t, each[..., 0], each[..., 1:]), parts=parts)


def _path(sol: Shape, one: EndsProblem, i: int) -> Path | None:
    """The level and the path of the equilibrium of case i; None where no orbit is found that joins the ends."""
    orbit = sol.trajectory.orbit
    if orbit is not None and getattr(orbit, "path", None) is not None:
        return path_of(orbit.path, i)
    path = path_from_start(one, float(sol.trajectory.dbeta[i, 0]))
    if path is None or path.helix:
        return path
    own = settle(one, path)  # the slope is as exact as the method
    return path if isinstance(own, str) else own.path
