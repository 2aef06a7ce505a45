"""Bars, a panel an observable: the cases along an axis, Sobol' indices of a sampled study, tornado diagrams."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from solver.problem.errors import InputError
from solver.problem.quantities import quantity
from studies.grammar.axes import SAMPLE

from ..store import schema, selection
from ..words import labels
from . import canvas, colours, fonts
from .scales import RoomLocator
from .sheet import SCREEN, Sheet

COLUMN = 3.4  # inches: the width of a column of a journal
BAR, FRAME, AROUND = 0.2, 0.6, 0.8  # inches of a bar, of title and ticks of a panel, and of the legend
MOST, MOST_PANELS = 12, 4  # bars of a panel of a tornado or of cases; panels of cases where none is asked for
ROOM = 0.34  # share of the width that is kept for the numbers on either side
FIRST, TOTAL = colours.PAIR


def of_cases(
    ds: xr.Dataset,
    x: str | None = None,
    show: Sequence[str] = (),
    at: Mapping[str, float] | None = None,
    sheet: Sheet = SCREEN,
) -> Figure:
    """Observables of a study along an axis of few values, a bar a case.

    Parameters
    ----------
    ds, x, at
        The study, the axis (default: the first of several values), and values of other axes.
    show
        The observables, which the panel of the sheet replaces; default: the first four that vary.
    sheet
        What the figure is drawn for.

    Raises
    ------
    InputError
        For an axis of more than `MOST` values, a study of samples or of one case, and an observable that is not stored.
    """
    axes = [name for name in schema.axes_of(ds) if ds.sizes[name] > 1]
    if not axes or SAMPLE in axes:
        raise InputError(f"bars need an axis of several values; the file holds {'samples' if axes else 'one case'}")
    axis = selection.axis_of(ds, x) if x else axes[0]
    if (count := ds.sizes[axis]) > MOST:
        raise InputError(f"bars show at most {MOST} values of an axis, and {axis} has {count}: choose --kind lines")
    stored = selection.observables(ds)
    names = selection.names_of(ds, [sheet.panel] if sheet.panel else show)
    names = names or ([name for name in stored if not selection.is_level(ds, name)] or stored)[:MOST_PANELS]
    if not names:
        raise InputError("no bars: the dataset has no observables")
    cases = selection.line(ds, axis, at)
    held = {name: i for name, i in cases[0].items() if name != axis}
    notes = [f"All bars: {labels.equations(ds, held)}."] if held else []
    return _panels(ds, names, count, partial(_cases, ds, axis, cases), notes, sheet)


def _cases(ds: xr.Dataset, axis: str, cases: Sequence[dict[str, int]], name: str, ax: Axes) -> None:
    """One observable of the cases along an axis, the first on top."""
    array = ds[name]
    sizes = np.array([float(labels.in_label_unit(array, array.isel(case).values)) for case in cases])
    ax.barh(range(sizes.size), np.nan_to_num(sizes), 0.66, color=colours.DATA, zorder=3)
    _write_sizes(
        ax,
        sizes,
        [labels.minus_signs(labels.number(size)) if np.isfinite(size) else "unsolved" for size in sizes],
        selection.is_count(ds, name),
    )
    first, *others = labels.distinct(ds[axis], ds[axis].values[[case[axis] for case in cases]])
    _look(ax, [f"{labels.axis_symbol(axis)} = {first}", *(text.partition(" ")[0] for text in others)])
    ax.set_title(fonts.wrap(labels.label(array, long=True), ax), loc="left", pad=4)


def indices(ds: xr.Dataset, sheet: Sheet | None = None) -> Figure:
    """The Sobol' indices of a dataset of `influence.sobol`, of first order and total, with intervals.

    sheet: what the figure is drawn for; default: a column of a journal as wide as on paper, with letters for the
    screen, and two columns for several panels.
    """
    names = [str(name) for name in ds["observable"].values]
    limits = _limits(ds)
    entries = [
        Patch(color=FIRST, label="first order: the field alone"),
        Patch(color=TOTAL, label="total: with interactions"),
    ]
    share = f"{100 * ds.attrs['confidence']:g} %"
    notes = [f"Shares of the variance; lines: {share} intervals.", *_notes_of_errors(ds)]
    return _panels(ds, names, 2 * ds.sizes["field"], partial(_indices, ds, limits), [*entries, *notes], sheet)


def tornado(ds: xr.Dataset, sheet: Sheet | None = None) -> Figure:
    """How each observable of a dataset of `influence.local` answers each field, the strongest on top; sheet: as above.

    ds may have the attribute varied: the fields of the axes of a study, whose values the title names. Raises
    `InputError` where no field has an effect.
    """
    names = [str(name) for name in ds["observable"].values if _effects(ds, str(name))]
    if not names:
        raise InputError("no diagram: no observable depends on these fields, or none has a derivative")
    most = max(len(_effects(ds, name)[:MOST]) for name in names)
    varied = [name for name in str(ds.attrs.get("varied", "")).split() if name in ds["field"].values]
    at = [(quantity(name).symbol, ds.sel(field=name)) for name in varied]
    values = [f"{symbol} = {_in_unit(float(row['at']), str(row['field_unit'].values))}" for symbol, row in at]
    titled = ds.assign_attrs(title=", ".join([str(ds.attrs["title"]), *values]))
    entries = [Patch(color=colours.PAIR[k], label=word) for k, word in ((1, "rises"), (0, "falls"))]
    note = "The change of each observable if a field rises by 1 %, or by the amount beside it."
    return _panels(titled, names, most, partial(_tornado, ds), [*entries, note], sheet)


def _panels(
    ds: xr.Dataset,
    names: Sequence[str],
    bars: int,
    panel: Callable[[str, Axes], None],
    said: canvas.Said,
    sheet: Sheet | None,
) -> Figure:
    """A panel for each of the names, with room for so many bars, and one legend below."""
    columns = min(len(names), 2)
    if sheet is not None:
        columns = 1 if sheet.narrow else min(len(names), max(int(sheet.width / COLUMN), 1))
    page = sheet or Sheet(COLUMN * columns)
    rows = canvas.in_rows([partial(panel, name) for name in names], columns, FRAME + BAR * max(bars, 2))
    return canvas.page(ds, page, rows, said, AROUND)


def _look(ax: Axes, ticks: Sequence[str]) -> None:
    """The look of a panel whose bars lie at 0, 1, ... downward."""
    ax.set_yticks(range(len(ticks)), ticks)
    ax.set_ylim(len(ticks) - 0.4, -0.6)
    ax.tick_params(axis="y", length=0, labelcolor=colours.INK, labelsize=fonts.small())
    ax.axvline(0, color=colours.SOFT, linewidth=0.8, zorder=4)
    ax.spines["left"].set_visible(False)


def _indices(ds: xr.Dataset, limits: tuple[float, float], name: str, ax: Axes) -> None:
    """The indices of one observable, the field of the largest total on top."""
    row = ds.sel(observable=name)
    ax.set_title(str(row["symbol"].values), loc="left", pad=4)
    if not np.isfinite(row["total"].values).any():
        ax.text(0.5, 0.5, "one value on all samples", transform=ax.transAxes, ha="center", color=colours.SOFT)
        ax.set(xticks=[], yticks=[])
        return
    order = np.argsort(-row["total"].values)
    at = np.arange(order.size)
    looks: list[dict[str, Any]] = [
        {"ecolor": "white", "elinewidth": 2.4},
        {"ecolor": colours.INK, "elinewidth": 1, "capsize": 2},
    ]
    for key, color, offset in (("first", FIRST, -0.19), ("total", TOTAL, 0.19)):
        values = row[key].values[order]
        ax.barh(at + offset, values, 0.36, color=color, zorder=3)
        for look in looks:
            ax.errorbar(values, at + offset, xerr=row[f"{key}_conf"].values[order], linestyle="none", zorder=4, **look)
    _look(ax, [str(ds["field_symbol"].values[i]) for i in order])
    ax.set_xlim(*limits)
    if row["lost"] > 0:
        lost = f"{100 * float(row['lost']):.2g} % of the blocks left out"
        ax.set_title(lost, loc="right", pad=4, size=fonts.small(), color=colours.SOFT)


def _notes_of_errors(ds: xr.Dataset) -> list[str]:
    """Why an index is negative, or a total index is less than that of first order, where this is so."""
    found = {
        "an index can be below 0": bool((ds["first"] < 0).any() or (ds["total"] < 0).any()),
        "a total index can be below that of first order": bool((ds["total"] < ds["first"]).any()),
    }
    said = " and ".join(words for words, is_so in found.items() if is_so)
    return [f"The samples give estimates: by their sampling error {said}."] if said else []


def _limits(ds: xr.Dataset) -> tuple[float, float]:
    """The ends of the axis of every panel of indices: 0 and 1, and beyond them what the intervals need."""
    low = min(float((ds[key] - ds[f"{key}_conf"]).min()) for key in ("first", "total"))
    high = max(float((ds[key] + ds[f"{key}_conf"]).max()) for key in ("first", "total"))
    return min(np.nan_to_num(low), 0.0) - 0.03, max(np.nan_to_num(high), 1.0) + 0.03


def _tornado(ds: xr.Dataset, name: str, ax: Axes) -> None:
    """The tornado diagram of one observable."""
    row, found = ds.sel(observable=name), _effects(ds, name)
    shown, rest = found[:MOST], found[MOST:]
    sizes = np.array([effect for _, effect in shown])
    ax.barh(range(sizes.size), sizes, 0.66, color=[colours.PAIR[int(size > 0)] for size in sizes], zorder=3)
    _write_sizes(ax, sizes, [f"{'+' if size > 0 else '−'}{labels.number(abs(size), 2)}" for size in sizes])
    _look(ax, [_tick(ds, field) for field, _ in shown])
    value = _in_unit(float(row["value"]), str(row["unit"].values))
    unit = str(row["effect_unit"].values)
    ax.set_title(f"{quantity(name).symbol} = {value}", loc="left", pad=4)
    change = f"change [{labels.unit(unit)}]" if unit != "1" else "change"
    ax.set_title(change, loc="right", pad=4, size=fonts.small(), color=colours.SOFT)
    if rest:
        more = f"{len(rest)} fields of less than {abs(shown[-1][1]):.1g}"
        ax.set_xlabel(more, size=fonts.small(), color=colours.SOFT)


def _write_sizes(ax: Axes, sizes: Any, texts: Sequence[str], integer: bool = False) -> None:
    """Write the sizes of bars at 0, 1, ... beside their ends, and give the axis room for them; NaN has no bar."""
    ends = np.nan_to_num(sizes)
    for i, (end, text) in enumerate(zip(ends, texts, strict=True)):
        ax.annotate(text, (end, i), (-3 if end < 0 else 3, 0), textcoords="offset points",
                    ha="right" if end < 0 else "left", va="center", color=colours.INK, size=fonts.small())  # fmt: skip
    low, high = min(ends.min(), 0.0), max(ends.max(), 0.0)
    room = ROOM * (high - low or 1.0)
    ax.set_xlim(low - (room if low < 0 else room / 6), high + (room if high > 0 else room / 6))
    ax.xaxis.set_major_locator(RoomLocator("counts" if integer else "numbers"))


def _effects(ds: xr.Dataset, name: str) -> list[tuple[str, float]]:
    """The fields that have an effect on an observable, and the effects, the largest first."""
    row = ds["effect"].sel(observable=name).values
    found = [(str(f), float(v)) for f, v in zip(ds["field"].values, row, strict=True) if np.isfinite(v) and v != 0]
    return sorted(found, key=lambda pair: -abs(pair[1]))


def _tick(ds: xr.Dataset, field: str) -> str:
    """``E``, or with another amount than 1 % ``β₀, 1°``."""
    amount = str(ds["amount"].sel(field=field).values)
    symbol = quantity(field).symbol
    return symbol if amount == "1 %" else f"{symbol}, {labels.unit(amount.replace(' deg', '°'))}"


def _in_unit(number: float, unit: str) -> str:
    """A number with its unit, an angle in degrees."""
    return labels.value(number, xr.DataArray(number, attrs={"units": unit}))
