"""Follow one equilibrium while one field of its case changes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .branches.branch_events import Bounds, Place, Stop
from .branches.branch_following import branch_through
from .branches.family import end_numbers, exchange, family_of
from .branches.path_correction import settle
from .follow_result import BORDER, HELIX, Branch, BranchEnd, BranchPoint, SpecialPoint
from .held.equilibrium_choice import path_of_seed
from .nodes.constant_loads import end_numbers as end_numbers_of_shape
from .nodes.constant_loads import shape_of_solution
from .nodes.loaded_rod import rods_of
from .nodes.loaded_solutions import answer_ends, curve_over, way_of
from .nodes.node_branch import shapes_through
from .nodes.varying_shapes import Shape
from .numerics.arclength import CLOSED, END, FOLD, POINTS
from .numerics.arrays import Array, whole_turns
from .orbits.boundary import Path
from .orbits.joined_orbits import join_answers
from .orbits.path_orbits import equilibrium_trajectory, orbits_of_paths
from .problem.case import Case, Ends, refuse_leaving
from .problem.case_fields import fields_of, of_quantity, value_of, with_field
from .problem.declared_fields import ANGLES, PAIRS
from .problem.dimensionless import EndsProblem, fields_held, size_of_field, span_of
from .problem.errors import InputError, check_known, check_type, choices, show, whole_number
from .problem.field_values import doubt, in_rad
from .problem.notices import is_called_by_a_program, warn
from .problem.trajectory import Trajectory
from .solution import Solution
from .solve import as_seed, between_ends, ends_case, start_solution

# of the size of a field: the range of a branch, of which a share of 4e-15 is taken for rounding. x10: a field is
# located to 4e-6 of its size only
WIDEST = 1e8
# of the way to the fold: at the fold the condition number is infinite, and half the digits are lost. x10: as good
_BEFORE = 1e-10
_BLOCK = 256  # points of a branch whose shapes are computed together: their orbits take 10 to 100 MB. x10: up to 1 GB
SolvePoint = Callable[[BranchPoint], Solution]


def follow(solution: Solution, *, points: int = POINTS, **field: ArrayLike) -> Branch:
    """Follow an equilibrium while one field changes, through folds.

    The branch is followed by pseudo-arclength continuation, so it goes on where the field turns back. It ends where it
    leaves the range of the values, the value of the solution included; if that lies between the others, the branch is
    followed in both directions.

    Parameters
    ----------
    solution : Solution
        One equilibrium of an ends problem; that of a start problem is taken as one between its own two end angles.
    points : int
        The largest number of points in each direction.
    **field : float or array
        One numeric field of the rod, the cylinder or the ends, with the value or the values that the branch should
        pass: ``FZ=-300.0``, ``L=[10, 20, 40]``; an angle in rad, or text such as ``"30deg"``. A displacement or an end
        moment that the case does not hold is held from then on, in place of its partner: under ``height=4.0`` FZ is
        found. Likewise a load or an end angle in place of what is held.

    Returns
    -------
    Branch
        Its points, its folds and other special points, and why it stops at each end.

    Raises
    ------
    InputError
        For an unsolved solution, a grid of cases, no field or several, an unknown field, and a value that no case can
        have.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, follow, solve
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> solution = solve(Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, FZ=-8.66)))
    >>> branch = follow(solution, FZ=-4.0)
    >>> float(branch.values[-1]), branch.end.reason
    (-4.0, 'the end of the range')
    """
    solution = _check(solution)
    case = ends_case(solution)
    name, goals = _field_and_values(case, field)
    if name not in fields_of(case):
        if case.varies:
            raise InputError(f"with weight or friction follow takes a field that the case gives, got {name}")
        case = exchange(case, _numbers(solution), name)
    bounds = Bounds(*_range(case, name, goals), whole_number("points", points, 1, 10_000_000))
    followed = (_follow_shape if case.on_nodes else _follow_orbit)(solution, case, name, bounds)
    if isinstance(followed, str):
        raise InputError(f"the equilibrium cannot be followed: {followed}")
    solve_point = partial(_solution_at, solution.tol, solution.t[0] / solution.problem.span[0])
    return _branch(case, name, *_without_failures(case, name, solution.tol, *followed), solve_point)


def _range(case: Case, name: str, goals: Array) -> tuple[float, float, tuple[float, ...]]:
    """The lowest and the highest value, and all at which there are to be points."""
    begin = value_of(case, name)
    for value in (float(goals.min()), float(goals.max())):
        with_field(case, name, value)  # raises `InputError`
    low, high = min(begin, float(goals.min())), max(begin, float(goals.max()))
    widest = WIDEST * float(max(size_of_field(case, name)[0], size_of_field(case, name, case.rho)[0]))
    if max(-low, high) > widest:
        far = low if -low > high else high
        raise InputError(
            f"{name} = {far:g} is so far that rounding of the range would hide the branch; give follow values of "
            f"{name} from {-widest:.3g} to {widest:.3g}"
        )
    if low == high:
        raise InputError(f"the solution has {name} = {begin:.10g} already; give follow another value of {name}")
    return low, high, tuple(sorted({begin, *goals.tolist()}))


def _follow_shape(
    solution: Solution, case: Case, name: str, bounds: Bounds
) -> tuple[list[Place], int, Stop, Stop] | str:
    """The branch of a rod with weight, friction or a hinge, or why it cannot be followed."""
    known = shape_of_solution(rods_of(case)[0], solution.trajectory, between_ends(solution), solution.t[0])
    curve, shape = curve_over(case, known, name, bounds.low, bounds.high)
    return shapes_through(curve, shape, value_of(case, name), bounds)


def _follow_orbit(
    solution: Solution, case: Case, name: str, bounds: Bounds
) -> tuple[list[Place], int, Stop, Stop] | str:
    """The branch of any other rod, or why it cannot be followed."""
    begun = between_ends(solution)
    return branch_through(family_of(case, name, begun, bounds), _path(solution), value_of(case, name), bounds)


def _check(solution: object) -> Solution:
    """One solved equilibrium. Raises `InputError`."""
    solution = check_type("follow", solution, Solution, "; give its solution" if hasattr(solution, "solution") else "")
    if solution.case.shape:
        raise InputError(f"follow takes one solution at a time, got a grid of shape {solution.case.shape}")
    refuse_leaving(solution.case.cylinder, "follow")
    if not solution.solved:
        raise InputError(f"follow takes a solved equilibrium; this one is not solved: {solution.outcome}")
    if solution.case.varies and not isinstance(solution.case.given, Ends):
        raise InputError("with weight or friction follow takes a solution between Ends, got that of a start problem")
    return solution


def _path(solution: Solution) -> Path:
    """The path of a solution under its own dead loads, between its own end angles."""
    path = path_of_seed(as_seed(ends_case(solution), between_ends(solution), solution))
    if path is None:
        raise InputError("the solution is not an equilibrium of its own ends problem to 1e-6 rad")
    return path


def _numbers(solution: Solution) -> dict[str, float]:
    """The numbers of a solution by the names of `problem.dimensionless.NUMBER_OF`."""
    if solution.trajectory.shapes is not None:
        return end_numbers_of_shape(solution.trajectory.shapes.of(0))
    return end_numbers(between_ends(solution), _path(solution), float(solution.case.rod.stiffness_ratio))


def _field_and_values(case: Case, field: dict[str, ArrayLike]) -> tuple[str, Array]:
    known = (*fields_of(case), *(name for pair in PAIRS for name in pair if getattr(case.given, name) is None))
    if len(field) != 1:
        got = choices(field) or "none"
        raise InputError(f"follow takes one field with its values, got {got}; choose from {choices(known)}")
    ((given, values),) = field.items()
    name = of_quantity(case, given)
    check_known("field", name, known)
    try:
        read = in_rad(np.array(values, dtype=object)) if name in ANGLES else values
        numbers = np.atleast_1d(np.asarray(read, dtype=float)).ravel()
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be a number or an array of numbers, got {show(values)}") from None
    if not numbers.size or not np.isfinite(numbers).all():
        raise InputError(f"{name} must be one or several finite numbers, got {show(values)}")
    if name in ANGLES and is_called_by_a_program() and (sentence := doubt(name, values)):
        warn(sentence)
    return name, numbers


def _solution_at(tol: float, u: Array, point: BranchPoint) -> Solution:
    """The solution of a point, at stations u = s/L."""
    return _solutions_at([point], point.case, tol, u)


def _solutions_at(points: Sequence[BranchPoint], case: Case, tol: float, u: Array) -> Solution:
    """Points of a branch as one solution of a case with as many rods, at stations u = s/L."""
    if isinstance(points[0].path, Shape):
        t = span_of(case)[:, None] * u
        ways = [way_of(point.path, point.index) for point in points]
        return Solution(case, *answer_ends(case, t, tol, ways), t, "shooting", tol)
    problem = EndsProblem.join([point.problem for point in points])
    t = problem.span[:, None] * u
    blocks = [slice(i, i + _BLOCK) for i in range(0, len(points), _BLOCK)]
    parts = (_shapes(problem.take(rows), points[rows], t[rows], tol) for rows in blocks)
    trajectory = join_answers(parts, t, len(blocks)) if len(blocks) > 1 else next(parts)
    return Solution(case, problem, trajectory, t, "shooting", tol)


def _shapes(problem: EndsProblem, points: Sequence[BranchPoint], t: Array, tol: float) -> Trajectory:
    """The shapes of points of a branch at stations t (N, n); problem: theirs, under dead loads."""
    shapes = equilibrium_trajectory(problem, orbits_of_paths(problem, [point.path for point in points]), t, tol)
    if fields_held(points[0].case):
        shapes = replace(shapes, held_index=np.array([point.index if point.index >= 0 else np.nan for point in points]))
    return shapes


def solutions_of(branch: Branch, stations: int) -> Solution:
    """All points of a branch as one solution over a grid of one axis."""
    return _solutions_over(branch.points, branch.field, branch.points[0].solution.tol, stations)


def _solutions_over(points: Sequence[BranchPoint], name: str, tol: float, stations: int) -> Solution:
    """Points of a branch over a field as one solution over a grid of one axis."""
    case = with_field(points[0].case, name, np.array([point.value for point in points]))
    return _solutions_at(points, case, tol, np.linspace(0, 1, stations))


def _without_failures(
    case: Case, name: str, tol: float, places: list[Place], start: int, begin: Stop, end: Stop
) -> tuple[list[Place], int, Stop, Stop]:
    """The places of a branch that are solved to the tolerance, the number of the first one among them, and why there
    are no more; `start`: its number before.

    Where the branch is steep its field has too few digits for the tolerance: a place that is not solved is first
    corrected at its own value. One that still is not is left out where the branch is solved again behind it: floats
    do not resolve it. Else the branch ends before it. A special point stays: there no case determines its shape.
    """

    def verdict(rows: Sequence[int]) -> Solution:
        points, _ = _points([places[i] for i in rows], case, name, partial(_solution_at, tol, np.zeros(1)))
        return _solutions_over(points, name, tol, 2)

    def stop(i: int, old: Stop) -> Stop:
        why = failed[i].removeprefix("failed: ")
        why = f"the equilibrium found at {name} = {_value_in_words(name, places[i].p)} is not solved: {why}"
        p = float(places[i + (1 if i < start else -1)].p)
        passed = old.helix is not None and min(p, old.p) <= old.helix[0] <= max(p, old.p)
        return Stop(why, p, old.helix if passed else None)

    places, first, last = list(places), 0, len(places)
    plain = np.array([not place.kind for place in places])
    failed: dict[int, str] = {}
    if rows := np.flatnonzero(~verdict(range(last)).solved & plain).tolist():
        for i in rows:
            places[i] = _correction(places[i])
        again = verdict(rows)
        failed = {i: str(why) for i, good, why in zip(rows, again.solved, again.outcome, strict=True) if not good}
    failed.pop(start, None)
    solved = [start, *(i for i in np.flatnonzero(plain).tolist() if i not in failed)]
    if before := [i for i in failed if i < min(solved)]:
        first, begin = before[-1] + 1, stop(before[-1], begin)
    if after := [i for i in failed if i > max(solved)]:
        last, end = after[0], stop(after[0], end)
    kept = [i for i in range(first, last) if i not in failed]
    return [places[i] for i in kept], kept.index(start), begin, end


def _correction(place: Place) -> Place:
    """A place whose orbit is corrected under its own dead loads, where that succeeds."""
    settled = settle(place.problem, place.path) if isinstance(place.path, Path) and not place.path.helix else ""
    return place if isinstance(settled, str) else replace(place, path=settled.path)


def _branch(
    case: Case,
    name: str,
    places: list[Place],
    start: int,
    begin: Stop,
    end: Stop,
    solve_point: SolvePoint,
) -> Branch:
    """The branch of the places over a field, with why there are no more at either end; start: the first one."""
    points, special = _points(places, case, name, solve_point)
    ends = _end(name, begin), _end(name, end)
    if ends[0].kind == HELIX:
        special = (SpecialPoint(HELIX, points[0].value, -1, points[0].index, 0), *special)
    if ends[1].kind == HELIX:
        special = (*special, SpecialPoint(HELIX, points[-1].value, points[-1].index, -1, len(points) - 1))
    return Branch(name, points, special, *ends, start)


def _end(name: str, stop: Stop) -> BranchEnd:
    """Why a branch over a field stops."""
    p = float(stop.p)
    if stop.helix is None:
        kind = {END: BORDER, CLOSED: "closed"}.get(stop.reason, "stopped")
        return BranchEnd(p, stop.reason, kind)
    beta = f"{np.rad2deg(stop.helix[1]):.4g} deg"
    at = _value_in_words(name, stop.helix[0])
    reason = f"the helix of beta = {beta}, along which the rod lies, ceases to exist at {name} = {at}"
    return BranchEnd(p, reason, HELIX)


def _value_in_words(name: str, value: float) -> str:
    """A value of a field in words."""
    return f"{np.rad2deg(value):.10g} deg" if name in ANGLES else f"{value:.10g}"


def _next_index(places: list[Place], fallback: Place) -> int:
    """The index of the first place that is not special and whose index is known, else of the place itself, else -1."""
    ordinary = [place for place in places if not place.kind]
    known = (place.index for place in [*ordinary, fallback] if place.index is not None)
    return next(known, -1)


def _points(
    places: list[Place], case: Case, name: str, solve_point: SolvePoint
) -> tuple[tuple[BranchPoint, ...], tuple[SpecialPoint, ...]]:
    """The points of a branch and the special ones among them."""
    points, special, held = list[BranchPoint](), list[SpecialPoint](), bool(fields_held(case))
    case_at = partial(with_field, case, name)
    for i, place in enumerate(places):
        index = place.index
        if place.kind:
            before, after = _next_index(places[:i][::-1], place), _next_index(places[i + 1 :], place)
            index = min(before, after)
            special.append(SpecialPoint(place.kind, float(place.p), before, after, i))
        known = index if index is not None else _next_index(places[i:] + places[:i][::-1], place)
        problem = place.problem if held else None
        points.append(BranchPoint(float(place.p), known, place.path, problem, case_at, solve_point))
    return tuple(points), tuple(special)


@dataclass(frozen=True, eq=False)
class EndAngleBranch:
    """Equilibria over one field, the other fields of the ends problem held.

    field: its name, for example betaL. values: (count,), from the start problem's own to the limit, or next to the
    fold. dbeta0: (count,), beta'(0) [rad/length]. fold: the value at which the equilibrium ceases to exist;
    fold_dbeta0: beta'(0) there; None where the limit comes before the fold. ends: the ends problems, one case for each
    value.
    """

    field: str
    values: Array
    dbeta0: Array
    fold: float | None
    fold_dbeta0: float | None
    ends: Case


def to_fold(case: Case, limit: float, count: int = 9, field: str = "betaL") -> EndAngleBranch:
    """Follow the equilibrium of a start problem while a field changes to a limit or to the fold before it.

    At the fold d field/d beta'(0) = 0: two equilibria with one value of the field meet there and both end.

    Parameters
    ----------
    case : Case
        One start problem.
    limit : float
        The last value. To an angle beta(L) whole turns are added so that it lies on the rod's own turn of beta.
    count : int
        Number of values.
    field : str
        A numeric field of the rod, the cylinder or the ends problem.

    Raises
    ------
    InputError
        For an ends problem, a grid of cases, fewer than two values, a limit of beta(L) below the rod's own, a limit
        that no case can have, or a branch that cannot be followed.
    """
    if count < 2:
        raise InputError(f"count must be at least 2, got {count}")
    solution = start_solution(case)
    ends = ends_case(solution)
    begin = value_of(ends, field)
    if field == "betaL":
        limit += whole_turns(begin)
        if limit <= begin:
            raise InputError(
                f"the rod itself already ends at beta(L) = {begin:.6g} rad, beyond the limit of {limit:.6g} rad"
            )
    last: dict[str, Any] = {field: limit}
    fold = _fold(follow(solution, **last), limit)
    values = np.linspace(begin, limit if fold is None else fold - _BEFORE * (fold - begin), count)
    every: dict[str, Any] = {field: [*values[1:].tolist(), limit]}
    branch = follow(solution, **every)
    places = [next(i for i, point in enumerate(branch.points) if point.value == value) for value in values.tolist()]
    slopes = np.array([float(branch.points[i].solution.dbeta[0]) for i in places])
    at_fold = None
    if fold is not None:
        place = next(point.position for point in branch.special if point.kind == FOLD)
        at_fold = float(branch.points[place].solution.dbeta[0])
    return EndAngleBranch(field, values, slopes, fold, at_fold, with_field(ends, field, values))


def _fold(branch: Branch, limit: float) -> float | None:
    """The first fold of a branch; None where it reaches the limit before. Raises `InputError` where it does neither."""
    fold = next((point.value for point in branch.special if point.kind == FOLD), None)
    if fold is None and branch.values[-1] != limit:
        name = "beta(L)" if branch.field == "betaL" else branch.field
        raise InputError(f"the branch stops at {name} = {branch.end.value:.6g}: {branch.end.reason}")
    return fold
