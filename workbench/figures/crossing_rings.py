"""The rings of places where rods pass through themselves, the same in all pictures."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.lines import Line2D

from .colours import CROSSED

RING, CROWDED = 1.2, 1.35  # points, the line of a ring; between the middles of two rings, in the size of one


def entry(label: str) -> Line2D:
    """The entry of a legend for the rings of `draw`."""
    return Line2D([], [], marker="o", markersize=7, fillstyle="none", color=CROSSED, linestyle="none", label=label)


def draw(ax: Axes, places: Any, sizes: Any, name: str) -> PathCollection:
    """Ring the places (n, 2) where rods pass through themselves: open circles, which do not cover what they mark.

    Of rings whose middles are nearer than `CROWDED` the smallest one is drawn. The units of the axes are inches. sizes:
    (n,), points across. name: theirs in a table. Returns what is drawn.
    """
    places, sizes = np.asarray(places, dtype=float), np.asarray(sizes, dtype=float)
    kept: list[int] = []
    for k in np.argsort(sizes, kind="stable"):
        if all(np.hypot(*(places[k] - places[i])) >= CROWDED * (sizes[k] + sizes[i]) / 2 / 72 for i in kept):
            kept.append(k)
    x, y = places[kept].T
    return ax.scatter(x, y, s=np.square(sizes[kept]), facecolors="none", edgecolors=CROSSED, linewidths=RING, gid=name,
                      zorder=5, clip_on=False)  # fmt: skip
