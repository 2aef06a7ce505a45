"""Writes workbench/lab/trade_references.json: the cases of `workbench trade` by Taylor series in 40 digits.

The series and the reduction in 40 digits are make_references'. An ends problem is shot from its start's slope, by
Newton's rule on the series' own change of beta(L) with beta'(0), until the far angle is met to 25 digits.
Run from the root: python -m benchmarks.make_trade_references [NAME ...]
"""

import json
import sys
from pathlib import Path
from typing import Any

import mpmath
from mpmath import mpf

from benchmarks.make_references import DIGITS, ORDER, numbers, series, state_after
from solver import Case, Ends
from workbench.lab.trade_runs import CASES, FILE, Named

STATIONS = 40  # and the start
OUT = Path(__file__).resolve().parents[1] / "workbench" / "compare" / FILE


def of_ends(case: Case) -> dict[str, Any]:
    """As `numbers`, for loads that are given; the slope is left out."""
    rod, given = case.rod, case.given
    E, a, L, R = (mpf(float(v)) for v in (rod.E, rod.a, rod.L, case.cylinder.R))
    A = mpmath.pi / {"solid": 4, "paper": 16}[rod.stiffness] * E * a**4
    rho = R + a if case.cylinder.side == "outside" else R - a
    FZ, MZ, M3, beta = (mpf(float(v)) for v in (given.FZ, given.MZ, given.M3, given.beta0))
    return {"rho": rho, "lam": MZ / A * rho, "mu": M3 / A * rho, "phi": FZ / A * rho**2, "span": L / rho, "beta": beta}


def march(at: dict[str, Any], parts: int) -> tuple[list[list[Any]], Any]:
    """The nine numbers of `series` at so many equal parts of the rod, and the condition number."""
    state = [at["beta"], at["v"], mpf(0), mpf(0), mpf(0), mpf(1), mpf(0), mpf(0), mpf(1)]
    t, condition, rows = mpf(0), mpf(1), [state]
    for k in range(1, parts + 1):
        goal = at["span"] * k / parts
        while t < goal:
            terms = series(state, at["lam"], at["mu"], at["phi"])
            tail = max(max(abs(x[-1]), abs(x[-2])) / max(1, abs(x[0])) for x in terms)
            h = min((mpf(10) ** -(DIGITS - 4) / tail) ** (mpf(1) / ORDER) if tail else goal - t, goal - t)
            for part in (h / 2, h):
                here = state_after(terms, part)
                condition = max(condition, abs(here[5]), abs(here[7]))
            state, t = here, goal if h == goal - t else t + h
        rows.append(state)
    return rows, condition


def contact(at: dict[str, Any], beta: Any, v: Any) -> Any:
    """f rho^3/A; section 2 of docs/explanation/physics.md."""
    s, c = mpmath.sin(beta), mpmath.cos(beta)
    FY = at["lam"] - at["mu"] * c - s**3
    H = at["lam"] * c - at["mu"] * mpmath.cos(2 * beta) - (at["phi"] + 2 * c * s**2) * s
    return s * FY + H * (3 * s * c - at["mu"]) - 3 * v**2 * mpmath.cos(2 * beta)


def shot(named: Named) -> dict[str, Any]:
    """The reduced numbers of an ends problem with the slope of the equilibrium that is meant."""
    at = of_ends(named.case)
    at["v"] = mpf(sharp_slope(named)) * at["rho"]
    goal = mpf(float(named.case.given.betaL))
    for _ in range(8):
        rows, _ = march(at, 1)
        off = rows[-1][0] - goal
        if abs(off) < mpf(10) ** -25:
            return at
        at["v"] -= off / rows[-1][7]
    raise RuntimeError(f"the far angle is missed by {float(off)}")


def sharp_slope(named: Named) -> float:
    """The slope to all digits of a float: where shooting is blunt Newton's rule needs a start so near."""
    from solver import solve

    sol = solve(named.case, tol=1e-10, method="shooting", seed=named.slope)
    return float(sol.dbeta[0])


def row(named: Named) -> dict[str, Any]:
    ends = isinstance(named.case.given, Ends)
    at = shot(named) if ends else numbers(named.case)
    rows, condition = march(at, STATIONS)
    table: dict[str, Any] = {
        "beta": [float(r[0]) for r in rows],
        "alpha": [float(r[2]) for r in rows],
        "z": [float(r[3]) for r in rows],
        "contact": [float(contact(at, r[0], r[1])) for r in rows],
        "condition": float(f"{float(condition):.3g}"),
    }
    if ends:
        table["slope"] = float(at["v"] / at["rho"])
    table["numbers"] = [float(at[name]) for name in ("lam", "mu", "phi", "span", "beta")]
    return table


def main(names: list[str]) -> None:
    mpmath.mp.dps = DIGITS
    old = json.loads(OUT.read_text(encoding="utf-8"))["cases"] if OUT.exists() else {}
    done = {}
    for name, named in CASES.items():
        done[name] = old[name] if names and name not in names and name in old else row(named)
        print(name, done[name]["beta"][-1], done[name]["condition"], flush=True)
    rows = ",\n".join(f"{json.dumps(name)}: {json.dumps(table)}" for name, table in done.items())
    about = f"alpha, z and contact in units of rho and A; Taylor series of order {ORDER} in {DIGITS} digits"
    shares = [k / STATIONS for k in range(STATIONS + 1)]
    text = f'{{"about": {json.dumps(about)},\n"u": {json.dumps(shares)},\n"cases": {{\n{rows}\n}}}}\n'
    OUT.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
