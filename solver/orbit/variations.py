"""Variations of orbits: how beta and its integrals answer a change of the start or of the loads.

Along an orbit the change (d beta, d beta_t) is a f + g b + (shift, 0): f = (beta_t, -H) is the flow, b = (c H, beta_t)/D
with D = beta_t^2 + c H^2 lies across it (c as in `conditioning`), and next to a critical point o of G the shift
-H_q(o)/H'(o) dq is that of o itself. The level gives g without integration:

    g = e . gamma,  e = (g0, d lam, d mu, d phi),  gamma_0 = 1,  gamma_q = -(G_q - G_q(o))/2 - shift_q H.

What is left are integrals that do not depend on the direction of travel, so whole periods add to them by their number:

    a = a0 + M_0 . e,
    the integral of H_q d beta = M_q . e + [shift_q g beta_t/D - a gamma_q],

and M, (4, 4), is symmetric, for it holds the second derivatives of the action of the orbit. H_lam = cos(beta),
H_mu = -cos(2 beta) and H_phi = -sin(beta) are also the derivatives of sin(beta), -sin(beta) cos(beta) and cos(beta), so
the integrals of H_q d beta are the changes of alpha, of minus the swirl and of z. Nothing is marched, and next to a
saddle no large numbers cancel.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..mechanics.potential import TAU, Loads, load_size, slope_rate
from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis, polynomials
from ..problem.reduced import StartProblem
from .arcs import Arcs
from .conditioning import across
from .panels import Panels, panelled, running
from .periodic_orbit import Orbit, assembled
from .phase import unfolded
from .pieces import LIBRATION

PAIRS = ((0, 0, 0, 0, 1, 1, 1, 2, 2, 3), (0, 1, 2, 3, 1, 2, 3, 2, 3, 3))  # the rows and columns of M that are kept
POINTS, LENGTH, GOAL = 22, 0.45, 5e-15  # of the panels
_NEAR = 0.5  # rad: the largest distance from a critical point at which its shift is split off
_STEEP = 1e-3  # of the size of the loads: the least |H'| of such a point


@dataclass(frozen=True, eq=False)
class Place:
    """The state of orbits where their variation is read, at (..., ) points.

    v, H: beta_t and H. c: of the transversal. shift: (..., 4), by a unit of each element of e. gamma: (..., 4). M: (..., 4, 4).
    """

    v: Array
    H: Array
    c: Array
    shift: Array
    gamma: Array
    M: Array

    @property
    def D(self) -> Array:
        """beta_t^2 + c H^2; 1 at rest, where nothing is across the flow."""
        found = self.v * self.v + self.c * self.H * self.H
        return np.where(found > 0, found, 1.0)

    def take(self, index: Any) -> "Place":
        """The places that an index picks."""
        return Place(**{name: value[index] for name, value in vars(self).items()})


@dataclass(frozen=True, eq=False)
class Change:
    """The change of orbits at places, (..., F) for F directions: of beta, beta_t and the integrals of H_q d beta (..., F, 3)
    for q = lam, mu, phi: the changes of alpha, of minus the swirl, and of z."""

    beta: Array
    rate: Array
    integrals: Array


@dataclass(frozen=True, eq=False)
class Variations:
    """The variations of B orbits, none of them a helix, ready to be read anywhere along the rods.

    orbit: the orbits; their series of beta count from the angle `base` (P,) of each panel. nodes: the
    state at the nodes of the panels. jump: (P, 10), closing: (2 B, 10), what M gains on entering each panel, and where
    the rotation of an arc closes. series: (P, 19, n + 1), of |beta_t|, H, c, the shifts (3), gamma_q (3) and the ten
    elements of M. gain: (B, 2, 10), what M gains over the forward and the backward arc.
    """

    orbit: Orbit
    base: Array
    nodes: "Nodes"
    jump: Array
    closing: Array
    series: Array
    gain: Array

    def at(self, t: Array) -> Place:
        """The places at t (B, n), (B, n) each."""
        orbit, phase = self.orbit, self.orbit.locate(t)
        values = orbit.read(self.series, phase)
        kind, direction = orbit.arcs.kind[:, None], orbit.arcs.direction[:, None]
        sign = np.where(phase.second, -direction, direction) * np.where(phase.mirrored, -1.0, 1.0)
        ten = [unfolded(values[..., 9 + k], phase, self.gain[..., k], kind == LIBRATION) for k in range(10)]
        return _place(sign * values[..., 0], values[..., 1:9], ten)

    @property
    def start(self) -> Place:
        """The places at the starts of the rods, (B,) each."""
        return self.at(np.zeros((self.orbit.problem.size, 1))).take((slice(None), 0))

    def angles(self, t: Array) -> tuple[Array, Array]:
        """At t (B, n), the critical point from which beta counts, with whole turns, and beta less it, (B, n) each."""
        orbit, phase = self.orbit, self.orbit.locate(t)
        series = np.zeros((self.base.size, 2, orbit.panels.series.shape[2]))
        series[:, 0, 0], series[:, 1] = self.base, orbit.panels.series[:, 0]
        folded = (orbit.arcs.kind == LIBRATION)[:, None]
        around = np.where(folded, 0.0, TAU) * orbit.arcs.direction[:, None] * phase.periods
        values = orbit.read(series, phase)
        return values[..., 0] + around, values[..., 1]

    def on_panels(self, panel: Array, x: Array) -> tuple[Array, Place]:
        """beta and the places, without M, at x (N, m) in [-1, 1] on panels (N,), moving away from the start."""
        arc = self.orbit.panels.arc[panel]
        sign = self.orbit.arcs.direction[arc // 2] * np.where(arc % 2 == 1, -1.0, 1.0)
        series = np.concatenate([self.orbit.panels.series[panel, :1], self.series[panel, :9]], axis=1)
        values = np.einsum("nks,snm->nmk", series, polynomials(x, series.shape[2]), optimize=False)
        ten = [np.zeros(x.shape)] * 10
        place = _place(sign[:, None] * np.maximum(values[..., 1], 0), values[..., 2:], ten)
        return self.base[panel, None] + values[..., 0], place

    def sums(self, rates: Array, jump: Array, closing: Array) -> Array:
        """Integrals over the rods, (B, k), of even rates (P, k, n) at the nodes with jumps (P, k), closings (2 B, k)."""
        series, gain = _accumulated(self.orbit, rates, jump, closing)
        phase = self.orbit.locate(self.orbit.problem.span[:, None])
        values = self.orbit.read(series, phase)
        folded = (self.orbit.arcs.kind == LIBRATION)[:, None]
        parts = [unfolded(values[..., k], phase, gain[..., k], folded)[:, 0] for k in range(rates.shape[1])]
        return np.stack(parts, axis=1)

    def cut(self, panel: Integers, x: Array) -> "Variations":
        """The same with panels cut at x in (-1, 1); a panel may be cut several times."""
        panels, points = self.orbit.panels, basis(self.nodes.v.shape[1])
        every = np.concatenate([np.arange(panels.arc.size), panel])
        low = np.concatenate([np.full(panels.arc.size, -1.0), x])
        order = np.lexsort((low, every))
        every, low = every[order], low[order]
        high = np.append(np.where(every[1:] == every[:-1], low[1:], 1.0), 1.0)
        at = low[:, None] + (high - low)[:, None] * ((1 + points.nodes) / 2)
        T = polynomials(at, panels.series.shape[2])

        def moved(coefficients: Array) -> Array:
            return np.einsum("nks,snm->nkm", coefficients[every], T[: coefficients.shape[2]], optimize=False)

        series = np.zeros((every.size, *panels.series.shape[1:]))
        series[:, :2, :-1] = moved(panels.series[:, :2]) @ points.analyse
        duration = panels.duration[every] * (high - low) / 2
        orbit = assembled(
            self.orbit.problem, self.orbit.arcs, replace(panels.take(every), series=series, duration=duration)
        )
        state, M = moved(self.series[:, :9]), moved(self.nodes.M @ points.analyse)
        v = np.maximum(state[:, 0], 0.0)
        nodes = Nodes(v, state[:, 1], self.nodes.c[every], self.nodes.shift[every], state[:, 6:9], M)
        jump = np.where((low == -1)[:, None], self.jump[every], 0.0)
        return _varied(orbit, self.base[every], nodes, jump, self.closing)


def _place(v: Array, values: Array, ten: list[Array]) -> Place:
    H, c, shift, gamma = values[..., 0], values[..., 1], values[..., 2:5], values[..., 5:8]
    M = np.empty((*v.shape, 4, 4))
    for i, j, value in zip(*PAIRS, ten, strict=True):
        M[..., i, j] = M[..., j, i] = value
    none, one = np.zeros((*v.shape, 1)), np.ones((*v.shape, 1))
    return Place(v, H, c, np.concatenate([none, shift], axis=-1), np.concatenate([one, gamma], axis=-1), M)


def directions(start: Place) -> tuple[Array, Array]:
    """a0 (B, 5) and e (B, 5, 4) of a unit of beta(0), beta_t(0), lam, mu and phi, each with the others held."""
    e = np.zeros((*start.v.shape, 5, 4))
    a0 = np.zeros((*start.v.shape, 5))
    v, H, c, D = start.v, start.H, start.c, start.D
    e[..., 0, 0], a0[..., 0] = H, v / D
    e[..., 1, 0], a0[..., 1] = v, -c * H / D
    full = start.gamma + start.shift * H[..., None]
    for q in (1, 2, 3):
        e[..., q + 1, q] = 1
        e[..., q + 1, 0] = -full[..., q]
        a0[..., q + 1] = -start.shift[..., q] * v / D
    return a0, e


def changed(start: Place, there: Place, a0: Array, e: Array) -> Change:
    """The change at places (B, n) by the directions a0 (B, F), e (B, F, 4), (B, n, F) each."""
    rise = np.einsum("bnjk,bfk->bnfj", there.M - start.M[:, None], e)
    a = a0[:, None, :] + rise[..., 0]
    g, shift = (np.einsum("bnk,bfk->bnf", value, e) for value in (there.gamma, there.shift))
    v, H, c, D = (value[..., None] for value in (there.v, there.H, there.c, there.D))
    beta = shift + a * v + g * (c * H / D)
    rate = -a * H + g * (v / D)
    g0 = np.einsum("bk,bfk->bf", start.gamma, e)
    ends = _end_term(there, a, g) - _end_term(start, a0, g0)[:, None]
    return Change(beta, rate, rise[..., 1:] + ends)


def _end_term(place: Place, a: Array, g: Array) -> Array:
    """shift g beta_t/D - a gamma of each load, (..., F, 3)."""
    shift = place.shift[..., None, 1:]
    gamma = place.gamma[..., None, 1:] + shift * place.H[..., None, None]
    return shift * (g * (place.v / place.D)[..., None])[..., None] - a[..., None] * gamma


def variations(problem: StartProblem, arcs: Arcs, stretch: float = 1.0) -> Variations:
    """The variations of orbits with these arcs, none of them a helix.

    stretch: as in `panels.panelled`.
    """
    pieces = arcs.pieces
    plain = replace(arcs, pieces=replace(pieces, base=np.zeros_like(pieces.base)))
    panels = panelled(problem, plain, basis(POINTS), LENGTH, GOAL, stretch=stretch)
    return variations_on(assembled(problem, plain, panels), arcs)


def variations_on(orbit: Orbit, arcs: Arcs) -> Variations:
    """The variations on panels whose series of beta count from the angles from which the pieces of `arcs` count."""
    pieces, panels = arcs.pieces, orbit.panels
    most = int(pieces.rank.max(initial=0)) + 1
    place = np.searchsorted(pieces.arc * most + pieces.rank, panels.arc * most + panels.rank)
    nodes = _nodes(orbit, pieces.local.o[place, 0])
    jump, closing = _jumps(orbit, nodes)
    return _varied(orbit, pieces.base[place], nodes, jump, closing)


def _varied(orbit: Orbit, base: Array, nodes: "Nodes", jump: Array, closing: Array) -> Variations:
    summed, gain = _accumulated(orbit, nodes.M, jump, closing)
    series = _states(nodes)
    series[:, 9:] = summed
    return Variations(orbit, base, nodes, jump, closing, series, gain)


@dataclass(frozen=True, eq=False)
class Nodes:
    """The state at the nodes of P panels, (P, n); M: (P, 10, n), the rates of the elements of M."""

    v: Array
    H: Array
    c: Array
    shift: Array
    gamma: Array
    M: Array


def _nodes(orbit: Orbit, origin: Array) -> Nodes:
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
    """-(G_q(o) - G_q(o*))/2 of each panel, (P, 3), o* the critical point to which the orbit comes closest.

    D: (P,), the least beta_t^2 + c H^2 of each panel.
    """
    B, b = orbit.problem.size, orbit.panels.arc // 2
    order = np.lexsort((D, b))
    first = np.searchsorted(b[order], np.arange(B))
    nearest = origin[order[np.minimum(first, order.size - 1)]][b]
    # products, so that points that are mirror images have exactly the same height where the load cannot tell them apart
    half, mean = (origin - nearest) / 2, (origin + nearest) / 2
    sin_half = np.sin(half)
    by_lam, by_mu, by_phi = 2 * np.cos(mean) * sin_half, np.cos(2 * mean) * np.sin(2 * half), -2 * np.sin(mean) * sin_half
    return np.where((origin == nearest)[:, None], 0.0, np.stack([-by_lam, by_mu, -by_phi], axis=1))


def _rates(
    v: Array, H: Array, c: Array, rate: Array, shift: Array, gamma: Array, H_q: Array, plain: Array
) -> Array:
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


def _states(nodes: Nodes) -> Array:
    """The series of `Variations` without M."""
    points = basis(nodes.v.shape[1])
    series = np.zeros((nodes.v.shape[0], 19, points.nodes.size + 1))
    for k, value in enumerate((nodes.v, nodes.H)):
        series[:, k, :-1] = value @ points.analyse
    series[:, 2, 0], series[:, 3:6, 0] = nodes.c, nodes.shift
    series[:, 6:9, :-1] = nodes.gamma @ points.analyse
    return series


def _accumulated(orbit: Orbit, rates: Array, jump: Array, closing: Array) -> tuple[Array, Array]:
    """Integrals from the start, (P, k, n + 1), and over both arcs, (B, 2, k); arguments as in `Variations.sums`."""
    panels, points = orbit.panels, basis(rates.shape[2])
    series = (rates @ points.analyse @ points.integrate) * (panels.duration / 2)[:, None, None]
    ends = series.sum(axis=2) + jump
    series[..., 0] += running(ends, orbit.first, orbit.count) + jump
    gain = [np.bincount(panels.arc, ends[:, k], orbit.first.size) for k in range(ends.shape[1])]
    return series, (np.stack(gain, axis=1) + closing).reshape(-1, 2, ends.shape[1])


def _jumps(orbit: Orbit, nodes: Nodes) -> tuple[Array, Array]:
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
    found = np.empty((v.size, 10))
    for n, (i, j) in enumerate(zip(*PAIRS, strict=True)):
        found[:, n] = turn * g[:, i] * g[:, j]
        found[:, n] += lift * (less[:, i] * full[:, j] + full[:, i] * less[:, j])
        found[:, n] -= lift * H * (was[:, i] * was[:, j] - now[:, i] * now[:, j])
    return found
