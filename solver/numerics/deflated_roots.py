"""Newton's rule led away from zeros that are known, to find other ones.

The equations are multiplied by the product of 1 + 1/r^2 over the known zeros, r being the distance from one of them in
some numbers: the product has the same zeros but these. Newton's step for the product is that for the equations times a
number, so nothing but this number is computed.
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from .arrays import Array

State = TypeVar("State")
Step = TypeVar("Step")
_SLIGHT = 0.5  # of the rate of the product along a step, below which the known zeros hardly matter


def lead_away(
    state: State,
    newton_step: Callable[[State], tuple[Array, Array, Step] | None],
    move: Callable[[State, Step, float], tuple[State, float] | None],
    known: Sequence[Array],
    rounds: int,
    near: float,
) -> State | None:
    """A state from which Newton's rule converges by itself, away from the known zeros; None where the steps reach none.

    Parameters
    ----------
    state : any type
        Where to begin.
    newton_step : callable
        Of a state: the numbers in which distances are taken, their change by a step of Newton's rule for the equations,
        and that step; None where there is none.
    move : callable
        Of a state, a step and a factor: the state after the factor times the step, or less if that is too long, and the
        size of the step itself; None where there is no such state.
    known : sequence of arrays
        The numbers of the known zeros.
    rounds : int
        Of steps.
    near : float
        Size of a step from which Newton's rule converges.
    """
    for _ in range(rounds):
        step = newton_step(state)
        if step is None:
            return None
        numbers, change, whole = step
        rate = rate_of_product(numbers, change, known)
        moved = move(state, whole, 1 / (1 - rate) if rate != 1 else np.inf)
        if moved is None:
            return None
        state, size = moved
        if size < near and abs(rate) < _SLIGHT:
            return state
    return None


def rate_of_product(numbers: Array, change: Array, known: Sequence[Array]) -> float:
    """The derivative of the logarithm of the product along a change of the numbers."""
    total = 0.0
    for zero in known:
        apart = numbers - zero
        square = max(float(apart @ apart), 1e-30)
        total -= 2 * float(apart @ change) / (square * (square + 1))
    return total
