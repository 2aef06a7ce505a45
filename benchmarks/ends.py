"""Problems given by their two ends: `difference` against scipy's solve_bvp at one achieved error, and how long it takes
to find every equilibrium.

Run from the checkout: `.venv/bin/python -m benchmarks.ends` (half a minute; `--json FILE` writes the rows). Nothing
here is asserted: machines differ.
"""

import argparse
import json
import statistics
import time
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp

from benchmarks.timing import compare_times
from solver import Case, Solution, equilibria, solve
from solver.orbits.potential import slope, slope_rate
from workbench.lab.trade_runs import CASES, ends_in_units_of_rho

WANTED = 5e-8  # error of beta, at 201 stations
NODES = (129, 193, 257, 385, 513, 769, 1025, 1537, 2049)
MESHES = (65, 129, 257, 513, 1025)
TOLERANCES = tuple(10.0**-k for k in range(2, 10))
REFERENCE = (-0.3655, 0.7464, -0.7506, 20.0, np.pi / 6, np.pi / 6)


def difference_against_bvp(rounds: int = 15) -> list[dict[str, Any]]:
    """A row a case: both from the same first shape, each at its loosest setting that achieves `WANTED`.

    `difference` is timed as whoever calls `solve` pays for it: alpha and z, error estimate and condition number
    included, on the coarsest mesh that will do; "by itself": left to find that mesh, tol = WANTED. solve_bvp is given
    its best: analytic Jacobians, beta alone, no estimate of the whole error. "first mesh 129": the same that
    `difference` begins with; "best first mesh": the quickest of several, which one knows afterwards.
    """
    rows = []
    for name, seed in rods():
        exact, t = seed.trajectory.beta[0], seed.t[0]
        ours = coarsest(seed.case, seed, exact)
        itself = partial(solve, seed.case, WANTED, "difference", seed=seed)
        theirs = {mesh: loosest(seed, mesh, exact, t) for mesh in MESHES}
        able = {mesh: work for mesh, work in theirs.items() if work is not None}
        best = min(able, key=lambda mesh: compare_times(able[mesh], ours, 3, clock=time.process_time)[0])
        row: dict[str, Any] = {"case": name, "nodes": ours.keywords["nodes"], "error": _off(ours(), exact)}
        row["error by itself"] = _off(itself(), exact)
        for title, mesh in (("first mesh 129", 129), ("best first mesh", best)):
            if mesh not in able:
                continue
            slow, fast, ratio = compare_times(able[mesh], ours, rounds, clock=time.process_time)
            row |= {f"solve_bvp ms, {title}": 1e3 * slow, "difference ms": 1e3 * fast, f"ratio, {title}": ratio}
            row[f"ratio, {title}, by itself"] = compare_times(able[mesh], itself, rounds, clock=time.process_time)[2]
        rows.append(row)
    return rows


def rods() -> list[tuple[str, Solution]]:
    """The ends problems of `workbench trade`, and the eight equilibria of lowest energy of the reference problem."""
    out = [
        (name, solve(named.case, tol=1e-10, seed=named.slope, method="shooting"))
        for name, named in CASES.items()
        if named.slope is not None
    ]
    lowest = equilibria(ends_in_units_of_rho(*REFERENCE))[:8]
    return out + [(f"equilibrium {i + 1}", one.solution) for i, one in enumerate(lowest)]


def summary(rows: list[dict[str, Any]]) -> dict[str, float]:
    """The median of each ratio over the cases, its least and its largest."""
    out = {}
    for key in sorted({key for row in rows for key in row if key.startswith("ratio")}):
        values = [row[key] for row in rows if key in row]
        out |= {f"{key}: median": statistics.median(values), f"{key}: least": min(values), f"{key}: most": max(values)}
    return out


def coarsest(case: Case, seed: Solution, exact: Any) -> Any:
    """`solve` by difference on the fewest nodes that achieve `WANTED`."""
    for nodes in NODES:
        work = partial(solve, case, WANTED, "difference", seed=seed, nodes=nodes)
        if _off(work(), exact) <= WANTED:
            return work
    raise ValueError(f"no mesh of up to {NODES[-1]} nodes achieves {WANTED}")


def _off(sol: Solution, exact: Any) -> float:
    off = float(np.abs(sol.trajectory.beta[0] - exact).max())
    return off if np.isfinite(off) else np.inf


def loosest(seed: Solution, mesh: int, exact: Any, t: Any) -> Any:
    """A call of solve_bvp from that first mesh at the largest tolerance that achieves `WANTED`; None without any."""
    problem = seed.problem
    first, last = problem.beta0[0], problem.betaL[0]
    x = np.linspace(0, problem.span[0], mesh)
    guess = np.interp(x, t, exact)
    ends_change = np.array([[1.0, 0.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])

    def rates(_: Any, y: Any) -> Any:
        return np.stack([y[1], -slope(problem, y[0])])

    def change(_: Any, y: Any) -> Any:
        jacobian = np.zeros((2, 2, y.shape[1]))
        jacobian[0, 1], jacobian[1, 0] = 1, -slope_rate(problem, y[0])
        return jacobian

    def work(tol: float) -> Any:
        ends = lambda ya, yb: np.array([ya[0] - first, yb[0] - last])  # noqa: E731
        both = np.stack([guess, np.gradient(guess, x)])
        more = {"fun_jac": change, "bc_jac": lambda *_: ends_change, "max_nodes": 100_000}
        return solve_bvp(rates, ends, x, both, tol=tol, **more).sol(t)[0]

    for tol in TOLERANCES:
        if np.abs(work(tol) - exact).max() <= WANTED:
            return partial(work, tol)
    return None


def every_equilibrium(repeats: int = 15) -> list[dict[str, Any]]:
    """Median seconds, of the clock and of the processor, of finding all equilibria of the reference problem."""
    case = ends_in_units_of_rho(*REFERENCE)
    count = len(equilibria(case))
    clock, processor = [], []
    for _ in range(repeats):
        began, used = time.perf_counter(), time.process_time()
        equilibria(case)
        clock.append(time.perf_counter() - began)
        processor.append(time.process_time() - used)
    return [{"equilibria": count, "seconds": statistics.median(clock), "of processor": statistics.median(processor)}]


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--json", type=Path)
    asked = options.parse_args()
    rows = difference_against_bvp()
    found = {
        "difference against solve_bvp": rows,
        "over all of them": [summary(rows)],
        "every equilibrium": every_equilibrium(),
    }
    for title, rows in found.items():
        print(title)
        for row in rows:
            print("  " + "; ".join(f"{k} {v}" if isinstance(v, str) else f"{k} {v:.3g}" for k, v in row.items()))
    if asked.json:
        asked.json.write_text(json.dumps(found, indent=2))


if __name__ == "__main__":
    main()
