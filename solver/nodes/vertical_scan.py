"""Every equilibrium of a vertical rod with weight, by a scan of the one number of its start that is not given.

The weight along the cylinder's axis changes neither the moment about that axis nor the torque, so that all loads are
known along a rod whose loads are given at the far end, and only beta_t(0), or beta(0) at a hinge, is unknown. As
|beta_tt| has a bound, so has that number.
"""

from collections.abc import Callable

import numpy as np

from ..core.weight_friction import march
from ..numerics.arrays import Array
from ..numerics.roots import roots_between
from ..orbits.potential import TAU, Loads, load_size
from .loaded_rod import ALPHA, BETA, MU, PHI, SPEED, LoadedRod, Q

FIRST, MOST = 1001, 200_000  # starts of the scan. x10: 5.7 times the time, and the same list
# of the far end, between starts: see `_rough`. x10: changes of more than a turn between neighbours, whose roots are
# missed
STEP, BENT, LEAST, NEAR = 0.5, 0.05, 1e-3, 0.1


def has_one_unknown(rod: LoadedRod) -> bool:
    """Whether only one number of the start is not given."""
    return rod.across == 0 and not rod.has_friction and not rod.held & {"azimuth", "height", "rotation"}


def start_range(rod: LoadedRod) -> tuple[float, float]:
    """The range in which beta_t(0) lies; a turn where a hinge leaves beta(0) open, as all is periodic in it."""
    phi = np.abs(rod.far[2] - rod.along * np.array([0.0, rod.span])).max()
    bend = float(load_size(Loads(rod.far[1], rod.far[3], phi))) + 1  # bound of |beta_tt|
    if "beta0" in rod.held and "betaL" in rod.held:
        return _about((rod.far[0] - rod.near[0]) / rod.span, bend * rod.span / 2)
    if "beta0" in rod.held:
        return _about(rod.far[0], bend * rod.span)
    return -np.pi, np.pi


def _about(middle: float, reach: float) -> tuple[float, float]:
    """A range, somewhat wider on one side: its middle, a start that symmetry may single out, is none of the scan."""
    return float(middle - 1.01 * reach), float(middle + 1.0173 * reach)


def begin_at(rod: LoadedRod, first: Array, q: Array | float) -> Array:
    """States (N, 8) at the start. first: beta_t(0), or beta(0) at a hinge. q: q(0)."""
    y = np.zeros((first.size, rod.scale.size))
    y[:, BETA], y[:, SPEED] = (rod.near[0], first) if "beta0" in rod.held else (first, rod.near[0])
    y[:, ALPHA], y[:, Q], y[:, MU] = rod.near[1], q, rod.far[3]
    y[:, PHI] = rod.far[2] - rod.along * rod.span
    return y


def every_start(rod: LoadedRod) -> tuple[Array, bool]:
    """The states (N, 8) at the start from which the far end meets what it is given, and whether they are all.

    They are all where between neighbours of the scan the far end moves nearly in proportion.
    """
    q = rod.far[1] - rod.far[3]
    turning = "beta0" not in rod.held and "betaL" in rod.held  # each whole turn that the far end is off is a root

    def off(first: Array) -> Array:
        end = march(rod.numbers, rod.scale, begin_at(rod, first, q), np.full(first.size, rod.span)).end
        if "betaL" in rod.held:
            return np.asarray(end[:, BETA] - rod.far[0])
        return np.asarray((end[:, SPEED] - rod.far[0]) * rod.time)

    def size(value: Array) -> Array:
        return 2 * np.sin(value / 2) if turning else value

    x, resolved = _resolve(off, size, *start_range(rod))
    roots = np.concatenate(roots_between(lambda first: size(off(first)), x))
    if "beta0" not in rod.held:
        roots = roots[roots < np.pi * (1 - 1e-12)]
    if turning:
        roots -= TAU * np.round(off(roots) / TAU)
    return begin_at(rod, roots, q), resolved


def _resolve(
    read: Callable[[Array], Array], size: Callable[[Array], Array], low: float, high: float
) -> tuple[Array, bool]:
    """Places from low to high, and whether no interval is left too wide.

    size: how far from a root a number is, with a sign.
    """
    x = np.linspace(low, high, FIRST)
    value = read(x)
    while True:
        rough = _rough(x, value, np.abs(size(value)))
        fine = np.diff(x) > 8 * np.finfo(float).eps * np.maximum(np.abs(x[1:]), np.abs(x[:-1]))
        if not rough.any() or x.size + rough.sum() > MOST or not fine[rough].all():
            return x, not rough.any()
        middle = (x[:-1] + np.diff(x) / 2)[rough]
        x, place = np.concatenate([x, middle]), np.concatenate([value, read(middle)])
        order = np.argsort(x)
        x, value = x[order], place[order]


def _rough(x: Array, value: Array, size: Array) -> Array:
    """Which intervals are too wide, (n - 1,).

    The number may change by `STEP` across one. Each number may lie off the line through its neighbours by `BENT`, and
    near a root by a share `NEAR` of the size, or `LEAST`. size: how far from a root each number is.
    """
    share = (x[1:-1] - x[:-2]) / (x[2:] - x[:-2])
    off = np.abs(value[1:-1] - (value[:-2] + share * (value[2:] - value[:-2])))
    least = np.minimum(np.minimum(size[:-2], size[2:]), size[1:-1])
    bent = ~(off <= np.clip(NEAR * least, LEAST, BENT))
    rough = ~(np.abs(np.diff(value)) <= STEP)
    rough[:-1] |= bent
    rough[1:] |= bent
    return np.asarray(rough)
