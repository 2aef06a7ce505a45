"""Variations of orbits and of equilibria by the compiled core, against a march and against differences."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solver.orbit.periodic_orbit import TIGHT, solve_orbit
from solver.orbit.pieces import HELIX
from solver.orbit.variations import Variations, variations_on
from solver.problem.reduced import StartProblem


def variations(seed: int, size: int) -> Variations:
    """The variations of random orbits."""
    rng = np.random.default_rng(seed)
    loads, ends = rng.normal(size=(3, size)) * [[2.0], [1.0], [2.0]], rng.uniform(-4, 4, size)
    problem = StartProblem(*loads, 10 ** rng.uniform(0, 2, size), ends, 1.5 * rng.normal(size=size))
    orbit = solve_orbit(problem, TIGHT)
    assert not (orbit.kind == HELIX).any()
    return variations_on(orbit)


def test_variations_are_those_of_a_march_of_the_variational_equation() -> None:
    """eta'' + H' eta = -H_q, and the integrals of H_q eta, by a Runge-Kutta rule of order 8."""
    found = variations(2, 12)
    p = found.orbit.problem
    rows = np.flatnonzero(p.span < 12)[:4]
    change = found.change(p.span[:, None], found.directions)
    assert rows.size == 4
    for i in rows:
        loads = float(p.lam[i]), float(p.mu[i]), float(p.phi[i])
        marched = march(loads, float(p.beta0[i]), float(p.dbeta0[i]), float(p.span[i]))
        own = np.column_stack([change.beta[i, 0], change.rate[i, 0], change.integrals[i, 0]])
        assert own == pytest.approx(marched, rel=1e-8, abs=1e-8 * np.abs(marched).max())


def march(loads: tuple[float, float, float], beta0: float, rate0: float, span: float) -> Any:
    """At the far end, by beta(0), beta_t(0), lam, mu and phi: eta, eta_t and the integrals of H_q eta, (5, 5)."""
    lam, mu, phi = loads

    def rates(_: float, state: Any) -> Any:
        beta, s, c = state[0], np.sin(state[0]), np.cos(state[0])
        H = lam * c - mu * np.cos(2 * beta) - (phi + 2 * c * s * s) * s
        slope = -lam * s + 2 * mu * np.sin(2 * beta) - phi * c - 2 * (3 * s * s * c * c - s**4)
        by_loads = np.array([c, -np.cos(2 * beta), -s])
        eta, eta_t = state[2:7], state[7:12]
        forced = np.concatenate([[0, 0], by_loads])
        return np.concatenate([[state[1], -H], eta_t, -slope * eta - forced, np.outer(eta, by_loads).ravel()])

    begin = np.concatenate([[beta0, rate0], [1, 0, 0, 0, 0], [0, 1, 0, 0, 0], np.zeros(15)])
    end = solve_ivp(rates, (0, span), begin, method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    integrals = -end[12:].reshape(5, 3)  # H_lam is minus the derivative of sin(beta), and so on
    return np.column_stack([end[2:7], end[7:12], -integrals])
