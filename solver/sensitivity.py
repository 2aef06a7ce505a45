"""How an orbit answers to a change of its start: the condition number, from the transfers of its panels.

A small change grows on the way to a turning point as the 2x2 transfers of eta'' = -H'(beta) eta say; what comes after
follows from the symmetry of the orbit about its turning points and from d(period)/d(level), so a rod of a million
bends is again no more work than one of three. Good to a factor of about two, which is what a count of digits needs.
"""

from typing import Any

import numpy as np

from .course import HELIX, LIBRATION, Course
from .landscape import slope, slope_rate
from .panels import Panels
from .reduced import Array, Reduced

_MIRROR = np.diag([1.0, -1.0])


def condition(
    problem: Reduced, way: Course, panels: Panels, since: Array, first: Any, count: Any, duration: Array
) -> Array:
    """Largest |d beta/d beta(0)| and |d beta/d beta_t(0)| max(1, |beta_t(0)|) along the rod, at least 1, (B,).

    `since`, `first`, `count`, `duration` say when and where the panels of each part begin, as in `methods.orbit.Orbit`.
    """
    assert problem.dbeta0 is not None
    v0, span = problem.dbeta0, problem.span
    weight = np.stack([np.ones(v0.size), np.maximum(1, np.abs(v0))], axis=1)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        still = (_helix(problem) * weight).max(axis=1)
        if not panels.part.size:
            return np.maximum(1, still)
        b = panels.part // 2
        rows, clock, exits = _transfers(problem, panels, since, first, count)
        there, back = duration[0::2], duration[1::2]
        flow = np.stack([v0, -slope(problem, problem.beta0)], axis=1)
        turned, turned_back = (
            _reflection(problem, panels, first, count, exits, part, flow * [1 - 2 * part, 1]) for part in (0, 1)
        )
        half = _MIRROR @ turned
        folded = (way.kind == LIBRATION)[:, None, None]
        far = turned_back @ half
        whole = np.where(folded, _MIRROR @ far, exits[0::2])
        # each panel is met on the way out, and in a libration again on the way back
        out, back_again = np.empty((2, 2 * v0.size, 2, 2))
        out[0::2], out[1::2], back_again[0::2], back_again[1::2] = np.eye(2), half, turned, far
        begins, ends = np.zeros((2, 2 * v0.size))
        begins[1::2], ends[0::2] = 2 * there, 2 * there
        ends[1::2] = np.where(way.kind == LIBRATION, 2 * (there + back), np.inf)
        ends[0::2] = np.where(way.kind == LIBRATION, ends[0::2], np.inf)
        worst = np.zeros(weight.shape)
        part = panels.part
        for before, time in ((out, begins[part, None] + clock), (back_again, ends[part, None] - clock)):
            met = (time <= span[b][:, None])[..., None]
            size = np.where(met, np.abs(rows @ before[part]), 0).max(axis=1)
            np.maximum.at(worst, b, np.where(np.isnan(size), np.inf, size))
        # each whole period comes late by d(period)/d(level) once more
        gradient = np.stack([-flow[:, 1], v0], axis=1)
        steep = (flow**2).sum(axis=1) * (gradient**2).sum(axis=1)
        late = np.abs(np.einsum("bi,bij,bj->b", flow, whole - np.eye(2), gradient) / np.maximum(steep, 1e-300))
        period = np.where(folded[:, 0, 0], 2, 1) * (there + back)
        rounds = np.where(period > 0, np.floor(span / np.maximum(period, 1e-300)), 0)
        fastest = np.zeros(v0.size)
        np.maximum.at(fastest, b, panels.fastest)
        worst += np.where(rounds > 0, rounds * late * fastest, 0)[:, None] * np.abs(gradient)
        total = np.where(way.kind == HELIX, still, (worst * weight).max(axis=1))
    return np.maximum(1, np.where(np.isnan(total), np.inf, total))


def _helix(problem: Reduced) -> Array:
    """The two growths about a constant angle: bounded about a centre, exponential about a saddle, (B, 2)."""
    rate = slope_rate(problem, problem.beta0)
    root = np.sqrt(np.abs(rate))
    angle = root * problem.span
    swing = np.minimum(1 / np.maximum(root, 1e-300), problem.span)
    even = np.where(rate >= 0, 1, np.cosh(np.minimum(angle, 700)))
    return np.stack([even, np.where(rate >= 0, swing, np.sinh(np.minimum(angle, 700)) / np.maximum(root, 1e-300))], 1)


def _transfers(problem: Reduced, panels: Panels, since: Array, first: Any, count: Any) -> tuple[Array, Array, Array]:
    """First rows of the transfers from the start to each substep (P, k, 2), their times (P, k), and the transfers to
    the end of each part (parts, 2, 2). Each substep by the Magnus series to fourth order on two Gauss points."""
    pieces = panels.gauss.shape[1] // 2
    h = (panels.duration / pieces)[:, None]
    at = problem.take(panels.part // 2)
    loads = Reduced(*(v[:, None] for v in (at.lam, at.mu, at.phi, at.span, at.beta0)))
    rate = slope_rate(loads, panels.gauss)
    early, late = rate[:, 0::2], rate[:, 1::2]
    p, q = np.sqrt(3) / 12 * h * h * (late - early), -h / 2 * (early + late)
    square = p * p + h * q
    angle = np.sqrt(np.abs(square))
    grows = square > 0
    even = np.where(grows, np.cosh(np.minimum(angle, 700)), np.cos(angle))
    odd = np.where(grows, np.sinh(np.minimum(angle, 700)), np.sin(angle)) / np.where(angle > 0, angle, 1)
    odd = np.where(angle > 0, odd, 1)
    step = np.empty((*rate.shape[:1], pieces, 2, 2))
    step[..., 0, 0], step[..., 0, 1] = even + odd * p, odd * h
    step[..., 1, 0], step[..., 1, 1] = odd * q, even - odd * p
    for k in range(1, pieces):
        step[:, k] = step[:, k] @ step[:, k - 1]
    # chained from panel to panel, part by part; parts that have ended stand still
    part = panels.part
    rank = np.arange(part.size) - first[part]
    links = np.tile(np.eye(2), (count.size, int(count.max(initial=0)) + 1, 1, 1))
    links[part, rank + 1] = step[:, -1]
    for j in range(1, links.shape[1]):
        links[:, j] = links[:, j] @ links[:, j - 1]
    entry = links[part, rank]
    return step[..., 0, :] @ entry, since[:, None] + h * np.arange(1, pieces + 1), links[:, -1]


def _reflection(
    problem: Reduced, panels: Panels, first: Any, count: Any, exits: Array, part: int, flow: Array
) -> Array:
    """The change that, followed to the turning point and back, is the mirror of the one at the start, (B, 2, 2).

    A change along the flow returns with its sign turned; one that does not delay the turning point returns as it is.
    """
    last = np.maximum(first[part::2] + count[part::2] - 1, 0)
    pull = slope(problem, panels.series[np.minimum(last, panels.part.size - 1), 0].sum(axis=1))
    at_turn = exits[part::2, 1, :]
    out = np.eye(2) + 2 * flow[:, :, None] * (at_turn / pull[:, None])[:, None, :]
    # no way to go: the start is the turning point
    at_rest = np.eye(2) * [1.0, -1.0]
    return np.where((count[part::2] > 0)[:, None, None], out, at_rest)
