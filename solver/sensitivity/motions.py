"""The motions of the solved cases of a solution: how each orbit answers what is given."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..equilibrium.orbit_rates import helix_change, rates_of_helices, rates_of_variations
from ..equilibrium.system import settle
from ..levels.line_point import LinePoint, Path, path_of
from ..levels.path_orbits import path_from_start, variations_of
from ..numerics.arrays import Array, Integers
from ..observe.measurement import MIDDLE
from ..orbit import helix_variations
from ..orbit.variations import Change, Variations
from ..problem.reduced import EndsProblem, Reduced, StartProblem, flat, given_numbers
from ..shape import Shape

NO_PATH = "failed: no orbit with beta(0) and beta'(0) of this solution ends at beta(L), so it has no derivatives"
_BLOCK = 256  # cases at once
MARKS = np.array([0.0, *MIDDLE, 1.0])  # shares of the length that observables need


@dataclass(frozen=True, eq=False)
class Motion:
    """The motions of b cases, the `rows` of a solution.

    problem: the start problems of the orbits. change: the changes at t (b, n) by amounts (b, 5, F) of five directions,
    the parts of a change of an orbit (`orbit.variations`); about helices two of them are others. parts: (b, 5, k), how
    much of each direction a unit of what is given makes: of beta(0), beta_t(0), lam, mu and phi of a start problem
    (k = 5), of the five given numbers of an ends problem and of the length (k = 6). varied: None for helices.
    """

    rows: Integers
    problem: StartProblem
    change: Callable[[Array, Array], Change]
    parts: Array
    varied: Variations | None = None


def of_equilibria(sol: Shape, outcome: Array) -> Iterator[Motion]:
    """The motions of the solved cases of an ends problem. outcome: (B,), set where one of them has none."""
    for i in np.flatnonzero(sol.trajectory.solved):
        problem = sol.problem.take(slice(i, i + 1))
        assert isinstance(problem, EndsProblem)
        path = _path(sol, problem, int(i))
        if path is None:
            outcome[i] = NO_PATH
        else:
            yield _of_equilibrium(sol, problem, path, int(i))


def of_helices(sol: Shape, rows: Integers) -> Iterator[Motion]:
    """The motions of start problems whose orbits are helices, some at a time."""
    for block in (rows[k : k + _BLOCK] for k in range(0, rows.size, _BLOCK)):
        problem = sol.problem.take(block)
        assert isinstance(problem, StartProblem)
        parts = np.broadcast_to(np.eye(5), (block.size, 5, 5))
        yield Motion(block, problem, partial(_helix_change, helix_variations.start, problem), parts)


def marks_of(problem: Reduced) -> Array:
    """t at the shares `MARKS` of the length, (b, 4)."""
    return np.asarray(problem.span[:, None] * MARKS)


def _helix_change(way: Callable[[Any, Array], Change], problem: Any, t: Array, amounts: Array) -> Change:
    by = way(problem, t)
    integrals = np.stack([by.integrals[..., k] @ amounts for k in range(3)], axis=-1)
    return Change(by.beta @ amounts, by.rate @ amounts, integrals)


def _of_equilibrium(sol: Shape, one: EndsProblem, path: Path, i: int) -> Motion:
    rows = np.array([i])
    names, ratio = given_numbers(sol.case), float(flat(sol.case.rod.stiffness_ratio, sol.case.shape)[i])
    problem = one.with_start(sol.trajectory.dbeta[i : i + 1, 0])
    if path.helix:
        parts = rates_of_helices(one).parts(names, ratio)
        return Motion(rows, problem, partial(_helix_change, helix_change, one), parts)
    varied = variations_of(one, path, LinePoint(one))
    parts = rates_of_variations(one, varied).parts(names, ratio)
    return Motion(rows, problem, varied.change, parts, varied)


def _path(sol: Shape, one: EndsProblem, i: int) -> Path | None:
    """The level and the path of the equilibrium of case i; None where no orbit is found that joins the ends."""
    orbit = sol.trajectory.orbit
    if orbit is not None and getattr(orbit, "path", None) is not None:
        return path_of(orbit.path, i)
    path = path_from_start(one, float(sol.trajectory.dbeta[i, 0]))
    if path is None or path.helix:
        return path
    settled = settle(one, path)  # the slope is as exact as the method
    return path if isinstance(settled, str) else settled.path
