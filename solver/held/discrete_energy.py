"""The energy of the shapes of a rod between held ends, on a mesh of panels, with its slope and its curvature.

The energy is that of bending and twist less the work of the loads and end moments that are given, in units of A/rho,
and beta along the rod the only unknown: a given rotation adds the energy of the twist that is left, a given height or
azimuth is a constraint. A minimum is a stable equilibrium of these ends, but for the error of the mesh; the reactions
are the multipliers of the constraints.
"""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import scipy  # its parts are imported when used

from ..branches.given_numbers import Given
from ..numerics.arrays import DOUBTFUL, FAINT, Array, Integers
from ..numerics.chebyshev import GAUSS, basis
from .bordered_bands import Bordered

_DEGREE = 8  # of beta on a panel; one on which it is not enough is halved. x10: more than six times the time
_LAYER = 3.0  # by how much panels beside an end grow. x10: a layer has one panel, which is halved
# rad: the last coefficients of beta on a panel that is fine enough: its equilibrium is solved for anyway. x10: as good
_SMOOTH = 1e-5
LONGEST = 0.6  # rad: the largest change of beta in a step. x10: descents may jump to another minimum
_LOAD_OF = {"z": "phi", "alpha": "lam"}


@dataclass(frozen=True, eq=False)
class _EnergyPanel:
    """The panel [0, 1].

    points, weights: of integrals, (q,). values, slopes: from its nodes to beta and its slope there, (q, d). products:
    of each two nodes there, (q, d * d).
    """

    points: Array
    weights: Array
    values: Array
    slopes: Array
    products: Array


@cache
def panel() -> _EnergyPanel:
    """The panel of all meshes."""
    chebyshev, unit = np.polynomial.chebyshev, np.eye(_DEGREE + 1)
    x, weights = GAUSS
    series = basis(_DEGREE + 1).analyse.T
    values = chebyshev.chebvander(x, _DEGREE) @ series
    slopes = 2 * np.stack([chebyshev.chebval(x, chebyshev.chebder(row)) for row in unit], axis=1) @ series
    products = (values[:, :, None] * values[:, None]).reshape(x.size, -1)
    return _EnergyPanel((x + 1) / 2, weights / 2, values, slopes, products)


@dataclass(frozen=True, eq=False)
class EnergyMesh:
    """P panels between breaks that rise from 0 to 1, as shares of the length; beta is a polynomial on each."""

    breaks: Array

    @classmethod
    def with_layers(cls, panels: int, layer: float) -> "EnergyMesh":
        """So many equal panels, and narrower ones beside both ends, where a layer is so wide."""
        breaks, edges = np.linspace(0, 1, panels + 1), list[float]()
        while layer < 0.7 * breaks[1]:
            edges.append(layer)
            layer *= _LAYER
        return cls(np.unique(np.concatenate([breaks, edges, 1 - np.array(edges)])))

    @cached_property
    def widths(self) -> Array:
        """(P,)."""
        return np.diff(self.breaks)

    @cached_property
    def nodes(self) -> Array:
        """(n,), rising."""
        return np.append(self._inside((basis(_DEGREE + 1).nodes[:-1] + 1) / 2).ravel(), 1.0)

    @cached_property
    def points(self) -> Array:
        """Of integrals, (P, q)."""
        return self._inside(panel().points)

    def _inside(self, places: Array) -> Array:
        return self.breaks[:-1, None] + self.widths[:, None] * places

    @cached_property
    def _own(self) -> Integers:
        """The nodes of each panel, (P, d)."""
        return _DEGREE * np.arange(self.widths.size)[:, None] + np.arange(_DEGREE + 1)

    def on_panels(self, beta: Array) -> Array:
        """Values at the nodes (n,) by panels, (P, d)."""
        return beta[self._own]

    def sums(self, each: Array) -> Array:
        """The sums at the nodes (n,) of what panels (P, d) contribute to theirs."""
        out = np.append(each[:, :-1].ravel(), 0.0)
        out[_DEGREE::_DEGREE] += each[:, -1]
        return out

    def band(self, blocks: Array) -> Array:
        """The sums of what panels contribute to pairs of their nodes (P, d, d), symmetric, as a band (d, n)."""
        out = np.zeros((_DEGREE + 1, self.nodes.size))
        out[0] = self.sums(np.diagonal(blocks, axis1=1, axis2=2))
        for i in range(1, _DEGREE + 1):
            diagonal = out[i, :-1].reshape(-1, _DEGREE)
            diagonal[:, : _DEGREE + 1 - i] = np.diagonal(blocks, -i, axis1=1, axis2=2)
        return out

    def finer(self, beta: Array) -> "EnergyMesh":
        """The mesh with each panel halved on which beta (n,) is rough; itself where there is none."""
        rough = np.abs((self.on_panels(beta) @ basis(_DEGREE + 1).analyse)[:, -2:]).max(axis=1) > _SMOOTH
        middles = (self.breaks[:-1] + self.breaks[1:]) / 2
        return EnergyMesh(np.sort(np.append(self.breaks, middles[rough]))) if rough.any() else self

    def read(self, beta: Array, u: Array) -> Array:
        """beta at other shares of the length u (m,), from that at the nodes."""
        at = np.clip(np.searchsorted(self.breaks, u, side="right") - 1, 0, self.widths.size - 1)
        x = 2 * (u - self.breaks[at]) / self.widths[at] - 1
        series = (self.on_panels(beta) @ basis(_DEGREE + 1).analyse)[at]
        return np.asarray((np.polynomial.chebyshev.chebvander(x, _DEGREE) * series).sum(axis=1))


