"""Speed of the solver as ratios measured in one run, and the cost of `workbench reproduce`.

Run from the checkout: `.venv/bin/python -m benchmarks.speed` (some minutes; `--skip-reproduce`: ratios alone). The rows
against heyoka need the extra taylor. Prints a table and, with `--json FILE`, writes it. Nothing here is
asserted: machines differ.
"""

import argparse
import json
import math
import platform
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy
from scipy.integrate import solve_ivp

from benchmarks import taylor
from benchmarks.timing import compare_times, table1
from solver import methods, solve
from solver.problem.dimensionless import reduce

STATIONS = 201


METHODS = ("swing", "orbit") if "swing" in methods.available() else ("orbit",)


def against_dop853() -> dict[str, float]:
    """`solve` against solve_ivp(DOP853) with a right-hand side of plain floats, both within 1e-9."""
    case = table1()
    problem = reduce(case)
    lam, mu, phi = (float(v[0]) for v in (problem.lam, problem.mu, problem.phi))
    t = problem.span[0] * np.linspace(0, 1, STATIONS)
    y0 = [float(problem.beta0[0]), float(problem.dbeta0[0]), 0.0, 0.0]

    def rates(_: float, y: np.ndarray) -> list[float]:
        s, c = math.sin(y[0]), math.cos(y[0])
        return [y[1], -(lam * c - mu * (c * c - s * s) - (phi + 2 * c * s * s) * s), s, c]

    exact = solve(case, tol=1e-13, method="orbit", stations=STATIONS).trajectory.beta[0]

    def integrate(rtol: float) -> np.ndarray:
        return solve_ivp(rates, (0, t[-1]), y0, "DOP853", t_eval=t, rtol=rtol, atol=rtol).y[0]

    rtol = 1e-8
    while np.abs(integrate(rtol) - exact).max() > 1e-9:
        rtol /= 2
    out = {"dop853 rtol": rtol, "dop853 error": float(np.abs(integrate(rtol) - exact).max())}
    for method in METHODS:

        def ours(method: str = method) -> np.ndarray:
            return solve(case, tol=1e-9, method=method, stations=STATIONS).trajectory.beta[0]

        slow, fast, ratio = compare_times(lambda: integrate(rtol), ours, 15, (1, 20))
        out |= {
            f"{method} error": float(np.abs(ours() - exact).max()),
            f"{method} ms": 1e3 * fast,
            f"dop853 / {method}": ratio,
        }
    return out | {"dop853 ms": 1e3 * slow}


def long_rod() -> dict[str, float]:
    """A rod of L = 2e6 against one of L = 20, both at 201 stations."""
    long, short = table1(2e6), table1()
    out = {}
    for method in METHODS:
        work = [lambda case=case, method=method: solve(case, method=method) for case in (long, short)]
        slow, fast, ratio = compare_times(*work, 25)
        out |= {
            f"{method}, L = 2e6 ms": 1e3 * slow,
            f"{method}, L = 20 ms": 1e3 * fast,
            f"{method}, L = 2e6 / L = 20": ratio,
        }
    return out


def batch(cases: int = 2000) -> dict[str, float]:
    """A grid of cases in one call against a loop over them."""
    E = np.geomspace(5e3, 4e4, cases)
    out = {}
    for method in METHODS:

        def loop(method: str = method) -> None:
            for value in E[::20]:
                solve(table1(E=float(value)), method=method)

        looped, together, ratio = compare_times(loop, lambda method=method: solve(table1(E=E), method=method), 3)
        out |= {
            f"{method}, ms a case, looped": 1e3 * looped / (cases / 20),
            f"{method}, ms a case, together": 1e3 * together / cases,
            f"{method}, looped / together": 20 * ratio,
        }
    return out


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
        ("against DOP853, Table 1, L = 20, both within 1e-9", against_dop853),
        ("a long rod", long_rod),
        ("a grid in one call", batch),
    ]
    versions = f"Python {platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}"
    if {"swing", "heyoka"} <= set(methods.available()):
        parts += taylor.PARTS.items()
    if not asked.skip_reproduce:
        parts.append(("workbench reproduce", reproduce))
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
