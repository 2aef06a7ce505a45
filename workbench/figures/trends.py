"""Trends and developed curves of a stored dataset, as Matplotlib figures without pyplot and without solving."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullLocator

from solver.observe.observables import is_count
from solver.problem.errors import InputError, no_such
from studies.laws import DIRECTIONS, FAILS, NOISE
from studies.reasons import DOES

from ..data import law_verdicts, schema, selection
from . import single_rod, style
from .developed import axis_label, developed, strip_height

KINDS = (".png", ".pdf", ".svg")
WIDTH, LAW_HEIGHT = 9.6, 4.3  # inches
BESIDE, LEAST_BESIDE = 0.55, 2.6  # the share of the width that curves have beside a law, and inches they then need
MOST_PLAIN = 4  # observables shown where there is no law
NOT_OBSERVED = ("outcome", "error", "condition", "FZ", "MZ", "M3", "dbeta0")


def figure(ds: xr.Dataset, path: str | Path, dpi: int = style.DPI) -> Figure:
    """Draw all of a study and save it as PNG (of that many dots an inch), PDF or SVG by the name's ending.

    A study with axes: for each axis the developed curves, beside them each law in its panel (where there is no law,
    the first observables). One case alone: its angle, its contact and its developed curve. Raises `InputError`.
    """
    path = Path(path)
    style.picture_kind(path, KINDS)
    axes = schema.axes_of(ds)
    with rc_context(style.RC):
        fig = _trends(ds, axes) if axes else single_rod.figure(ds)
        style.entitle(fig, ds)
        fig.savefig(path, dpi=dpi)
    return fig


def panel(ds: xr.Dataset, ax: Axes, law: int = 0, rows: Sequence[dict[str, Any]] | None = None) -> Axes:
    """A law's observable against its axis, with the verdict and its reason; of the study's laws the one of that number.

    rows: those of `check.verdicts`, where they are known already. Raises `InputError` where there is no such law.
    """
    rows = law_verdicts.verdicts(ds) if rows is None else rows
    if not 0 <= law < len(rows):
        raise InputError(f"no law number {law}: the study has {len(rows)}")
    row = rows[law]
    trend(ds, ax, row["observable"], row["axis"], row["at"])
    for step in row["exceptions"]:
        if all(step["at"][name] == value for name, value in row["at"].items()):
            ends = [_shown(ds[row["axis"]], step[end]) for end in ("from", "to")]
            ax.plot(ends, step["values"], color=style.VERDICT_COLOURS[FAILS], linewidth=3, alpha=0.75, zorder=3,
                    label="a step the wrong way")  # fmt: skip
    words = f"{row['claim']}  {style.words(ds[row['observable']])} {DIRECTIONS[row['direction']].does} with"
    pad = 6 + _verdict(ax, row)
    ax.set_title(style.wrapped(f"{words} {style.symbol(row['axis'])}:", ax), loc="left", pad=pad)
    if row["also"]:
        text = style.wrapped(_others(ds, row), ax, style.SMALL)
        lines = "\n" * (text.count("\n") + 2)
        ax.set_xlabel(ax.get_xlabel() + lines, linespacing=0.95)  # room that the layout sees
        note = ax.annotate(text, (0, 0), (-8, -38), xycoords="axes fraction", textcoords="offset points", va="top",
                           size=style.SMALL, color=style.SOFT)  # fmt: skip
        note.set_in_layout(False)
    _legend(ax)
    return ax


def _verdict(ax: Axes, row: dict[str, Any]) -> float:
    """Write the verdict above the axes and its reason below it, in the verdict's colour; their height in points."""
    colour = style.VERDICT_COLOURS[row["verdict"]]
    reason = style.wrapped(style.reason(row, law_verdicts.detail(row)), ax, style.SMALL)
    below = 11 * (reason.count("\n") + 1) if reason else 0
    lift: dict[str, Any] = {"xycoords": "axes fraction", "textcoords": "offset points", "va": "bottom", "color": colour}
    ax.annotate(reason, (0, 1), (0, 3), size=style.SMALL, **lift)
    ax.annotate(row["verdict"], (0, 1), (0, 3 + below), weight="bold", **lift)
    return below + 14


def _others(ds: xr.Dataset, row: dict[str, Any]) -> str:
    """The verdicts of the other observables: those as plausible as the law's own, then the rest."""
    told = []
    for words, equal in (("As plausible", True), ("Also admitted by the sentence", False)):
        some = [also for also in row["also"] if also["alternative"] == equal]
        if some:
            brief = "; ".join(f"{style.short(ds[also['observable']])} {_brief(also)}" for also in some)
            told.append(f"{words}: {brief}.")
    return " ".join(told)


