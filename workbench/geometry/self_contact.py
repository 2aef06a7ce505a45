"""Whether a rod can be a solid body: no bend tighter than its own radius, and no self-contact."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from solver.problem.errors import InputError

from .centreline import Array, Centreline

MOST = 400_000  # points along the rod; some 300 MB of pairs
CLOSED = 1e-3  # radii between the ends of a closed rod, at most
APART = np.pi  # radii along the rod: nearer points are close as neighbours in a bend, not in self-contact


@dataclass(frozen=True)
class Finding:
    """What keeps a rod from being a solid.

    tight: kappa a >= 1 somewhere, so that no tube exists; else the rod passes through itself. sentence: what and where.
    """

    tight: bool
    sentence: str


def findings(line: Centreline, unit: str) -> list[Finding]:
    """What keeps the rod from being a solid; empty for a solid. Raises `InputError` for a rod too long to test."""
    step = line.a / 4
    count = int(np.ceil(line.L / step)) + 1
    if count > MOST:
        longest = MOST * step
        raise InputError(
            f"a rod of length {line.L:g} {unit} and radius {line.a:g} {unit} is too long to test for self-contact; "
            f"at most {longest:g} {unit} of it can be exported as a body"
        )
    s = np.linspace(line.s[0], line.s[-1], max(count, 8 * line.s.size))
    kappa = line.kappa(s)
    found = []
    k = int(np.argmax(kappa))
    if kappa[k] * line.a >= 1:
        bend = f"the rod bends with a radius of {1 / kappa[k]:.4g} {unit} at s = {s[k]:.4g} {unit}"
        found.append(Finding(True, f"{bend}, less than its own radius a = {line.a:g} {unit} (kappa a >= 1)"))
    nearest = _nearest(line, np.linspace(line.s[0], line.s[-1], count))
    if nearest is not None:
        gap, one, other = nearest
        turns = f"the rod passes through itself: at s = {one:.4g} and s = {other:.4g} {unit} its centreline is"
        found.append(Finding(False, f"{turns} {gap:.4g} {unit} apart, less than 2 a = {2 * line.a:g} {unit}"))
    return found


def places(line: Centreline, span: tuple[float, float], most: int = 40) -> list[Array]:
    """The middles of the places where the rod passes through itself, (3,) each [length], the deepest first.

    Of a rod too long to test (`MOST`) none.
    """
    s = np.linspace(*span, int(np.ceil(4 * (span[1] - span[0]) / line.a)) + 1)
    if s.size > MOST:
        return []
    points, pairs = _close(line, s)
    gaps = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=-1)
    deep = gaps < 2 * line.a * (1 - 1e-3)
    pairs, gaps = pairs[deep], gaps[deep]
    found: list[Array] = []
    while len(pairs) and len(found) < most:
        i, j = pairs[np.argmin(gaps)]
        middle = (points[i] + points[j]) / 2
        found.append(middle)
        far = np.linalg.norm((points[pairs[:, 0]] + points[pairs[:, 1]]) / 2 - middle, axis=-1) > 2.5 * line.a
        pairs, gaps = pairs[far], gaps[far]
    return found


def _close(line: Centreline, s: Array) -> tuple[Array, Any]:
    """Points of the centreline, and the pairs of them that are not neighbours and about 2 a apart or less, (n, 2).

    The two ends of a closed rod are neighbours.
    """
    points = line.frame(s)[0]
    pairs = cKDTree(points).query_pairs(2 * line.a + (s[1] - s[0]), output_type="ndarray")
    away = np.abs(s[pairs[:, 0]] - s[pairs[:, 1]])
    if float(np.linalg.norm(points[-1] - points[0])) < CLOSED * line.a:
        away = np.minimum(away, s[-1] - s[0] - away)
    return points, pairs[away > APART * line.a]


def _nearest(line: Centreline, s: Array) -> tuple[float, float, float] | None:
    """The least distance of two points that are not neighbours, and their s, where it is less than 2 a; else None."""
    h = s[1] - s[0]
    points, pairs = _close(line, s)  # a pair may lie between two samples
    if not len(pairs):
        return None
    gaps = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=-1)
    i, j = np.sort(pairs[np.argmin(gaps)])
    near = [np.linspace(max(s[k] - h, s[0]), min(s[k] + h, s[-1]), 201) for k in (i, j)]
    gap = cdist(line.frame(near[0])[0], line.frame(near[1])[0])
    p, q = np.unravel_index(np.argmin(gap), gap.shape)
    return (float(gap[p, q]), float(near[0][p]), float(near[1][q])) if gap[p, q] < 2 * line.a * (1 - 1e-9) else None
