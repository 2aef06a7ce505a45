"""The waves of a long lying rod inside a cylinder: a sinusoid or a helix that follows the local compression.

Of a slender rod, with F the compression in units of sqrt(A w sin(theta)/rho), x in (A rho/(w sin(theta)))^(1/4), and
the mean over a wave in brackets: the energy e = <alpha''^2 + alpha'^4 - F alpha'^2>/2 + <1 - cos(alpha)> of a sinusoid
is least over the harmonics of alpha and over the wave number k.
A helix has the wave number k = (F/2)^(1/2) and the energy (k^4 - F k^2)/2 + 1.
Friction f per push P pulls the phase of a wave:  d/dx (de/dk) = -f c,  with c = <P alpha'^2 + <P> alpha'^2>/(2k) of a
rod that slides along itself and <<P> alpha'^2 - P alpha'^2>/(2k) of one that moves along the axis.
A rod that turns in place leans: the wall drives it up by f P, against the weight. A sinusoid alpha = m + d leans by
sin(m) <cos(d)> + f <P> = 0; its P falls by f sin(m) d as well, so that d feels the weight cos(m) - f sin(m).
"""

from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import NEGLIGIBLE, Array, Booleans, integral, whole_turns
from ..numerics.roots import root
from ..problem.case import ALONG_ITSELF
from .banded_newton import correct
from .descent import descend
from .loaded_rod import ALPHA, BETA, PHI, SHORT, SPEED, LoadedRod, Q
from .shape_index import index_of_any
from .varying_shapes import Shape

# F - 2, of the rows of a table of sinusoids: up to the fold, closer where they begin. x10: none of these is a sinusoid;
# pipes have no shape to start from
OVER = (1e-3, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4, 2.8, 3.2)
# at which a period of five harmonics is averaged, exactly. x10: only time
PHASES = np.linspace(0, 2 * np.pi, 64, endpoint=False)
EQUAL, LIFTED, LAST = 0.901122, 1.541672, 3.2613  # F - 2: from which a helix has less energy than the sinusoid, from
# which the sinusoid lifts off the wall, and of its fold

# F - 2: where a helix may become a sinusoid, tried in this order. x10: places where neither is near
FRONTS = EQUAL + np.array([0.0, 0.05, -0.05, -0.1])
HELIX = 4 / (3 * np.sqrt(3))  # the largest compression of a helix: beyond, -phi = 2 cos(beta) sin(beta)^2 has no root
LIGHTEST = 1e-30  # weight across, in units of A and rho, that makes waves: its fourth root is a float. x10: as good
# of F: how softly the amplitude comes to 0. x10: waves where the rod is straight; Newton's method still mends it
SOFT = 0.03
# places for a node, so that each wave has dozens; of the square of the amplitude. x10: 1.5 times the time; waves of a
# rod that drags itself along are too high
FINE, LEAST = 12, 0.1
# of F - 2: the last change of that in which a rod leans; below, a turn at an end dies away. x10: a lean that has not
# settled; ends wound for nothing
LEANT, QUIET = 0.1, -0.06
ROUNDS = 100  # of the compression under friction, each a digit nearer. x10: 1.6 times the time
# nodes of a rod with friction, of which one front is tried: each that fails takes seconds. x10: tens of seconds
MANY = 1000
STEPS, NODES = 30, 50  # of Newton's method from it, and one more for so many nodes. x10: only failures take longer
STEEPEST = 0.9  # sine of beta, so that its arc sine and slope are finite. x10: beta is not limited
# least, of a helix: a shorter one is a bend. x10: helices of less than 20 turns are found otherwise, or not
TURNS = 2.0
BLUR = 1.0  # of x: from where a helix becomes a sinusoid. x10: 1.6 times the time


