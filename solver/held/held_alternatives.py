"""Other equilibria with the same held ends, near the one that a seed leads to.

An equilibrium is carried from a seed along its branch. Where a fold is near, another equilibrium with the same ends may
be as near to the seed. They are looked for across the nearest fold, by deflation from the seed, and on the branch
itself: beyond the ends that are wanted and behind the seed it may turn back at a fold and meet these ends again.
"""

import numpy as np

from ..branches.branch_events import Bounds
from ..branches.deflation import end_vector, is_known
from ..branches.given_numbers import Given, OrbitState
from ..branches.held_index import index_of
from ..numerics.arclength import FEW_POINTS
from ..numerics.arrays import NEGLIGIBLE
from .held_moves import across_fold, angles_along, deflate, is_nearer_across_fold, meetings

# shares of the way from the seed, 0, to the held ends, 1, over which its branch is followed, as some turn back. x10:
# time, and rods that are far from both
_REACH = (-1.0, 3.0)


def alternatives_of(seed: OrbitState, state: OrbitState, wanted: Given) -> list[OrbitState]:
    """The other equilibria, as they are found."""
    known = [end_vector(state)]
    others: list[OrbitState] = []

    def add(other: OrbitState | None) -> None:
        if other is not None and not is_known(other, known):
            known.append(end_vector(other))
            others.append(other)

    for guess in (*across_fold(state, wanted), seed):
        add(deflate(guess, wanted, known))
    for meeting in meetings(seed, state, wanted, Bounds(*_REACH, (1.0,), FEW_POINTS)):
        add(meeting)
    for other in tuple(others):
        for guess in across_fold(other, wanted)[:1]:
            add(deflate(guess, wanted, known))
    return others


def away(state: OrbitState, other: OrbitState) -> float:
    """The largest difference of beta [rad] at equal s/L."""
    return float(np.abs(angles_along(state) - angles_along(other)).max())


def said_of_seed(seed: OrbitState, state: OrbitState, wanted: Given) -> str:
    """How far the seed is, what differs there, and whether another equilibrium is nearer than the seed."""
    far = away(seed, state)
    words = f"the seed, {far:.3g} rad away" if far > NEGLIGIBLE else "the seed itself"
    indices = index_of(seed, wanted.at(seed)), index_of(state, wanted)
    if np.isfinite(indices).all() and indices[0] != indices[1]:
        words += f"; the seed has index {indices[0]:.0f} and this equilibrium index {indices[1]:.0f}"
    if is_nearer_across_fold(seed, state, wanted):
        words += "; another equilibrium with these ends is nearer to this one than the seed is: see alternatives"
    return words
