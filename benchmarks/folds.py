"""Fold curves against scipy's solve_bvp: the same folds, and the time for each.

Run from the checkout: `.venv/bin/python -m benchmarks.folds` (a minute; `--json FILE` writes the rows). Nothing here is
asserted: machines differ.

solve_bvp is given the bordered problem: beta and the Jacobi field eta along the rod, eta(0) = 0, eta_t(0) = 1, eta(L) =
0, with the first field as unknown parameter, at values of the second field. It follows the curve from point to point,
each from the shape before, and begins with the exact one.
"""

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp

from solver import Case, fold_curves, region_map
from solver.branches.fold_curves import FoldCurve
from solver.orbits.potential import Loads, slope, slope_rate
from studies import load
from workbench.branches.ends_study import ends_problem

RANGES: dict[str, Any] = {"betaL": ("-60deg", "90deg"), "FZ": (4.0, 12.0)}
NODES, TOL = 401, 1e-8


def rows() -> list[dict[str, Any]]:
    """A row a curve of the atlas, and the times of the whole map."""
    case = ends_problem(load("fig7_4_end_angle"))
    began = time.process_time()
    found = region_map(case, **RANGES)
    whole = time.process_time() - began
    began = time.process_time()
    folds = fold_curves(case, **RANGES)
    curves = time.process_time() - began
    count = sum(int(one.exact.sum()) for one in folds.curves)
    out: list[dict[str, Any]] = [
        {"curve": "all", "points": count, "map s": whole, "curves s": curves, "regions": len(found.regions),
         "ms a point": 1e3 * curves / count}
    ]  # fmt: skip
    for number, curve in enumerate(folds.curves):
        if not curve.cusps.size:
            out.append({"curve": number, **against_bvp(case, curve, 1e3 * curves / count)})
    return out


def against_bvp(case: Case, curve: FoldCurve, ours: float) -> dict[str, Any]:
    """The largest difference of the second field at the points of a curve, and the time of solve_bvp for each."""
    points = curve.values[curve.exact]
    slopes = curve.dbeta0[curve.exact] * float(case.rho)
    every = slice(0, None, max(1, len(points) // 12))
    state: Any = None
    off, lost, seconds = 0.0, 0, 0.0
    for (betaL, FZ), v in zip(points[every], slopes[every], strict=True):
        guess = _first(case, FZ, v) if state is None else state
        began = time.process_time()
        found = _fold(case, betaL, guess)
        seconds += time.process_time() - began
        if not found.success or abs(found.p[0] - FZ) > 0.1:
            lost, state = lost + 1, None
            continue
        off = max(off, abs(found.p[0] - FZ) / abs(FZ))
        state = found.x, found.y, found.p
    count = len(points[every])
    return {"points": count, "lost": lost, "largest relative difference": off,
            "solve_bvp ms a point": 1e3 * seconds / count, "ratio": 1e3 * seconds / count / ours}  # fmt: skip


def _loads(case: Case, FZ: float) -> Loads:
    A, rho = float(case.rod.bending_stiffness), float(case.rho)
    return Loads(case.loads[1] * rho / A, case.loads[2] * rho / A, FZ * rho**2 / A)


def _flow(case: Case, FZ: float, y: Any) -> Any:
    loads = _loads(case, FZ)
    return np.stack([y[1], -slope(loads, y[0]), y[3], -slope_rate(loads, y[0]) * y[2]])


def _first(case: Case, FZ: float, v: float) -> tuple[Any, Any, Any]:
    span = float(case.rod.L / case.rho)
    t = np.linspace(0, span, NODES)
    start = [float(case.given.beta0), v, 0.0, 1.0]  # type: ignore[union-attr]
    shape = solve_ivp(lambda _, y: _flow(case, FZ, y), (0, span), start, "DOP853", t, rtol=1e-12, atol=1e-12).y
    return t, shape, np.array([FZ])


def _fold(case: Case, betaL: float, guess: tuple[Any, Any, Any]) -> Any:
    first = float(case.given.beta0)  # type: ignore[union-attr]

    def ends(ya: Any, yb: Any, p: Any) -> Any:
        return np.array([ya[0] - first, yb[0] - betaL, ya[2], ya[3] - 1, yb[2]])

    def flow(t: Any, y: Any, p: Any) -> Any:
        return _flow(case, float(p[0]), y)

    return solve_bvp(flow, ends, *guess, tol=TOL, max_nodes=20_000)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    table = rows()
    for row in table:
        print(
            "  ".join(
                f"{key}: {value:.4g}" if isinstance(value, float) else f"{key}: {value}" for key, value in row.items()
            )
        )
    if given.json:
        given.json.write_text(json.dumps(table, indent=1), encoding="utf-8")
