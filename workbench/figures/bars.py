"""Panels of horizontal bars, one panel an observable, in one or two columns as wide as those of a journal."""

from collections.abc import Callable, Sequence

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import canvas, style

COLUMN = 3.4  # inches: the width of a column of a journal
BAR, FRAME, AROUND = 0.2, 0.6, 1.4  # inches of a bar, of title and ticks of a panel, of the title and the legend
IN_ONE_COLUMN = 3  # panels; more stand in two columns


def figure(
    ds: xr.Dataset,
    names: Sequence[str],
    bars: int,
    panel: Callable[[Axes, str], object],
    legend: Callable[[Figure], None],
) -> Figure:
    """A panel for each of the names, with room for so many bars. panel: draws one. legend: draws what stands below."""
    columns = 1 if len(names) <= IN_ONE_COLUMN else 2
    rows = -(-len(names) // columns)
    height = rows * (FRAME + BAR * max(bars, 2)) + AROUND

    def draw(fig: Figure) -> None:
        for i, name in enumerate(names):
            panel(fig.add_subplot(rows, columns, i + 1), name)
        legend(fig)

    return canvas.figure((COLUMN * columns, height), draw, ds)


def look(ax: Axes, ticks: Sequence[str]) -> None:
    """The look of a panel whose bars lie at 0, 1, ... downward."""
    ax.set_yticks(range(len(ticks)), ticks)
    ax.set_ylim(len(ticks) - 0.4, -0.6)
    ax.tick_params(axis="y", length=0, labelcolor=style.INK, labelsize=style.SMALL + 0.5)
    ax.spines["left"].set_visible(False)
    ax.grid(axis="x", color=style.FAINT, linewidth=0.6)
    ax.set_axisbelow(True)
