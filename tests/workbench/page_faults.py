"""What is wrong with the page of a figure: words cut off, words over words, small letters, units as programs write
them, legends over what is drawn, red that is no failure."""

import re
from collections.abc import Iterator
from io import BytesIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.colors import to_hex
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Bbox
from numpy.typing import NDArray

from workbench.figures.colours import SOFT

SLACK = 1.5  # pixels
MOST_MARKERS = 50  # values of a line, beyond which it has none
PRINTED, TALLEST = 183.5, 185.5  # millimetres: a figure no wider is for print, and no taller
RED = 0.2  # by which red exceeds green and blue
UNREADABLE = re.compile(r"\[rad\]|[\w)]\^|\*\*|\b(nan|inf)\b")  # angles are in degrees, powers are raised


def words(fig: Figure) -> list[Text]:
    """The texts that are drawn; the numbers of ticks beyond an axis are not. It draws the figure once."""
    fig.draw_without_rendering()
    hidden: set[Text] = set()
    for ax in fig.findobj(lambda one: hasattr(one, "get_xticklabels")):
        for axis, limits in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
            low, high = sorted(limits)
            spare = 1e-6 * (high - low)
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                labels = {tick.label1, tick.label2}
                outside = not low - spare <= tick.get_loc() <= high + spare
                hidden |= labels if outside or not ax.axison or not axis.get_visible() else set()
        if not ax.axison:
            hidden |= {ax.xaxis.label, ax.yaxis.label}
    return [text for text in fig.findobj(Text) if text.get_text().strip() and _is_drawn(text) and text not in hidden]


def _is_drawn(text: Text) -> bool:
    return bool(text.get_visible() and (text.axes is None or text.axes.get_visible()))


def faults(fig: Figure, least: float = 7.0, texts: list[Text] | None = None, axes: float = 0.0) -> list[str]:
    """A sentence for each fault; least: points of the smallest letters. texts: its `words`, if it is drawn already.
    axes: millimetres that axes are high at least."""
    found, texts = [], words(fig) if texts is None else texts
    wide, tall = 25.4 * fig.get_size_inches()
    found += [f"{tall:.0f} mm tall"] if wide < PRINTED and tall > TALLEST else []
    scales = [ax for ax in fig.axes if ax.axison and ax.get_label() != "<colorbar>"]
    heights = [25.4 * ax.get_window_extent().height / fig.dpi for ax in scales]
    found += [f"axes of {high:.1f} mm" for high in heights if high < axes]
    for line in (line for ax in fig.axes for line in ax.lines if line.get_linestyle() != "None"):
        marked = line.get_marker() not in ("None", "") and len(line.get_xdata()) > MOST_MARKERS
        found += [f"{len(line.get_xdata())} markers on a line"] if marked else []
    boxes = [Text.get_window_extent(text) for text in texts]
    for text, box in zip(texts, boxes, strict=True):
        said = " ".join(text.get_text().split())
        if box.x0 < -SLACK or box.y0 < -SLACK or box.x1 > fig.bbox.x1 + SLACK or box.y1 > fig.bbox.y1 + SLACK:
            found.append(f"cut off: {said}")
        if text.get_fontsize() < least - 1e-9:
            found.append(f"letters of {text.get_fontsize():.1f} points: {said}")
        if UNREADABLE.search(said):
            found.append(f"as programs write it: {said}")
    for one, other in _near_pairs(texts, boxes):
        room = one.get_text().endswith("\n") or other.get_text().endswith("\n")  # empty lines keep room for the other
        if not room and _outline(one).intersects_path(_outline(other)):
            found.append(f"over one another: {one.get_text()!r} and {other.get_text()!r}")
    return found + _covering_legends(fig) + _unknown_marks(fig)


def _covering_legends(fig: Figure) -> list[str]:
    """A sentence for each legend with words or samples over lines, points or bars."""
    inside = [legend for ax in fig.axes if (legend := ax.get_legend())]
    found = []
    for legend in (*fig.legends, *inside):
        parts = [*legend.get_texts(), *legend.legend_handles]
        box = Bbox.union([part.get_window_extent() for part in parts if part is not None]).padded(-SLACK)
        for ax in fig.axes:
            if ax.get_window_extent().overlaps(box) and any(path.intersects_bbox(box, False) for path in _outlines(ax)):
                found.append(f"a legend over what is drawn: {legend.get_texts()[0].get_text()}")
    return found


