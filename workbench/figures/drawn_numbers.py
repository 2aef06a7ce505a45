"""What a figure shows, as a table: the points of its lines and dots, its bars, and the values of its coloured cells.

The numbers are in the units of the axis labels. Marks that say where something is, and not what (grid lines, legends,
hatching, the tube of a scene), are left out.
"""

import csv
from collections.abc import Iterator
from io import StringIO
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import LineCollection, PathCollection, QuadMesh
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..words import labels
from . import canvas
from .trends import CHANGE

CASING = "_casing"  # the label of the grey casing of a coloured line
COLUMNS = ("panel", "x_label", "y_label", "kind", "series", "x", "y", "value")


def table(fig: Figure) -> str:
    """The table as CSV: a row for each point, bar and cell, with `COLUMNS`; `value` is that of its colour.

    Of a bar, `value` is where it begins; its series is the name at its foot.

    Sentences of the caption are rows of the kind `note`, as their series.
    """
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    shown = [ax for ax in fig.axes if ax.get_label() != "<colorbar>"]
    for number, ax in enumerate(shown, 1):
        title = ax.get_title(loc="left") or ax.get_label() or ax.get_title()
        head = f"{number} {_one_line(str(title))}".strip()
        named = head, _one_line(ax.get_xlabel()), _one_line(ax.get_ylabel())
        writer.writerows((*named, *row) for row in rows(ax))
    writer.writerows(("", "", "", "note", note, "", "", "") for note in canvas.caption(fig))
    return text.getvalue()


def rows(ax: Axes) -> Iterator[tuple[str, str, Any, Any, Any]]:
    """Kind, series, x, y and value of each point and each cell of one panel; a point without a number is left out.

    A line that is drawn at an offset has its own numbers here.
    """
    lines = [line for line in ax.lines if line.get_transform().contains_branch(ax.transData) and not _is_mark(ax, line)]
    for k, line in enumerate(lines, 1):
        points = np.column_stack([np.asarray(line.get_xdata(), dtype=float), np.asarray(line.get_ydata(), dtype=float)])
        for x, y in points[np.isfinite(points).all(axis=1)].tolist():
            yield "line", _label(line, k), x, y, ""
    for k, coloured in enumerate(
        (collection for collection in ax.collections if isinstance(collection, LineCollection)), 1
    ):
        array = coloured.get_array()
        shades = [] if array is None else np.asarray(array, dtype=float).tolist()
        for points, shade in zip(coloured.get_segments() if shades else [], shades, strict=True):
            x, y = np.asarray(points)[len(points) // 2].tolist()
            yield "line", _label(coloured, k), x, y, shade
    dots = [dot for dot in ax.collections if isinstance(dot, PathCollection)]
    for k, dot in enumerate(dots, 1):
        offsets: Any = np.ma.getdata(dot.get_offsets()).astype(float)
        for x, y in offsets[np.isfinite(offsets).all(axis=1)].tolist():
            yield "dot", _label(dot, k), x, y, ""
    for bars in (container for container in ax.containers if isinstance(container, BarContainer)):
        lies = bars.orientation == "horizontal"
        for bar in bars.patches:
            (left, low), (right, high) = bar.get_bbox().get_points()
            foot, begin, end = ((low + high) / 2, left, right) if lies else ((left + right) / 2, low, high)
            begin, end = (begin, end) if (bar.get_width() if lies else bar.get_height()) >= 0 else (end, begin)
            name = " ".join(filter(None, (_name_at(ax.yaxis if lies else ax.xaxis, foot), bar.get_gid())))
            yield "bar", name, *((end, foot) if lies else (foot, end)), begin
    for k, mesh in enumerate((collection for collection in ax.collections if isinstance(collection, QuadMesh)), 1):
        corners: Any = mesh.get_coordinates()
        values: Any = np.ma.asarray(mesh.get_array())
        middles = (corners[1:, 1:] + corners[:-1, :-1]) / 2
        for (x, y), value in zip(middles.reshape(-1, 2).tolist(), values.ravel().filled(np.nan).tolist(), strict=True):
            yield "cell", _label(mesh, k), x, y, "" if np.isnan(value) else value


def _name_at(axis: Axis, place: float) -> str:
    """The words of the tick nearest to a place, within half a unit."""
    apart = [abs(tick - place) for tick in axis.get_ticklocs()]
    near = int(np.argmin(apart)) if apart else -1
    return _one_line(axis.get_ticklabels()[near].get_text()) if apart and apart[near] <= 0.5 else ""


def _is_mark(ax: Axes, line: Line2D) -> bool:
    """Whether it is a line across the whole panel, which marks one value, a bracket or step between two values, or the
    casing of a coloured line."""
    across = line.get_transform() in (ax.get_xaxis_transform("grid"), ax.get_yaxis_transform("grid"))
    return across or line.get_gid() == CHANGE or line.get_label() in (CASING, "_samples")


def _label(artist: Any, number: int) -> str:
    """The name of an artist, by default its label, or else its number."""
    label = str(artist.get_gid() or artist.get_label())
    return str(number) if label.startswith("_") or not label else _one_line(label)


def _one_line(text: str) -> str:
    return " ".join(labels.plain(text).split())
