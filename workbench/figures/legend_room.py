"""Legends that cover lines, points or words of their axes are put below them."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PathCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.path import Path
from matplotlib.transforms import Bbox, ScaledTranslation

from . import fonts

POINT = 2.0  # pixels by which a point reaches beyond its middle
HANDLE, GAP = 0.45, 0.1  # inches: of an entry beside its label; between columns of a legend
BROKEN = 0.75  # lines by which a legend is to be lower for each name that it breaks
BELOW = 0.06  # inches between the words of an axis and the legend below


def clear(fig: Figure) -> float:
    """Put each legend of axes that covers a line, a point or a word of them below the words of their axis.

    Returns the inches that the rows of these axes need for it.
    """
    legends = [(ax, legend) for ax in fig.axes if (legend := ax.get_legend()) is not None]
    if legends and (engine := fig.get_layout_engine()) is not None:
        engine.execute(fig)
    for _, legend in legends:
        legend.draw(_renderer(fig))  # which places its entries
    needed = dict[int, float]()  # by the lower edge of a row
    for ax, legend in [(ax, legend) for ax, legend in legends if _covers(ax, legend)]:
        row = round(ax.bbox.y0)
        needed[row] = max(needed.get(row, 0.0), BELOW + _move_below(fig, ax, legend))
    return sum(needed.values())


def legend_columns(names: Sequence[str], width: float, most: int = 2, handle: float = HANDLE) -> tuple[int, list[str]]:
    """The columns of a legend of one entry or more, and its names in lines, where it is lowest in so many inches.

    most: lines of a name in one of several columns; alone it takes as many as it needs. handle: inches of an entry
    beside its name.
    """
    size, tried = fonts.small(), []
    for columns in range(1, len(names) + 1):
        room = max((width + GAP) / columns - handle, 0.0)
        broken = [fonts.break_lines(name, room, size) for name in names]
        for written in (list(names), broken):
            lines = [name.count("\n") + 1 for name in written]
            across = sum(
                handle + max(fonts.width_of(name, size) for name in part)
                for part in np.array_split(np.array(written, dtype=object), columns)
            )
            if (max(lines) <= most and across <= width + GAP) or (columns == 1 and written is broken):
                high = lines_of(written, columns) + BROKEN * (sum(lines) - len(lines))
                tried.append((high, columns, written))
    return min(tried)[1:]


def lines_of(names: Sequence[str], columns: int) -> int:
    """The lines of the highest of so many columns of a legend."""
    return max(sum(name.count("\n") + 1 for name in part) for part in np.array_split(np.array(names, object), columns))


def _renderer(fig: Figure) -> Any:
    assert isinstance(fig.canvas, FigureCanvasAgg)
    return fig.canvas.get_renderer()


def _covers(ax: Axes, legend: Legend) -> bool:
    parts = [*legend.get_texts(), *(handle for handle in legend.legend_handles if handle is not None)]
    boxes = [part.get_window_extent() for part in parts]
    box = Bbox.union([each for each in boxes if np.isfinite(each.extents).all()])  # that of a dot is not known
    words = [text.get_window_extent() for text in ax.texts]
    return any(map(box.overlaps, words)) or any(path.intersects_bbox(box, filled=False) for path in _paths(ax))


def _paths(ax: Axes) -> Iterator[Path]:
    """The lines of axes, the outlines of their bands, and a stroke through each of their points, in pixels."""
    for line in ax.lines:
        if line.get_linestyle() != "None":
            yield line.get_transform().transform_path(line.get_path())
    for band in ax.collections:
        if isinstance(band, PolyCollection):
            yield from map(band.get_transform().transform_path, band.get_paths())
    marked = [(line.get_transform(), line.get_xydata()) for line in ax.lines if line.get_marker() not in ("None", "")]
    clouds = [cloud for cloud in ax.collections if isinstance(cloud, PathCollection)]
    for transform, points in (*marked, *((of.get_offset_transform(), of.get_offsets()) for of in clouds)):
        yield from (Path([place - POINT, place + POINT]) for place in transform.transform(points))


def _move_below(fig: Figure, ax: Axes, legend: Legend) -> float:
    """Draw a legend anew below the words of its horizontal axis, in columns; returns its height in inches."""
    entries = [
        (handle, text.get_text())
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True)
        if handle is not None
    ]
    columns, labels = legend_columns([label for _, label in entries], ax.bbox.width / fig.dpi)
    words = ax.xaxis.get_tightbbox(_renderer(fig))
    drop = BELOW + ((ax.bbox.y0 - words.y0) / fig.dpi if words is not None else 0.0)
    below = ax.transAxes + ScaledTranslation(0, -drop, fig.dpi_scale_trans)
    moved = ax.legend(
        [handle for handle, _ in entries],
        labels,
        loc="upper left",
        borderpad=0.0,
        borderaxespad=0.0,
        bbox_to_anchor=(0, 0),
        bbox_transform=below,
        ncols=columns,
        columnspacing=1.0,
    )
    for text, before in zip(moved.get_texts(), legend.get_texts(), strict=True):
        text.set_parse_math(before.get_parse_math())
    return lines_of(labels, columns) * 1.6 * fonts.small() / 72
