"""How a change of the start grows along a rod: the variational equation marched beside the orbit, many rods at once.

A family apart from the solver: the Runge-Kutta rule of order 8 of Prince and Dormand (its coefficients are SciPy's), in
equal steps that resolve the quickest wave H' allows, with no knowledge of period, turning point or saddle.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate._ivp import dop853_coefficients as rule

Array = NDArray[Any]
_STEP = 0.1  # of the quickest wave, rad


def quickest(lam: Any, mu: Any, phi: Any) -> Any:
    """The root of a bound of |H'|."""
    return np.sqrt(np.abs(lam) + 2 * np.abs(mu) + np.abs(phi) + 2)


def work(lam: Any, mu: Any, phi: Any, span: Any, v0: Any) -> Any:
    """What a march has to go through [rad]."""
    return span * (quickest(lam, mu, phi) + np.abs(v0))


def weight(lam: Any, mu: Any, phi: Any, beta: Any, v0: Any) -> Any:
    """w = max(1, |beta_t(0)|, sqrt|H'(beta(0))|), H' written as in the physics notes."""
    s, c = np.sin(beta), np.cos(beta)
    rate = -lam * s + 2 * mu * np.sin(2 * beta) - phi * c - 2 * (3 * s**2 * c**2 - s**4)
    return np.maximum(np.maximum(1, np.abs(v0)), np.sqrt(np.abs(rate)))


def growth(lam: Any, mu: Any, phi: Any, span: Any, beta0: Any, v0: Any) -> Array:
    """Largest |d beta/d beta(0)| and w |d beta/d beta_t(0)| over [0, span], at least 1, (B,)."""
    lam, mu, phi, span, beta0, v0 = (np.asarray(x, dtype=float) for x in (lam, mu, phi, span, beta0, v0))
    one = np.ones(beta0.size)
    w = weight(lam, mu, phi, beta0, v0)
    steps = np.ceil(work(lam, mu, phi, span, v0) / _STEP).astype(int) + 4
    worst = one.copy()
    order = np.argsort(steps)
    for some in np.array_split(order, max(1, min(40, order.size // 50))):
        loads = lam[some], mu[some], phi[some]
        state = np.stack([beta0[some], v0[some], one[some], 0 * one[some], 0 * one[some], one[some]])
        n = int(steps[some].max())
        h = span[some] / n
        for _ in range(n):
            state = state + h * _increment(state, h, loads)
            grown = np.maximum(np.abs(state[2]), w[some] * np.abs(state[4]))
            worst[some] = np.fmax(worst[some], grown)
    return worst


def _increment(state: Array, h: Array, loads: tuple[Array, Array, Array]) -> Array:
    stages = np.empty((rule.N_STAGES, *state.shape))
    for k in range(rule.N_STAGES):
        at = state if k == 0 else state + h * np.einsum("i,i...->...", rule.A[k, :k], stages[:k])
        stages[k] = _rates(at, loads)
    return np.asarray(np.einsum("i,i...->...", rule.B, stages))


def _rates(state: Array, loads: tuple[Array, Array, Array]) -> Array:
    """Rates of beta, beta_t, eta, eta_t, zeta, zeta_t."""
    lam, mu, phi = loads
    s, c = np.sin(state[0]), np.cos(state[0])
    s2, c2 = 2 * s * c, (c - s) * (c + s)
    pull = lam * c - mu * c2 - (phi + 2 * c * s * s) * s
    rate = -lam * s + 2 * mu * s2 - phi * c - 2 * s * s * (3 * c * c - s * s)
    return np.stack([state[1], -pull, state[3], -rate * state[2], state[5], -rate * state[4]])
