"""How far a shape is from being stable, and the stable shape to which a rod falls from one that is not."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..core.varying_loads import HALF, SIZE, count_negatives
from ..numerics.arrays import Array
from ..numerics.roots import DIVERGED, newton, solve
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q
from .newton import (
    ENDING,
    Linear,
    correct,
    largest_turn,
    linear_at,
    march_of,
    share_within,
    size_of,
)
from .varying_shapes import Shape


def index_of(rod: LoadedRod, transfer: Array, scale: Array, stiffness: Array | None = None) -> int:
    """The negative eigenvalues of the Hessian of the action, from the transfer matrices (N, 8, 8) of the stretches.

    The action over nodes is the sum of p' q' - W(q, p') over the stretches, where W generates the map of a stretch from
    (q, p) to (q', p'), with q = (beta, alpha, z, gamma) and p = (beta_t, lam, phi, mu). Its second derivatives exist on
    any stretch shorter than a conjugate distance, also where a height or a rotation does not change. Eliminating the p,
    of which each stretch has four, leaves the energy with its constraints: the index is the number of negative
    eigenvalues less that of the p. stiffness: (N + 1, 2), springs at the nodes.
    """
    N = transfer.shape[0]
    S, P = scale[[BETA, ALPHA, SHORT, ROUND]], scale[[SPEED, Q, PHI, MU]]
    free = np.array(["beta0" not in rod.held, False, False, False])
    held = np.array([name in rod.held for name in ("betaL", "azimuth", "height", "rotation")])
    springs = np.zeros((N + 1, HALF))
    if stiffness is not None:
        springs[:, :2] = stiffness * S[:2] ** 2
    unit = np.concatenate([S, P])
    return count_negatives(transfer, unit, springs, free, held) - HALF * (N - 1) - int(held.sum())


SOFT = 1e-14  # springs that hardly change the equations, in the scales
LOOSE, FLUID = 1e-4, 1e-2  # of the scales: a correction that is enough on the way, and in a fall
WEAKEST, FIRST, FIRMEST, FACTOR = 1e-7, 1e-2, 1e6, 3.0  # springs: weakest, at first, strongest, change
KICK, FAR, REST = 0.1, 0.5, 1e-3  # of the angles, in their scales: a push, the longest move, what counts as none
EASY, QUICK = 5.0, 4  # how much weaker the springs are when a shape without them is tried; steps of an easy correction
ROUNDS = 150  # steps of a fall
BALANCED = 1e-9  # of the scales: what is left open where symmetry alone holds a shape


def index_at(shape: Shape) -> int:
    """The Morse index of a shape."""
    return held_indices(shape, ())[0]


def held_indices(shape: Shape, strengths: Sequence[float]) -> list[int]:
    """The Morse index of a shape alone, and where springs of each strength hold it."""
    shape = fine_shape(shape)
    springs = [None, *(springs_of(shape, strength) for strength in strengths)]
    transfer = march_of(shape)[1]
    return [index_of(shape.rod, transfer, shape.rod.scale, spring) for spring in springs]


def fine_shape(shape: Shape) -> Shape:
    """A shape with stretches so short that none holds a conjugate distance: the index counts by stretches.

    The loads alone set the nodes; in a rod that goes far round, beta turns faster.
    """
    t = fine_nodes(shape)
    return shape if t.size == shape.t.size else on_nodes(shape, t)


def fine_nodes(shape: Shape) -> Array:
    """The nodes of `fine_shape`; those of the shape itself where its loads are not finite."""
    parts = np.ceil(np.diff(shape.t) * change_rates(shape)).clip(1)
    if not np.isfinite(parts).all():
        return shape.t
    return np.interp(np.arange(parts.sum() + 1), np.append(0, np.cumsum(parts)), shape.t)


def change_rates(shape: Shape) -> Array:
    """A bound of the root of |H'| on each stretch of a shape, (N - 1,)."""
    y, width = shape.y, np.diff(shape.t)
    sin = np.maximum(np.abs(np.sin(y[1:, BETA])), np.abs(np.sin(y[:-1, BETA])))
    sin = np.minimum(1, sin + width * np.maximum(np.abs(y[1:, SPEED]), np.abs(y[:-1, SPEED])))
    loads = np.maximum(np.abs(y[1:]), np.abs(y[:-1]))
    return np.asarray(np.sqrt(loads[:, PHI] + (loads[:, Q] + 5 * loads[:, MU] + 6 * sin) * sin))


def on_nodes(shape: Shape, t: Array) -> Shape:
    """The same shape on other nodes."""
    return shape_like(shape.rod, shape, t)


def shape_like(rod: LoadedRod, known: Shape, t: Array) -> Shape:
    """A shape of one rod as a guess of that of another rod on nodes t, at equal shares of their spans."""
    return Shape(rod, t, known.at(t * (known.t[-1] / rod.span)))


def index_of_any(shape: Shape) -> int:
    """The Morse index of a shape; 0 with friction, which has none."""
    return 0 if shape.rod.rubbed else index_at(shape)


def is_near(shape: Shape, other: Shape) -> bool:
    """Whether no angle changed so much that it may be another branch."""
    scale = shape.rod.scale
    return largest_turn((other.y - shape.y) / scale) < 0.5 + largest_turn(shape.y / scale)


def springs_of(shape: Shape, strength: float) -> Array:
    """Springs at the nodes (N, 2), as much on each length, in the scales of beta and alpha."""
    width, T = np.gradient(shape.t), shape.rod.time
    return np.asarray(strength * width[:, None] / np.array([T**2, T**4]))


def descend(shape: Shape, change: Array | None = None) -> Shape | None:
    """The stable equilibrium to which a shape falls as if through a viscous fluid; None where it reaches none.

    Springs at the nodes hold each shape near the one before it. Their strength keeps the steps short and the held shape
    stable, so that each step lowers the energy. At a shape that does not move and is not stable the rod is pushed along
    its weakest mode. A rod with friction has no energy, and none is sought.
    """
    if shape.rod.rubbed:
        return None
    strength, tried, eased = FIRST, FIRST, False
    y = shape.y + (KICK * weakest_modes(shape)[0] if change is None else change)
    for _ in range(ROUNDS):
        now = replace(shape, y=y)
        ahead = correct(now, y, springs_of(now, strength), most=6, enough=FLUID)
        moved = np.inf if ahead is None else largest_turn((ahead.y - y) / shape.rod.scale)
        index, held = (1, 1) if ahead is None or moved > FAR else held_indices(ahead, (strength,))
        if ahead is None or held > 0:
            strength, eased = strength * FACTOR, False
            if strength > FIRMEST:
                return None
            continue
        y = ahead.y
        if index == 0 and strength <= tried / EASY:
            tried = strength
            free = correct(ahead, most=12)
            if free is not None and is_near(ahead, free) and index_at(free) == 0:
                return free
        if index > 0:
            tried = FIRST
        if eased and ahead.steps <= QUICK:
            strength = max(WEAKEST, strength / FACTOR)
        eased = True
        if moved < REST and index > 0:
            y = y + KICK * weakest_modes(ahead)[0]
    return None


def forces_of(push: Array) -> Array:
    """Forces (N, 2, count) on beta and alpha at the nodes, as right sides (8 N, count) of the equations."""
    count = push.shape[-1]
    right = np.zeros((len(push) - 1, SIZE, count))
    right[:, [SPEED, Q]] = push[1:]
    ends = np.zeros((HALF, count))
    return np.concatenate([ends, right.reshape(-1, count), ends])


def response(linear: Linear, push: Array) -> Array | None:
    """The changes (N, 8, count), in the scales, that forces (N, 2, count) on beta and alpha at the nodes make."""
    change = linear.solve(forces_of(push))
    return None if change is None else change.reshape(len(push), SIZE, push.shape[-1])


def held_change(linear: Linear, push: Array, right: Array, along: Array) -> tuple[Array, Array] | None:
    """The changes (N, 8, m), in the scales, that right sides (8 N, m) make of a shape that is held along a mode, and
    the forces (m,) along it that hold it; None where there are none.

    push: the mode's angles (N, 2), also its unit force. along: (m,), by how much each change moves along it. These
    equations are regular where the rod gives way along the mode: a spring at its largest angle is put in and taken out.
    """
    node, k = divmod(int(np.abs(push[1:-1]).argmax()), 2)
    scale, pin = linear.rod.scale, np.zeros_like(push)
    pin[node + 1, k] = 1.0
    sprung = replace(linear, stiffness=pin * scale[[SPEED, Q]] / scale[[BETA, ALPHA]])
    columns = sprung.solve(np.concatenate([right, forces_of(np.stack([pin, push], axis=-1))], axis=1))
    if columns is None:
        return None
    changes = columns.reshape(len(push), SIZE, -1)
    read = np.einsum("rnk,nkm->rm", np.stack([pin, push]), changes[:, [BETA, ALPHA]])  # at the pin, along the mode
    wanted = np.stack([np.zeros_like(along), along])
    forces = solve((read[:, -2:] + [[1.0, 0.0], [0.0, 0.0]])[None], (read[:, :-2] - wanted)[None])[0]
    return (changes[..., :-2] - changes[..., -2:] @ forces, forces[1]) if np.isfinite(forces).all() else None


def hold(shape: Shape, mode: Array) -> tuple[Shape, float] | None:
    """The equilibrium near a shape that its symmetry keeps, which does not move along a mode (N, 8) that breaks it, and
    the stiffness of the rod there against a push along the mode; None where there is none.

    Both are smooth where the rod gives way along the mode, which is where the stiffness is 0.
    """
    scale = shape.rod.scale
    push = (mode / scale)[:, [BETA, ALPHA]]

    def step(now: Shape) -> tuple[Shape, float] | str:
        moved = float((push * ((now.y - shape.y) / scale)[:, [BETA, ALPHA]]).sum())
        linear = linear_at(now)
        solved = held_change(linear, push, linear.open[:, None], np.array([moved]))
        if solved is None:
            return DIVERGED
        change = solved[0][..., 0]
        y = now.y - change * scale * share_within(change)
        return replace(now, y=y, steps=now.steps + 1), size_of(change)

    held = newton(shape, step, ENDING)
    if isinstance(held, str):
        return None
    linear = linear_at(held)
    solved = held_change(linear, push, np.zeros((linear.open.size, 1)), np.ones(1))
    return None if solved is None or np.abs(linear.open).max() > BALANCED else (held, -float(solved[1][0]))


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
        step = response(linear, push)
        if step is None:  # at a buckling load, to the last digit
            linear = replace(linear, stiffness=np.full((N, 2), SOFT))
            step = response(linear, push)
        assert step is not None
        mode = step
        moved = mode[:, angles]
        stiffness = np.einsum("nik,nil->kl", moved[1:] * work, push[1:])
        sizes = np.einsum("nik,nil->kl", moved, moved)
        if np.linalg.matrix_rank(sizes, hermitian=True) < count:  # exactly at a buckling load all tend to one mode
            return weakest_modes(shape, count - 1, rounds)
        rates, mix = np.linalg.eig(np.linalg.solve(sizes, stiffness + stiffness.T))
        mode = mode @ mix[:, np.argsort(-rates)].real  # the force that makes an unstable change is along it here
        mode /= np.abs(mode[:, angles]).max(axis=(0, 1))
        push = mode[:, angles]
    first = np.argmax(np.abs(mode[:, BETA]) > 0.3 * np.abs(mode[:, BETA]).max(axis=0), axis=0)
    sign = np.sign(np.take_along_axis(mode[:, BETA], first[None], axis=0))
    return np.asarray(np.moveaxis(mode * sign * scale[:, None], -1, 0))
