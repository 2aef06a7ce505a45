"""The rings of places where rods pass through themselves, the same in all pictures."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.lines import Line2D
from scipy.spatial import cKDTree

from .colours import CROSSED
from .halo import Halo

RING, EDGED = 1.2, 1.9  # points, the line of a ring at most, without and with its pale edges
THIN = 4.0  # a smaller ring has a line so many times thinner than it is wide
CROWDED = 1.15  # between the middles of two rings, in the size of one
RADII, IN_RODS = (0.03, 0.065), 0.75  # inches of a ring on a rod in space at least and at most; else radii of its rod
SMALLEST = 3.0  # points of a ring around a line, and of one around two more than they are apart


def entry(label: str) -> Line2D:
    """The entry of a legend for the rings of `draw`."""
    return Line2D(
        [],
        [],
        marker="o",
        markersize=7,
        fillstyle="none",
        color=CROSSED,
        linestyle="none",
        label=label,
        markeredgewidth=RING,
    )


def radius(a: float) -> float:
    """The radius of a ring on a rod in space whose radius is drawn so many inches large [inches]."""
    return float(np.clip(IN_RODS * a, *RADII))


def draw(ax: Axes, places: Any, sizes: Any, name: str, **look: Any) -> PathCollection:
    """Ring the places (n, 2) where rods pass through themselves: open circles, which do not cover what they mark, with
    a pale edge, as rods are dark in places. Returns them.

    Rings are smaller where they would touch their neighbours; of the smallest that still would one is drawn. The units
    of the axes are inches. sizes: (n,), points across. name: theirs in a table. look: of `Axes.scatter`, as a transform
    from inches.
    """
    places, sizes = np.asarray(places, dtype=float), np.asarray(sizes, dtype=float)
    if len(places) > 1:
        nearest = cKDTree(places).query(places, k=2)[0][:, 1]
        sizes = np.clip(72 * nearest / CROWDED, SMALLEST, sizes.clip(SMALLEST))
    kept: list[int] = []
    for k in np.argsort(sizes, kind="stable"):
        if all(np.hypot(*(places[k] - places[i])) >= CROWDED * (sizes[k] + sizes[i]) / 2 / 72 - 1e-9 for i in kept):
            kept.append(k)
    x, y = places[kept].T
    widths = np.minimum(RING, sizes[kept] / THIN)
    look = {"zorder": 5, "path_effects": [Halo(EDGED)], **look}
    return ax.scatter(x, y, s=np.square(sizes[kept]), facecolors="none", edgecolors=CROSSED, linewidths=widths,
                      gid=name, clip_on=False, **look)  # fmt: skip
