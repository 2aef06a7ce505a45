"""Equilibria whose ends hold a displacement or give a moment, traced over it from all equilibria under dead loads.

Each equilibrium of the case under dead loads is also one with its own height held, so it is a start. Other branches,
which none of these starts lies on, are not found.
"""

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np

from solver import Branch, Case, Ends, InputError, Solution, equilibria, follow, solve
from solver.equilibria import Equilibrium
from solver.equilibrium.charts import same_equilibrium
from solver.follow import MOST
from solver.levels.line_point import LinePoint, path_of
from solver.problem.case import PAIRS

from .tracing import FINE, Traced, number_pieces

PARTNER = {held: own for own, held in PAIRS}  # height -> FZ
_NEAR = 1e-6  # between the loads of one equilibrium, relative


def trace_held(case: Case, name: str, values: list[float], stations: int, step: Callable[[float], None]) -> Traced:
    """The branches over a held field on which the equilibria of a case under dead loads lie.

    step: called with each value of the field before the branch from it is followed. Raises `InputError` for a value
    that no rod of that length reaches.
    """
    for value in (values[0], values[-1]):
        holding(case, name, value)
    starts = list(equilibria(case, stations=stations))
    own = [own_value(start.solution, name) for start in starts]
    passed = np.union1d([*values, *own], np.linspace(values[0], values[-1], FINE))
    curves, remarks, known = list[Branch](), list[str](), [False] * len(starts)
    for i, one in enumerate(starts):
        if known[i]:
            continue
        step(own[i])
        try:
            held = solve(holding(case, name, own[i]), seed=one.solution, stations=stations)
            branch = follow(held, points=MOST, **{name: passed})
        except InputError as error:
            remarks.append(f"{name} = {own[i]:.6g}: {error}")
            continue
        curves.append(branch)
        known = [
            found or _lies_on(branch, other, own[k]) for k, (found, other) in enumerate(zip(known, starts, strict=True))
        ]
        ends = float(passed[0]), float(passed[-1])
        remarks += [
            f"{name} = {end.value:.6g}: {end.reason}" for end in (branch.begin, branch.end) if end.value not in ends
        ]
    empty = [list[Equilibrium]() for _ in values]
    return number_pieces(empty, [[] for _ in values], curves, remarks)


def holding(case: Case, name: str, value: float) -> Case:
    """The case with a field held or given in place of its partner."""
    given = case.given
    assert isinstance(given, Ends)
    every = {field.name: getattr(given, field.name) for field in fields(given)}
    return replace(case, given=Ends(**{**every, PARTNER[name]: None, name: value}))


def own_value(solution: Solution, name: str) -> float:
    """The value of a displacement or an end moment that a solution has."""
    if name in ("M10", "M1L"):
        return float(solution.M1[0 if name == "M10" else -1])
    along = {"height": solution.z, "azimuth": solution.alpha, "rotation": solution.gamma}[name]
    return float(along[-1] - along[0])


def _lies_on(branch: Branch, one: Equilibrium, value: float) -> bool:
    """Whether a branch passes an equilibrium under dead loads."""
    problem = one.solution.problem
    for point in branch.points:
        if point.value == value:
            pairs = [(getattr(point.problem, load)[0], getattr(problem, load)[0]) for load in ("lam", "mu", "phi")]
            near = all(abs(a - b) < _NEAR * (1 + abs(b)) for a, b in pairs)
            if near and same_equilibrium(LinePoint(point.problem), path_of(one.path, 0), point.path):
                return True
    return False
