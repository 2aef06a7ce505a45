"""The ranges of the unknown loads and end angles over which equilibria with held ends are searched for."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from ..equilibrium.given_numbers import FREE, Given
from ..mechanics.potential import TAU
from ..numerics.arrays import Array

HALF_WAVES = 4  # of a straight rod: pushed as hard as it needs to buckle into so many, or pulled as hard
_SURFACE = 2.0  # bound of what the cylinder's curvature adds to a load
_SAFE = 4.0  # times the load that holds a nearly straight rod
_HARDEST = 1e6
VALUES = {1: 61, 2: 13, 3: 6, 4: 4, 5: 3}  # of each of so many unknowns


@dataclass(frozen=True)
class Ranges:
    """The lowest and the highest value of each unknown number, by its name, and how many values of each are taken.

    root: of the load under which a straight rod buckles into `HALF_WAVES`.
    """

    bounds: dict[str, tuple[float, float]]
    count: int
    root: float

    def holds(self, values: dict[str, float]) -> bool:
        """Whether numbers lie within."""
        return all(low - 1e-9 <= values[name] <= high + 1e-9 for name, (low, high) in self.bounds.items())

    def axes(self) -> dict[str, Array]:
        """The values of each; of a force or MZ by its root, as half waves go with it.

        The steps of the root are equal up to `root`, and grow in proportion to it beyond: a slender rod on a cylinder
        buckles at loads far below those that the cylinder's curvature adds.
        """
        rooted = {name: self.root if name in ("phi", "lam") else None for name in self.bounds}
        return {name: _steps(*ends, self.count, rooted[name]) for name, ends in self.bounds.items()}

    def points(self) -> list[dict[str, float]]:
        """All combinations of the values."""
        axes = self.axes()
        return [dict(zip(axes, values, strict=True)) for values in product(*(axis.tolist() for axis in axes.values()))]


def ranges_of(given: Given, own: dict[str, tuple[float, float]], count: int | None) -> Ranges:
    """The ranges of the unknown numbers of a problem, those of `own` as they are there, with `count` values of each."""
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    bounds = {name: own.get(name) or _default(name, known, given) for name in FREE if name not in known}
    return Ranges(bounds, VALUES[len(bounds)] if count is None else count, HALF_WAVES * np.pi / given.span)


def _default(name: str, known: dict[str, float], given: Given) -> tuple[float, float]:
    span = given.span
    if name in ("beta0", "betaL"):
        other = known.get("betaL" if name == "beta0" else "beta0", 0.0)
        return other - np.pi, other + np.pi
    if name == "mu":  # turn = ratio mu span - swirl, and |swirl| is at most span/2
        low, high = ((known["turn"] + sign * span / 2) / (given.ratio * span) for sign in (-1, 1))
        return low, high
    dead = sum(abs(known.get(load, 0.0)) for load in ("phi", "lam", "mu"))
    waves = (HALF_WAVES * np.pi / span) ** 2
    most = float(min(waves + _SURFACE + dead + _straightening(name, known, span), _HARDEST))
    return -most, most


def _straightening(load: str, known: dict[str, float], span: float) -> float:
    """The load that pulls a clamped rod to its held height or azimuth.

    Each end falls 2 (1 - cos(b/2))/sqrt(load) short, b being its angle from the pull.
    """
    held = known["z" if load == "phi" else "alpha"]
    pull = {"phi": 0.0, "lam": np.pi / 2}[load] if held >= 0 else {"phi": np.pi, "lam": -np.pi / 2}[load]
    short = sum(2 * (1 - abs(np.cos((known[name] - pull) / 2))) for name in ("beta0", "betaL") if name in known)
    slack = span - abs(held)
    return float(_SAFE * (short / slack) ** 2) if slack > 1e-9 * span else 0.0


def _steps(low: float, high: float, count: int, root: float | None) -> Array:
    if root is None:
        return np.linspace(low, high, count)
    first, last = (float(np.arcsinh(np.sign(end) * np.sqrt(abs(end)) / root)) for end in (low, high))
    roots = root * np.sinh(np.linspace(first, last, count))
    steps = np.sign(roots) * roots * roots
    steps[[0, -1]] = low, high
    return np.asarray(steps)


def within_a_turn(beta: float) -> float:
    """The whole turns to add to an angle that lead it to [-pi, pi)."""
    return -TAU * float(np.floor((beta + np.pi) / TAU))
