"""An observable of a stored study against one of its axes, and samples: each observable against each sampled field."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from numpy.typing import NDArray

from studies.grammar.axes import SAMPLE

from ..stored.stored_study import StoredStudy
from ..words import labels
from . import canvas, colours, fonts
from .scales import SPARE, RoomLocator, is_logarithmic, set_scale

MOST_DOTS = 50  # values of a line, beyond which it has no dots
ROW_HEIGHT, LEAST_WIDTH, TALLEST = 2.1, 1.7, 6.7  # inches of a panel of samples; of all
NARROW_ROW, LEAST_PANEL, BESIDE = 1.25, 0.85, 0.75  # on a narrow sheet; inches of a panel at least; of ticks and label
FEW, MANY = 300, 4000  # samples up to which a dot is large, and beyond which the density is drawn
ALONE = "Each rod was let go by itself: neighbours may be at different minima of the energy, and no line joins them."
LEAST = 8  # samples of which a rank correlation says something
BINS = (90, 60)  # of the density
WITHOUT = "solved, without a number"  # in a legend
BRACKET, CHANGE = "changes in between", "change"  # of a whole number: in a legend, and the gid of what shows it
NEAR = 0.08  # inches between two values of an axis whose dots touch: a step in their middle is right within a dot

Values = NDArray[np.float64]


def trend(
    stored: StoredStudy,
    ax: Axes,
    observable: str,
    axis: str,
    at: dict[str, float] | None = None,
    joined: bool = True,
) -> Axes:
    """A stored number of each case against an axis; on a grid the line at `at` stands out and the others are faint.

    joined: whether a line joins the cases, and not another one that is drawn over them; more than `MOST_DOTS` have one.
    """
    order = stored.places(axis, at)
    on = {axis: [where[axis] for where in order]}
    along = labels.in_label_unit(stored[axis], stored[axis].values[on[axis]])
    lines = stored.of_solved(observable).transpose(..., axis).isel(on)
    lines = lines.copy(data=labels.in_label_unit(stored[observable], lines.values))
    others = {name: i for name, i in order[0].items() if name != axis}
    values = lines.isel(others).values.astype(float)
    is_count, logarithmic = observable in stored.counts, is_logarithmic(stored[axis])
    for line in lines.values.reshape(-1, along.size) if lines.ndim > 1 and not stored.stand_alone else ():
        draw_line(ax, along, line, is_count, logarithmic, color=colours.FAINT, linewidth=1, zorder=1)
    broken = np.empty(0, dtype=int)  # a line has a gap wherever the branch changes
    if "branch" in stored and set(stored["branch"].dims) == set(order[0]):
        broken = np.flatnonzero(np.diff(stored["branch"].isel(others | on).values)) + 1
    if stored.stand_alone:
        broken = np.arange(1, along.size)
    changes = np.empty(0, dtype=int)
    if joined or along.size > MOST_DOTS:
        look: dict[str, Any] = {"color": colours.DATA, "linewidth": 1.2, "zorder": 2}
        changes = draw_line(ax, along, values, is_count, logarithmic, broken, **look)
    for k in changes.tolist():
        ax.plot(along[[k - 1, k]], [values[[k - 1, k]].mean()] * 2, color=colours.SOFT, linewidth=0.8, marker="|",
                markersize=5, zorder=1.9, label=BRACKET, gid=CHANGE)  # fmt: skip
    if along.size <= MOST_DOTS:
        ax.scatter(along, values, color=colours.DATA, s=15, zorder=4, edgecolors="white", linewidths=0.7)
    solved = stored["solved"].transpose(..., axis).isel(on).isel(others).values
    _mark_missing(ax, along, np.isfinite(values), solved, named=True)
    low, high = float(along.min()), float(along.max())
    set_scale(ax.xaxis, (low, high), logarithmic, SPARE)
    if "fold" in stored and axis == stored.attrs.get("followed") and np.isfinite(stored["fold"]):
        ax.axvline(
            float(np.degrees(stored["fold"])), color=colours.INK, linewidth=1, linestyle=(0, (4, 3)), label="fold"
        )
    wide, high = fonts.inches(ax)
    ax.set_xlabel(fonts.wrap(fonts.fit_label(partial(axis_label, stored, axis, others), wide), ax))
    ax.set_ylabel(fonts.fit_label(partial(labels.label, stored[observable]), high))
    ax.margins(y=0.1)
    drawn = lines.values[np.isfinite(lines.values)]
    if is_count:
        ax.yaxis.set_major_locator(RoomLocator("counts"))
        if drawn.size and np.ptp(drawn) < 2:
            count = round(float(drawn.mean()))
            ax.set_ylim(max(count - 2, min(count, 0) - 0.5), count + 2)
    elif drawn.size and np.ptp(drawn) and stored.is_level(observable):  # what rounding allows is no news
        middle = float(drawn.mean())
        half = max(0.1 * abs(middle), 10 * np.ptp(drawn))
        ax.set_ylim(middle - half, middle + half)
    return ax


def draw_line(
    ax: Axes,
    along: Values,
    values: Values,
    is_count: bool,
    logarithmic: bool,
    broken: NDArray[np.int64] | tuple[()] = (),
    **look: Any,
) -> NDArray[np.int64]:
    """Draw values against those of an axis, with a gap before each of the places `broken`, and a dot where one stands
    alone.

    A whole number has a step between two values of the axis that stand at one place of the picture. Between others
    nobody knows where it changes: the line has a gap there too, before the places that are returned. look: options of
    `Axes.plot`.
    """
    changes = np.setdiff1d(np.flatnonzero(np.abs(np.diff(values)) > 0) + 1 if is_count else (), broken).astype(int)
    share = np.log(np.abs(along)) if logarithmic else along
    inches = np.abs(np.diff(share)) / (np.ptp(share) or 1.0) * fonts.inches(ax)[0]
    is_near = inches[changes - 1] < NEAR
    gaps = np.union1d(broken, changes).astype(int)
    known = np.isfinite(values)
    joined = known[1:] & known[:-1] & ~np.isin(np.arange(1, values.size), gaps)
    alone = np.flatnonzero(known & ~np.append(joined, False) & ~np.insert(joined, 0, False))
    dots = {"marker": ".", "markersize": 3, "markevery": (alone + np.searchsorted(gaps, alone, "right")).tolist()}
    ax.plot(
        *(np.insert(row.astype(float), gaps, np.nan) for row in (along, values)), **(dots if alone.size else {}), **look
    )
    if (near := changes[is_near]).size:
        (left, right), (first, last) = ((row[near - 1], row[near]) for row in (along, values))
        middle, gap = (left + right) / 2, np.full(near.size, np.nan)
        x, y = np.stack([left, middle, middle, right, gap], 1), np.stack([first, first, last, last, gap], 1)
        ax.plot(x.ravel(), y.ravel(), **{**look, "label": "", "gid": CHANGE})
    return changes[~is_near]


def axis_label(stored: StoredStudy, axis: str, where: dict[str, int], long: bool = True) -> str:
    """The axis with its unit, and the values at which the other axes are held."""
    held = stored.equations({name: i for name, i in where.items() if name != axis})
    return labels.axis_label(stored[axis], long) + (f", at {held}" if held else "")


def _mark_missing(ax: Axes, at: Values, known: Any, solved: Any, named: bool = False, **look: Any) -> None:
    """On the lower edge a cross at each value whose case is not solved, and a ring at that of a solved one without a
    number, as a rod that does not bend has no number of bends; named: in a legend."""
    for missing, mark, label in ((~solved, "x", "unsolved"), (solved & ~known, "o", WITHOUT)):
        if missing.any():
            below = np.zeros(int(missing.sum()))
            ax.plot(at[missing], below, mark, color=colours.SOFT, clip_on=False, fillstyle="none",
                    transform=ax.get_xaxis_transform(), label=label * named, **look)  # fmt: skip


def samples(stored: StoredStudy, names: Sequence[str], width: float, narrow: bool) -> tuple[list[canvas.Row], str]:
    """Each of these observables against each sampled field, in rows of panels of a figure of so many inches.

    Beside samples the dataset may have axes: they are held where the laws or Table 1 put them. Each panel says the rank
    correlation (Spearman) of its two quantities, over the samples that have a number. Returns the rows, and a sentence
    about them.
    """
    held = {axis: i for axis, i in stored.place().items() if axis != SAMPLE}
    every, most, high = (
        stored.sampled,
        max(int((width - BESIDE) / LEAST_PANEL), 1),
        NARROW_ROW if narrow else ROW_HEIGHT,
    )
    most = -(-len(every) // -(-len(every) // most))  # as many in each row
    blocks = [every[i : i + most] for i in range(0, len(every), most)]
    whole = min(len(blocks) * (high * len(names) + 0.5), max(TALLEST, 1.1 * len(blocks) * len(names)))
    across = len(blocks[0])
    room = (width - BESIDE) / across - 0.1

    def draw(name: str, field: str, fields: list[str], ax: Axes) -> None:
        ax.set_label(f"{name} against {field}")
        _draw_samples(stored.select(held), ax, name, field, room)
        ax.tick_params(labelleft=field == fields[0], labelbottom=name == names[-1])
        if name == names[-1]:
            ax.set_xlabel(fonts.fit_label(partial(labels.axis_label, stored[field]), room))
        if field == fields[0]:
            words = [fonts.break_lines(labels.label(stored[name], long), 1.2) for long in (True, False)]
            ax.set_ylabel(words[words[0].count("\n") > 1])

    rows = [
        row
        for fields in blocks
        for name in names
        for row in canvas.in_rows(
            [partial(draw, name, field, fields) for field in fields], across, whole / len(names) / len(blocks)
        )
    ]
    count, at = stored.sizes[SAMPLE], stored.equations(held)
    dense = "; the darker, the more samples" if count > MANY else ""
    return rows, f"{count} sample{'s' * (count != 1)}{f', at {at}' if at else ''}; r: rank correlation{dense}."


def _draw_samples(stored: StoredStudy, ax: Axes, name: str, field: str, room: float) -> None:
    """One observable against one field, on a panel of so many inches."""
    x, y = (labels.in_label_unit(stored[key], stored[key].values) for key in (field, name))
    known, solved = np.isfinite(y), stored["solved"].values
    logarithmic = is_logarithmic(stored[field])
    set_scale(ax.xaxis, (float(x.min()), float(x.max())), logarithmic, SPARE)
    if known.sum() > MANY:
        _density(ax, x[known], y[known], logarithmic)
    else:
        size, alpha = (16, 0.75) if x.size <= FEW else (5, 0.45)
        area = size * min(room / ROW_HEIGHT, 1.0) ** 2
        ax.scatter(x[known], y[known], s=area, color=colours.DATA, alpha=alpha, linewidths=0, zorder=3)
    _mark_missing(ax, x, known, solved, markersize=4, rasterized=x.size > MANY)
    if (r := rank_correlation(x[known], y[known])) is not None:
        ax.set_title(f"r = {r:+.2f}".replace("-", "−"), loc="right", size=fonts.small(), color=colours.SOFT, pad=2)
    ax.yaxis.set_major_locator(RoomLocator("counts" if name in stored.counts else "numbers"))
    ax.margins(y=0.12)


def rank_correlation(x: Values, y: Values) -> float | None:
    """Spearman's rank correlation; None for fewer than `LEAST` samples, or where one of the two is constant."""
    from scipy.stats import rankdata

    if x.size < LEAST or np.ptp(x) == 0 or np.ptp(y) == 0:
        return None
    return float(np.corrcoef(rankdata(x), rankdata(y))[0, 1])


def _density(ax: Axes, x: Values, y: Values, logarithmic: bool) -> None:
    """How many samples lie where, on a logarithmic scale of colours: dots would hide one another."""
    space = np.geomspace if logarithmic else np.linspace
    spare = 0.01 * (float(np.ptp(y)) or abs(float(y[0])) or 1.0)
    bins: Any = [space(x.min(), x.max(), BINS[0] + 1), np.linspace(y.min() - spare, y.max() + spare, BINS[1] + 1)]
    ax.hist2d(x, y, bins, cmin=1, cmap=colours.COUNTS, norm=LogNorm(0.3), rasterized=True, zorder=3)
    ax.use_sticky_edges = False
