"""An observable of a stored study against one of its axes."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ..stored.trend_lines import TrendLine
from ..words import labels
from . import colours, fonts
from .axis_scales import SPARE, RoomLocator, set_scale

MOST_DOTS = 50  # values of a line, beyond which it has no dots
ALONE = "Each rod was let go by itself: neighbours may be at different minima of the energy, and no line joins them."
UNBENT = "Bends of nearly straight rods are left out."
WITHIN = "estimated error"  # in a legend
WITHOUT = "solved, without a number"  # in a legend
BRACKET, CHANGE = "changes in between", "change"  # of a whole number: in a legend, and the gid of what shows it
APART = 0.08  # of the range of lines, from one end to the next: nearer ones have no room for their names
ALONE_BY = 0.02  # of that range, from the lowest or the highest end with a name to any other
NEAR = 0.08  # inches between two values of an axis whose dots touch: a step in their middle is right within a dot

Values = NDArray[np.float64]


def trend(line: TrendLine, ax: Axes) -> Axes:
    """A number of each case against an axis; of a grid the lines at other values of the other axes are pale, and have
    their names at the right where these have room, else the lowest and the highest. The legend has that of the dark
    line.

    More than `MOST_DOTS` cases are joined by a line in any case.
    """
    along = labels.in_label_unit(line.axis, line.along)
    lines, values = (labels.in_label_unit(line.observable, numbers) for numbers in (line.lines, line.values))
    set_scale(ax.xaxis, (float(along.min()), float(along.max())), line.is_logarithmic, SPARE)
    named, key = _names_at_ends(line, lines, values)
    entry: dict[str, Any] = {"label": key, "gid": line.held} if key else {}
    for k, other in enumerate(lines, 1):
        look: dict[str, Any] = {"color": colours.OTHERS, "linewidth": 1, "zorder": 1, "gid": f"{line.elsewhere}, {k}"}
        draw_line(ax, along, other, line.is_count, **look)
    for name, height in named:
        ax.annotate(name, (along[-1], height), (4, 0), textcoords="offset points", va="center", size=fonts.small(),
                    color=colours.SOFT)  # fmt: skip
    changes = np.empty(0, dtype=int)
    if _is_joined(line):
        look = {"color": colours.DATA, "linewidth": 1.2, "zorder": 2, **entry}
        changes = draw_line(ax, along, values, line.is_count, line.broken, **look)
    for k in changes.tolist():
        ax.plot(along[[k - 1, k]], [values[[k - 1, k]].mean()] * 2, color=colours.SOFT, linewidth=0.8, marker="|",
                markersize=5, zorder=1.9, label=BRACKET, gid=CHANGE)  # fmt: skip
    if along.size <= MOST_DOTS:
        ax.scatter(along, values, color=colours.DATA, s=15, zorder=4, edgecolors="white", linewidths=0.7,
                   **({} if _is_joined(line) else entry))  # fmt: skip
    mark_missing(ax, along, np.isfinite(values) | line.unbent, line.solved, named=True)
    if line.fold is not None:
        ax.axvline(float(np.degrees(line.fold)), color=colours.INK, linewidth=1, linestyle=(0, (4, 3)), label="fold")
    wide, high = fonts.inches(ax)
    along_label = fonts.fit_label(partial(labels.axis_label, line.axis, held="" if entry else line.held), wide)
    ax.set_xlabel(along_label if "\n" in along_label else fonts.wrap(along_label, ax))
    ax.set_ylabel(fonts.fit_label(partial(labels.label, line.observable), high))
    ax.margins(y=0.1)
    drawn = np.vstack([lines, values])
    drawn = drawn[np.isfinite(drawn)]
    if line.is_count:
        ax.yaxis.set_major_locator(RoomLocator("counts"))
        if drawn.size and np.ptp(drawn) < 2:
            count = round(float(drawn.mean()))
            ax.set_ylim(max(count - 2, min(count, 0) - 0.5), count + 2)
    elif drawn.size and np.ptp(drawn) and line.is_level:  # what rounding allows is no news
        middle = float(drawn.mean())
        half = max(0.1 * abs(middle), 10 * np.ptp(drawn))
        ax.set_ylim(middle - half, middle + half)
    if line.is_uncertain:
        low, high = (labels.in_label_unit(line.observable, end) for end in line.within)
        look = {"color": colours.DATA, "alpha": 0.25, "zorder": 1.5, "label": WITHIN}
        if along.size <= MOST_DOTS:  # an error is that of a case, and may jump to the next one
            ax.vlines(along, low, high, linewidth=3, **look)
        else:
            ax.fill_between(along, low, high, linewidth=0, step="mid", **look)
    return ax


def _names_at_ends(line: TrendLine, lines: Values, values: Values) -> tuple[list[tuple[str, float]], str]:
    """The names of the lines at other values with the heights of their ends, and the entry of the dark line, none where
    there are no others.

    All have names, or of the lowest and the highest end each has one that stands alone; without both the entry says the
    values.
    """
    others = [(name, float(row[-1])) for name, row in zip(line.names, lines, strict=False)
              if not np.array_equal(row, values)]  # fmt: skip
    named = sorted((pair for pair in others if np.isfinite(pair[1])), key=lambda pair: pair[1])
    if not named:
        return [], f"{line.held}; pale: {line.elsewhere}" if others else ""
    heights = np.array([height for _, height in named])
    span = float(np.nanmax(lines) - np.nanmin(lines))
    if len(named) == len(others) and np.all(np.diff(heights) > APART * span):
        return named, line.held
    first, last, *ends = (name.partition("= ")[2] for name, _ in [others[0], others[-1], named[0], named[-1]])
    near = [int((np.abs(np.append(heights, values[-1]) - height) < ALONE_BY * span).sum()) for height in heights]
    alone = {name: float(heights[k]) for name, k in zip(ends, (0, -1), strict=True) if near[k] == 1}
    return list(alone.items()), f"{line.held}; {'others pale' if len(alone) == 2 else f'pale: {first} to {last}'}"


def _is_joined(line: TrendLine) -> bool:
    return line.is_joined or line.along.size > MOST_DOTS


def say_gaps(lines: Sequence[TrendLine]) -> list[str]:
    """A sentence on where lines have gaps, but for those of whole numbers; none where they have none."""
    states = dict.fromkeys(name.replace("_", " ") for line in lines for name in line.states)
    begins = any(
        _begins(values).size
        for line in lines
        if not line.is_count
        for values in [*line.lines, *[line.values] * (_is_joined(line) and not line.alone)]
    )
    why = [*(f"{name} changes" for name in states), *["a number leaves 0"] * begins]
    return [f"A line breaks where {' or '.join(why)}."] * bool(why)


def say_errors(line: TrendLine) -> list[str]:
    """A sentence on the errors of a number where a picture shows them."""
    if not line.is_uncertain:
        return []
    most = labels.value(float(line.errors.max()), line.observable, 2)
    return [f"Pale: the estimated error of {labels.long_name(line.observable)}, up to {most}."]


def draw_line(
    ax: Axes,
    along: Values,
    values: Values,
    is_count: bool,
    broken: NDArray[np.int64] | tuple[()] = (),
    **look: Any,
) -> NDArray[np.int64]:
    """Draw values against those of an axis, with a gap before each of the places `broken`, and a dot where one stands
    alone.

    A whole number has a step between two values of the axis that stand at one place of the picture. Between others
    nobody knows where it changes: the line has a gap there too, before the places that are returned. So has that of a
    number which stays at 0 and then begins, as the curvature of a rod that buckles. look: options of `Axes.plot`.
    """
    changes = np.setdiff1d(np.flatnonzero(np.abs(np.diff(values)) > 0) + 1 if is_count else (), broken).astype(int)
    share = np.log(np.abs(along)) if ax.get_xscale() == "log" else along
    inches = np.abs(np.diff(share)) / (np.ptp(share) or 1.0) * fonts.inches(ax)[0]
    is_near = inches[changes - 1] < NEAR
    gaps = np.unique(np.concatenate([broken, changes, [] if is_count else _begins(values)])).astype(int)
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


def _begins(values: Values) -> NDArray[np.int64]:
    """The places before which values begin or end to be exactly 0, with another 0 beside that."""
    zero = values == 0
    level = zero & (np.append(zero[1:], False) | np.insert(zero[:-1], 0, False))
    return np.flatnonzero((level[1:] & ~zero[:-1]) | (level[:-1] & ~zero[1:])) + 1


def mark_missing(ax: Axes, at: Values, known: Any, solved: Any, named: bool = False, **look: Any) -> None:
    """On the lower edge a cross at each value whose case is not solved, and a ring at that of a solved one without a
    number, as a rod that does not bend has no number of bends; named: in a legend."""
    for missing, mark, label in ((~solved, "x", "unsolved"), (solved & ~known, "o", WITHOUT)):
        if missing.any():
            below = np.zeros(int(missing.sum()))
            ax.plot(at[missing], below, mark, color=colours.SOFT, clip_on=False, fillstyle="none",
                    transform=ax.get_xaxis_transform(), label=label * named, **look)  # fmt: skip
