"""The cost of derivatives with respect to six fields, against two solves of the same rods, in one run.

Run from the checkout: `.venv/bin/python -m benchmarks.sensitivity` (a minute). Nothing here is asserted: machines
differ. "two solves": what a difference with respect to one field alone would cost. Seconds of the processor, the least
of several calls: on a busy machine the clock counts other work too.
"""

import time
from collections.abc import Callable

import numpy as np

from benchmarks.timing import table1
from solver import Case, solve
from solver.observe.observables import OBSERVABLES

FIELDS = ("E", "R", "a", "beta0", "F1", "F3")
READ = ((), ("height", "energy", "push_max"), tuple(name for name, row in OBSERVABLES.items() if not row.free))


def row(name: str, case: Case, stations: int, rounds: int, method: str) -> str:
    """One row of the table: milliseconds, and in brackets the ratios to two solves."""

    def seconds(call: Callable[[], object]) -> float:
        begun = time.process_time()
        call()
        return time.process_time() - begun

    def least(call: Callable[[], object]) -> float:
        call()
        return min(seconds(call) for _ in range(rounds))

    solution = solve(case, stations=stations, method=method)
    both = 2 * least(lambda: solve(case, stations=stations, method=method))
    costs = [least(lambda names=names: solution.sensitivity(FIELDS, names)) for names in READ]  # type: ignore[misc]
    numbers = " ".join(f"{1e3 * cost:10.2f} ({cost / both:5.1f})" for cost in costs)
    return f"{name:28s} {method:8s} {1e3 * both:10.2f} {numbers}"


def main() -> None:
    print("ms".ljust(37) + " two solves  along rod            with three         with all")
    thousand = table1(E=np.linspace(5e3, 4e4, 1000))
    for method in ("orbit", "auto"):
        print(row("one rod, 201 stations", table1(), 201, 60, method))
        print(row("1000 rods, 201 stations", thousand, 201, 3, method))


if __name__ == "__main__":
    main()
