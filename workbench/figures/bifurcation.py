"""The bifurcation diagram, drawn from the dataset of `bifurcation.sweep`."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from studies.laws import HOLDS, QUALIFIED

from ..branches.branch_dataset import branches
from . import style


def figure(ds: xr.Dataset, path: Path) -> Figure:
    """beta'(0) and energy against the axis: stable branches solid, unstable ones thin, folds marked; where laws were
    judged, the branches on which none fails have a colour. Saved by the name's ending."""
    style.picture_kind(path, (".png", ".pdf", ".svg"))
    with rc_context(style.RC):
        fig = Figure(figsize=(9.6, 9.2), layout="constrained")
        FigureCanvasAgg(fig)
        for i, key in enumerate(("dbeta0", "energy")):
            panel(ds, fig.add_subplot(2, 1, i + 1), key)
        style.entitle(fig, ds)
        fig.savefig(path)
    return fig


def panel(ds: xr.Dataset, ax: Axes, key: str) -> Axes:
    """One quantity of each equilibrium against the axis, a line a branch."""
    name = str(ds["outcome"].dims[0])
    along = np.degrees(ds[name].values) if style.is_angle(ds[name]) else ds[name].values
    for row in branches(ds):
        k, i = np.nonzero(ds["branch"].values == row["branch"])
        look, label = _look(row)
        ax.plot(along[k], ds[key].values[k, i], label=label, solid_capstyle="round",
                marker="." if k.size == 1 else "", **look)  # fmt: skip
    at = np.degrees(ds["fold"].values) if style.is_angle(ds[name]) else ds["fold"].values
    share = np.linspace(0, 1, 21)  # next to a fold a branch is a parabola
    for which, pair in enumerate(ds["fold_branches"].values):
        fold, there = at[which], float(ds[f"fold_{key}"][which])
        for row in branches(ds):
            if row["branch"] in pair:
                k, i = np.nonzero(ds["branch"].values == row["branch"])
                tip = 0 if abs(along[k[0]] - fold) < abs(along[k[-1]] - fold) else -1
                last = ds[key].values[k[tip], i[tip]]
                bend = fold + (along[k[tip]] - fold) * share**2, there + (last - there) * share
                ax.plot(*bend, **_look(row)[0])
        ax.plot(fold, there, "o", color=style.INK, markersize=4, fillstyle="none", label="fold", zorder=5)
    ax.set_xlabel(style.axis_label(name, ds[name]))
    ax.set_ylabel(style.label(ds[key]))
    ax.margins(x=0.01)
    if key == "dbeta0":
        handles, labels = ax.get_legend_handles_labels()
        once = dict(zip(labels, handles, strict=True))
        ax.legend(list(once.values()), list(once), loc="lower left", bbox_to_anchor=(0, 1), ncols=5)
    return style.quiet(ax)


def _look(row: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """How a branch is drawn, and what that means."""
    verdicts = [v for key, v in row.items() if " " in key]
    holds = bool(verdicts) and all(v.startswith((HOLDS, QUALIFIED)) for v in verdicts)
    stable = row["index"] == 0
    colour = style.PUSHED if holds else style.INK if stable else style.SOFT
    look = {"color": colour, "linewidth": 2.6 if stable else 1.3, "zorder": 4 if stable else 3 if holds else 2}
    if not stable and not holds:
        look["alpha"] = 0.55
    return look, ("stable" if stable else "unstable") + (", no law of the study fails" if holds else "")
