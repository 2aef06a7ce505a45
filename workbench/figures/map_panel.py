"""One map: an observable in colours over two axes, the regions of a count, the cases, and cells without a number.

A further map has unrolled views of the rod at chosen cells, all at one scale.
"""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from numpy.typing import NDArray

from solver.problem.errors import InputError
from studies.grammar.axes import SAMPLE
from studies.laws.line_verdicts import NOISE

from ..stored.stored_cases import NEARLY_STRAIGHT
from ..stored.stored_study import StoredStudy
from ..words import caution_words, labels
from . import canvas, colours, drawn_rods, fonts, regions, unrolled
from .axis_scales import RoomLocator, Scale
from .halo import Halo
from .map_cells import Cells, Choice

Values = NDArray[np.float64]
# the scale of colours ends at the last value that is so many times the range of the others away from their middle;
# the others: all but this share at either end
REACH, OUTLIERS = 1.5, 0.025
MOST_TAKEN = 0.5  # but it ends at outliers where the rest takes more of it
DECADES = 1e3  # ratio of the values from which their colours are logarithmic
MOST_COLOURS = 256  # counts, each with a colour of its own
MOST_CLASSES = 24  # of a count, with a border between each two
# points that a map shows, and on a square inch of it: each is seen, and between them the map
MOST_SAMPLES, DENSEST = 1200, 120
REFINED = 4  # times fewer of a refined study: its cases lie along borders, which they would cover
TURNED: Any = {"facecolor": colours.UNKNOWN, "edgecolor": colours.SOFT, "hatch": "....", "linewidth": 0}
DENSE = ", dense where a number changes"  # of the cases of a refined study
COARSE = "; of these only the coarse grid is shown"  # of those that are shown of it
SAMPLES: Any = {"color": colours.INK, "linestyle": "none", "markeredgewidth": 0.5, "alpha": 0.8}
SIZES = {".": 2.8, "x": 2.4}  # points of a mark where there are many; with few cases up to `LARGER` times as many
LARGER = 1.6
MOST_SHAPES, FILL = 12, 0.86  # shapes along an axis; of the room of a shape that it fills
FINE = 0.02  # inches between the places where the number of a region may stand
HALO = Halo(2.2, 0.75)


class Colours:
    """The one scale of colours of an observable, over all its panels.

    said: ``, 3 in all cases`` of a constant, which is white and has no bar; else nothing. extend: at which ends of its
    bar an arrow stands for outliers; notes: how far these are.
    """

    def __init__(self, stored: StoredStudy, name: str, values: Values) -> None:
        self.count = name in stored.counts
        known = values[np.isfinite(values)]
        low, high = self.low, self.high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
        self.constant = stored.is_level(name)  # what rounding and errors allow is no news
        self.said = f", {stored.level_in_words(name)}" if self.constant else ""
        self.cmap: Colormap = colours.map_colours()
        self.extend, self.notes = "neither", list[str]()
        self.norm = Normalize(low, high)
        if self.constant:
            self.cmap, self.norm = ListedColormap(["white"]), Normalize(low - 1, high + 1)
        elif self.count and high - low < MOST_COLOURS:
            levels = np.arange(low - 0.5, high + 1)
            self.cmap, self.norm = colours.map_colours(levels.size - 1), BoundaryNorm(levels, levels.size - 1)
        elif self.count:
            self.norm = Normalize(low - 0.5, high + 0.5)
        elif low > 0 and high > DECADES * low:  # of sizes above rounding
            self.norm = LogNorm(float(known[known > NOISE * high].min()), high)
        elif known.size:
            inner = _without_outliers(known)
            self.norm = Normalize(float(inner.min()), float(inner.max()))
            far = {"min": f"down to {labels.number(low)}"} if inner.min() > low else {}
            far |= {"max": f"up to {labels.number(high)}"} if inner.max() < high else {}
            if far:
                self.extend = "both" if len(far) == 2 else next(iter(far))
                self.notes.append(
                    f"Beyond the colours: {labels.label(stored[name], long=True)} {', '.join(far.values())}."
                )

    def bar(self, mesh: Any, axes: list[Axes]) -> None:
        """The bar of colours beside the panels; none of a constant."""
        if self.constant:
            return
        bar = canvas.colour_bar(axes, mesh, pad=0.015, aspect=30, fraction=0.05, extend=self.extend)
        bar.locator = RoomLocator("counts" if self.count else "numbers")


def _without_outliers(known: Values) -> Values:
    """Values without those that would take most of their scale."""
    bulk = np.quantile(known, [OUTLIERS, 1 - OUTLIERS])
    inner = known[np.abs(known - bulk.mean()) <= REACH * np.ptp(bulk)]
    return inner if inner.size and 0 < np.ptp(inner) < MOST_TAKEN * np.ptp(known) else known


