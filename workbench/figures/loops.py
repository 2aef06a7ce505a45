"""The figure of closed rods: their developed curves in the colours of the push."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solver.mechanics.contact import push_from

from ..data import labels
from . import canvas, push_scale, shape_cell, style

WIDTH, MOST, COLUMNS = 9.6, 24, 4  # inches; loops shown; panels in a row


def figure(ds: xr.Dataset) -> Figure:
    """The developed curve of each loop at one scale, coloured by the push, with its index and energy."""
    count = min(ds.sizes["equilibrium"], MOST)
    columns = min(COLUMNS, max(count, 2))
    rows, cell = -(-count // columns), 0.9 * WIDTH / columns - 0.15

    def draw(fig: Figure) -> None:
        grid = fig.subplots(rows, columns, squeeze=False).ravel()
        pushes = [_push(ds, k) for k in range(count)]
        norm, half = push_scale.scale(pushes), _half(ds, count)
        drawn = [_draw(ds, ax, k, pushes[k], norm, half) for k, ax in enumerate(grid[:count])]
        for ax in grid[count:]:
            ax.set_axis_off()
        push_scale.bar(fig, drawn[0], list(grid), push_scale.unit(ds), rows * (cell + 0.6))
        orange = "Orange: the cylinder would have to pull, a rod that is free to unbind lifts off there"
        fig.supxlabel(
            "Unrolled views, z up, all at one scale; the vertical lines are one turn around the cylinder apart. "
            f"The rod lies {ds.attrs['side']}.\n"
            f"{orange}.\n"
            "Stable and index: of the closed rod on the surface, its section free to turn.",
            x=0.01, ha="left", size=style.small(), color=style.SOFT,
        )  # fmt: skip

    return canvas.figure((WIDTH, rows * (cell + 0.6) + 0.9), draw, ds)


def _push(ds: xr.Dataset, k: int) -> Any:
    return push_from(ds["contact"].values[k], str(ds.attrs["side"]))


def _curve(ds: xr.Dataset, k: int) -> tuple[Any, Any]:
    one = ds.isel(equilibrium=k)
    z = one["z"].values
    return float(ds["rho"]) * (one["alpha"].values - one["alpha"].values[0]), z - (z.max() + z.min()) / 2


def _half(ds: xr.Dataset, count: int) -> float:
    """Half of the widest or tallest curve: one scale for all."""
    return 0.53 * max(max(np.ptp(x), np.ptp(z)) for x, z in (_curve(ds, k) for k in range(count)))


def _draw(ds: xr.Dataset, ax: Axes, k: int, push: Any, norm: Any, half: float) -> Any:
    """One developed curve between lines that are one wrap apart."""
    x, z = _curve(ds, k)
    one = ds.isel(equilibrium=k)
    turn = 2 * np.pi * float(ds["rho"])
    for wrap in range(int(one["wraps"]) + 1):
        ax.axvline(wrap * turn, color=style.FAINT, linewidth=0.8, zorder=0)
    drawn = push_scale.line(ax, x, z, push, norm)
    middle = (x.max() + x.min()) / 2
    ax.set(xlim=(middle - half, middle + half), ylim=(-half, half), xticks=[], yticks=[])
    ax.set_aspect("equal")
    for spine in ax.spines.values():
        spine.set(visible=True, color=style.FAINT)
    index, waves = int(one["index"]), int(one["folds"])
    word = "stable" if index == 0 else f"unstable in {index} way{'s' * (index > 1)}"
    ax.set_title(f"loop {k + 1}: {waves} wave{'s' * (waves > 1)}, {word}", loc="left", pad=4)
    shape_cell.bar(ax, 2 * half, labels.unit(str(ds.attrs["length_unit"])))
    meets = "\nintersects itself" if "overlaps" in str(one["caution"].values) else ""
    ax.set_xlabel(f"energy {labels.value(float(one['energy']), one['energy'])}{meets}", size=style.small(), labelpad=2)
    return drawn
