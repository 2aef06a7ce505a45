"""Equilibria of a rod with weight other than the known ones: Newton's method led away from these.

Distances are taken in the angles at the nodes.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..numerics.arrays import Array
from ..numerics.roots import lead_away
from .curve import REACH
from .loaded_rod import ALPHA, BETA, LoadedRod
from .newton import DEEP, Shape, correct, is_same, linear_at, size_of

ROUNDS = 30  # steps
NEAR = 0.1  # size of a step of Newton's method from which it converges by itself
AMPLITUDES = -1.0, 0.9  # of the waves of a start: the powers of ten between which it lies
WAVES, FROM_KNOWN, AROUND = 4, 0.7, 0.3  # in a start; share of starts from known shapes; azimuths over angles


def angles_of(shape: Shape) -> Array:
    """The angles at the nodes in their scales, such that the length of a difference is its mean size."""
    return angles_in(shape.y / shape.rod.scale)


def angles_in(change: Array) -> Array:
    """Those of a change (N, 8) in the scales."""
    return np.asarray(change[:, [BETA, ALPHA]].reshape(-1) / np.sqrt(len(change)))


def deflate(start: Shape, known: list[Shape]) -> Shape | None:
    """An equilibrium that is none of the known ones; None where the steps from a shape lead to none."""

    def newton_step(shape: Shape) -> tuple[Array, Array, Array] | None:
        change = linear_at(shape, deep=DEEP).newton_change()
        return None if change is None else (angles_of(shape), angles_in(change), change)

    def move(shape: Shape, change: Array, factor: float) -> tuple[Shape, float]:
        turn = float(np.abs(change[:, [BETA, ALPHA]]).max())
        share = np.clip(factor, -REACH / turn, REACH / turn) if turn else 0.0
        return replace(shape, y=shape.y + share * change * shape.rod.scale), size_of(change)

    near = lead_away(start, newton_step, move, [angles_of(one) for one in known], ROUNDS, NEAR)
    found = None if near is None else correct(near, reach=REACH, most=15)
    return None if found is None or any(is_same(found, one) for one in known) else found


def further_shapes(rod: LoadedRod, t: Array, known: list[Shape], tries: int) -> Iterator[Shape]:
    """Further equilibria on nodes t, until so many tries in a row find none.

    known: grows by what the caller takes of them.
    """
    rng, fruitless = np.random.default_rng(0), 0
    wave = np.pi * np.outer(t / rod.span, np.arange(1, WAVES + 1))
    while fruitless < tries:
        from_known = known and rng.random() < FROM_KNOWN
        y = known[rng.integers(len(known))].y.copy() if from_known else rod.lying(t)
        size = 10 ** rng.uniform(*AMPLITUDES)
        turned, moved = rng.normal(size=(2, WAVES)) / np.arange(1, WAVES + 1)
        y[:, BETA] += size * rod.scale[BETA] * (np.sin(wave + rng.uniform(0, np.pi, WAVES)) @ turned)
        y[:, ALPHA] += AROUND * size * (np.sin(wave) @ moved)
        found = deflate(Shape(rod, t, y), known)
        fruitless = fruitless + 1 if found is None else 0
        if found is not None:
            yield found
