"""A case on the branch of the one before it along a followed axis; where the branch does not reach it, it has none."""

from dataclasses import replace
from typing import Any

import numpy as np

from solver import Branch, Case, InputError, Solution, follow, solve
from solver.equilibrium_branch import BORDER, HELIX
from solver.numerics.arclength import FOLD
from solver.problem.case_fields import value_of
from studies.grammar.axes import is_angle, quantity_of

BEYOND = "failed: the followed branch"
_STRAIGHT = 1e-6  # rad


def follow_to(before: Solution, case: Case, field: str, neighbour: str) -> Solution:
    """The solution of a case on the branch of another one, which differs in one field; or unsolved, with the reason.

    field: its name in a study. neighbour: its value in the other case, in words.
    """
    if not before.solved:
        said = str(before.outcome)
        first = f"failed: no equilibrium at {neighbour}, from which the axis is followed"
        return _unsolved(before, case, said if said.startswith(BEYOND) else first)
    name = quantity_of(field).name
    value = value_of(case, name)
    wanted: dict[str, Any] = {name: value}
    try:
        branch = follow(before, **wanted)
    except InputError as error:
        return _unsolved(before, case, f"{BEYOND} stops at {neighbour}: {error}")
    if (why := _end(branch, value)) is not None:
        return _unsolved(before, case, why)
    found = solve(case, tol=before.tol, stations=2, seed=branch.points[-1].solution)
    return found if found.solved else _unsolved(before, case, f"{BEYOND} stops before this case: {found.outcome}")


def _end(branch: Branch, value: float) -> str | None:
    """Where and why a branch does not reach a value without turning back; None where it does."""
    for one in branch.special:
        if one.kind == FOLD:
            return f"{BEYOND} ends in a fold at {_said(branch.field, one.value)}"
    if branch.values[-1] == value:
        return None
    far = branch.values[int(np.abs(branch.values - branch.values[0]).argmax())]
    if branch.end.kind == BORDER:  # back at its own value, without a fold
        where = f"a pitchfork at {_said(branch.field, float(far))}"
        turn = next((one for one in branch.special if one.value == far), None)
        beta = np.full(2, np.nan) if turn is None else branch.points[turn.position].solution.beta
        if np.ptp(beta) > _STRAIGHT or not abs(np.sin(beta[0])) < _STRAIGHT:
            return f"{BEYOND} turns back in {where}"
        return f"{BEYOND} ends where the rod becomes straight, in {where}"
    if branch.end.kind == HELIX:
        return f"{BEYOND} ends at {_said(branch.field, branch.end.value)}: {branch.end.reason}"
    return f"{BEYOND} stops at {_said(branch.field, branch.end.value)}: {branch.end.reason}"


def _said(name: str, value: float) -> str:
    return f"{name} = {np.rad2deg(value):.10g} deg" if is_angle(name) else f"{name} = {value:.10g}"


def _unsolved(before: Solution, case: Case, outcome: str) -> Solution:
    """A case without a solution, in the form of that of the case before it."""
    was = before.trajectory
    nothing = np.full(was.beta.shape, np.nan)
    told = replace(
        was,
        beta=nothing,
        dbeta=nothing,
        alpha=nothing,
        z=nothing,
        solved=np.array([False]),
        outcome=np.array([outcome], dtype=object),
        error=np.array([np.inf]),
        condition=np.array([np.inf]),
        orbit=None,
        selection=None,
        held_index=None if was.held_index is None else np.array([np.nan]),
    )
    return replace(before, case=case, trajectory=told)
