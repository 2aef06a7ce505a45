"""The figure of a stored study: its developed curves along each axis, its samples, and a panel for each law."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solver.problem.errors import InputError, no_such
from studies.dimensions import SAMPLE

from ..data import labels, law_verdicts, observed, refined, schema
from . import canvas, legend, scatter, single_rod
from .developed import STRIP, developed, has_curve, strip_height
from .law_panel import panel
from .sheet import SCREEN, Sheet
from .trends import trend

LAW_HEIGHT, LEAST_LAW = 4.3, 2.7  # inches
SAMPLES = "samples"  # the panel of the scatter diagrams
BESIDE, LEAST_BESIDE = 0.55, 3.2  # the share of the width that curves have beside a law, and inches they then need
MOST_PLAIN = 4  # observables shown where there is no law


def figure(ds: xr.Dataset, verdicts: Sequence[Mapping[str, Any]] | None = None, sheet: Sheet = SCREEN) -> Figure:
    """Draw all of a study.

    With axes: for each axis of several values the developed curves, beside them each law in its panel (where there is
    no law, the first observables); of a refined study those of its coarse grid, along one axis with the observables of
    all cases. With samples: each observable against each sampled field. One case alone: its angle, its push and its
    developed curve.

    Parameters
    ----------
    verdicts
        The rows of `law_verdicts.verdicts` where they are known already; default: they are computed.
    sheet
        What the figure is drawn for. Its `panel` is an axis (the developed curves along it), the claim of a law (of
        several laws of one claim also the claim with the observable), an observable, or ``samples``.

    Raises
    ------
    InputError
        The dataset's laws are invalid, there is nothing to draw, or the figure has no such panel.
    """
    rows = law_verdicts.verdicts(ds) if verdicts is None else verdicts
    curves = ds
    if refined.is_refined(ds) and SAMPLE in ds["outcome"].dims:
        curves = refined.coarse(ds)
        ds = refined.line(ds) if len(refined.axes_of(ds)) == 1 else curves
    axes = schema.axes_of(ds)
    if all(ds.sizes[axis] == 1 for axis in axes):
        return single_rod.figure(ds.isel(dict.fromkeys(axes, 0)), sheet)
    sampled = SAMPLE in axes and bool(observed.observables(ds))
    if sampled:
        axes = [axis for axis in axes if axis != SAMPLE]
    plain = [] if rows or sampled else observed.observables(ds)
    plain, level = _told(ds, plain, sheet.panel)
    axes = [axis for axis in axes if ds.sizes[axis] > 1]
    strips = axes if has_curve(curves) else []
    if not (rows or plain or strips or sampled):
        raise InputError("nothing to draw: the dataset has neither observables nor the arrays alpha and z")
    strips, rows, plain, sampled = _only(sheet.panel, strips, rows, plain, sampled)
    count, width = len(rows or plain), sheet.width
    beside = 0 < count <= len(strips) and all(
        strip_height(curves, axis, width * BESIDE) > LEAST_BESIDE for axis in strips
    )
    beside = beside and not sampled and not sheet.narrow
    across = 1 if sheet.narrow else 3 if len(plain) == 3 and not rows else 2
    law_height = min(LAW_HEIGHT, max(0.9 * width / across, LEAST_LAW))
    heights = [law_height if beside else strip_height(curves, axis, width) for axis in strips]
    below = 0 if beside else law_height * -(-count // across)
    heights += [below] if below else []
    if sampled and sheet.style == SCREEN.style and not sheet.narrow:
        width = max(width, scatter.LEAST_WIDTH * len(scatter.fields_of(ds)) + 0.8)
    heights += [scatter.height(ds, width, sheet.narrow)] if sampled else []

    def draw(fig: Figure) -> None:
        ratios = (1.3, 1) if beside else (1,)
        grid = fig.add_gridspec(len(heights), len(ratios), height_ratios=heights, width_ratios=ratios)
        cells = [grid[i, 1] for i in range(count)] if beside else []
        if below:
            cells = _in_rows(grid[len(strips), 0], count, across)
        for i, axis in enumerate(strips):
            drawn.append(developed(curves, fig.add_subplot(grid[i, 0]), axis, sheet))
        if sampled:
            scatter.scatter(ds, fig, grid[len(heights) - 1, 0], width)
            legend.below(fig, [], [scatter.said(ds)], sheet)
        for row, cell in zip(rows, cells, strict=False):
            panel(ds, fig.add_subplot(cell), row, sheet)
        for name, cell in zip(plain, cells, strict=False):
            ax = trend(ds, fig.add_subplot(cell), name, axes[0])
            ax.set_title(labels.long_name(ds[name]), loc="left")
            legend.add(ax)
        if plain and level:
            legend.below(fig, [], level, sheet)

    drawn: list[Axes] = []
    fig = canvas.figure((width, 0.7 * sheet.titled + 0.3 * sampled + sum(heights)), draw, ds, sheet=sheet)
    if not beside:
        canvas.close_gaps(fig, drawn, STRIP[1])
    return fig


def _told(ds: xr.Dataset, names: list[str], panel: str | None) -> tuple[list[str], list[str]]:
    """The observables that get a panel, and sentences about counts that are the same in all cases and get none."""
    level = [name for name in names if name != panel and observed.is_count(ds, name) and _is_level(ds[name])]
    if len(level) == len(names):
        return names[:MOST_PLAIN], []
    said = [f"{labels.long_name(ds[name])}: {float(ds[name].max()):g} in all cases." for name in level]
    return [name for name in names if name not in level][:MOST_PLAIN], [text[0].upper() + text[1:] for text in said]


def _is_level(array: xr.DataArray) -> bool:
    return bool((array == array.values.flat[0]).all())


def _only(
    name: str | None, strips: list[str], rows: Sequence[Mapping[str, Any]], plain: list[str], sampled: bool
) -> tuple[list[str], Sequence[Mapping[str, Any]], list[str], bool]:
    """The panels of that name; all where it is None. Raises `InputError` where there is none."""
    if name is None:
        return strips, rows, plain, sampled
    laws = _named(rows)
    known = [*strips, *(str(row["claim"]) for row in rows), *laws, *plain, *([SAMPLES] if sampled else [])]
    if name not in known:
        raise no_such("panel", name, dict.fromkeys(known))
    some = [axis for axis in strips if axis == name]
    chosen = [laws[name]] if name in laws else [row for row in rows if row["claim"] == name]
    return some, chosen, [one for one in plain if one == name], name == SAMPLES


def _named(rows: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """The laws that share their claim by names of their own: ``(4) turns``, with the axis where that is not enough."""
    claims = Counter(row["claim"] for row in rows)
    short = Counter((row["claim"], row["observable"]) for row in rows)
    found: dict[str, Mapping[str, Any]] = {}
    for row in rows:
        if claims[row["claim"]] > 1:
            words = [row["claim"], row["observable"]]
            found[" ".join([*words, row["axis"]] if short[tuple(words)] > 1 else words)] = row
    return found


def _in_rows(cell: Any, count: int, across: int) -> list[Any]:
    """That many cells, so many a row."""
    grid = cell.subgridspec(-(-count // across), min(count, across))
    return [grid[i // across, i % across] for i in range(count)]
