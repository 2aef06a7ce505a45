"""The cost of derivatives with respect to six fields, against two solves of the same rods, in one run.

Run from the checkout: `.venv/bin/python -m benchmarks.sensitivity` (a minute). Nothing here is asserted: machines
differ. "two solves": what a difference with respect to one field alone would cost.
"""

from collections.abc import Callable

import numpy as np

from benchmarks.timing import paired, table1
from solver import Case, solve

FIELDS = ("E", "R", "a", "beta0", "F1", "F3")
OBSERVABLES = ("height", "energy", "push_max")


def row(name: str, case: Case, stations: int, rounds: int, method: str) -> str:
    """One row of the table: milliseconds, and ratios of the medians."""

    def solved() -> object:
        return solve(case, stations=stations, method=method)

    solution = solve(case, stations=stations, method=method)

    def twice(first: Callable[[], object]) -> Callable[[], object]:
        return lambda: (first(), first())

    along, both, ratio = paired(lambda: solution.sensitivity(FIELDS), twice(solved), rounds)
    more, _, with_observables = paired(lambda: solution.sensitivity(FIELDS, OBSERVABLES), twice(solved), rounds)
    numbers = f"{1e3 * both:10.2f} {1e3 * along:10.2f} {ratio:8.2f} {1e3 * more:10.2f} {with_observables:8.2f}"
    return f"{name:28s} {method:8s} {numbers}"


def main() -> None:
    print("ms".ljust(37) + " two solves  along rod    ratio  with three    ratio")
    thousand = table1(E=np.linspace(5e3, 4e4, 1000))
    for method in ("orbit", "auto"):
        print(row("one rod, 201 stations", table1(), 201, 15, method))
        print(row("1000 rods, 201 stations", thousand, 201, 3, method))


if __name__ == "__main__":
    main()