class _WaveRow(NamedTuple):
    """Of the sinusoid at F: its wave number, what its energy and its push say, as smooth functions of F.

    size, third: a/(F - 2)^(1/2) and a3/a^3 of the first and third harmonics a, a3. stiffness: d2e/dk2/(F - 2). push:
    <P>. itself, axis: what friction takes from the phase, over F - 2 of a rod that slides along itself and over
    (F - 2)^2 of one that moves along the axis, as of `local_waves`.
    """

    k: float
    size: float
    third: float
    stiffness: float
    push: float
    itself: float
    axis: float


def row(over: float, sizes: Array, k: float) -> tuple[_WaveRow, Array]:
    """The sinusoid at F - 2, and the sizes (3,) of its harmonics, from those and a wave number near it."""
    F, n = 2 + over, np.array([[1.0], [3.0], [5.0]])  # harmonics
    waves = np.stack([np.sin(n * PHASES), n * np.cos(n * PHASES), -n * n * np.sin(n * PHASES)])

    def slopes(x: Array) -> Array:
        """The derivatives of the energy by the sizes and by k, (4,)."""
        (alpha, a, b), k = x[:3] @ waves, x[3]
        by_size = k**4 * b * waves[2] + (2 * k**4 * a**3 - F * k**2 * a) * waves[1] + np.sin(alpha) * waves[0]
        return np.append(by_size.mean(axis=1), (2 * k**3 * (b**2 + a**4) - F * k * a**2).mean())

    def bends(x: Array) -> Array:
        """The derivatives of the slopes, (4, 4), exact: the imaginary part carries a change too small to be felt."""
        return np.array([slopes(x + 1e-30j * unit).imag / 1e-30 for unit in np.eye(4)])

    x = root(lambda x: (slopes(x), bends(x)), np.append(sizes, k), np.inf, STEPS)
    assert x is not None
    (alpha, a, b), sizes, k = x[:3] @ waves, x[:3], float(x[3])
    stiffness = float(1 / np.linalg.inv(bends(x))[3, 3])
    square, P = (k * a) ** 2, np.cos(alpha) + k**4 * (4 * a * (sizes @ (-(n**2) * waves[1])) + 3 * b**2 - a**4)
    P += F * square
    by_square, by_means = np.mean(P * square) / (2 * k), np.mean(P) * np.mean(square) / (2 * k)
    scaled = sizes[0] / np.sqrt(over), sizes[1] / sizes[0] ** 3, stiffness / over
    return _WaveRow(k, *scaled, P.mean(), (by_square + by_means) / over, (by_means - by_square) / over**2), sizes


def rows() -> list[_WaveRow]:
    """The rows of the table of sinusoids."""
    k, sizes, table, last = 1.0, np.sqrt([8 / 11, 0.0, 0.0]), [], 1.0
    for over in OVER:
        entry, sizes = row(over, sizes * np.sqrt(over / last), k)
        k, last = entry.k, over
        table.append(entry)
    return table


@cache
def curves() -> Array:
    """The polynomials in F - 2 through the table, (8, 7): powers, numbers of a row."""
    return np.asarray(np.polynomial.polynomial.polyfit(OVER, np.array(rows()), 7))


class _Waves(NamedTuple):
    """The local waves at places of a rod, (n,) each.

    k: wave number. size, third: of the first harmonic and a3/a^3 of the third. stiffness: d2e/dk2. push:
    <P>. pull: c, of friction. wound: where it is a helix.
    """

    k: Array
    size: Array
    third: Array
    stiffness: Array
    push: Array
    pull: Array
    wound: Booleans


def has_waves(rod: LoadedRod) -> bool:
    """Whether this is a rod that may lie in waves: inside, with weight across, on the low side at its start."""
    inside = rod.numbers[6] < 0 and rod.across > LIGHTEST and "height" not in rod.held
    return bool(inside and not np.any(rod.near))


class _Lean(NamedTuple):
    """How a rod leans on the wall, at places (n,): m, the weight that a wave about it feels, and F - 2 in that weight.

    NaN where friction turns the rod all the way round.
    """

    angle: Array
    weight: Array
    over: Array


