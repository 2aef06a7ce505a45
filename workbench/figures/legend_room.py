"""Legends that cover lines or points of their axes are put below them."""

from collections.abc import Iterator
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PathCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path
from matplotlib.transforms import Bbox, ScaledTranslation

from . import fonts

POINT = 2.0  # pixels by which a point reaches beyond its middle
HANDLE, GAP = 0.45, 0.1  # inches: of an entry beside its label; between columns of a legend
BELOW = 0.06  # inches between the words of an axis and the legend below


def clear(fig: Figure) -> float:
    """Put each legend of axes that covers a line or a point of them below their words.

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


def _renderer(fig: Figure) -> Any:
    assert isinstance(fig.canvas, FigureCanvasAgg)
    return fig.canvas.get_renderer()


def _covers(ax: Axes, legend: Legend) -> bool:
    parts = [*legend.get_texts(), *(handle for handle in legend.legend_handles if handle is not None)]
    box = Bbox.union([part.get_window_extent() for part in parts])
    return any(path.intersects_bbox(box, filled=False) for path in _paths(ax))


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
        if isinstance(handle, Line2D | Patch)
    ]
    room = ax.bbox.width / fig.dpi
    labels = [fonts.break_lines(label, room - HANDLE - GAP, fonts.small()) for _, label in entries]
    words = ax.xaxis.get_tightbbox(_renderer(fig))
    drop = BELOW + ((ax.bbox.y0 - words.y0) / fig.dpi if words is not None else 0.0)
    widest = HANDLE + GAP + max(fonts.width_of(label, fonts.small()) for label in labels)
    columns = max(int(room / widest), 1)
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
    )
    for text, before in zip(moved.get_texts(), legend.get_texts(), strict=True):
        text.set_parse_math(before.get_parse_math())
    lines = max(label.count("\n") + 1 for label in labels)
    return -(-len(labels) // columns) * lines * 1.6 * fonts.small() / 72
