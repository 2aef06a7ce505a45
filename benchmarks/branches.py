"""Times of following branches: CPU milliseconds a point, under dead loads and with a held height.

python benchmarks/branches.py           # with the compiled core, if it is there
ROD_WORKBENCH_NO_CORE=1 python benchmarks/branches.py
"""

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from solver import Branch, Case, Ends, equilibria, follow, solve
from solver.core.panels import available

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tests.cases import TABLE_1

STEPS = 100


def main() -> None:
    """Each of Table 1's 13 equilibria, 100 steps under a falling load; five of them with a falling height."""
    case = TABLE_1["force-first/tension/paper"].case
    start = solve(case, tol=1e-12)
    loads = [float(load) for load in case.loads]
    ends = Case(case.rod, case.cylinder, Ends(case.given.beta, float(start.beta[-1]), *loads))
    every = list(equilibria(ends))
    print(f"compiled core: {available()}")
    values = np.linspace(loads[0], 2.0, STEPS + 1)
    told("dead loads, FZ falling", [partial(follow, one.solution, FZ=values) for one in every])
    held = []
    for one in every[::3]:
        own = float(one.solution.z[-1])
        given = Ends(case.given.beta, float(start.beta[-1]), None, *loads[1:], height=own)
        held.append((solve(Case(case.rod, case.cylinder, given), seed=one.solution), own))
    runs = [partial(follow, sol, height=np.linspace(own, own - 0.5, STEPS + 1)) for sol, own in held]
    told("height held and falling", runs)


def told(name: str, runs: Sequence[Callable[[], Branch]]) -> None:
    """Print CPU time a point, and the number of points."""
    began = time.process_time()
    points = sum(len(run()) for run in runs)
    print(f"{name}: {1e3 * (time.process_time() - began) / points:.2f} ms a point, {points} points")


if __name__ == "__main__":
    main()
