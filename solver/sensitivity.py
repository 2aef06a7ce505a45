"""How an orbit answers to a change of its start, from the transfers of its panels: the condition number.

A change of the start grows along the way to a turning point as the 2x2 transfers of eta'' = -H'(beta) eta say; what
comes after follows from the symmetry of the orbit about its turning points and from d(period)/d(level), so a rod of a
million bends is again no more work than one of three.
"""

import numpy as np

from .course import HELIX, LIBRATION, ROTATION, Course
from .growth import steps
from .landscape import slope, slope_rate
from .panels import Panels
from .reduced import Array, Reduced


def condition(problem: Reduced, way: Course, panels: Panels, since: Array, first: Array, count: Array, duration: Array) -> Array:
    """Largest growth along the rod of a change of beta(0) or beta_t(0), each counted over max(1, its size), (B,).

    `since`, `first`, `count`, `duration`: as in `methods.orbit.Orbit`.
    """
    assert problem.dbeta0 is not None
    v0, span = problem.dbeta0, problem.span
    sizes = np.maximum(1, np.abs(np.stack([problem.beta0, v0], axis=1)))
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        still = _helix(problem) * sizes.max(axis=1)
        if not panels.part.size:
            return np.maximum(1, still)
        transfer, clock, entry, exit_ = _transfers(problem, panels, since, first, count)
        visited = clock <= np.repeat(span, 2)[panels.part, None]
        visited[first[count > 0], 0] = True
        size = np.abs(transfer[..., 0, :])
        size[panels.part % 2 == 1] *= 1.0
        along = np.where(visited[..., None], size, 0).max(axis=1)
        worst = np.zeros((2 * problem.size, 2))
        np.maximum.at(worst, panels.part, np.nan_to_num(along, nan=np.inf))
        worst = worst.reshape(-1, 2, 2)
        there, back = duration[0::2], duration[1::2]
        out = worst[:, 0]
        # beyond a turning point: the way so far reflected, and every swing late by d(duration)/d(level)
        pull = slope(problem, problem.beta0)
        gradient = 2 * np.stack([pull, v0], axis=1)
        unit = gradient / np.maximum((gradient**2).sum(axis=1), 1e-300)[:, None]
        folded = way.kind == LIBRATION
        late = np.stack([_late(problem, panels, first, count, exit_, part, unit) for part in (0, 1)], axis=1)
        swings = np.where(folded, np.ceil(np.maximum(span - there, 0) / np.maximum(there + back, 1e-300)), 0)
        rounds = np.where(way.kind == ROTATION, np.floor(span / np.maximum(there, 1e-300)), 0)
        delay = np.where(
            folded,
            np.where(swings > 0, 2 * np.abs(late[:, 0]), 0) + np.maximum(swings - 1, 0) * np.abs(late.sum(axis=1)),
            rounds * np.abs(_delay_of_round(exit_[0::2], unit, v0)),
        )
        fastest = _fastest_after(panels, since, duration, span)
        beyond = (delay * fastest)[:, None] * np.abs(gradient) + np.where((swings > 0)[:, None], out, 0)
        beyond = np.where((swings > 1)[:, None], np.maximum(beyond, worst[:, 1]), beyond)
        total = (np.maximum(out, beyond) * sizes).max(axis=1)
    total = np.where(way.kind == HELIX, still, np.where(np.isnan(total), np.inf, total))
    return np.maximum(1, total)


def _helix(problem: Reduced) -> Array:
    """Growth about a constant angle: bounded about a centre, exponential about a saddle, (B,)."""
    diagonal, upper, _ = steps(problem, problem.span, problem.beta0)
    rate = slope_rate(problem, problem.beta0)
    swing = np.minimum(1 / np.sqrt(np.maximum(rate, 1e-300)), problem.span)
    return np.maximum(1, np.where(rate > 0, swing, np.maximum(np.abs(diagonal), np.abs(upper))))


def _transfers(problem: Reduced, panels: Panels, since: Array, first: Array, count: Array) -> tuple[Array, Array, Array, Array]:
    """Transfers from the start to each substep (P, k, 2, 2), their times (P, k), and those to the end of each part."""
    pieces = panels.middles.shape[1]
    dt = (panels.duration / pieces)[:, None]
    at = problem.take(panels.part // 2)
    loads = Reduced(*(v[:, None] for v in (at.lam, at.mu, at.phi, at.span, at.beta0)))
    diagonal, upper, lower = steps(loads, dt, panels.middles)
    step = np.stack([np.stack([diagonal, upper], -1), np.stack([lower, diagonal], -1)], -2)
    for k in range(1, pieces):
        step[:, k] = step[:, k] @ step[:, k - 1]
    # the backward course starts with the opposite slope
    so_far = np.broadcast_to(np.eye(2), (count.size, 2, 2)).copy()
    so_far[1::2, 1, 1] = -1
    entry = np.empty((panels.part.size, 2, 2))
    for j in range(int(count.max(initial=0))):
        parts = np.flatnonzero(count > j)
        index = first[parts] + j
        entry[index] = so_far[parts]
        so_far[parts] = step[index, -1] @ so_far[parts]
    clock = since[:, None] + dt * np.arange(pieces)
    return step @ entry[:, None], clock, entry, so_far


def _late(problem: Reduced, panels: Panels, first: Array, count: Array, exit_: Array, part: int, unit: Array) -> Array:
    """d(time to the turning point)/d(level), (B,): the slope there, over the pull that ends it."""
    index = np.maximum(first[part::2] + count[part::2] - 1, 0)
    turn = panels.series[index, 0].sum(axis=1)
    pull = slope(problem, turn)
    change = np.einsum("bj,bj->b", exit_[part::2, 1, :], unit)
    return np.where(count[part::2] > 0, change / pull * 1.0, 0.0)


def _delay_of_round(exit_: Array, unit: Array, v0: Array) -> Array:
    return np.einsum("bj,bj->b", exit_[:, 0, :], unit) / v0


def _fastest_after(panels: Panels, since: Array, duration: Array, span: Array) -> Array:
    """Largest |beta_t| on what the rod covers after its first turning point (or from the start, in a rotation), (B,)."""
    there, back = duration[0::2], duration[1::2]
    left = np.where(back + there > 0, span - there, 0)
    b = panels.part // 2
    reached = np.where(panels.part % 2 == 0, since + panels.duration > (there - left)[b], left[b] > there[b])
    out = np.zeros(span.size)
    np.maximum.at(out, b, np.where(reached, panels.fastest, 0))
    return out
