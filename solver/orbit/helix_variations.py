"""Variations of a helix: eta'' + H' eta = -H_q dq with constant coefficients, in closed form."""

import numpy as np

from ..mechanics.potential import slope_rate, slopes_by_loads
from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from .variations import Change

_SERIES = 1.0  # below this |z| the functions are summed


def start(problem: Reduced, t: Array) -> Change:
    """The change of B helices at t (B, n) by a unit of beta(0), beta_t(0), lam, mu and phi, (B, n, 5) each."""
    beta0 = problem.beta0
    rate = slope_rate(problem, beta0)[:, None]
    C, S, S2, S3 = _waves(rate, t)
    return _change(beta0, (C, -rate * S, S), (S, C, S2), (S2, S, S3))


def held(problem: Reduced, t: Array) -> Change:
    """The same by a unit of beta(0), beta(L), lam, mu and phi, each with the other end held."""
    beta0, span = problem.beta0, problem.span[:, None]
    rate = slope_rate(problem, beta0)[:, None]
    with np.errstate(all="ignore"):
        C, S, S2, S3 = _waves(rate, t)
        C_L, S_L, S2_L, _ = _waves(rate, span)
        first = C - C_L / S_L * S, -rate * S - C_L / S_L * C, S - C_L / S_L * S2
        second = S / S_L, C / S_L, S2 / S_L
        forced = S2 - S2_L / S_L * S, S - S2_L / S_L * C, S3 - S2_L / S_L * S2
        steep = rate * span**2 < -_SERIES
        far = _between_saddles(np.sqrt(np.abs(rate)), t, span)
        near = _between_saddles(np.sqrt(np.abs(rate)), span - t, span)
        whole = _between_saddles(np.sqrt(np.abs(rate)), span, span)[2]
    mirrored = near[0], -near[1], whole - near[2]
    shifts = ((size - a - b) / rate for size, a, b in zip((1.0, 0.0, t), far, mirrored, strict=True))
    chosen = (
        tuple(np.where(steep, a, b) for a, b in zip(*pair, strict=True))
        for pair in ((mirrored, first), (far, second), (tuple(shifts), forced))
    )
    return _change(beta0, *chosen)


def _change(beta0: Array, first: tuple[Array, ...], second: tuple[Array, ...], forced: tuple[Array, ...]) -> Change:
    """The change from value, rate and integral of eta by the two ends, and by -H_q = 1."""
    H_q = slopes_by_loads(beta0[:, None])[..., 0]
    values, rates, sums = (
        np.concatenate([by_start[..., None], two[..., None], -three[..., None] * H_q[:, None, :]], axis=-1)
        for by_start, two, three in zip(first, second, forced, strict=True)
    )
    return Change(values, rates, sums[..., None] * H_q[:, None, None, :])


def _waves(rate: Array, t: Array) -> tuple[Array, Array, Array, Array]:
    """The solution of eta'' = -rate eta that begins as 1, and its first three integrals."""
    z = rate * t * t
    small = np.abs(z) < _SERIES
    with np.errstate(all="ignore"):
        root = np.sqrt(np.abs(z))
        even = np.where(z > 0, np.cos(root), np.cosh(root))
        odd = np.where(z > 0, np.sin(root), np.sinh(root)) / root
        waves = [even, odd, (1 - even) / z, (1 - odd) / z]
    for k in range(4):
        term = total = np.ones_like(z) / (1, 1, 2, 6)[k]
        for n in range(1, 12):
            term = -term * np.where(small, z, 0.0) / ((2 * n + k - 1) * (2 * n + k))
            total = total + term
        waves[k] = np.where(small, total, waves[k])
    C, S, S2, S3 = (value * t**k for k, value in enumerate(waves))
    return C, S, S2, S3


def _between_saddles(k: Array, t: Array, span: Array) -> tuple[Array, Array, Array]:
    """sinh(k t)/sinh(k span), its derivative and its integral, without overflow."""
    scale = np.exp(-k * (span - t)) / -np.expm1(-2 * k * span)
    fall = np.exp(-k * t)
    return scale * -np.expm1(-2 * k * t), k * scale * (1 + fall * fall), scale * np.expm1(-k * t) ** 2 / k
