"""The start of a taut rod: at each place the angle at which its loads alone are in balance, bent to what its ends hold.

Where the tension is large against bending, beta'' = -H(beta) leaves H = 0 but for layers at the ends, in which
tan((beta - b)/4) falls like exp(-k t), with b the angle in balance and k^2 = -H'(b). Friction changes the loads along
the rod (on a drum the capstan). A hoop without axial force is such a rod to the last digit.
"""

from itertools import pairwise

import numpy as np

from ..numerics.arrays import NEGLIGIBLE, Array, integral
from ..numerics.roots import REACH, ROUNDS
from ..orbits.potential import Loads, slope, slope_rate
from ..problem.case import ALONG_AXIS, ALONG_ITSELF
from .banded_newton import correct
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q, rate_of_change
from .varying_shapes import Shape

# on which the loads are summed, and the parts of the rod in which they are. x10: only time; parts so short that their
# errors add up
PLACES, PARTS = 4000, 50
# the most by which a change may grow between two nodes, as a power of e: at 8 Newton's method is lost. x10: it is lost
STEEP = 4.0
MOST = 100_000  # nodes: a few seconds. x10: half a minute, and its memory


def taut_shape(rod: LoadedRod) -> Shape | str | None:
    """The equilibrium of a rod without weight that is taut all along, or why it is not computed.

    None of another rod, and of one whose loads are not given.
    """
    if rod.along or rod.across or rod.held & {"azimuth", "height", "rotation"}:
        return None
    t = np.linspace(0, rod.span, PLACES + 1)
    y = balance(rod, t)
    if y is None:
        return None
    start = with_layers(rod, t, y)
    return start if isinstance(start, str) else correct(start)


def loads_of(y: Array) -> Loads:
    """The loads in states (n, 8)."""
    return Loads(y[:, Q] + y[:, MU], y[:, MU], y[:, PHI])


def balance(rod: LoadedRod, t: Array) -> Array | None:
    """The states (n, 8) at places t in which the loads are in balance without bending; None where a place is not taut.

    Friction changes the loads from the far end on.
    """
    y = np.zeros((t.size, rod.scale.size))
    y[-1, [Q, PHI, MU]] = rod.far[1] - rod.far[3], rod.far[2], rod.far[3]
    y[-1, BETA] = np.arctan2(rod.far[1], rod.far[2])
    for last, first in pairwise(np.linspace(0, t.size - 1, PARTS + 1).astype(int)[::-1]):
        part = balance_part(rod, t[first : last + 1], y[last])
        if part is None:
            return None
        y[first : last + 1] = part
    return y


def balance_part(rod: LoadedRod, t: Array, last: Array) -> Array | None:
    """The states in balance on a part of the rod, from that at its last place (8,), whose loads are right."""
    y = np.tile(last, (t.size, 1))
    for _ in range(ROUNDS):
        before, loads = y.copy(), loads_of(y)
        stiffness = -slope_rate(loads, y[:, BETA])
        if not (stiffness > 0).all():
            return None
        y[:, BETA] += np.clip(slope(loads, y[:, BETA]) / stiffness, -REACH, REACH)
        for column, rate in zip((Q, PHI, MU), rates(rod, y), strict=True):
            grown = integral(rate, t)
            y[:, column] = last[column] - (grown[-1] - grown)
        if np.abs(y - before).max() <= NEGLIGIBLE * (1 + np.abs(y[:, [Q, PHI]]).max()):
            return y
    return None


def rates(rod: LoadedRod, y: Array) -> tuple[Array, Array, Array]:
    """The rates of q, phi and mu by friction in states (n, 8) without bending, (n,) each."""
    friction, way, a, outward = rod.numbers[3:]
    rubbed, sin, cos = friction * Shape(rod, y[:, 0], y).pushes(y), np.sin(y[:, BETA]), np.cos(y[:, BETA])
    along = {ALONG_ITSELF: cos, ALONG_AXIS: np.ones_like(cos)}.get(way, outward * sin)
    across = {ALONG_ITSELF: sin, ALONG_AXIS: np.zeros_like(sin)}.get(way, (a - outward) * cos)
    twist = rubbed * a * rod.rotates
    return rubbed * across - twist, rubbed * along, twist


def with_layers(rod: LoadedRod, t: Array, y: Array) -> Shape | str:
    """The shape on nodes from states in balance at places t, with layers at ends that hold another angle.

    About one node stands on each length on which the local loads change the shape, and more where a change would grow
    too far between two. Where they are too many, a sentence that says so.
    """
    stiffness = -slope_rate(loads_of(y), y[:, BETA])
    rate = rate_of_change(y[:, PHI], 0.0, 0.0, y[:, MU], y[:, Q], rod.span)
    passed = integral(np.maximum(rate, np.sqrt(stiffness) / STEEP), t)
    if not passed[-1] < MOST:
        may = f"the shape of this taut rod may change {passed[-1]:.3g} times along it"
        return f"{may}, and at most {MOST:,} changes are computed"
    nodes = np.interp(np.linspace(0, passed[-1], max(4, int(np.ceil(passed[-1]))) + 1), passed, t)
    states = np.stack([np.interp(nodes, t, column) for column in y.T], axis=1)
    for name, angle, end, away in (("beta0", rod.near[0], 0, nodes), ("betaL", rod.far[0], -1, rod.span - nodes)):
        if name in rod.held:
            k, size = np.sqrt(stiffness[end]), np.tan((angle - y[end, BETA]) / 4)
            bent = 4 * np.arctan(size * np.exp(-k * away))
            states[:, BETA] += bent
            states[:, SPEED] += (2 if end else -2) * k * np.sin(bent / 2)
    sin, cos = np.sin(states[:, BETA]), np.cos(states[:, BETA])
    states[:, ALPHA] = rod.near[1] + integral(sin, nodes)
    states[:, SHORT] = integral(1 - cos, nodes)
    states[:, ROUND] = integral(rod.numbers[0] * states[:, MU] + sin * (1 - cos), nodes)
    return Shape(rod, nodes, states)
