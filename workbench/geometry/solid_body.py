"""Whether a rod can be a solid body: no bend tighter than its own radius, and no self-contact."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, make_interp_spline
from scipy.spatial.distance import cdist

from solver.core.measures import crossings
from solver.problem.errors import InputError

from .centreline import Array, Centreline

LONGEST = 1e5  # radii of a rod that is tested
CLOSED = 1e-3  # radii between the ends of a closed rod, at most
DENSE = 8  # points for each radius of the rod, as on the live page: of overlaps one after the other fewer find others
CROSSED = 0.2  # radii between two stretches of a centreline that crosses itself: more than the points are apart
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
    longest = LONGEST * line.a
    if longest < line.L:
        raise InputError(
            f"a rod of length {line.L:g} {unit} and radius {line.a:g} {unit} is too long to test for self-contact; "
            f"at most {longest:g} {unit} of it can be exported as a body"
        )
    s = np.linspace(line.s[0], line.s[-1], max(count, 8 * line.s.size))
    kappa = line.kappa(s)
    faults = []
    k = int(np.argmax(kappa))
    if kappa[k] * line.a >= 1:
        bend = f"the rod bends with a radius of {1 / kappa[k]:.4g} {unit} at s = {s[k]:.4g} {unit}"
        faults.append(Finding(True, f"{bend}, less than its own radius a = {line.a:g} {unit} (kappa a >= 1)"))
    nearest = _nearest(line, np.linspace(line.s[0], line.s[-1], count))
    if nearest is not None:
        gap, first, second = nearest
        turns = f"the rod passes through itself: at s = {first:.4g} and s = {second:.4g} {unit} its centreline is"
        faults.append(Finding(False, f"{turns} {gap:.4g} {unit} apart, less than 2 a = {2 * line.a:g} {unit}"))
    return faults


def places(s: Array, points: Array, a: float) -> list[tuple[float, float]] | None:
    """The places where two stretches of a rod overlap: of each the two arc lengths whose points are nearest.

    Where the centreline crosses itself is a place, also where one overlap joins it to another one. A bend tighter than
    the rod is thick (kappa a >= 1) overlaps in itself: its tightest point, twice, unless that is nearer than 2 a to the
    middle of another place, which it then is a part of.

    Parameters
    ----------
    s : array (n,)
        Arc length, rising [length].
    points : array (n, 3)
        The centreline there [length].
    a : float
        Radius of the rod [length].

    Returns
    -------
    list of (s, s)
        The smaller arc length first, in rising order; None for a rod longer than `LONGEST`.
    """
    if s[-1] - s[0] > LONGEST * a:
        return None
    at = np.linspace(s[0], s[-1], int(np.ceil(DENSE * (s[-1] - s[0]) / a)) + 1)
    curve = CubicSpline(s, points)(at)
    pairs = {(int(i), int(j)) for near in (2 * a, CROSSED * a) for j, i in _pairs(at, curve, a, near)}
    kappa = np.linalg.norm(make_interp_spline(s, points, k=5)(at, 2), axis=-1)
    is_tight = np.concatenate([[False], kappa * a >= 1, [False]])
    strands = [(curve[i] + curve[j]) / 2 for i, j in pairs]
    for begin, end in np.flatnonzero(np.diff(is_tight)).reshape(-1, 2):
        k = begin + int(np.argmax(kappa[begin:end]))
        if all(np.linalg.norm(curve[k] - place) >= 2 * a for place in strands):
            pairs.add((k, k))
    return sorted((float(at[i]), float(at[j])) for i, j in pairs)


def middles(line: Centreline, span: tuple[float, float]) -> list[Array]:
    """The middles of the places between two arc lengths where the rod passes through itself, (3,) each [length]."""
    s = np.linspace(*span, 4 * line.s.size)
    pairs = places(s, line.frame(s)[0], line.a) or []
    return [np.asarray(line.frame(np.array(pair))[0].mean(axis=0)) for pair in pairs]


def _pairs(s: Array, points: Array, a: float, near: float) -> Any:
    """The places where points (n, 3) at s come nearer than `near` along a rod of radius a: (m, 2), the later first."""
    is_closed = float(np.linalg.norm(points[-1] - points[0])) < CLOSED * a
    return crossings(s, points, near, APART * a, s[-1] - s[0] if is_closed else np.inf)


def _nearest(line: Centreline, s: Array) -> tuple[float, float, float] | None:
    """The least distance of two points that are not neighbours, and their s, where it is less than 2 a; else None."""
    h = s[1] - s[0]
    points = line.frame(s)[0]
    pairs = _pairs(s, points, line.a, 2 * line.a + h)  # a pair may lie between two samples
    if not len(pairs):
        return None
    gaps = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=-1)
    j, i = pairs[np.argmin(gaps)]
    near = [np.linspace(max(s[k] - h, s[0]), min(s[k] + h, s[-1]), 201) for k in (i, j)]
    gap = cdist(line.frame(near[0])[0], line.frame(near[1])[0])
    p, q = np.unravel_index(np.argmin(gap), gap.shape)
    return (float(gap[p, q]), float(near[0][p]), float(near[1][q])) if gap[p, q] < 2 * line.a * (1 - 1e-9) else None
