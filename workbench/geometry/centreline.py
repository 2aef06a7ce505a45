"""The centreline of one stored case as a smooth curve, and its error between stations. NumPy and SciPy only.

Nothing is solved. Between stations the curve follows from stored values: the tangent from beta, its rate from
beta'' = -H(beta), which needs the stored loads, and beta' from both sides of a station. Where the stations are farther
apart than the swings of beta, such a curve may miss swings without a trace: there alpha and z rise evenly from station
to station, and the error is the largest that a rod of that length can have.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly, make_interp_spline

from solver.orbits import forces, frames
from solver.orbits.forces import contact_force, push_from
from solver.orbits.potential import Loads, dimensional_slope, potential
from solver.problem.errors import InputError
from studies.language.study import MAX_STATIONS

Array = NDArray[np.float64]

NEEDED = ("beta", "alpha", "z", "R", "a", "rho", "L", "FZ", "MZ", "M3")
GAUSS, WEIGHT = (0.5 * (v + k) for v, k in zip(np.polynomial.legendre.leggauss(5), (1.0, 0.0), strict=True))
ROUNDS = 6  # each reduces the error of beta' by a factor of some (step x largest frequency)^2 / 10
DEGREE = 5  # of the splines through the stations
ORDER, CUBIC_ORDER = 6, 4  # of the errors of the curve and of the cubics between stations, in their distance
VALUE_ORDER = 5  # of the error of what follows from beta', as the push and the curvature do
EASED = 4.0  # an error falls by that much at least where stations are twice as near; by 32 where they are near enough
PARTS = 4  # of an interval, for a better number of stations
APART = 3.0  # radians of a swing of beta between stations; from pi on a swing may lie between two of them unseen
SHARES = np.linspace(0, 1, 17)[1:-1]  # of an interval: where the cubic is compared with the curve


class TooFewStations(InputError):
    """The stations are too few for what is drawn; `stations`: about how many are needed."""

    def __init__(self, sentence: str, stations: int) -> None:
        super().__init__(sentence)
        self.stations = stations


@dataclass(frozen=True, eq=False)
class Centreline:
    """A rod's centreline r(s), 0 <= s <= L, in the dataset's own units.

    s, alpha, beta, dbeta, z: at the stations, (n,). A: bending stiffness; l, m, p: MZ/A, M3/A, FZ/A. bore: inner radius
    of a tube, 0 of a solid section. unit: that of length, for messages. stored_slopes: dbeta is stored; else it follows
    from beta, and where `phase_step` is above `APART` only its size does.
    """

    s: Array
    alpha: Array
    beta: Array
    dbeta: Array
    z: Array
    R: float
    a: float
    rho: float
    A: float
    l: float
    m: float
    p: float
    side: str
    bore: float = 0.0
    unit: str = ""
    stored_slopes: bool = True

    @property
    def L(self) -> float:
        return float(self.s[-1] - self.s[0])

    @property
    def reach(self) -> float:
        """The largest distance of the centreline from the axis [length]."""
        return self.rho

    @property
    def place(self) -> Array:
        """The centreline at the stations, (n, 3) [length]."""
        return frames.position(self.rho, self.alpha, self.z)

    @property
    def tangent(self) -> Array:
        """The unit tangent at the stations, (n, 3)."""
        return frames.tangent(self.alpha, self.beta)

    @property
    def bend(self) -> Array:
        """beta'' at the stations, (n,) [1/length^2]."""
        return -dimensional_slope(self.l, self.m, self.p, self.rho, self.beta)

    @cached_property
    def _angle(self) -> Any:
        return through(self.s, np.stack([self.beta, self.dbeta, self.bend], axis=-1))

    @cached_property
    def _curve(self) -> Any:
        """alpha and z, each with three derivatives known at every station."""
        sin, cos = np.sin(self.beta), np.cos(self.beta)
        around = np.stack([sin, cos * self.dbeta, cos * self.bend - sin * self.dbeta**2], axis=-1) / self.rho
        up = np.stack([cos, -sin * self.dbeta, -sin * self.bend - cos * self.dbeta**2], axis=-1)
        known = np.stack([np.column_stack([self.alpha, around]), np.column_stack([self.z, up])], axis=-1)
        return through(self.s, known)

    @cached_property
    def phase_step(self) -> float:
        """The radians of a swing of beta between stations, at most: the step times the largest frequency."""
        return _phase_step(self.s, self.beta, self.rho, self.l, self.m, self.p)

    @cached_property
    def smooth(self) -> bool:
        """Whether the curve is the smooth one through the stations; else alpha and z rise evenly between them."""
        return self.phase_step <= APART and self._smooth_error <= self.chord_error

    def at(self, s: Array) -> tuple[Array, Array, Array]:
        """alpha, beta [rad] and z [length] at s, (k,) each."""
        if not self.smooth:
            return self._even(self.alpha, s), self._even(self.beta, s), self._even(self.z, s)
        alpha, z = self._curve(s).T
        return alpha, self._angle(s), z

    def _even(self, values: Array, s: Array) -> Array:
        return np.interp(s, self.s, values)

    def frame(self, s: Array) -> tuple[Array, Array, Array, Array]:
        """Position, tangent, outward normal and the normal in the surface at s, (k, 3) each."""
        alpha, beta, z = self.at(s)
        place = frames.position(self.rho, alpha, z)
        return place, frames.tangent(alpha, beta), frames.outward(alpha), frames.binormal(alpha, beta)

    def kappa(self, s: Array) -> Array:
        """Curvature at s, (k,) [1/length]."""
        if not self.smooth:
            return self._even(forces.curvature(self.rho, self.beta, self.dbeta), s)
        return forces.curvature(self.rho, self._angle(s), self._angle(s, 1))

    def contact(self, s: Array) -> Array:
        """The cylinder's push per length at s, (k,) [force/length], positive outward; eq. (34), corrected."""
        if not self.smooth:
            return self._even(self._contact(self.beta, self.dbeta), s)
        return self._contact(self._angle(s), self._angle(s, 1))

    def _contact(self, beta: Array, dbeta: Array) -> Array:
        around = forces.circumferential_force(self.A, self.l, self.m, self.rho, beta)
        H = dimensional_slope(self.l, self.m, self.p, self.rho, beta)
        return contact_force(self.A, self.m, self.rho, around, H, beta, dbeta)

    def push(self, s: Array) -> Array:
        """The cylinder's push at s on either side, (k,) [force/length], negative where it would have to pull."""
        return push_from(self.contact(s), self.side)

    @property
    def error(self) -> float:
        """The estimated error of the curve between stations [length]."""
        return self._smooth_error if self.smooth else self.chord_error

    @cached_property
    def _smooth_error(self) -> float:
        """The curve through the angles, integrated from one station, misses the next by this much at most [length]."""
        h = np.diff(self.s)[:, None]
        beta = self._angle(self.s[:-1, None] + h * GAUSS)
        across = self.rho * np.diff(self.alpha) - (h * np.sin(beta)) @ WEIGHT
        up = np.diff(self.z) - (h * np.cos(beta)) @ WEIGHT
        return float(np.hypot(across, up).max())

    @cached_property
    def chord_error(self) -> float:
        """The greatest possible distance of the rod from an even rise between stations [length], whatever its shape.

        The rod is not stretched: of length h between two points c apart on the unrolled cylinder it stays within
        sqrt(h^2 - c^2)/2 of their chord.
        """
        chord = np.hypot(self.rho * np.diff(self.alpha), np.diff(self.z))
        return float(np.sqrt(np.maximum(np.diff(self.s) ** 2 - chord**2, 0)).max() / 2)

    def cut(self, parts: int) -> Self:
        """This curve through so many times as many stations."""
        s = cut(self.s, parts)
        alpha, beta, z = self.at(s)
        dbeta = self._angle(s, 1) if self.smooth else self._even(self.dbeta, s)
        return replace(self, s=s, alpha=alpha, beta=beta, dbeta=dbeta, z=z)

    def every_other(self) -> Self:
        """The curve through every other station and the last one."""
        kept = _every_other(self.s.size)
        return replace(self, **{name: getattr(self, name)[kept] for name in self._arrays})

    @property
    def _arrays(self) -> tuple[str, ...]:
        return ("s", "alpha", "beta", "dbeta", "z")

    def value_error(self, value: "Callable[[Centreline, Array], Array]") -> float:
        """The estimated error between stations of a quantity along the rod, of a function of a curve and of s.

        The curve through every other station misses the others by this much, times what the smaller distance gains.
        """
        left_out = self.s[1::2]
        return float(np.abs(value(self.every_other(), left_out) - value(self, left_out)).max()) / EASED

    @cached_property
    def cubic(self) -> Any:
        """Cubic curves in space from station to station, with the exact tangents there; its `c`: control points."""
        return through(self.s, np.stack([self.place, self.tangent], axis=1))

    @cached_property
    def cubic_error(self) -> float:
        """The largest distance of `cubic` from the rod at the same s [length]: from the curve, and that curve's."""
        return self._distance(self.cubic) + self.error

    def _distance(self, cubic: Any) -> float:
        """The largest distance of cubics from the curve at the same s [length]."""
        s = (cubic.x[:-1, None] + np.diff(cubic.x)[:, None] * SHARES).ravel()
        return float(np.linalg.norm(cubic(s) - self.frame(s)[0], axis=-1).max())

    def stations_for(self, tolerance: float, cubic: bool = False) -> int:
        """About how many stations are needed for an `error`, or a `cubic_error`, within the tolerance [length].

        The errors go with powers of the distance of stations. That of the cubics is extrapolated from cubics over parts
        of the intervals. Half of the tolerance is for the cubics, half for the curve.
        """
        n, allowed = self.s.size - 1, tolerance / 2 if cubic else tolerance
        more = n * max(self.error / allowed, 1.0) ** (1 / ORDER)
        if self.error > allowed:
            more = max(more, n * 2 * self.phase_step / APART)
        if cubic:
            s = np.interp(np.arange(PARTS * n + 1) / PARTS, np.arange(n + 1), self.s)
            place, tangent, _, _ = self.frame(s)
            missed = self._distance(through(s, np.stack([place, tangent], axis=1)))
            more = max(more, PARTS * n * (missed / allowed) ** (1 / CUBIC_ORDER))
        return int(np.ceil(1.1 * more)) + 1

    def check(self, tolerance: float, share: float = 1.0, cubic: bool = False) -> None:
        """Raise `TooFewStations` where the error is above that share of the tolerance.

        The error is `error`, or `cubic_error` for a file of cubics.
        """
        error, needed = self.cubic_error if cubic else self.error, share * tolerance
        if error > needed * (1 + 1e-9):
            more = max(self.stations_for(needed, cubic), self.s.size + 1)
            raise TooFewStations(
                f"{self.s.size} stations fix the rod between them to {error:.1e} {self.unit} only, and "
                f"{needed:.1e} {self.unit} is needed for a tolerance of {tolerance:g} {self.unit}: "
                f"{advice_to_store(more)}, or give a larger --tolerance",
                more,
            )


