"""The bifurcation diagram of a dataset of branches: all equilibria over an axis, folds, and a shape of each branch."""

from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.laws import HOLDS, QUALIFIED

from ..branches.branch_dataset import branches
from ..data import labels
from . import canvas, legend, style

WIDTH, PANEL, STRIP = 9.6, (4.6, 3.0), 1.5  # inches: width, heights of the panels and of a row of shapes
MOST, ROW = 16, 8  # shapes, and shapes in a row
MARKS = {"fold": "o", "pitchfork": "D", "branch point": "s"}
GAP = 0.035  # of the height of a panel, between two labels
SAME = 0.008  # of a panel: lines that are nearer are drawn once, as two dashed ones would look solid


_HELD: dict[int, tuple[dict[str, Any], str]] = {
    0: ({"color": style.SOFT, "linewidth": 1.2, "linestyle": (0, (4, 1.6)), "zorder": 2}, "unstable"),
    1: ({"color": style.PUSHED, "linewidth": 2.4, "zorder": 4}, "stable as it is held, unstable under dead loads"),
    2: ({"color": style.STABLE, "linewidth": 2.4, "zorder": 4}, "stable, under dead loads too"),
}


def figure(ds: xr.Dataset) -> Figure:
    """The shown quantity and the energy against the axis, and the developed curves of the branches.

    Stable branches are solid and thick, unstable ones dashed; each has its number at both ends and below its shape.
    Folds and other special points are marked. Where laws were judged, the branches on which none fails have a colour.
    """
    names = [name for name in dict.fromkeys((str(ds.attrs["shown"]), "energy")) if f"curve_{name}" in ds]
    count = min(ds.sizes.get("shape", 0), MOST)
    rows = -(-count // ROW)

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(
            len(names) + bool(rows), 1, height_ratios=[*PANEL[: len(names)], *[STRIP * rows] * bool(rows)]
        )
        for i, name in enumerate(names):
            ax = panel(ds, fig.add_subplot(grid[i]), name)
            if i == 0:
                legend.add(ax, loc="lower left", bbox_to_anchor=(0, 1), ncols=5)
        if rows:
            cells = grid[len(names)].subgridspec(rows, ROW)
            _shapes(ds, fig, cells, count)

    return canvas.figure((WIDTH, sum(PANEL[: len(names)]) + STRIP * rows + 0.8), draw, ds)


def panel(ds: xr.Dataset, ax: Axes, key: str) -> Axes:
    """One quantity of each equilibrium against the axis, a line a branch."""
    name = str(ds.attrs["axis"])
    along, height = labels.in_label_unit(ds[name], ds[f"curve_{name}"].values), _values(ds, f"curve_{key}")
    tips: dict[int, list[tuple[float, float, int]]] = {-1: [], 1: []}
    drawn: list[tuple[str, Any]] = []
    shares = np.stack([values / (np.ptp(values) or 1.0) for values in (along, height)], axis=1)
    for row in branches(ds):
        on = ds["curve_branch"].values == row["branch"]
        x, y = along[on], height[on]
        for run, look, label in _runs(ds, row, np.flatnonzero(on)):
            if any(label == same and _lies_on(shares[run], other) for same, other in drawn):
                continue
            drawn.append((label, shares[run]))
            ax.plot(along[run], height[run], label=label, marker="." if x.size == 1 else "", **look)
        _mark_dead_folds(ds, ax, np.flatnonzero(on), along, height)
        for end, inner in ((0, 1), (-1, -2)):
            if x.size > 1 and not _is_special(ds, name, x[end]):
                tips[1 if x[end] > x[inner] else -1].append((float(x[end]), float(y[end]), int(row["branch"])))
    for kind, mark in MARKS.items():
        x, y = _special(ds, name, key, kind)
        if x.size:
            ax.plot(x, y, mark, color=style.INK, markersize=4.5, markerfacecolor="white", zorder=6, linestyle="none",
                    label=kind)  # fmt: skip
    ax.set_xlabel(labels.axis_label(name, ds[name]))
    ax.set_ylabel(labels.label(ds[f"curve_{key}"]))
    ends = labels.in_label_unit(ds[name], ds[name].values[[0, -1]])
    if "member" in ds.sizes:
        ax.margins(x=0.06)
    else:
        ax.set_xlim(*(ends + 0.06 * np.ptp(ends) * np.array([-1, 1])))
    _label_tips(ax, tips)
    return style.with_grid(ax)


def _lies_on(line: Any, other: Any) -> bool:
    """Whether each point of a line (n, 2), in shares of the panel, is nearer than `SAME` to another line."""
    if len(line) < 2 or len(other) < 2:
        return False
    first, along = other[:-1], np.diff(other, axis=0)
    length2 = np.maximum((along**2).sum(axis=1), 1e-300)
    share = np.clip(((line[:, None] - first) * along).sum(axis=2) / length2, 0, 1)
    apart = np.linalg.norm(line[:, None] - first - share[:, :, None] * along, axis=2)
    return bool((apart.min(axis=1) < SAME).all())


def _values(ds: xr.Dataset, name: str) -> Any:
    return labels.in_label_unit(ds[name], ds[name].values)


def _special(ds: xr.Dataset, name: str, key: str, kind: str) -> tuple[Any, Any]:
    """Axis values and shown values of the special points of one kind."""
    dim = "fold" if kind == "fold" else "special"
    if dim not in ds.sizes:
        return np.empty(0), np.empty(0)
    some = np.ones(ds.sizes[dim], dtype=bool) if dim == "fold" else ds["special_kind"].values == kind
    return labels.in_label_unit(ds[name], ds[dim].values)[some], _values(ds, f"{dim}_{key}")[some]


def _is_special(ds: xr.Dataset, name: str, x: float) -> bool:
    """Whether a branch ends there at a special point."""
    every = [ds[dim].values for dim in ("fold", "special") if dim in ds.sizes]
    return any(bool((labels.in_label_unit(ds[name], values) == x).any()) for values in every)


def _label_tips(ax: Axes, tips: dict[int, list[tuple[float, float, int]]]) -> None:
    """The number of each branch beside its ends; those of neighbouring ends stand in one line."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    for side, some in tips.items():
        groups: list[list[tuple[float, float, int]]] = []
        for tip in sorted((one for one in some if left <= one[0] <= right), key=lambda one: one[1]):
            if groups and tip[1] - groups[-1][-1][1] < GAP * (high - low):
                groups[-1].append(tip)
            else:
                groups.append([tip])
        for group in groups:
            x = max(tip[0] * side for tip in group) * side
            text = _numbers(sorted(tip[2] for tip in group))
            ax.annotate(text, (x, float(np.mean([tip[1] for tip in group]))), xytext=(5 * side, 0),
                        textcoords="offset points", va="center", ha="left" if side > 0 else "right",
                        size=style.small(), color=style.SOFT, annotation_clip=False)  # fmt: skip


def _runs(ds: xr.Dataset, row: dict[str, Any], on: Any) -> list[tuple[Any, dict[str, Any], str]]:
    """The parts of a branch of one look: places among the points, look and entry in the legend.

    Under held ends those are told apart that would be stable under dead loads too.
    """
    if "member" in ds.sizes:
        return [(on, *_look(row))]
    index, dead = ds["curve_index"].values[on], ds["curve_dead_index"].values[on]
    kind = np.where(index > 0, 0, np.where(dead > 0, 1, 2))
    if kind.size > 2:  # at a fold the smaller index is stored
        kind[[0, -1]] = kind[[1, -2]]
    cuts = [0, *(np.flatnonzero(np.diff(kind)) + 1), on.size]
    return [(on[a : b + 1], *_HELD[int(kind[a])]) for a, b in pairwise(cuts)]


def _mark_dead_folds(ds: xr.Dataset, ax: Axes, on: Any, along: Any, height: Any) -> None:
    """Mark where a rod that is held becomes unstable under dead loads: there it would snap through."""
    if "member" in ds.sizes or on.size < 3:
        return
    index, dead = ds["curve_index"].values[on], ds["curve_dead_index"].values[on]
    at = [int(on[k]) for k in np.flatnonzero(np.diff(dead > 0)) if not index[k : k + 2].any()]
    middle = [tuple((values[k] + values[k + 1]) / 2 for values in (along, height)) for k in at]
    if middle:
        ax.plot(*zip(*middle, strict=True), "^", color=style.INK, markersize=5.5, markerfacecolor="white", zorder=6,
                linestyle="none", label="fold under dead loads: the rod snaps through")  # fmt: skip


def _numbers(some: list[int]) -> str:
    """``0, 4–6``."""
    runs: list[list[int]] = []
    for number in some:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    parts = [[str(n) for n in run] if len(run) < 3 else [f"{run[0]}–{run[-1]}"] for run in runs]
    return ", ".join(part for run in parts for part in run)


def _look(row: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The look of a branch, and its entry in the legend."""
    verdicts = [v for key, v in row.items() if " " in key]
    holds = bool(verdicts) and all(str(v).startswith((HOLDS, QUALIFIED)) for v in verdicts)
    stable = row["index"] == 0
    colour = style.PUSHED if holds else style.STABLE if stable else style.SOFT
    look: dict[str, Any] = {
        "color": colour,
        "linewidth": 2.4 if stable else 1.2,
        "zorder": 4 if stable else 3 if holds else 2,
    }
    look["linestyle"] = "-" if stable else (0, (4, 1.6))
    return look, ("stable" if stable else "unstable") + (", no law of the study fails" if holds else "")


def _colour_of_shape(ds: xr.Dataset, name: str, row: dict[str, Any], k: int) -> Any:
    """That of the line of its branch, at the place of the shape."""
    if "member" in ds.sizes:
        return _look(row)[0]["color"]
    on = np.flatnonzero(ds["curve_branch"].values == row["branch"])
    at = on[int(np.argmin(np.abs(ds[f"curve_{name}"].values[on] - float(ds[f"shape_{name}"].values[k]))))]
    index, dead = int(ds["curve_index"].values[at]), int(ds["curve_dead_index"].values[at])
    return _HELD[0 if index > 0 else 1 if dead > 0 else 2][0]["color"]


def _shapes(ds: xr.Dataset, fig: Figure, cells: Any, count: int) -> None:
    """The developed curves of the first branches, all at one scale."""
    name = str(ds.attrs["axis"])
    across = ds["shape_rho"].values[:, None] * (ds["shape_alpha"].values - ds["shape_alpha"].values[:, :1])
    up = ds["shape_z"].values
    half = 0.54 * max((max(np.ptp(x), np.ptp(z)) for x, z in zip(across[:count], up[:count], strict=True)), default=1.0)
    rows = {row["branch"]: row for row in branches(ds)}
    for k in range(count):
        ax = fig.add_subplot(cells[k // ROW, k % ROW])
        ax.plot(across[k], up[k], color=_colour_of_shape(ds, name, rows[k], k), linewidth=1.4, solid_capstyle="round")
        ax.plot(across[k][0], up[k][0], "o", color=style.INK, markersize=2.6)
        middle = (across[k].max() + across[k].min()) / 2, (up[k].max() + up[k].min()) / 2
        ax.set(
            xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half), xticks=[], yticks=[]
        )
        ax.set_aspect("equal")
        for spine in ax.spines.values():
            spine.set(visible=True, color=style.FAINT)
        ax.set_title(f"{k}  index {rows[k]['index']}", loc="left", size=style.small(), pad=2)
        at = labels.value(float(ds[f"shape_{name}"].values[k]), ds[name], 3)
        ax.set_xlabel(f"at {at}", size=style.small(), labelpad=1)
