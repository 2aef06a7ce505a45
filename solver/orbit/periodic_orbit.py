"""The paper's quadrature (36) made exact, and nothing integrated beyond one half period.

The course of the orbit from its start to its turning points (or once round) is cut into pieces on which time is a
smooth function of one variable (`course`). On panels of these, short enough for a Chebyshev series to reach
rounding or the tolerance, t(u) is integrated and inverted, and beta, beta_t, alpha, z become series in t.
Reflection at the turning points and repetition do the rest: a rod of a million bends costs what one of three bends
costs. Converges geometrically; all problems are solved together.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import Array
from ..numerics.chebyshev import basis, polynomials
from ..problem.reduced import Reduced
from .panels import Panels, joined, panelled, running
from .phase import Phase, located
from .pieces import HELIX, LIBRATION, Arcs, arcs_of

_BLOCK = 4096  # stations evaluated at once: series and points stay in the cache


@dataclass(frozen=True, eq=False)
class Orbit:
    """The solved orbits of B problems, ready to be read anywhere along the rod.

    ahead, back: (B,), time from the start to the turning points forward and backward (once round: ahead alone).
    period: (B,), of beta_t; inf where nothing moves. lengthens: (B,), 1 where the way between the two end angles
    grows longer with the level, 0 where shorter, NaN where whoever made the orbits does not know; the index needs it.
    passed: (B,), turning points passed, where whoever made the orbits knows better than rounding tells.
    response: (B,), largest |d beta(t)/d beta(L)| along the rod, where whoever made the orbits knows it.
    path: the level and the path of each (`search.Way`), where it is an equilibrium that was searched for or followed.
    """

    problem: Reduced
    arcs: Arcs
    panels: Panels
    since: Array
    first: NDArray[np.int64]
    count: NDArray[np.int64]
    duration: Array
    gain: Array
    lengthens: Array | None = None
    response: Array | None = None
    passed: Array | None = None
    path: Any = None

    @property
    def kind(self) -> NDArray[np.int64]:
        """HELIX, LIBRATION or ROTATION, (B,)."""
        return self.arcs.kind

    @property
    def ahead(self) -> Array:
        return self.duration[0::2]

    @property
    def back(self) -> Array:
        return self.duration[1::2]

    @cached_property
    def period(self) -> Array:
        swings = np.where(self.arcs.kind == LIBRATION, 2.0, 1.0)
        return np.where(self.arcs.kind == HELIX, np.inf, swings * (self.ahead + self.back))

    @cached_property
    def turns(self) -> Array:
        """Turning points passed by the far end, (B,); 0 where beta does not swing."""
        if self.passed is not None:
            return self.passed
        return self.locate(self.problem.span[:, None]).turns[:, 0]

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """beta, beta_t, alpha, z at t (B, n), each (B, n)."""
        where = self.locate(t)
        values = self.read(self.panels.series[:, 0:4], where)
        return self._unfold(values, where)

    def take(self, i: int) -> "Orbit":
        """The orbit of problem i alone."""
        return self.pick(np.array([i]))

    def pick(self, rows: NDArray[np.int64]) -> "Orbit":
        """The orbits of the problems `rows`, (b,) rising."""
        parts = (2 * rows[:, None] + [0, 1]).reshape(-1)
        count = self.count[parts]
        first = np.cumsum(count) - count
        mine = np.repeat(self.first[parts] - first, count) + np.arange(count.sum())
        panels = replace(self.panels.take(mine), arc=np.repeat(np.arange(parts.size), count))
        way = Arcs(self.arcs.kind[rows], self.arcs.direction[rows], self.arcs.pieces)
        known = [None if v is None else v[rows] for v in (self.lengthens, self.response, self.passed)]
        known.append(None if self.path is None else self.path.take(rows))
        some, since = self.problem.take(rows), self.since[mine]
        return Orbit(some, way, panels, since, first, count, self.duration[parts], self.gain[parts], *known)

    def along(self, case: NDArray[np.int64], t: Array) -> tuple[Array, Array]:
        """alpha and z at single points of the rods: at t (N,) of the problems `case` (N,), (N,) each."""
        where = located(t[:, None], self.kind[case], self.ahead[case], self.back[case], self.period[case])
        where = replace(where, arc=2 * case[:, None] + where.second)
        values, beta0 = self.read(self.panels.series[:, 2:4], where), self.problem.beta0
        alpha = self._repeat(values[..., 0], where, 2, np.sin(beta0), case)
        z = self._repeat(values[..., 1], where, 3, np.cos(beta0), case)
        return alpha[:, 0], z[:, 0]

    def swirl(self, t: Array) -> Array:
        """The integral of sin(beta) cos(beta) from the start, (B, n)."""
        where = self.locate(t)
        value = self.read(self.panels.series[:, 4:5], where)[..., 0]
        s = np.sin(self.problem.beta0) * np.cos(self.problem.beta0)
        return self._repeat(value, where, 4, s)

    @property
    def exact(self) -> "Orbit":
        """What the index asks for."""
        return self

    def locate(self, t: Array) -> "Phase":
        """Where t (B, n) are on the courses."""
        return located(t, self.kind, self.ahead, self.back, self.period)

    def read(self, series: Array, where: "Phase") -> Array:
        """Series of the panels (P, k, n + 1) at the located times, (B, n, k)."""
        part, local = where.arc.reshape(-1), where.local.reshape(-1)
        out = np.empty((part.size, series.shape[1]))
        if not self.panels.arc.size:
            out[:] = 0
            return out.reshape(*where.arc.shape, -1)
        since, duration = self.since, self.panels.duration
        for k in range(0, part.size, _BLOCK):
            p, x = part[k : k + _BLOCK], local[k : k + _BLOCK]
            panel, last = self.first[p], self.first[p] + np.maximum(self.count[p] - 1, 0)
            for _ in range(int(self.count[p].max(initial=0)).bit_length()):  # halving what is left between the two
                middle = (panel + last + 1) // 2
                begun = x >= since[np.minimum(middle, since.size - 1)]
                panel, last = np.where(begun, middle, panel), np.where(begun, last, middle - 1)
            panel = np.minimum(panel, since.size - 1)
            with np.errstate(over="ignore"):  # a panel as short as a float can be, or shorter
                x = np.clip(2 * (x - since[panel]) / np.maximum(duration[panel], 5e-324) - 1, -1, 1)
            out[k : k + _BLOCK] = np.einsum(
                "pcn,np->pc", series[panel], polynomials(x, series.shape[2]), optimize=False
            )
        return out.reshape(*where.arc.shape, -1)

    def _unfold(self, values: Array, where: "Phase") -> tuple[Array, Array, Array, Array]:
        kind, direction = self.arcs.kind[:, None], self.arcs.direction[:, None]
        way = np.where(where.second, -direction, direction) * np.where(where.mirrored, -1.0, 1.0)
        helix = kind == HELIX
        around = np.where(kind == LIBRATION, 0.0, 2 * np.pi) * direction * where.rounds
        beta = np.where(helix, self.problem.beta0[:, None], values[..., 0] + around)
        dbeta = np.where(helix, 0.0, values[..., 1] * way)
        alpha = self._repeat(values[..., 2], where, 2, np.sin(self.problem.beta0))
        z = self._repeat(values[..., 3], where, 3, np.cos(self.problem.beta0))
        return beta, dbeta, alpha, z

    def _repeat(self, value: Array, where: "Phase", column: int, straight: Array, case: Any = slice(None)) -> Array:
        """A mean + periodic quantity of the problems `case` from its value within a course; `straight`: its rate on
        a helix, (B,)."""
        kind = self.arcs.kind[case, None]
        gain = self.gain[:, column - 2].reshape(-1, 2)[case]
        there, after = gain[:, :1], gain[:, 1:]
        limit = np.where(where.second, after, there)
        value = np.where(where.mirrored, 2 * limit - value, value) + np.where(where.second, 2 * there, 0.0)
        a_period = np.where(kind == LIBRATION, 2 * (there + after), there)
        return np.where(kind == HELIX, straight[case, None] * where.t, value + where.rounds * a_period)


def joined_orbits(orbits: list[Orbit]) -> Orbit:
    """The orbits of several batches as one."""
    sizes = np.array([orbit.problem.size for orbit in orbits])
    before = np.cumsum(sizes) - sizes
    panels = joined([replace(o.panels, arc=o.panels.arc + 2 * k) for o, k in zip(orbits, before, strict=True)])

    def column(name: str) -> Any:
        values = [getattr(orbit, name) for orbit in orbits]
        return None if any(v is None for v in values) else np.concatenate(values)

    fields: dict[str, Any] = {
        name: None if value is None else np.concatenate([getattr(o.problem, name) for o in orbits])
        for name, value in vars(orbits[0].problem).items()
    }
    kind, direction = (np.concatenate([getattr(o.arcs, n) for o in orbits]) for n in ("kind", "direction"))
    way = Arcs(kind, direction, orbits[0].arcs.pieces)
    count = column("count")
    rest = (column(name) for name in ("duration", "gain", "lengthens", "response", "passed"))
    return Orbit(Reduced(**fields), way, panels, column("since"), np.cumsum(count) - count, count, *rest)


def solve_orbit(problem: Reduced, tol: float, pin: tuple[Array, Array] | None = None, stretch: float = 1.0) -> Orbit:
    """The orbits of B start problems with finite numbers; `pin` as in `course`, `stretch` as in `panelled`."""
    way = arcs_of(problem, pin)
    n, length = (16, 0.6) if tol >= 1e-6 else (22, 0.45)
    return assembled(problem, way, panelled(problem, way, basis(n), length, 0.05 * tol, stretch=stretch))


def assembled(problem: Reduced, way: Arcs, panels: Panels) -> Orbit:
    """Orbits from their panels, each with integrals from its own near end; the panels' series are changed in place."""
    parts = 2 * problem.size
    count = np.bincount(panels.arc, minlength=parts)
    first = np.cumsum(count) - count
    duration = np.bincount(panels.arc, weights=panels.duration, minlength=parts)
    ends = panels.series[:, 2:].sum(axis=2)
    gain = np.stack([np.bincount(panels.arc, weights=ends[:, k], minlength=parts) for k in range(3)], axis=1)
    # times and integrals of each panel count from the start of its course
    before = running(np.column_stack([ends, panels.duration]), first, count)
    panels.series[:, 2:, 0] += before[:, :3]
    since = before[:, 3]
    return Orbit(problem, way, panels, since, first, count, duration, gain)
