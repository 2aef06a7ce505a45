"""Other equilibria with the same held ends, near the one that a seed leads to.

An equilibrium is carried from a seed along its branch. Where a fold is near, another equilibrium with the same ends may
be as near to the seed. They are looked for across the nearest fold, by deflation from the seed, and on the branch
itself: beyond the ends that are wanted and behind the seed it may turn back at a fold and meet these ends again.
"""

import numpy as np

from ..branches.branch_events import Bounds
from ..branches.deflation import is_known, numbers_of
from ..branches.given_numbers import Given, OrbitState
from ..branches.held_index import index_of
from ..numerics.arclength import FEW_POINTS
from .held_moves import across_fold, angles_along, deflate, is_nearer_across_fold, meetings

_REACH = (-1.0, 3.0)  # shares of the way from the seed, 0, to the held ends, 1, over which its branch is followed
_ITSELF = 1e-9  # rad


def alternatives_of(seed: OrbitState, found: OrbitState, wanted: Given) -> list[OrbitState]:
    """The other equilibria, as they are found."""
    known = [numbers_of(found)]
    others: list[OrbitState] = []

    def add(state: OrbitState | None) -> None:
        if state is not None and not is_known(state, known):
            known.append(numbers_of(state))
            others.append(state)

    for guess in (*across_fold(found, wanted), seed):
        add(deflate(guess, wanted, known))
    for state in meetings(seed, found, wanted, Bounds(*_REACH, (1.0,), FEW_POINTS)):
        add(state)
    for other in tuple(others):
        for guess in across_fold(other, wanted)[:1]:
            add(deflate(guess, wanted, known))
    return others


def away(one: OrbitState, other: OrbitState) -> float:
    """The largest difference of beta [rad] at equal s/L."""
    return float(np.abs(angles_along(one) - angles_along(other)).max())


def said_of_seed(seed: OrbitState, found: OrbitState, wanted: Given) -> str:
    """How far the seed is, what differs there, and whether another equilibrium is nearer than the seed."""
    far = away(seed, found)
    words = f"the seed, {far:.3g} rad away" if far > _ITSELF else "the seed itself"
    indices = index_of(seed, wanted.at(seed)), index_of(found, wanted)
    if np.isfinite(indices).all() and indices[0] != indices[1]:
        words += f"; the seed has index {indices[0]:.0f} and this equilibrium index {indices[1]:.0f}"
    if is_nearer_across_fold(seed, found, wanted):
        words += "; another equilibrium with these ends is nearer to this one than the seed is: see alternatives"
    return words
