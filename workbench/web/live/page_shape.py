"""The shape of a state's rod, soon enough for a page: followed, looked for, or refused.

Between two ends a shape follows the one before it where it can; else the rule of `solve` takes one of all equilibria,
or the one that the study names is looked for where they are few. What would take minutes is refused with a sentence.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from solver import Case, Ends, Solution, equilibria, solve
from solver.boundary.selection import NEAREST
from solver.equilibria import meant, nearest
from solver.problem.errors import InputError
from solver.problem.reduced import reduce
from solver.problem.tolerance import DEFAULT_TOLERANCE
from studies import Study
from studies.axes import Which

from ...run.case_input import field_values

TOL, NEAR = DEFAULT_TOLERANCE, 1e-6  # of a shape, and of one that follows another as a slider moves
STATIONS, BETWEEN, MOST = 201, 401, 4001  # given by its start, by its ends, and of a rod of many bends
MOST_SWINGS = 100  # of a rod between two ends whose equilibria are all looked through, in some tenths of a second
MOST_TAKEN = 1000  # of one whose equilibrium is taken by the rule, without a list
SAME = 1e-3  # of itself that beta'(0) may differ from the one that was named
CHORD = 0.4  # rad that the rod may turn from one station to the next before more are taken
STRIDES = (1, 4)  # in how many steps a shape follows another
FOLLOWED = ("E", "nu", "a", "L", "R", "beta0", "betaL", "FZ", "MZ", "M3")


@dataclass(frozen=True, eq=False)
class Shape:
    """A solved rod: study, solution, and how much of the rod is in it (a rod of very many bends is shown in part)."""

    study: Study
    sol: Solution

    @property
    def shown(self) -> float:
        return float(self.sol.s[-1])

    @property
    def whole(self) -> bool:
        return self.shown >= float(self.sol.case.rod.L) * (1 - 1e-9)


def soon(study: Study, near: Solution | None = None) -> Shape | None:
    """The rod of a state where that takes no search: given by its start, or next to a shape; None where it does.

    near: a shape between ends that this one follows, where it can. Raises `InputError` where there is no shape.
    """
    case = study.case()
    if not isinstance(case.given, Ends):
        return _resolved(study, case, solve(case, TOL, stations=STATIONS))
    if near is None or near.problem.kind != "ends":
        return None
    sol = _followed(study, case, near)
    return None if sol is None else Shape(study, sol)


def shape(study: Study, near: Solution | None = None) -> Shape:
    """The rod of a state; between two ends the one next to `near`, or that the study names, or that `solve` takes.

    Raises `InputError` where there is no shape.
    """
    return soon(study, near) or _looked_for(study, near is not None and near.problem.kind == "ends")


def _looked_for(study: Study, lost: bool) -> Shape:
    """The rod between two ends; lost: what the study names is a shape before it, which could not be followed."""
    sol = _between(study, study.case(), lost)
    _check(sol)
    return Shape(study, sol)


def bare(one: Shape) -> Shape:
    """The same shape without what was computed of it since."""
    return Shape(one.study, replace(one.sol))


def portable(one: Shape) -> Shape:
    """The same shape with its arrays alone: it can be sent to another process, and keeps no other shape alive."""
    course = one.sol.trajectory
    arrays = {name: np.array(getattr(course, name)) for name in ("beta", "dbeta", "alpha", "z")}
    kept = replace(course, **arrays, swirl=partial(np.array, course.swirl()))
    return Shape(one.study, replace(one.sol, trajectory=kept))


def searched(study: Study, lost: bool) -> Shape:
    """The rod where `soon` has none, to be sent to another process. Raises `InputError`."""
    return portable(_looked_for(study, lost))


def _resolved(study: Study, case: Case, sol: Solution) -> Shape:
    """The rod from its start at as many stations as its bends need, or the part of it that fits into `MOST`."""
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
    which, swings = study.equilibrium, _swings(case)
    if lost and swings > MOST_SWINGS:
        which = None
    rule = NEAREST if which is None or which.rule is None else which.rule
    if swings > MOST_SWINGS:
        return _of_many(case, which, rule, swings)
    found = equilibria(case, TOL, BETWEEN)
    if not found:
        raise InputError("no equilibrium joins these end angles under these loads")
    if which is not None and which.dbeta0 is not None and which.energy is not None:
        return nearest(found, which.dbeta0, which.energy).solution
    one = meant(found, rule)
    if one is None:
        raise InputError(f"none of the {len(found)} equilibria has index {rule}")
    return one.solution


def _followed(study: Study, case: Case, near: Solution) -> Solution | None:
    """The shape next to another by Newton's rule, in one step or in more; None where it is lost on the way."""
    before, after = field_values(near.case), field_values(case)
    for steps in STRIDES:
        sol: Solution = near
        for k in range(1, steps):
            part = {name: before[name] + (after[name] - before[name]) * k / steps for name in FOLLOWED}
            sol = solve(study.case_of(part), NEAR, "difference", BETWEEN, seed=sol)
            if not sol.solved:
                break
        else:
            sol = solve(case, NEAR, "difference", BETWEEN, seed=sol)
            if sol.solved:
                return sol
    return None


def _of_many(case: Case, which: Which | None, rule: str | int, swings: float) -> Solution:
    """Of more equilibria than are listed the one that the rule takes, or the one of a beta'(0) where it is found."""
    named = which is not None and which.dbeta0 is not None
    if which is not None and named:
        sol = solve(case, NEAR, "difference", BETWEEN, seed=which.dbeta0)
        if sol.solved and _same(sol, which):
            return sol
    if swings <= MOST_TAKEN:
        sol = solve(case, TOL, stations=BETWEEN, choose=rule)
        if which is None or not named or (sol.solved and _same(sol, which)):
            return sol
        raise InputError(f"the equilibrium that is named is not the one taken by default, and {_too_many(swings)}")
    raise InputError(_too_many(swings))


def _same(sol: Solution, which: Which) -> bool:
    assert which.dbeta0 is not None
    found, rho = float(sol.dbeta[0]), float(sol.case.rho)
    return abs(found - which.dbeta0) <= SAME * max(abs(which.dbeta0), NEAR / rho)


def refuse_many(case: Case) -> None:
    """Raise `InputError` where all equilibria of a rod would take the page too long to find."""
    if (swings := _swings(case)) > MOST_SWINGS:
        raise InputError(_too_many(swings))


def _too_many(swings: float) -> str:
    return (
        f"between these ends and under these loads the rod may swing some {swings:.0f} times, and the page looks "
        f"through at most {MOST_SWINGS}: workbench equilibria takes its time"
    )


def _swings(case: Case) -> float:
    """A bound on how often beta can swing: L over the shortest half period that the loads and the cylinder allow."""
    p = reduce(case)
    quickest = np.sqrt(np.abs(p.lam) + 2 * np.abs(p.mu) + np.abs(p.phi) + 1)
    return float(p.span[0] * quickest[0] / np.pi)


def _check(sol: Solution) -> None:
    if not sol.solved:
        raise InputError(f"this rod is not solved: {sol.outcome}")
