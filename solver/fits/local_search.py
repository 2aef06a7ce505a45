"""The local search of a fit: steps of least squares that move only what the data determine.

A step is that of Gauss and Newton within a region of trust, whose radius follows how well the last one was foretold.
Directions that change no datum get no part of it, so that what the data do not determine stays where the search began,
and no rounding decides where it ends.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..numerics.arrays import Array
from .model import FitMinimum, Model, NoValueError
from .uncertainty import Decomposition, decomposition

# Relative: a search ends where its step in x, or its gain of the sum of squares, is smaller. With 50 points this gain
# leaves 6e-4 standard errors (measured); data that are met exactly end by the step. x10: 2e-3 standard errors
STEP, _GAIN = 1e-10, 1e-7
_EVALUATIONS = 200  # of one search. x10: only failures take longer
# Shares of a foretold gain: of a smaller one the radius shrinks to this share of the step, of a larger one it doubles.
# x10: it never grows; the values are those of textbooks
_POOR, _GOOD = 0.25, 0.75


class _Step(NamedTuple):
    """A step in x, (F,), its length in units of the columns' norms, and by how much it should lower the cost."""

    move: Array
    length: float
    gain: float


@np.errstate(all="ignore")  # of steps to places without a value
def search(model: Model, start: Array, is_known: Callable[[Array], bool]) -> FitMinimum | None:
    """The minimum to which a search from `start` leads; None where there is no value, or where it comes to a known one.

    A step to a place without a value is made shorter.
    """
    model.begin()
    residuals = model.residuals(start)
    if not np.isfinite(residuals).all():
        return None
    every = np.ones(start.size, dtype=bool)
    try:
        if not model.jacobian(start).any() or not residuals.any():  # no direction is better, or nothing is left to gain
            return FitMinimum(*model.accepted[0], every)
        return _descent(model, start, is_known)
    except NoValueError as error:
        return FitMinimum(*model.accepted[-1], every, str(error)) if model.accepted else None


def _descent(model: Model, start: Array, is_known: Callable[[Array], bool]) -> FitMinimum | None:
    low, high = bounds = np.array([parameter.bounds for parameter in model.parameters]).T
    x = start
    radius = float(np.linalg.norm(x * np.linalg.norm(model.accepted[0][1], axis=0))) or 1.0  # a change of its own size
    for _ in range(_EVALUATIONS):
        evaluation, jacobian = model.accepted[-1]
        step = _step(jacobian, evaluation.residuals, x, bounds, radius)
        if np.linalg.norm(step.move) < STEP * (STEP + np.linalg.norm(x)):
            return FitMinimum(evaluation, jacobian, (low < x) & (x < high))
        x_new = np.clip(x + step.move, low, high)
        residuals = model.residuals(x_new)
        cost, cost_new = float(evaluation.residuals @ evaluation.residuals) / 2, float(residuals @ residuals) / 2
        gain = cost - cost_new if np.isfinite(cost_new) else -np.inf
        share = gain / step.gain if step.gain > 0 else 0.0
        if gain > 0:
            x = x_new
            model.jacobian(x)
            if is_known(x):
                return None
        if gain < _GAIN * cost and share > _POOR:
            return FitMinimum(*model.accepted[-1], (low < x) & (x < high))
        if share < _POOR:
            radius = _POOR * step.length
        elif share > _GOOD:
            radius = max(radius, 2 * step.length)
    stop = f"the search did not end in {_EVALUATIONS} evaluations"
    return FitMinimum(*model.accepted[-1], (low < x) & (x < high), stop)


def _step(jacobian: Array, residuals: Array, x: Array, bounds: Array, radius: float) -> _Step:
    """The step that lowers the cost most within the radius, as long as the bounds of x (2, F) let it go.

    A parameter at a bound that the step would pass stays there.
    """
    low, high = bounds
    gradient = jacobian.T @ residuals
    free = ~((x <= low) & (gradient >= 0) | (x >= high) & (gradient <= 0))
    while True:
        columns = decomposition(jacobian, free)
        move = _within(columns, residuals, radius)
        passes = free & ((x <= low) & (move < 0) | (x >= high) & (move > 0))
        if not passes.any():
            break
        free &= ~passes
    room = np.where(move < 0, low - x, high - x) / np.where(move == 0, 1.0, move)
    move = move * min(1.0, np.min(room, where=move != 0, initial=1.0))
    change = jacobian @ move
    return _Step(move, float(np.linalg.norm(move * columns.norms)), float(-gradient @ move - change @ change / 2))


def _within(columns: Decomposition, residuals: Array, radius: float) -> Array:
    """The step (F,) of least squares that is no longer than the radius, in units of the norms of the columns."""
    sizes, part = columns.sizes[: columns.rank], columns.left[:, : columns.rank].T @ residuals

    def parts(damping: float) -> Array:
        return sizes * part / (sizes**2 + damping)

    damping = 0.0
    if np.linalg.norm(parts(0.0)) > radius:
        top = float(np.linalg.norm(sizes * part)) / radius  # beyond it every step is shorter
        damping = brentq(lambda damping: float(np.linalg.norm(parts(damping))) - radius, 0.0, top)
    move = np.zeros(columns.active.size)
    move[columns.active] = -(columns.right[: columns.rank].T @ parts(damping)) / columns.norms[columns.active]
    return move
