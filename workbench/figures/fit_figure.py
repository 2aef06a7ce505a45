"""The figure of a fit: the fitted unrolled view with the measured points, the joint region, which data decide."""

from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import special

from studies.grammar.axes import quantity_of

from ..words import labels
from . import bars, canvas, colours, fonts, unrolled
from .sheet import SCREEN, Sheet

LOWER = 3.4  # inches: the height of the lower panels
TALLEST = 0.45  # of the width: the highest unrolled view
LEVEL = 0.95
CROSSES = {False: "; crosses: other minima that the data do not exclude", True: "; crosses: others that reach the data"}
FITTED: dict[str, Any] = {"color": colours.PAIR[1], "linewidth": 1.2, "label": "fitted rod"}
JOINED: dict[str, Any] = {"color": colours.INK, "linewidth": 0.9, "zorder": 1}
MEASURED: dict[str, Any] = {"marker": "o", "markersize": 3.5, "color": "white", "markeredgecolor": colours.INK,
                            "markeredgewidth": 0.9, "linestyle": "none", "zorder": 5,
                            "label": "measured points"}  # fmt: skip
MARKS = ("o", "s", "^", "D", "v", "P")


def figure(ds: xr.Dataset, sheet: Sheet = SCREEN) -> Figure:
    """The figure of a dataset of `workbench.fitting`, on a sheet."""
    view = curve(ds, (sheet.width - unrolled.BESIDE, TALLEST * sheet.width), sheet.small)
    lower = LOWER if not sheet.narrow else min(LOWER, 0.8 * sheet.width)
    parts = [region, shares] if ds.sizes["field"] > 1 else [shares]

    rows: list[canvas.Row] = [(view.height, [view.draw])]
    for beside in [[part] for part in parts] if sheet.narrow else [parts]:
        rows.append((lower, [partial(part, ds) for part in beside]))
    return canvas.page(ds, sheet, rows)


def curve(ds: xr.Dataset, room: tuple[float, float], letters: float) -> unrolled.Panel:
    """The fitted unrolled view with the measured points, which lines join to their places on the rod."""
    factors = {"z": 1.0, "alpha": float(ds["rho"])}
    line, feet, points = (
        [ds[part + name].values * factor for name, factor in factors.items() if part + name in ds]
        for part in ("", "foot_", "measured_")
    )
    over: list[Any] = [((a, c), (b, d), JOINED, "") for a, b, c, d in zip(*points, *feet, strict=True)]
    over += [(*points, MEASURED, "measured points")] if points else []
    view = unrolled.View(line[0], line[1], "", FITTED, name="fitted rod", over=over)
    return unrolled.Panel([view], room, letters, labels.unit(str(ds.attrs["length_unit"])))


def region(ds: xr.Dataset, ax: Axes) -> None:
    """The ellipse of the first two fields that holds both with 95 %, and the interval of each."""
    factors = np.array([np.degrees(1.0) if unit == "rad" else 1.0 for unit in ds["unit"].values[:2]])  # of the labels
    values, low, high = (ds[name].values[:2].astype(float) * factors for name in ("value", "low", "high"))
    names = [labels.symbol_of(str(name)) for name in ds["field"].values[:2]]
    ax.set_xlabel(_label(ds, 0))
    ax.set_ylabel(fonts.fit_label(partial(_label, ds, 1), fonts.inches(ax)[1]))
    ax.plot(*values, "o", color=colours.PAIR[1], markersize=6, zorder=4)
    others = ds["other_minimum"].values[:, :2]
    for other in others:
        ax.plot(*(other * factors), "X", color=colours.INK, markersize=7, zorder=3)
    covariance = ds["covariance"].values[:2, :2] * np.outer(factors, factors)
    also = CROSSES[bool(ds.attrs["exact"])] if len(others) else ""
    if not np.isfinite(covariance).all() or not np.isfinite([low, high]).all():
        ax.set_title(fonts.wrap(f"{' and '.join(names)}: no region is known{also}", ax), loc="left")
        return
    if "normal" in str(ds.attrs["rule"]):  # square of the radius in standard deviations
        square = special.chdtri(2, 1 - LEVEL)
    else:
        square = 2 * special.fdtri(2, int(ds.attrs["freedom"]), LEVEL)
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


def shares(ds: xr.Dataset, ax: Axes) -> None:
    """The share of each datum in what is known of each field: along the rod for points, else by observable."""
    names = [labels.symbol_of(str(name)) for name in ds["field"].values]
    known = [name for name, row in zip(names, ds["share"].values, strict=True) if np.isfinite(row).all()]
    shades = [*colours.PAIR, *colours.ramp_colours(max(len(names) - 2, 0))]
    if "point_share" in ds:
        s, unit = ds["foot_s"].values, labels.unit(str(ds.attrs["length_unit"]))
        order = np.argsort(s, kind="stable")
        for name, row, colour, mark in zip(names, ds["point_share"].values, shades, MARKS * len(names), strict=False):
            ax.plot(s[order], 100 * row[order], color=colour, marker=mark, markersize=3, linewidth=0.9,
                    label=name if name in known else None)  # fmt: skip
        ax.set_xlabel(f"s of the point [{unit}]")
        ax.set_ylabel("share [%]")
    else:
        groups = list(dict.fromkeys(map(str, ds["group"].values)))
        sums = np.array([[row[ds["group"].values == g].sum() for g in groups] for row in ds["share"].values])
        bars.draw(ax, groups, list(zip(100 * sums, shades, strict=False)),
                  names=[name if name in known else None for name in names])  # fmt: skip
        ax.set_xlabel("share [%]")
    each = "each point" if "point_share" in ds else "each target"
    title = f"share of {each} in what is known"
    if not known:
        ax.set_axis_off()
        title = "no field has shares"
    ax.set_title(fonts.wrap(title, ax), loc="left")
    canvas.add_legend(ax, loc="best", ncols=max(len(known), 1))


def _label(ds: xr.Dataset, k: int, long: bool = True) -> str:
    name, unit = str(ds["field"].values[k]), str(ds["unit"].values[k])
    attrs = {"units": unit, "long_name": quantity_of(name).long_name}
    return labels.axis_label(name, xr.DataArray(0.0, attrs=attrs), long)
