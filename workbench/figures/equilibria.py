"""The figure of all equilibria of one case: their developed curves and energies."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..data import labels
from . import canvas, style

WIDTH, MOST = 10.0, 40  # inches; curves shown
COLUMNS = (4, 8)  # the fewest and the most panels in a row


def figure(ds: xr.Dataset) -> Figure:
    """The developed curves in the order of energy, and below them energy against index."""
    count = min(ds.sizes["equilibrium"], MOST)
    columns = int(np.clip(np.ceil(np.sqrt(1.9 * count)), *COLUMNS))
    rows, cell = max(-(-count // columns), 1), WIDTH / columns + 0.1

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(2, 1, height_ratios=[rows * cell, 2.9])
        cells = grid[0].subgridspec(rows, columns)
        half = _half_width(ds, count)
        for k in range(count):
            _draw_curve(ds, fig.add_subplot(cells[k // columns, k % columns]), k, half)
        energies(ds, fig.add_subplot(grid[1]))

    return canvas.figure((WIDTH, rows * cell + 3.6), draw, ds)


def energies(ds: xr.Dataset, ax: Axes) -> Axes:
    """Energy against index, a dot an equilibrium, in the colours of the curves."""
    ax.scatter(ds["index"], ds["energy"], c=colours(ds), s=40, edgecolors="white", linewidths=0.7, zorder=3)
    ax.set_xlabel("Morse index: number of unstable directions (0: stable)")
    ax.set_ylabel(labels.label(ds["energy"]))
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.margins(0.04, 0.08)
    stable = int((ds["index"] == 0).sum())
    counts = f"{ds.sizes['equilibrium']} equilibria, {stable} stable (red): {ds.attrs['stability']}"
    ax.set_title(f"Above: developed curves, all at one scale, the energy below each.\n{counts}", loc="left")
    return style.with_grid(ax)


def colours(ds: xr.Dataset) -> list[Any]:
    """The colour of each by its index; the stable ones stand out."""
    ramp = style.ramp_colours(int(ds["index"].max()) + 1 if ds["index"].size else 1)
    return [style.STABLE if i == 0 else ramp[i] for i in ds["index"].values]


def _curve(ds: xr.Dataset, k: int) -> tuple[Any, Any]:
    one = ds.isel(equilibrium=k)
    return float(one["rho"]) * (one["alpha"].values - one["alpha"].values[0]), one["z"].values


def _half_width(ds: xr.Dataset, count: int) -> float:
    """Half of the widest or tallest curve: one scale for all."""
    curves = [_curve(ds, k) for k in range(count)]
    return 0.53 * max((max(np.ptp(x), np.ptp(z)) for x, z in curves), default=1.0)


def _draw_curve(ds: xr.Dataset, ax: Axes, k: int, half: float) -> None:
    x, z = _curve(ds, k)
    one = ds.isel(equilibrium=k)
    ax.plot(x, z, color=colours(ds)[k], linewidth=1.5, solid_capstyle="round")
    ax.plot(x[0], z[0], "o", color=style.INK, markersize=3)
    middle = (x.max() + x.min()) / 2, (z.max() + z.min()) / 2
    ax.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half), xticks=[], yticks=[])
    ax.set_aspect("equal")
    for spine in ax.spines.values():
        spine.set(visible=True, color=style.FAINT)
    ax.set_title(f"{k + 1}  index {int(one['index'])}", loc="left", size=style.small(), pad=2)
    ax.set_xlabel(labels.value(float(one["energy"]), one["energy"]), size=style.small(), labelpad=1)
