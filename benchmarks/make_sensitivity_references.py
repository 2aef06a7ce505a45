"""Writes tests/sensitivity_references.json: derivatives of orbits by Taylor series in fifty digits.

Run from the checkout: `.venv/bin/python -m benchmarks.make_sensitivity_references` (ten minutes). Each case is marched
with the five variational equations beside it: a family apart from the solver, which marches nothing. An ends problem is
a start problem whose beta_t(0) Newton's rule finds in fifty digits, and its derivatives follow from those at the start.
"""

import json
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np

from solver import equilibria
from solver.problem.dimensionless import reduce
from tests.cases import START, ends_in_units_of_rho

NAMES = (
    "catenary", "elliptic k=0.25 L=20", "helix at a centre", "helix at a saddle", "force-first/tension/solid",
    "shear/compression/paper", "many equilibria", "going round backwards", "from a far angle", "inside, twisted",
    "nearly straight", "long", "turning 0.0001 before a saddle", "passing a saddle at 1e-06",
)  # fmt: skip
REFERENCE = (-0.3655, 0.7464, -0.7506, 20.0, np.pi / 6, np.pi / 6)  # 31 equilibria
TAKEN = (0, 2, 6, 12, 20)  # of them; the first stays near a saddle for most of its length
SHARES = (0.17, 0.5, 0.83, 1.0)  # of the length
ORDER, DIGITS = 30, 50
State, Sides = list[Any], list[list[Any]]


def series(state: State, sides: Sides, loads: State) -> tuple[list[Any], list[list[Any]]]:
    """Coefficients of beta, beta_t, alpha, z and the swirl, and of the same of five variations."""
    lam, mu, phi = loads
    zero = mp.mpf(0)
    b, v, s, c = ([zero] * (ORDER + 1) for _ in range(4))
    b[0], v[0], s[0], c[0] = state[0], state[1], mp.sin(state[0]), mp.cos(state[0])
    s2: State = []
    c2: State = []
    s4, c4, rate = [], [], []
    sums = [[total] + [zero] * ORDER for total in state[2:]]
    y, w = ([[side[k]] + [zero] * ORDER for side in sides] for k in (0, 1))
    moved = [[[total] + [zero] * ORDER for total in side[2:]] for side in sides]

    def product(p: State, q: State, k: int) -> Any:
        return mp.fdot(p[: k + 1], [q[k - i] for i in range(k + 1)])

    for k in range(ORDER):
        one, n = int(k == 0), k + 1
        s2.append(2 * product(s, c, k))
        c2.append(one - 2 * product(s, s, k))
        s4.append(2 * product(s2, c2, k))
        c4.append(one - 2 * product(s2, s2, k))
        force = lam * c[k] - mu * c2[k] - phi * s[k] - s2[k] / 2 + s4[k] / 4
        rate.append(-lam * s[k] + 2 * mu * s2[k] - phi * c[k] - c2[k] + c4[k])
        b[n], v[n] = v[k] / n, -force / n
        s[n], c[n] = product(v, c, k) / n, -product(v, s, k) / n
        for j, by_load in enumerate((zero, zero, c[k], -c2[k], -s[k])):
            y[j][n], w[j][n] = w[j][k] / n, -(product(rate, y[j], k) + by_load) / n
            moved[j][0][n], moved[j][1][n] = product(c, y[j], k) / n, -product(s, y[j], k) / n
            moved[j][2][n] = product(c2, y[j], k) / n
        sums[0][n], sums[1][n], sums[2][n] = s[k] / n, c[k] / n, s2[k] / 2 / n
    return [b, v, *sums], [[y[j], w[j], *moved[j]] for j in range(5)]


def at(coefficients: Any, h: Any) -> Any:
    return mp.polyval(coefficients[::-1], h)


def march(numbers: State, times: State) -> list[tuple[State, Sides]]:
    """The state and the variations by beta(0), beta_t(0), lam, mu, phi at rising times."""
    lam, mu, phi, beta0, v0 = numbers
    zero, now, out = mp.mpf(0), mp.mpf(0), []
    state, sides = [beta0, v0, zero, zero, zero], [[mp.mpf(int(j == k)) for k in range(5)] for j in range(5)]
    sides = [side if j < 2 else [zero] * 5 for j, side in enumerate(sides)]
    while len(out) < len(times):
        own, varied = series(state, sides, [lam, mu, phi])
        rows = [*own[:2], *(row for side in varied for row in side[:2])]
        reach = mp.mpf(2)
        for row in rows:
            for k in (ORDER - 1, ORDER):
                if row[k]:
                    size = max(abs(row[0]), 1)
                    reach = min(reach, (mp.mpf(10) ** (8 - DIGITS) * size / abs(row[k])) ** (mp.mpf(1) / k))
        while len(out) < len(times) and times[len(out)] - now <= reach:
            h = times[len(out)] - now
            out.append(([at(row, h) for row in own], [[at(row, h) for row in side] for side in varied]))
        state, sides = [at(row, reach) for row in own], [[at(row, reach) for row in side] for side in varied]
        now += reach
    return out


def exact(values: Any) -> State:
    return [mp.mpf(float(value)) for value in values]


def start_row(name: str) -> dict[str, Any]:
    p = reduce(START[name].case)
    numbers = exact(getattr(p, key)[0] for key in ("lam", "mu", "phi", "beta0", "dbeta0"))
    span = mp.mpf(float(p.span[0]))
    found = march(numbers, [span * mp.mpf(share) for share in SHARES])
    return {"jacobian": [[[float(side[m]) for side in sides] for m in range(5)] for _, sides in found]}


def ends_row(place: int) -> dict[str, Any]:
    case = ends_in_units_of_rho(*REFERENCE)
    solution = equilibria(case, stations=3)[place].solution
    p = solution.problem
    lam, mu, phi, span, beta0, betaL = exact(getattr(p, k)[0] for k in ("lam", "mu", "phi", "span", "beta0", "betaL"))
    slope = mp.mpf(float(solution.trajectory.dbeta[0, 0]))
    for _ in range(20):
        ((state, sides),) = march([lam, mu, phi, beta0, slope], [span])
        step = (betaL - state[0]) / sides[1][0]
        slope += step
        if abs(step) < mp.mpf(10) ** -35:
            break
    found = march([lam, mu, phi, beta0, slope], [span * mp.mpf(share) for share in SHARES])
    end = found[-1][1]
    rows = []
    for _, sides in found:
        # each other direction with as much of beta_t(0) as leaves beta(L) where it is
        follows = [sides[1][m] / end[1][0] for m in range(5)]
        rows.append([
            [float(follows[m] if j == 1 else sides[j][m] - follows[m] * end[j][0]) for j in range(5)] for m in range(5)
        ])  # fmt: skip
    return {"dbeta0": float(slope), "jacobian": rows}


def main() -> None:
    with mp.workdps(DIGITS):
        cases = {name: start_row(name) for name in NAMES}
        ends = {str(place): ends_row(place) for place in TAKEN}
    data = {"shares": SHARES, "reference": REFERENCE, "start": cases, "ends": ends}
    path = Path(__file__).resolve().parents[1] / "tests" / "sensitivity_references.json"
    path.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
