"""The force at s = L with which a rod has a force at s = 0: weight and friction lie between them."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from ..nodes.lock_up import PASSED
from ..observe.observables import observe
from ..problem.case import Case
from ..problem.case_fields import value_of, with_field
from ..problem.errors import InputError
from ..solve import solve

# of a search for bounds of the force at s = L; each step is twice as long as the one before. x10: only time
MOST_STEPS = 12
CLOSE, MET = 1e-10, 1e-7  # of the loads: the last step of this search; how well the force at s = 0 is met


def without_friction(FZ0: Any, weight: Any, L: Any, inclination: Any) -> Any:
    """The FZ of a rod without friction whose force at s = 0 is FZ0 [force].

    weight, inclination: None is 0, no weight or a rod that climbs straight up.
    """
    weight, inclination = (np.asarray(0.0 if value is None else value) for value in (weight, inclination))
    return (FZ0 + weight * L * np.cos(inclination))[()]


def with_start_force(case: Case, FZ0: float) -> Case:
    """The case, of one rod, with the FZ that gives it this force at s = 0. Raises `InputError` where none is found."""
    wall = case.cylinder
    case = with_field(case, "FZ", without_friction(FZ0, case.rod.weight, case.rod.L, wall.inclination))
    if not wall.friction:
        return case
    force, why = far_force(case, FZ0)
    if why:
        raise InputError(why.removeprefix("failed: "))
    return with_field(case, "FZ", force)


def far_force(case: Case, near: float, unit: str = "") -> tuple[float, str]:
    """The FZ with which the force at s = 0 is `near`, of one rod; or the given one, and why none was found.

    case: its FZ is where the search begins. near: tension positive [force]. unit: of forces, in words.

    FZ0 grows with FZ. A rod without an answer counts as one whose push at s = 0 has no bound, as that of a rod next to
    lock-up: it needs more tension.
    """
    from scipy.optimize import brentq  # only rods with friction load SciPy's search

    unit = f" {unit}" if unit else ""

    @cache
    def answer(force: float) -> tuple[float, float, str]:
        sol = solve(with_field(case, "FZ", force), stations=2)
        if not sol.solved:
            return -math.inf, math.nan, str(sol.outcome).removeprefix("failed: ")
        seen = observe(sol, ["FZ0", "arriving_max"])
        return float(seen["FZ0"]), float(seen["arriving_max"]), ""

    first = value_of(case, "FZ")
    begun, most, _ = answer(first)
    off, known = abs(begun - near), f"FZ0 = {near:.5g}{unit}"
    if off == 0:
        return first, ""
    if case.cylinder.sense[0] < 0 and near < -most:
        share = f"less than {100 * PASSED:g} % of a change of it arrives at s = 0"
        why = f"locked up. No push at s = L gives {known}: beyond FZ0 = {-most:.5g}{unit} {share}"
        return first, f"failed: {why}"
    loads = abs(near) + abs(first) + abs(case.rod.weight or 0.0) * value_of(case, "L")
    size = loads or (off if off < math.inf else 1.0)

    def excess(force: float) -> float:
        off = answer(force)[0] - near
        return -1.0 if off == -math.inf else off / (abs(off) + size)

    low, high = _bracket(excess, first, off if off < math.inf else size)
    none = f"failed: no FZ was found that gives {known}"
    if not excess(low) <= 0 <= excess(high):
        last = low if excess(low) > 0 else high
        push, _, reason = answer(last)
        said = f"there is no answer: {reason}" if reason else f"it is {push:.5g}{unit}"
        return first, f"{none}: with FZ = {last:.5g}{unit} {said}"
    force = float(brentq(excess, low, high, xtol=CLOSE * size))
    if abs(answer(force)[0] - near) <= MET * size:
        return force, ""
    below, above = (float(force + side * 2 * CLOSE * size) for side in (-1, 1))
    (push, _, reason), other = answer(below), answer(above)[0]
    at = f"FZ = {force:.5g}{unit}"
    if reason:
        return first, f"{none}: it is {other:.5g}{unit} with {at}, next to which there is no answer: {reason}"
    return first, f"{none}: at {at} the shape changes, and FZ0 jumps from {other:.5g} to {push:.5g}{unit}"


def _bracket(excess: Callable[[float], float], first: float, step: float) -> tuple[float, float]:
    """Two forces, from a first one on, between which a rising excess passes 0, if `MOST_STEPS` lead so far."""
    low = high = first
    for _ in range(MOST_STEPS):
        if excess(low) <= 0 <= excess(high):
            break
        low, high = (low - step, low) if excess(low) > 0 else (high, high + step)
        step *= 2
    return low, high
