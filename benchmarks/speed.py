"""Speed of `orbit` as ratios measured in one run, and the cost of `workbench reproduce`.

Run from the checkout: `.venv/bin/python benchmarks/speed.py` (a minute or two; `--skip-reproduce`: ratios alone).
Prints a table and, with `--json FILE`, writes it. Nothing here is asserted: machines differ.
"""

import argparse
import json
import math
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from math import pi
from pathlib import Path

import numpy as np
import scipy
from scipy.integrate import solve_ivp

from solver import Case, Cylinder, Rod, Start, solve
from solver.reduced import reduce

STATIONS = 201


def table1(L: float = 20.0) -> Case:
    """Table 1 read force-first, in tension, with the paper's stiffness."""
    rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=L, stiffness="paper")
    return Case(rod, Cylinder(R=0.75), Start(beta=pi / 6, dbeta=0.5, F1=5.0, F3=10.0))


def paired(first: Callable[[], object], second: Callable[[], object], rounds: int) -> tuple[float, float, float]:
    """Median seconds of both, run in turn, and the median of their ratios first/second."""
    first(), second()
    times = []
    for _ in range(rounds):
        times.append((_seconds(first), _seconds(second)))
    return (
        statistics.median(a for a, _ in times),
        statistics.median(b for _, b in times),
        statistics.median(a / b for a, b in times),
    )


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def against_dop853() -> dict[str, float]:
    """`solve` by orbit against solve_ivp(DOP853) with a right-hand side of plain floats, both within 1e-9."""
    case = table1()
    problem = reduce(case)
    lam, mu, phi = (float(v[0]) for v in (problem.lam, problem.mu, problem.phi))
    t = problem.span[0] * np.linspace(0, 1, STATIONS)
    y0 = [float(problem.beta0[0]), float(problem.dbeta0[0]), 0.0, 0.0]  # type: ignore[index]

    def rates(_: float, y: np.ndarray) -> list[float]:
        s, c = math.sin(y[0]), math.cos(y[0])
        return [y[1], -(lam * c - mu * (c * c - s * s) - (phi + 2 * c * s * s) * s), s, c]

    exact = solve(case, tol=1e-13, stations=STATIONS).trajectory.beta[0]

    def integrate(rtol: float) -> np.ndarray:
        return solve_ivp(rates, (0, t[-1]), y0, "DOP853", t_eval=t, rtol=rtol, atol=rtol).y[0]

    rtol = 1e-8
    while np.abs(integrate(rtol) - exact).max() > 1e-9:
        rtol /= 2
    orbit = solve(case, tol=1e-9, stations=STATIONS).trajectory.beta[0]
    slow, fast, ratio = paired(lambda: integrate(rtol), lambda: solve(case, tol=1e-9, stations=STATIONS), 15)
    return {
        "dop853 rtol": rtol,
        "dop853 error": float(np.abs(integrate(rtol) - exact).max()),
        "orbit error against orbit at 1e-13": float(np.abs(orbit - exact).max()),
        "dop853 ms": 1e3 * slow,
        "orbit ms": 1e3 * fast,
        "dop853 / orbit": ratio,
    }


def long_rod() -> dict[str, float]:
    """A rod of L = 2e6 against one of L = 20, both at 201 stations."""
    long, short = table1(2e6), table1()
    slow, fast, ratio = paired(lambda: solve(long), lambda: solve(short), 25)
    return {"L = 2e6 ms": 1e3 * slow, "L = 20 ms": 1e3 * fast, "L = 2e6 / L = 20": ratio}


def batch(cases: int = 2000) -> dict[str, float]:
    """A grid of cases in one call against a loop over them."""
    E = np.geomspace(5e3, 4e4, cases)

    def case(E: object) -> Case:
        given = Start(beta=pi / 6, dbeta=0.5, F1=5.0, F3=10.0)
        return Case(Rod(E=E, nu=0.25, a=0.25, L=20.0, stiffness="paper"), Cylinder(R=0.75), given)

    def loop() -> None:
        for value in E[::20]:
            solve(case(float(value)))

    looped, together, ratio = paired(loop, lambda: solve(case(E)), 3)
    return {
        "ms a case, looped": 1e3 * looped / (cases / 20),
        "ms a case, together": 1e3 * together / cases,
        "looped / together": 20 * ratio,
    }


def reproduce() -> dict[str, float]:
    """Wall time and the largest memory of `workbench reproduce` in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        command = [sys.executable, "-m", "workbench", "reproduce", "--out", str(Path(folder) / "results")]
        done = subprocess.run(command, capture_output=True, check=False)
        seconds = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 2**20
    return {"exit status": done.returncode, "seconds": seconds, "peak GB": peak}


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--json", type=Path)
    options.add_argument("--skip-reproduce", action="store_true")
    asked = options.parse_args()
    parts: list[tuple[str, Callable[[], dict[str, float]]]] = [
        ("orbit against DOP853, Table 1, L = 20", against_dop853),
        ("a long rod", long_rod),
        ("a grid in one call", batch),
    ]
    if not asked.skip_reproduce:
        parts.append(("workbench reproduce", reproduce))
    versions = f"Python {platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}"
    found: dict[str, object] = {"machine": f"{platform.machine()}, {versions}"}
    for title, work in parts:
        found[title] = measured = work()
        print(title)
        for name, value in measured.items():
            print(f"  {name:<36} {value:.3g}")
    if asked.json:
        asked.json.write_text(json.dumps(found, indent=2))


if __name__ == "__main__":
    main()
