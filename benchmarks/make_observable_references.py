"""Writes tests/observable_references.json: derivatives of observables by differences in fifty digits.

Run from the checkout: `.venv/bin/python -m benchmarks.make_observable_references` (some minutes). Each rod is marched
by Taylor series in fifty digits from the fields of its case; zeros and extremes are found on the series, and a field is
moved by 1e-13 of its size to both sides, so that a difference keeps more than twenty digits.
"""

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import mpmath as mp

ORDER, DIGITS, STEP = 30, 50, "1e-13"
NAMES = ("pitch", "push_middle", "lift_off_at", "F3_size_max", "bending_stress_max", "push_max_at")
FIELDS = ("E", "nu", "a", "L", "R", "beta0", "dbeta0", "F1", "F2", "F3")
CASES = {
    "lifts off at its start": ["outside", 1.07e4, 0.25, 0.25, 9.0, 0.75, 0.5, 0.5, 5.0, 1.0, 10.0],
    "pushes, then lifts off": ["inside", 1.07e4, 0.25, 0.25, 9.0, 1.25, 0.6, 0.3, 2.0, 1.0, -12.0],
    "pushes all along": ["inside", 1.07e4, 0.25, 0.25, 5.0, 1.25, 0.7, 0.02, -0.97, -6.7, -21.6],
    "lifts off in its first bend": ["outside", 2e4, 0.3, 0.2, 12.0, 0.8, 1.4, 0.4, 1.0, 0.5, 3.0],
}
Numbers = dict[str, Any]


class Rod:
    """The series of sin, cos, beta, beta_t, alpha and z of one rod, in units of A and rho."""

    def __init__(self, n: Numbers) -> None:
        self.A, self.sign = mp.pi / 4 * n["E"] * n["a"] ** 4, n["sign"]
        self.rho = n["R"] + self.sign * n["a"]
        s, c = mp.sin(n["beta0"]), mp.cos(n["beta0"])
        m = n["F1"] / (self.A * n["dbeta0"]) + 3 * s * c / self.rho
        FY, FZ = n["F3"] * s - n["F2"] * c, n["F2"] * s + n["F3"] * c
        self.mu, self.phi = m * self.rho, FZ * self.rho**2 / self.A
        self.lam = self.rho**2 * FY / self.A + self.mu * c + s**3
        self.span = n["L"] / self.rho
        self.pieces: list[tuple[Any, list[Any]]] = []
        state, now = [n["beta0"], n["dbeta0"] * self.rho, mp.mpf(0), mp.mpf(0)], mp.mpf(0)
        while now < self.span:
            rows = self._series(state)
            reach = mp.mpf("0.5")
            for row in rows:
                for k in (ORDER - 1, ORDER):
                    if row[k]:
                        reach = min(reach, (mp.mpf(10) ** (4 - DIGITS) / abs(row[k])) ** (mp.mpf(1) / k))
            self.pieces.append((now, rows))
            state, now = [mp.polyval(row[::-1], reach) for row in rows], now + reach

    def _series(self, state: list[Any]) -> list[Any]:
        b, v, alpha, z, s, c = ([value] + [mp.mpf(0)] * ORDER for value in (*state, mp.sin(state[0]), mp.cos(state[0])))
        ss: list[Any] = []
        sss: list[Any] = []

        def product(p: Any, q: Any, k: int) -> Any:
            return mp.fdot(p[: k + 1], [q[k - i] for i in range(k + 1)])

        for k in range(ORDER):
            ss.append(product(s, s, k))
            sss.append(product(ss, s, k))
            cos2 = int(k == 0) - 2 * ss[k]
            H = self.lam * c[k] - self.mu * cos2 - self.phi * s[k] - 2 * product(sss, c, k)
            b[k + 1], v[k + 1] = v[k] / (k + 1), -H / (k + 1)
            s[k + 1], c[k + 1] = product(v, c, k) / (k + 1), -product(v, s, k) / (k + 1)
            alpha[k + 1], z[k + 1] = s[k] / (k + 1), c[k] / (k + 1)
        return [b, v, alpha, z]

    def at(self, t: Any) -> list[Any]:
        begin, rows = next(piece for piece in reversed(self.pieces) if piece[0] <= t)
        return [mp.polyval(row[::-1], t - begin) for row in rows]

    def push(self, t: Any) -> Any:
        b, v = self.at(t)[:2]
        s, c = mp.sin(b), mp.cos(b)
        H = self.lam * c - self.mu * mp.cos(2 * b) - (self.phi + 2 * c * s * s) * s
        f = s * (self.lam - self.mu * c - s**3) + H * (3 * s * c - self.mu) - 3 * v * v * mp.cos(2 * b)
        return self.sign * f

    def kappa_rate(self, t: Any) -> Any:
        """Of kappa^2/2, without its factor beta_t."""
        b, _ = self.at(t)[:2]
        s, c = mp.sin(b), mp.cos(b)
        return -(self.lam * c - self.mu * mp.cos(2 * b) - (self.phi + 2 * c * s * s) * s) + 2 * s**3 * c

    def push_rate(self, t: Any) -> Any:
        """Of the push, without its factor beta_t."""
        b, v = self.at(t)[:2]
        s, c, cos2 = mp.sin(b), mp.cos(b), mp.cos(2 * b)
        H = self.lam * c - self.mu * cos2 - (self.phi + 2 * c * s * s) * s
        H_beta = -self.lam * s + 2 * self.mu * mp.sin(2 * b) - self.phi * c - 6 * s * s * c * c + 2 * s**4
        across = c * (self.lam - self.mu * c - s**3) + s * (self.mu * s - 3 * s * s * c)
        return self.sign * (across + H_beta * (3 * s * c - self.mu) + 9 * H * cos2 + 6 * v * v * mp.sin(2 * b))

    def tension(self, t: Any) -> Any:
        b = self.at(t)[0]
        s, c = mp.sin(b), mp.cos(b)
        return self.phi * c + (self.lam - self.mu * c - s**3) * s

    def tension_rate(self, t: Any) -> Any:
        """Of the tension, by beta."""
        b = self.at(t)[0]
        s, c = mp.sin(b), mp.cos(b)
        return -self.phi * s + c * (self.lam - self.mu * c - s**3) + s * (self.mu * s - 3 * s * s * c)

    def zeros(self, read: Any, low: Any, high: Any) -> list[Any]:
        count = 600
        at = [low + (high - low) * k / count for k in range(count + 1)]
        seen = [read(t) for t in at]
        pairs = zip(pairwise(at), pairwise(seen), strict=True)
        return [mp.findroot(read, ends, solver="anderson", tol=1e-80) for ends, two in pairs if two[0] * two[1] < 0]

    def extremes(self, rate: Any) -> list[Any]:
        turning = self.zeros(lambda t: self.at(t)[1], mp.mpf(0), self.span)
        return [mp.mpf(0), self.span, *turning, *self.zeros(rate, mp.mpf(0), self.span)]


