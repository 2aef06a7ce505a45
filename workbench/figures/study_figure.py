"""The figure of a stored study: its developed curves along each axis, its samples, and a panel for each law."""

from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from solver.problem.errors import InputError
from studies.dimensions import SAMPLE

from ..data import labels, law_verdicts, observed, refined, schema
from . import canvas, legend, scatter, single_rod
from .developed import developed, has_curve, strip_height
from .law_panel import panel
from .trends import trend

WIDTH, LAW_HEIGHT = 9.6, 4.3  # inches
BESIDE, LEAST_BESIDE = 0.55, 2.6  # the share of the width that curves have beside a law, and inches they then need
MOST_PLAIN = 4  # observables shown where there is no law


def figure(ds: xr.Dataset, verdicts: Sequence[Mapping[str, Any]] | None = None) -> Figure:
    """Draw all of a study.

    With axes: for each axis of several values the developed curves, beside them each law in its panel (where there is
    no law, the first observables); of a refined study those of its coarse grid, along one axis with the observables of
    all cases. With samples: each observable against each sampled field. One case alone: its angle, its push and its
    developed curve.

    Parameters
    ----------
    verdicts
        The rows of `law_verdicts.verdicts` where they are known already; default: they are computed.

    Raises
    ------
    InputError
        The dataset's laws are invalid, or there is nothing to draw.
    """
    rows = law_verdicts.verdicts(ds) if verdicts is None else verdicts
    curves = ds
    if refined.is_refined(ds) and SAMPLE in ds["outcome"].dims:
        curves = refined.coarse(ds)
        ds = refined.line(ds) if len(refined.axes_of(ds)) == 1 else curves
    axes = schema.axes_of(ds)
    if all(ds.sizes[axis] == 1 for axis in axes):
        return single_rod.figure(ds.isel(dict.fromkeys(axes, 0)))
    sampled = SAMPLE in axes and bool(observed.observables(ds))
    if sampled:
        axes = [axis for axis in axes if axis != SAMPLE]
    plain = [] if rows or sampled else observed.observables(ds)[:MOST_PLAIN]
    axes = [axis for axis in axes if ds.sizes[axis] > 1]
    count, strips = len(rows or plain), axes if has_curve(curves) else []
    if not (count or strips or sampled):
        raise InputError("nothing to draw: the dataset has neither observables nor the arrays alpha and z")
    beside = count <= len(strips) and all(strip_height(curves, axis, WIDTH * BESIDE) > LEAST_BESIDE for axis in strips)
    beside = beside and not sampled
    heights = [LAW_HEIGHT if beside else strip_height(curves, axis, WIDTH) for axis in strips]
    below = 0 if beside else LAW_HEIGHT * -(-count // 2)
    heights += [below] if below else []
    heights += [scatter.ROW_HEIGHT * len(observed.observables(ds)) + 0.7] if sampled else []
    width = max(WIDTH, scatter.LEAST_WIDTH * len(scatter.fields_of(ds)) + 0.8) if sampled else WIDTH

    def draw(fig: Figure) -> None:
        ratios = (1.3, 1) if beside else (1,)
        grid = fig.add_gridspec(len(heights), len(ratios), height_ratios=heights, width_ratios=ratios)
        cells = [grid[i, 1] for i in range(count)] if beside else _pairs(grid[len(strips), 0], count) if below else []
        for i, axis in enumerate(strips):
            developed(curves, fig.add_subplot(grid[i, 0]), axis)
        if sampled:
            scatter.scatter(ds, fig, grid[len(heights) - 1, 0])
        for row, cell in zip(rows, cells, strict=False):
            panel(ds, fig.add_subplot(cell), row)
        for name, cell in zip(plain, cells, strict=False):
            ax = trend(ds, fig.add_subplot(cell), name, axes[0])
            ax.set_title(labels.long_name(ds[name]), loc="left")
            legend.add(ax)

    return canvas.figure((width, 0.7 + sum(heights)), draw, ds)


def _pairs(cell: Any, count: int) -> list[Any]:
    """That many cells, two a row."""
    grid = cell.subgridspec(-(-count // 2), min(count, 2))
    return [grid[i // 2, i % 2] for i in range(count)]
