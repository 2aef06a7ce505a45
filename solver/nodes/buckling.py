"""Where a straight rod buckles, and the stable shape into which it does."""

from collections.abc import Iterator
from itertools import product

import numpy as np

from ..numerics.arrays import ALIKE, FAINT, NEGLIGIBLE, Array
from ..numerics.roots import halve
from .descent import descend
from .loaded_rod import LoadedRod
from .node_branch import SPLIT, NodeCurve
from .shape_index import index_at
from .varying_shapes import Shape
from .weak_modes import weakest_modes

# of the loads: how far beyond its end the stable shape is sought to which a rod jumps. x10: as good for the problems
# that jump
AHEAD = 0.01


def straight_shape(rod: LoadedRod, t: Array) -> Shape:
    """The straight rod along the axis."""
    return Shape(rod, t, rod.straight_states(t))


def rod_without_friction(rod: LoadedRod) -> LoadedRod:
    """The rod without friction whose straight shape is under the same axial force.

    What friction adds to that force varies along a straight rod as the weight does. A straight rod that moves along
    itself feels a force across as well, of the size of f rho times the rate of the azimuth, which is left out.
    """
    even = rod.with_friction(0.0)
    if not rod.rotates:
        even.numbers[1] -= rod.numbers[3] * rod.numbers[6] * rod.across * np.cos(rod.near[1])
    return even


def rod_without_lean(rod: LoadedRod) -> LoadedRod:
    """The straight rod without friction that buckles under the load under which one that turns in place does.

    A rod on its wall leans by the angle m = -arctan(f), and a bend about that feels the weight cos(m) - f sin(m) =
    (1 + f^2)^(1/2) across. Ends that hold another azimuth than m are left out.
    """
    return rod.times(np.hypot(1.0, rod.numbers[3]), [2]).with_friction(0.0)


def straight_index(rod: LoadedRod) -> int:
    """The Morse index of the straight rod under its axial force, with what friction adds to it."""
    even = rod_without_friction(rod)
    return index_of_straight(even, even.nodes())


def index_of_straight(rod: LoadedRod, t: Array) -> int:
    """The Morse index of the straight rod without friction: 0 of one that is sure to be stable, else that on nodes t.

    Rounding on the nodes of a rod of 10^5 radii is as large as what is left of its stiffness near its buckling load.
    """
    return 0 if _is_stable(rod) else index_at(straight_shape(rod, t))


def _is_stable(rod: LoadedRod) -> bool:
    """Whether the compression is nowhere above 2 (w across)^(1/2) of Dawson and Paslay, without torque.

    With a for the azimuth, the energy of a''^2 - P a'^2 + k a^2 is then at least that of (a'' + k^(1/2) a)^2, as a a'
    is 0 at both ends: the azimuth is given at the start, and at the far end a clamp or the azimuth.
    """
    if rod.far[1] or rod.far[3] or "height" in rod.held or not {"betaL", "azimuth"} & rod.held:
        return False
    stiffness, least = rod.across * np.cos(rod.near[1]), rod.tension_known - max(0.0, rod.along * rod.span)
    return bool(stiffness >= 0 and least >= -2 * np.sqrt(stiffness))


def shares_of_buckling(rod: LoadedRod, t: Array) -> Iterator[tuple[float, int]]:
    """The shares of the loads just above which the index of the straight rod rises, the lowest first, and by how much.

    It rises by more than one where modes buckle at one load to rounding, and at 0 where the rod is unstable without
    loads. Below `NEGLIGIBLE` the index is that of rounding, and no share is given.
    """

    def index(share: float) -> int:
        return index_of_straight(rod.share(share), t)

    unloaded = index(0.0)
    parts = [(0.0, unloaded, 1.0, index(1.0)), (0.0, 0, 0.0, unloaded)]
    while parts:
        low, below, high, above = parts.pop()
        if above <= below:
            continue
        # a rod that buckles under less than NEGLIGIBLE, as between hinges on a cylinder, buckles under any load
        if high - low <= (ALIKE if above == below + 1 else FAINT) * high or 0 < high <= NEGLIGIBLE:
            yield high, above - below
            continue
        middle = (low + high) / 2
        now = index(middle)
        parts += [(middle, now, high, above), (low, below, middle, now)]


def tension_of_buckling(rod: LoadedRod) -> float | None:
    """The far end's phi below which the straight rod under its whole weight is unstable, without friction.

    None where the straight rod is no equilibrium, or is unstable though all of it is in tension.
    """
    rod = rod.with_friction(0.0).with_tension(0.0)

    def is_stable(phi: float) -> bool:
        pulled = rod.with_tension(phi)
        return index_of_straight(pulled, pulled.nodes()) == 0

    high = max(0.0, rod.along * rod.span)  # here no part of the rod is compressed
    if not rod.straight or not is_stable(high):
        return None
    low = high - 1 / rod.span**2
    while is_stable(low):
        low = high + 4 * (low - high)
    return sum(halve(is_stable, low, high, ALIKE * max(abs(high), abs(low)) / 4)) / 2


def buckle(rod: LoadedRod, t: Array, critical: float) -> tuple[Shape, float] | None:
    """A stable shape into which the straight rod buckles at a share of its loads, and its own share; None without one.

    The amplitude of the weakest mode is given and the share unknown: so the way leads round no straight rod. Where the
    branch turns to smaller loads it is the stable shape below the straight rod.
    """
    begin = straight_shape(rod.share(critical), t)
    modes = weakest_modes(begin, 2)
    curve = NodeCurve(rod.share, 1.0, begin.rod.scale)
    for amplitude, mode in product(SPLIT * 4.0 ** -np.arange(6), modes):
        point = next(curve.split_off(begin, mode, (amplitude,), critical), None)
        if point is None or point.p > 1:
            continue
        if point.p < critical:
            break
        if point.index == 0:
            return point.shape, point.p
    share = min(1.0, critical * (1 + AHEAD))
    below = descend(straight_shape(rod.share(share), t), modes[0])
    return None if below is None else (below, share)
