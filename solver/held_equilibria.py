"""The equilibria of one case with held ends that a search over stated ranges finds."""

from collections.abc import Collection
from dataclasses import replace
from typing import Any

import numpy as np

from .choose.held_equilibrium import held_trajectory
from .equilibrium.given_numbers import Given, OrbitState
from .equilibrium.held_index import dead_index_of
from .equilibrium_list import Equilibrium, HeldEquilibria, HeldSearch, equilibrium_of, in_order
from .held.held_search import HeldFound, held_search
from .held.held_starts import Reached
from .problem.case import PAIRS, Case
from .problem.errors import InputError, no_such, show
from .problem.limits import OUT_OF_RANGE, beyond, beyond_limits, held_apart, too_far, units_held
from .problem.reduced import NUMBER_OF, held_of, reduce_held, value_of_number
from .solution import Solution

TRIES, MOST_SWINGS = 10, 8
_FAR_WIDER = 2.5  # times the range around the equilibria that were found
_REACTION_OF = {held: field for field, held in PAIRS}
ANY_LOAD = "a straight rod or a helix is an equilibrium under any load and is not listed"


def held_equilibria(
    case: Case,
    tol: float,
    stations: int,
    most_swings: int | None,
    within: dict[str, Any],
    tries: int,
    values: int | None,
) -> HeldEquilibria:
    """The equilibria of a case with held ends; the parameters are those of `equilibria.equilibria`."""
    ranges = _ranges(case, within)
    swings = MOST_SWINGS if most_swings is None else most_swings
    problem = reduce_held(case)
    why = beyond_limits(problem)
    why = why if units_held(case).all() else OUT_OF_RANGE
    said = str(beyond(why, case)[0]).removeprefix("failed: ") if why else ""
    if sentence := said or too_far(*held_apart(problem)):
        return HeldEquilibria([], HeldSearch({}, swings, 0, 0, 0, 0, 0, sentence))
    A, rho = float(case.rod.bending_stiffness), float(case.rho)
    size = {name: value_of_number(name, 1.0, A, rho) for name, _ in PAIRS}  # the unit of each load and angle
    bounds = {NUMBER_OF[name]: (low / size[name], high / size[name]) for name, (low, high) in ranges.items()}
    result = held_search(Given.of(problem), bounds, swings, tries, values)
    t = problem.span[:, None] * np.linspace(0, 1, stations)
    listed = [_equilibrium(case, result.given, *pair, t, tol) for pair in zip(result.states, result.how, strict=True)]
    search = _search_of(result, size, swings)
    return HeldEquilibria(in_order(listed), replace(search, narrower=_narrower(listed, search, ranges)))


def _ranges(case: Case, within: dict[str, Any]) -> dict[str, tuple[float, float]]:
    """The ranges of reactions that are given."""
    reactions = [_REACTION_OF[name] for name in held_of(case)]
    ranges = {}
    for name, ends in within.items():
        if name not in reactions:
            raise no_such("reaction of this case", name, reactions)
        try:
            low, high = (float(end) for end in ends)
        except (TypeError, ValueError, OverflowError):
            raise InputError(
                f"within[{show(name)}] must be two numbers, the lowest and the highest, got {show(ends)}"
            ) from None
        if not (np.isfinite([low, high]).all() and low < high):
            raise InputError(f"within[{show(name)}] must be two finite rising numbers, got {show(ends)}")
        ranges[name] = low, high
    return ranges


def _equilibrium(case: Case, given: Given, state: OrbitState, how: str, t: Any, tol: float) -> Equilibrium:
    """One equilibrium with its shape at stations t (1, n)."""
    trajectory = held_trajectory(Reached(state, how), given, t, tol)
    solution = Solution(case, state.problem, trajectory, t, "shooting", tol)
    index, dead = (int(i) if np.isfinite(i) else -1 for i in (float(solution.held_index), dead_index_of(state)))
    return equilibrium_of(solution, index, state.path.level_path, dead, how)


def _narrower(listed: list[Equilibrium], search: HeldSearch, given: Collection[str]) -> dict[str, tuple[float, float]]:
    """A range around the reactions that were found, for each reaction whose default range is far wider."""
    narrower = {}
    for name, (low, high) in search.within.items():
        if name in given or not listed:
            continue
        values = [float(equilibrium.solution.reactions[name]) for equilibrium in listed]
        margin = max(0.5 * max(map(abs, values)), 0.02 * (high - low))
        ends = max(min(values) - margin, low), min(max(values) + margin, high)
        if high - low > _FAR_WIDER * (ends[1] - ends[0]):
            narrower[name] = float(f"{ends[0]:.2g}"), float(f"{ends[1]:.2g}")
    return narrower


def _search_of(result: HeldFound, size: dict[str, float], swings: int) -> HeldSearch:
    name_of = {NUMBER_OF[field]: field for field, _ in PAIRS}
    bounds = {name_of[number]: ends for number, ends in result.ranges.bounds.items()}
    within = {name: (low * size[name], high * size[name]) for name, (low, high) in bounds.items()}
    outside = {
        name_of[number]: (min(values) * size[name_of[number]], max(values) * size[name_of[number]])
        for number in result.ranges.bounds
        if (values := [numbers[number] for numbers in result.outside])
    }
    counts = result.problems, result.starts, result.failed, result.tries, len(result.outside)
    return HeldSearch(within, swings, *counts, ANY_LOAD if result.any_load else "", outside)
