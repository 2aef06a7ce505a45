"""The figure of a fit: the fitted unrolled view with the measured points, the joint region, which data decide."""

from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import special

from studies.grammar.axes import quantity_of

from ..stored.stored_study import StoredStudy
from ..words import caution_words, labels
from . import bars, canvas, colours, fonts, unrolled
from .sheet import SCREEN, Sheet

LOWER = 3.4  # inches: the height of the lower panels
TALLEST = 0.45  # of the width: the highest unrolled view
LEVEL = 0.95
CROSSES = {False: "; crosses: other minima that the data do not exclude", True: "; crosses: others that reach the data"}
FITTED: dict[str, Any] = {"color": colours.PAIR[1], "linewidth": 1.2, "label": "fitted rod"}
JOINED: dict[str, Any] = {"color": colours.INK, "linewidth": 0.9, "zorder": 1}
MEASURED: dict[str, Any] = {
    "marker": "o",
    "markersize": 3.5,
    "color": "white",
    "markeredgecolor": colours.INK,
    "markeredgewidth": 0.9,
    "linestyle": "none",
    "zorder": 6,  # upon rings
    "label": "measured points",
}
MARKS = ("o", "s", "^", "D", "v", "P")


def figure(stored: StoredStudy, sheet: Sheet = SCREEN) -> Figure:
    """The figure of a dataset of `workbench.fitting`, on a sheet."""
    view = curve(stored, (sheet.width - unrolled.BESIDE, TALLEST * sheet.width), sheet.small)
    lower = LOWER if not sheet.narrow else min(LOWER, 0.8 * sheet.width)
    parts = [region, shares] if stored.sizes["field"] > 1 else [shares]

    rows: list[canvas.Row] = [(view.height, [view.draw])]
    for beside in [[part] for part in parts] if sheet.narrow else [parts]:
        rows.append((lower, [partial(part, stored) for part in beside]))
    return canvas.page(stored, sheet, rows)


def curve(stored: StoredStudy, room: tuple[float, float], letters: float) -> unrolled.UnrolledPanel:
    """The fitted unrolled view with the measured points, which lines join to their places on the rod, and its rings."""
    factors = {"z": 1.0, "alpha": float(stored["rho"])}
    line, feet, points = (
        [stored[part + name].values * factor for name, factor in factors.items() if part + name in stored]
        for part in ("", "foot_", "measured_")
    )
    over: list[Any] = [((a, c), (b, d), JOINED, "") for a, b, c, d in zip(*points, *feet, strict=True)]
    over += [(*points, MEASURED, "measured points")] if points else []
    rings: list[unrolled.Crossing] | None = None
    if "overlaps" in caution_words.keys(str(stored["caution"].values)):
        rho = factors["alpha"]
        rings = unrolled.crossings(stored["s"].values, rho, stored["alpha"].values, line[0], float(stored["a"]), rho)
    start = np.array([0.0, line[1][0]])  # around from alpha = 0, as the points
    rings = [ring._replace(place=ring.place + start) for ring in rings or []]
    view = unrolled.UnrolledView(line[0], line[1], "", FITTED, rings, name="fitted rod", over=over)
    return unrolled.UnrolledPanel([view], room, letters, labels.unit(stored.units["length"]))


