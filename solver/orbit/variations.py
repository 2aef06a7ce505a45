"""Variations of orbits: how beta and its integrals answer a change of the start or of the loads.

Along an orbit the change (d beta, d beta_t) is a f + g b + (shift, 0). f = (beta_t, -H) is the flow. b = (c H,
beta_t)/D with D = beta_t^2 + c H^2 lies across it (c: `core/conditioning.c`). Next to a critical point o of G the shift
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

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..core import varied_orbits as core
from ..core.library import Cutting
from ..core.orbits import read_series
from ..mechanics.potential import TAU
from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis, polynomials
from ..problem.reduced import StartProblem
from .periodic_orbit import Orbit, assemble, relative_orbit
from .pieces import LIBRATION, Arcs, running
from .variation_nodes import PAIRS, Nodes, nearest

POINTS, LENGTH, GOAL = 22, 0.45, 5e-15  # of the panels
_MATRIX = np.zeros((4, 4), dtype=int)  # where the elements of M are kept
_MATRIX[PAIRS] = _MATRIX[PAIRS[::-1]] = range(10)


@dataclass(frozen=True, eq=False)
class Place:
    """The state of orbits where their variation is read, at points (...).

    v, H: beta_t and H. c: of the transversal. shift, gamma: (..., 4), by a unit of each element of e. M: (..., 4, 4).
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
    """The change of orbits at places in F directions.

    beta, rate: (..., F), of beta and beta_t. integrals: (..., F, 3), of H_q d beta for q = lam, mu, phi: the changes of
    alpha, of minus the swirl, and of z.
    """

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
    nodes: Nodes
    jump: Array
    closing: Array
    series: Array
    gain: Array

    def at(self, t: Array) -> Place:
        """The places at t (B, n), (B, n) each."""
        found = core.places(self.orbit, self.series, self.gain, t)
        M = found[..., 11:][..., _MATRIX]
        return Place(found[..., 0], found[..., 1], found[..., 2], found[..., 3:7], found[..., 7:11], M)

    def change(self, t: Array, parts: Array) -> Change:
        """The changes at t (B, n) in F directions with the parts (B, 5, F): a0, then e."""
        found = core.changes(self.orbit, self.series, self.gain, t, parts).swapaxes(2, 3)
        return Change(found[0], found[1], np.moveaxis(found[2:], 0, -1))

    @cached_property
    def start(self) -> Place:
        """The places at the starts of the rods, (B,) each."""
        return self.at(np.zeros((self.orbit.problem.size, 1))).take((slice(None), 0))

    @property
    def nearest(self) -> Array:
        """The angles, with whole turns, of the critical points from whose heights the level counts, (B,)."""
        D = (self.nodes.v**2 + self.nodes.c[:, None] * self.nodes.H**2).min(axis=1)
        return np.asarray(self.base[nearest(self.orbit, D)])

    def beta(self, t: Array) -> Array:
        """beta at t (B, n)."""
        from_point, x = self.angles(t)
        return np.asarray(from_point + x)

    def angles(self, t: Array) -> tuple[Array, Array]:
        """At t (B, n), the critical point from which beta counts, with whole turns, and beta less it, (B, n) each."""
        orbit = self.orbit
        series = np.zeros((self.base.size, 2, orbit.panels.series.shape[2]))
        series[:, 0, 0], series[:, 1] = self.base, orbit.panels.series[:, 0]
        values, periods = read_series(orbit, series, t)
        around = np.where(orbit.kind == LIBRATION, 0.0, TAU * orbit.arcs.direction)[:, None] * periods
        return values[..., 0] + around, values[..., 1]

    def on_panels(self, panel: Array, x: Array) -> tuple[Array, Place]:
        """beta and the places, without M, at x (N, m) in [-1, 1] on panels (N,), moving away from the start."""
        arc = self.orbit.panels.arc[panel]
        sign = self.orbit.arcs.direction[arc // 2] * np.where(arc % 2 == 1, -1.0, 1.0)
        series = np.concatenate([self.orbit.panels.series[panel, :1], self.series[panel, :9]], axis=1)
        values = np.einsum("nks,snm->nmk", series, polynomials(x, series.shape[2]), optimize=False)
        v, H, c = sign[:, None] * np.maximum(values[..., 1], 0), values[..., 2], values[..., 3]
        shift, gamma = (np.insert(values[..., k : k + 3], 0, first, axis=-1) for k, first in ((4, 0.0), (7, 1.0)))
        place = Place(v, H, c, shift, gamma, np.zeros((*x.shape, 4, 4)))
        return self.base[panel, None] + values[..., 0], place

    def sums(self, rates: Array, jump: Array, closing: Array, until: Array) -> Array:
        """Integrals over the rods up to t = until (B,), (B, k), of rates (P, k, n) at the nodes.

        jump: (P, k). closing: (2 B, k). The rates do not depend on the direction of travel.
        """
        series, gain = _accumulate(self.orbit, rates, jump, closing)
        return read_series(self.orbit, series, until[:, None], gain)[0][:, 0]

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

        def on_cuts(coefficients: Array) -> Array:
            return np.einsum("nks,snm->nkm", coefficients[every], T[: coefficients.shape[2]], optimize=False)

        series = np.zeros((every.size, *panels.series.shape[1:]))
        series[:, :2, :-1] = on_cuts(panels.series[:, :2]) @ points.analyse
        duration = panels.duration[every] * (high - low) / 2
        orbit = assemble(
            self.orbit.problem, self.orbit.arcs, replace(panels.take(every), series=series, duration=duration)
        )
        state, M = on_cuts(self.series[:, :9]), on_cuts(self.nodes.M @ points.analyse)
        v = np.maximum(state[:, 0], 0.0)
        nodes = Nodes(v, state[:, 1], self.nodes.c[every], self.nodes.shift[every], state[:, 6:9], M)
        jump = np.where((low == -1)[:, None], self.jump[every], 0.0)
        return _vary(orbit, self.base[every], nodes, jump, self.closing)


def directions(start: Place) -> Array:
    """The parts of a unit of beta(0), beta_t(0), lam, mu and phi, each with the others held, (B, 5, 5)."""
    parts = np.zeros((*start.v.shape, 5, 5))
    v, H, c, D = start.v, start.H, start.c, start.D
    parts[:, :2, 0] = np.stack([v / D, H], axis=1)
    parts[:, :2, 1] = np.stack([-c * H / D, v], axis=1)
    full = start.gamma + start.shift * H[..., None]
    for q in (1, 2, 3):
        parts[:, q + 1, q + 1] = 1
        parts[:, :2, q + 1] = np.stack([-start.shift[..., q] * v / D, -full[..., q]], axis=1)
    return parts


def orbits_to_vary(problem: StartProblem) -> Orbit:
    """The orbits of start problems as `variations_on` takes them, helices included."""
    return relative_orbit(problem, POINTS, Cutting(LENGTH, GOAL, 1.0))


def variations_on(orbit: Orbit, arcs: Arcs) -> Variations:
    """The variations on panels whose series of beta count from the angles from which the pieces of `arcs` count."""
    pieces, panels = arcs.pieces, orbit.panels
    most = int(pieces.rank.max(initial=0)) + 1
    number = pieces.arc * most + pieces.rank
    order = np.argsort(number, kind="stable")
    place = order[np.searchsorted(number, panels.arc * most + panels.rank, sorter=order)]
    base, origin = pieces.base[place], pieces.origin[place]
    found = core.variations(orbit, origin)
    nodes = Nodes(*(found[field.name] for field in fields(Nodes)))
    return Variations(orbit, base, nodes, *(found[name] for name in ("jump", "closing", "series", "gain")))


def _vary(orbit: Orbit, base: Array, nodes: Nodes, jump: Array, closing: Array) -> Variations:
    summed, gain = _accumulate(orbit, nodes.M, jump, closing)
    series = _states(nodes)
    series[:, 9:] = summed
    return Variations(orbit, base, nodes, jump, closing, series, gain)


def _states(nodes: Nodes) -> Array:
    """The series of `Variations` without M."""
    points = basis(nodes.v.shape[1])
    series = np.zeros((nodes.v.shape[0], 19, points.nodes.size + 1))
    for k, value in enumerate((nodes.v, nodes.H)):
        series[:, k, :-1] = value @ points.analyse
    series[:, 2, 0], series[:, 3:6, 0] = nodes.c, nodes.shift
    series[:, 6:9, :-1] = nodes.gamma @ points.analyse
    return series


def _accumulate(orbit: Orbit, rates: Array, jump: Array, closing: Array) -> tuple[Array, Array]:
    """Integrals from the start, (P, k, n + 1), and over both arcs, (B, 2, k); arguments as in `Variations.sums`."""
    panels, points = orbit.panels, basis(rates.shape[2])
    series = (rates @ points.analyse @ points.integrate) * (panels.duration / 2)[:, None, None]
    ends = series.sum(axis=2) + jump
    series[..., 0] += running(ends, orbit.first, orbit.count) + jump
    gain = [np.bincount(panels.arc, ends[:, k], orbit.first.size) for k in range(ends.shape[1])]
    return series, (np.stack(gain, axis=1) + closing).reshape(-1, 2, ends.shape[1])
