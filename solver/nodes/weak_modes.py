"""The modes along which a shape gives way most easily, and a shape that is held along one."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..core.weight_friction import HALF, SIZE
from ..numerics.arrays import ROUNDED, Array
from ..numerics.roots import newton, solve
from .banded_newton import ENDING, Linear, linear_at, newton_move
from .loaded_rod import ALPHA, BETA, SPEED, Q
from .varying_shapes import Shape

ANGLES = [BETA, ALPHA]
# of the angles, in their scales: how far a shape may be off along a mode. x10: beyond 0.1 another shape is meant
AMPLITUDES = 10.0 ** np.arange(-8, -1)


def forces_of(push: Array) -> Array:
    """Forces (N, 2, count) on beta and alpha at the nodes, as right sides (8 N, count) of the equations."""
    count = push.shape[-1]
    right = np.zeros((len(push) - 1, SIZE, count))
    right[:, [SPEED, Q]] = push[1:]
    ends = np.zeros((HALF, count))
    return np.concatenate([ends, right.reshape(-1, count), ends])


def response(linear: Linear, push: Array) -> Array | None:
    """The changes (N, 8, count), in the scales, that forces (N, 2, count) on beta and alpha at the nodes make."""
    change = linear.solve(forces_of(push), soft=True)
    return None if change is None else change.reshape(len(push), SIZE, push.shape[-1])


def weakest_modes(shape: Shape, count: int = 1, rounds: int = 4) -> Array:
    """The changes of the shape (count, N, 8) that the least forces make, the weakest first; the largest angle is 1.

    Fewer than asked for where they are not distinct. In a long rod the two weakest differ in their phase alone, and
    hardly in their stiffness: hence Ritz vectors.
    """
    N, scale = shape.t.size, shape.rod.scale
    u = 2.399963 * np.arange(N)
    pushes = [np.stack([np.cos(u + k), 1 + 0.5 * np.sin(u + k)], axis=1) for k in range(count)]  # contain every mode
    push = np.stack(pushes, axis=-1)
    linear = linear_at(shape)
    mode = np.zeros((N, scale.size, count))
    work = (scale[ANGLES] * scale[[SPEED, Q]])[:, None]  # of a unit force along a unit change
    for _ in range(rounds):
        step = response(linear, push)
        assert step is not None
        size = 2.0 ** np.floor(np.log2(np.abs(step[:, ANGLES]).max(axis=(0, 1))))  # squares of it may overflow
        mode, push = step / size, push / size
        moved = mode[:, ANGLES]
        stiffness = np.einsum("nik,nil->kl", moved[1:] * work, push[1:])
        sizes = np.einsum("nik,nil->kl", moved, moved)
        if np.linalg.matrix_rank(sizes, hermitian=True) < count:  # exactly at a buckling load all tend to one mode
            return weakest_modes(shape, count - 1, rounds)
        rates, mix = np.linalg.eig(np.linalg.solve(sizes, stiffness + stiffness.T))
        mode = mode @ mix[:, np.argsort(-rates)].real  # the force that makes an unstable change is along it here
        mode /= np.abs(mode[:, ANGLES]).max(axis=(0, 1))
        push = mode[:, ANGLES]
    first = np.argmax(np.abs(mode[:, BETA]) > 0.3 * np.abs(mode[:, BETA]).max(axis=0), axis=0)
    sign = np.sign(np.take_along_axis(mode[:, BETA], first[None], axis=0))
    return np.asarray(np.moveaxis(mode * sign * scale[:, None], -1, 0))


def modal_change(linear: Linear, push: Array, right: Array, along: Array) -> tuple[Array, Array] | None:
    """The changes (N, 8, m), in the scales, that right sides (8 N, m) make of a shape that is held along a mode, and
    the forces (m,) along it that hold it; None where there are none.

    push: the mode's angles (N, 2), also its unit force. along: (m,), by how much each change moves along it. These
    equations are regular where the rod gives way along the mode: a spring at its largest angle is put in and taken out.
    """
    node, k = divmod(int(np.abs(push[1:-1]).argmax()), 2)
    scale, pin = linear.rod.scale, np.zeros_like(push)
    pin[node + 1, k] = 1.0
    sprung = replace(linear, stiffness=pin * scale[[SPEED, Q]] / scale[ANGLES])
    columns = sprung.solve(np.concatenate([right, forces_of(np.stack([pin, push], axis=-1))], axis=1))
    if columns is None:
        return None
    changes = columns.reshape(len(push), SIZE, -1)
    read = np.einsum("rnk,nkm->rm", np.stack([pin, push]), changes[:, ANGLES])  # at the pin, along the mode
    target = np.stack([np.zeros_like(along), along])
    forces = solve((read[:, -2:] + [[1.0, 0.0], [0.0, 0.0]])[None], (read[:, :-2] - target)[None])[0]
    return (changes[..., :-2] - changes[..., -2:] @ forces, forces[1]) if np.isfinite(forces).all() else None


class Held(NamedTuple):
    """A shape that is held along a mode, the force along the mode that holds it, and how it grows as the shape
    moves by the mode."""

    shape: Shape
    force: float
    stiffness: float


def hold(shape: Shape, mode: Array) -> Held | None:
    """The equilibrium near a shape of a rod that is held along a mode (N, 8); None where there is none.

    It is smooth where the rod gives way along the mode, which is where the stiffness is 0. Where the mode breaks a
    symmetry that the shape has, no force is needed.
    """
    scale = shape.rod.scale
    push = (mode / scale)[:, ANGLES]

    def step(now: Shape) -> tuple[Shape, float] | str:
        moved = float((push * ((now.y - shape.y) / scale)[:, ANGLES]).sum())
        linear = linear_at(now)
        solved = modal_change(linear, push, linear.open[:, None], np.array([moved]))
        return newton_move(now, None if solved is None else -solved[0][..., 0])

    held = newton(shape, step, ENDING)
    if isinstance(held, str):
        return None
    linear = linear_at(held)
    right = np.stack([linear.open, np.zeros_like(linear.open)], axis=1)
    solved = modal_change(linear, push, right, np.array([0.0, (push * push).sum()]))
    return None if solved is None else Held(held, float(solved[1][0]), -float(solved[1][1]))


def largest_move(shape: Shape, error: float) -> float:
    """How far, in radians, a shape may be off that is off by an error in radians if it gives way as much all the way.

    At a fold or where branches meet the rod gives way to the least force, but only next to the shape. It is moved along
    its weakest mode until a force as large as that of the error holds it. The error where no amplitude is enough.
    """
    mode = weakest_modes(shape)[0]
    turned, base = float(np.abs(mode[:, BETA]).max()), hold(shape, mode)
    if base is None or not turned:
        return error
    force = max(abs(base.stiffness) * error / turned, ROUNDED)
    for amplitude in AMPLITUDES[AMPLITUDES * turned < error]:
        sides = [hold(replace(shape, y=shape.y + sign * amplitude * mode), mode) for sign in (1, -1)]
        if all(side is not None and abs(side.force) > force for side in sides):
            return float(amplitude * turned)
    return error
