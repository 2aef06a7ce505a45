"""A smooth line through the points of a curve that was followed in steps, so that it shows no corners."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator, CubicSpline

BETWEEN = 8  # places between two points

Values = NDArray[np.float64]


def through(x: Any, y: Any, shares: Any) -> tuple[Values, Values]:
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
    x, y, shares = (np.asarray(values, dtype=float) for values in (x, y, shares))
    kept = np.append(True, np.linalg.norm(np.diff(shares, axis=0), axis=1) > 1e-9)
    x, y, shares = x[kept], y[kept], shares[kept]
    if x.size < 3:
        return x, y
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(shares, axis=0), axis=1)))
    both = np.stack([x, y], axis=1)
    curve = Akima1DInterpolator(along, both, method="makima") if x.size > 4 else CubicSpline(along, both)
    parts = np.linspace(0.0, 1.0, BETWEEN + 1)[:-1]
    places = np.append((along[:-1, None] + parts * np.diff(along)[:, None]).ravel(), along[-1])
    found = curve(places)
    return found[:, 0], found[:, 1]
