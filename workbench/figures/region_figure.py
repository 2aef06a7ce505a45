"""The map of a dataset of regions: the number of equilibria over two fields, fold curves, cusps, stable shapes."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path

from solver.problem.errors import check_known

from ..stored.stored_study import StoredStudy
from ..words import labels
from . import canvas, colours, fonts, regions, unrolled
from .equilibria_figure import one_shown
from .map_panel import HALO
from .sheet import SCREEN, Sheet

HIGH = 0.62  # height of the map over its width
SHAPE, SMALL_SHAPE = 0.5, 0.3  # inches, the longer side of the largest shape, and that on a narrow map
NARROW = 4.0  # inches of a map
MOST, APART, PAD = 4, 0.15, 0.09  # shapes in a region; inches between two of them, and more than a text has
CLEAR = 0.06  # inches about a mark without letters
LEADER: Any = {"arrowstyle": "-", "color": colours.INK, "linewidth": 0.6, "shrinkA": 1, "shrinkB": 0}
LED = 14  # points from a region without room to the middle of its number
WAYS = ((-1, 0), (1, 0), (0, 1), (0, -1), (-1, 1), (-1, -1), (1, 1), (1, -1))  # up and across, to a text without room
GIVEN = ("the given rod", "the rod of Table 1")  # what the map was made of
CURVES = {  # as of `_curves`
    ("fold", True): "fold of a stable and an unstable equilibrium",
    ("fold", False): "fold of two unstable equilibria",
    ("pitchfork", True): "pitchfork of a stable equilibrium",
    ("pitchfork", False): "pitchfork of an unstable equilibrium",
}
CUSP: dict[str, Any] = {
    "marker": "D",
    "color": "white",
    "markeredgecolor": colours.INK,
    "markersize": 4,
    "linestyle": "none",
    "zorder": 5,
    "label": "cusp",
}
MARK: dict[str, Any] = {
    "marker": "P",
    "color": colours.INK,
    "markeredgecolor": "white",
    "markersize": 8,
    "linestyle": "none",
    "zorder": 7,
}
VIEW = np.linspace(-1, 1, 30)
SHAPES = Line2D(
    [],
    [],
    color=colours.INK,
    linestyle="none",
    marker=Path(np.stack([VIEW, -0.5 * np.sin(4 * VIEW)], axis=1)),
    markersize=13,
    fillstyle="none",
    markeredgewidth=1.1,
    label="stable shape, unrolled",
)
COUNT, STABLE = "count", "count_stable"  # of the equilibria of a region


def figure(stored: StoredStudy, sheet: Sheet = SCREEN, show: Sequence[str] = ()) -> Figure:
    """The map: colours and numbers by region, curves where stable equilibria appear or disappear thick.

    A shape stands beside the number where there is room: the unrolled views of the stable equilibria there.

    show: what the colours are, `count` (default) or `count_stable` of the regions, or a quantity that is stored along
    the curves, such as `dbeta0`. Raises `InputError` for another, and for several.
    """
    shown = next(iter(one_shown(show)), COUNT)
    along = _along_curves(stored)
    check_known("quantity of this map", shown, [COUNT, STABLE, *along])
    high = sheet.width * (HIGH if not sheet.narrow else 1.0)

    def draw(ax: Axes) -> canvas.Said:
        said = _panel(stored, ax, (sheet.width - 1.1, high - 0.6), None if shown in along else shown)
        if shown in along:
            _colour_curves(stored, ax, shown)
            said.append(f"Colours beside the curves: {labels.long_name(stored[f'curve_{shown}'])}.")
        elif shown != COUNT:
            said.append(f"Colours of the regions: {labels.long_name(stored[shown])}.")
        return said

    subject = {COUNT: "", STABLE: "The number of stable equilibria"}.get(shown)
    subject = f"Folds, and their {labels.long_name(stored[f'curve_{shown}'])}," if subject is None else subject
    title = re.sub(r"^The number of equilibria", lambda words: subject or words[0], str(stored.attrs["title"]))
    return canvas.page(stored.with_title(title), sheet, [(high, [draw])])


def _along_curves(stored: StoredStudy) -> list[str]:
    """The quantities that are stored along the curves, beside the two fields."""
    fields = stored.data("fields")
    along = [name for name in stored.variables if stored[name].dims == ("curve", "point")]
    names = [name.removeprefix("curve_") for name in along if stored[name].notnull().any()]
    return [name for name in names if name not in fields]


def _lines(stored: StoredStudy) -> list[Any]:
    """The points of each curve in the units of the axes, (points, 2), NaN beyond its ends."""
    fields = stored.data("fields")
    x, y = (
        labels.in_label_unit(stored[name], stored[f"curve_{name}"].values) if "curve" in stored.sizes else ()
        for name in fields
    )
    return [np.stack(line, axis=1) for line in zip(x, y, strict=True)]


def _colour_curves(stored: StoredStudy, ax: Axes, name: str) -> None:
    """Colour what lies beside the curves by a quantity that is stored along them, with its bar."""
    values = labels.in_label_unit(array := stored[f"curve_{name}"], array.values)
    pairs = [np.stack([line[:-1], line[1:]], axis=1) for line in _lines(stored)]
    segments, middles = np.concatenate(pairs), ((values[:, 1:] + values[:, :-1]) / 2).ravel()
    known = np.isfinite(segments).all(axis=(1, 2)) & np.isfinite(middles)
    drawn = LineCollection(
        list(segments[known]), cmap=colours.map_colours(), linewidths=6.0, zorder=2, array=middles[known], gid=name
    )
    ax.add_collection(drawn, autolim=False)
    canvas.colour_bar([ax], drawn, labels.label(array), pad=0.015, aspect=30, fraction=0.05)


def _panel(stored: StoredStudy, ax: Axes, inches: tuple[float, float], shown: str | None) -> list[str | Artist]:
    """Draw the map on axes of about that width and height; shown: the count that colours the regions; None: nothing.

    Returns what is said of it: notes, and the colours that no number explains.
    """
    names = stored.data("fields")
    edges = np.array(
        [
            labels.in_label_unit(stored[name], np.array([stored.attrs[end][k] for end in ("low", "high")]))
            for k, name in enumerate(names)
        ]
    )
    lines = _lines(stored)
    curves = sorted(enumerate(_curves(stored)), key=lambda curve: [*CURVES].index(curve[1]))  # as in the legend
    for k, curve in curves:
        ax.plot(*lines[k].T, zorder=3, solid_capstyle="round", gid=str(k + 1), label=CURVES[curve], **_look(*curve))
    marks = list[Any]()
    if "cusp" in stored.sizes:
        cusps = [labels.in_label_unit(stored[name], stored[f"cusp_{name}"].values) for name in names]
        ax.plot(*cusps, **CUSP)
        marks += np.transpose(cusps).tolist()
    ax.set(
        xlim=edges[0],
        ylim=edges[1],
        **{f"{axis}label": labels.axis_label(stored[name]) for axis, name in zip("xy", names, strict=True)},
    )
    given = zip(names, stored.attrs.get("given", (np.nan, np.nan)), strict=True)  # older files have none
    point = np.array([float(labels.in_label_unit(stored[name], value)) for name, value in given])
    if ((edges[:, 0] <= point) & (point <= edges[:, 1])).all():
        ax.plot(*point, **MARK, label=GIVEN[bool(stored.attrs.get("reading"))])
        marks.append(point)
    free = _free(
        stored["region_at"].values, [(np.array(mark) - edges[:, 0]) / np.ptp(edges, axis=1) for mark in marks], inches
    )
    notes, left_out = _name_regions(stored, ax, free, inches)
    if shown is None:
        return [*notes]
    raster = regions.fine(stored["region_at"].values, [(line - edges[:, 0]) / np.ptp(edges, axis=1) for line in lines])
    counts = np.append(stored[shown].values, 0)[raster].astype(float)
    counts[raster < 0] = np.nan
    known = np.unique(counts[np.isfinite(counts)])
    ramp = ListedColormap(colours.map_colours(max(known.size, 2))(np.arange(max(known.size, 1))))
    ax.imshow(np.searchsorted(known, np.where(np.isnan(counts), known[:1], counts)), cmap=ramp, origin="lower",
              extent=(*edges[0], *edges[1]), aspect="auto", interpolation="nearest", alpha=0.8,
              vmin=-0.5, vmax=max(known.size, 2) - 0.5, zorder=0)  # fmt: skip
    pairs = list(zip(stored[COUNT].values.tolist(), stored[STABLE].values.tolist(), strict=True))
    unsaid = {pairs[k] for k in left_out} - {pair for k, pair in enumerate(pairs) if k not in left_out}
    entries = dict[Any, dict[int, list[int]]]()  # of one colour
    for pair in sorted(unsaid):
        tone = (*ramp(int(np.searchsorted(known, pair[shown == STABLE])))[:3], 0.8)
        entries.setdefault(tone, {}).setdefault(pair[0], []).append(pair[1])
    return [
        *notes,
        *(
            Patch(color=tone, label=", ".join(_words(count, *stable) for count, stable in of.items()))
            for tone, of in entries.items()
        ),
    ]


def _curves(stored: StoredStudy) -> list[tuple[str, bool]]:
    """The kind of each curve, and whether an equilibrium on it is stable on one side."""
    count = stored.sizes.get("curve", 0)
    return [(str(stored["curve_kind"].values[k]), bool(stored["curve_index"].values[k] == 0)) for k in range(count)]


def _look(kind: str, stable: bool) -> dict[str, Any]:
    return {
        "color": colours.INK,
        "linewidth": 1.8 if stable else 0.8,
        "linestyle": "-" if kind == "fold" else (0, (4, 2)),
    }


def _free(numbers: Any, marks: Sequence[Any], inches: tuple[float, float]) -> Any:
    """The region of each cell, -1 for none and under the marks, which are given in shares of the map."""
    rows, columns = np.indices(numbers.shape) + 0.5
    places = np.stack([columns / numbers.shape[1], rows / numbers.shape[0]], axis=-1)
    away = [np.hypot(*np.moveaxis((places - mark) * inches, -1, 0)) for mark in marks if np.isfinite(mark).all()]
    return np.where(np.min(away, axis=0) < CLEAR, -1, numbers) if away else numbers


def _name_regions(
    stored: StoredStudy, ax: Axes, numbers: Any, inches: tuple[float, float]
) -> tuple[list[str | Artist], list[int]]:
    """Write ``13 (2 stable)`` into each region with room, and all its stable shapes below it where they fit too; where
    all regions have as many stable ones, the largest says so, and the others have ``13`` alone. A region without room
    has its text in another one where that covers nothing, and a line to it.

    numbers: the region of each cell, -1 where no letters may stand. Returns what is said of the shapes, and the regions
    without room.
    """
    cell = inches[1] / numbers.shape[0], inches[0] / numbers.shape[1]
    line, longest = 1.3 * fonts.small() / 72, SHAPE if inches[0] > NARROW else SMALL_SHAPE
    taken = numbers.copy()
    left_out, texts, drawn = list[int](), dict[int, str](), False
    largest = np.bincount(numbers[numbers >= 0]).argmax()
    same = np.unique(stored["count_stable"].values).size == 1
    views = _views(stored)
    extent = max((float(np.ptp(view, axis=1).max()) for of in views for view in of), default=1.0)
    for k, (count, stable) in enumerate(zip(stored["count"].values, stored["count_stable"].values, strict=True)):
        text = texts[k] = f"{count}" if same else f"{count} ({stable} stable)"
        full = _words(count, stable).replace(" stable", f" stable{', as everywhere' * (same and len(views) > 1)}")
        sizes = [np.ptp(view, axis=1) / extent * longest + APART for view in views[k]]
        shapes = float(sum(size[0] for size in sizes)), float(max((size[1] for size in sizes), default=0.0))
        all_fit = bool(0 < len(sizes) == stable <= MOST and not same)
        for said, (across_shapes, high_shapes) in (
            *((full if k == largest else text, size) for size in [shapes] * all_fit + [(0.0, 0.0)]),
            *((part.replace(" ", "\n", 1), (0.0, 0.0)) for part in (full, text) if part is text or k == largest),
        ):
            wide = fonts.width_of(said, fonts.small())
            high = line * (1 + said.count("\n"))
            middle = regions.place(numbers == k, cell, (high + high_shapes + PAD, max(wide, across_shapes) + PAD))
            if middle is None:
                continue
            up, across = (place / size for place, size in zip(middle, numbers.shape, strict=True))
            _box(taken, middle, cell, (high + high_shapes + PAD, max(wide, across_shapes) + PAD))[:] = -1
            ax.text(across, up + high_shapes / 2 / inches[1], said, transform=ax.transAxes, ha="center", va="center",
                    size=fonts.small(), color=colours.INK, linespacing=1.1, path_effects=[HALO], zorder=6)  # fmt: skip
            if high_shapes:
                drawn = True
                left, low = across - across_shapes / 2 / inches[0], up - (high + high_shapes) / 2 / inches[1]
                for view, size in zip(views[k], sizes, strict=True):
                    box = left, low, size[0] / inches[0], high_shapes / inches[1]
                    unrolled.draw_inset(ax, box, view[0], view[1], tuple(size * extent / longest))
                    left += box[2]
            break
        else:
            left_out.append(k)
    for k in [*left_out]:
        size = line + PAD, fonts.width_of(texts[k], fonts.small()) + PAD
        foot = regions.place(numbers == k, cell, (0.0, 0.0))
        if foot is None:
            continue
        ways = [np.array([LED / 72, LED / 72 + size[1] / 2]) * way for way in WAYS]
        boxes = [(way, _box(taken, foot + way / cell, cell, size)) for way in ways]
        if free := next(((way, box) for way, box in boxes if box.size and box.min() == box.max() >= 0), None):
            free[1][:] = -1
            up, across = (place / side for place, side in zip(foot, numbers.shape, strict=True))
            _lead(ax, texts[k], (across, up), (72 * free[0][1], 72 * free[0][0]), xycoords=ax.transAxes)
            left_out.remove(k)
    note = f"Shapes: unrolled views of the stable equilibria, {fonts.WAYS}, all at one scale; dot: s = 0."
    return [note, SHAPES] * drawn, left_out


def _box(numbers: Any, middle: Any, cell: tuple[float, float], size: tuple[float, float]) -> Any:
    """The cells within a box of inches about a place of a map, (rows, columns); none where it leaves the map."""
    half = np.divide(size, cell) / 2
    low, high = (np.rint(middle + sign * half).astype(int) for sign in (-1, 1))
    inside = (low >= 0).all() and (high <= numbers.shape).all()
    return numbers[low[0] : high[0], low[1] : high[1]] if inside else numbers[:0]


def _words(count: int, *stable: int) -> str:
    return f"{count} equilibri{'um' if count == 1 else 'a'} ({' or '.join(map(str, stable))} stable)"


def _views(stored: StoredStudy) -> list[list[Any]]:
    """The stable shapes of each region, unrolled: z and the distance around the cylinder, (2, stations) each."""
    alpha, z = stored["stable_alpha"].values, stored["stable_z"].values
    around = _rho(stored)[:, None, None] * (alpha - alpha[..., :1])
    return [[view for view in of if np.isfinite(view).all()] for of in np.stack([z, around], axis=2)]


def _rho(stored: StoredStudy) -> Any:
    """rho of each region, (regions,)."""
    if "rho" in stored:
        return np.full(stored.sizes["region"], float(stored["rho"]))
    R, a = (stored[f"region_{n}"].values if f"region_{n}" in stored else float(stored[n]) for n in ("R", "a"))
    return R + (1 if stored.attrs["side"] == "outside" else -1) * a


def _lead(ax: Axes, text: str, place: tuple[float, float], away: tuple[float, float], **look: Any) -> None:
    """Write a text so many points (2,) away from a place, with a line to it; look: of `Axes.annotate`."""
    ax.annotate(
        text,
        place,
        away,
        textcoords="offset points",
        ha="center",
        va="center",
        size=fonts.small(),
        color=colours.INK,
        path_effects=[HALO],
        zorder=6,
        arrowprops=LEADER,
        **look,
    )
