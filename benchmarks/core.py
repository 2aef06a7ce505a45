"""The compiled core: threads, one call against blocks, memory, saddles, and what a new process pays.

Run from the checkout: `.venv/bin/python -m benchmarks.core`. Prints a table. Nothing here is asserted: machines differ.
"""

import contextlib
import os
import subprocess
import sys
import tracemalloc
from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.timing import compare_times, table1
from solver import Case, Cylinder, Rod, Start, solve
from solver.problem.dimensionless import reduce

CASES, STATIONS, BLOCK = 100_000, 101, 512


@contextlib.contextmanager
def threads(number: int) -> Iterator[None]:
    """So many threads for the calls inside."""
    before = os.environ.get("OMP_NUM_THREADS")
    os.environ["OMP_NUM_THREADS"] = str(number)
    try:
        yield
    finally:
        os.environ.pop("OMP_NUM_THREADS")
        if before is not None:
            os.environ["OMP_NUM_THREADS"] = before


def many(cases: int = CASES) -> Case:
    return table1(E=np.geomspace(5e3, 4e4, cases))


def by_threads() -> dict[str, float]:
    """100,000 rods in one call, by one thread and by two."""

    def run(number: int) -> Callable[[], None]:
        def work() -> None:
            with threads(number):
                solve(case, stations=STATIONS)

        return work

    case = many()
    one, two, ratio = compare_times(run(1), run(2), 5)
    return {"one thread s": one, "two threads s": two, "one / two": ratio}


def against_blocks() -> dict[str, float]:
    """The same rods in one call, and in calls of 512 whose answers are kept; one thread."""
    case, E = many(), many().rod.E
    blocks = [table1(E=E[k : k + BLOCK]) for k in range(0, CASES, BLOCK)]
    with threads(1):
        whole, parts, ratio = compare_times(
            lambda: solve(case, stations=STATIONS), lambda: [solve(block, stations=STATIONS) for block in blocks], 5
        )
    return {"one call us a case": 1e6 * whole / CASES, "blocks us a case": 1e6 * parts / CASES, "one / blocks": ratio}


def memory() -> dict[str, float]:
    """The most that NumPy holds during one call, against what is returned."""
    tracemalloc.start()
    solution = solve(many(), stations=400)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    told = solution.trajectory
    arrays = [told.beta, told.dbeta, told.alpha, told.z, told.outcome, told.orbit.found, solution.t]
    returned = sum(array.nbytes for array in arrays)
    return {"peak MB": most / 2**20, "returned MB": returned / 2**20, "peak / returned": most / returned}


def next_to_a_saddle() -> dict[str, float]:
    """One rod under tension that nearly rests along the axis: milliseconds by the gap, and against an ordinary rod."""
    out = {}
    rod = Rod(4 / np.pi / 0.25**4, 0.25, 0.25, 60.0)  # A = 1
    for gap in (1e-4, 1e-8, 1e-12):
        near = Case(rod, Cylinder(0.75), Start(gap, 0.0, F3=1.0, M3=0.0))
        slow, fast, _ = compare_times(lambda near=near: solve(near), lambda: solve(table1()), 25)
        out |= {f"gap {gap:.0e} ms": 1e3 * slow, "ordinary rod ms": 1e3 * fast}
    return out


def new_process() -> dict[str, float]:
    """Seconds of the processor for `import solver`, and milliseconds of the first solve after it; medians of nine."""
    code = (
        "import time; a = time.process_time(); import numpy; b = time.process_time(); import solver\n"
        "c = time.process_time(); from benchmarks.timing import table1; case = table1()\n"
        "d = time.perf_counter(); solver.solve(case); print(a, b - a, c - b, time.perf_counter() - d)"
    )
    rows = []
    for _ in range(9):
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        rows.append([float(word) for word in done.stdout.split()])
    python, numpy, own, first = np.median(rows, axis=0)
    names = ("start of Python s", "import numpy s", "import solver after it s", "first solve ms")
    return dict(zip(names, (python, numpy, own, 1e3 * first), strict=True))


def bound() -> dict[str, float]:
    """What the arithmetic and the memory of 10,000 rods x 400 stations need at least, in microseconds a rod.

    Each number of a step costs one multiplication and one addition for each of its terms: 6 products and 2 squares of
    two series of 20 terms; each station four polynomials of 20 terms and a derivative. Eight lanes, one of each
    operation a clock; the memory that is written is measured by filling an array of the size of the answer.
    """
    case = table1(E=np.geomspace(5e3, 4e4, 10_000))
    with threads(1):
        solution = solve(case, tol=1e-9, stations=400)
    steps = float(solution.trajectory.orbit.found["count"].sum(axis=1).mean())
    series, station = 6 * 210 + 2 * 105, 5 * 20
    clocks = (steps * series + 400 * station) / 8
    gigahertz = _clock()
    whole = np.empty((4, reduce(case).size, 400))
    fill, _, _ = compare_times(lambda: whole.fill(1.0), lambda: None, 9)
    arithmetic, written = clocks / gigahertz / 1e3, 1e6 * fill / 10_000
    return {"steps a rod": steps, "GHz": gigahertz, "arithmetic us": arithmetic, "memory us": written}


def _clock() -> float:
    """The clock of the processor in GHz, as the system tells it; 3 where it does not."""
    try:
        with open("/proc/cpuinfo") as file:
            return max(float(line.split(":")[1]) for line in file if line.startswith("cpu MHz")) / 1e3
    except (OSError, ValueError):
        return 3.0


PARTS: dict[str, Callable[[], dict[str, float]]] = {
    "100,000 rods x 101 stations by threads": by_threads,
    "one call against blocks of 512": against_blocks,
    "memory of 100,000 rods x 400 stations": memory,
    "one rod next to a saddle": next_to_a_saddle,
    "a new process": new_process,
    "bound for 10,000 rods x 400 stations, L = 20": bound,
}


def main() -> None:
    for title, work in PARTS.items():
        print(title)
        for name, value in work().items():
            print(f"  {name:<36} {value:.3g}", flush=True)


if __name__ == "__main__":
    main()
