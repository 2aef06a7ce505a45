"""Variations of orbits: how beta and its integrals answer a change of the start or of the loads.

Along an orbit the change (d beta, d beta_t) is a f + g b + (shift, 0). f = (beta_t, -H) is the flow. b = (c H,
beta_t)/D with D = beta_t^2 + c H^2 lies across it (c: `scale_across` of `core/variations.c`). Next to a critical point
o of G the shift -H_q(o)/H'(o) dq is that of o itself. The level gives g without integration:

    g = e . gamma,  e = (g0, d lam, d mu, d phi),  gamma_0 = 1,  gamma_q = -(G_q - G_q(o))/2 - shift_q H.

What is left are integrals that do not depend on the direction of travel, so whole periods add to them by their number:

    a = a0 + M_0 . e,
    the integral of H_q d beta = M_q . e + [shift_q g beta_t/D - a gamma_q],

and M, (4, 4), is symmetric, for it holds the second derivatives of the action of the orbit. H_lam = cos(beta),
H_mu = -cos(2 beta) and H_phi = -sin(beta) are also the derivatives of sin(beta), -sin(beta) cos(beta) and cos(beta), so
the integrals of H_q d beta are the changes of alpha, of minus the swirl and of z. Nothing is marched, and next to a
saddle no large numbers cancel. Along a helix eta'' + H' eta = -H_q dq has constant coefficients and a closed form.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..core.library import Cutting, fine, points, run, structure, widest
from ..numerics.arrays import Array
from ..problem.dimensionless import Reduced
from .periodic_orbit import Orbit, as_core_orbits
from .potential import slope_rate, slopes_by_loads

# nodes of a panel, and how panels are cut: shorter than those of an orbit, as zeros are counted on them. x10: C has no
# such panels; on longer ones digits are lost
POINTS, HOW = 24, Cutting(0.45, 5e-15, 1.0)
# below this |H'| t^2 the waves along a helix are summed as series, as differences of sines lose digits. x10: as good
_SUMMED = 1.0
PAIRS = 10  # of elements of M that are kept
KEPT = ("least", "M", "jump", "closing", "series", "gain")
_VariedOrbits = structure("varied_orbits", "variations.h")


@dataclass(frozen=True, eq=False)
class Change:
    """The change of orbits at places in F directions.

    beta, rate: (..., F), of beta and beta_t. integrals: (..., F, 3), of H_q d beta for q = lam, mu, phi: the changes of
    alpha, of minus the swirl, and of z.
    """

    beta: Array
    rate: Array
    integrals: Array

    @property
    def rows(self) -> Array:
        """The changes of beta, beta_t and the integrals as rows, (5, b, F, n), at n places of b orbits."""
        every = self.beta, self.rate, *np.moveaxis(self.integrals, -1, 0)
        return np.ascontiguousarray(np.stack(every).swapaxes(2, 3))


@dataclass(frozen=True, eq=False)
class Variations:
    """The variations of B orbits, none of them a helix, ready to be read anywhere along the rods.

    kept: arrays by name (`KEPT`). least: (P,), the least beta_t^2 + c H^2 of each panel. M: (P, 10, n), the
    rates of its elements at the nodes. jump: (P, 10), closing: (2 B, 10), what M gains on entering each panel, and
    where the rotation of an arc closes. series: (P, 15 n + 19), those of |beta_t|, H, gamma_q (3)
    and the ten elements of M, of n + 1 coefficients, then c and the shifts (3). gain: (B, 2, 10), what M gains over the
    forward and the backward arc.
    """

    orbit: Orbit
    kept: dict[str, Array]

    def change(self, t: Array, parts: Array) -> Change:
        """The changes at t (B, n) in F directions with the parts (B, 5, F): a0, then e."""
        (B, n), F = t.shape, parts.shape[2]
        out = np.empty((5, B, F, n))
        given = np.ascontiguousarray(t), np.ascontiguousarray(parts.swapaxes(1, 2))
        run("rod_variations_changes", *self.arguments, B, n, F, *given, out)
        columns = out.swapaxes(2, 3)
        return Change(columns[0], columns[1], np.moveaxis(columns[2:], 0, -1))

    @cached_property
    def arguments(self) -> tuple[Any, Any]:
        """The orbits and their variations as the core reads them."""
        return as_core_orbits(self.orbit), _VariedOrbits(**self.kept, lanes=widest())

    @cached_property
    def directions(self) -> Array:
        """The parts of a unit of beta(0), beta_t(0), lam, mu and phi, each with the others held, (B, 5, 5)."""
        units = np.tile(np.eye(5), (self.orbit.problem.size, 1, 1))
        start, rows = self.change(np.zeros((len(units), 1)), units), units.copy()
        rows[:, 0], rows[:, 1] = start.beta[:, 0], start.rate[:, 0]
        return np.linalg.inv(rows)


def variations_on(orbit: Orbit) -> Variations:
    """The variations of orbits, none of them a helix."""
    problem, n = orbit.problem, orbit.panels.series.shape[2] - 1
    P, B = orbit.panels.arc.size, problem.size
    loads = np.stack([problem.lam, problem.mu, problem.phi], axis=1)
    shapes = (P,), (P, PAIRS, n), (P, PAIRS), (2 * B, PAIRS), (P, 15 * n + 19), (B, 2, PAIRS)
    varied = Variations(orbit, dict(zip(KEPT, map(np.empty, shapes), strict=True)))
    fine(run("rod_variations", B, loads, varied.arguments[0], points(n), varied.arguments[1]))
    return varied


@dataclass(frozen=True, eq=False)
class HelixVariations:
    """The variations of B helices, in closed form: eta'' + H' eta = -H_q dq with constant coefficients.

    Of the five parts of a change the first two are those of beta(0) and beta_t(0), the others those of lam, mu and phi.
    held: whether about saddles, where what beta_t(0) changes grows too fast, they are those of beta(0) and beta(L).
    """

    problem: Reduced
    held: bool = False

    def change(self, t: Array, parts: Array) -> Change:
        """The changes at t (B, n) in F directions with the parts (B, 5, F)."""
        by = self.units(t)
        integrals = np.stack([by.integrals[..., k] @ parts for k in range(3)], axis=-1)
        return Change(by.beta @ parts, by.rate @ parts, integrals)

    def units(self, t: Array) -> Change:
        """The changes at t (B, n) by a unit of each part, (B, n, 5)."""
        by_start = _change_by_start(self.problem, t)
        if not self.held:
            return by_start
        steep = slope_rate(self.problem, self.problem.beta0) < 0
        pairs = zip(vars(_change_by_ends(self.problem, t)).values(), vars(by_start).values(), strict=True)
        return Change(*(np.where(steep.reshape(-1, *[1] * (a.ndim - 1)), a, b) for a, b in pairs))


def _change_by_start(problem: Reduced, t: Array) -> Change:
    """The change by a unit of beta(0), beta_t(0), lam, mu and phi, (B, n, 5) each."""
    beta0 = problem.beta0
    rate = slope_rate(problem, beta0)[:, None]
    C, S, S2, S3 = _waves(rate, t)
    return _by_waves(beta0, (C, -rate * S, S), (S, C, S2), (S2, S, S3))


def _change_by_ends(problem: Reduced, t: Array) -> Change:
    """The change by a unit of beta(0), beta(L), lam, mu and phi, each with the other end held."""
    beta0, span = problem.beta0, problem.span[:, None]
    rate = slope_rate(problem, beta0)[:, None]
    with np.errstate(all="ignore"):
        C, S, S2, S3 = _waves(rate, t)
        C_L, S_L, S2_L, _ = _waves(rate, span)
        first = C - C_L / S_L * S, -rate * S - C_L / S_L * C, S - C_L / S_L * S2
        second = S / S_L, C / S_L, S2 / S_L
        forced = S2 - S2_L / S_L * S, S - S2_L / S_L * C, S3 - S2_L / S_L * S2
        steep = rate * span**2 < -_SUMMED
        far = _between_saddles(np.sqrt(np.abs(rate)), t, span)
        near = _between_saddles(np.sqrt(np.abs(rate)), span - t, span)
        whole = _between_saddles(np.sqrt(np.abs(rate)), span, span)[2]
    mirrored = near[0], -near[1], whole - near[2]
    shifts = ((size - a - b) / rate for size, a, b in zip((1.0, 0.0, t), far, mirrored, strict=True))
    chosen = (
        tuple(np.where(steep, a, b) for a, b in zip(*pair, strict=True))
        for pair in ((mirrored, first), (far, second), (tuple(shifts), forced))
    )
    return _by_waves(beta0, *chosen)


def _by_waves(beta0: Array, first: tuple[Array, ...], second: tuple[Array, ...], forced: tuple[Array, ...]) -> Change:
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
    small = np.abs(z) < _SUMMED
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
