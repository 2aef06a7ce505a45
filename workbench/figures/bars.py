"""Bars, a panel an observable: the cases along an axis, Sobol' indices of a sampled study, tornado diagrams."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solver.problem.errors import InputError
from solver.problem.quantities import QUANTITIES, quantity
from studies.grammar.axes import SAMPLE

from ..stored.stored_study import StoredStudy
from ..words import labels
from . import canvas, colours, fonts, print_heights
from .axis_scales import RoomLocator
from .sheet import SCREEN, Sheet

COLUMN = 3.4  # inches: the width of a column of a journal
BAR, FRAME, AROUND = 0.2, 0.78, 0.8  # inches of a bar, of title, ticks and label of a panel, and of the legend
MOST, MOST_PANELS = 12, 4  # bars of a panel of a tornado or of cases; panels of cases where none is asked for
ROOM = 0.34  # share of the width that is kept for the numbers on either side
FIRST, TOTAL = colours.PAIR
ORDERS = "first order: the field alone", "total: with interactions"
SIGNS = "falls", "rises"
SHOW = "sensitivity --show"  # chooses the observables of indices and of a tornado
EDGE: dict[str, Any] = {"ecolor": "white", "elinewidth": 2.4}  # of an interval
LINE: dict[str, Any] = {"ecolor": colours.INK, "elinewidth": 1, "capsize": 2}


def of_cases(
    stored: StoredStudy,
    x: str | None = None,
    show: Sequence[str] = (),
    at: Mapping[str, float] | None = None,
    sheet: Sheet = SCREEN,
) -> Figure:
    """Observables of a study along an axis of few values, a bar a case.

    Parameters
    ----------
    stored, x, at
        The study, the axis (default: the first of several values), and values of other axes.
    show
        The observables, which the panel of the sheet replaces; default: the first that vary, as many as have room.
    sheet
        What the figure is drawn for.

    Raises
    ------
    InputError
        For an axis of more than `MOST` values, a study of samples or of one case, and an observable that is not stored.
    """
    stored = stored.coarse()
    axes = stored.varied
    if not axes or SAMPLE in axes:
        raise InputError(f"bars need an axis of several values; the file holds {'samples' if axes else 'one case'}")
    axis = stored.axis(x) if x else axes[0]
    if (count := stored.sizes[axis]) > MOST:
        raise InputError(f"bars show at most {MOST} values of an axis, and {axis} has {count}: choose --kind lines")
    show, most = [sheet.panel] if sheet.panel else show, _most_panels(sheet, count) or MOST_PANELS
    cases = stored.places(axis, at)
    held = {name: i for name, i in cases[0].items() if name != axis}
    line = stored.select(held | {axis: [case[axis] for case in cases]})
    names = stored.names_of(show) if show else line.names_that_vary or stored.observables
    names, left_out = (names, []) if show else (names[:most], names[most:])
    if not names:
        raise InputError("no bars: the dataset has no observables")
    notes = [f"All bars: {stored.equations(held)}."] if held else []
    notes += labels.definitions(stored.expressions, names)
    notes += line.level_notes(name for name in stored.observables if name not in [*names, *left_out] and not show)
    notes += canvas.say_left_out(left_out, "--show or --panel")
    first, *others = labels.distinct(stored[axis], stored[axis].values[[case[axis] for case in cases]])
    rows = [f"{labels.axis_symbol(axis)} = {first}", *(text.partition(" ")[0] for text in others)]

    def panel(name: str, ax: Axes) -> None:
        values = stored.of_solved(name)
        sizes = np.array([float(labels.in_label_unit(values, values.isel(case).values)) for case in cases])
        none = ["no number" if bool(stored["solved"].isel(case)) else "unsolved" for case in cases]
        errors = [float(labels.in_label_unit(values, stored.errors_of(name).isel(case).values)) for case in cases]
        numbers = map(labels.number, sizes) if name in stored.counts else labels.column(sizes, errors)
        texts = [
            labels.minus_signs(text) if np.isfinite(size) else why
            for text, size, why in zip(numbers, sizes, none, strict=True)
        ]
        draw(ax, rows, [(np.nan_to_num(sizes), colours.DATA)], texts, integer=name in stored.counts)
        ax.set_title(fonts.wrap(labels.label(stored[name], long=True), ax), loc="left", pad=4)

    return _panels(stored, names, count, panel, notes, sheet)


def indices(stored: StoredStudy, sheet: Sheet = SCREEN) -> Figure:
    """The Sobol' indices of a dataset of `influence.sobol`, of first order and total, with intervals.

    The field of the largest total is on top. The axis of every panel goes from 0 to 1, and beyond them as far as the
    intervals need.
    """
    low = min(float((stored[key] - stored[f"{key}_conf"]).min()) for key in ("first", "total"))
    high = max(float((stored[key] + stored[f"{key}_conf"]).max()) for key in ("first", "total"))
    limits = min(np.nan_to_num(low), 0.0) - 0.03, max(np.nan_to_num(high), 1.0) + 0.03

    def panel(name: str, ax: Axes) -> None:
        row = stored.part(observable=name)
        words = labels.quantity_name(quantity(name).long_name) if name in QUANTITIES else str(row["symbol"].values)
        ax.set_title(fonts.wrap(words, ax), loc="left", pad=4)
        if not np.isfinite(row["total"].values).any():
            ax.text(0.5, 0.5, "one value on all samples", transform=ax.transAxes, ha="center", color=colours.SOFT)
            ax.set(xticks=[], yticks=[])
            return
        order = _order_of_size(row["total"].values.tolist())
        fields = [str(stored["field_symbol"].values[i]) for i in order]
        draw(
            ax,
            fields,
            [(row["first"].values[order], FIRST), (row["total"].values[order], TOTAL)],
            names=ORDERS,
            errors=[row[f"{key}_conf"].values[order] for key in ("first", "total")],
            interval=f"{100 * stored.attrs['confidence']:g} % interval",
        )
        ax.set_xlim(*limits)
        ax.set_xlabel("share of the variance")
        if row["lost"] > 0:
            _remark(ax, f"{100 * float(row['lost']):.2g} % of the blocks left out")

    notes = []
    surprises = {
        "an index can be below 0": bool((stored["first"] < 0).any() or (stored["total"] < 0).any()),
        "a total index can be below that of first order": bool((stored["total"] < stored["first"]).any()),
    }
    if said := " and ".join(words for words, occurs in surprises.items() if occurs):
        notes.append(f"The samples give estimates: by their sampling error {said}.")
    notes.append(_in_words(dict(zip(stored["field"].values, stored["field_symbol"].values, strict=True))))
    names, bars = [str(name) for name in stored["observable"].values], 2 * stored.sizes["field"]
    return _panels(stored, names, bars, panel, notes, sheet, SHOW)


def tornado(stored: StoredStudy, sheet: Sheet = SCREEN) -> Figure:
    """How each observable of a dataset of `influence.local` answers each field, the strongest on top.

    stored may have the attribute varied: the fields of the axes of a study, whose values the title names. Raises
    `InputError` where no field has an effect.
    """
    effects = {str(name): _effects(stored, str(name)) for name in stored["observable"].values}
    names = [name for name, rows in effects.items() if rows]
    if not names:
        raise InputError("no diagram: no observable depends on these fields, or none has a derivative")
    varied = [name for name in str(stored.attrs.get("varied", "")).split() if name in stored["field"].values]
    at = [(name, stored.part(field=name)) for name in varied]
    values = [
        f"{quantity(name).symbol} = {_in_unit(float(row['at']), str(row['field_unit'].values), name)}"
        for name, row in at
    ]
    titled = stored.with_title(", ".join([str(stored.attrs["title"]), *values]))

    def panel(name: str, ax: Axes) -> None:
        row, shown, rest = stored.part(observable=name), effects[name][:MOST], effects[name][MOST:]
        sizes = np.array([effect for _, effect in shown])
        rises = [int(size > 0) for size in sizes]
        said = map(labels.powers_of_ten, labels.alike(abs(sizes), 2))
        texts = [f"{'−+'[k]}{text}" for k, text in zip(rises, said, strict=True)]
        draw(
            ax,
            [_tick(stored, field) for field, _ in shown],
            [(sizes, [colours.PAIR[k] for k in rises])],
            texts,
            names=[[SIGNS[k] for k in rises]],
        )
        value, unit = _in_unit(float(row["value"]), str(row["unit"].values), name), str(row["effect_unit"].values)
        words = labels.quantity_name(quantity(name).long_name)
        ax.set_title(fonts.wrap(f"{words} = {value}", ax), loc="left", pad=4)
        ax.set_xlabel(f"change [{'°' if unit == 'deg' else labels.unit(unit)}]" if unit != "1" else "change")
        if rest:
            _remark(ax, f"{len(rest)} fields of less than {abs(shown[-1][1]):.1g}")

    shown = {field for rows in effects.values() for field, _ in rows[:MOST]}
    fields = _in_words({field: quantity(field).symbol for field in stored["field"].values if field in shown})
    note = f"The change of each observable if a field rises by the amount beside it. {fields}"
    most = max(len(effects[name][:MOST]) for name in names)
    return _panels(titled, names, most, panel, [note], sheet, SHOW)


def draw(
    ax: Axes,
    rows: Sequence[str],
    series: Sequence[tuple[Any, Any]],
    texts: Sequence[str] = (),
    errors: Sequence[Any] = (),
    integer: bool = False,
    names: Sequence[Any] = (),
    interval: str = "",
) -> None:
    """Draw bars in rows, the first on top.

    Parameters
    ----------
    ax, rows
        The panel, and the word at the left of each row.
    series
        The sizes of the bars of a row, (rows,), and their colour or colours; several series share each row.
    texts
        What is written beside the end of each bar of one series; the axis has room for it.
    errors
        Half the length of the interval of each bar, (rows,) of each series.
    integer
        Whether the sizes are counts.
    names
        Of the series in the legend, or of the bars of a series.
    interval
        What the errors are, in the legend.
    """
    count, at = len(series), np.arange(len(rows))
    thick, step = (0.66, 0.0) if count == 1 else (0.72 / count, 0.76 / count)
    for k, (sizes, colour) in enumerate(series):
        place = at + (k - (count - 1) / 2) * step
        bars = ax.barh(place, sizes, thick, color=colour, zorder=3, label=names[k] if names else None)
        if texts:
            ax.bar_label(bars, texts, padding=3, color=colours.INK, size=fonts.small())
        for look in EDGE, LINE:
            if errors:
                label = interval if look is LINE and k == count - 1 else ""
                ax.errorbar(sizes, place, xerr=errors[k], linestyle="none", zorder=4, label=label, **look)
    if texts:
        sizes = series[0][0]
        low, high = min(sizes.min(), 0.0), max(sizes.max(), 0.0)
        room = ROOM * (high - low or 1.0)
        ax.set_xlim(low - (room if low < 0 else room / 6), high + (room if high > 0 else room / 6))
        ax.xaxis.set_major_locator(RoomLocator("counts" if integer else "numbers"))
    ax.set_yticks(at, [labels.mathematical(row) for row in rows])
    for word in ax.get_yticklabels():
        word.set_parse_math(True)
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.tick_params(axis="y", length=0, labelcolor=colours.INK, labelsize=fonts.small())
    ax.axvline(0, color=colours.SOFT, linewidth=0.8, zorder=4)
    ax.spines["left"].set_visible(False)


def _remark(ax: Axes, text: str) -> None:
    """A remark at the upper right of a panel."""
    ax.set_title(text, loc="right", pad=4, size=fonts.small(), color=colours.SOFT)


def _most_panels(sheet: Sheet, bars: int) -> int | None:
    """For how many panels of so many bars one column of a page has room; None elsewhere."""
    return max(int((print_heights.TALLEST - AROUND) / _height(bars)), 1) if sheet.narrow else None


def _height(bars: int) -> float:
    """Inches of a panel of so many bars."""
    return FRAME + BAR * max(bars, 2)


def _panels(
    stored: StoredStudy,
    names: Sequence[str],
    bars: int,
    panel: Callable[[str, Axes], None],
    said: Sequence[str],
    sheet: Sheet,
    option: str = "",
) -> Figure:
    """A panel of so many bars for each of the names, and one legend below.

    option: that which chooses among names; where it is given, those without room are named and not drawn.
    """
    most = (_most_panels(sheet, bars) if option else None) or len(names)
    said = [*said, *canvas.say_left_out(names[most:], option)]
    names = names[:most]
    columns = 1 if sheet.narrow else min(len(names), max(int(sheet.width / COLUMN), 1))
    rows = canvas.in_rows([partial(panel, name) for name in names], columns, _height(bars))
    return canvas.page(stored, sheet, rows, said, AROUND, high=False)


def _effects(stored: StoredStudy, name: str) -> list[tuple[str, float]]:
    """The fields that have an effect on an observable, and the effects, the largest first."""
    row = stored["effect"].sel(observable=name).values
    effects = [
        (str(f), float(v)) for f, v in zip(stored["field"].values, row, strict=True) if np.isfinite(v) and v != 0
    ]
    return [effects[k] for k in _order_of_size([abs(effect) for _, effect in effects])]


def _order_of_size(sizes: Sequence[float]) -> list[int]:
    """Their order, the largest first; of those that are equal but for rounding, as of E and L, that of the list."""
    return sorted(range(len(sizes)), key=lambda k: -float(f"{sizes[k]:.6g}"))


def _tick(stored: StoredStudy, field: str) -> str:
    """A field and by how much it rises: ``E, 1 %``, ``β₀, 1°``."""
    amount = str(stored["amount"].sel(field=field).values)
    return f"{quantity(field).symbol}, {labels.unit(amount.replace(' deg', '°'))}"


def _in_words(symbols: Mapping[str, str]) -> str:
    """The sentence that says what the symbols of fields stand for; symbols: field -> its symbol."""
    known = {symbol: QUANTITIES[field].long_name for field, symbol in symbols.items() if field in QUANTITIES}
    return f"{'; '.join(f'{symbol}: {labels.quantity_name(words)}' for symbol, words in known.items())}."


def _in_unit(number: float, unit: str, name: str) -> str:
    """A number of a quantity with its unit, an angle in degrees."""
    return labels.value(number, xr.DataArray(number, name=name, attrs={"units": unit}))
