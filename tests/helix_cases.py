"""Seeded random start problems next to a helix and next to a fold (H = H' = 0), where orbits are small or slow."""

from typing import Any

import numpy as np

from solver.orbits.boundary import critical_points
from solver.problem.dimensionless import Reduced, StartProblem, reduce
from tests.extreme_cases import KINDS, draw
from tests.variation import work

NEAR = ("plain", "centre", "fold", "fold at an end of the axis")
WORK = 200.0  # radians at the most that the rods swing through: what a march reaches in seconds


def problems(kind: str, n: int, seed: int, most: float = WORK) -> StartProblem:
    """At most n problems of one kind: of those of `extreme_cases` the ones within a march's reach, or near a helix."""
    with np.errstate(all="ignore"):
        p = reduce(draw(4 * n, seed, kind)) if kind in KINDS else _near(kind, n, np.random.default_rng([seed, 7]))
        fit = np.isfinite(np.stack([p.lam, p.mu, p.phi, p.span, p.beta0, p.dbeta0])).all(axis=0)
        fit &= work(p.lam, p.mu, p.phi, p.span, p.dbeta0) < most
    return p.take(np.flatnonzero(fit)[:n])


def _signed(rng: Any, low: float, high: float, n: int, zero: float = 0.0) -> Any:
    """10^low to 10^high of either sign, or 0 with the probability `zero`."""
    return 10.0 ** rng.uniform(low, high, n) * rng.choice([-1.0, 1.0], n) * (rng.random(n) >= zero)


def _near(kind: str, n: int, rng: Any) -> StartProblem:
    span, v = 10 ** rng.uniform(0, 1.6, n), _signed(rng, -17, -1, n, 0.5)
    lam, mu, phi = (_signed(rng, -2, 1, n) for _ in range(3))
    if kind == "plain":
        return StartProblem(lam, mu, phi, span, rng.uniform(-np.pi, np.pi, n), _signed(rng, -8, 0.5, n))
    off = _signed(rng, -17, -1, n, 0.1)
    if kind == "centre":
        found = critical_points(Reduced(lam, mu, phi, span, lam))
        chance = np.where(found.centre, rng.random(found.beta.shape), -1.0)
        at = found.beta[np.arange(n), chance.argmax(axis=1)]
        return StartProblem(lam, mu, phi, span, at + off, v)
    if kind == "fold":  # lam and phi follow from H = H' = 0 at an angle
        at = rng.uniform(-np.pi, np.pi, n)
        s, c = np.sin(at), np.cos(at)
        level = mu * np.cos(2 * at) + 2 * c * s**3
        tilt = -2 * mu * np.sin(2 * at) + 2 * s * s * (3 * c * c - s * s)
        lam, phi = level * c - tilt * s, -level * s - tilt * c
        return StartProblem(lam * (1 + _signed(rng, -17, -1, n, 0.5)), mu, phi, span, at + off, v)
    side = rng.choice([-1.0, 1.0], n)
    mu, phi = _signed(rng, -3, 1, n, 0.3), _signed(rng, -17, 1, n, 0.3)
    return StartProblem(side * mu, mu, phi, span, np.where(side > 0, 0, np.pi) + off, v)
