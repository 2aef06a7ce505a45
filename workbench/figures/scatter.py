"""Scatter diagrams of a study of samples: a row for each observable, a column for each sampled field."""

from collections.abc import Sequence
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from numpy.typing import NDArray

from studies.grammar.axes import SAMPLE
from studies.laws.line_verdicts import FAILS

from ..store import schema, selection
from ..words import labels
from . import canvas, colours, fonts
from .scales import SPARE, WIDE, RoomLocator, set_scale

ROW_HEIGHT, LEAST_WIDTH, TALLEST = 2.1, 1.7, 6.7  # inches of a panel; of all
NARROW_ROW, LEAST_PANEL, BESIDE = 1.25, 0.85, 0.75  # on a narrow sheet; inches of a panel at least; of ticks and label
FEW, MANY = 300, 4000  # samples up to which a dot is large, and beyond which the density is drawn
LEAST = 8  # samples of which a rank correlation says something
BINS = (90, 60)  # of the density

Values = NDArray[np.float64]


def fields_of(ds: xr.Dataset) -> list[str]:
    """The sampled fields, as the dataset names them: the columns."""
    return [schema.dimension(name) for name in schema.fields_of_samples(ds)]


def blocks_of(ds: xr.Dataset, width: float) -> list[list[str]]:
    """The fields in blocks, one below the other, whose panels have room side by side in so many inches."""
    fields, across = fields_of(ds), max(int((width - BESIDE) / LEAST_PANEL), 1)
    return [fields[i : i + across] for i in range(0, len(fields), across)]


def said(ds: xr.Dataset) -> str:
    """How many samples there are, where the axes are held, and what r is."""
    at = labels.equations(ds, {axis: i for axis, i in selection.case(ds).items() if axis != SAMPLE})
    count = f"{ds.sizes[SAMPLE]} sample{'s' * (ds.sizes[SAMPLE] != 1)}"
    dense = "; the darker, the more samples" if ds.sizes[SAMPLE] > MANY else ""
    return f"{count}{f', at {at}' if at else ''}; r: rank correlation{dense}."


def rows(ds: xr.Dataset, names: Sequence[str], width: float, narrow: bool) -> list[canvas.Row]:
    """Each of these observables against each sampled field, in rows of panels of a figure of so many inches.

    Beside samples the dataset may have axes: they are held where the laws or Table 1 put them. Each panel says the rank
    correlation (Spearman) of its two quantities, over the solved samples.
    """
    held = {axis: i for axis, i in selection.case(ds).items() if axis != SAMPLE}
    here, blocks, high = ds.isel(held), blocks_of(ds, width), NARROW_ROW if narrow else ROW_HEIGHT
    whole = min(len(blocks) * (high * len(names) + 0.5), max(TALLEST, 1.1 * len(blocks) * len(names)))
    across = max(map(len, blocks))
    room = (width - BESIDE) / across - 0.1

    def draw(name: str, field: str, fields: list[str], ax: Axes) -> None:
        ax.set_label(f"{name} against {field}")
        _panel(here, ax, name, field, room)
        ax.tick_params(labelleft=field == fields[0], labelbottom=name == names[-1])
        if name == names[-1]:
            words = [labels.axis_label(field, ds[field], long) for long in (True, False)]
            ax.set_xlabel(fonts.shorter(words, room))
        if field == fields[0]:
            words = [fonts.break_lines(labels.label(ds[name], long), 1.2) for long in (True, False)]
            ax.set_ylabel(words[words[0].count("\n") > 1])

    return [
        (whole / len(names) / len(blocks), [*(partial(draw, name, field, fields) for field in fields),
                                            *[None] * (across - len(fields))])
        for fields in blocks for name in names
    ]  # fmt: skip


def _panel(ds: xr.Dataset, ax: Axes, name: str, field: str, room: float) -> None:
    """One observable against one field, on a panel of so many inches."""
    x, y = labels.in_label_unit(ds[field], ds[field].values), labels.in_label_unit(ds[name], ds[name].values)
    solved = np.isfinite(y)
    logarithmic = _scale(ax, x)
    if solved.sum() > MANY:
        _density(ax, x[solved], y[solved], logarithmic)
    else:
        size, alpha = (16, 0.75) if x.size <= FEW else (5, 0.45)
        area = size * min(room / ROW_HEIGHT, 1.0) ** 2
        ax.scatter(x[solved], y[solved], s=area, color=colours.DATA, alpha=alpha, linewidths=0, zorder=3)
    if not solved.all():
        ax.plot(x[~solved], np.zeros(int((~solved).sum())), "x", color=colours.VERDICTS[FAILS], markersize=4,
                clip_on=False, transform=ax.get_xaxis_transform(), rasterized=x.size > MANY)  # fmt: skip
    if (found := rank_correlation(x[solved], y[solved])) is not None:
        ax.set_title(f"r = {found:+.2f}".replace("-", "−"), loc="right", size=fonts.small(), color=colours.SOFT, pad=2)
    ax.yaxis.set_major_locator(RoomLocator("counts" if selection.is_count(ds, name) else "numbers"))
    ax.margins(y=0.12)


def rank_correlation(x: Values, y: Values) -> float | None:
    """Spearman's rank correlation; None for fewer than `LEAST` samples, or where one of the two is constant."""
    from scipy.stats import rankdata

    if x.size < LEAST or np.ptp(x) == 0 or np.ptp(y) == 0:
        return None
    return float(np.corrcoef(rankdata(x), rankdata(y))[0, 1])


def _scale(ax: Axes, x: Values) -> bool:
    """A logarithmic axis where the samples are spread more evenly so; whether it is one."""
    low, middle, high = float(x.min()), float(np.median(x)), float(x.max())
    even = low > 0 and abs(middle - np.sqrt(low * high)) < abs(middle - (low + high) / 2)
    logarithmic = even and high > WIDE * low
    set_scale(ax.xaxis, (low, high), logarithmic, SPARE)
    return logarithmic


def _density(ax: Axes, x: Values, y: Values, logarithmic: bool) -> None:
    """How many samples lie where, on a logarithmic scale of colours: dots would hide one another."""
    low, high = float(x.min()), float(x.max())
    space = np.geomspace if logarithmic else np.linspace
    span = float(np.ptp(y)) or abs(float(y[0])) or 1.0
    edges = np.linspace(float(y.min()) - 0.01 * span, float(y.max()) + 0.01 * span, BINS[1] + 1)
    counts, across, up = np.histogram2d(x, y, bins=[space(low, high, BINS[0] + 1), edges])
    ax.pcolormesh(
        across, up, np.ma.masked_equal(counts.T, 0), cmap=colours.COUNTS, norm=LogNorm(0.3, max(counts.max(), 1.0)),
        rasterized=True, zorder=3,
    )  # fmt: skip
    ax.use_sticky_edges = False
