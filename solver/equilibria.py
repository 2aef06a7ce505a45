"""Every equilibrium of one ends problem, with its stability."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .branches.given_numbers import Given
from .equilibria_result import Equilibria, Equilibrium, HeldEquilibria, HeldSearch, equilibrium_of, in_order
from .held.energy_minima import is_turned_round
from .held.equilibrium_choice import LOWEST, NEAREST, Choose, HeldSelection, Selection, select
from .held.held_equilibrium import trajectory_between, way_between_hinges
from .held.held_reach import Reached
from .held.held_search import MOST_PERIODS, TRIES, FoundStates, search_equilibria
from .held.held_sweep import ranges_of
from .nodes.loaded_rod import LoadedRod, rods_of
from .nodes.loaded_solutions import answer_ends, way_of, why_unsolved
from .nodes.shape_search import GRID, HEAVIEST, MOST_NODES, FoundShapes, scan_one_unknown, search_shapes
from .nodes.vertical_scan import has_one_unknown
from .numerics.arrays import Array
from .observe.measurement import MeasuredNumbers
from .observe.observables import OBSERVABLES
from .orbits.boundary import repeat
from .orbits.level_search import search_levels
from .orbits.path_orbits import equilibrium_trajectory
from .problem.case import Case, Ends, check_case
from .problem.case_fields import value_of, with_field
from .problem.declared_fields import PAIRS
from .problem.dimensionless import NUMBER_OF, EndsProblem, fields_held, reduce, reduce_held, span_of, value_of_number
from .problem.errors import DEFAULT_TOLERANCE, InputError, check_known, check_tolerance, choices, whole_number
from .problem.field_values import read_range
from .problem.limits import OUT_OF_RANGE, beyond_limits, ends_and_span, reason_beyond, refusals, too_far, units_held
from .problem.trajectory import Trajectory
from .solution import Solution

__all__ = ["Equilibria", "Equilibrium", "equilibria", "meant", "nearest"]

MOST_LISTED = 100_001  # stations of one of them. x10: ten times the memory of each
# times the range around the equilibria that were found. x10: the advice to narrow a range is rarely given
_FAR_WIDER = 2.5
FINE = 801  # stations of an equilibrium without weight, whose shape weight changes. x10: only time
# radii: up to it a list with weight has nearly all that a finer scan finds. x10: lists that miss a fifth say nothing of
# it
SHORT = 10.0


def equilibria(
    case: Case,
    tol: float = DEFAULT_TOLERANCE,
    stations: int = 201,
    most_swings: int | None = None,
    within: Mapping[str, Sequence[float]] | None = None,
    tries: int = TRIES,
    values: int | None = None,
) -> Equilibria:
    """All equilibria of one ends problem; of one with held ends or weight those that a search finds.

    Parameters
    ----------
    case : Case
        A single ends problem. beta(L) counts whole turns: for the same tangent after one turn, give beta(L) + 2 pi.
    tol : float
        Tolerance, as of `solve`.
    stations : int
        Number of stations of each solution.
    most_swings : int, optional
        The largest number of whole periods of beta along the rod; under held ends, along the rods from which the search
        begins. Default: 200, and 8 under held ends.
    within : mapping, optional
        Under held ends, the lowest and the highest value of reactions, for example ``{"FZ": (-50.0, 10.0)}`` with a
        held height. Default: forces and moments of the size that buckles a straight rod into four half waves, more
        where the held displacement needs it; end angles within half a turn of the other one.
    tries : int
        Under held ends, the number of deflations without a new equilibrium after which the search ends.
    values : int, optional
        Under held ends, at how many values of each reaction all equilibria under dead loads are computed. Default: 61
        of one reaction, 13 of each of two, 6, 4 and 3 of three, four and five.

    Returns
    -------
    Equilibria
        A list of `Equilibrium`, lowest energy first. Its `complete` says whether the list passes the test of
        completeness; its `remark` says why not. Of a vertical rod with weight all are listed where its start can be
        scanned finely enough; of other rods with weight never. Under held ends, without weight, `HeldEquilibria`, which
        is never proved complete: its `search` states the ranges and counts.

    Raises
    ------
    InputError
        For a start problem, a grid of cases, `within` that is no range of a reaction of the case, and another argument
        out of its range.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, equilibria
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0)
    >>> found = equilibria(Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, FZ=-8.66)))
    >>> found.complete, [one.index for one in found]
    (True, [0, 0, 1])
    """
    case, tol = check_case("equilibria", case), check_tolerance(tol)
    stations = whole_number("stations", stations, 2, MOST_LISTED)
    tries = whole_number("tries", tries, 0, 10_000)
    if most_swings is not None:
        most_swings = whole_number("most_swings", most_swings, 0, 10_000)
    if values is not None:
        values = whole_number("values", values, 2, 1_000)
    if within is not None and not isinstance(within, Mapping):
        raise InputError(f"within must be a mapping of a reaction to its lowest and highest value, got {within!r}")
    if not isinstance(case.given, Ends):
        raise InputError(f"equilibria needs a Case with Ends, got {type(case.given).__name__}")
    if case.shape:
        raise InputError(f"equilibria takes one case at a time, got a grid of shape {case.shape}")
    if case.varies:
        if within:
            raise InputError("with weight equilibria searches over ranges of its own; leave within out")
        return equilibria_on_nodes(case, tol, stations)
    if fields_held(case):
        swings = MOST_PERIODS if most_swings is None else most_swings
        return _with_held_ends(case, tol, stations, swings, within or {}, tries, values)
    if within:
        raise InputError(f"within takes reactions of held ends, and the case holds none; got {choices(within)}")
    return _under_dead_loads(case, tol, stations, most_swings)


def _under_dead_loads(case: Case, tol: float, stations: int, most_swings: int | None) -> Equilibria:
    """All equilibria of one case under dead loads."""
    problem = reduce(case)
    assert isinstance(problem, EndsProblem)
    if why := refusals(case, problem)[0]:
        return Equilibria([], reason_beyond(why, case))
    equilibria = search_levels(problem) if most_swings is None else search_levels(problem, most_swings)
    if equilibria is None:
        return Equilibria([], "incomplete: no equilibrium was found, and by degree there is always one")
    dbeta0, orbit, K = equilibria.dbeta0, equilibria.orbit, equilibria.dbeta0.size
    wide, index, stray = repeat(problem, K), equilibria.index, equilibria.stray
    t = wide.span[:, None] * np.linspace(0, 1, stations)
    together = equilibrium_trajectory(wide, orbit, t, tol)
    copies = with_field(case, "beta0", np.full(K, value_of(case, "beta0")))
    read = MeasuredNumbers(Solution(copies, wide, together, t, "shooting", tol))
    for name, angle in (("low", equilibria.lowest), ("high", equilibria.highest)):
        read.know({name: (angle, read.error)})
    bends, attached = OBSERVABLES["bends"].compute(read), OBSERVABLES["attached"].compute(read)[0]
    energy = read.unit_moment * equilibria.energy - OBSERVABLES["twist_energy"].compute(read)[0]
    listed = []
    for i in range(K):
        solution = Solution(case, problem, _row_of(together, t, i), t[i : i + 1], "shooting", tol)
        numbers = float(energy[i]), float(dbeta0[i] / case.rho), int(bends[i])
        more = float(attached[i]), float(stray[i]), orbit.paths.take(slice(i, i + 1))
        listed.append(Equilibrium(solution, int(index[i]), *numbers, *more, int(index[i])))
    return Equilibria(in_order(listed), equilibria.remark)


def _row_of(together: Trajectory, t: Array, i: int) -> Trajectory:
    """Row i of a trajectory, with its own orbit."""
    row, orbit = slice(i, i + 1), together.orbit.take(slice(i, i + 1))
    names = ("beta", "dbeta", "alpha", "z", "solved", "outcome", "error", "condition", "evaluations")
    picked = {name: getattr(together, name)[row] for name in names}
    return replace(together, **picked, swirl=partial(orbit.swirl, t[row]), orbit=orbit)


def _with_held_ends(
    case: Case, tol: float, stations: int, most_swings: int, within: Mapping[str, Any], tries: int, values: int | None
) -> HeldEquilibria:
    """The equilibria of a case with held ends that a search over stated ranges finds."""
    number_of = _reactions_of(case)
    for name in within:
        check_known("reaction of this case", name, number_of)
    ranges = {name: read_range(name, ends) for name, ends in within.items()}
    problem = reduce_held(case)
    why = beyond_limits(problem)[0] if units_held(case).all() else OUT_OF_RANGE
    said = reason_beyond(why, case) if why else too_far(*ends_and_span(problem))
    if said:
        return HeldEquilibria([], HeldSearch({}, most_swings, 0, 0, 0, 0, 0, said))
    size = _sizes_of(case)
    bounds = {(k := number_of[name]): (low / size[k], high / size[k]) for name, (low, high) in ranges.items()}
    result = search_equilibria(Given.of(problem), bounds, most_swings, tries, values)
    listed = _list_of_states(case, result, problem.span[:, None] * np.linspace(0, 1, stations), tol)

    def in_units(number: str, some: Collection[float]) -> tuple[float, float]:
        return min(some) * size[number], max(some) * size[number]

    name_of = {number: name for name, number in number_of.items()}
    searched = {name_of[k]: in_units(k, ends) for k, ends in result.ranges.bounds.items()}
    outside = {name_of[k]: in_units(k, [unknowns[k] for unknowns in result.outside]) for k in name_of if result.outside}
    counts = result.problems, result.starts, result.failed, result.tries, len(result.outside)
    whole = result.ranges.turns and len(result.ranges.bounds) == 2 and not result.any_load
    note = _count_between_hinges(listed) if whole else ""
    if result.any_load:
        note = "a straight rod or a helix is an equilibrium under any load and is not listed"
    narrower = _narrower(listed, {name: ends for name, ends in searched.items() if name not in ranges})
    return HeldEquilibria(in_order(listed), HeldSearch(searched, most_swings, *counts, note, outside, narrower))


def _list_of_states(case: Case, result: FoundStates, t: Array, tol: float) -> list[Equilibrium]:
    """The equilibria with held ends that a search found, as it found them, at stations t (1, n)."""
    listed = []
    for state, how in zip(result.states, result.how, strict=True):
        path: Any = state.path.alone
        if case.has_hinge:
            way = way_between_hinges(state, rods_of(case)[0])
            path, answer = way.shape, answer_ends(case, t, tol, [way])
        else:
            answer = state.problem, trajectory_between(Reached(state, how), result.given, t, tol)
        solution = Solution(case, *answer, t, "shooting", tol)
        indices = float(solution.held_index), float(solution.dead_index)
        index, dead = (int(i) if np.isfinite(i) else -1 for i in indices)
        listed.append(equilibrium_of(solution, index, path, dead, how))
    return listed


def _reactions_of(case: Case) -> dict[str, str]:
    """The reactions of a case, and the dimensionless number of each."""
    return {name: NUMBER_OF[name] for held in fields_held(case) for name, other in PAIRS if other == held}


def _sizes_of(case: Case) -> dict[str, float]:
    """A unit of each dimensionless number of the reactions in the units of a case."""
    A, rho = float(case.rod.bending_stiffness), float(case.rho)
    return {number: value_of_number(name, 1.0, A, rho) for name, number in _reactions_of(case).items()}


def default_ranges(case: Case) -> dict[str, tuple[float, float]]:
    """The lowest and the highest value of each reaction over which a case with held ends is searched by default."""
    bounds, size = ranges_of(Given.of(reduce_held(case)), {}, None).bounds, _sizes_of(case)
    ends = {name: [size[k] * end for end in bounds[k]] for name, k in _reactions_of(case).items()}
    return {name: (min(pair), max(pair)) for name, pair in ends.items()}


def _count_between_hinges(listed: list[Equilibrium]) -> str:
    """What the indices of the equilibria between two hinges under given loads tell of their list, or nothing.

    Shapes of one turn of beta are as many as points of a circle, so that by degree they add up to 0.
    """
    count = sum((-1) ** equilibrium.index for equilibrium in listed)
    if not count or any(equilibrium.index < 0 for equilibrium in listed):
        return ""
    return f"counted with (-1)^index they add up to {count}, by degree to 0, so some are missing"


def _narrower(listed: list[Equilibrium], searched: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    """A range around the reactions that were found, for each whose range is far wider."""
    narrower = {}
    for name, (low, high) in searched.items() if listed else ():
        values = [float(equilibrium.solution.reactions[name]) for equilibrium in listed]
        margin = max(0.5 * max(map(abs, values)), 0.02 * (high - low))
        ends = max(min(values) - margin, low), min(max(values) + margin, high)
        if high - low > _FAR_WIDER * (ends[1] - ends[0]):
            narrower[name] = float(f"{ends[0]:.2g}"), float(f"{ends[1]:.2g}")
    return narrower


def nearest(found: list[Equilibrium], dbeta0: float, energy: float) -> Equilibrium:
    """The equilibrium nearest to beta'(0) [rad/length] and energy [force length], each relative to its spread.

    Both are needed: mirror images have the same energy to the last bit, and equilibria that rest near one saddle the
    same slope. Raises `InputError` for an empty list.
    """
    if not found:
        raise InputError("no equilibrium was found for these end angles and loads")
    far = np.zeros(len(found))
    for values, goal in (([e.dbeta0 for e in found], dbeta0), ([e.energy for e in found], energy)):
        far += np.abs(np.array(values) - goal) / (np.ptp(values) or 1.0)
    return found[int(np.argmin(far))]


def meant(found: list[Equilibrium], choose: Choose = NEAREST) -> Equilibrium | None:
    """The equilibrium of a list that the rule `choose` of `solve` takes; None if no equilibrium fits the rule."""
    index, energy, stray, dbeta0 = (
        np.array([getattr(equilibrium, name) for equilibrium in found], dtype=float)
        for name in ("index", "energy", "stray", "dbeta0")
    )
    if isinstance(found, HeldEquilibria):
        stray = _are_turned(found).astype(float)
    i = select(choose, index, energy, stray, dbeta0)
    return None if i is None else found[i]


def choice(found: Equilibria, choose: Choose) -> tuple[Equilibrium | None, Selection]:
    """What `meant` takes of a list, and how."""
    taken = meant(found, choose)
    count, stable = len(found), sum(equilibrium.index == 0 for equilibrium in found)
    if not isinstance(found, HeldEquilibria):
        return taken, Selection(count, stable, choose, found.complete)
    index = np.nan if taken is None or taken.index < 0 else taken.index
    turned = _are_turned(found)
    is_last = taken is None or choose == LOWEST or turned[[equilibrium is taken for equilibrium in found]].any()
    return taken, HeldSelection(count, stable, choose, False, index, 0 if is_last else int(turned.sum()))


def _are_turned(found: list[Equilibrium]) -> NDArray[np.bool_]:
    """Whether a dead force turns each round, of held ends."""
    given = Given.of(reduce_held(found[0].solution.case)) if found else None
    beta = [equilibrium.solution.beta for equilibrium in found]
    return np.array([given is not None and is_turned_round(given, each) for each in beta], dtype=bool)


def without_weight(case: Case) -> Case:
    """A case with the weight of its rod taken away."""
    return Case(
        replace(case.rod, weight=None), replace(case.cylinder, inclination=None), replace(case.given, alpha=0.0)
    )


def equilibria_on_nodes(case: Case, tol: float, stations: int) -> Equilibria:
    """The equilibria of a rod with weight that a search finds. Raises `InputError` for what it does not search."""
    (rod,) = rods_of(case)
    if rod.has_friction:
        raise InputError("equilibria of a rod with friction are not searched for; solve gives one of them")
    if rod.held & {"height", "rotation"}:
        raise InputError(
            "with weight equilibria needs FZ and M3, got a held height or rotation; solve gives one of them"
        )
    if why := why_unsolved(rod):
        return Equilibria([], why)
    scan, is_all = scan_one_unknown(rod) if has_one_unknown(rod) else (None, False)
    if scan is not None and is_all:
        return Equilibria(_list_of_shapes(case, scan, tol, stations))
    follows = not fields_held(case) and rod.nodes().size <= MOST_NODES
    light = equilibria(without_weight(case), tol, FINE) if follows else []
    result = search_shapes(rod, [equilibrium.solution for equilibrium in light], scan)
    remark = _remark_on_search(rod, result, len(light) if follows else None, scan is not None)
    return Equilibria(_list_of_shapes(case, result, tol, stations), remark)


def _remark_on_search(rod: LoadedRod, result: FoundShapes, light: int | None, is_vertical: bool) -> str:
    """What was searched for the equilibria of a rod with weight, and what is known to be missing.

    light: the number of equilibria without weight that were followed; None without that. is_vertical: whether a scan
    might have told all.
    """
    ways = ["from the straight rod"]
    if light is not None:
        ways.append(f"from {light} equilibria without weight, which grows to {HEAVIEST:g} times this one")
    ways += ["by a scan of the start"] * (result.scanned is not None or is_vertical) + ["by deflation"]
    said = [f"not proved complete: searched {', '.join(ways[:-1])}, and {ways[-1]}"]
    if is_vertical:
        said.append("the far end of this vertical rod hangs too finely on its start for a scan that tells all")
    elif not result.scanned:
        said.append(
            f"only rods of at most {GRID.longest:g} radii are scanned, and without the scan lists had 83 of the 203 "
            "equilibria of nine random rods of 14 to 24 radii"
        )
    elif rod.span > SHORT:
        said.append(
            f"beyond {SHORT:g} radii such lists had 231 of the 296 equilibria of ten random rods that a scan four "
            "times as fine found"
        )
    count = sum((-1) ** index for index in result.index)
    ends = rod.held & {"beta0", "betaL"}
    if ends and "azimuth" not in rod.held:
        wrong = "" if count == 1 else ", so some are missing"
        said.append(f"counted with (-1)^index they add up to {count}, by degree to 1{wrong}")
    return "; ".join(said)


def _list_of_shapes(case: Case, result: FoundShapes, tol: float, stations: int) -> list[Equilibrium]:
    """The equilibria of the shapes that a search found, lowest energy first."""
    t = span_of(case)[:, None] * np.linspace(0, 1, stations)
    listed = []
    for shape, index, how in zip(result.shapes, result.index, result.how, strict=True):
        solution = Solution(case, *answer_ends(case, t, tol, [way_of(shape, index)]), t, "shooting", tol)
        listed.append(equilibrium_of(solution, index, shape, -1, how))
    return in_order(listed)
