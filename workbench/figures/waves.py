"""Waves that a picture has no room for: below four pixels each, a curve is the band from its least to its largest."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path
from matplotlib.transforms import Transform
from numpy.typing import NDArray

from studies.laws.line_verdicts import NOISE

LEAST = 0.04  # inches of a wave: four pixels of a screen
FEW = 4  # waves one after the other that are less than a band
SEEN = 1 / 256  # of the range of a curve: lower waves are rounding, or are not seen
EDGE, PALE = 0.6, 0.5  # points of the edges of a band; opacity of what is between them
BEHIND = 0.02  # of the order of drawing: what stands on a curve stands on its band
SHADES = 512  # of a band whose colour says its height
BIN = 2  # waves of a piece of a band: neighbouring crests may differ, and each piece needs the higher one
SAID = "Band: waves narrower than 4 pixels each, from their least to their largest value."

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stretch:
    """A part of a curve.

    of: its points among those of the curve. band: x rising, and the lower and the upper edge there, (n,) each, where
    the waves are too narrow; else None.
    """

    of: slice
    band: tuple[Values, Values, Values] | None = None


def stretches(x: Values, y: Values, inches: float) -> Iterator[Stretch]:
    """The parts of a curve in their order; neighbours share a point.

    x, y: (n,); where x does not rise everywhere the curve is one line. inches: of a unit of x.
    """
    x, y = np.asarray(x), np.asarray(y)
    sign = np.sign(np.diff(y))
    moves = np.flatnonzero(sign)
    turns = np.concatenate([[0], moves[1:][np.diff(sign[moves]) != 0], [y.size - 1]])
    wide = (x[turns[2:]] - x[turns[:-2]]) * inches >= LEAST
    if wide.all() or (np.diff(x) <= 0).any():
        yield Stretch(slice(0, x.size))
        return
    narrow = np.append(~wide, False) | np.append(False, ~wide)  # from each turn to the next
    heights, least = np.abs(np.diff(y[turns])), max(SEEN * np.ptp(y), NOISE * np.abs(y).max())
    for first, last in pairwise(_cuts(narrow)):
        narrow[first:last] &= last - first >= 2 * FEW and heights[first:last].max() > least
    cuts = _cuts(narrow)
    for first, last in pairwise(cuts):
        of = slice(int(turns[first]), int(turns[last]) + 1)
        if not narrow[first]:
            yield Stretch(of)
            continue
        widest = float((x[turns[2:]] - x[turns[:-2]])[first : last - 1].max())
        inner = turns[[first + 2, last - 2]] - turns[first]
        yield Stretch(of, _band(x[of], y[of], inner, BIN * max(LEAST / inches, widest)))


def _cuts(flags: NDArray[np.bool_]) -> list[int]:
    """Where runs of equal flags begin, and the end of the last one."""
    return [0, *(np.flatnonzero(np.diff(flags)) + 1).tolist(), flags.size]


def _band(x: Values, y: Values, inner: NDArray[np.int64], wide: float) -> tuple[Values, Values, Values]:
    """The band of waves: the least and the largest of its first and its last wave, and of equal pieces between them.

    inner: the points between these waves, the first and the last. wide: pieces are at least so wide.
    """
    begin, end = x[inner]
    places = np.linspace(begin, end, max(int((end - begin) / wide), 1) + 1)
    starts = np.unique(np.append(np.searchsorted(x, places), 0))
    edges = [
        np.array([start + int(extreme(piece)) for start, piece in zip(starts, np.split(y, starts[1:]), strict=True)])
        for extreme in (np.argmin, np.argmax)
    ]
    at = x[np.unique([*edges[0], *edges[1], 0, x.size - 1])]
    low, high = (np.interp(at, x[k], y[k]) for k in edges)
    return at, low, high


def outline(x: Values, y: Values, inches: float) -> tuple[Values, Values, Values]:
    """x rising, and the lower and the upper edge of what is drawn of a curve there, (n,) each; as of `stretches`."""
    parts = [stretch.band or (x[stretch.of], y[stretch.of], y[stretch.of]) for stretch in stretches(x, y, inches)]
    at, low, high = (np.concatenate(each) for each in zip(*parts, strict=True))
    return at, low, high


def draw(
    ax: Axes,
    x: Values,
    y: Values,
    inches: float,
    look: Mapping[str, Any],
    where: Transform | None = None,
    order: float = 2.0,
    label: str = "",
    line: Callable[[slice], Any] | None = None,
) -> list[str]:
    """Draw a curve, its lines and its bands of waves; returns what is to be said of the bands.

    look: options of the lines; its colour, or the colour of a height, and its name in a table are also those of bands.
    label: of bands in a legend. where: the transform; order: of drawing. line: draws the points of a slice in place of
    a line of this look.
    """
    where, bands, x, y = where or ax.transData, 0, np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    colour = look["color"]
    for stretch in stretches(x, y, inches):
        if stretch.band is None:
            if line is not None:
                line(stretch.of)
            else:
                ax.plot(x[stretch.of], y[stretch.of], transform=where, **{"zorder": order, **look})
            continue
        bands += 1
        at, low, high = stretch.band
        if callable(colour):
            _colour_heights(ax, at, low, high, colour, where, order - BEHIND)
        else:
            ax.fill_between(at, low, high, color=colour, linewidth=0, alpha=PALE, label=label, transform=where,
                            zorder=order - BEHIND)  # fmt: skip
        for edge in (low, high):
            shade = colour(edge.mean()) if callable(colour) else colour
            ax.plot(at, edge, color=shade, linewidth=EDGE, transform=where, zorder=order, gid=look["gid"])
    return [SAID] * bool(bands)


def _colour_heights(
    ax: Axes, x: Values, low: Values, high: Values, colour: Callable[[float], Any], where: Transform, order: float
) -> None:
    """Fill a band so that each height has its colour."""
    least, most = float(low.min()), float(high.max())
    shades = [[colour(height)] for height in np.linspace(least, most, SHADES)]
    image = ax.imshow(
        shades,
        extent=(float(x[0]), float(x[-1]), least, most),
        origin="lower",
        aspect="auto",
        transform=where,
        zorder=order,
    )
    outline = np.column_stack([np.concatenate([x, x[::-1]]), np.concatenate([low, high[::-1]])])
    image.set_clip_path(Path(outline), where)
    image.sticky_edges.y.clear()  # the panel keeps its margin
