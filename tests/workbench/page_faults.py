"""What is wrong with the page of a figure: words cut off, words over words, small letters, units as programs write
them, red that is no failure."""

import re
from io import BytesIO
from itertools import combinations
from typing import Any

import numpy as np
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.lines import Line2D
from matplotlib.text import Text
from numpy.typing import NDArray

SLACK = 1.5  # pixels
MOST_MARKERS = 50  # values of a line, beyond which it has none
COLUMN, TALLEST = 89.5, 120.5  # millimetres: a figure no wider is no taller
RED = 0.2  # by which red exceeds green and blue
UNREADABLE = re.compile(r"\[rad\]|\w\^|\*\*|\b(nan|inf)\b")  # angles are in degrees, powers are raised


def words(fig: Figure) -> list[Text]:
    """The texts that are drawn; the numbers of ticks beyond an axis are not."""
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


def faults(fig: Figure, least: float = 7.0) -> list[str]:
    """A sentence for each fault; least: points of the smallest letters."""
    found, texts = [], words(fig)
    wide, tall = 25.4 * fig.get_size_inches()
    found += [f"{tall:.0f} mm tall"] if wide < COLUMN and tall > TALLEST else []
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
    for (one, a), (other, b) in combinations(zip(texts, boxes, strict=True), 2):
        wide, high = (min(a.x1, b.x1) - max(a.x0, b.x0)), (min(a.y1, b.y1) - max(a.y0, b.y0))
        room = one.get_text().endswith("\n") or other.get_text().endswith("\n")  # empty lines keep room for the other
        if not room and wide > SLACK and high > 0.25 * min(a.height, b.height):
            found.append(f"over one another: {one.get_text()!r} and {other.get_text()!r}")
    return found


def picture(fig: Figure, dpi: float = 80) -> NDArray[np.float64]:
    """The pixels of a figure, (height, width, 3)."""
    page = BytesIO()
    fig.savefig(page, dpi=dpi, format="png")
    page.seek(0)
    return np.asarray(imread(page), dtype=float)[..., :3]


def share_of_red(fig: Figure) -> float:
    """The share of the pixels that are red."""
    pixels = picture(fig)
    return float((pixels[..., 0] - pixels[..., 1:].max(axis=-1) > RED).mean())


def look(fig: Figure) -> list[str]:
    """What each panel draws, a line for all marks that look alike: how many, where they lie, their colours and weights.

    A mark with a name has a line of its own; what stands in a legend, and words, are left out.
    """
    found: list[str] = []
    for number, ax in enumerate(fig.axes, 1):
        alike: dict[str, list[NDArray[np.float64]]] = {}
        for mark in (*ax.lines, *ax.collections, *ax.patches, *(patch for box in ax.containers for patch in box)):
            alike.setdefault(_style(mark), []).append(_places(mark))
        found += [f"{number} {style}: {_ranges(places)}" for style, places in alike.items()]
    return found


def _style(mark: Any) -> str:
    """The kind, the name and the looks of a mark."""
    name = str(mark.get_gid() or mark.get_label() or "_")
    said = [type(mark).__name__, *([] if name.startswith("_") else [" ".join(name.split())])]
    if isinstance(mark, Line2D):
        marker = mark.get_marker()
        said += [to_hex(mark.get_color()), mark.get_linestyle(), f"{mark.get_linewidth():g}"]
        return " ".join([*said, *([] if marker in ("None", "") else [f"{marker}{mark.get_markersize():g}"])])
    if mark.get_array() is not None if hasattr(mark, "get_array") else False:
        return " ".join([*said, mark.get_cmap().name, *(f"{limit:.4g}" for limit in mark.get_clim())])
    colours = [colour for of in (mark.get_facecolor(), mark.get_edgecolor()) for colour in np.atleast_2d(of)[:1]]
    return " ".join([*said, *(to_hex(colour, keep_alpha=True) for colour in colours)])


def _places(mark: Any) -> NDArray[np.float64]:
    """The points of a mark with the values of its colours, (n, 3); NaN where a point has no value."""
    if isinstance(mark, Line2D):
        points = np.asarray(mark.get_xydata(), dtype=float)
    elif isinstance(mark, PathCollection):
        points = np.ma.getdata(mark.get_offsets())
    elif isinstance(mark, QuadMesh):
        points = mark.get_coordinates()[:-1, :-1].reshape(-1, 2)
    elif hasattr(mark, "get_paths"):
        points = np.concatenate([np.zeros((0, 2)), *(path.vertices for path in mark.get_paths())])
    else:
        points = mark.get_patch_transform().transform(mark.get_path().vertices)
    array = mark.get_array() if hasattr(mark, "get_array") else None
    values = np.ma.filled(np.ma.asarray(np.nan if array is None else array, dtype=float), np.nan).ravel()
    rows = np.full((max(len(points), values.size), 3), np.nan)
    rows[: len(points), :2], rows[: values.size, 2] = points, values
    return rows


def _ranges(places: list[NDArray[np.float64]]) -> str:
    """The number of marks, and the least, the mean and the largest of x, y and value."""
    said = [f"{len(places)} of {sum(map(len, places))}"]
    for column in np.concatenate(places).T:
        known = column[np.isfinite(column)]
        said += [f"{known.min():.5g} {known.mean():.5g} {known.max():.5g}" if known.size else "-"]
    return ", ".join(said)
