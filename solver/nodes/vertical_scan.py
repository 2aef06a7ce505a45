"""Every equilibrium of a vertical rod with weight, and of any rod without weight whose loads are given and an end of
which is hinged, by a scan of the one number of its start that is not given.

The weight along the cylinder's axis changes neither the moment about that axis nor the torque, so that all loads are
known along a rod whose loads are given at the far end, and only beta_t(0), or beta(0) at a hinge, is unknown. As
|beta_tt| has a bound, so has that number.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from ..core.weight_friction import march
from ..numerics.arrays import EPS, FAINT, Array, whole_turns
from ..numerics.roots import roots_between, sign_changes
from ..orbits.boundary import boundary_of
from ..orbits.periodic_orbit import solve_orbit
from ..orbits.potential import TAU, Loads, load_size, potential
from ..problem.dimensionless import EndsProblem, StartProblem
from .constant_loads import states_under
from .loaded_rod import ALPHA, BETA, MU, PHI, SPEED, LoadedRod, Q

FIRST, MOST = 1001, 200_000  # starts of the scan. x10: 5.7 times the time, and the same list
# of the far end, between starts: see `_rough`. x10: changes of more than a turn between neighbours, whose roots are
# missed
STEP, BENT, LEAST, NEAR = 0.5, 0.05, 1e-3, 0.1
# distances from the starts whose orbits reach a saddle: two a decade, from rounding on. x10: those within 1e-12 are not
# scanned
CLOSER = np.logspace(-13, -2, 23)


def has_one_unknown(rod: LoadedRod) -> bool:
    """Whether only one number of the start is not given."""
    return rod.across == 0 and not rod.has_friction and not rod.held & {"azimuth", "height", "rotation"}


def start_range(rod: LoadedRod) -> tuple[float, float]:
    """The range in which beta_t(0) lies; a turn where a hinge leaves beta(0) open, as all is periodic in it."""
    phi = np.abs(rod.far[2] - rod.along * np.array([0.0, rod.span])).max()
    bend = float(load_size(Loads(rod.far[1], rod.far[3], phi))) + 1  # bound of |beta_tt|
    if "beta0" not in rod.held:
        return -np.pi, np.pi
    middle, reach = rod.far[0], bend * rod.span
    if "betaL" in rod.held:
        middle, reach = (rod.far[0] - rod.near[0]) / rod.span, reach / 2
    # beta_t is the middle somewhere, and its square changes by 8 |beta_tt| at most, as beta_t^2 + G by weight alone
    reach = min(reach, abs(middle) + np.sqrt(middle**2 + 8 * bend))
    # somewhat wider on one side: the middle, a start that symmetry may single out, is none of the scan
    return float(middle - 1.01 * reach), float(middle + 1.0173 * reach)


def begin_at(rod: LoadedRod, first: Array, q: Array | float) -> Array:
    """States (N, 8) at the start. first: beta_t(0), or beta(0) at a hinge. q: q(0)."""
    y = np.zeros((first.size, rod.scale.size))
    y[:, BETA], y[:, SPEED] = (rod.near[0], first) if "beta0" in rod.held else (first, rod.near[0])
    y[:, ALPHA], y[:, Q], y[:, MU] = rod.near[1], q, rod.far[3]
    y[:, PHI] = rod.far[2] - rod.along * rod.span
    return y


def states_from(rod: LoadedRod, begin: Array, t: Array) -> Array:
    """The states (N, n, 8) at rising times t (n,) of rods that begin with states (N, 8); without weight by their
    orbits, which lose no more digits from period to period."""
    rods, n = len(begin), t.size
    if rod.along or rod.across:
        first, stations = n * np.arange(rods + 1), np.tile(t, rods)
        read = march(rod.numbers, rod.scale, begin, np.full(rods, rod.span), first=first, stations=stations)
        return read.out.reshape(rods, n, rod.scale.size)
    beta, speed, q, mu, phi = begin[:, [BETA, SPEED, Q, MU, PHI]].T
    orbit = solve_orbit(StartProblem(q + mu, mu, phi, np.full(rods, rod.span), beta, speed), FAINT)
    t = np.tile(t, (rods, 1))
    return states_under(rod, t, (q + mu, mu, phi), (*orbit.at(t), orbit.swirl(t)))


def every_start(rod: LoadedRod) -> tuple[Array, bool]:
    """The states (N, 8) at the start from which the far end meets what it is given, and whether they are all.

    They are all where between neighbours of the scan the far end moves nearly in proportion.
    """
    q = rod.far[1] - rod.far[3]
    turning = "beta0" not in rod.held and "betaL" in rod.held  # each whole turn that the far end is off is a root

    def off(first: Array) -> Array:
        end = states_from(rod, begin_at(rod, first, q), np.array([rod.span]))[:, 0]
        if "betaL" in rod.held:
            return np.asarray(end[:, BETA] - rod.far[0])
        return np.asarray((end[:, SPEED] - rod.far[0]) * rod.time)

    def size(value: Array) -> Array:
        return 2 * np.sin(value / 2) if turning else value

    even, beside = np.linspace(*start_range(rod), FIRST), _beside_saddles(rod)
    x = np.unique(np.concatenate([even, beside[(beside > even[0]) & (beside < even[-1])]]))
    x, resolved = _resolve(off, size, x)
    roots = np.concatenate(roots_between(lambda first: size(off(first)), x))
    if "beta0" not in rod.held:
        roots = roots[roots < np.pi * (1 - 1e-12)]
    if turning:
        roots -= whole_turns(off(roots))
    return begin_at(rod, roots, q), resolved


def _beside_saddles(rod: LoadedRod) -> Array:
    """Starts of a rod without weight beside those whose orbits reach a saddle, where the far end moves fast, (n,)."""
    if rod.along:
        return np.empty(0)
    given = {"lam": rod.far[1], "mu": rod.far[3], "phi": rod.far[2], "beta0": 0.0, "betaL": 0.0, "span": rod.span}
    problem = EndsProblem(**{name: np.array([value]) for name, value in given.items()})
    saddles = boundary_of(problem).saddles
    heights = potential(problem, saddles)
    if "beta0" in rod.held:
        square = heights - potential(problem, rod.near[:1])
        speeds = np.sqrt(square[square >= 0])
        special = [speeds, -speeds]
    else:
        even, special = np.linspace(-np.pi, np.pi, FIRST), [saddles]
        for height in heights - rod.near[0] ** 2:
            above = partial(lambda height, angle: potential(problem, angle) - height, height)
            special.append(sign_changes(above, even, above(even)))
    near = np.concatenate(special)[:, None] + np.concatenate([-CLOSER, CLOSER])
    return near.ravel() if "beta0" in rod.held else (near.ravel() + np.pi) % TAU - np.pi


def _resolve(read: Callable[[Array], Array], size: Callable[[Array], Array], x: Array) -> tuple[Array, bool]:
    """Rising places and more of them between, and whether no interval is left too wide.

    size: how far from a root a number is, with a sign.
    """
    value = read(x)
    while True:
        rough = _rough(x, value, np.abs(size(value)))
        wide = rough & (np.diff(x) > 8 * EPS * np.maximum(np.abs(x[1:]), np.abs(x[:-1])))
        if not wide.any() or x.size + wide.sum() > MOST:
            return x, not rough.any()
        middle = (x[:-1] + np.diff(x) / 2)[wide]
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
