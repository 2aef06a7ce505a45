"""The lines of a diagram of branches: their parts, whether one lies on another, and smooth curves through points."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator, CubicSpline

BETWEEN = 8  # places on a smooth line between two points
SAME = 0.008  # of a panel: lines that are nearer are drawn once
Values = NDArray[np.float64]


def parts(points: Any, count: bool) -> list[Any]:
    """The stretches of points (n, 2) that have numbers, one after the other; of a count those of one number each, as
    nobody knows where between two points it changes."""
    known = np.isfinite(points).all(axis=1)
    ends = np.diff(known) | (count & (np.abs(np.diff(points[:, 1])) > 0))
    stretches = np.split(np.arange(len(points)), np.flatnonzero(ends) + 1)
    return [points[stretch] for stretch in stretches if stretch.size and known[stretch[0]]]


def lies_on(line: Any, other: Any) -> bool:
    """Whether each point of a line (n, 2), in shares of the panel, is nearer than `SAME` to another line."""
    if len(line) < 2 or len(other) < 2 or (line.min(axis=0) < other.min(axis=0) - SAME).any():
        return False
    if (line.max(axis=0) > other.max(axis=0) + SAME).any():
        return False
    first, along = other[:-1], np.diff(other, axis=0)
    length2 = np.maximum((along**2).sum(axis=1), 1e-300)
    share = np.clip(((line[:, None] - first) * along).sum(axis=2) / length2, 0, 1)
    apart = np.linalg.norm(line[:, None] - first - share[:, :, None] * along, axis=2)
    return bool((apart.min(axis=1) < SAME).all())


def smooth(x: Any, y: Any, shares: Any) -> tuple[Values, Values]:
    """Places on a smooth curve through points, all the points among them.

    Parameters
    ----------
    x, y
        The points in their order, (n,) each.
    shares
        The same points, (n, 2), in units in which both directions are drawn equally large.

    Returns
    -------
    Two arrays, x and y; the points themselves where they are fewer than three.
    """
    kept = np.append(True, np.linalg.norm(np.diff(shares, axis=0), axis=1) > 1e-9)
    x, y, shares = x[kept], y[kept], shares[kept]
    if x.size < 3:
        return x, y
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(shares, axis=0), axis=1)))
    points = np.stack([x, y], axis=1)
    curve = Akima1DInterpolator(along, points, method="makima") if x.size > 4 else CubicSpline(along, points)
    parts = np.linspace(0.0, 1.0, BETWEEN + 1)[:-1]
    places = np.append((along[:-1, None] + parts * np.diff(along)[:, None]).ravel(), along[-1])
    line = curve(places)
    return line[:, 0], line[:, 1]