def lean(rod: LoadedRod, over: Array) -> _Lean:
    """How a rod leans at F - 2; on the low side, but for one that turns in place."""
    angle, weight, local = np.zeros_like(over), np.ones_like(over), over
    if not rod.rotates:
        return _Lean(angle, weight, local)
    f, before = rod.numbers[3], local
    with np.errstate(invalid="ignore"):
        for _ in range(ROUNDS):
            waves = waves_at(rod, local, np.inf)
            level = 1 - waves.size**2 / 4  # <cos(d)>
            push = np.cos(angle) * level + weight * (waves.push - level)
            angle = -np.arcsin(f * push / level)
            weight = np.cos(angle) - f * np.sin(angle)
            before, local = local, (2 + over) / np.sqrt(weight) - 2
        settled = (np.abs(local - before) < LEANT) & (weight > 0)
    return _Lean(*(np.where(settled, values, np.nan) for values in (angle, weight, local)))


def leans_and_buckles(rod: LoadedRod, beyond: float = 0.0) -> bool:
    """Whether a long rod that turns in place buckles about its lean, or cannot lean. beyond: F - 2 from which."""
    if not (rod.rotates and has_waves(rod)):
        return False
    return not lean(rod, compression(rod, rod.nodes())).over.max() <= beyond


def waves_at(rod: LoadedRod, over: Array, front: float) -> _Waves:
    """The waves at F - 2. front: F - 2 above which the rod is a helix."""
    soft = positive_part(over)
    k, size, third, stiff, _, itself, axis = np.polynomial.polynomial.polyval(np.minimum(soft, OVER[-1]), curves())
    along_itself = rod.numbers[4] == ALONG_ITSELF
    pull = itself * soft if along_itself else axis * soft**2 * (not rod.rotates)
    wound = over > front
    F = np.maximum(2 + over, 1.0)
    helix = np.sqrt(F / 2)
    k, stiff = np.where(wound, [helix, 2 * F], [k, stiff * soft])
    pull = np.where(wound, helix * F**2 / 4 * along_itself, pull)
    return _Waves(k, size * np.sqrt(soft), third, stiff, mean_push(over, front), pull, wound)


def mean_push(over: Array, front: float) -> Array:
    """The mean push of the wall at F - 2, in units of the weight across. front: as in `waves_at`."""
    sinusoid = np.polynomial.polynomial.polyval(np.minimum(positive_part(over), OVER[-1]), curves()[:, 4])
    return np.asarray(np.where(over > front, np.maximum(2 + over, 1.0) ** 2 / 4, sinusoid))


def compression(rod: LoadedRod, t: Array, front: float = np.inf) -> Array:
    """F - 2 at t (n,), with what friction adds; `largest` where the rod locks."""
    rubbed, unit = 0.0 if rod.rotates else rod.numbers[3] * rod.across, np.sqrt(rod.across)
    given, passed = rod.tension_known - rod.along * (rod.span - t), t
    over = before = -(given - rubbed * (rod.span - t)) / unit - 2
    for _ in range(ROUNDS if rubbed else 0):
        passed = integral(waves_at(rod, over, front).push, t)
        over = np.minimum(-(given - rubbed * (passed[-1] - passed)) / unit - 2, largest(rod.across))
        if np.abs(over - before).max() < NEGLIGIBLE:
            break
        before = over
    return over


def largest(across: float) -> float:
    """F - 2 beyond which there is no helix."""
    return HELIX / np.sqrt(across) - 2


def positive_part(over: Array) -> Array:
    """F - 2 where it is positive, and nearly 0 elsewhere."""
    root = np.sqrt(over**2 + SOFT**2)
    return np.asarray(np.where(over > 0, (root + over) / 2, SOFT**2 / (2 * (root + np.abs(over)))))


def places(rod: LoadedRod, nodes: Array) -> Array:
    """Places on the rod, dense enough for its waves."""
    return np.linspace(0, rod.span, FINE * nodes.size)


