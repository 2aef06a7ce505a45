"""Developed curves: the rods on the unrolled cylinder, rho alpha to the right and z up.

A rod a thousand times as long as the cylinder is wide is a hair at one scale. The rule: one scale for both directions,
unless the curves would then be less than `LEAST` inches across; then that direction is drawn larger, by the largest
factor of one digit that fits its room.
"""

from collections.abc import Sequence
from math import floor, log10
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ..data import labels, selection
from . import notes, style
from .sheet import SCREEN, Sheet

MOST_CURVES = 9
AROUND = "distance around the cylinder"
STRIP = (1.5, 4.5)  # inches, the least and the greatest height of a row of curves
SHORT = 0.9  # of the arc: a shorter chord has turned by a right angle or more in between
LEAST = 0.3  # inches
STRAIGHT = 1e-9  # of the other extent: less is rounding, which no scale shows


def has_curve(ds: xr.Dataset) -> bool:
    """Whether the dataset stores what the developed curve is made of."""
    return all(name in ds.data_vars for name in ("alpha", "z", "rho"))


def curve(ds: xr.Dataset, where: dict[str, int]) -> tuple[Any, Any] | None:
    """rho (alpha - alpha(0)) and z of one case, (n,) each; None where it is not solved."""
    one = ds.isel(where)
    alpha, z = one["alpha"].values, one["z"].values
    across = float(one["rho"]) * (alpha - alpha[0])
    return (across, z) if np.isfinite([across, z]).all() else None


def too_coarse(ds: xr.Dataset, where: dict[str, int]) -> bool:
    """Whether the stations of one case miss a bend: some chord is much shorter than the arc between its ends."""
    one, found = ds.isel(where), curve(ds, where)
    if found is None:
        return False
    chords = np.hypot(np.diff(found[0]), np.diff(found[1]))
    return bool((chords < SHORT * np.diff(one["s"].values)).any())


def stretch(wide: float, high: float, room: tuple[float, float], widest: float | None = None) -> float:
    """How many times larger the width is drawn than the height: 1, above 1, or below 1 where the height is enlarged.

    Parameters
    ----------
    wide, high
        The extent of what is drawn [length].
    room
        Inches to the right and up.
    widest
        Of the curves that stand side by side in `wide`, the widest [length]; default: `wide`.
    """
    widest = wide if widest is None else widest
    if min(wide, high) <= STRAIGHT * max(wide, high):
        return 1.0
    across, up = room[0] / wide, room[1] / high  # inches per length that would fill the room
    if widest * up < LEAST and across > up:
        return _one_digit(across / up)
    if high * across < LEAST and up > across:
        return 1 / _one_digit(up / across)
    return 1.0


def larger(factor: float, name: str = "") -> str:
    """The end of an axis label where a direction is enlarged: ``, drawn 50 times larger``; else nothing."""
    return f", {name} drawn {factor:g} times larger".replace("  ", " ") if factor > 1 else ""


def developed(ds: xr.Dataset, ax: Axes, axis: str, sheet: Sheet = SCREEN) -> Axes:
    """The developed curves of the rods along an axis, side by side.

    Each begins on its own line alpha = 0, and the rod's value on the axis stands below it. Both directions have one
    scale, unless the curves would be too thin to see (`stretch`); then the label of the vertical axis names the factor.
    Raises `InputError`.
    """
    cases, lines, curves, width = _side_by_side(ds, axis)
    room = style.inches(ax)
    factor = _factor(curves, width, room)
    coarse = False
    values = _names(ds, axis, cases)
    for where, line, found, value in zip(cases, lines, curves, values, strict=True):
        ax.axvline(line, color=style.FAINT, linewidth=0.8, zorder=0)
        if found is None:
            ax.text(line, 0.5, "unsolved", transform=ax.get_xaxis_transform(), rotation=90, ha="center", va="center",
                    color=style.SOFT, size=style.small())  # fmt: skip
        else:
            look: dict[str, Any] = {"linewidth": 1.7, "solid_capstyle": "round"}
            if too_coarse(ds, where):  # a line would show bends that are not there
                coarse, look = True, {"linestyle": "none", "marker": ".", "markersize": 3}
            ax.plot(line, found[1][0], "o", color=style.INK, markersize=3, zorder=4)
            ax.plot(line + found[0], found[1], color=style.DATA, label=f"{labels.axis_symbol(axis)} = {value}", **look)
    middles = _middles(lines, curves)
    ax.set_xticks(middles, values)
    ax.tick_params(axis="x", length=0)
    ax.spines["bottom"].set_visible(False)  # the values are names of the curves and no scale
    if _crowded(middles, values, min(room[0] / width, room[1] * factor / _height(curves))):
        ax.tick_params(axis="x", labelrotation=90)
    ax.set_aspect(1 / factor, adjustable="box", anchor="NW")
    ax.set_xlim(0, width)
    some = f"; {len(cases)} of {ds.sizes[axis]} values, evenly chosen" if len(cases) < ds.sizes[axis] else ""
    said = [f"each curve at its {axis_label(ds, axis, cases[0], long)}{some}" for long in (True, False)]
    texts = [style.wrap(text, ax) for text in said]
    ax.set_xlabel(texts["\n" in texts[0]], loc="left")  # the short label where the long one needs two lines
    ax.set_ylabel(f"z [{labels.unit(str(ds.attrs['length_unit']))}]{larger(factor, AROUND)}{larger(1 / factor)}")
    scale = "at one scale" if factor == 1 else "at two scales"
    dots = f"; other dots: {ds.sizes['u']} stations miss bends" if coarse else ""
    title = f"Unrolled view: {AROUND} to the right, z up, {scale}; dot: s = 0{dots}"
    if sheet.titled:
        ax.set_title(style.wrap(title, ax), loc="left")
    else:
        ax.set_label(f"unrolled view along {axis}")
        fig = ax.get_figure(root=True)
        assert fig is not None
        notes.keep(fig, [f"{title}."])
    ax.grid(axis="y", color=style.FAINT, linewidth=0.6)
    ax.set_axisbelow(True)
    return ax


