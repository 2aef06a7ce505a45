"""Lines in the colours of the push along a rod, and the bar of these colours; see `colours`."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, QuadMesh
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Normalize
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ..words import labels
from ..words.caution_words import SLIGHT
from ..words.unit_habits import plain, size_shown, unit_shown
from . import canvas, colours, fonts, waves
from .drawn_numbers import CASING

PUSHES, PULLS = "the cylinder pushes", colours.LIFTS  # in a legend
OFF_WALL: dict[str, Any] = {  # a line upon that of the rod where no wall pushes it
    "color": colours.LIGHTEST,
    "label": "off the wall",
    "gid": "off the wall",
    "path_effects": [withStroke(linewidth=2.4, foreground=colours.SOFT)],
}
ON_WALL = "on the wall"  # of a line in one colour, in a legend
TOUCH: dict[str, Any] = {  # upon the line of a rod where the wall touches it at one place
    "color": colours.DATA,
    "marker": "o",
    "markersize": 3.0,
    "markeredgewidth": 0,
    "linestyle": "none",
    "label": "touches the wall at one place",
}
WIDEST, HIGH = 2.2, 0.11  # inches of a bar of colours
EDGE, LEAST = 1.2, 0.35  # the grey casing of a line: share of its width, and points that it adds at least
THIN = 0.4  # of the width of a line, where the rod would lift off; where nothing pushes, its casing alone


def scale(pushes: Sequence[Any]) -> Normalize:
    """The scale of colours that the pushes of several rods share, as far below 0 as above it."""
    ends = [(float(np.min(push)), float(np.max(push))) for push in pushes] or [(0.0, 0.0)]
    end = colours.push_scale(min(low for low, _ in ends), max(high for _, high in ends))[1] or 1.0
    return Normalize(-end, end)


def away_from_ends(push: Any) -> Any:
    """The pushes (n,) of a pipe from the first least one at each end on: before it the push of a clamp dies away.

    All where that is not the larger part of the pipe.
    """
    first, last = (int(np.argmin(np.append(np.diff(way) < 0, False))) for way in (push, push[::-1]))
    inner = push[first : push.size - last]
    return inner if 2 * inner.size > push.size else push


def line(
    ax: Axes,
    x: Any,
    y: Any,
    push: Any,
    norm: Normalize,
    width: float = 2.0,
    name: str = "",
    where: Any = None,
    order: float = 2.0,
    inches: float = np.inf,
) -> list[str]:
    """Draw a line whose colour at each point is that of the push there; returns what is to be said of its bands.

    The line is thin where the rod would lift off, and thin and grey where there is no push: its form says the sign too.

    name: its own in a table. where: its transform; order: of drawing. inches: of a unit of x. A band of the push itself
    has the colours of its heights, another one has none.
    """
    ramp = colours.push_ramp()
    place: dict[str, Any] = {"zorder": order, "transform": where or ax.transData, "snap": False}  # both at one height
    points: NDArray[np.float64] = np.column_stack([x, y])
    middles = (points[1:] + points[:-1]) / 2
    before, after = np.vstack([points[:1], middles]), np.vstack([middles, points[-1:]])
    segments, shades = np.stack([before, points, after], axis=1), np.asarray(push, dtype=float)
    thin = pulls(shades) | (shades == 0)
    widths = width * np.where(thin, THIN, 1.0)

    def paint(of: slice) -> None:
        for wide in np.unique(widths[of]):
            points = np.where((widths[of] == wide)[:, None, None], segments[of], np.nan).reshape(-1, 2)
            ax.plot(*points.T, color=colours.SOFT, linewidth=max(wide * EDGE, wide + LEAST), solid_capstyle="round",
                    label=CASING, **place)  # fmt: skip
        inner = np.where(shades == 0, 0.0, widths)[of]
        drawn = LineCollection(list(segments[of]), cmap=ramp, norm=norm, linewidths=inner, gid=name, **place)
        drawn.set(array=shades[of], capstyle="round", joinstyle="round")
        ax.add_collection(drawn)

    def shade(height: float) -> Any:
        return ramp(norm(height))

    look = {"color": shade if y is push else colours.NEUTRAL, "gid": name}
    return waves.draw(ax, x, y, inches, look, where, order, line=paint)


def bar(ax: Axes, units: Mapping[str, str], inches: float, place: tuple[float, float] | None = None) -> None:
    """The bar of the colours of lines or rows on axes, at most so many inches wide; none without any.

    units: of the pushes. place: left and top of the bar, on axes whose units are inches; default: below the axes.
    """
    lines = [collection for collection in ax.collections if isinstance(collection, (LineCollection, QuadMesh))]
    if not lines:
        return
    wide, said = min(inches, WIDEST), ax.get_legend_handles_labels()[1]
    where: dict[str, Any] = {"location": "bottom", "anchor": (0.0, 1.0), "panchor": False, "fraction": 0.05,
                             "pad": 0.02, "aspect": 20, "shrink": wide / inches}  # fmt: skip
    if place is not None:
        box = (*place, wide, HIGH)
        where = {"orientation": "horizontal", "cax": ax.inset_axes(box, transform=ax.transData)}
    drawn = canvas.colour_bar([ax], in_habitual_unit(lines[-1].get_clim()[1] or 1.0, units), **where)
    words = trim(drawn, units, [line.get_array() for line in lines])
    if isinstance(lines[-1], LineCollection):
        words = words.replace("below 0", "below 0 (thin)")
        if OFF_WALL["label"] not in said and any((np.asarray(line.get_array()) == 0).any() for line in lines):
            words += "; grey: no push"
    if fonts.width_of(words, fonts.small()) > inches:
        words = "\n".join(fonts.break_lines(part, inches, fonts.small()) for part in words.split("; "))
    drawn.set_label(words, size=fonts.small(), loc="left")


def trim(drawn: Colorbar, units: Mapping[str, str], pushes: Sequence[Any]) -> str:
    """Cut the half of a bar where none of these pushes is; returns what its colours are called."""
    end = float(drawn.norm.vmax or 0.0)
    low = -end if any(pulls(push).any() for push in pushes) else 0.0
    drawn.ax.set_xlim(low, end)
    strongest = max((size(units) * float(abs(push).max()) for push in pushes), default=0.0)
    beyond = f"; next to an end up to {plain(strongest, 2)}" if strongest > end * (1 + colours.ROUNDING) else ""
    return colours.push_words(unit(units), low) + beyond


def pulls(push: Any) -> NDArray[np.bool_]:
    """Where the cylinder would have to pull by more than rounding, (n,)."""
    return np.asarray(push < -SLIGHT * np.abs(push).max())


def unit(units: Mapping[str, str]) -> str:
    """The unit in which a push is written: ``lbf/ft`` where lengths are in ft and forces in klbf."""
    return labels.unit(unit_shown("push_max", units))


def size(units: Mapping[str, str]) -> float:
    """How many of the unit in which a push is written are one of the unit of a case."""
    return size_shown("push_max", units)


def in_habitual_unit(end: float, units: Mapping[str, str]) -> ScalarMappable:
    """The colours of pushes up to an end of their scale, whose numbers are in the unit in which a push is written."""
    end = size(units) * end
    return ScalarMappable(Normalize(-end, end), colours.push_ramp())
