"""Unrolled views of the rod at chosen cells of a map, all at one scale."""

import re
from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from solver.problem.errors import InputError

from ..data import labels, selection
from . import drawn_rods, push_scale, style, unrolled
from .drawn_rods import DrawnRod
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


def draw(ax: Axes, cells: Cells, shapes: Shapes, inches: tuple[float, float], name: str) -> list[str]:
    """Draw the shapes on a map so many inches wide and high, each above the number of an observable; returns notes."""
    ds = cells.source
    columns, across = _spread(cells.x, shapes.across)
    rows, up = _spread(cells.y, shapes.up)
    names = [name for name, array in {"alpha": "alpha", "z": "z", "push": "contact"}.items() if array in ds.data_vars]
    rods = {(j, i): drawn_rods.rod_of_case(ds.isel(cells.place(j, i)), names) for j in rows for i in columns}
    known = [rod for cell, rod in rods.items() if cells.solved[cell] and rod.arrays is not None]
    if not known:
        return ["None of the chosen rods is solved: no shape is drawn."]
    wide, tall = (max(float(np.ptp(rod.developed()[k])) for rod in known) for k in (0, 1))
    extent = wide, tall
    factor = unrolled.stretch(wide, tall, (across * inches[0], up * inches[1]))
    norm = push_scale.wide_scale([rod["push"] for rod in known]) if "push" in names else None
    for (j, i), rod in rods.items():
        left, low = (float(np.clip(scale.share(float(scale.values[k])) - room / 2, 0, 1 - room))
                     for scale, k, room in ((cells.x, i, across), (cells.y, j, up)))  # fmt: skip
        if rod in known:
            _curve(ax.inset_axes((left, low, across, up)), rod, extent, factor, norm)
        text = _number(cells, name, j, i)
        size = style.width_of(text, style.small()) / inches[0], style.small() * 1.2 / 72 / inches[1]
        place = _place_of_number(cells, name, (j, i), (left, low, across, up), size)
        if place is not None:
            ax.text(*place, text, transform=ax.transAxes, ha="center", va="bottom", size=style.small(),
                    path_effects=[HALO], zorder=20)  # fmt: skip
    if norm is not None:
        coloured = ScalarMappable(norm, push_scale.ramp())
        push_scale.bar(ax.get_figure(root=True), coloured, [ax], push_scale.unit(ds), inches[0], below=True)  # type: ignore[arg-type]
    notes = [f"Dots: {ds.sizes['u']} stations miss bends."] if any(map(unrolled.is_coarse, known)) else []
    return [_scale_of(ds, extent, factor), *notes]


def _spread(scale: Scale, count: int) -> tuple[list[int], float]:
    """The cells in the middles of so many equal bands of an axis, and the room of each as a share of the axis."""
    chosen = list(dict.fromkeys(scale.cell((k + 0.5) / count) for k in range(count)))
    shares = [scale.share(float(scale.values[i])) for i in chosen]
    return chosen, FILL * float(min([*np.diff(shares), 1 / count]))


def _place_of_number(
    cells: Cells,
    name: str,
    cell: tuple[int, int],
    room: tuple[float, float, float, float],
    size: tuple[float, float],
) -> tuple[float, float] | None:
    """Where the number of a case stands in the room of its shape, the middle of its foot in shares of the map.

    Of a count it stands among cells of that number: below the shape, else above or beside it, else nowhere (None).
    """
    left, low, across, up = room
    values = np.where(cells.unbent(name), -1.0, np.nan_to_num(cells.values(name), nan=-2.0))
    beside = (0.5, 0.92, 0.08)
    for share in beside:
        for height in np.linspace(0, 1, 9) if share != beside[0] else (0.0, 1.0):
            x, y = left + share * across, low + height * (up - size[1])
            corners = {(cells.y.cell(y + v * size[1]), cells.x.cell(x + (h - 0.5) * size[0]))
                       for v in (0, 1) for h in (0, 1)}  # fmt: skip
            if not selection.is_count(cells.source, name) or all(values[at] == values[cell] for at in corners):
                return x, y
    return None


def _number(cells: Cells, name: str, j: int, i: int) -> str:
    """The number of an observable at one cell, or why there is none."""
    value = cells.values(name)[j, i]
    if cells.unbent(name)[j, i]:
        return "straight"
    return labels.number(float(value), 3) if np.isfinite(value) else "not solved" if not cells.solved[j, i] else ""


def _scale_of(ds: xr.Dataset, extent: tuple[float, float], factor: float) -> str:
    """The scale of the shapes in words."""
    unit = labels.unit(str(ds.attrs["length_unit"]))
    size = f"the longest is {labels.number(extent[0])} {unit} long"
    enlarged = f"{unrolled.larger(1 / factor, 'z')}{unrolled.larger(factor, style.AROUND)}"
    where = f"{style.WAYS}, each about its own case, its number beside it"
    return f"Shapes: unrolled views, {where}; all at one scale{enlarged}; {size}."


def _curve(inset: Axes, rod: DrawnRod, extent: tuple[float, float], factor: float, norm: Normalize | None) -> None:
    """One unrolled view, in the middle of its own axes; where the push is stored, in the colours of the push."""
    across, down = rod.developed()
    if unrolled.is_coarse(rod):
        inset.plot(across, down, ".", color=style.DATA, markersize=2)
    elif norm is not None:
        push_scale.line(inset, across, down, rod["push"], norm, 1.3)
    else:
        inset.plot(across, down, color=style.DATA, linewidth=1.3)
    inset.plot(across[0], down[0], "o", color=style.INK, markersize=2.2)
    for drawn in (*inset.lines, *inset.collections):
        drawn.set_clip_on(False)
    for low_high, values, size in ((inset.set_xlim, across, extent[0]), (inset.set_ylim, down, -extent[1])):
        middle, half = (values.min() + values.max()) / 2, 0.5 * size or 0.5
        low_high(middle - half, middle + half)
    inset.set_aspect(factor, adjustable="box")
    inset.set_axis_off()
