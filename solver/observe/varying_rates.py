"""The derivatives of rods whose loads vary along them.

A change of a field opens the equations of a shape between ends, and the band matrix of Newton's method says how the
states at its nodes answer: the implicit function theorem. What is read of a rod, along it and as an observable, is read
on that line at four places, whose differences are of fourth order, so that no formula is written twice. A start problem
is marched from the four places.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..core.tuning import NUDGE
from ..nodes.banded_newton import largest_turn, linear_at
from ..nodes.loaded_rod import rods_of
from ..nodes.loaded_solutions import answer_ends, answer_starts, way_of
from ..nodes.node_branch import NodeCurve
from ..nodes.varying_shapes import Shape as Nodal
from ..numerics.arrays import NEGLIGIBLE, Array
from ..numerics.roots import EXACT
from ..orbits.shape_arrays import ShapeArrays
from ..problem.case import Case, Start
from ..problem.case_fields import values_of, with_fields_unchecked
from ..problem.dimensionless import flat, size_of_field, span_of
from .observables import observe

# of the angles, in their scales, and of a field, in its size: the fourth root of rounding, for second differences. x10:
# their error of order 2 is 1e-6
STEP = 1e-4
# second differences at two steps over those at one: 4 of a smooth function, so above that nothing has a derivative.
# x10: no number of a rod has one
SMOOTH = 3.0


@dataclass(frozen=True, eq=False)
class _FieldAnswers:
    """How B rods answer a field. size: (B,), of the field. step: (B,), over its size. answers: of the states (N, 8)."""

    name: str
    size: Array
    step: Array
    answers: list[Array | None]


def rates_on_nodes(
    sol: ShapeArrays, fields: Sequence[str], along: Sequence[str], observables: Sequence[str]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """The derivatives of arrays along B rods, (B, F, n), and of observables, (B, F), by name; NaN where there is none.

    The derivative of an observable is NaN as well where a change of either sign changes it by unlike amounts.
    """
    B, F, n = sol.t.shape[0], len(fields), sol.t.shape[1]
    curves, numbers = {name: np.zeros((B, F, n)) for name in along}, {name: np.zeros((B, F)) for name in observables}
    plain = {name: np.reshape(value, -1) for name, value in observe(sol, observables).items()}
    for k, field in enumerate(fields):
        line = _line(sol, field)
        bends: dict[str, list[Array]] = {name: [] for name in observables}
        sizes = {name: np.abs(value) for name, value in plain.items()}
        for count, weight in ((1, 2 / 3), (2, -1 / 12)):  # central differences of order 4
            above, below = (_at_step(sol, line, sign * count) for sign in (1, -1))
            amount = line.step * line.size
            for name in along:
                change = getattr(above, name) - getattr(below, name)
                curves[name][:, k] += weight * change.reshape(B, n) / amount[:, None]
            seen = [observe(values, observables) for values in (above, below)]
            for name in observables:
                high, low = (np.reshape(values[name], -1) for values in seen)
                numbers[name][:, k] += weight * (high - low) / amount
                bends[name].append(np.abs(high + low - 2 * plain[name]))
                sizes[name] = np.maximum(sizes[name], np.abs(high - low))
        for name, (near, far) in bends.items():
            numbers[name][(near > NEGLIGIBLE * sizes[name]) & (far < SMOOTH * near), k] = np.nan
    return curves, numbers


def _line(sol: ShapeArrays, name: str) -> _FieldAnswers:
    """How the rods of a solution answer one field."""
    case = sol.case
    name = {"beta0": "beta", "dbeta0": "dbeta"}.get(name, name) if isinstance(case.given, Start) else name
    size = size_of_field(case, name)
    if isinstance(case.given, Start):
        return _FieldAnswers(name, size, STEP / np.asarray(sol.trajectory.condition), [])
    near = {sign > 0: rods_of(_case_at(case, name, sign * NUDGE * size)) for sign in (1, -1)}
    shapes: Any = sol.trajectory.shapes
    steps: list[float] = []
    answers: list[Array | None] = []
    for i, rod in enumerate(rods_of(case)):
        nodes = shapes.of(i)
        answer = None
        if nodes is not None:
            rod = rod.in_scales(nodes.rod.scale)
            shape = replace(nodes, rod=rod)
            curve = NodeCurve(lambda x, i=i: near[x > 0][i], 1.0, rod.scale)  # type: ignore[misc]
            answer = linear_at(shape).solve(-curve.rate(shape, 0.0)[:, None])
        if answer is None:
            steps.append(STEP)
            answers.append(None)
            continue
        change = answer.reshape(nodes.y.shape)
        steps.append(STEP / max(1.0, largest_turn(change)))
        answers.append(change * rod.scale)
    return _FieldAnswers(name, size, np.array(steps), answers)


def _case_at(case: Case, name: str, change: Array) -> Case:
    """The case with a field changed by (B,)."""
    value: Any = (flat(values_of(case, name), case.shape) + change).reshape(case.shape)[()]
    return with_fields_unchecked(case, {name: value})


def _at_step(sol: ShapeArrays, line: _FieldAnswers, count: int) -> ShapeArrays:
    """The rods after so many steps along their lines, at the same s/L."""
    case = _case_at(sol.case, line.name, count * line.step * line.size)
    t = span_of(case)[:, None] * (sol.t / sol.t[:, -1:])
    known: Any = sol.trajectory
    problem: Any
    if isinstance(case.given, Start):
        problem, trajectory = answer_starts(case, t, sol.tol)
    else:
        ways = []
        for i, rod in enumerate(rods_of(case)):
            nodes, answer, index = known.shapes.of(i), line.answers[i], known.held_index[i]
            y = np.full((2, 8), np.nan) if answer is None else nodes.y + count * line.step[i] * answer
            times = np.array([0.0, rod.span]) if answer is None else nodes.t * (rod.span / nodes.t[-1])
            times[1:-1] *= 1 - EXACT  # so a station at a node is read from it at each step, and not from the one before
            ways.append(way_of(Nodal(rod, times, y), index))
        problem, trajectory = answer_ends(case, t, sol.tol, ways)
    # on the line the equations are open by the square of the step
    trajectory = replace(trajectory, solved=known.solved, error=known.error, condition=known.condition)
    return ShapeArrays(case, problem, trajectory, t, sol.method, sol.tol)