def wave_shape(rod: LoadedRod, nodes: Array, over: Array, front: float = np.inf, more: int = 0) -> Shape:
    """Nearly an equilibrium: a sinusoid with the half waves of least energy, and a helix where F - 2 is above a front.

    over: `compression` at `places` of the nodes. more: further half waves of a sinusoid all along.
    """
    t, ell, leans = places(rod, nodes), rod.across**-0.25, lean(rod, over)
    x, whole, over = t / ell, over, leans.over
    waves = waves_at(rod, over, front)
    flux = integral(rod.numbers[3] * rod.across * ell**3 * waves.pull, x)
    ends = positive_part(over[[0, -1]]) ** 1.5  # as much as each end can bear
    change = (flux - flux[-1] * ends[0] / ends.sum()) / waves.stiffness
    phase = integral(waves.k * leans.weight**0.25 + change, x)
    turned, way, edge = np.zeros(t.size), 1.0, None
    if waves.wound.any():
        turned, way, edge = helix(rod, waves, x, phase, over)
        phase -= phase[edge]
        outer = 0 if edge else -1
        if over[outer] > 0 and phase[outer] != 0:
            phase *= np.round(phase[outer] / np.pi) * np.pi / phase[outer]
    elif over.min() > 0:
        phase *= (np.round(phase[-1] / np.pi) + more) * np.pi / phase[-1]
    elif over[0] < over[-1]:
        phase -= phase[-1]
    size = waves.size * np.sqrt(np.maximum(LEAST, 1 - 4 * change**2 / positive_part(over)))
    for name, place, end in (("beta0", x, over[0]), ("betaL", x[-1] - x, over[-1])):
        size *= np.tanh(place * np.sqrt(positive_part(end) / 8)) if name in rod.held else 1.0
    sinusoid = size * np.sin(phase) + waves.third * size**3 * np.sin(3 * phase)
    leant = leans.angle * np.tanh(x) ** 2 * (np.tanh(x[-1] - x) ** 2 if "azimuth" in rod.held else 1.0)
    alpha = leant + turned + np.where(waves.wound, 0.0, way * sinusoid)
    return shape_of(rod, nodes, t, alpha if edge is None else smooth_at(x, alpha, edge), whole)


