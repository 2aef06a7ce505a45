"""The solved rod of a state, fast enough for a page.

Between two ends the rod follows the one before it where that works. Else it is the equilibrium that the study names, or
that the rule of `solve` selects. A search that would take minutes is refused.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from solver import Case, Ends, Solution, solve
from solver.problem.errors import DEFAULT_TOLERANCE, InputError, choices
from solver.problem.reduced import held_of, reduce
from solver.shooting.numbers import rods_of
from studies import Study
from studies.grammar.axes import Which
from studies.language.case_input import field_values

from ...store.case_solutions import rule_of, solve_one

TOL, NEAR = DEFAULT_TOLERANCE, 1e-6  # tolerances of a rod, and of one that follows another as a slider moves
STATIONS, BETWEEN, MOST = 201, 401, 4001  # of a start problem, an ends problem, and a rod with many bends or weight
MOST_LISTED = 100  # half periods of a rod between two ends whose equilibria are all found, in some tenths of a second
MOST_NODES = 1500  # of a rod with weight or friction: a pipe of some 3 km, which takes seconds
SAME = 1e-3  # relative difference that beta'(0) may have from the one that is named
CHORD = 0.4  # rad by which the rod may turn between two stations before more stations are solved
STEPS = (1, 4)  # numbers of steps in which a rod follows another, tried in this order
FOLLOWED = ("E", "nu", "inner_radius", "EI", "GJ", "a", "L", "R", "beta0", "betaL", "FZ", "MZ", "M3")


@dataclass(frozen=True, eq=False)
class Shape:
    """A solved rod: its study and solution. Of a rod with very many bends only the beginning is solved and shown."""

    study: Study
    sol: Solution

    @property
    def shown(self) -> float:
        return float(self.sol.s[-1])

    @property
    def whole(self) -> bool:
        return self.shown >= float(self.sol.case.rod.L) * (1 - 1e-9)


def without_search(study: Study, near: Solution | None = None) -> Shape | None:
    """The rod of a state where that needs no search: a start problem, or a rod next to another; None where it does.

    near: a solution between ends that this one follows, where that works. Raises `InputError` for an unsolved rod.
    """
    case = study.case()
    check_shown(case)
    if not isinstance(case.given, Ends):
        return _resolve(study, case, solve(case, TOL, stations=STATIONS))
    if case.varies or near is None or near.problem.kind != "ends":
        return None
    sol = _follow(study, case, near)
    return None if sol is None else Shape(study, sol)


def check_shown(case: Case) -> None:
    """Raise `InputError` for a case that the page does not show."""
    if not case.varies and (held := held_of(case)):
        raise InputError(f"the live page shows ends under dead loads, got {choices(held)}: use workbench solve")


def shape(study: Study, near: Solution | None = None) -> Shape:
    """The rod of a state; between two ends the one next to `near`, or that the study names, or that `solve` selects.

    Raises `InputError` for an unsolved rod.
    """
    return without_search(study, near) or _search(study, near is not None and near.problem.kind == "ends")


def _search(study: Study, lost: bool) -> Shape:
    """The rod between two ends; lost: the study names the equilibrium of an earlier state, which was not followed."""
    case = study.case()
    sol = _with_weight(case) if case.varies else _between(study, case, lost)
    _check(sol)
    return Shape(study, sol)


def _with_weight(case: Case) -> Solution:
    """The rod that `solve` selects. Raises `InputError` for one so long that the page would wait."""
    nodes = rods_of(case)[0].nodes().size
    if nodes > MOST_NODES:
        raise InputError(
            f"the shape of this rod may change on {nodes} lengths, and the page computes at most {MOST_NODES}: "
            "use workbench solve"
        )
    return solve(case, TOL, stations=MOST)


def bare(one: Shape) -> Shape:
    """The same rod without what was computed of it since."""
    return Shape(one.study, replace(one.sol))


def portable(one: Shape) -> Shape:
    """The same rod with its arrays alone: it can be sent to another process, and holds no other rod in memory."""
    trajectory = one.sol.trajectory
    arrays: dict[str, Any] = {name: np.array(getattr(trajectory, name)) for name in ("beta", "dbeta", "alpha", "z")}
    kept = replace(trajectory, **arrays, swirl=partial(np.array, trajectory.swirl()))
    return Shape(one.study, replace(one.sol, trajectory=kept))


def search(study: Study, lost: bool) -> Shape:
    """The rod where `without_search` has none, to be sent to another process. Raises `InputError`."""
    return portable(_search(study, lost))


def _resolve(study: Study, case: Case, sol: Solution) -> Shape:
    """The start problem at as many stations as its bends need, or the part of the rod that fits into `MOST`."""
    _check(sol)
    turn = float((sol.kappa.max() if sol.kappa.size else 0.0) * sol.s[-1] / (sol.s.size - 1))
    if turn <= CHORD:
        return Shape(study, sol)
    n = int(np.ceil(STATIONS * turn / CHORD))
    length = float(case.rod.L) * min(1.0, MOST / n)
    sol = solve(case, TOL, stations=np.linspace(0.0, length, min(n, MOST)))
    _check(sol)
    return Shape(study, sol)


def _between(study: Study, case: Case, lost: bool) -> Solution:
    which, half_periods = study.equilibrium, _half_periods(case)
    many = half_periods > MOST_LISTED
    if which is None or which.dbeta0 is None or (lost and many):
        return solve(case, TOL, stations=BETWEEN, choose=rule_of(None if lost and many else which))
    near: tuple[dict[str, Any], ...] = ({"seed": which.dbeta0}, {"choose": rule_of(which)})
    for sol in (solve(case, TOL, stations=BETWEEN, **how) for how in near):
        if sol.solved and _same(sol, which):
            return sol
    if many:
        raise InputError(f"the named equilibrium is not the one selected by default, and {_too_many(half_periods)}")
    return solve_one(case, which, TOL, "auto", BETWEEN)


def _follow(study: Study, case: Case, near: Solution) -> Solution | None:
    """The solution next to another by Newton's method, in one step or in more; None where a step fails."""
    before, after = field_values(near.case), field_values(case)
    names = [name for name in FOLLOWED if name in before and name in after]
    for steps in STEPS:
        sol: Solution = near
        for k in range(1, steps):
            part = {name: before[name] + (after[name] - before[name]) * k / steps for name in names}
            sol = solve(study.case_of(part), NEAR, "difference", BETWEEN, seed=sol)
            if not sol.solved:
                break
        else:
            sol = solve(case, NEAR, "difference", BETWEEN, seed=sol)
            if sol.solved:
                return sol
    return None