def trend(ds: xr.Dataset, ax: Axes, observable: str, axis: str, at: dict[str, float] | None = None) -> Axes:
    """An observable against an axis; on a grid the line at `at` stands out and the others are faint.

    Raises `InputError` for an observable or axis that is not stored.
    """
    if observable not in ds:
        raise no_such("observable", observable, [str(name) for name in ds.data_vars])
    order = selection.line(ds, axis, at)
    along = _shown(ds[axis], ds[axis].values[[where[axis] for where in order]])
    lines = ds[observable].transpose(..., axis).isel({axis: [where[axis] for where in order]})
    for line in lines.values.reshape(-1, along.size) if lines.ndim > 1 else ():
        ax.plot(along, line, color=style.FAINT, linewidth=1, zorder=1)
    others = {name: i for name, i in order[0].items() if name != axis}
    values = lines.isel(others).values.astype(float)
    ax.plot(along, values, color=style.SOFT, linewidth=1.2, zorder=2)
    ax.scatter(along, values, c=style.colours(along.size), s=34, zorder=4, edgecolors="white", linewidths=0.7)
    unsolved = ~np.isfinite(values)
    if unsolved.any():
        ax.plot(along[unsolved], np.zeros(unsolved.sum()), "x", color=style.VERDICT_COLOURS[FAILS], clip_on=False,
                transform=ax.get_xaxis_transform(), label="unsolved")  # fmt: skip
    _scale(ax, ds, axis, along)
    if "fold" in ds and axis == "betaL" and np.isfinite(ds["fold"]):
        ax.axvline(float(np.degrees(ds["fold"])), color=style.INK, linewidth=1, linestyle=(0, (4, 3)), label="fold")
    ax.set_xlabel(axis_label(ds, axis, others, long=False))
    ax.set_ylabel(style.label(ds[observable]))
    ax.margins(x=0.04, y=0.1)
    ax.yaxis.set_major_formatter(style.plain)
    drawn = lines.values[np.isfinite(lines.values)]
    if is_count(observable):
        ax.yaxis.set_major_locator(MaxNLocator(integer=True))
        if drawn.size and np.ptp(drawn) < 2:
            count = round(float(drawn.mean()))
            ax.set_ylim(count - 2, count + 2)
    elif drawn.size and 0 < np.ptp(drawn) < NOISE * np.abs(drawn).max():  # rounding is no news
        middle = float(drawn.mean())
        ax.set_ylim(middle - 0.1 * abs(middle), middle + 0.1 * abs(middle))
    return style.quiet(ax)


def _trends(ds: xr.Dataset, axes: Sequence[str]) -> Figure:
    """Each law beside the curves along an axis, or all laws in a row below where there are more of them."""
    judged = law_verdicts.verdicts(ds)
    count = len(judged)
    plain = [] if count else [str(name) for name in ds.data_vars if _observed(ds, str(name))][:MOST_PLAIN]
    panels = count or len(plain)
    rows = len(axes) if single_rod.has_shape(ds) else 0
    beside = panels <= rows and all(strip_height(ds, axis, WIDTH * BESIDE) > LEAST_BESIDE for axis in axes)
    below = 0 if beside else LAW_HEIGHT * -(-panels // 2)
    fig = Figure(figsize=(WIDTH, 1), layout="constrained")
    FigureCanvasAgg(fig)
    heights = [LAW_HEIGHT if beside else strip_height(ds, axis, WIDTH) for axis in axes[:rows]]
    heights += [below] if below else []
    fig.set_figheight(0.7 + sum(heights))
    grid = fig.add_gridspec(
        len(heights), 2 if beside else 1, height_ratios=heights, width_ratios=(1.3, 1) if beside else (1,)
    )
    cells = [grid[i, 1] for i in range(panels)] if beside else _pairs(grid[rows, 0], panels)
    for i, axis in enumerate(axes[:rows]):
        developed(ds, fig.add_subplot(grid[i, 0]), axis)
    for i, cell in enumerate(cells):
        ax = fig.add_subplot(cell)
        if count:
            panel(ds, ax, i, judged)
        else:
            trend(ds, ax, plain[i], axes[0])
            ax.set_title(style.words(ds[plain[i]]), loc="left")
            _legend(ax)
    return fig


def _pairs(cell: Any, count: int) -> list[Any]:
    """So many cells, two a row."""
    grid = cell.subgridspec(-(-count // 2), min(count, 2))
    return [grid[i // 2, i % 2] for i in range(count)]


def _observed(ds: xr.Dataset, name: str) -> bool:
    numbers = ds[name].dtype.kind in "iuf"  # `caution` is text
    return numbers and ds[name].dims == ds["outcome"].dims and not name.endswith("error") and name not in NOT_OBSERVED


def _brief(row: dict[str, Any]) -> str:
    """What an observable does, in the words of its verdict, and how often it goes the wrong way."""
    wrong, does = len(row["exceptions"]), DOES[row["verdict"]][0]
    return f"{does} ({wrong} step{'s' * (wrong > 1)} wrong)" if wrong else does


def _shown(axis: xr.DataArray, values: Any) -> Any:
    return np.degrees(values) if style.is_angle(axis) else np.asarray(values, dtype=float)


def _scale(ax: Axes, ds: xr.Dataset, axis: str, along: Any) -> None:
    """A logarithmic axis where the values are spaced so, with ticks at some of them."""
    if along.size < 3 or along.min() <= 0:
        return _linear(ax)
    steps = np.diff(np.log(along))
    if np.ptp(steps) < 1e-6 * steps.mean() and along[-1] / along[0] > 3:
        ax.set_xscale("log")
        some = along[:: max((along.size - 1) // 4, 1)]
        ax.xaxis.set_minor_locator(NullLocator())
        ax.set_xticks(some, [style.number(float(value)) for value in some])
    else:
        _linear(ax)


def _linear(ax: Axes) -> None:
    """Few enough ticks that their numbers do not meet."""
    ax.xaxis.set_major_locator(MaxNLocator(nbins=5))
    ax.xaxis.set_major_formatter(style.plain)


def _legend(ax: Axes) -> None:
    handles, labels = ax.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    if once:
        ax.legend(list(once.values()), list(once), loc="best")