def smooth_at(x: Array, alpha: Array, edge: int) -> Array:
    """The angles alpha, but for a bend at one place."""
    blur = np.hanning(2 * int(np.searchsorted(x, BLUR)) + 3)
    wide = np.pad(alpha, blur.size // 2, "edge")
    product = np.fft.rfft(wide) * np.fft.rfft(blur / blur.sum(), wide.size)
    smooth = np.fft.irfft(product, wide.size)[blur.size - 1 :]  # where the circular convolution does not wrap
    near = np.exp(-((x - x[edge]) ** 2))
    return np.asarray(alpha + near * (smooth - alpha))


def helix(rod: LoadedRod, waves: _Waves, x: Array, phase: Array, over: Array) -> tuple[Array, float, int]:
    """The azimuth (n,) of a rod on a stretch where it is a helix, constant beyond; its sense and place where it ends.

    A helix turns back where the azimuth of the far end wants it: as a kink of u'' = 2 u^3 - F u with u = alpha'. A
    clamped end is half a kink.
    """
    zone = np.flatnonzero(waves.wound)
    first, last = int(zone[0]), int(zone[-1])
    stretch = slice(first, last + 1)
    x, phase, k = x[stretch], phase[stretch] - phase[first], waves.k[stretch]
    whole = whole_turns(phase[-1])
    goal = float(rod.far[1]) if "azimuth" in rod.held else whole
    if last + 1 < waves.k.size:
        goal = whole_turns(goal)
    way = -1.0 if goal < 0 else 1.0
    rate = np.gradient(phase, x)
    if first == 0 and "beta0" in rod.held:
        rate = rate * np.tanh(k * (x - x[0]))
    if last + 1 == waves.k.size and "betaL" in rod.held:
        rate = rate * np.tanh(k * (x[-1] - x))
    pins = [(0, 0.0), (x.size - 1, abs(goal))]
    if phase[-1] - abs(goal) > np.pi:
        back = int(np.searchsorted(phase, (phase[-1] + abs(goal)) / 2))
        rate = rate * np.tanh(k * (x[back] - x))
        reached = whole_turns(integral(rate, x)[back])
        pins.insert(1, (back, float(reached)))
    way_along, turned = integral(rate, x), np.zeros(x.size)
    for (a, low), (b, high) in pairwise(pins):
        part = way_along[a : b + 1] - way_along[a]
        turned[a : b + 1] = low + part * ((high - low) / part[-1])
    turned -= 0.8 / (2 + over[stretch]) ** 2 * np.sin(turned)
    angle = np.zeros(waves.k.size)
    angle[stretch], angle[last + 1 :] = way * turned, way * turned[-1]
    return angle, way * (-1.0 if len(pins) > 2 and first == 0 else 1.0), first if first else last


def shape_of(rod: LoadedRod, nodes: Array, t: Array, alpha: Array, over: Array) -> Shape:
    """The rod with azimuths at t under a local compression F - 2, on nodes."""

    def rate(values: Array) -> Array:
        return np.asarray(np.gradient(values, t, edge_order=2))

    beta = np.arcsin(np.clip(rate(alpha), -STEEPEST, STEEPEST))
    speed, phi = rate(beta), -(over + 2) * np.sqrt(rod.across)
    moment = ((phi + 2 * np.cos(beta) * np.sin(beta) ** 2) * np.sin(beta) - rate(speed)) / np.cos(beta)
    y = rod.straight_states(nodes)
    short = integral(1 - np.cos(beta), t)
    for column, values in ((BETA, beta), (SPEED, speed), (ALPHA, alpha), (Q, moment), (PHI, phi), (SHORT, short)):
        y[:, column] = np.interp(nodes, t, values)
    return Shape(rod, nodes, y)


def wave_nodes(rod: LoadedRod, front: float = np.inf) -> tuple[Array, Array]:
    """Nodes, dense where friction adds to the compression, and the compression at their `places`."""
    t = rod.nodes()
    over = compression(rod, places(rod, t), front)
    if rod.has_friction:
        rubbed = compression(rod.with_friction(0.0), places(rod, t), front) - over
        t = rod.nodes(rubbed * np.sqrt(rod.across))
        over = compression(rod, places(rod, t), front)
    return t, over


def sinusoid(rod: LoadedRod) -> Shape | None:
    """The equilibrium near the local sinusoid, with its half waves or one more or less; None where there is none.

    A shape from which Newton's method has taken the waves, as by a straight end, is none.
    """
    if not has_waves(rod):
        return None
    t, over = wave_nodes(rod)
    if not 0 < lean(rod, over).over.max() < LAST:
        return None
    for more in (0, 1, -1):
        shape = correct(wave_shape(rod, t, over, more=more), most=STEPS + t.size // NODES)
        if shape is not None and shape.is_bent:
            return shape
    return None


def wants_helix(rod: LoadedRod) -> bool:
    """Whether the sinusoid of a rod would lift off the wall."""
    return bool(not rod.rotates and has_waves(rod) and compression(rod, places(rod, rod.nodes())).max() > LIFTED)


def wound_shape(rod: LoadedRod) -> Shape | None:
    """A stable equilibrium that is a helix where the compression wants one; None without one.

    With friction, which leaves no index, any such equilibrium.
    """
    fronts, unstable = FRONTS[:1] if rod.has_friction and rod.nodes().size > MANY else FRONTS, None
    for front in fronts:
        t, over = wave_nodes(rod, front)
        if over.max() >= largest(rod.across):
            return None
        waves = waves_at(rod, over, front)
        if integral(waves.k * waves.wound, places(rod, t))[-1] * rod.across**0.25 < 2 * np.pi * TURNS:
            return None
        shape = correct(wave_shape(rod, t, over, front), most=STEPS + t.size // NODES)
        if shape is not None and index_of_any(shape) == 0:
            return shape
        unstable = unstable or shape
    return None if unstable is None else descend(unstable)
