"""Seeded random start problems over the whole range that a float may ask for, on every kind of orbit.

E 1e-9..1e15, R 1e-9..1e9 times a, L/rho 1e-6..1e9, nu over (-1, 0.5] and at its ends, loads 0 and 1e-12..1e12, beta0 at
and next to 0, pi/2, pi; starts on helices, on separatrices, and next to both down to rounding. All log-uniform.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import Case, Cylinder, Rod, Start
from solver.orbits.boundary import critical_points
from solver.orbits.potential import potential
from solver.problem.dimensionless import Reduced
from tests.cases import start_of

KINDS = ("loads", "forces", "helix", "separatrix", "gap", "tension")
Array = NDArray[Any]


def log_uniform(rng: Any, low: float, high: float, n: int) -> Array:
    return 10.0 ** rng.uniform(np.log10(low), np.log10(high), n)


def signed(rng: Any, low: float, high: float, n: int, zero: float = 0.15) -> Array:
    """0 with the probability `zero`, else of either sign and log-uniform size."""
    return log_uniform(rng, low, high, n) * rng.choice([-1.0, 1.0], n) * (rng.random(n) >= zero)


def angles(rng: Any, n: int) -> Array:
    """Any angle; 0, pi/2, pi; next to these by one bit, and by 1e-16..1e-3."""
    special = rng.choice([0.0, np.pi / 2, np.pi, -np.pi / 2, -np.pi], n)
    beside = np.nextafter(special, special + rng.choice([-1.0, 1.0], n))
    near = special + signed(rng, 1e-16, 1e-3, n)
    return np.choose(rng.choice(4, n, p=[0.4, 0.2, 0.1, 0.3]), [rng.uniform(-np.pi, np.pi, n), special, beside, near])


def ratios(rng: Any, n: int) -> Array:
    """Poisson's ratio: anywhere, at its ends, and next to -1."""
    low = np.nextafter(-1.0, 0.0)
    near = -1 + log_uniform(rng, 1e-15, 1e-1, n)
    return np.choose(
        rng.choice(4, n, p=[0.55, 0.15, 0.15, 0.15]),
        [rng.uniform(-0.9, 0.5, n), np.full(n, 0.5), near, np.full(n, low)],
    )


def draw(n: int, seed: int, kind: str = "loads", side: str = "outside") -> Case:
    """n cases of one kind as one batch."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    E, a = log_uniform(rng, 1e-9, 1e15, n), log_uniform(rng, 1e-3, 1e1, n)
    R = a * (log_uniform(rng, 1e-9, 1e9, n) + (0 if side == "outside" else 1))
    cylinder = Cylinder(R, side)
    rho = R + a if side == "outside" else R - a
    rod = Rod(E, ratios(rng, n), a, rho * log_uniform(rng, 1e-6, 1e9, n))
    if kind == "forces":
        return Case(rod, cylinder, _forces(rng, n))
    lam, mu, phi, beta, v = _MAKERS[kind](rng, n)
    return Case(rod, cylinder, start_of(rod, rho, lam / rho, mu / rho, phi / rho**2, beta, v / rho))


def _forces(rng: Any, n: int) -> Start:
    """Forces and rates as the user types them."""
    F2, F3, dgamma, dbeta = (signed(rng, 1e-12, 1e12, n) for _ in range(4))
    return Start(angles(rng, n), dbeta, F2=F2, F3=F3, dgamma=dgamma)


def _loads(rng: Any, n: int) -> tuple[Array, ...]:
    lam, mu, phi = (signed(rng, 1e-12, 1e12, n, 0.3) for _ in range(3))
    v = signed(rng, 1e-12, 1e6, n, 0.3)
    return lam, np.where(rng.random(n) < 0.15, lam, mu), phi, angles(rng, n), v


def _moderate(rng: Any, n: int) -> tuple[Array, Array, Array]:
    """Loads with a landscape: mostly near 1, sometimes far."""
    wide = rng.random(n) < 0.3
    lam, mu, phi = (np.where(wide, signed(rng, 1e-12, 1e12, n), signed(rng, 1e-2, 1e1, n)) for _ in range(3))
    return np.where(rng.random(n) < 0.2, mu, lam), mu, phi


def _helix(rng: Any, n: int) -> tuple[Array, ...]:
    """At rest on a root of H: as found, or with lam made to fit."""
    lam, mu, phi = _moderate(rng, n)
    at = _extremum(rng, lam, mu, phi, saddle=None)
    beta = rng.uniform(-np.pi, np.pi, n)
    fitted = (mu * np.cos(2 * beta) + (phi + 2 * np.cos(beta) * np.sin(beta) ** 2) * np.sin(beta)) / np.cos(beta)
    fit = rng.random(n) < 0.5
    return np.where(fit, fitted, lam), mu, phi, np.where(fit, beta, at), np.zeros(n)


def _separatrix(rng: Any, n: int) -> tuple[Array, ...]:
    """Somewhere on the way to a saddle, with the speed that just reaches it, or next to that speed down to rounding."""
    lam, mu, phi = _moderate(rng, n)
    problem = Reduced(lam, mu, phi, lam, lam)
    beta = angles(rng, n)
    rise = potential(problem, _extremum(rng, lam, mu, phi, saddle=True)) - potential(problem, beta)
    v = np.sqrt(np.abs(rise)) * rng.choice([-1.0, 1.0], n)
    return lam, mu, phi, beta, v * (1 + signed(rng, 1e-17, 1e-1, n, 0.3))


def _gap(rng: Any, n: int) -> tuple[Array, ...]:
    """At a saddle but for a small angle or a small speed."""
    lam, mu, phi = _moderate(rng, n)
    at = _extremum(rng, lam, mu, phi, saddle=True)
    gap, turning = signed(rng, 1e-20, 1e-1, n, 0.1), rng.random(n) < 0.5
    return lam, mu, phi, at + np.where(turning, gap, 0), np.where(turning, 0, gap)


def _tension(rng: Any, n: int) -> tuple[Array, ...]:
    """Pulled so hard that a march loses every digit: phi up to 1e12, next to the straight rod."""
    twist = signed(rng, 1e-6, 1e3, n, 0.5)
    beta = rng.choice([0.0, np.pi], n) + signed(rng, 1e-18, 1.0, n, 0.2)
    return (
        twist,
        twist,
        log_uniform(rng, 1e0, 1e12, n) * rng.choice([-1.0, 1.0], n),
        beta,
        signed(rng, 1e-18, 1e3, n, 0.4),
    )


def _extremum(rng: Any, lam: Array, mu: Array, phi: Array, saddle: bool | None) -> Array:
    """A random extremum of G; of that sort if it is said, (n,)."""
    found = critical_points(Reduced(lam, mu, phi, lam, lam))
    wanted = ~np.isnan(found.beta) if saddle is None else (found.centre != saddle) & ~np.isnan(found.beta)
    chance = np.where(wanted, rng.random(found.beta.shape), -1.0)
    return found.beta[np.arange(lam.size), chance.argmax(axis=1)]


_MAKERS = {"loads": _loads, "helix": _helix, "separatrix": _separatrix, "gap": _gap, "tension": _tension}
