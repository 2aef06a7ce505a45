"""The laws on maps: beside a map the verdict on each line of the grid, and on it the line that decides.

A law along an axis that the map does not have is judged on one line for each cell: it has a map of its own.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from studies.laws import law_words
from studies.laws.law_words import PLAIN, count
from studies.laws.line_verdicts import HOLDS, VERDICTS

from ..store import law_verdicts, refined, schema
from ..words import labels
from . import colours
from .map_cells import Cells, Choice

THICK, GAP = 0.06, 0.04  # inches of a strip of verdicts, and between strips
DECIDES: dict[str, Any] = {"color": colours.INK, "linewidth": 1.3, "linestyle": (0, (5, 2))}

_COLOURS: dict[str, Any] = {
    "cmap": ListedColormap([colours.VERDICTS[verdict] for verdict in VERDICTS]),
    "vmin": -0.5,
    "vmax": len(VERDICTS) - 0.5,
}


@dataclass(frozen=True, eq=False)
class JudgedLaw:
    """A law on a map: its row of `law_verdicts.verdicts`, and the verdict on each line of the grid."""

    row: Mapping[str, Any]
    lines: xr.DataArray

    def at(self, where: Mapping[str, int]) -> xr.DataArray:
        """The verdicts at indices on other axes; a law has none along its own."""
        return self.lines.isel({name: i for name, i in where.items() if name in self.lines.dims})

    def is_mixed(self) -> bool:
        """Whether lines differ in their verdict."""
        return np.unique(self.lines.values).size > 1


def judge(ds: xr.Dataset, choice: Choice, rows: Sequence[Mapping[str, Any]]) -> tuple[list[JudgedLaw], list[JudgedLaw]]:
    """The laws on the observables shown: those along an axis of the map, and those along a further axis.

    rows: of `law_verdicts.verdicts`, in the same order.
    """
    shown = [
        (law.axis, JudgedLaw(row, law_verdicts.verdicts_of_lines(ds, law)))
        for law, row in zip(schema.laws_of(ds), rows, strict=True)
        if law.observable in choice.shown
    ]
    axes = (choice.x, choice.y)
    return [law for axis, law in shown if axis in axes], [law for axis, law in shown if axis not in axes]


def draw(
    ax: Axes, laws: Sequence[JudgedLaw], cells: Cells, choice: Choice, where: Mapping[str, int],
    inches: tuple[float, float],
) -> list[Artist]:  # fmt: skip
    """Draw the laws on a map of that width and height in inches; returns the entries of the legend.

    where: the indices on the other axes.
    """
    entries: list[Artist] = []
    beside = above = 0
    for law in laws:
        upward = law.row["axis"] == choice.x  # its lines lie one above the other
        across = choice.y if upward else choice.x
        verdicts = law.at(where).sortby(across).values
        _strip(ax, cells, verdicts, upward, beside if upward else above, inches)
        beside, above = beside + upward, above + (not upward)
        entries += _entries(verdicts, all_of_them=False)
        value = _decisive_value(law.row, cells.ds, across, where)
        if value is not None:
            (ax.axhline if upward else ax.axvline)(value, **DECIDES)
            entries.append(Line2D([], [], **DECIDES, label="the law is judged on this line"))
    return entries


def draw_map(ax: Axes, law: JudgedLaw, cells: Cells, where: Mapping[str, int]) -> list[Artist]:
    """Draw the verdict on the line through each cell, for a law along an axis that the map does not have.

    where: the indices on the other axes. Returns the entries of the legend.
    """
    here = law.at(where)
    verdicts = here.sortby([*here.dims]).transpose(*cells.ds["outcome"].dims).values
    numbers = _numbers(verdicts)
    cells.colour(ax, numbers, **_COLOURS)
    cells.draw_borders(ax, numbers, colors="white", linewidths=1.0)
    return _entries(verdicts)


def _entries(verdicts: NDArray[np.str_], all_of_them: bool = True) -> list[Artist]:
    """The legend of the verdicts that occur, without that of the rows in which the law holds if it is not drawn."""
    return [
        Patch(facecolor=colours.VERDICTS[verdict], label=f"law {PLAIN[verdict]} on these lines")
        for verdict in VERDICTS
        if verdict in verdicts and (verdict != HOLDS or all_of_them)
    ]


def _numbers(verdicts: NDArray[np.str_]) -> NDArray[np.float64]:
    return np.vectorize(VERDICTS.index, otypes=[float])(verdicts)


def sentence(law: JudgedLaw, ds: xr.Dataset, choice: Choice) -> str:
    """``(1): the number of bends falls with E; true in part: true at R = 0.75 cm``, on the line that decides."""
    row = law.row
    at = ", ".join(labels.equation(ds[name], value) for name, value in row["at"].items())
    at = at.replace(" ", "\N{NO-BREAK SPACE}")
    law_text = law_words.law_in_words(row, labels.noun_of(row["observable"]), labels.axis_symbol(row["axis"]))
    said = f"{row['claim']}: {law_text}; {PLAIN[row['verdict']]}"
    if not at:
        return said
    there = {name: int(np.abs(law.lines[name].values - value).argmin())
             for name, value in row["at"].items() if name in law.lines.dims}  # fmt: skip
    decided = str(law.lines.isel(there).values)
    how = f": {PLAIN[decided]} at" if decided in VERDICTS and decided != row["verdict"] else "; judged at"
    return f"{said}{how} {at}"


def of_coarse_grid(ds: xr.Dataset, rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The refinement of a study in words, and the verdict of each of its laws."""
    told = [
        f"law {row['claim']}: {labels.law_text(row, law_words.law_in_words(row))}; {PLAIN[row['verdict']]}"
        for row in rows
    ]
    watched = refined.describe(ds).watch
    ended = str(ds.attrs.get(schema.SAMPLING[-1], ""))
    ended = re.sub(r"\w+", lambda one: labels.noun_of(one[0]) if one[0] in watched else one[0], ended)
    return [f"{text[0].upper()}{text[1:]}." for text in (ended, *told) if text]


