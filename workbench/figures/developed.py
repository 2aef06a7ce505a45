"""The unrolled curves of the rods along an axis, side by side."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ..data import selection
from . import single_rod, style
from .scales import larger, stretch

MOST_CURVES = 9
STRIP = (1.5, 4.5)  # inches, the least and the most that a row of curves is high


def developed(ds: xr.Dataset, ax: Axes, axis: str) -> Axes:
    """The rods along an axis on the unrolled cylinder, side by side: rho alpha to the right, z up.

    Each begins on its own line alpha = 0, at which its value is written. At one scale, unless they would be too thin
    to see (`stretch`); then the vertical axis says so. Raises `InputError`.
    """
    cases, lines, curves, width = _side_by_side(ds, axis)
    room = style.inches(ax)
    factor = _factor(curves, width, room)
    coarse = False
    for where, line, found, colour in zip(cases, lines, curves, style.colours(len(cases)), strict=True):
        ax.axvline(line, color=style.FAINT, linewidth=0.8, zorder=0)
        if found is None:
            ax.text(line, 0.5, "unsolved", transform=ax.get_xaxis_transform(), rotation=90, ha="center", va="center",
                    color=style.SOFT, size=style.SMALL)  # fmt: skip
        else:
            how: dict[str, Any] = {"linewidth": 1.7, "solid_capstyle": "round"}
            if single_rod.too_coarse(ds, where):  # a line would show bends that are not there
                coarse, how = True, {"linestyle": "none", "marker": ".", "markersize": 3}
            ax.plot(line + found[0], found[1], color=colour, **how)
    values = [style.shown(float(ds[axis].values[where[axis]]), ds[axis]).partition(" ")[0] for where in cases]
    ax.set_xticks(lines, values)
    ax.tick_params(axis="x", length=0)
    if _crowded(lines, values, min(room[0] / width, room[1] * factor / _height(curves))):
        ax.tick_params(axis="x", labelrotation=90)
    ax.set_aspect(1 / factor, adjustable="box", anchor="NW")
    ax.set_xlim(0, width)
    ax.set_xlabel(axis_label(ds, axis, cases[0]), loc="left")
    ax.set_ylabel(f"z [{style.unit(str(ds.attrs['length_unit']))}]{larger(factor, 'ρα')}{larger(1 / factor)}")
    scale = "all at one scale" if factor == 1 else "at two scales"
    dots = f"; dots: it bends between {ds.sizes['u']} stations" if coarse else ""
    ax.set_title(style.wrapped(f"Unrolled cylinder: ρα to the right, z up, {scale}{dots}", ax), loc="left")
    ax.grid(axis="y", color=style.FAINT, linewidth=0.6)
    ax.set_axisbelow(True)
    return ax


def strip_height(ds: xr.Dataset, axis: str, page: float) -> float:
    """Inches that the curves along an axis are high, with their labels, on a page of that many inches."""
    _, _, curves, width = _side_by_side(ds, axis)
    room = page - 0.9, STRIP[1]
    tall = 1.1 * _height(curves)
    return float(np.clip(room[0] * tall / (width * _factor(curves, width, room)), *STRIP)) + 0.9


def axis_label(ds: xr.Dataset, axis: str, where: dict[str, int], long: bool = True) -> str:
    """The axis with its unit, and where the others are held."""
    held = [f"{style.symbol(k)} = {style.shown(float(ds[k][i]), ds[k])}" for k, i in where.items() if k != axis]
    return style.axis_label(axis, ds[axis], long) + (f", at {', '.join(held)}" if held else "")


def _side_by_side(ds: xr.Dataset, axis: str) -> tuple[list[dict[str, int]], list[float], list[Any], float]:
    """The cases along an axis, where each one's line alpha = 0 stands, its curve or None, and the width of all."""
    cases = selection.spread(selection.line(ds, axis), MOST_CURVES)
    curves = [single_rod.unrolled(ds, where) for where in cases]
    spans = [(min(c[0].min(), 0.0), max(c[0].max(), 0.0)) if c is not None else (0.0, 0.0) for c in curves]
    gap = 0.35 * float(np.mean([high - low for low, high in spans])) or 1.0
    edge, lines = gap / 2, []
    for low, high in spans:
        lines.append(edge - low)
        edge += high - low + gap
    return cases, lines, curves, edge - gap / 2


def _height(curves: Sequence[Any]) -> float:
    """How high the curves are together, never 0 [length]."""
    ups = [curve[1] for curve in curves if curve is not None] or [np.zeros(2)]
    return float(max(up.max() for up in ups) - min(up.min() for up in ups)) or 1.0


def _factor(curves: Sequence[Any], width: float, room: tuple[float, float]) -> float:
    """How many times wider than high the curves are drawn in a room of inches, see `stretch`."""
    widest = max((float(np.ptp(curve[0])) for curve in curves if curve is not None), default=width)
    return stretch(width, _height(curves), room, widest)


def _crowded(lines: Sequence[float], labels: Sequence[str], scale: float) -> bool:
    """Whether labels at the lines would meet; scale: inches per length."""
    gaps = np.diff(lines) * scale
    return bool(gaps.size and gaps.min() < max(map(len, labels)) * style.SMALL * style.LETTER + 0.08)
