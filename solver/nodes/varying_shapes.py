"""The shapes of B rods whose loads vary along them, on nodes from which everything along them is read."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from ..core.measures import densities
from ..core.tuning import BARELY
from ..core.weight_friction import READ, SIZE, march
from ..numerics.arrays import FAINT, Array, Booleans, Integers
from ..numerics.chebyshev import GAUSS
from ..numerics.roots import largest_between, sign_changes
from ..orbits.forces import circumferential_force, contact_force, curvature, surface_forces
from ..orbits.potential import Loads, slope
from ..problem.case import IN_PLACE
from .loaded_rod import ALPHA, BETA, MU, PHI, SPEED, LoadedRod, Q
from .pipe_states import STRAIGHT, StretchState, ends_turn, is_drawn, least_pull, states

# places on a stretch, at which the states along a rod are judged: a stretch has a few radians. x10: only time
DENSE = 17
FINE = 2  # nodes of a start problem, for each step of its march. x10: the same readings in four times the time


@dataclass(frozen=True, eq=False)
class Shape:
    """A rod on nodes. t: (N,). y: (N, 8), states at the nodes. steps: those of Newton that were taken."""

    rod: LoadedRod
    t: Array
    y: Array
    steps: int = 0

    def at(self, t: Array) -> Array:
        """States at times t (n,), rising, (n, 8)."""
        stretch = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, self.t.size - 2)
        first = np.searchsorted(stretch, np.arange(self.t.size))
        return self._read(first, t - self.t[stretch])

    def between(self, places: Array) -> Array:
        """States at places (m,) of [-1, 1], rising, on each stretch, (N - 1, m, 8)."""
        width, m = np.diff(self.t), places.size
        stations = (width[:, None] * (1 + places) / 2).reshape(-1)
        return self._read(m * np.arange(self.t.size), stations).reshape(width.size, m, SIZE)

    def _read(self, first: Integers, stations: Array) -> Array:
        """States at stations of the stretches, as of `core.weight_friction.march`."""
        rod = self.rod
        return march(rod.numbers, rod.scale, self.y[:-1], np.diff(self.t), first=first, stations=stations).out

    def local_values(self, y: Array) -> Array:
        """What `observe` integrates, from states (Q, m, 8), as (Q, 7, m).

        beta, beta_t, lam, mu, phi, omega sin(theta) cos(alpha), and what friction divides the contact force by.
        """
        _, _, across, rubbed, way, a, outward = self.rod.numbers
        divisor = 1 - (way == IN_PLACE) * outward * rubbed * a * y[:, :, SPEED]
        beta, speed, lam, mu, phi = (y[:, :, k] for k in (BETA, SPEED, Q, MU, PHI))
        return np.stack([beta, speed, lam + mu, mu, phi, across * np.cos(y[:, :, ALPHA]), divisor], axis=1)

    def push_at(self, t: Array) -> Array:
        """The push at times t (n,) in any order, in units of A/rho^3, (n,)."""
        return self.pushes(self._states(t))

    def _states(self, t: Array) -> Array:
        """States at times t (n,) in any order, (n, 8)."""
        order = np.argsort(t)
        y = np.empty((t.size, SIZE))
        y[order] = self.at(t[order])
        return y

    def pushes(self, y: Array) -> Array:
        """The push in states y (n, 8), in units of A/rho^3, (n,)."""
        beta, speed, lam, mu, phi, weight, divisor = self.local_values(y[None])[0]
        around = circumferential_force(1.0, lam, mu, 1.0, beta)
        plain = contact_force(1.0, mu, 1.0, around, slope(Loads(lam, mu, phi), beta), beta, speed)
        return np.asarray(self.rod.numbers[6] * (plain - weight) / divisor)

    def _pushes_and_rounding(self, y: Array) -> Array:
        """The push plus its rounding in states y (n, 8), in units of A/rho^3, (n,): negative where the wall pulls."""
        beta, speed, lam, mu, phi, weight, _ = self.local_values(y[None])[0]
        loads = np.stack([lam, mu, phi, np.full(lam.size, self.rod.numbers[6])], axis=1)
        terms = densities("outward", loads, beta[:, None], speed[:, None])
        return self.pushes(y) + terms.rounding[:, 0] + BARELY * np.abs(weight)

    @cached_property
    def dense(self) -> tuple[Array, Array]:
        """Times and states (n,) and (n, 8), dense enough to judge what the rod does between its nodes."""
        places = np.linspace(-1, 1, DENSE)[:-1]
        y = np.concatenate([self.between(places).reshape(-1, SIZE), self.y[-1:]])
        t = (self.t[:-1, None] + np.diff(self.t)[:, None] * (1 + places) / 2).reshape(-1)
        return np.append(t, self.t[-1]), y

    def bend_and_tension(self, t: Array) -> tuple[Array, Array]:
        """kappa and F3 at rising times t, in units of rho and A, (n,) each."""
        beta, speed, lam, mu, phi, _, _ = self.local_values(self.at(t)[None])[0]
        around = circumferential_force(1.0, lam, mu, 1.0, beta)
        return curvature(1.0, beta, speed), surface_forces(around, phi, beta)[1]

    def largest_strain(self, bent: float, stretched: float) -> float:
        """The largest strain along the rod: `bent` times kappa plus `stretched` times |F3|, in units of rho and A."""

        def strain(t: Array) -> Array:
            kappa, F3 = self.bend_and_tension(t)
            return (bent * kappa + stretched * np.abs(F3))[None]

        return float(largest_between(strain, self.dense[0])[0][0])

    def states(self, rho: float) -> tuple[StretchState, ...]:
        """The states along the rod, with s in the unit of rho."""
        t, y = self.dense
        turns = ends_turn(bool(self.rod.across), "azimuth" in self.rod.held)
        return states(t * rho, y[:, BETA], y[:, ALPHA], is_drawn(y[:, PHI], self.pushes(y)), turns)

    @property
    def is_bent(self) -> bool:
        """Whether some stretch of the rod is a sinusoid or a helix."""
        return any(state.word != STRAIGHT for state in self.states(1.0))

    def lift_offs(self, rho: float) -> tuple[tuple[float, float], ...]:
        """The stretches on which the wall would have to pull, from one s to another, in the unit of rho.

        A pull of less than its rounding is none, as in `core/measures.c`, and so is one on a stretch where it stays
        below `least_pull`.
        """
        t, y = self.dense
        push = self._pushes_and_rounding(y)
        pulls = push < 0
        zeros = sign_changes(lambda t: self._pushes_and_rounding(self._states(t)), t, np.where(pulls, -1, 1))
        ends = [*(t[:1] if pulls[0] else ()), *zeros, *(t[-1:] if pulls[-1] else ())]
        first = np.flatnonzero(pulls & ~np.append(False, pulls[:-1]))
        after = np.flatnonzero(pulls & ~np.append(pulls[1:], False)) + 1
        least = -least_pull(np.abs(push).max())
        deep = [push[a:b].min() < least for a, b in zip(first, after, strict=True)]
        return tuple(
            (float(a * rho), float(b * rho)) for a, b, counts in zip(ends[::2], ends[1::2], deep, strict=True) if counts
        )

    def lift_off_reach(self) -> float:
        """The largest t from the nearer end at which the wall would have to pull, 0 where it does nowhere."""
        return max((min(b, float(self.t[-1]) - a) for a, b in self.lift_offs(1.0)), default=0.0)

    def square_twist(self) -> float:
        """The mean of the square of mu over the length."""
        places, weights = GAUSS
        squares = self.between(places)[:, :, MU] ** 2 @ weights / 2
        return float(squares @ np.diff(self.t) / self.t[-1])

    def neutral(self) -> float:
        """The first t at which FZ changes its sign; NaN where it does not."""
        changes = sign_changes(lambda t: self.at(t)[:, PHI], self.t, self.y[:, PHI])
        return float(changes[0]) if changes.size else np.nan

    def bends(self, rho: float) -> tuple[tuple[float, float], ...]:
        """The interior extrema of beta: s in the unit of rho, and the size [rad], the smaller one of the changes of
        beta from there to the next ones or to an end. A change of less than `FAINT` of the largest beta is rounding.
        """
        t, y = self.dense
        moving = np.flatnonzero(y[1:-1, SPEED]) + 1
        speed = y[moving, SPEED]
        k = np.flatnonzero(np.sign(speed[1:]) != np.sign(speed[:-1]))
        first, share = moving[k], speed[k] / (speed[k] - speed[k + 1])
        after = share * (t[moving[k + 1]] - t[first])  # beta_t is linear between the two
        beta = np.concatenate([y[:1, BETA], y[first, BETA] + speed[k] * after / 2, y[-1:, BETA]])
        # a change of beta that is smaller, of the largest, is rounding
        kept = np.array(places_of_extremes(beta, FAINT * np.abs(y[:, BETA]).max()))
        change = np.abs(np.diff(beta[kept]))
        places = (t[first] + after)[kept[1:-1] - 1] * rho
        return tuple(zip(places.tolist(), np.minimum(change[1:], change[:-1]).tolist(), strict=True))


def places_of_extremes(values: Array, least: float) -> list[int]:
    """The places of the first and the last of values (n,), and between them of the extremes that differ from the ones
    next to them by more than `least`."""
    kept, far, way = [0], 0, 0.0
    for i, moved in ((i, value - values[far]) for i, value in enumerate(values)):
        if moved * way > 0:
            far = i
        elif abs(moved) > least:
            kept += [far] * bool(way)
            far, way = i, moved
    return [*kept, values.size - 1]


@dataclass(frozen=True, eq=False)
class Marched:
    """Start problems, whose shapes are computed when they are asked for, as those between the ends that they have.

    numbers, scale, begin: (B, 7), (B, 8) and (B, 8). span, steps: (B,), lengths and steps of their march.
    """

    numbers: Array
    scale: Array
    begin: Array
    span: Array
    steps: Integers

    def __getitem__(self, i: int) -> Shape | None:
        t = np.linspace(0, self.span[i], max(FINE * int(self.steps[i]), 4) + 1)
        first = np.array([0, t.size])
        y = march(self.numbers[i], self.scale[i], self.begin[[i]], self.span[[i]], first=first, stations=t).out
        far = y[-1, [SPEED, Q, PHI, MU]] + [0, y[-1, MU], 0, 0]
        rod = LoadedRod(self.numbers[i], float(self.span[i]), frozenset({"beta0"}), y[0, [BETA, ALPHA]], far)
        return Shape(rod.in_scales(self.scale[i]), t, y) if np.isfinite(y).all() else None


@dataclass(frozen=True, eq=False)
class VaryingShapes:
    """The rods of B problems.

    shapes: of each rod, computed or in a list; None for a rod without one. index: (B,), Morse indices under what the
    ends hold, NaN where there is none. critical: (B,), the share of the loads at which the straight rod buckles, NaN
    where it does not or was not asked.
    """

    shapes: "Marched | _SelectedShapes | Sequence[Shape | None]"
    index: Array
    critical: Array

    @cached_property
    def _known(self) -> dict[int, Shape | None]:
        return {}

    def of(self, i: int) -> Shape | None:
        """The shape of one rod, computed once."""
        if i not in self._known:
            self._known[i] = self.shapes[i]
        return self._known[i]

    def each(self, count: int) -> list[Shape | None]:
        """The shapes of so many rods; that of one rod for all of them."""
        return [self.of(i if self.index.size > 1 else 0) for i in range(count)]

    def only(self, fit: Booleans) -> "VaryingShapes":
        """The rods without the shapes of those that are not `fit` (B,)."""
        shapes = [shape if fits else None for shape, fits in zip(self.each(fit.size), fit, strict=True)]
        return VaryingShapes(shapes, *(np.where(fit, values, np.nan) for values in (self.index, self.critical)))

    def take(self, rows: Integers) -> "VaryingShapes":
        """The rods of the problems `rows`, (b,); each is computed where it is asked for."""
        return VaryingShapes(_SelectedShapes(self, rows), self.index[rows], self.critical[rows])

    def ends(self) -> tuple[Array, Array]:
        """States at the start and at the far end, (B, 8) each; NaN for a rod without a shape."""
        pairs = self.numbers(lambda shape: shape.y[[0, -1]], (2, SIZE))
        return pairs[:, 0], pairs[:, 1]

    def read(self, t: Array, alpha0: Array) -> dict[str, Any]:
        """What a trajectory holds at stations t (B, n), whose azimuth begins at alpha0 (B,); NaN without a shape."""
        shapes, none = self.each(len(t)), np.full((t.shape[1], SIZE), np.nan)
        y = np.array([none if shape is None else shape.at(times) for shape, times in zip(shapes, t, strict=True)])
        ratio = self.numbers(lambda shape: shape.rod.numbers[0])
        return read_starts(np.moveaxis(y[:, :, READ], -1, 0), t, alpha0, ratio * self.ends()[1][:, MU])

    def numbers(self, read: Callable[[Shape], Any], size: tuple[int, ...] = ()) -> Array:
        """What is read of each rod, (B, *size); NaN for a rod without a shape."""
        shapes = self.each(self.index.size)
        return np.array([np.full(size, np.nan) if shape is None else read(shape) for shape in shapes], dtype=float)


@dataclass(frozen=True, eq=False)
class _SelectedShapes:
    """The rods at some rows, (b,), of those of more problems."""

    whole: VaryingShapes
    rows: Integers

    def __getitem__(self, i: int) -> Shape | None:
        return self.whole.of(int(self.rows[i]))


def read_starts(y: Array, t: Array, alpha0: Array, twist: Array) -> dict[str, Any]:
    """What a trajectory holds, from states (8, B, n) at t (B, n) in the order of a march with `judge`, in their place.

    twist: (B,), A/C times mu at the far end.
    """
    beta, dbeta, alpha, lam, mu, _, short, turned = y
    alpha -= alpha0[:, None]
    lam += mu
    np.subtract(t, short, out=short)
    swirl = partial(_swirl, twist[:, None], t, turned, alpha)
    return {"beta": beta, "dbeta": dbeta, "alpha": alpha, "z": short, "swirl": swirl, "loads": y[Q : PHI + 2]}


def _swirl(twist: Array, t: Array, turned: Array, alpha: Array) -> Array:
    return np.asarray(twist * t - turned + alpha)
