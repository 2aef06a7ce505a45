"""Panels of horizontal bars, one panel an observable, in one or two columns as wide as those of a journal."""

from collections.abc import Callable, Sequence

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import canvas, style
from .sheet import Sheet

COLUMN = 3.4  # inches: the width of a column of a journal
BAR, FRAME, AROUND = 0.2, 0.6, 1.4  # inches of a bar, of title and ticks of a panel, of the title and the legend


def figure(
    ds: xr.Dataset,
    names: Sequence[str],
    bars: int,
    panel: Callable[[Axes, str], object],
    legend: Callable[[Figure], None],
    sheet: Sheet | None = None,
) -> Figure:
    """A panel for each of the names, with room for so many bars. panel: draws one. legend: draws what stands below.

    sheet: what the figure is drawn for; default: a column of a journal is as wide as on paper, with letters for the
    screen, and several panels have two columns.
    """
    columns = min(len(names), 2)
    if sheet is not None:
        columns = 1 if sheet.narrow else min(len(names), max(int(sheet.width / COLUMN), 1))
    page = sheet or Sheet(COLUMN * columns)
    rows = -(-len(names) // columns)
    height = rows * (FRAME + BAR * max(bars, 2)) + AROUND - 0.6 * (not page.titled)

    def draw(fig: Figure) -> None:
        for i, name in enumerate(names):
            panel(fig.add_subplot(rows, columns, i + 1), name)
        legend(fig)

    return canvas.figure((page.width, height), draw, ds, sheet=page)


def look(ax: Axes, ticks: Sequence[str]) -> None:
    """The look of a panel whose bars lie at 0, 1, ... downward."""
    ax.set_yticks(range(len(ticks)), ticks)
    ax.set_ylim(len(ticks) - 0.4, -0.6)
    ax.tick_params(axis="y", length=0, labelcolor=style.INK, labelsize=style.small())
    ax.spines["left"].set_visible(False)
    ax.grid(axis="x", color=style.FAINT, linewidth=0.6)
    ax.set_axisbelow(True)
