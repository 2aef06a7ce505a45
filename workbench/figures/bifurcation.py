"""The bifurcation diagram of a dataset of branches: every equilibrium over an axis, and the folds."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.laws import HOLDS, QUALIFIED

from ..branches.branch_dataset import branches
from ..data import labels
from . import canvas, legend, style

SIZE = (9.6, 9.2)  # inches


def figure(ds: xr.Dataset) -> Figure:
    """beta'(0) and the energy against the axis: stable branches solid, unstable ones thin, folds marked.

    Where laws were judged, the branches on which none fails have a colour.
    """

    def draw(fig: Figure) -> None:
        for i, name in enumerate(("dbeta0", "energy")):
            ax = panel(ds, fig.add_subplot(2, 1, i + 1), name)
            if i == 0:
                legend.add(ax, loc="lower left", bbox_to_anchor=(0, 1), ncols=5)

    return canvas.figure(SIZE, draw, ds)


def panel(ds: xr.Dataset, ax: Axes, key: str) -> Axes:
    """One quantity of each equilibrium against the axis, a line a branch."""
    name = str(ds["outcome"].dims[0])
    along = labels.in_label_unit(ds[name], ds[name].values)
    for row in branches(ds):
        k, i = np.nonzero(ds["branch"].values == row["branch"])
        look, label = _look(row)
        ax.plot(along[k], ds[key].values[k, i], label=label, solid_capstyle="round",
                marker="." if k.size == 1 else "", **look)  # fmt: skip
    folds = labels.in_label_unit(ds[name], ds["fold"].values)
    share = np.linspace(0, 1, 21)  # next to a fold a branch is a parabola
    for which, pair in enumerate(ds["fold_branches"].values):
        fold, height = folds[which], float(ds[f"fold_{key}"][which])
        for row in branches(ds):
            if row["branch"] in pair:
                k, i = np.nonzero(ds["branch"].values == row["branch"])
                tip = 0 if abs(along[k[0]] - fold) < abs(along[k[-1]] - fold) else -1
                last = ds[key].values[k[tip], i[tip]]
                bend = fold + (along[k[tip]] - fold) * share**2, height + (last - height) * share
                ax.plot(*bend, **_look(row)[0])
        ax.plot(fold, height, "o", color=style.INK, markersize=4, fillstyle="none", label="fold", zorder=5)
    ax.set_xlabel(labels.axis_label(name, ds[name]))
    ax.set_ylabel(labels.label(ds[key]))
    ax.margins(x=0.01)
    return style.with_grid(ax)


def _look(row: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The look of a branch, and its entry in the legend."""
    verdicts = [v for key, v in row.items() if " " in key]
    holds = bool(verdicts) and all(v.startswith((HOLDS, QUALIFIED)) for v in verdicts)
    stable = row["index"] == 0
    colour = style.PUSHED if holds else style.INK if stable else style.SOFT
    look = {"color": colour, "linewidth": 2.6 if stable else 1.3, "zorder": 4 if stable else 3 if holds else 2}
    if not stable and not holds:
        look["alpha"] = 0.55
    return look, ("stable" if stable else "unstable") + (", no law of the study fails" if holds else "")
