"""What a refined study costs, and what it misses, against the uniform grid of the same resolution solved in full.

Run from the checkout: `.venv/bin/python -m benchmarks.refine` (minutes; `--points N` for another resolution). The
boundary cells of the uniform grid are those whose four corners have different numbers of bends. Processor time of one
process that is bound to one core where the system allows that. Nothing is asserted here: machines differ.
"""

import argparse
import os
import tempfile
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.timing import peak_gigabytes
from solver import solve
from solver.observe.observables import observe
from studies import Study
from studies.language.loader import load, loads
from studies.language.refinement import Lattice, refinement_of
from workbench.run import in_memory
from workbench.run.run_and_resume import RunOptions, run_to_file
from workbench.stored import refined

BLOCK = 512  # cases, as of a run


def study(points: int) -> Study:
    """The shipped study at another resolution."""
    text = load("regimes_refined").text
    return loads(text.replace("points = 400", f"points = {points}").replace("50_000", "10_000_000"), default_name="r")


def uniform(work: Study, lattice: Lattice) -> NDArray[np.float64]:
    """The number of bends at every place of the lattice, solved in blocks; nothing is stored."""
    places = np.indices(lattice.sizes).reshape(len(lattice.sizes), -1).T
    values = lattice.values(places)
    found = []
    for i in range(0, len(places), BLOCK):
        case = work.case_of({name: row[i : i + BLOCK] for name, row in values.items()})
        sol = solve(case, work.tol, work.method, 2)
        found.append(np.where(sol.solved, np.asarray(observe(sol, ["bends"])["bends"], dtype=float), np.nan))
    return np.concatenate(found).reshape(lattice.sizes)


def seconds_to_store(work: Study) -> float:
    """Processor time of a run into a file, by one worker."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.process_time()
        run_to_file(work, Path(folder) / "stored.h5", RunOptions(workers=1))
        return time.process_time() - began


def as_grid(work: Study, lattice: Lattice) -> Study:
    """The study over the uniform grid."""
    text = work.text.partition("[refine]")[0]
    for before, after in zip(lattice.shape, lattice.sizes, strict=True):
        text = text.replace(f"count = {before}\n", f"count = {after}\n")
    return loads(text, default_name="u")


def boundary(turns: NDArray[np.float64]) -> NDArray[np.bool_]:
    """The cells of a grid whose four corners differ."""
    corners = np.stack([turns[:-1, :-1], turns[1:, :-1], turns[:-1, 1:], turns[1:, 1:]])
    found: NDArray[np.bool_] = np.ptp(corners, axis=0) > 0
    return found


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    options.add_argument("--points", type=int, default=400)
    given = options.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    work = study(given.points)
    ds = in_memory.run(work)
    found = refined.describe(ds)
    lattice, cases, size = found.lattice, len(found.places), int(np.prod(found.lattice.sizes))
    grid = " x ".join(map(str, lattice.sizes))
    print(f"refined: {cases} cases; uniform: {grid} = {size} cases; share {100 * cases / size:.2f} %", flush=True)
    turns = uniform(work, lattice)
    at = tuple(found.places.T)
    print(f"cases with another number than on the uniform grid: {int((turns[at] != ds['bends'].values).sum())}")
    cells = refinement_of(lattice, found.places, np.empty((cases, 0)), np.empty(0), lattice.depth).cells[-1]
    wanted, known = boundary(turns), np.zeros([size - 1 for size in lattice.sizes], dtype=bool)
    known[tuple(cells.T)] = True
    print(f"boundary cells of the uniform grid: {int(wanted.sum())}; missed: {int((wanted & ~known).sum())}")
    ours, theirs = seconds_to_store(work), seconds_to_store(as_grid(work, lattice))
    print(f"run into a file: refined {ours:.1f} s, uniform {theirs:.1f} s, {theirs / ours:.1f} times")
    print(f"largest memory {peak_gigabytes():.2f} GB")


if __name__ == "__main__":
    main()
