"""`shooting`: ends problems by the quadrature of `orbit`, exact to rounding for a rod of any length.

If the seed is a solution, its equilibrium is continued. If it is a number, it means the equilibrium whose slope at the
start is nearest: Newton's rule on the slope finds one that has this slope itself, for all problems at once; else, and
without a seed, the search over levels and paths of `equilibria` is used.
"""

from dataclasses import dataclass

import numpy as np

from ..branches.branch_events import Stop
from ..branches.continuation import resume
from ..held.equilibrium_choice import NEAREST, Choose, path_of_seed, selection_of
from ..numerics.arclength import BRANCH_POINT, FOLD
from ..numerics.arrays import ALIKE, Array
from ..orbits.path_orbits import equilibrium_trajectory, orbit_of, together
from ..orbits.periodic_orbit import TIGHT, solve_orbit
from ..problem.dimensionless import EndsProblem
from ..problem.trajectory import Seed, Trajectory
from .method import EndsMethod, Ladder, tens


@dataclass(frozen=True)
class Shooting(EndsMethod):
    """The orbit of the right length; it has no knobs."""

    name = "shooting"
    summary = "the level at which the orbit's length is the rod's"
    order = float("inf")
    knows_orbit = True
    ladders = (Ladder("shooting", "tol", tens(2, 13, 2), "#009e9e", "o", bold=True),)

    def run(
        self, problem: EndsProblem, t: Array, tol: float, seed: Seed | None = None, choose: Choose = NEAREST
    ) -> Trajectory:
        if seed is not None and seed.problem is not None:
            rows = [slice(i, i + 1) for i in range(problem.size)]
            return together([_carry(problem.take(row), t[row], tol, seed.take(row)) for row in rows], t)
        starts = np.full(problem.size, np.nan) if seed is None else _next_to(problem, seed.dbeta0)
        near = np.isfinite(starts)
        if near.all():
            return equilibrium_trajectory(problem, solve_orbit(problem.with_start(starts), TIGHT), t, tol)
        answers: list[Trajectory | str] = []
        for i in range(problem.size):
            row = slice(i, i + 1)
            single = problem.take(row)
            if near[i]:
                orbit = solve_orbit(single.with_start(starts[row]), TIGHT)
                answers.append(equilibrium_trajectory(single, orbit, t[row], tol))
            else:
                dbeta0 = None if seed is None else float(seed.dbeta0[i])
                answers.append(selection_of(single, t[row], tol, dbeta0, choose))
        return together(answers, t)


def _carry(problem: EndsProblem, t: Array, tol: float, seed: Seed) -> Trajectory | str:
    """The equilibrium of one problem on the branch of the seed, or the outcome that says why there is none."""
    assert seed.problem is not None
    path = path_of_seed(seed)
    if path is None:
        return "failed: the seed is not a solution of its own ends problem"
    resumed = resume(seed.problem, path, problem)
    if isinstance(resumed, Stop):
        way = f"{resumed.p:.2%} of the way from the seed to this case"
        if resumed.reason in (FOLD, BRANCH_POINT):
            return f"failed: the branch of the seed ends, at a fold or where it meets another branch, after {way}"
        return f"failed: the branch of the seed could not be followed beyond {way}: {resumed.reason}"
    return equilibrium_trajectory(problem, orbit_of(problem, resumed), t, tol)


def _next_to(problem: EndsProblem, dbeta0: Array) -> Array:
    """beta_t(0) of the solution that a number means, as it is next to it, (B,); NaN where none is found so near."""
    B, known = problem.size, np.isfinite(dbeta0)
    twice = problem.take(np.tile(np.arange(B), 2))
    at, reach = np.where(known, dbeta0, 0.0), ALIKE * (1 + np.abs(dbeta0))
    off, near = np.full(B, np.inf), known
    for _ in range(40):
        nudge = 1e-7 * np.maximum(1, np.abs(at))
        end = solve_orbit(twice.with_start(np.concatenate([at, at + nudge])), TIGHT).far_angle
        off = end[:B] - problem.betaL
        met = np.abs(off) <= 2e-13 * np.maximum(1, np.abs(problem.betaL))
        near = known & (np.abs(at - dbeta0) <= reach)
        if (met | ~near).all():
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            step = -off / ((end[B:] - end[:B]) / nudge)
        step = np.clip(np.where(np.isfinite(step), step, np.inf), -2 * reach, 2 * reach)
        at = np.where(met | ~near, at, at + step)
    return np.where(near & (np.abs(off) <= 1e-10), at, np.nan)
