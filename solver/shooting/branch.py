"""The equilibrium that continues from the straight rod as its loads grow, stable where one is."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from ..core.banded import solve_band
from ..numerics.arrays import Array
from .curve import Curve
from .inertia import index_of
from .loaded_rod import ALPHA, BETA, MU, PHI, SHORT, SPEED, LoadedRod, Q
from .newton import Shape, correct, linear_at, march_of
from .varying_shapes import Nodes

CLOSE = 1e-6  # relative: of the load at which the straight rod buckles
LOOSE = 1e-4  # of the scales: a correction that is enough on the way
AMPLITUDES = tuple(
    0.05 * 4.0**-k for k in range(6)
)  # of the angles, in their scales, with which a buckled shape is sought
MOST_FORCES = 40  # that are tried for a held height
FIRST_STEP, LEAST_STEP, LONGEST_STEP = 0.1, 1e-5, 0.25
AHEAD = 0.01  # of the loads: how far beyond its end the stable shape is sought to which a rod jumps
WEAKEST, STIFFER, FIRM, ROUNDS = 1e-4, 3.0, 1e6, 300  # springs: weakest, factor, strongest; steps of a descent


@dataclass(frozen=True, eq=False)
class Path:
    """How a shape was reached.

    shape: None if none was. index: its Morse index; 0 with friction, which has none. buckled: the share of the loads at
    which the straight rod buckles; None if it does not. jumped: shares at which the branch ended and the rod fell to
    another one. why: why no shape, or none under the whole loads, was reached.
    """

    shape: Shape | None
    index: int = 0
    buckled: float | None = None
    jumped: tuple[float, ...] = ()
    why: str = ""


def index_at(shape: Shape, springs: Array | None = None) -> int:
    """The Morse index of a shape; with springs, of the shape that they hold."""
    shape = shape if springs is not None else divided(shape)
    return index_of(shape.rod, march_of(shape)[1], shape.rod.scale, springs)


def divided(shape: Shape) -> Shape:
    """A shape with stretches so short that none holds a conjugate distance: the index counts by stretches.

    The loads alone set the nodes; in a rod that goes far round, beta turns faster.
    """
    y, width = shape.y, np.diff(shape.t)
    sin = np.maximum(np.abs(np.sin(y[1:, BETA])), np.abs(np.sin(y[:-1, BETA])))
    sin = np.minimum(1, sin + width * np.maximum(np.abs(y[1:, SPEED]), np.abs(y[:-1, SPEED])))
    loads = np.maximum(np.abs(y[1:]), np.abs(y[:-1]))
    squares = loads[:, PHI] + (loads[:, Q] + 5 * loads[:, MU] + 6 * sin) * sin  # above |H'|
    parts = np.ceil(width * np.sqrt(squares)).astype(int)
    if not np.isfinite(squares).all() or (parts <= 1).all():
        return shape
    t = np.interp(np.arange(parts.clip(1).sum() + 1), np.append(0, np.cumsum(parts.clip(1))), shape.t)
    return Shape(shape.rod, t, Nodes(shape.rod.numbers, shape.rod.scale, shape.t, y).at(t))


def index_of_any(shape: Shape) -> int:
    """The Morse index of a shape; 0 with friction, which has none."""
    return 0 if shape.rod.rubbed else index_at(shape)


def straight_shape(rod: LoadedRod, t: Array) -> Shape:
    """The straight rod along the axis."""
    return Shape(rod, t, rod.lying(t))


def branch_from_straight(rod: LoadedRod) -> Path:
    """The equilibrium on the branch of the straight rod.

    A straight rod that is stable is the answer. Elsewhere the loads grow from 0, but for the weight across, which is
    whole from the beginning; where the straight rod buckles the path takes the buckled shape, and where it ends, the
    stable shape below it. Friction grows at last, on the shape without it.
    """
    if rod.rubbed:
        return branch_with_friction(rod)
    if "height" in rod.held:
        return branch_to_height(rod)
    t = rod.nodes()
    if not rod.straight:
        first = correct(straight_shape(rod.share(0.0), t))
        if first is None:
            return Path(None, why="no equilibrium without loads was found")
        return grow(rod.share, first, 0.0, 1.0)
    shape = straight_shape(rod, t)
    if index_at(shape) == 0:
        return Path(shape)
    critical = buckling_share(rod, t)
    buckled = buckle(rod, t, critical)
    if buckled is None:
        why = f"no stable equilibrium was found near {critical:.6g} of the loads, where the straight rod buckles"
        return Path(None, buckled=critical, why=why)
    # in the root of the distance from the buckling load the branch is smooth
    first, share = buckled
    begin, end = np.sqrt(share - critical), np.sqrt(1 - critical)
    found = grow(lambda x: rod.share(1.0 if x == end else critical + x * x), first, begin, end)
    return replace(found, buckled=critical, jumped=tuple(critical + x * x for x in found.jumped))


def branch_with_friction(rod: LoadedRod) -> Path:
    """The same of a rod with friction, which grows on the shape without it."""
    plain = branch_from_straight(rod.rubbed_by(0.0))
    if plain.shape is None:
        return plain
    found = grow(rod.rubbed_by, plain.shape, 0.0, 1.0)
    return replace(found, buckled=plain.buckled, jumped=plain.jumped)


def branch_to_height(rod: LoadedRod) -> Path:
    """The same where the height is held: the axial force changes until the far end is there.

    A straight rod does not answer a change of its height, so this is a continuation in the force.
    """
    low, high, best = 0.0, np.inf, None  # sizes of the force
    size = float(rod.rate(np.array([rod.span]))[0] ** 2) / 4
    for _ in range(MOST_FORCES):
        far = rod.far.copy()
        far[2] = -size
        path = branch_from_straight(replace(rod, held=rod.held - {"height"}, far=far))
        if path.shape is None:
            return replace(path, why=f"{path.why}, under a force on the way to the held height")
        short = path.shape.y[-1, SHORT]
        bent = short > 1e-3 * (rod.span - rod.far[2])
        if bent:
            best = path
            shape = Shape(rod, path.shape.t, path.shape.y)
            found = correct(shape, reach=1.0, most=12)
            if found is not None and is_near(shape, found) and index_of_any(found) <= path.index:
                return replace(path, shape=found, index=index_of_any(found))
        low, high = (low, size) if short > rod.span - rod.far[2] else (size, high)
        size = 2 * size if high == np.inf else (low + high) / 2
    return Path(
        None, why="no axial force was found that holds this height" + ("" if best else ": the rod stays straight")
    )


def buckling_share(rod: LoadedRod, t: Array) -> float:
    """The share of the loads just above which the straight rod is unstable along one mode."""
    low, high, index = 0.0, 1.0, index_at(straight_shape(rod, t))
    while (high - low > CLOSE * high or index > 1) and high - low > 1e-12 * high:
        middle = (low + high) / 2
        now = index_at(straight_shape(rod.share(middle), t))
        low, high, index = (low, middle, now) if now else (middle, high, index)
    return high


def buckling_tension(rod: LoadedRod) -> float | None:
    """The far end's phi below which the straight rod under its whole weight is unstable, without friction.

    None where the straight rod is no equilibrium, or is unstable though all of it is in tension.
    """
    rod = replace(rod.rubbed_by(0.0), held=rod.held - {"height"})

    def is_unstable(phi: float) -> bool:
        far = rod.far.copy()
        far[2] = phi
        pulled = replace(rod, far=far)
        return index_at(straight_shape(pulled, pulled.nodes())) > 0

    high = max(0.0, rod.along * rod.span)  # here no part of the rod is compressed
    if not rod.straight or is_unstable(high):
        return None
    low = high - 1 / rod.span**2
    while not is_unstable(low):
        low = high + 4 * (low - high)
    while high - low > CLOSE * max(abs(high), abs(low)):
        middle = (low + high) / 2
        low, high = (middle, high) if is_unstable(middle) else (low, middle)
    return (low + high) / 2


def buckle(rod: LoadedRod, t: Array, critical: float) -> tuple[Shape, float] | None:
    """A stable shape into which the straight rod buckles at a share of its loads, and its own share; None without one.

    The amplitude of the weakest mode is given and the share unknown: so the way leads round no straight rod. Where the
    branch turns to smaller loads it is the stable shape below the straight rod.
    """
    begin = straight_shape(rod.share(critical), t)
    modes = weakest_modes(begin, 2)
    curve = Curve(rod.share, 1.0, begin.rod.scale)
    for amplitude, mode in product(AMPLITUDES, modes):
        across = curve.direction(mode, 0.0)
        guess = replace(begin, y=begin.y + amplitude * mode)
        found = curve.correct(guess, critical, across)
        if found is None or found.x > 1:
            continue
        if found.x < critical:
            break
        if index_at(found.shape) == 0:
            return found.shape, found.x
    share = min(1.0, critical * (1 + AHEAD))
    below = descend(straight_shape(rod.share(share), t), modes[0])
    return None if below is None else (below, share)


def grow(rod_at: Callable[[float], LoadedRod], shape: Shape, x: float, last: float) -> Path:
    """The equilibrium reached from one at x while x grows to its last value; a stable one stays stable.

    rod_at: the rod at each x. The `jumped` of the path are values of x.
    """
    step, before = max(x, FIRST_STEP * last), None
    jumped: list[float] = []
    index = index_of_any(shape)
    while x < last:
        ahead = min(last, x + step)
        guess = shape.y if before is None else shape.y + (shape.y - before[1]) * ((ahead - x) / (x - before[0]))
        found = correct(Shape(rod_at(ahead), shape.t, guess), reach=2.0, most=10, enough=LOOSE)
        if found is not None and is_near(shape, found) and index_of_any(found) <= index:
            before = x, shape.y
            x, shape = ahead, found
            step = min(2 * step, LONGEST_STEP * last) if found.steps <= 5 else step
            continue
        step /= 3
        if step > LEAST_STEP * last:
            continue
        ahead = min(last, x + AHEAD * last)
        rod = rod_at(ahead)
        below = None if rod.rubbed else descend(Shape(rod, shape.t, shape.y))
        if below is None:
            return Path(
                None, index, None, tuple(jumped), f"the branch ends at {x / last:.6g} of the way to these loads"
            )
        jumped.append(x)
        x, shape, index, before, step = ahead, below, 0, None, AHEAD * last
    final = correct(Shape(rod_at(last), shape.t, shape.y))
    if final is None or not is_near(shape, final):
        return Path(None, index, None, tuple(jumped), "Newton's method did not converge under the whole loads")
    return Path(final, index_of_any(final), None, tuple(jumped))


def is_near(shape: Shape, other: Shape) -> bool:
    """Whether no angle changed so much that it may be another branch."""
    change = np.abs(other.y - shape.y)[:, [BETA, ALPHA]] / shape.rod.scale[[BETA, ALPHA]]
    size = np.abs(shape.y[:, [BETA, ALPHA]] / shape.rod.scale[[BETA, ALPHA]]).max()
    return bool(change.max() < 0.5 + size)


def springs_of(shape: Shape, strength: float) -> Array:
    """Springs at the nodes (N, 2), as much on each length, in the scales of beta and alpha."""
    width, T = np.gradient(shape.t), shape.rod.time
    return np.asarray(strength * width[:, None] / np.array([T**2, T**4]))


def descend(shape: Shape, change: Array | None = None) -> Shape | None:
    """A stable equilibrium below a shape, by steps each of which lowers the energy; None where none was reached.

    Springs at the nodes hold each shape near the one before it, as weak as the stability of the next one allows.
    """
    strength = WEAKEST
    while index_at(shape, springs_of(shape, strength)) > 0:
        strength *= STIFFER
        if strength > FIRM:
            return None
    y = shape.y + 0.1 * (weakest_modes(shape)[0] if change is None else change)
    for _ in range(ROUNDS):
        now = replace(shape, y=y)
        found = correct(now, y, springs_of(now, strength), reach=1.0, most=15, enough=LOOSE)
        if found is None:
            strength *= STIFFER
            if strength > FIRM:
                return None
            continue
        y = found.y
        if index_at(found) == 0:
            free = correct(found, reach=1.0, most=12)
            if free is not None and is_near(found, free) and index_at(free) == 0:
                return free
            strength = max(WEAKEST, strength / 2)
    return None


def weakest_modes(shape: Shape, count: int = 1, rounds: int = 4) -> Array:
    """The changes of the shape (count, N, 8) that the least forces make, the weakest first; the largest angle is 1.

    Fewer than asked for where they are not distinct. In a long rod the two weakest differ in their phase alone, and
    hardly in their stiffness: hence Ritz vectors.
    """
    N, scale = shape.t.size, shape.rod.scale
    u = 2.399963 * np.arange(N)
    pushes = [np.stack([np.cos(u + k), 1 + 0.5 * np.sin(u + k)], axis=1) for k in range(count)]  # contain every mode
    push = np.stack(pushes, axis=-1)
    linear, angles = linear_at(shape), [BETA, ALPHA]
    mode = np.zeros((N, scale.size, count))
    work = (scale[angles] * scale[[SPEED, Q]])[:, None]  # of a unit force along a unit change
    for _ in range(rounds):
        right = np.zeros((N, scale.size, count))
        right[:-1, [SPEED, Q]] = push[1:]
        flat = np.concatenate([np.zeros((4, count)), right[:-1].reshape(-1, count), np.zeros((4, count))])
        step = solve_band(linear.band, flat)
        assert step is not None
        mode = np.asarray(step).reshape(N, -1, count)
        moved = mode[:, angles]
        stiffness = np.einsum("nik,nil->kl", moved[1:] * work, push[1:])
        sizes = np.einsum("nik,nil->kl", moved, moved)
        if np.linalg.matrix_rank(sizes, hermitian=True) < count:  # exactly at a buckling load all tend to one mode
            return weakest_modes(shape, count - 1, rounds)
        found, mix = np.linalg.eig(np.linalg.solve(sizes, stiffness + stiffness.T))
        mode = mode @ mix[:, np.argsort(-found)].real  # the force that makes an unstable change is along it here
        mode /= np.abs(mode[:, angles]).max(axis=(0, 1))
        push = mode[:, angles]
    first = np.argmax(np.abs(mode[:, BETA]) > 0.3 * np.abs(mode[:, BETA]).max(axis=0), axis=0)
    sign = np.sign(np.take_along_axis(mode[:, BETA], first[None], axis=0))
    return np.asarray(np.moveaxis(mode * sign * scale[:, None], -1, 0))
