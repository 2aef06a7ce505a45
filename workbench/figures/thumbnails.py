"""Developed shapes of the rod at chosen cells of a map, all at one scale."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from solver.problem.errors import InputError

from ..data import labels
from . import developed, push_scale, style
from .map_cells import Cells, Choice
from .map_panel import HALO
from .scales import Scale
from .single_rod import pushes

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
    if not developed.has_curve(ds):
        raise InputError('the study stores no unrolled curves: add "alpha" and "z" to its outputs, and run it again')


def draw(ax: Axes, cells: Cells, shapes: Shapes, inches: tuple[float, float], name: str) -> list[str]:
    """Draw the shapes on a map so many inches wide and high, each above the number of an observable; returns notes."""
    ds = cells.source
    columns, across = _spread(cells.x, shapes.across)
    rows, up = _spread(cells.y, shapes.up)
    places = {(j, i): cells.place(j, i) for j in rows for i in columns}
    curves = {cell: developed.curve(ds, where) if cells.solved[cell] else None for cell, where in places.items()}
    known = [curve for curve in curves.values() if curve is not None]
    if not known:
        return ["None of the chosen rods is solved: no shape is drawn."]
    extent = max(float(np.ptp(curve[0])) for curve in known), max(float(np.ptp(curve[1])) for curve in known)
    factor = developed.stretch(*extent, (across * inches[0], up * inches[1]))
    drawn = [ds.isel(places[cell]) for cell, curve in curves.items() if curve is not None]
    norm = push_scale.wide_scale([pushes(one) for one in drawn]) if "contact" in ds.data_vars else None
    coarse = False
    for (j, i), curve in curves.items():
        left, low = (float(np.clip(scale.share(float(scale.values[k])) - room / 2, 0, 1 - room))
                     for scale, k, room in ((cells.x, i, across), (cells.y, j, up)))  # fmt: skip
        if curve is not None:
            dots = developed.too_coarse(ds, places[j, i])
            _curve(ax.inset_axes((left, low, across, up)), ds.isel(places[j, i]), curve, extent, factor, dots, norm)
            coarse |= dots
        ax.text(left + across / 2, low, _number(cells, name, j, i), transform=ax.transAxes, ha="center", va="bottom",
                size=style.small(), path_effects=[HALO], zorder=20)  # fmt: skip
    if norm is not None:
        coloured = ScalarMappable(norm, push_scale.ramp())
        push_scale.bar(ax.get_figure(root=True), coloured, [ax], push_scale.unit(ds), inches[0], below=True)  # type: ignore[arg-type]
    notes = [f"Dots: {ds.sizes['u']} stations miss bends."] if coarse else []
    return [_scale_of(ds, extent, factor), *notes]


def _spread(scale: Scale, count: int) -> tuple[list[int], float]:
    """The cells in the middles of so many equal bands of an axis, and the room of each as a share of the axis."""
    chosen = list(dict.fromkeys(scale.cell((k + 0.5) / count) for k in range(count)))
    shares = [scale.share(float(scale.values[i])) for i in chosen]
    return chosen, FILL * float(min([*np.diff(shares), 1 / count]))


def _number(cells: Cells, name: str, j: int, i: int) -> str:
    """The number of an observable at one cell, or why there is none."""
    value = cells.values(name)[j, i]
    return labels.number(float(value), 3) if np.isfinite(value) else "not solved" if not cells.solved[j, i] else ""


def _scale_of(ds: xr.Dataset, extent: tuple[float, float], factor: float) -> str:
    """The scale of the shapes in words."""
    unit = labels.unit(str(ds.attrs["length_unit"]))
    size = f"the tallest is {labels.number(extent[1])} {unit} high"
    enlarged = f"{developed.larger(factor, developed.AROUND)}{developed.larger(1 / factor, 'z')}"
    return f"Shapes: unrolled views, each about its own case, its number below; all at one scale{enlarged}; {size}."


def _curve(
    inset: Axes,
    one: xr.Dataset,
    curve: tuple[Any, Any],
    extent: tuple[float, float],
    factor: float,
    dots: bool,
    norm: Normalize | None,
) -> None:
    """One developed curve, in the middle of its own axes; where the push is stored, in the colours of the push."""
    across, up = curve
    look: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 2} if dots else {"linewidth": 1.3}
    look["clip_on"] = False
    if norm is not None:
        push_scale.draw(inset, across, up, pushes(one), norm, 1.3, dots)
        for drawn in (*inset.lines, *inset.collections):
            drawn.set_clip_on(False)
    else:
        inset.plot(across, up, color=style.PUSHED, **look)
    inset.plot(across[0], up[0], "o", color=style.INK, markersize=2.2, clip_on=False)
    for low_high, values, size in ((inset.set_xlim, across, extent[0]), (inset.set_ylim, up, extent[1])):
        middle, half = (values.min() + values.max()) / 2, 0.5 * size or 0.5
        low_high(middle - half, middle + half)
    inset.set_aspect(1 / factor, adjustable="box")
    inset.set_axis_off()
