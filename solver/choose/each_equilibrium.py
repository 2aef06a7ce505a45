"""One equilibrium of each of B ends problems: near a seed, on the branch of a seed, or by a rule."""

from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..branches.continuation import FOLD, Stopped, resume
from ..core import orbits as core
from ..levels.level_search import Found, search_levels
from ..levels.line_point import path_of
from ..levels.path_orbits import orbit_of, path_from_start
from ..numerics.arrays import Array
from ..orbit.periodic_orbit import TIGHT, Orbit, solve_orbit
from ..orbit.pieces import Arcs, join
from ..problem.reduced import EndsProblem, StartProblem
from ..problem.trajectory import PLAIN, Seed, Trajectory, verdicts, where_shown
from .selection import NEAREST, Choose, none_of, select, selection

NO_EQUILIBRIUM = "failed: the search found no equilibrium, though at least one exists"


def equilibrium_trajectory(problem: EndsProblem, orbit: Orbit, t: Array, tol: float) -> Trajectory:
    """The orbits of K ends problems at stations t (K, n); their error is that of beta(L)."""
    beta, dbeta, alpha, z = orbit.at(t)
    condition = core.response(orbit)[0] if orbit.response is None else orbit.response
    miss = np.abs(orbit.at(problem.span[:, None])[0][:, 0] - problem.betaL)
    error = (2 * miss + 1e-14) * condition
    calls = np.bincount(orbit.panels.arc // 2, weights=orbit.panels.calls, minlength=t.shape[0]).astype(np.int64)
    verdict = verdicts(beta, error, condition, tol)
    return Trajectory(beta, dbeta, alpha, z, partial(orbit.swirl, t), *verdict, error, condition, calls, orbit)


def selection_of(
    problem: EndsProblem, t: Array, tol: float, slope: float | None, choose: Choose = NEAREST
) -> Trajectory | str:
    """The equilibrium of one ends problem with beta_t(0) nearest `slope`, or without `slope` the one of the rule.

    Returns the outcome, a sentence, where there is none.
    """
    known = _search(problem, slope, choose)
    if known is None:
        return NO_EQUILIBRIUM
    if slope is not None:
        return equilibrium_trajectory(problem, known.orbit.take(int(np.argmin(np.abs(known.slope - slope)))), t, tol)
    i = select(choose, known.index, known.energy, known.stray, known.slope)
    if i is None:
        return none_of(choose, known.index, known.total)
    if not isinstance(choose, int) and known.index[i] != 0 and known.remark:  # by degree there is a stable equilibrium
        return f"failed: {known.remark}"
    how = np.array([selection(choose, known.index, known.total, not known.remark)], dtype=object)
    return replace(equilibrium_trajectory(problem, known.orbit.take(i), t, tol), selection=how)


def _search(problem: EndsProblem, slope: float | None, choose: Choose) -> Found | None:
    """The equilibria that the rule needs.

    A stable one has one turning point at most, one of index K at most K + 1, and that of lowest energy is stable.
    """
    if slope is not None:
        return search_levels(problem)
    equilibria = search_levels(problem, most_turns=choose + 1 if isinstance(choose, int) else 1)
    needs_stable = equilibria is None or not (equilibria.index == 0).any()
    return search_levels(problem) if not isinstance(choose, int) and needs_stable else equilibria


def select_seed(
    problem: EndsProblem, choose: Choose = NEAREST, points: int = 2001
) -> tuple[Seed, NDArray[np.object_], list[str]]:
    """The equilibrium of each of B ends problems that the rule takes, as a seed at `points` stations.

    Returns the seed, NaN where there is no equilibrium; (B,) how each was selected; and the outcomes that say why there
    is none, empty where there is one.
    """
    u = np.linspace(0, 1, points)
    taken, why = np.full(problem.size, None, dtype=object), [""] * problem.size
    slopes, shapes = np.full(problem.size, np.nan), np.full((problem.size, points), np.nan)
    for i in range(problem.size):
        single = problem.take(slice(i, i + 1))
        answer = selection_of(single, single.span[:, None] * u, 1e-8, None, choose)
        if isinstance(answer, str):
            why[i] = answer
            continue
        slopes[i], shapes[i] = answer.dbeta[0, 0], answer.beta[0]
        taken[i] = None if answer.selection is None else answer.selection[0]
    return Seed(slopes, np.tile(u, (problem.size, 1)), shapes), taken, why


_ROUNDS = 40


def each_equilibrium(
    problem: EndsProblem, t: Array, tol: float, seed: Seed | None = None, choose: Choose = NEAREST
) -> Trajectory:
    """The answer at the stations t (B, n): the equilibria near `seed`, or by `choose`."""
    if seed is not None and seed.problem is not None:
        return together([_carry(single, t[i : i + 1], tol, seed.take(i)) for i, single in enumerate(_each(problem))], t)
    slopes = np.full(problem.size, np.nan) if seed is None else _next_to(problem, seed.slope)
    near = np.isfinite(slopes)
    if near.all():
        return equilibrium_trajectory(problem, solve_orbit(problem.with_start(slopes), TIGHT), t, tol)
    answers: list[Trajectory | str] = []
    for i, single in enumerate(_each(problem)):
        row = t[i : i + 1]
        if near[i]:
            answers.append(
                equilibrium_trajectory(single, solve_orbit(single.with_start(slopes[i : i + 1]), TIGHT), row, tol)
            )
        else:
            answers.append(selection_of(single, row, tol, None if seed is None else float(seed.slope[i]), choose))
    return together(answers, t)


def _each(problem: EndsProblem) -> list[EndsProblem]:
    """The problems as problems of size 1."""
    return [problem.take(slice(i, i + 1)) for i in range(problem.size)]


def together(found: list[Trajectory | str], t: Array) -> Trajectory:
    """The answers of B problems at t (B, n) as one; a problem without an answer is given by its outcome."""
    if len(found) == 1 and not isinstance(found[0], str):
        return found[0]
    plain = StartProblem(**{field.name: np.array([PLAIN[field.name]]) for field in fields(StartProblem)})
    nothing = solve_orbit(plain, TIGHT)  # the tolerance of the others: the same series
    orbits = [nothing if isinstance(answer, str) else answer.orbit for answer in found]
    orbit = orbits[0] if len(orbits) == 1 else _join_orbits(orbits)
    shown = np.array([not isinstance(answer, str) for answer in found])
    columns = np.full((4, *t.shape), np.nan)
    error, condition = np.full((2, t.shape[0]), np.inf)
    calls, outcome = np.zeros(t.shape[0], dtype=np.int64), np.full(t.shape[0], NO_EQUILIBRIUM, dtype=object)
    solved, taken = np.zeros(t.shape[0], dtype=bool), np.full(t.shape[0], None, dtype=object)
    begun, held = np.full(t.shape[0], None, dtype=object), np.full(t.shape[0], np.nan)
    for i, answer in enumerate(found):
        if isinstance(answer, str):
            outcome[i] = answer
            continue
        columns[:, i] = answer.beta[0], answer.dbeta[0], answer.alpha[0], answer.z[0]
        taken[i] = None if answer.selection is None else answer.selection[0]
        begun[i] = None if answer.begun is None else answer.begun[0]
        held[i] = np.nan if answer.held_index is None else answer.held_index[0]
        error[i], condition[i], calls[i] = answer.error[0], answer.condition[0], answer.evaluations[0]
        solved[i], outcome[i] = answer.solved[0], answer.outcome[0]
    beta, dbeta, alpha, z = columns
    rest = solved, outcome, error, condition, calls, orbit, taken, begun, held
    return Trajectory(beta, dbeta, alpha, z, partial(where_shown, shown[:, None], orbit.swirl, t), *rest)


def _join_orbits(orbits: list[Orbit]) -> Orbit:
    """The orbits of several batches, concatenated."""
    sizes = np.array([orbit.problem.size for orbit in orbits])
    before = np.cumsum(sizes) - sizes
    panels = join([replace(o.panels, arc=o.panels.arc + 2 * k) for o, k in zip(orbits, before, strict=True)])

    def column(name: str) -> Any:
        values = [getattr(orbit, name) for orbit in orbits]
        return None if any(v is None for v in values) else np.concatenate(values)

    fields: dict[str, Any] = {
        name: None if value is None else np.concatenate([getattr(o.problem, name) for o in orbits])
        for name, value in vars(orbits[0].problem).items()
    }
    kind, direction = (np.concatenate([getattr(o.arcs, n) for o in orbits]) for n in ("kind", "direction"))
    arcs = Arcs(kind, direction, orbits[0].arcs.pieces)
    count = column("count")
    rest = (column(name) for name in ("duration", "gain", "lengthens", "response", "passed"))
    return Orbit(StartProblem(**fields), arcs, panels, column("since"), np.cumsum(count) - count, count, *rest)


def _carry(problem: EndsProblem, t: Array, tol: float, seed: Seed) -> Trajectory | str:
    """The equilibrium of one problem on the branch of the seed, or the outcome that says why there is none."""
    assert seed.problem is not None
    path = path_of_seed(seed)
    if path is None:
        return "failed: the seed is not a solution of its own ends problem"
    result = resume(seed.problem, path, problem)
    if isinstance(result, Stopped):
        way = f"{result.share:.2%} of the way from the seed to this case"
        if result.reason == FOLD:
            return f"failed: the branch of the seed ends, at a fold or where it meets another branch, after {way}"
        return f"failed: the branch of the seed could not be followed beyond {way}: {result.reason}"
    return equilibrium_trajectory(problem, orbit_of(problem, result), t, tol)


def path_of_seed(seed: Seed) -> Any:
    """The path of the seed's equilibrium; None if the seed is not an equilibrium."""
    assert seed.problem is not None
    if not np.isfinite(seed.beta[0]).all():
        return None
    if seed.orbit is not None and getattr(seed.orbit, "path", None) is not None:
        return path_of(seed.orbit.path, int(seed.row[0]))
    path = path_from_start(seed.problem, float(seed.slope[0]))
    if path is not None:
        return path
    equilibria = search_levels(seed.problem)
    if equilibria is None:
        return None
    u = seed.problem.span[:, None] * seed.u[:1]
    apart = np.abs(equilibria.orbit.at(np.repeat(u, equilibria.slope.size, axis=0))[0] - seed.beta[:1]).max(axis=1)
    best = int(np.argmin(apart))
    return path_of(equilibria.path, best) if apart[best] < 0.01 else None


def _next_to(problem: EndsProblem, slope: Array) -> Array:
    """beta_t(0) of the solution near a guess, (B,); NaN if Newton's rule does not converge."""
    B = problem.size
    twice = problem.take(np.tile(np.arange(B), 2))
    at = np.where(np.isfinite(slope), slope, 0.0)
    off = np.full(B, np.inf)
    for _ in range(_ROUNDS):
        nudge = 1e-7 * np.maximum(1, np.abs(at))
        orbit = solve_orbit(twice.with_start(np.concatenate([at, at + nudge])), TIGHT)
        end = orbit.at(twice.span[:, None])[0][:, 0]
        off = end[:B] - problem.betaL
        with np.errstate(divide="ignore", invalid="ignore"):
            step = -off / ((end[B:] - end[:B]) / nudge)
        step = np.clip(np.where(np.isfinite(step), step, 0.01), -0.05, 0.05)
        if (np.abs(off) <= 2e-13 * np.maximum(1, np.abs(problem.betaL))).all():
            break
        at = np.where(np.abs(off) <= 2e-13 * np.maximum(1, np.abs(problem.betaL)), at, at + step)
    met = (np.abs(off) <= 1e-10) & np.isfinite(slope) & (np.abs(at - slope) <= 0.1 * (1 + np.abs(slope)))
    return np.where(met, at, np.nan)
