"""From a case to its solution: reduce, run a method, restore the units."""

from dataclasses import fields, replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from .each_case import Answer, Question, answer_each, rows_of
from .free.free_rods import FREE_TOLERANCE, FreeRods, answers_beside
from .free.starting_curves import BILATERAL, bilateral_cases, curves_of
from .held.equilibrium_choice import LOWEST, NEAREST, RULES, Choose, check
from .nodes.constant_loads import shape_of_solution
from .nodes.growth import GrowthWay
from .nodes.loaded_rod import LoadedRod, rods_of
from .nodes.loaded_solutions import answer_ends, answer_starts, branch_of, way_near
from .nodes.varying_shapes import VaryingShapes
from .numerics.arrays import NEGLIGIBLE, Array
from .problem.case import Case, Ends, Start, check_case
from .problem.declared_fields import VARY_LOADS
from .problem.dimensionless import (
    EndsProblem,
    HeldProblem,
    Reduced,
    StartProblem,
    fields_held,
    flat,
    reduce,
    reduce_held,
    span_of,
)
from .problem.errors import DEFAULT_TOLERANCE, InputError, check_tolerance, choices, show, whole_number
from .problem.limits import LARGEST_HELD, LONGEST, OUT_OF_RANGE, beyond, ordinary, refusals, representable
from .problem.trajectory import PLAIN, Seed, Trajectory, blank, stood_in
from .solution import FreeSolution, Solution

if TYPE_CHECKING:
    from .methods import Method

TWO_WAYS = "a seed and choose = {!r} exclude each other: each selects an equilibrium"


def solve(
    case: Case,
    tol: float | None = None,
    method: "str | Method" = "auto",
    stations: Any = 201,
    seed: Any = None,
    choose: Choose = NEAREST,
    **knobs: Any,
) -> Solution:
    """The shape of a case, or of each case of a grid.

    An unsolved case does not affect its neighbours: its `outcome` states the reason.

    Parameters
    ----------
    case : Case
    tol : float, optional
        Tolerance: the error allowed, times max(1, condition), of beta [rad], and of alpha and z/rho over max(1, L/rho);
        default: 1e-8. Of a rod that may leave the cylinder: of its places over its length; default: 1e-4.
    method : str or Method
        "auto", a name of `solver.methods.METHODS`, or a method with its knobs, for example ``Verlet(steps=400)``.
    stations : int or array, (n,) or (*cases, n)
        The number of stations, at equal steps of s; or their values of s [length], rising within [0, L].
    seed : float, array, Solution or "straight", optional
        For an ends problem, which of its equilibria: the one whose beta'(0) is nearest to this value [rad/length], or
        the one that continues from this solution. For held ends a solution. Of a rod with weight or friction: a
        solution of such a rod, or "straight" for the straight rod where it is an equilibrium; default: the branch that
        continues from the straight rod as the loads grow, stable where one is. Of a rod that may leave the cylinder: a
        solution; default: that of the cylinder which holds the rod on, and where there is none, or an end is off the
        wall outside, the straight rod as its loads grow.
    choose : {"nearest", "lowest"} or int
        For an ends problem without a seed, which of its equilibria. "nearest": of the stable ones (of all, if none is
        stable) the one whose beta goes least beyond its end angles. "lowest": the one of
        lowest energy. A number K: among those of Morse index K the one whose beta goes least beyond them. For held
        ends, of those that are found in a bounded time, "nearest": the stable one of least held energy, that of a rod
        which a dead force turns round last; "lowest": the one of least held energy; K: that of Morse index K, among
        those of `equilibria`, which takes seconds. Of a rod that may leave the cylinder, "nearest": the minimum that
        continues from the seed or its default; "lowest": the one of least energy among those that are found from there,
        from the straight rod and beside them, which takes some seconds.
    **knobs
        The knobs of a method given by its name: ``solve(case, method="verlet", steps=400)``.

    Returns
    -------
    Solution
        Its `selection` says how many equilibria there are.

    Raises
    ------
    InputError
        For an invalid tolerance, method, knob, rule, seed or stations.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, Start, solve
    >>> rod, cylinder = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0), Cylinder(R=0.75)
    >>> solution = solve(Case(rod, cylinder, Start(beta=0.5, dbeta=0.5, F3=10.0, M3=0.0)), stations=5)
    >>> print(solution.beta.round(4))
    [ 0.5     5.9763 10.5736 15.1074 19.8569]
    >>> print(solve(Case(rod, cylinder, Ends(beta0=0.5, betaL=0.8, FZ=-8.66, MZ=1.3, M3=6.1))).selection)
    17 equilibria, 3 stable; shown: the stable shape that swings least
    """
    case = check_case("solve", case)
    tol = check_tolerance((FREE_TOLERANCE if case.leaves else DEFAULT_TOLERANCE) if tol is None else tol)
    if isinstance(seed, Solution) and seed.case.shape not in ((), case.shape):
        raise InputError(f"the cases of the seed have shape {seed.case.shape}, those to solve {case.shape or '()'}")
    if case.leaves:
        question_of = _question_beside_wall
    elif case.varies:
        question_of = _question_on_nodes
    else:
        question_of = _question_of_held_ends if fields_held(case) else _question_under_dead_loads
    question = question_of(case, tol, method, knobs, stations, seed, choose)
    kind = FreeSolution if case.leaves else Solution
    return kind(case, *answer_each(question, case, _blank_answer), question.t, question.name, tol)