def strip_height(ds: xr.Dataset, axis: str, page: float) -> float:
    """The height in inches of the curves along an axis with their labels, on a page of that many inches."""
    cases, lines, curves, width = _side_by_side(ds, axis)
    room = page - 0.4, STRIP[1]  # what is too high is cut by `canvas.close_gaps`
    tall = 1.1 * _height(curves)
    least = min(STRIP[0], 0.25 * page)
    high = float(np.clip(room[0] * tall / (width * _factor(curves, width, room)), least, STRIP[1]))
    values = _names(ds, axis, cases)
    upright = _crowded(_middles(lines, curves), values, min(room[0] / width, high / tall))
    return high + 0.9 + (max(map(len, values)) * style.SMALL * style.LETTER - 0.1 if upright else 0.0)


def axis_label(ds: xr.Dataset, axis: str, where: dict[str, int], long: bool = True) -> str:
    """The axis with its unit, and the values at which the other axes are held."""
    held = [f"{labels.axis_symbol(k)} = {labels.value(float(ds[k][i]), ds[k])}" for k, i in where.items() if k != axis]
    return labels.axis_label(axis, ds[axis], long) + (f", at {', '.join(held)}" if held else "")


def _side_by_side(ds: xr.Dataset, axis: str) -> tuple[list[dict[str, int]], list[float], list[Any], float]:
    """The cases along an axis, where each one's line alpha = 0 stands, its curve or None, and the width of all."""
    cases = selection.spread(selection.line(ds, axis), MOST_CURVES)
    curves = [curve(ds, where) for where in cases]
    spans = [(min(c[0].min(), 0.0), max(c[0].max(), 0.0)) if c is not None else (0.0, 0.0) for c in curves]
    gap = 0.35 * float(np.mean([high - low for low, high in spans])) or 1.0
    edge, lines = gap / 2, []
    for low, high in spans:
        lines.append(edge - low)
        edge += high - low + gap
    return cases, lines, curves, edge - gap / 2


def _names(ds: xr.Dataset, axis: str, cases: Sequence[dict[str, int]]) -> list[str]:
    """The value of each case on the axis, without the unit."""
    texts = labels.distinct(ds[axis], [ds[axis].values[where[axis]] for where in cases])
    return [text.partition(" ")[0] for text in texts]


def _middles(lines: Sequence[float], curves: Sequence[Any]) -> list[float]:
    """The middle of each curve, or its line where it has none."""
    ends = [(found[0].min(), found[0].max()) if found is not None else (0.0, 0.0) for found in curves]
    return [line + (low + high) / 2 for line, (low, high) in zip(lines, ends, strict=True)]


def _height(curves: Sequence[Any]) -> float:
    """The height of the curves together, never 0 [length]."""
    ups = [curve[1] for curve in curves if curve is not None] or [np.zeros(2)]
    return float(max(up.max() for up in ups) - min(up.min() for up in ups)) or 1.0


def _factor(curves: Sequence[Any], width: float, room: tuple[float, float]) -> float:
    """How many times wider than high the curves are drawn in a room of inches, see `stretch`."""
    widest = max((float(np.ptp(curve[0])) for curve in curves if curve is not None), default=width)
    return stretch(width, _height(curves), room, widest)


def _crowded(lines: Sequence[float], texts: Sequence[str], scale: float) -> bool:
    """Whether texts at the lines would overlap; scale: inches per length."""
    gaps = np.diff(lines) * scale
    return bool(gaps.size and gaps.min() < max(map(len, texts)) * style.small() * style.LETTER + 0.08)


def _one_digit(ratio: float) -> float:
    """The ratio cut to one digit."""
    power = 10.0 ** floor(log10(ratio * (1 + 1e-9)))
    return float(floor(ratio / power * (1 + 1e-9)) * power)
