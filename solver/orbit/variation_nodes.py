"""The state of varied orbits at the nodes of their panels, to relative accuracy next to critical points.

Quantities are those of `variations`, which integrates the rates of M.
"""

from dataclasses import dataclass

import numpy as np

from ..mechanics.potential import Loads, load_size, slope_rate
from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis
from .conditioning import across
from .periodic_orbit import Orbit
from .pieces import LIBRATION

PAIRS = ((0, 0, 0, 0, 1, 1, 1, 2, 2, 3), (0, 1, 2, 3, 1, 2, 3, 2, 3, 3))  # the rows and columns of M that are kept
_NEAR = 0.5  # rad: the largest distance from a critical point at which its shift is split off
_STEEP = 1e-3  # of the size of the loads: the least |H'| of such a point


@dataclass(frozen=True, eq=False)
class Nodes:
    """The state at the nodes of P panels, (P, n); M: (P, 10, n), the rates of the elements of M."""

    v: Array
    H: Array
    c: Array
    shift: Array
    gamma: Array
    M: Array


def state_at_nodes(orbit: Orbit, origin: Array) -> Nodes:
    problem, panels = orbit.problem, orbit.panels
    points, b = basis(panels.series.shape[2] - 1), panels.arc // 2
    loads, o = Loads.columns(problem, b), origin[:, None]
    x, v = panels.series[:, 0] @ points.values, panels.series[:, 1] @ points.values
    v = np.maximum(v, 0.0)
    steep = slope_rate(loads, o)
    near = (np.abs(x).max(axis=1) < _NEAR) & (np.abs(steep[:, 0]) > _STEEP * (1 + load_size(problem))[b])
    at = slopes_by_loads(o)[..., 0]
    shift = np.where(near[:, None], -at / np.where(near[:, None], steep, 1.0), 0.0)
    H, gamma, H_q = _about(loads, o, x, steep, shift, at, near)
    rate = slope_rate(loads, o + x)
    c = across(v, np.abs(H), rate, panels.duration / 2)
    gamma = gamma + _heights(orbit, origin, (v * v + c[:, None] * H * H).min(axis=1))[:, :, None]
    M = _rates(v, H, c[:, None], rate, shift, gamma, H_q, slopes_by_loads(o + x))
    return Nodes(v, H, c, shift, gamma, M)


def slopes_by_loads(beta: Array) -> Array:
    """The derivatives of H with respect to lam, mu and phi at beta (P, n), (P, 3, n)."""
    return np.stack([np.cos(beta), -np.cos(2 * beta), -np.sin(beta)], axis=1)


def _about(
    loads: Loads, o: Array, x: Array, steep: Array, shift: Array, at: Array, near: Array
) -> tuple[Array, Array, Array]:
    """H, gamma_q (P, 3, n) less its value at o, and H_q + shift_q H' (P, 3, n), all to relative accuracy in x.

    H = H'(o) sin(x) + R and -(G_q - G_q(o))/2 = -H_q(o) sin(x) + r_q with R and r_q of the order of x^2, so where the
    shift is split off the terms in sin(x) cancel without being computed.
    """
    lam, mu, phi = loads.lam, loads.mu, loads.phi
    s, c, s2, c2, s4, c4 = (f(k * o) for k in (1, 2, 4) for f in (np.sin, np.cos))
    q, sx, cx = np.sin(x / 2) ** 2, np.sin(x), np.cos(x)
    s2x, c2x, sx2 = np.sin(2 * x), np.cos(2 * x), sx * sx
    turn, even = 4 * (mu * s2 - c2 / 2), lam * c - phi * s
    w = -2 * q - 2 * sx2 + 4 * q * sx2
    R = -turn * q * sx + c4 * sx * w - 2 * q * even + sx2 * (2 * mu * c2 + s2) - s4 * s2x * s2x / 2
    R_x = -turn * (sx2 / 2 + q * cx) + c4 * (cx * w - sx * (sx * c2x + 2 * cx * s2x)) - sx * even
    R_x = R_x + s2x * (2 * mu * c2 + s2) - s4 * np.sin(4 * x)
    r = np.stack([2 * s * q, -2 * c2 * q * sx - s2 * sx2, 2 * c * q], axis=1)
    r_x = np.stack([s * sx, -c2 * (sx2 + 2 * q * cx) - s2 * s2x, c * sx], axis=1)
    left = np.where(near[:, None], 0.0, at)[..., None]  # H_q(o) + shift_q H'(o)
    gamma = r - shift[..., None] * R[:, None] - left * sx[:, None]
    H_q = -r_x + shift[..., None] * R_x[:, None] + left * cx[:, None]
    return steep * sx + R, gamma, H_q