# quantities along a rod that a curve gives at any s
ALONG: Mapping[str, Callable[[Centreline, Array], Array]] = {
    "alpha": lambda line, s: line.at(s)[0],
    "beta": lambda line, s: line.at(s)[1],
    "z": lambda line, s: line.at(s)[2],
    "kappa": lambda line, s: line.kappa(s),
    "contact": lambda line, s: line.contact(s),
    "push": lambda line, s: line.push(s),
}


def spline(s: Array, values: Array) -> Any:
    """The spline through values at the stations, (n,)."""
    return make_interp_spline(s, values, k=min(DEGREE, s.size - 1))


def spline_error(s: Array, values: Array) -> float:
    """The estimated error between stations of the spline through values there, (n,); as of `Centreline.value_error`."""
    kept = _every_other(s.size)
    return float(np.abs(spline(s[kept], values[kept])(s[1::2]) - values[1::2]).max()) / EASED


def cut(s: Array, parts: int) -> Array:
    """The stations, and between each two of them evenly as many as cut the way in so many parts."""
    return np.interp(np.arange(parts * (s.size - 1) + 1) / parts, np.arange(s.size), s)


def _every_other(n: int) -> NDArray[np.int64]:
    """The indices of every other station and the last one."""
    return np.union1d(np.arange(0, n, 2), n - 1)