def counts(law: JudgedLaw, where: Mapping[str, int]) -> str:
    """How many lines of one map have each verdict: ``16 hold, 3 fail``."""
    verdicts = law.at(where).values
    return count({verdict: int(np.count_nonzero(verdicts == verdict)) for verdict in VERDICTS})


def _strip(
    ax: Axes, cells: Cells, verdicts: NDArray[np.str_], upward: bool, place: int, inches: tuple[float, float]
) -> None:
    """The verdict on each line on which the law does not hold as a strip of colours beside the map, or above it."""
    size = inches[0] if upward else inches[1]
    start, thick = 1 + (GAP + place * (THICK + GAP)) / size, THICK / size
    strip = ax.inset_axes((start, 0, thick, 1) if upward else (0, start, 1, thick))
    scale = cells.y if upward else cells.x
    numbers = np.ma.masked_where(verdicts == HOLDS, _numbers(verdicts))
    grid = (np.array([0.0, 1.0]), scale.edges, numbers[:, None]) if upward else (scale.edges, [0.0, 1.0], numbers[None])
    strip.pcolormesh(*grid, **_COLOURS, rasterized=True)
    scale.apply(strip, "y" if upward else "x")
    strip.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
    strip.set_axis_off()


def _decisive_value(row: Mapping[str, Any], ds: xr.Dataset, across: str, where: Mapping[str, int]) -> float | None:
    """The value of the other axis of the map on whose line the law is decided, None where it is decided elsewhere."""
    if across not in row["at"]:
        return None
    elsewhere = any(name in row["at"] and row["at"][name] != float(ds[name]) for name in where)
    return None if elsewhere else float(labels.in_label_unit(ds[across], row["at"][across]))