@dataclass(frozen=True, eq=False)
class _Slopes:
    """The energy beside a shape that meets the m constraints, by changes of the k free angles.

    slope: (k,), without what the constraints resist. curved: its borders are the constraints, and where the rotation is
    held the swirl. reactions: (m,).
    """

    slope: Array
    curved: Bordered
    reactions: Array


@dataclass(frozen=True, eq=False)
class DiscreteEnergy:
    """The energy of shapes on a mesh between given ends; a shape is beta at the n nodes.

    pace: about the beta_t that the loads make; bending and pace^2 times the square of a change are its size.
    """

    given: Given
    mesh: EnergyMesh
    pace: float

    @cached_property
    def held(self) -> list[str]:
        """The m held displacements that are constraints."""
        return [name for name in _LOAD_OF if name in self.given.names]

    @cached_property
    def _weights(self) -> Array:
        """Of integrals over t, (P, q)."""
        return self.given.span * self.mesh.widths[:, None] * panel().weights

    @cached_property
    def _bend_form(self) -> Array:
        """Twice the energy of beta_t on each panel as a form of its angles, (P, d, d)."""
        form = (panel().slopes.T * panel().weights) @ panel().slopes
        return np.asarray(form / (self.given.span * self.mesh.widths[:, None, None]))

    @cached_property
    def _moments(self) -> Array:
        """What given end moments add to the slope of the energy, (n,)."""
        moments = np.zeros(self.mesh.nodes.size)
        moments[0], moments[-1] = self.given.number("dbeta0", 0.0), -self.given.number("dbetaL", 0.0)
        return moments

    def _bend_slope(self, beta: Array) -> Array:
        """The slope of the energy of beta_t on each panel, (P, d)."""
        return np.asarray((self._bend_form @ self.mesh.on_panels(beta)[:, :, None])[:, :, 0])

    @cached_property
    def _free(self) -> slice:
        """The nodes whose angle is not given."""
        return slice(int("beta0" in self.given.names), self.mesh.nodes.size - int("betaL" in self.given.names))

    @cached_property
    def metric(self) -> Array:
        """The size of changes of the free angles as a form, a band (d, k)."""
        return self._form(self.pace**2 * self._weights)

    @cached_property
    def _factor(self) -> Array:
        """The Cholesky factor of the metric, a band."""
        return np.asarray(scipy.linalg.lapack.dpbtrf(self.metric, lower=1)[0])

    def _form(self, density: Array) -> Array:
        """Twice the energy of beta_t, and the integral of a density (P, q), its weights included, times the square of a
        change, by the free angles, as a band (d, k)."""
        blocks = self._bend_form + (density @ panel().products).reshape(self._bend_form.shape)
        return self.mesh.band(blocks)[:, self._free]

    def _row(self, density: Array) -> Array:
        """The integral of a density (P, q), its weights included, times a change of beta, by the free angles (k,)."""
        return self.mesh.sums(density @ panel().values)[self._free]

    def angles(self, beta: Array) -> Array:
        """beta at the points of integrals, (P, q)."""
        return np.asarray(self.mesh.on_panels(beta) @ panel().values.T)

    def shape(self, beta: Array) -> Array:
        """The shape (n,) with the given angles at the ends."""
        ends = self.given.number("beta0", beta[0]), self.given.number("betaL", beta[-1])
        return np.concatenate([ends[:1], beta[1:-1], ends[1:]])

    def move(self, beta: Array, step: Array) -> Array:
        """The shape after a step (k,) of the free angles."""
        new = beta.copy()
        new[self._free] += step
        return new

    def loads(self, beta: Array, reactions: Array) -> dict[str, float]:
        """lam, mu and phi, of a shape with the reactions to its constraints (m,)."""
        given = self.given
        loads = {name: given.number(name, 0.0) for name in ("lam", "mu", "phi")}
        if "turn" in given.names:
            swirl = float((self._weights * np.sin(2 * self.angles(beta))).sum()) / 2
            loads["mu"] = (given.number("turn", 0.0) + swirl) / (given.ratio * given.span)
        return loads | {_LOAD_OF[name]: float(x) for name, x in zip(self.held, reactions, strict=True)}

    def energy(self, beta: Array) -> float:
        """The held energy of a shape, in units of A/rho."""
        given, b = self.given, self.angles(beta)
        s, c = np.sin(b), np.cos(b)
        mu, swirl = given.number("mu", 0.0), float((self._weights * s * c).sum())
        twist = mu * swirl - given.ratio * mu**2 * given.span / 2
        if "turn" in given.names:
            twist = (given.number("turn", 0.0) + swirl) ** 2 / (2 * given.ratio * given.span)
        rest = s**4 / 2 - given.number("phi", 0.0) * c - given.number("lam", 0.0) * s
        bending = (self._bend_slope(beta) * self.mesh.on_panels(beta)).sum() / 2
        return float(bending + self._moments @ beta + (self._weights * rest).sum() + twist)

    def _constraints(self, beta: Array) -> tuple[Array, Array]:
        """By how much a shape misses the constraints (m,), and how they change by the free angles (m, k)."""
        b = self.angles(beta)
        s, c = np.sin(b), np.cos(b)
        each = {"z": (c, -s), "alpha": (s, c)}
        miss = [(self._weights * each[name][0]).sum() - self.given.number(name, 0.0) for name in self.held]
        rows = [self._row(self._weights * each[name][1]) for name in self.held]
        return np.array(miss), np.array(rows).reshape(len(rows), self.metric.shape[1])

    def _across(self, rows: Array) -> Array | None:
        """The shortest changes that change the constraints by one, (k, m); None of a straight rod, whose constraints do
        not change to first order."""
        steepest = scipy.linalg.lapack.dpbtrs(self._factor, rows.T, lower=1)[0]
        square = rows @ steepest
        size = float(np.trace(square)) ** square.shape[0]
        # the constraints of a straight rod depend on each other, to rounding
        if not float(np.linalg.det(square)) > FAINT * size > 0:
            return None
        return steepest @ np.linalg.inv(square)

    def meet(self, beta: Array, rounds: int) -> Array | None:
        """The shape next to one that meets the constraints; None where the rounds lead to none."""
        for _ in range(rounds if self.held else 0):
            miss, rows = self._constraints(beta)
            if np.abs(miss).max() < DOUBTFUL * self.given.span:
                return beta
            across = self._across(rows)
            if across is None:
                return None
            step = -across @ miss
            beta = self.move(beta, step * min(1.0, LONGEST / float(np.abs(step).max())))
        return None if self.held else beta

    def slopes(self, beta: Array) -> _Slopes | None:
        """The derivatives at a shape that meets the constraints; None of a straight rod that is held."""
        given, weights, b = self.given, self._weights, self.angles(beta)
        s, c, c2 = np.sin(b), np.cos(b), np.cos(2 * b)
        rows, dead = self._constraints(beta)[1], self.loads(beta, np.zeros(len(self.held)))
        rise = 2 * s**3 * c + dead["phi"] * s - dead["lam"] * c + dead["mu"] * c2
        slope = self.mesh.sums(self._bend_slope(beta) + (weights * rise) @ panel().values) + self._moments
        across = self._across(rows) if self.held else np.empty((rows.shape[1], 0))
        if across is None:
            return None
        reactions = across.T @ slope[self._free]
        loads, corner = self.loads(beta, reactions), np.zeros(len(self.held))
        bend = 6 * (s * c) ** 2 - 2 * s**4 + loads["phi"] * c + loads["lam"] * s - 4 * loads["mu"] * s * c
        borders = rows
        if "turn" in given.names:  # its energy curves by the square of this row, divided by the negative corner
            borders, corner = np.vstack([rows, self._row(weights * c2)]), np.append(corner, -given.ratio * given.span)
        curved = Bordered(self._form(weights * bend), borders, corner)
        return _Slopes(slope[self._free] - reactions @ rows, curved, reactions)
