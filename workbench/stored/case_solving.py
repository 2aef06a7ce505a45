"""How a study solves one case: by which method, and which equilibrium it takes."""

from typing import TYPE_CHECKING, Any

from solver import Case, Ends, Solution, equilibria, observe, solve
from solver.equilibria import Equilibria, nearest
from solver.held.equilibrium_choice import NEAREST, Choose
from solver.problem.errors import DEFAULT_TOLERANCE, InputError, choices
from studies.grammar.axes import Which

if TYPE_CHECKING:
    from studies import Study
    from studies.grammar.axes import Dimensions


def method_of(study: "Study", over: "Dimensions") -> str:
    """The name of the method that solves a study over these axes. Raises `InputError` as `solve` does."""
    from solver.methods import choose_method, free_method, method_on_nodes

    first = study.case_of({name: values[0] for name, values in over.fields.items()})
    if study.variation.from_base:  # the equilibrium is followed by its ends, also where the study gives its start
        first = Case(first.rod, first.cylinder, Ends(0.0, 0.0))
    if study.leaves:
        name = free_method(study.method)
    elif study.varies:
        name = method_on_nodes(first.kind, study.method)
    else:
        name = choose_method(first.kind, study.method).name
    if study.held and name not in ("shooting", "uno"):
        raise InputError(f"method {name!r} needs dead loads and end angles, got {choices(study.held)}; choose shooting")
    return name


def knows_orbit(method: str, batched: bool = False) -> bool:
    """Whether a method knows the orbits of its rods, where numbers are measured; batched: and solves many together."""
    from solver.methods import METHODS

    return method in METHODS and METHODS[method].knows_orbit and (METHODS[method].batched or not batched)


def rule_of(which: Which | None) -> Choose:
    """The rule by which a study takes the equilibrium of a case."""
    return NEAREST if which is None or which.rule is None else which.rule


def which_is(sol: Solution) -> Which:
    """The equilibrium of a solution, as a study names it."""
    return Which(index=None, dbeta0=float(sol.dbeta[0]), energy=float(observe(sol, ["energy"])["energy"]))


def solve_one(
    case: Case,
    which: Which | None,
    tol: float,
    method: str,
    stations: Any,
    let_go: bool = False,
    listed: Equilibria | None = None,
) -> Solution:
    """The solution of a case, or of several; where a study names an equilibrium, that one. Raises `InputError`.

    let_go: whether the cylinder then only pushes; tol is that of the rod let go. listed: all equilibria of the case at
    these stations, where they are known.
    """
    if let_go:
        return solve_one(case, which, DEFAULT_TOLERANCE, "auto", stations, listed=listed).let_go(tol)
    if which is not None and which.dbeta0 is not None and which.energy is not None:
        every = equilibria(case, tol, stations) if listed is None else listed
        if len(every):
            taken = nearest(every, which.dbeta0, which.energy).solution
            return taken if method in ("auto", taken.method) else solve(case, tol, method, stations, seed=taken)
    return solve(case, tol=tol, method=method, stations=stations, choose=rule_of(which))