def advice_to_store(stations: int) -> str:
    """How one has so many stations stored, as advice."""
    if stations > MAX_STATIONS:
        return f"about {stations} are needed, and a study stores at most {MAX_STATIONS}; study a shorter rod"
    return (
        f"store about {stations} (stations = {stations}; workbench run takes --stations {stations}, also for the .toml "
        "of solve --out)"
    )


def through(s: Array, known: Array) -> Any:
    """The piecewise polynomial with the derivatives `known`, (n, k, ...), at s, (n,): all its pieces at once.

    SciPy's `BPoly.from_derivatives` makes one piece after the other, in seconds for a hundred thousand. Here its
    polynomials on a piece of length 1, one for each derivative, are scaled and summed for every piece.
    """
    k = known.shape[1]
    unit = BPoly.from_derivatives([0.0, 1.0], np.eye(2 * k).reshape(2, k, 2 * k)).c[:, 0]
    h = np.diff(s).reshape(-1, 1, *[1] * (known.ndim - 2)) ** np.arange(k).reshape(k, *[1] * (known.ndim - 2))
    ends = np.concatenate([known[:-1] * h, known[1:] * h], axis=1)
    return BPoly(np.tensordot(unit, ends, axes=(1, 1)), s)


def slopes(s: Array, beta: Array, rho: float, l: float, m: float, p: float) -> Array:
    """beta' at the stations from beta there and beta'' = -H(beta) between them, (n,).

    On each interval beta' at its two ends follows from the two angles and the integral of beta''; the two values at a
    common station of neighbouring intervals are averaged. Where the stations are too far apart for that, the size of
    beta' follows from beta'^2 + G(beta) = max G over the stations, to which the turning points come near.
    """
    if _phase_step(s, beta, rho, l, m, p) > APART:
        G = potential(Loads(l * rho, m * rho, p * rho**2), beta) / rho**2
        return np.sqrt(G.max() - G)
    h = np.diff(s)
    bend = -dimensional_slope(l, m, p, rho, beta)
    dbeta = np.gradient(beta, s)
    for _ in range(ROUNDS):
        angle = through(s, np.stack([beta, dbeta, bend], axis=-1))
        inside = -dimensional_slope(l, m, p, rho, angle(s[:-1, None] + h[:, None] * GAUSS))
        chord = np.diff(beta) / h
        leaving = chord - h * (inside @ (WEIGHT * (1 - GAUSS)))
        arriving = chord + h * (inside @ (WEIGHT * GAUSS))
        dbeta = np.concatenate([leaving[:1], (leaving[1:] + arriving[:-1]) / 2, arriving[-1:]])
    return dbeta


def _phase_step(s: Array, beta: Array, rho: float, l: float, m: float, p: float) -> float:
    """The largest step of s times the largest frequency sqrt|H'| at the angles between the least and the largest."""
    angle = np.linspace(beta.min(), beta.max() + 1e-3, 361)
    rate = np.gradient(dimensional_slope(l, m, p, rho, angle), angle)
    return float(np.diff(s).max() * np.sqrt(np.abs(rate).max()))
