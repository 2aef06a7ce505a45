"""One map: an observable in colours over two axes, the regions of a count, the cases, and cells without a number."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ..store import selection
from ..words import labels
from . import colours, fonts, legend, regions
from .map_cells import STRAIGHT, Cells
from .scales import RoomLocator

Values = NDArray[np.float64]
DECADES = 1e3  # ratio of the values from which their colours are logarithmic
MOST_COLOURS = 256  # counts, each with a colour of its own
MOST_CLASSES = 24  # of a count, with a border between each two
MOST_SAMPLES = 2500  # points that a map shows
BARRED = "would lift off away from its ends, or pass through itself"
SAMPLES: Any = {"color": colours.INK, "linestyle": "none", "markeredgewidth": 0.4, "alpha": 0.6}
HALO = withStroke(linewidth=2.2, foreground="white", alpha=0.75)


class Colours:
    """The one scale of colours of an observable, over all its panels."""

    def __init__(self, ds: xr.Dataset, name: str, values: Values) -> None:
        self.count = selection.is_count(ds, name)
        known = values[np.isfinite(values)]
        self.low, self.high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
        self.constant = selection.is_level(ds, name)  # what rounding and errors allow is no news
        self.text = labels.level(ds[name], *selection.level(ds, name))
        self.cmap: Colormap = colours.map_colours()
        self.norm = self._norm()

    def _norm(self) -> Normalize:
        if self.constant:  # written and not coloured
            self.cmap = ListedColormap(["white"])
            return Normalize(self.low - 1, self.high + 1)
        if self.count and self.high - self.low < MOST_COLOURS:
            levels = np.arange(self.low - 0.5, self.high + 1)
            self.cmap = colours.map_colours(levels.size - 1)
            return BoundaryNorm(levels, levels.size - 1)
        if not self.count and self.low > 0 and self.high > DECADES * self.low:
            return LogNorm(self.low, self.high)
        if self.count:
            return Normalize(self.low - 0.5, self.high + 0.5)
        return Normalize(self.low, self.high)

    def said(self) -> str:
        """``, 3 in all cases`` of a constant, which has no bar; else nothing."""
        return f", {self.text} in all cases" if self.constant else ""

    def bar(self, mesh: Any, axes: list[Axes]) -> None:
        """The bar of colours beside the panels; none of a constant."""
        if self.constant:
            return
        bar = legend.colour_bar(axes, mesh, pad=0.015, aspect=30, fraction=0.05)
        bar.locator = RoomLocator("counts" if self.count else "numbers")


def draw(ax: Axes, cells: Cells, name: str, scale: Colours, inches: tuple[float, float], pale: float = 1.0) -> Any:
    """Draw the map of an observable on axes of that width and height in inches; returns its coloured cells.

    pale: the opacity of the colours; below 1 there are neither borders nor cases.
    """
    values = cells.values(name)
    x, y = cells.x.edges, cells.y.edges
    mesh = cells.colour(ax, values, cmap=scale.cmap, norm=scale.norm, alpha=pale)
    if cells.unbent(name).any():
        ax.add_patch(PathPatch(regions.path(cells.unbent(name), x, y), facecolor=colours.BAND, linewidth=0))
    if not cells.solved.all():
        ax.add_patch(PathPatch(regions.path(~cells.solved, x, y), facecolor=colours.UNSOLVED, linewidth=0))
    if scale.count and not scale.constant and pale == 1:
        classes, step = _classes(np.where(cells.unbent(name), -1.0, values), scale)
        cells.draw_borders(ax, classes, colors=colours.INK, linewidths=0.5, capstyle="projecting")
        _number_regions(ax, cells, classes, step, inches)
    if pale == 1:
        _show_samples(ax, cells)
    for side in ("top", "right"):
        ax.spines[side].set_visible(True)
    return mesh


def entries(panels: list[Cells], shown: tuple[str, ...]) -> list[str | Artist]:
    """What is said below of the cases and of cells without a number."""
    barred = np.concatenate([panel.samples()[2] for panel in panels])
    most = max(panel.samples()[2].size for panel in panels)
    few = f" (one of {-(-most // MOST_SAMPLES)} is shown)" if most > MOST_SAMPLES else ""
    found: list[Artist] = [
        Line2D([], [], label=label, marker=mark, **SAMPLES)
        for mark, label in ((".", f"a case{few}"), ("x", f"a case: {BARRED}"))
        if barred.any() and not barred.all()
    ]
    if any(panel.unbent(name).any() for panel in panels for name in shown):
        label = f"β varies by less than {np.degrees(STRAIGHT):.0f}°"
        found.append(Patch(facecolor=colours.BAND, edgecolor=colours.SOFT, linewidth=0.6, label=label))
    if not all(panel.solved.all() for panel in panels):
        found.append(Patch(facecolor=colours.UNSOLVED, label="not solved"))
    if any(
        (np.isnan(panel.values(name)) & panel.solved & ~panel.unbent(name)).any() for panel in panels for name in shown
    ):
        found.append(
            Patch(facecolor=colours.UNKNOWN, edgecolor=colours.SOFT, linewidth=0.6, label="solved, number unknown")
        )
    notes = [f"Every rod {BARRED}."] if barred.size and barred.all() else []
    unchecked, cases = sum(panel.unchecked for panel in panels), sum(panel.solved.size for panel in panels)
    if unchecked:
        notes.append(f"{unchecked} of {cases} rods were not checked for all cautions.")
    return [*found, *notes]


def _classes(values: Values, scale: Colours) -> tuple[Values, int]:
    """The lowest count of the class of each cell, and how many counts a class has: 1, or 2, 5, 10, ... for many."""
    span = scale.high - scale.low
    step = next(
        digit * 10**power for power in range(20) for digit in (1, 2, 5) if span <= MOST_CLASSES * digit * 10**power
    )
    return np.floor(values / step) * step, step


def _number_regions(ax: Axes, cells: Cells, classes: Values, step: int, inches: tuple[float, float]) -> None:
    """The count of each region that has room for it, or the first and the last count of its class."""
    for number, area in regions.areas(classes):
        text = (
            "nearly straight"
            if number < 0
            else labels.tick(number)
            if step == 1
            else f"{labels.tick(number)}–{labels.tick(number + step - 1)}"
        )
        size = 1.25 * fonts.small() / 72, fonts.width_of(text, fonts.small()) + 0.06
        middle = regions.place(area, (inches[1] / cells.y.values.size, inches[0] / cells.x.values.size), size)
        if middle is not None:
            ax.text(cells.x.between(middle[1]), cells.y.between(middle[0]), text, ha="center", va="center",
                    size=fonts.small(), color=colours.INK, path_effects=[HALO], zorder=5)  # fmt: skip


def _show_samples(ax: Axes, cells: Cells) -> None:
    """A point at each case, a cross where no real rod takes its shape; of very many cases so many, evenly chosen."""
    x, y, barred = cells.samples()
    shown = np.arange(0, x.size, -(-x.size // MOST_SAMPLES))
    size = float(np.clip(40 / shown.size**0.5, 0.7, 2.0))
    for marker, some in ((".", shown[~barred[shown]]), ("x", shown[barred[shown]])):
        if some.size:
            ax.plot(x[some], y[some], marker=marker, markersize=1.6 * size, clip_on=False, zorder=4, label="_samples",
                    **SAMPLES)  # fmt: skip