def _question_under_dead_loads(
    case: Case, tol: float, method: Any, knobs: dict[str, Any], stations: Any, seed: Any, choose: Choose
) -> Question:
    """What is asked of a start problem, or of an ends problem under dead loads."""
    from .methods import choose_method  # only a call of `solve` loads the methods

    whole = reduce(case)
    chosen = choose_method(whole.kind, method, knobs)
    t = _stations(case, whole.span, stations)
    choose = check(choose)
    if isinstance(whole, EndsProblem):
        if seed is not None and choose != NEAREST:
            raise InputError(TWO_WAYS.format(choose))
        seed = None if seed is None else as_seed(case, whole, seed)
    elif seed is not None or choose != NEAREST:
        word = f"choose = {choose!r}" if seed is None else "a seed"
        raise InputError(f"{word} selects an equilibrium of an ends problem; a start problem has only one solution")

    def column(rods: Case, t: Array, seed: Any) -> Answer:
        problem = whole if rods is case else reduce(rods)
        which = {"seed": seed, "choose": choose} if isinstance(problem, EndsProblem) else {}
        return problem, _run(rods, problem, chosen, t, tol, which)

    return Question(column, t, seed, chosen.name)


def _question_beside_wall(
    case: Case, tol: float, method: Any, knobs: dict[str, Any], stations: Any, seed: Any, choose: Choose
) -> Question:
    """What is asked of rods that may leave the cylinder: a minimum of the energy."""
    from .methods import free_method

    name = free_method(method, knobs)
    if check(choose) not in RULES:
        raise InputError(f"choose = {choose!r} needs all equilibria, which are not known with contact='unilateral'")
    if seed is not None and not isinstance(seed, Solution):
        raise InputError(f"seed of a rod that may leave the cylinder is a Solution, got {type(seed).__name__}")
    if seed is not None:
        curves = ["the seed is not solved" if curve is None else [curve] for curve in curves_of(seed, "the seed")]
        seed = curves * (case.size // len(curves))

    def column(rods: Case, t: Array, seed: Any) -> Answer:
        if seed is None:
            off = flat(np.maximum(*rods.end_radii) > (1 + NEGLIGIBLE) * rods.rho, rods.shape)
            begun = [] if off.all() else bilateral_cases(rods)
            twins = [curves_of(solve(twin, stations=2), BILATERAL) for twin in begun]
            seed = [[] if away else [*filter(None, each)] for *each, away in zip(*twins, off, strict=True)]
        return answers_beside(rods, seed, t, tol, lowest=choose == LOWEST)

    return Question(column, _stations(case, span_of(case), stations), seed, name)


def _question_on_nodes(
    case: Case, tol: float, method: Any, knobs: dict[str, Any], stations: Any, seed: Any, choose: Choose
) -> Question:
    """What is asked where loads vary along the rod: by Taylor series; between ends by multiple shooting."""
    from .methods import method_on_nodes

    name = method_on_nodes(case.kind, method, knobs)
    if check(choose) != NEAREST:
        raise InputError(f"choose = {choose!r} needs all equilibria, which are not known with weight or friction")
    straight = isinstance(seed, str) and seed == "straight"
    is_seed = straight or (isinstance(seed, Solution) and seed.trajectory.shapes is not None)
    if seed is not None and (case.kind == "start" or not is_seed):
        raise InputError(
            "seed of a rod with weight or friction is 'straight', or a Solution between ends of such a rod, got "
            f"{seed if isinstance(seed, str | float | int) else type(seed).__name__}"
        )
    t = _stations(case, span_of(case), stations)
    if case.kind == "start":
        return Question(lambda rods, t, _: answer_starts(rods, t, tol), t, None, name)
    if seed is not None:
        seed = case.size * ["straight"] if straight else seed.trajectory.shapes.each(case.size)

    def column(rods: Case, t: Array, seed: Any) -> Answer:
        even = np.flatnonzero((seed is None) & ~_varies(rods))
        if not even.size:
            return answer_ends(rods, t, tol, seed)
        alone = {i: solve(rows_of(rods, np.array([i])), tol, stations=2) for i in even.tolist()}
        ways = [_way_of(alone[i], rod) if i in alone else branch_of(rod) for i, rod in enumerate(rods_of(rods))]
        problem, answer = answer_ends(rods, t, tol, ways)
        how, begun = np.full(rods.size, None, dtype=object), np.array(answer.begun, dtype=object)
        for i, sol in alone.items():
            how[i], begun[i] = (None if said is None else said[0] for said in (sol.selection, sol.begun))
        return problem, replace(answer, selection=how, begun=begun)

    return Question(column, t, seed, name)


def _varies(case: Case) -> Any:
    """Of which rods the loads vary along them, (B,) of bool."""
    loads = [flat(value, case.shape) for _, name, value in case._numeric if name in VARY_LOADS]
    return np.any(np.array(loads) != 0, axis=0)


def _way_of(sol: Solution, rod: LoadedRod) -> GrowthWay:
    """The answer to one rod of a grid without weight and friction, as it is alone, on nodes."""
    if not sol.solved.all():
        return GrowthWay(None, why=str(sol.outcome[0]).removeprefix("failed: "))
    return way_near(shape_of_solution(rod, sol.trajectory, sol.problem, sol.t))


def _question_of_held_ends(
    case: Case, tol: float, method: Any, knobs: dict[str, Any], stations: Any, seed: Any, choose: Choose
) -> Question:
    """What is asked of a case with held ends, whose dead loads are found."""
    from .held.held_equilibrium import each_held, each_hinged
    from .methods import choose_method

    method, names = choose_method("ends", method, knobs), choices(fields_held(case))
    choose = check(choose)
    if method.name != "shooting":
        raise InputError(f"method {method.name!r} needs dead loads and end angles, got {names}; choose shooting")
    if seed is not None and choose != NEAREST:
        raise InputError(TWO_WAYS.format(choose))
    if seed is not None and not isinstance(seed, Solution):
        raise InputError(
            f"seed of a case with {names} must be a Solution, got {seed!r}: beta'(0) leaves its loads open"
        )
    whole = reduce_held(case)
    seed = None if seed is None else as_seed(case, whole, seed)

    @np.errstate(all="ignore")
    def column(rods: Case, t: Array, seed: Seed | None) -> Answer:
        problem = whole if rods is case else reduce_held(rods)
        fit = np.asarray(np.isfinite(t)).all(axis=1, keepdims=True)
        t = np.where(fit, t, np.linspace(0, 1, t.shape[1]))
        if rods.has_hinge:
            dead_problem, answer = each_hinged(rods, problem, t, tol, seed, choose)
        else:
            dead_problem, answer = each_held(problem, t, tol, seed, choose)
        limits = [said if said in (LARGEST_HELD.why, LONGEST.why) else "" for said in answer.outcome]
        why = np.where(representable(rods, dead_problem), limits, OUT_OF_RANGE)
        return dead_problem, _refuse(answer, rods, why)

    return Question(column, _stations(case, whole.span, stations), seed, method.name)


def _run(
    case: Case, problem: StartProblem | EndsProblem, method: Any, t: Array, tol: float, which: dict[str, Any]
) -> Trajectory:
    """The answer of the method; a case whose numbers overflow or underflow gets an outcome that says so."""
    if ordinary(case, problem) and isinstance(problem, StartProblem):
        return method.run_in_blocks(problem, t, tol)
    why = refusals(case, problem)
    fit = why == ""
    if not fit.all():
        t = np.where(fit[:, None], t, np.linspace(0, 1, t.shape[1]))
    if isinstance(problem, StartProblem):
        answer = method.run_in_blocks(stood_in(problem, fit), t, tol)
    else:
        answer = method.run(stood_in(problem, fit), t, tol, **which)
        dbeta0 = np.where(np.isfinite(answer.dbeta[:, 0]), answer.dbeta[:, 0], 0.0)  # beta'(0) is known only now
        why = np.where(fit & ~representable(case, problem.with_start(dbeta0)), OUT_OF_RANGE, why)
    return _refuse(answer, case, why)


def _refuse(answer: Trajectory, case: Case, why: Array) -> Trajectory:
    """The answer without the cases that a limit refuses; why: (B,), "" where none does."""
    fit = why == ""
    return answer if fit.all() else blank(answer, fit, beyond(why, case))


def _blank_answer(case: Case, t: Array, why: Array) -> Answer:
    """Plain problems, and answers of NaN at stations t (B, n), with the outcomes `why` (B,)."""
    B, kind = case.size, StartProblem if case.kind == "start" else EndsProblem
    numbers = {field.name: np.full(B, PLAIN[field.name]) for field in fields(kind)}
    problem = kind(**numbers | {"span": span_of(case)})
    nothing, each, endless = np.full(t.shape, np.nan), np.full(B, np.nan), np.full(B, np.inf)
    verdict = np.zeros(B, dtype=bool), why, endless, endless, np.zeros(B, dtype=np.int64)
    answer = Trajectory(nothing, nothing, nothing, nothing, partial(np.asarray, nothing), *verdict)
    if case.kind == "ends":
        answer = replace(answer, begun=np.full(B, "", dtype=object))
    if case.leaves:
        return problem, replace(answer, free=FreeRods.blank(*t.shape))
    if case.on_nodes:
        answer = replace(answer, shapes=VaryingShapes([None] * B, each, each))
    if case.varies:
        answer = replace(answer, loads=np.full((3, *t.shape), np.nan))
    return problem, answer


def _stations(case: Case, span: Array, stations: Any) -> Array:
    """The stations in units of rho, (B, n); span: L/rho, (B,)."""
    if isinstance(stations, (int, np.integer)) and not isinstance(stations, bool):
        stations = whole_number("stations", stations, 2, 10_000_000)
        with np.errstate(invalid="ignore", over="ignore"):  # overflow of the span is reported in the outcome
            return span[:, None] * _equal_steps(stations)
    try:
        s = np.asarray(stations, dtype=float)
        s = np.broadcast_to(s, (*case.shape, s.shape[-1])).reshape(case.size, -1)
    except (TypeError, ValueError, IndexError):
        shapes = f"(n,) or ({', '.join(map(str, case.shape))}, n)" if case.shape else "(n,)"
        raise InputError(
            f"stations must be a whole number, or values of s of shape {shapes}, got {show(stations)}"
        ) from None
    length = flat(case.rod.L, case.shape)[:, None]
    if not s.size:
        raise InputError("stations is empty; give at least one value of s, or a number of stations")
    inside = np.isfinite(s) & (s >= 0) & (s <= length * (1 + 4e-16))
    if not inside.all() or (np.diff(s, axis=1) < 0).any():
        raise InputError(f"stations must rise within [0, L], L = {length.min()}, got {s.min()} to {s.max()}")
    with np.errstate(all="ignore"):
        return np.minimum(s / flat(case.rho, case.shape)[:, None], span[:, None])


@lru_cache(maxsize=8)
def _equal_steps(stations: int) -> Array:
    """So many numbers from 0 to 1, at equal steps; read-only."""
    steps = np.linspace(0, 1, stations)
    steps.setflags(write=False)
    return steps


def as_seed(case: Case, problem: Reduced | HeldProblem, seed: Any) -> Seed:
    """A seed in units of rho, from beta'(0) [rad/length] or from a solution."""
    if isinstance(seed, Solution):
        trajectory, paths = seed.trajectory, getattr(seed.trajectory.orbit, "paths", None)
        row = np.arange(problem.size) if seed.case.shape else np.zeros(problem.size, dtype=np.int64)
        ends = between_ends(seed).take(row)
        u = seed.t / seed.problem.span[:, None]
        shapes = np.full(problem.size, None, dtype=object)
        shapes[:] = [None] * problem.size if trajectory.shapes is None else trajectory.shapes.each(problem.size)
        paths = None if paths is None else paths.take(row)
        return Seed(trajectory.dbeta[row, 0], u[row], trajectory.beta[row], ends, paths, shapes)
    try:
        with np.errstate(over="ignore"):
            dbeta0 = flat(np.asarray(seed, dtype=float) * case.rho, case.shape)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"seed must be beta'(0) or a Solution, got {show(seed)}") from None
    from .methods import OrbitQuadrature

    assert not isinstance(problem, HeldProblem)
    start = problem.with_start(dbeta0)
    u = np.linspace(0, 1, 2001)
    beta = OrbitQuadrature().run(start, start.span[:, None] * u, 1e-8).beta
    return Seed(dbeta0, np.tile(u, (problem.size, 1)), beta)


