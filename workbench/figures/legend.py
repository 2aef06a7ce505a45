"""The legend of a panel: each label once, however many lines carry it."""

from typing import Any

from matplotlib.axes import Axes


def add(ax: Axes, **where: Any) -> None:
    """The legend of what is drawn on the axes, none where nothing has a label; where: options of `Axes.legend`."""
    handles, labels = ax.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    if once:
        ax.legend(list(once.values()), list(once), **{"loc": "best", **where})