def _unknown_marks(fig: Figure) -> list[str]:
    """A sentence for each entry of a legend whose mark no axes have: a marker or a line of its colour.

    A grey marker says what a shape means in every colour.
    """
    axes = [part for ax in fig.axes for part in (ax, *ax.child_axes)]
    drawn = {(line.get_marker(), to_hex(line.get_color())) for ax in axes for line in ax.lines if len(line.get_xdata())}
    shapes = {marker for marker, _ in drawn}
    found = []
    for legend in (*fig.legends, *(legend for ax in axes if (legend := ax.get_legend()))):
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            if not isinstance(handle, Line2D) or handle.get_marker() in ("None", "", "o"):  # circles are also scattered
                continue
            if isinstance(handle.get_marker(), Path):  # a sign of what stands in the pixels of a scene
                continue
            mark = handle.get_marker(), to_hex(handle.get_color())
            if mark not in drawn and not (mark[1] == to_hex(SOFT) and mark[0] in shapes):
                found.append(f"a mark in the legend that is not drawn: {text.get_text()}")
    return found


def _outlines(ax: Axes) -> Iterator[Path]:
    """The lines, points and bars of axes, as paths in pixels."""
    bars = [bar for of in ax.containers if isinstance(of, BarContainer) for bar in of]
    strokes = [of for of in ax.collections if isinstance(of, LineCollection)]
    lines = [of for of in ax.lines if of.get_linestyle() != "None"]
    yield from (bar.get_transform().transform_path(bar.get_path()) for bar in bars)
    yield from (of.get_transform().transform_path(of.get_path()) for of in lines)
    yield from (of.get_transform().transform_path(path) for of in strokes for path in of.get_paths())
    marked = [(of.get_transform(), of.get_xydata()) for of in ax.lines if of.get_marker() not in ("None", "")]
    scattered = [of for of in ax.collections if isinstance(of, PathCollection)]
    for transform, points in (*marked, *((of.get_offset_transform(), of.get_offsets()) for of in scattered)):
        yield from (Path([place, place + SLACK]) for place in transform.transform(points))


def _near_pairs(texts: list[Text], boxes: list[Bbox]) -> Iterator[tuple[Text, Text]]:
    """The pairs of texts whose boxes overlap."""
    x0, y0, x1, y1 = np.array([box.extents for box in boxes]).reshape(-1, 4).T
    i, j = np.triu_indices(len(texts), 1)
    wide = np.minimum(x1[i], x1[j]) - np.maximum(x0[i], x0[j])
    high = np.minimum(y1[i], y1[j]) - np.maximum(y0[i], y0[j])
    near = (wide > SLACK) & (high > 0.25 * np.minimum((y1 - y0)[i], (y1 - y0)[j]))
    yield from ((texts[a], texts[b]) for a, b in zip(i[near].tolist(), j[near].tolist(), strict=True))


def _outline(text: Text) -> Path:
    """The rectangle around a text, slanted as the text is."""
    slant = text.get_rotation() if text.get_rotation() % 90 else 0.0
    if slant:
        text.set_rotation(0.0)
    corners = text.get_window_extent().corners()[[0, 1, 3, 2, 0]]
    if slant:
        text.set_rotation(slant)
    place = text.get_transform().transform(text.get_position())
    return Path(Affine2D().rotate_deg_around(*place, slant).transform(corners))


def picture(fig: Figure, dpi: float = 80) -> NDArray[np.float64]:
    """The pixels of a figure, (height, width, 3)."""
    page = BytesIO()
    fig.savefig(page, dpi=dpi, format="png")
    page.seek(0)
    return np.asarray(imread(page), dtype=float)[..., :3]


def largest_empty(fig: Figure, cell: int = 4) -> float:
    """The largest rectangle of a figure in which nothing is drawn, as a share of it; axes with scales count as full."""
    full = picture(fig).min(axis=-1) < 0.98
    high, wide = full.shape
    for left, low, right, top in (ax.get_position().extents for ax in fig.axes if ax.axison):
        full[int(high * (1 - top)) : int(high * (1 - low)), int(wide * left) : int(wide * right)] = True
    rows, columns = high // cell, wide // cell
    full = full[: rows * cell, : columns * cell].reshape(rows, cell, columns, cell).any(axis=(1, 3))
    largest = 0
    for first in range(rows):
        for last in range(first, rows):  # the widest run of columns that are empty from the first to the last row
            ends = np.flatnonzero(np.concatenate([[True], full[first : last + 1].any(axis=0), [True]]))
            largest = max(largest, (last + 1 - first) * (int(np.diff(ends).max()) - 1))
    return largest / full.size


def share_of_red(fig: Figure) -> float:
    """The share of the pixels that are red."""
    pixels = picture(fig)
    return float((pixels[..., 0] - pixels[..., 1:].max(axis=-1) > RED).mean())