def observables(n: Numbers) -> list[Any]:
    rod = Rod(n)
    third, far = rod.span / 3, 2 * rod.span / 3
    (_, _, alpha1, z1), (_, _, alpha2, z2) = rod.at(third), rod.at(far)
    ends = [third, *rod.zeros(rod.push, third, far), far]
    pushed = sum(mp.quad(rod.push, [a, b]) for a, b in pairwise(ends) if rod.push((a + b) / 2) > 0)
    zeros = [t for t in rod.zeros(rod.push, mp.mpf(0), rod.span) if rod.push(t + mp.mpf("1e-6")) < 0]
    first = mp.mpf(0) if rod.push(mp.mpf(0)) < 0 else min([*zeros, rod.span])
    force = max(abs(rod.tension(t)) for t in rod.extremes(rod.tension_rate))
    peaks = [(rod.push(t), t) for t in rod.extremes(rod.push_rate)]
    least = max(peaks)[0] - mp.mpf(10) ** (-DIGITS // 2)
    place = min(t for push, t in peaks if push > least)  # of equal ones the first
    states = [rod.at(t) for t in rod.extremes(rod.kappa_rate)]
    kappa = max(mp.sqrt(v * v + mp.sin(b) ** 4) for b, v, _, _ in states) / rod.rho
    return [
        2 * mp.pi * rod.rho * (z2 - z1) / abs(alpha2 - alpha1), 3 * pushed * rod.A / (rod.rho**3 * rod.span),
        first * rod.rho, force * rod.A / rod.rho**2, n["E"] * n["a"] * kappa, place * rod.rho,
    ]  # fmt: skip


def derivatives(row: list[Any]) -> dict[str, list[float]]:
    side, *values = row
    n = {"sign": mp.mpf(1 if side == "outside" else -1)}
    n |= {name: mp.mpf(value) for name, value in zip(FIELDS, values, strict=True)}
    found = {}
    for name in FIELDS:
        h = mp.mpf(STEP) * abs(n[name])
        up, down = (observables(n | {name: n[name] + turn * h}) for turn in (1, -1))
        found[name] = [float((a - b) / (2 * h)) for a, b in zip(up, down, strict=True)]
    return found


def main() -> None:
    with mp.workdps(DIGITS):
        rows = {name: {"case": row, "derivatives": derivatives(row)} for name, row in CASES.items()}
    path = Path(__file__).resolve().parents[1] / "tests" / "observable_references.json"
    path.write_text(json.dumps({"observables": NAMES, "cases": rows}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
