"""Writes tests/references.json: every start case of tests/cases.py by Taylor series in 40 digits.

A family apart from every method of the solver: power series of order 36 about each point, the coefficients by
recurrence, in mpmath. The loads are reduced here anew, in 40 digits, from the fields of the case as the floats they
are; so the reference also judges the reduction. Run from the root: python -m benchmarks.make_references [NAME ...]
"""

import json
import sys
from pathlib import Path
from typing import Any

import mpmath
from mpmath import mpf

from solver import Case
from tests.cases import START, Named

ORDER, DIGITS = 36, 40
SHARES = [k / 8 for k in range(1, 9)]
FILE = Path(__file__).resolve().parents[1] / "tests" / "references.json"


def numbers(case: Case) -> dict[str, Any]:
    """rho, lam, mu, phi, span, beta0, beta_t0 in 40 digits; sections 1 and 3 of docs/explanation/physics.md."""
    rod, given = case.rod, case.given
    E, nu, a, L, R = (mpf(float(v)) for v in (rod.E, rod.nu, rod.a, rod.L, case.cylinder.R))
    beta, dbeta, F2, F3 = (mpf(float(v)) for v in (given.beta, given.dbeta, given.F2, given.F3))
    A = mpmath.pi / {"solid": 4, "paper": 16}[rod.stiffness] * E * a**4
    rho = R + a if case.cylinder.side == "outside" else R - a
    s, c = mpmath.sin(beta), mpmath.cos(beta)
    if given.F1 is None:
        m = (mpf(float(given.dgamma)) + s * c / rho) / (1 + nu)
    else:
        m = mpf(float(given.F1)) / (A * dbeta) + 3 * s * c / rho
    l = rho * (F3 * s - F2 * c) / A + m * c + s**3 / rho
    p = (F2 * s + F3 * c) / A
    return {
        "rho": rho, "lam": l * rho, "mu": m * rho, "phi": p * rho**2, "span": L / rho, "beta": beta, "v": dbeta * rho,
    }  # fmt: skip


def product(x: list[Any], y: list[Any], k: int) -> Any:
    return mpmath.fdot((x[i], y[k - i]) for i in range(k + 1))


def series(state: list[Any], lam: Any, mu: Any, phi: Any) -> list[list[Any]]:
    """Taylor coefficients of beta, alpha, z, swirl and of two changes of beta, about a point.

    state: beta, beta_t, alpha, z, swirl, then eta, eta_t of a change of beta(0) and of one of beta_t(0).
    """
    b, alpha, z, swirl = [state[0], state[1]], [state[2]], [state[3]], [state[4]]
    changes = [[state[5], state[6]], [state[7], state[8]]]
    s, c = [mpmath.sin(b[0])], [mpmath.cos(b[0])]
    ss: list[Any] = []  # sin^2
    css: list[Any] = []  # cos sin^2
    sc: list[Any] = []
    csss: list[Any] = []  # cos sin^3
    s4: list[Any] = []
    rate: list[Any] = []  # H'
    for k in range(ORDER):
        ss.append(product(s, s, k))
        sc.append(product(s, c, k))
        css.append(product(c, ss, k))
        csss.append(product(s, css, k))
        s4.append(product(ss, ss, k))
        one = 1 if k == 0 else 0
        H = lam * c[k] - mu * (one - 2 * ss[k]) - phi * s[k] - 2 * csss[k]
        # 3 s^2 c^2 - s^4 = 3 s^2 - 4 s^4
        rate.append(-lam * s[k] + 4 * mu * sc[k] - phi * c[k] - 2 * (3 * ss[k] - 4 * s4[k]))
        b.append(-H / ((k + 1) * (k + 2)))
        for eta in changes:
            eta.append(-product(rate, eta, k) / ((k + 1) * (k + 2)))
        alpha.append(s[k] / (k + 1))
        z.append(c[k] / (k + 1))
        swirl.append(sc[k] / (k + 1))
        slopes = [(i + 1) * b[i + 1] for i in range(k + 1)]
        s.append(product(slopes, c, k) / (k + 1))
        c.append(-product(slopes, s[: k + 1], k) / (k + 1))
    return [b, alpha, z, swirl, *changes]


def state_after(coefficients: list[list[Any]], h: Any) -> list[Any]:
    """The state a step h on."""
    b, alpha, z, swirl, one, two = ([*reversed(column)] for column in coefficients)
    out = [*mpmath.polyval(b, h, derivative=True)]
    out += [mpmath.polyval(column, h) for column in (alpha, z, swirl)]
    return [*out, *mpmath.polyval(one, h, derivative=True), *mpmath.polyval(two, h, derivative=True)]


def march(named: Named) -> dict[str, Any]:
    """The reference of one case, in the units of the case (beta' per length, z and swirl as length)."""
    at = numbers(named.case)
    lam, mu, phi, rho = at["lam"], at["mu"], at["phi"], at["rho"]
    state = [at["beta"], at["v"], mpf(0), mpf(0), mpf(0), mpf(1), mpf(0), mpf(0), mpf(1)]
    t, condition, rows = mpf(0), mpf(1), []
    for share in SHARES:
        goal = at["span"] * mpf(share)
        while t < goal:
            coefficients = series(state, lam, mu, phi)
            tail = max(max(abs(x[-1]), abs(x[-2])) / max(1, abs(x[0])) for x in coefficients)
            h = min((mpf(10) ** -(DIGITS - 4) / tail) ** (mpf(1) / ORDER) if tail else goal - t, goal - t)
            for part in (h / 3, 2 * h / 3, h):
                here = state_after(coefficients, part)
                condition = max(condition, abs(here[5]), abs(here[7]))
            state, t = here, t + h
        b, v, alpha, z, swirl = state[:5]
        rows.append([float(b), float(v / rho), float(alpha), float(z * rho), float(swirl)])
    beta, dbeta, alpha, z, swirl = (list(column) for column in zip(*rows, strict=True))
    return {
        "beta": beta, "dbeta": dbeta, "alpha": alpha, "z": z, "swirl": swirl,
        "condition": float(f"{float(condition):.3g}"),
    }  # fmt: skip


def main(names: list[str]) -> None:
    mpmath.mp.dps = DIGITS
    old = json.loads(FILE.read_text(encoding="utf-8"))["cases"] if FILE.exists() and names else {}
    cases = {}
    for name, named in START.items():
        if names and name not in names and name in old:
            cases[name] = old[name]
            continue
        cases[name] = march(named)
        print(name, cases[name]["beta"][-1], cases[name]["condition"], flush=True)
    rows = ",\n".join(f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in cases.items())
    about = f"Taylor series of order {ORDER} in {DIGITS} digits, by benchmarks/make_references.py"
    text = f'{{\n"about": "{about}",\n"u": {json.dumps(SHARES)},\n"cases": {{\n{rows}\n}}\n}}\n'
    FILE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
