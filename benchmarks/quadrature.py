"""Quadrature over orbits: a rod at a saddle, all equilibria between two ends, and continuation.

Run from the checkout: `.venv/bin/python -m benchmarks.quadrature` (`--json FILE` writes the rows). Each row is a median
of processor times. Nothing is asserted: machines differ.
"""

import argparse
import json
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.ends import REFERENCE
from solver import Case, Cylinder, Ends, Rod, equilibria, solve
from solver.branches.continuation import resume
from solver.methods.half_period import OrbitQuadrature
from solver.orbits.boundary import critical_points, path_of
from solver.problem.dimensionless import StartProblem, reduce
from workbench.lab.trade_runs import ends_in_units_of_rho

STATIONS = 201
Work = dict[str, tuple[Callable[[], object], int]]  # what is measured, and how often


def at_saddle(gap: float) -> Callable[[], object]:
    """A rod of L = 20 rho that starts on a saddle, its level so far above it."""
    lam, mu, phi, span = (np.array([v]) for v in REFERENCE[:4])
    blank = StartProblem(lam, mu, phi, span, np.zeros(1), np.zeros(1))
    found = critical_points(blank)
    saddle = found.beta[:, : found.count[0]][~found.centre[:, : found.count[0]]][:1]
    problem = StartProblem(lam, mu, phi, span, saddle, np.sqrt([gap]))
    t = span[:, None] * np.linspace(0, 1, STATIONS)
    return lambda: OrbitQuadrature().run(problem, t, 1e-8)


def works() -> Work:
    """What is measured, by name."""
    case = ends_in_units_of_rho(*REFERENCE)
    near = ends_in_units_of_rho(REFERENCE[0], REFERENCE[1], REFERENCE[2] - 1e-3, *REFERENCE[3:])
    steel = Rod(2.06e8, 0.3, 0.0635, 300.0, inner_radius=0.0543)
    pipe = Case(steel, Cylinder(0.108, "inside"), Ends(0.0, 0.0, FZ=-300.0))
    seed = solve(case)
    assert seed.trajectory.orbit is not None
    first, last, path = reduce(case), reduce(near), path_of(seed.trajectory.orbit.paths, 0)
    return {
        "rod at a saddle, gap 1e-4": (at_saddle(1e-4), 30),
        "rod at a saddle, gap 1e-12": (at_saddle(1e-12), 30),
        "rod at a saddle, gap 1e-100": (at_saddle(1e-100), 20),
        "31 equilibria of the reference problem": (lambda: equilibria(case), 7),
        "851 equilibria of the pipe of 300 m": (lambda: equilibria(pipe), 2),
        "a step of continuation": (lambda: resume(first, path, last), 20),
        "solve with a seed near": (lambda: solve(near, seed=seed), 20),
    }


def times() -> dict[str, float]:
    """Milliseconds of the processor that each takes, the median of its repeats after a first call."""
    out = {}
    for name, (work, repeats) in works().items():
        work()
        times = []
        for _ in range(repeats):
            begun = time.process_time()
            work()
            times.append(time.process_time() - begun)
        out[name] = 1e3 * statistics.median(times)
    return out


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--json", type=Path)
    asked = options.parse_args()
    rows = [{"measured": name, "ms": found} for name, found in times().items()]
    for row in rows:
        print(f"{row['measured']:<40} {row['ms']:9.3f} ms")
    if asked.json:
        asked.json.write_text(json.dumps(rows, indent=2))


if __name__ == "__main__":
    main()
