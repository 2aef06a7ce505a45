"""A frame with one developed curve that fills it, and a bar that shows its scale."""

from math import floor, log10
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from . import style

FILL, STRIP = 0.84, 0.16  # of the frame: what a curve fills, and the strip of the bar at its foot
BAR = 0.4  # of the width of the frame: the longest bar


def look(index: int) -> dict[str, Any]:
    """The look of a shape: thick where it is stable."""
    return {"color": style.INK, "linewidth": 1.1 if index else 2.4}


def draw(ax: Axes, curve: tuple[Any, Any], how: dict[str, Any], unit: str, title: str, below: str) -> None:
    """Draw a developed curve, rho alpha to the right and z up, at one scale for both; its start is a dot.

    Parameters
    ----------
    ax
        The frame; it becomes a square.
    curve
        rho alpha and z, (n,) each.
    how
        Colour and width of the curve.
    unit
        Of its lengths, as the bar names it.
    title, below
        Texts above and below the frame.
    """
    x, z = curve
    ax.plot(x, z, **how, solid_capstyle="round", solid_joinstyle="round", zorder=3)
    ax.plot(x[0], z[0], "o", color=style.INK, markersize=3, zorder=4)
    size = max(float(np.ptp(x)), float(np.ptp(z)) / (1 - STRIP), 1e-300) / FILL
    left, low = (x.max() + x.min() - size) / 2, (z.max() + z.min() - size * (1 + STRIP)) / 2
    ax.set(xlim=(left, left + size), ylim=(low, low + size), xticks=[], yticks=[], aspect="equal")
    bar(ax, size, unit)
    for spine in ax.spines.values():
        spine.set(visible=True, color=style.FAINT)
    ax.set_title(title, loc="left", size=style.small(), pad=3)
    ax.set_xlabel(below, size=style.small(), labelpad=2)


def round_length(most: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not more."""
    power = 10.0 ** floor(log10(most) + 1e-9)
    return max(digit * power for digit in (1, 2, 5) if digit * power <= most * (1 + 1e-9))


def bar(ax: Axes, size: float, unit: str) -> None:
    """A bar of a round length in the lower left corner of a frame that is so wide, with its length beside it."""
    length = round_length(BAR * size)
    begin, up = 0.06, 0.07
    ax.plot([begin, begin + length / size], [up, up], color=style.INK, linewidth=1.6, solid_capstyle="butt",
            transform=ax.transAxes, zorder=4)  # fmt: skip
    ax.annotate(f"{length:g} {unit}".strip(), (begin + length / size, up), (3, 0), xycoords="axes fraction",
                textcoords="offset points", va="center", size=style.small(), color=style.SOFT)  # fmt: skip