def region(stored: StoredStudy, ax: Axes) -> None:
    """The ellipse of the first two fields that holds both with 95 %, and the interval of each."""
    factors = np.array([float(labels.in_label_unit(_field(stored, k), 1.0)) for k in range(2)])
    values, low, high = (stored[name].values[:2].astype(float) * factors for name in ("value", "low", "high"))
    names = [labels.symbol_of(str(name)) for name in stored["field"].values[:2]]
    ax.set_xlabel(_label(stored, 0))
    ax.set_ylabel(fonts.fit_label(partial(_label, stored, 1), fonts.inches(ax)[1]))
    ax.plot(*values, "o", color=colours.PAIR[1], markersize=6, zorder=4)
    others = stored["other_minimum"].values[:, :2]
    for other in others:
        ax.plot(*(other * factors), "X", color=colours.INK, markersize=7, zorder=3)
    covariance = stored["covariance"].values[:2, :2] * np.outer(factors, factors)
    also = CROSSES[bool(stored.attrs["exact"])] if len(others) else ""
    if not np.isfinite(covariance).all() or not np.isfinite([low, high]).all():
        ax.set_title(fonts.wrap(f"{' and '.join(names)}: no region is known{also}", ax), loc="left")
        return
    if "normal" in str(stored.attrs["rule"]):  # square of the radius in standard deviations
        square = special.chdtri(2, 1 - LEVEL)
    else:
        square = 2 * special.fdtri(2, int(stored.attrs["freedom"]), LEVEL)
    sizes, axes = np.linalg.eigh(covariance)
    t = np.linspace(0, 2 * np.pi, 181)
    around = values[:, None] + axes @ (
        np.sqrt(np.maximum(sizes, 0) * square)[:, None] * np.array([np.cos(t), np.sin(t)])
    )
    ax.fill(*around, color=colours.PAIR[1], alpha=0.18, linewidth=0)
    ax.plot(*around, color=colours.PAIR[1], linewidth=1.2)
    for draw, ends in ((ax.axvline, (low[0], high[0])), (ax.axhline, (low[1], high[1]))):
        for end in ends:
            draw(end, color=colours.SOFT, linewidth=0.9, linestyle=(0, (4, 3)))
    text = f"95 % region; dashed: 95 % intervals{also}"
    ax.set_title(fonts.wrap(text, ax), loc="left")


def shares(stored: StoredStudy, ax: Axes) -> None:
    """The share of the variance of each field that the error of each datum makes: along the rod for points, else by
    observable."""
    names = [labels.symbol_of(str(name)) for name in stored["field"].values]
    known = [name for name, row in zip(names, stored["share"].values, strict=True) if np.isfinite(row).all()]
    shades = [*colours.PAIR, *colours.ramp_colours(max(len(names) - 2, 0))]
    if "point_share" in stored:
        s, unit = stored["foot_s"].values, labels.unit(stored.units["length"])
        order = np.argsort(s, kind="stable")
        for name, row, colour, mark in zip(
            names, stored["point_share"].values, shades, MARKS * len(names), strict=False
        ):
            ax.plot(
                s[order],
                100 * row[order],
                color=colour,
                marker=mark,
                markersize=3,
                linewidth=0.9,
                label=name if name in known else None,
            )
        ax.set_xlabel(f"arc length of the point  s [{unit}]")
        ax.set_ylabel("share of the variance [%]")
    else:
        groups = list(dict.fromkeys(map(str, stored["group"].values)))
        sums = np.array([[row[stored["group"].values == g].sum() for g in groups] for row in stored["share"].values])
        bars.draw(
            ax,
            groups,
            list(zip(100 * sums, shades, strict=False)),
            names=[name if name in known else None for name in names],
        )
        ax.set_xlabel("share of the variance [%]")
    each = "each point" if "point_share" in stored else "each target"
    title = f"how much the error of {each} shifts {' and '.join(known) if len(known) < 3 else 'each field'}"
    if not known:
        ax.set_axis_off()
        title = "no field has shares"
    ax.set_title(fonts.wrap(title, ax), loc="left")
    canvas.add_legend(ax, loc="best", ncols=max(len(known), 1))


def _label(stored: StoredStudy, k: int, long: bool = True) -> str:
    return labels.axis_label(_field(stored, k), long)


def _field(stored: StoredStudy, k: int) -> xr.DataArray:
    """The k-th field that is fitted, as a variable with its labels."""
    name, unit = str(stored["field"].values[k]), str(stored["unit"].values[k])
    row = quantity_of(name)
    attrs = {"units": unit, "long_name": row.long_name, "symbol": row.symbol}
    return xr.DataArray(0.0, name=name, attrs=attrs)
