"""The derivatives of what is measured along rods of constant angle."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..core.measures import DENSITIES, densities
from ..mechanics.potential import slopes_by_loads
from ..numerics.arrays import EPS, Array
from ..observe.measurement import BARELY
from ..problem.reduced import StartProblem
from .motions import MARKS, Motion, marks_of

EXTREMES = {  # the density, and whether the size counts
    "low": ("angle", False), "high": ("angle", False), "tightest": ("curvature", False), "least": ("outward", False),
    "most": ("outward", False), "tension": ("tension", True),
}  # fmt: skip
PUSHES = {"pushed", "pulled", "share", "middle push", "lifts"}

_STEADY = 1e-10  # relative: a change that is the same all along a helix
_ROUNDED = 4 * EPS  # of the terms of a density, for a change of 1


def of_helices(motion: Motion, unit: Array, later: Array, sign: Array, wanted: set[str], t: Array) -> dict[str, Array]:
    """How what is measured along helices answers F changes, and half a period, (b, F) each, by name.

    An extreme has a derivative where every place of the rod changes equally. unit: (b, 5, F), of
    `solution_derivatives.amounts`. later: (b, F), the change of the length in t. sign: (b,), of `Case.outward`. t:
    (b, n), the stations.
    """
    rods = _Helices(motion, unit, later, sign, t)
    found: dict[str, Array] = {"half_period": np.full_like(later, np.nan)}
    for name in wanted:
        if name in EXTREMES:
            found[name] = rods.extreme(*EXTREMES[name])
        elif name in DENSITIES:  # its integral has the same name
            found[name] = rods.integral(name)[:, 3]
    if "peak" in wanted:  # it stays at the start of a rod that remains a helix
        found["peak"] = 0 * rods.extreme("outward")
    if wanted & PUSHES:
        found |= {name: value for name, value in rods.pushes().items() if name in wanted}
    return found


@dataclass(frozen=True, eq=False)
class _Rates:
    """A density on b helices: values and the sizes of their terms (b,), its derivatives by beta (b, 1) and by the
    fields at a constant beta, (b, F)."""

    values: Array
    size: Array
    by_beta: Array
    own: Array


@dataclass(frozen=True, eq=False)
class _Helices:
    motion: Motion
    unit: Array
    later: Array
    sign: Array
    stations: Array

    @property
    def problem(self) -> StartProblem:
        return self.motion.problem

    @cached_property
    def turned(self) -> Array:
        """The integrals of d beta up to the marks, (b, 4, F)."""
        H_q = slopes_by_loads(self.problem.beta0[:, None])[..., 0]
        moved = self.motion.change(marks_of(self.problem), self.unit).integrals
        return np.asarray(np.einsum("bmgk,bk->bmg", moved, H_q) / (H_q**2).sum(axis=1)[:, None, None])

    @cached_property
    def along(self) -> Array:
        """d beta at the stations and the marks, (b, F, n)."""
        t = np.concatenate([self.stations, marks_of(self.problem)], axis=1)
        return np.asarray(self.motion.change(t, self.unit).beta.swapaxes(1, 2))

    def rates(self, density: str) -> _Rates:
        problem, beta = self.problem, self.problem.beta0[:, None]
        loads = np.stack([problem.lam, problem.mu, problem.phi, self.sign], axis=1)
        values, size, by_beta, _, *by_load = densities(density, loads, beta, 0 * beta)
        own = np.einsum("kb,bkg->bg", np.stack(by_load)[..., 0], self.unit[:, 2:])
        return _Rates(values[:, 0], size[:, 0], by_beta, own)

    def changes(self, rates: _Rates) -> tuple[Array, Array]:
        """The changes of a density along the rods, (b, F, n), and the sizes of their terms, (b, F)."""
        moved = rates.by_beta[..., None] * self.along
        return moved + rates.own[..., None], np.abs(moved).max(axis=2) + np.abs(rates.own)

    def least(self, rates: _Rates, size: Array) -> Array:
        """What counts as no difference between changes of a density, (b, F); size: of their terms.

        Also what rounding makes of changes that cancel: those of the fields by which `unit` moves the helix.
        """
        return _STEADY * size + _ROUNDED * rates.size[:, None] * np.abs(self.unit).sum(axis=1)

    def extreme(self, density: str, size_counts: bool = False) -> Array:
        rates = self.rates(density)
        change, size = self.changes(rates)
        steady = np.ptp(change, axis=2) <= self.least(rates, size)
        if not size_counts:
            return np.where(steady, change[..., 0], np.nan)
        none = np.abs(rates.values) <= BARELY * rates.size
        sized = np.where(none, 0.0, np.sign(rates.values))[:, None] * change[..., 0]
        return np.where(steady & ~(none[:, None] & (size > 0)), sized, np.nan)

    def integral(self, density: str) -> Array:
        """Up to the marks, (b, 4, F)."""
        rates = self.rates(density)
        shares = MARKS[:, None]
        own = rates.own * self.problem.span[:, None] + rates.values[:, None] * self.later
        return np.asarray(rates.by_beta[:, None] * self.turned + shares * own[:, None])

    def pushes(self) -> dict[str, Array]:
        """Of what is measured of the push; none where it is zero, and a change would make it push or pull."""
        rates = self.rates("outward")
        none = np.abs(rates.values) <= BARELY * rates.size
        pushes, pulls = ((turn * rates.values > 0)[:, None] & ~none[:, None] for turn in (1, -1))
        change, size = self.changes(rates)
        unsure = none[:, None] & (np.abs(change).max(axis=2) > self.least(rates, size))
        whole = self.integral("outward")
        found = {
            "pushed": np.where(pushes, whole[:, 3], 0.0),
            "pulled": np.where(pulls, -whole[:, 3], 0.0),
            "share": np.where(pushes, self.later, 0.0),
            "middle push": np.where(pushes, whole[:, 2] - whole[:, 1], 0.0),
            "lifts": np.where(pulls, 0.0, self.later),
        }
        return {name: np.where(unsure, np.nan, value) for name, value in found.items()}
