"""Times of following branches, against what a user would do instead.

python benchmarks/branches.py

CPU milliseconds a point: Table 1's 13 equilibria under a falling load and five of them with a falling height; and for
the load, three of them (no stable one, whose shape hugs a saddle) by a loop of `solve`, each value from the shape
before, and by a loop of SciPy's `solve_bvp`.
"""

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from scipy.integrate import solve_bvp

from solver import Case, Ends, Solution, equilibria, follow, solve
from solver.problem.case_fields import with_field
from solver.problem.dimensionless import numbers_over

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tests.cases import TABLE_1

STEPS = 100
LAST = 2.0  # N, the load at which the branches end, those with a fold before it


def main() -> None:
    """Print one row for each way."""
    case = TABLE_1["force-first/tension/paper"].case
    start = solve(case, tol=1e-12)
    loads = [float(load) for load in case.loads]
    ends = Case(case.rod, case.cylinder, Ends(case.given.beta, float(start.beta[-1]), *loads))
    every = [one.solution for one in equilibria(ends)]
    values = np.linspace(loads[0], LAST, STEPS + 1)
    follow(every[0], FZ=values[:2])  # what is imported at the first call
    report("dead loads, FZ falling", [partial(count_points, one, FZ=values) for one in every])
    report("of these, no fold", [partial(count_points, one, FZ=values) for one in every[:11]])
    held = []
    for one in every[::3]:
        own = float(one.z[-1])
        given = Ends(case.given.beta, float(start.beta[-1]), None, *loads[1:], height=own)
        held.append((solve(Case(case.rod, case.cylinder, given), seed=one), own))
    runs = [partial(count_points, sol, height=np.linspace(own, own - 0.5, STEPS + 1)) for sol, own in held]
    report("height held and falling", runs)
    report("a loop of solve, FZ falling", [partial(by_solve, one, values) for one in every[4:11:3]])
    report("a loop of solve_bvp, tol 1e-8", [partial(by_collocation, one, values) for one in every[4:11:3]])


def count_points(solution: Solution, **field: np.ndarray) -> int:
    return len(follow(solution, **field))


def by_solve(solution: Solution, values: np.ndarray) -> int:
    """Each equilibrium from the one before."""
    found = solution
    for value in values[1:]:
        found = solve(with_field(solution.case, "FZ", float(value)), seed=found)
        assert found.solved, found.outcome
    return values.size


def by_collocation(solution: Solution, values: np.ndarray) -> int:
    """The same by collocation in beta and beta_t, without alpha and z; from the mesh and the shape before."""
    numbers, case = numbers_over(solution.case, "FZ"), solution.case
    s, shape = solution.s / float(case.rho), np.stack([solution.beta, solution.dbeta * float(case.rho)])
    for value in values:
        beta0, far, phi, lam, mu, *_ = numbers(float(value))
        rates = partial(equation, loads=(lam, mu, phi))
        ends = partial(apart, wanted=(beta0, far))
        found = solve_bvp(rates, ends, s, shape, tol=1e-8, max_nodes=20_000)
        if not found.success:
            print(f"solve_bvp stops at FZ = {value:.6g}: {found.message}")
            return int(np.count_nonzero(np.abs(values - values[0]) < abs(value - values[0])))
        s, shape = found.x, found.y
    return values.size


def apart(first: np.ndarray, last: np.ndarray, wanted: tuple[float, float]) -> np.ndarray:
    return np.array([first[0] - wanted[0], last[0] - wanted[1]])


def equation(_: np.ndarray, state: np.ndarray, loads: tuple[float, float, float]) -> np.ndarray:
    """beta_t and beta_tt = -H."""
    (lam, mu, phi), s, c = loads, np.sin(state[0]), np.cos(state[0])
    return np.stack([state[1], -(lam * c - mu * np.cos(2 * state[0]) - (phi + 2 * c * s * s) * s)])


def report(name: str, runs: Sequence[Callable[[], int]]) -> None:
    """Print CPU time a point, and the number of points."""
    began = time.process_time()
    points = sum(run() for run in runs)
    print(f"{name}: {1e3 * (time.process_time() - began) / points:.2f} ms a point, {points} points")


if __name__ == "__main__":
    main()
