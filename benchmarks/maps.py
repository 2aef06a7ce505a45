"""What a map of 400 x 400 rods costs on one core: solved, observed, stored and drawn.

Run from the checkout: `.venv/bin/python -m benchmarks.maps` (some minutes; `--count N` for N x N rods). Processor time
of one process that is bound to one core where the system allows that; the largest memory at the end. Nothing is
asserted here: machines differ.
"""

import argparse
import os
import statistics
import tempfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np

from benchmarks.timing import peak_gigabytes, seconds_of_processor
from solver import solve
from solver.observe.observables import observe
from studies import Study
from studies.language.loader import load, loads
from workbench.figures import canvas, map_figure
from workbench.run.run_and_resume import RunOptions, run_to_file
from workbench.stored import reading
from workbench.stored.stored_study import StoredStudy


def regimes(count: int, observables: list[str]) -> Study:
    """The shipped study over `count` moduli and as many radii, without arrays along the rod."""
    text = load("regimes").text.partition("[[laws]]")[0]
    text = text.replace("count = 25", f"count = {count}").replace("count = 19", f"count = {count}")
    told = ", ".join(f'"{name}"' for name in observables)
    return loads(text.replace('["bends", "attached"]', f"[{told}]\noutputs = []\nstations = 2"), default_name="map")


def bare(work: Study, size: int = 512) -> Callable[[], None]:
    """Solve and observe in blocks of the size of a run; nothing is stored and no caution is judged."""
    over = work.variation.dimensions
    cases = [work.case_of(over.at(part)) for part in np.split(np.arange(over.size), range(size, over.size, size))]

    def run() -> None:
        for case in cases:
            observe(solve(case, work.tol, work.method, work.stations), work.wanted)

    return run


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    options.add_argument("--count", type=int, default=400)
    options.add_argument("--rounds", type=int, default=2)
    given = options.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    turns, both = regimes(given.count, ["bends"]), regimes(given.count, ["bends", "attached"])
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "map.h5"

        def store() -> None:
            run_to_file(both, file, RunOptions(workers=1, restart=True))

        def draw() -> None:
            canvas.save(map_figure.figure(StoredStudy(reading.read(file))), BytesIO())

        rows = {
            "solve and observe the number of bends": bare(turns),
            "solve and observe the number of bends and attachment": bare(both),
            "run: the same with all cautions, stored": store,
            "plot: read and draw both maps": draw,
        }
        print(f"{both.size} rods")
        for name, part in rows.items():
            spent = [seconds_of_processor(part) for _ in range(given.rounds)]
            print(f"{name:<55} {min(spent):6.1f} s, median {statistics.median(spent):.1f} s", flush=True)
    print(f"largest memory {peak_gigabytes():.2f} GB")


if __name__ == "__main__":
    main()