def draw(ax: Axes, cells: Cells, name: str, scale: Colours, inches: tuple[float, float], pale: float = 1.0) -> Any:
    """Draw the map of an observable on axes of that width and height in inches; returns its coloured cells.

    pale: the opacity of the colours; below 1 there are neither borders nor cases.
    """
    values = cells.values(name)
    x, y = cells.x.edges, cells.y.edges
    mesh = cells.colour(ax, values, cmap=scale.cmap, norm=scale.norm, alpha=pale)
    nearly_straight = {"facecolor": colours.BAND, "linewidth": 0}
    states = (cells.unbent(name), nearly_straight), (cells.turned, TURNED), (~cells.solved, colours.UNSOLVED)
    for mask, look in states:
        if mask.any():
            ax.add_patch(PathPatch(regions.path(mask, x, y), **look))
    if scale.count and not scale.constant and pale == 1:
        _number_regions(ax, cells, name, np.where(cells.unbent(name), -1.0, values), scale, inches)
    if pale == 1:
        _show_samples(ax, cells, name, inches)
    for side in ("top", "right"):
        ax.spines[side].set_visible(True)
    return mesh


def _one_of(cells: Cells, inches: tuple[float, float]) -> int:
    """One of how many cases a map of that width and height in inches shows."""
    most = min(MOST_SAMPLES, int(DENSEST * inches[0] * inches[1]) + 1)
    return -(-cells.samples()[2].size * (REFINED if SAMPLE in cells.source.sizes else 1) // most)


def entries(panels: list[Cells], shown: tuple[str, ...], inches: tuple[float, float]) -> list[str | Artist]:
    """What is said of the cases and of cells without a number: entries of the legend, and sentences of the caption.

    inches: width and height of a panel.
    """
    barred = np.concatenate([panel.samples()[2] for panel in panels])
    most = max(_one_of(panel, inches) for panel in panels)
    is_thinned = any(panel.nearly_straight(name).any() for panel in panels for name in shown)
    few = f" (one of {most} is shown{', outside the pale area' * is_thinned})" if most > 1 else ""
    dense = DENSE if SAMPLE in panels[0].source.sizes else ""
    marks = {"." * bool(~barred.all()): "a case", "x" * bool(barred.any()): caution_words.BARRED}
    legend: list[Artist] = [
        Line2D([], [], label=label, marker=mark, markersize=LARGER * SIZES[mark], **SAMPLES)
        for mark, label in marks.items()
        if mark
    ]
    legend[0].set_label(f"{legend[0].get_label()}{few}{dense}")
    numbers = [
        (np.isnan(panel.values(name)) & panel.solved & ~panel.turned, panel.unbent(name))
        for panel in panels
        for name in shown
    ]
    framed: Any = {"edgecolor": colours.SOFT, "linewidth": 0.6}
    for occurs, label, look in (
        (
            any(unbent.any() for _, unbent in numbers),
            f"β varies by less than {np.degrees(NEARLY_STRAIGHT):.0f}°{COARSE * is_thinned}",
            {"facecolor": colours.BAND, **framed},
        ),
        (any(panel.turned.any() for panel in panels), "turns back against both its ends", TURNED),
        (not all(panel.solved.all() for panel in panels), "not solved", colours.UNSOLVED),
        (
            any((unknown & ~unbent).any() for unknown, unbent in numbers),
            "solved, number unknown",
            {"facecolor": colours.UNKNOWN, **framed},
        ),
    ):
        legend += [Patch(label=label, **look)] * bool(occurs)
    cases = sum(panel.solved.size for panel in panels)
    turned = sum(int(panel.turned.sum()) for panel in panels)
    turn = ("turn back against both their ends and have", "turns back against both its ends and has")[turned == 1]
    return [
        *legend,
        *[f"{turned} of {cases} rods {turn} no colour."] * bool(turned),
    ]


def _number_regions(
    ax: Axes, cells: Cells, name: str, values: Values, scale: Colours, inches: tuple[float, float]
) -> None:
    """The borders of the regions of a count, and its number in each that has room for it, beside the marks of cases if
    it can; the bar of colours has all.

    Many counts are taken in classes of 2, 5, 10, ..., which have their first and their last.
    """
    steps = (digit * 10**power for power in range(20) for digit in (1, 2, 5))
    step = next(step for step in steps if scale.high - scale.low <= MOST_CLASSES * step)
    classes = np.floor(values / step) * step
    cells.draw_borders(ax, classes, colors=colours.INK, linewidths=0.5, capstyle="projecting")
    cell_at = [
        np.searchsorted([axis.share(edge) for edge in axis.edges[1:-1]], np.arange(0.5, int(long / FINE)) * FINE / long)
        for axis, long in ((cells.y, inches[1]), (cells.x, inches[0]))
    ]
    x, y, _ = cells.samples()
    unmarked = np.ones([cell.size for cell in cell_at], dtype=bool)
    for k in cells.marks(name, _one_of(cells, inches)):
        shares = np.array([cells.y.share(y[k]), cells.x.share(x[k])])
        unmarked[*np.minimum(shares * unmarked.shape, np.array(unmarked.shape) - 1).astype(int)] = False
    for number, area in regions.areas(classes):
        last = f"–{labels.tick(number + step - 1)}" if step > 1 else ""
        text = "nearly straight" if number < 0 else f"{labels.tick(number)}{last}"
        size = fonts.small() / 72, fonts.width_of(text, fonts.small()) + 0.06
        inside = area[np.ix_(*cell_at)]
        middle = regions.place(inside & unmarked, (FINE, FINE), size) or regions.place(inside, (FINE, FINE), size)
        if middle is not None:
            up, along = np.divide(middle, unmarked.shape)
            words = ax.text(along, up, text, transform=ax.transAxes, ha="center", va="center_baseline",
                            size=fonts.small(), color=colours.INK, path_effects=[HALO], zorder=5)  # fmt: skip
            if number < 0:  # it is wider than the distance of the cases
                words.set_bbox({"facecolor": colours.BAND, "edgecolor": "none", "pad": 1})


def _show_samples(ax: Axes, cells: Cells, name: str, inches: tuple[float, float]) -> None:
    """A point at each case, a cross where no real rod could keep its shape; of very many cases so many, evenly chosen,
    and none that was added where a number changes that the map does not show. inches: width and height."""
    x, y, barred = cells.samples()
    shown = cells.marks(name, _one_of(cells, inches))
    size = float(np.clip(10 * (inches[0] * inches[1] / shown.size) ** 0.5, 1.0, LARGER))
    for marker, rows in ((".", shown[~barred[shown]]), ("x", shown[barred[shown]])):
        if rows.size:
            ax.plot(
                x[rows],
                y[rows],
                marker=marker,
                markersize=SIZES[marker] * size,
                clip_on=False,
                zorder=4,
                label="_samples",
                **SAMPLES,
            )


@dataclass(frozen=True)
class ShapeCounts:
    """How many shapes stand side by side, and one above the other."""

    across: int
    up: int


def read_shapes(text: str) -> ShapeCounts:
    """``5x4`` as the numbers of shapes. Raises `InputError`."""
    match = re.fullmatch(r"(\d{1,4})x(\d{1,4})", text.strip())
    numbers = [int(number) for number in match.groups()] if match else [0]
    if not all(1 <= number <= MOST_SHAPES for number in numbers):
        raise InputError(f"--shapes takes two numbers from 1 to {MOST_SHAPES}, such as 5x5, got {text!r}")
    return ShapeCounts(*numbers)


def check_shapes(stored: StoredStudy, grid: StoredStudy, choice: Choice, shapes: ShapeCounts) -> None:
    """Raise `InputError` unless the dataset stores the curves, and the axes of its grid have enough values."""
    for axis, count in ((choice.x, shapes.across), (choice.y, shapes.up)):
        if count > grid.sizes[axis]:
            raise InputError(f"{count} shapes along {axis} are more than its {grid.sizes[axis]} values")
    if not unrolled.has_curve(stored):
        raise InputError('the study stores no unrolled curves: add "alpha" and "z" to its outputs, and run it again')


def draw_shapes(ax: Axes, cells: Cells, shapes: ShapeCounts, inches: tuple[float, float]) -> list[str]:
    """Draw the shapes on a map so many inches wide and high, each about its own case; returns notes."""
    stored = cells.source
    columns, across = _spread(cells.x, shapes.across)
    rows, up = _spread(cells.y, shapes.up)
    places = [(j, i) for j in rows for i in columns]
    chosen = {name: list(dict.fromkeys(cells.place(*place)[name] for place in places)) for name in cells.place(0, 0)}
    rods = dict(zip(places, drawn_rods.of_all_cases(stored.select(chosen), ["alpha", "z"]), strict=True))
    known = [rod for cell, rod in rods.items() if cells.solved[cell] and rod.arrays is not None]
    if not known:
        return ["None of the chosen rods is solved: no shape is drawn."]
    wide, tall = (max(float(np.ptp(rod.plane_points()[k])) for rod in known) for k in (0, 1))
    factor = unrolled.stretch(wide, tall, (across * inches[0], up * inches[1]))
    for (j, i), rod in rods.items():
        left, low = (
            float(np.clip(scale.share(float(scale.values[k])) - room / 2, 0, 1 - room))
            for scale, k, room in ((cells.x, i, across), (cells.y, j, up))
        )
        if rod in known:
            unrolled.draw_inset(ax, (left, low, across, up), *rod.plane_points(), (wide, tall), factor)
        else:
            ax.text(left + across / 2, low + up / 2, "not solved", transform=ax.transAxes, ha="center", va="center",
                    size=fonts.small(), path_effects=[HALO], zorder=20)  # fmt: skip
    size = f"the longest is {labels.number(wide)} {labels.unit(stored.units['length'])} long"
    enlarged = f"{unrolled.larger(1 / factor, 'z')}{unrolled.larger(factor, fonts.AROUND)}"
    where = f"{fonts.WAYS}, each about its own case"
    return [f"Shapes: unrolled views, {where}; all at one scale{enlarged}; {size}."]


def _spread(scale: Scale, count: int) -> tuple[list[int], float]:
    """The cells in the middles of so many equal bands of an axis, and the room of each as a share of the axis."""
    chosen = list(dict.fromkeys(scale.cell((k + 0.5) / count) for k in range(count)))
    shares = [scale.share(float(scale.values[i])) for i in chosen]
    return chosen, FILL * float(min([*np.diff(shares), 1 / count]))