def ends_case(sol: Solution) -> Case:
    """The case of a solution between two ends; of a start problem that of its own far angle and its loads."""
    case, given = sol.case, sol.case.given
    if isinstance(given, Ends):
        return case
    far = float(between_ends(sol).betaL[0])
    return Case(case.rod, case.cylinder, Ends(given.beta, far, *case.loads, given.alpha, given.gamma))


def between_ends(sol: Solution) -> EndsProblem:
    """The ends problems that a solution solves; those of a start problem have the far angles of the solution."""
    problem, trajectory = sol.problem, sol.trajectory
    if isinstance(problem, EndsProblem):
        return problem
    far = trajectory.beta[:, -1] if trajectory.orbit is None else trajectory.orbit.far_angle
    return problem.with_end(far)


def own_ends(case: Case) -> Case:
    """The ends problem that the solution of a start problem solves, its loads held.

    Raises
    ------
    InputError
        For an ends problem, a grid of cases, and a start problem that is not solved.
    """
    return ends_case(start_solution(case))


def start_solution(case: Case) -> Solution:
    if not isinstance(case.given, Start) or case.shape:
        raise InputError("follow takes one start problem at a time")
    solution = solve(case, tol=1e-12, stations=2)
    if not solution.solved:
        raise InputError(f"the start problem is not solved: {solution.outcome}")
    return solution
