"""Unrolled views of the rod at chosen cells of a map, all at one scale."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from solver.problem.errors import InputError

from ..words import labels
from . import drawn_rods, fonts, unrolled
from .map_cells import Cells, Choice
from .map_panel import HALO
from .scales import Scale

MOST = 12  # shapes along an axis
FILL = 0.86  # of the room of a shape


@dataclass(frozen=True)
class Shapes:
    """How many shapes stand side by side, and one above the other."""

    across: int
    up: int


def read(text: str) -> Shapes:
    """``5x4`` as the numbers of shapes. Raises `InputError`."""
    found = re.fullmatch(r"(\d{1,4})x(\d{1,4})", text.strip())
    numbers = [int(number) for number in found.groups()] if found else [0]
    if not all(1 <= number <= MOST for number in numbers):
        raise InputError(f"the shapes are two numbers from 1 to {MOST} such as 5x5, got {text!r}")
    return Shapes(*numbers)


def check(ds: xr.Dataset, grid: xr.Dataset, choice: Choice, shapes: Shapes) -> None:
    """Raise `InputError` unless the dataset stores the curves, and the axes of its grid have enough values."""
    for axis, count in ((choice.x, shapes.across), (choice.y, shapes.up)):
        if count > grid.sizes[axis]:
            raise InputError(f"{count} shapes along {axis} are more than its {grid.sizes[axis]} values")
    if not unrolled.has_curve(ds):
        raise InputError('the study stores no unrolled curves: add "alpha" and "z" to its outputs, and run it again')


def draw(ax: Axes, cells: Cells, shapes: Shapes, inches: tuple[float, float]) -> list[str]:
    """Draw the shapes on a map so many inches wide and high, each about its own case; returns notes."""
    ds = cells.source
    columns, across = _spread(cells.x, shapes.across)
    rows, up = _spread(cells.y, shapes.up)
    rods = {(j, i): drawn_rods.rod_of_case(ds.isel(cells.place(j, i)), ["alpha", "z"]) for j in rows for i in columns}
    known = [rod for cell, rod in rods.items() if cells.solved[cell] and rod.arrays is not None]
    if not known:
        return ["None of the chosen rods is solved: no shape is drawn."]
    wide, tall = (max(float(np.ptp(rod.plane_points()[k])) for rod in known) for k in (0, 1))
    extent = wide, tall
    factor = unrolled.stretch(wide, tall, (across * inches[0], up * inches[1]))
    for (j, i), rod in rods.items():
        left, low = (float(np.clip(scale.share(float(scale.values[k])) - room / 2, 0, 1 - room))
                     for scale, k, room in ((cells.x, i, across), (cells.y, j, up)))  # fmt: skip
        if rod in known:
            coarse: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 2}
            unrolled.inset(ax, (left, low, across, up), *rod.plane_points(), extent, factor,
                           **(coarse if unrolled.is_coarse(rod) else {}))  # fmt: skip
        else:
            ax.text(left + across / 2, low + up / 2, "not solved", transform=ax.transAxes, ha="center", va="center",
                    size=fonts.small(), path_effects=[HALO], zorder=20)  # fmt: skip
    notes = [f"Dots: {ds.sizes['u']} stations miss bends."] if any(map(unrolled.is_coarse, known)) else []
    return [_scale_of(ds, extent, factor), *notes]


def _spread(scale: Scale, count: int) -> tuple[list[int], float]:
    """The cells in the middles of so many equal bands of an axis, and the room of each as a share of the axis."""
    chosen = list(dict.fromkeys(scale.cell((k + 0.5) / count) for k in range(count)))
    shares = [scale.share(float(scale.values[i])) for i in chosen]
    return chosen, FILL * float(min([*np.diff(shares), 1 / count]))


def _scale_of(ds: xr.Dataset, extent: tuple[float, float], factor: float) -> str:
    """The scale of the shapes in words."""
    unit = labels.unit(str(ds.attrs["length_unit"]))
    size = f"the longest is {labels.number(extent[0])} {unit} long"
    enlarged = f"{unrolled.larger(1 / factor, 'z')}{unrolled.larger(factor, fonts.AROUND)}"
    where = f"{fonts.WAYS}, each about its own case"
    return f"Shapes: unrolled views, {where}; all at one scale{enlarged}; {size}."