def _heights(orbit: Orbit, origin: Array, D: Array) -> Array:
    """`height_rates` of each panel from the point of its orbit's `nearest`, (P, 3); D as there."""
    return height_rates(origin, origin[nearest(orbit, D)[orbit.panels.arc // 2]])


def nearest(orbit: Orbit, D: Array) -> Integers:
    """The panel of each orbit whose critical point the orbit comes closest to, (B,).

    D: (P,), the least beta_t^2 + c H^2 of each panel.
    """
    b = orbit.panels.arc // 2
    order = np.lexsort((D, b))
    first = np.searchsorted(b[order], np.arange(orbit.problem.size))
    return np.asarray(order[np.minimum(first, order.size - 1)])


def height_rates(angle: Array, other: Array) -> Array:
    """-(G_q(angle) - G_q(other))/2 for q = lam, mu, phi, (P, 3)."""
    # products, so that points that are mirror images have exactly the same height where the load cannot tell them apart
    half, mean = (angle - other) / 2, (angle + other) / 2
    sin_half = np.sin(half)
    by_lam, by_mu, by_phi = (
        2 * np.cos(mean) * sin_half,
        np.cos(2 * mean) * np.sin(2 * half),
        -2 * np.sin(mean) * sin_half,
    )
    return np.where((angle == other)[:, None], 0.0, np.stack([-by_lam, by_mu, -by_phi], axis=1))


def _rates(v: Array, H: Array, c: Array, rate: Array, shift: Array, gamma: Array, H_q: Array, plain: Array) -> Array:
    """The rates of the elements of M, (P, 10, n)."""
    D = v * v + c * H * H
    at_rest = D == 0
    D = np.where(at_rest, 1.0, D)
    sigma = (1 - c * rate) * ((v * v - c * H * H) / D) / D
    lever = c * H / D
    sigma, lever = np.where(at_rest, 0.0, sigma), np.where(at_rest, 0.0, lever)
    M = np.empty((v.shape[0], len(PAIRS[0]), v.shape[1]))
    one = np.ones_like(v)
    g = (one, *np.moveaxis(gamma, 1, 0))
    h, p = (0.0, *np.moveaxis(H_q, 1, 0)), (0.0, *np.moveaxis(plain, 1, 0))
    k = (0.0, *(column[:, None] for column in shift.T))
    for n, (i, j) in enumerate(zip(*PAIRS, strict=True)):
        M[:, n] = g[i] * g[j] * sigma + lever * (g[i] * h[j] + g[j] * h[i])
        M[:, n] += k[i] * p[j] + k[j] * p[i] + (k[i] * rate) * k[j]
    return M


def jumps(orbit: Orbit, nodes: Nodes) -> tuple[Array, Array]:
    """What M gains on entering each panel from the one before, (P, 10); and where a rotation closes, (2 B, 10)."""
    arc, panel = orbit.panels.arc, np.arange(orbit.panels.arc.size)
    starts = panel == orbit.first[arc]
    out = orbit.first[arc - arc % 2]
    before = np.where(starts, np.where((arc % 2 == 1) & (orbit.count[arc - arc % 2] > 0), out, panel), panel - 1)
    jump = np.where((before == panel)[:, None], 0.0, _jump(orbit, nodes, before, panel))
    closing = np.zeros((orbit.first.size, 10))
    rotates = np.flatnonzero((orbit.count > 0) & (np.repeat(orbit.arcs.kind, 2) != LIBRATION))
    start = orbit.first[rotates]
    closing[rotates] = _jump(orbit, nodes, start + orbit.count[rotates] - 1, start)
    return jump, closing


def _jump(orbit: Orbit, nodes: Nodes, old: Integers, new: Integers) -> Array:
    """What M gains where the transversal and the shift change from those of panels `old` to those of `new`, (N, 10)."""
    arc = orbit.panels.arc[new]
    sign = orbit.arcs.direction[arc // 2] * np.where(arc % 2 == 1, -1, 1)
    v, H = sign * nodes.v[new, 0], nodes.H[new, 0]
    first, then = nodes.c[old], nodes.c[new]
    D_old, D_new = v * v + first * H * H, v * v + then * H * H
    D_old, D_new = (np.where(D > 0, D, 1.0) for D in (D_old, D_new))
    turn, lift = v * H * ((first - then) / D_old) / D_new, v / D_new
    zero = np.zeros((v.size, 1))
    was, now = (np.concatenate([zero, nodes.shift[k]], axis=1) for k in (old, new))
    full = np.concatenate([zero + 1, nodes.gamma[new, :, 0]], axis=1) + now * H[:, None]
    g, less = full - was * H[:, None], was - now
    i, j = PAIRS
    turn, raised, lift = turn[:, None], (lift * H)[:, None], lift[:, None]
    found = turn * g[:, i] * g[:, j] + lift * (less[:, i] * full[:, j] + full[:, i] * less[:, j])
    return np.asarray(found - raised * (was[:, i] * was[:, j] - now[:, i] * now[:, j]))
