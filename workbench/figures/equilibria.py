"""The figure of all equilibria of one case: their developed curves and energies."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..data import labels
from . import canvas, point_numbers, shape_cell, style

WIDTH, MOST = 9.6, 40  # inches; curves shown
HIGH = 2.9  # inches of the diagram of energies
REACTIONS = ("FZ", "MZ", "M3", "beta0", "betaL")  # of held ends
COLUMNS = (4, 8)  # the fewest and the most panels in a row


def figure(ds: xr.Dataset) -> Figure:
    """The developed curves in the order of energy, and below them energy against index."""
    count = min(ds.sizes["equilibrium"], MOST)
    columns = int(np.clip(np.ceil(np.sqrt(1.9 * count)), *COLUMNS))
    rows, cell = max(-(-count // columns), 1), WIDTH / columns + 0.3

    said = f"Unrolled views, each with its own scale, {_below(ds)} below it; dot: s = 0"

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(2, 1, height_ratios=[rows * cell, HIGH])
        cells = grid[0].subgridspec(rows, columns)
        for k in range(count):
            _draw_curve(ds, fig.add_subplot(cells[k // columns, k % columns]), k)
        energies(ds, fig.add_subplot(grid[1]))

    return canvas.figure((WIDTH, rows * cell + 3.6), draw, ds, said=said)


def energies(ds: xr.Dataset, ax: Axes) -> Axes:
    """Energy against index, a dot an equilibrium, filled where it is stable."""
    ax.scatter(ds["index"], ds["energy"], c=["white" if index else style.INK for index in ds["index"].values], s=30,
               edgecolors=style.INK, linewidths=0.9, zorder=3)  # fmt: skip
    ax.set_xlabel("Morse index: number of unstable directions (0: stable)")
    ax.set_ylabel(labels.label(ds["energy"]))
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.margins(0.04, 0.08)
    if ds.sizes["equilibrium"] and int(ds["index"].min()) == int(ds["index"].max()):
        ax.set_xlim(int(ds["index"].min()) - 0.5, int(ds["index"].max()) + 0.5)
    stable = int((ds["index"] == 0).sum())
    noun = "equilibrium" if ds.sizes["equilibrium"] == 1 else "equilibria"
    counts = f"{ds.sizes['equilibrium']} {noun}, {stable} stable (filled): {ds.attrs['stability']}"
    told = [counts]
    if "searched" in ds.attrs:
        told.append(f"Not proved complete: searched over {labels.minus_signs(ds.attrs['searched'])}")
    ax.set_title("\n".join(told), loc="left")
    points = [
        point_numbers.Point(float(ds["index"][k]), float(ds["energy"][k]), f"{k + 1}")
        for k in range(ds.sizes["equilibrium"])
    ]
    ax.set_xlim(*ax.get_xlim()), ax.set_ylim(*ax.get_ylim())
    point_numbers.write(ax, points, [], [], (style.inches(ax)[0], HIGH - 0.8))
    return style.with_grid(ax)


def _reaction(ds: xr.Dataset) -> str | None:
    """The first reaction of held ends."""
    return next((name for name in REACTIONS if name in ds and ds[name].dims == ("equilibrium",)), None)


def _below(ds: xr.Dataset) -> str:
    name = _reaction(ds)
    return "the energy" if name is None else f"{labels.symbol(ds[name])} and the energy"


def _curve(ds: xr.Dataset, k: int) -> tuple[Any, Any]:
    one = ds.isel(equilibrium=k)
    return float(one["rho"]) * (one["alpha"].values - one["alpha"].values[0]), one["z"].values


def _draw_curve(ds: xr.Dataset, ax: Axes, k: int) -> None:
    one, unit = ds.isel(equilibrium=k), labels.unit(str(ds["z"].attrs.get("units", "1")))
    values = [one[name] for name in (_reaction(ds), "energy") if name is not None]
    below = ", ".join(labels.value(float(value), value) for value in values)
    index = int(one["index"])
    shape_cell.draw(ax, _curve(ds, k), shape_cell.look(index), unit, f"{k + 1}  index {index}", below)