def _same(sol: Solution, which: Which) -> bool:
    assert which.dbeta0 is not None
    slope, rho = float(sol.dbeta[0]), float(sol.case.rho)
    return abs(slope - which.dbeta0) <= SAME * max(abs(which.dbeta0), NEAR / rho)


def refuse_many(case: Case) -> None:
    """Raise `InputError` where finding all equilibria of a rod would take too long for the page."""
    if case.varies:
        raise InputError("of a rod with weight or friction the page shows the equilibrium of workbench solve alone")
    if (half_periods := _half_periods(case)) > MOST_LISTED:
        raise InputError(_too_many(half_periods))


def _too_many(half_periods: float) -> str:
    return (
        f"between these ends and under these loads beta may have some {half_periods:.0f} half periods, and the page "
        f"searches at most {MOST_LISTED}: use workbench equilibria"
    )


def _half_periods(case: Case) -> float:
    """A bound on the half periods of beta: L over the shortest that the loads and the cylinder allow."""
    p = reduce(case)
    frequency = np.sqrt(np.abs(p.lam) + 2 * np.abs(p.mu) + np.abs(p.phi) + 1)
    return float(p.span[0] * frequency[0] / np.pi)


def _check(sol: Solution) -> None:
    if not sol.solved:
        raise InputError(f"this rod is not solved: {sol.outcome}")
