"""The equation of the rod, written anew from the physics notes and marched by SciPy: it shares nothing with the solver.

Everything is in units of rho and A, so that beta_tt = -H(beta).
"""

from math import cos, sin
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from solver import Case

BY = ("beta0", "rate0", "lam", "mu", "phi")  # what the columns of a march are derivatives by


def potential(b: Any, lam: float, mu: float, phi: float) -> Any:
    """G."""
    s, c = np.sin(b), np.cos(b)
    return (2 * (lam - mu * c) - s**3) * s + 2 * phi * c


def force(b: Any, lam: float, mu: float, phi: float) -> Any:
    """H."""
    s, c = np.sin(b), np.cos(b)
    return lam * c - mu * np.cos(2 * b) - (phi + 2 * c * s * s) * s


def force_rate(b: Any, lam: float, mu: float, phi: float) -> Any:
    """H'."""
    s, c = np.sin(b), np.cos(b)
    return -lam * s + 2 * mu * np.sin(2 * b) - phi * c - 6 * s * s * c * c + 2 * s**4


def march(loads: Any, beta0: Any, rate0: Any, span: float, tol: float = 1e-12, **how: Any) -> Any:
    """What `solve_ivp` answers for beta and beta_t, (2, n); for arrays of starts all beta and then all beta_t."""
    start = np.concatenate([np.atleast_1d(beta0) + 0.0 * np.atleast_1d(rate0), np.atleast_1d(rate0)])

    def rates(_: float, y: Any) -> Any:
        beta, rate = np.split(y, 2)
        return np.concatenate([rate, -force(beta, *loads)])

    return solve_ivp(rates, (0, span), start, "DOP853", rtol=tol, atol=tol, **how)


def march_with_variations(loads: Any, beta0: float, rate0: float, t: Any, tol: float = 1e-12) -> tuple[Any, Any, Any]:
    """At t (n,): beta, beta_t, azimuth, height and half the integral of sin(2 beta), (5, n); their derivatives `BY`,
    (5, 5, n); and the second derivative of beta by rate0, (n,)."""
    lam, mu, phi = loads

    def rates(_: float, y: Any) -> Any:
        b, eta = float(y[0]), y[5:10]
        s, c, turn = sin(b), cos(b), cos(2 * b)
        slope, found = force_rate(b, *loads), np.empty(32)
        bend = -lam * c + 4 * mu * turn + phi * s - 12 * s * c**3 + 20 * s**3 * c  # H''
        found[:5] = y[1], -force(b, *loads), s, c, s * c
        found[5:10], found[10:15] = y[10:15], -slope * eta
        found[12:15] -= c, -turn, -s
        found[15:20], found[20:25], found[25:30] = c * eta, -s * eta, turn * eta
        found[30:] = y[31], -slope * y[30] - bend * eta[1] ** 2
        return found

    start = np.zeros(32)
    start[[0, 1, 5, 11]] = beta0, rate0, 1.0, 1.0
    y = solve_ivp(rates, (0, np.max(t)), start, "DOP853", t_eval=np.atleast_1d(t), rtol=tol, atol=tol).y
    return y[:5], y[5:30].reshape(5, 5, -1), y[30]


def loads_of(case: Case) -> tuple[float, float, float]:
    """lam, mu and phi of one case."""
    A, rho = float(case.rod.bending_stiffness), float(case.rho)
    FZ, MZ, M3 = (float(load) / A for load in case.loads)
    return MZ * rho, M3 * rho, FZ * rho**2


def far_angle(case: Case, dbeta0: float) -> float:
    """beta(L) of the rod of an ends problem that starts with that dbeta."""
    rho = float(case.rho)
    span = float(case.rod.L) / rho
    return float(march(loads_of(case), case.given.beta0, dbeta0 * rho, span, 1e-13).y[0, -1])
