"""The laws on a map: beside it the verdict on each line of the grid, and on it the line that decides."""

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

from studies.laws import VERDICTS
from studies.reasons import DOES, counted

from ..data import labels, law_verdicts
from . import style
from .map_cells import Cells, Choice

THICK, GAP = 0.1, 0.05  # inches of a strip of verdicts, and between strips
DECIDES: dict[str, Any] = {"color": style.INK, "linewidth": 1.3, "linestyle": (0, (5, 2))}


@dataclass(frozen=True, eq=False)
class JudgedLaw:
    """A law along an axis of the map: its row of `law_verdicts.verdicts`, and the verdict on each line of the grid."""

    row: Mapping[str, Any]
    lines: xr.DataArray


def judged(ds: xr.Dataset, choice: Choice, rows: Sequence[Mapping[str, Any]]) -> list[JudgedLaw]:
    """The laws of the dataset along an axis of the map; rows: of `law_verdicts.verdicts`, in the same order."""
    laws = zip(law_verdicts.laws(ds), rows, strict=True)
    return [
        JudgedLaw(row, law_verdicts.verdicts_of_lines(ds, law))
        for law, row in laws
        if law.axis in (choice.x, choice.y) and law.observable in choice.shown
    ]


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
        verdicts = law.lines.isel(where).sortby(across).values
        _strip(ax, cells, verdicts, upward, beside if upward else above, inches)
        beside, above = beside + upward, above + (not upward)
        entries += [Patch(facecolor=style.VERDICT_COLOURS[verdict], label=f"line on which a law {DOES[verdict][0]}")
                    for verdict in VERDICTS if verdict in verdicts]  # fmt: skip
        value = _deciding(law.row, cells.ds, across, where)
        if value is not None:
            (ax.axhline if upward else ax.axvline)(value, **DECIDES)
            entries.append(Line2D([], [], **DECIDES, label="deciding line of a law"))
    return entries


def sentence(law: JudgedLaw, ds: xr.Dataset, choice: Choice) -> str:
    """``(1) falls with E: qualified; deciding line: R = 0.75 cm``."""
    row = law.row
    at = ", ".join(f"{labels.axis_symbol(name)} = {labels.value(v, ds[name])}" for name, v in row["at"].items())
    at = at.replace(" ", "\N{NO-BREAK SPACE}")
    does = f"{row['does']} {'with' if row['direction'] else 'along'} {labels.axis_symbol(row['axis'])}"
    return f"{row['claim']} {does}: {row['verdict']}{f'; deciding line: {at}' if at else ''}"


def counts(law: JudgedLaw, where: Mapping[str, int]) -> str:
    """How many lines of one map have each verdict: ``16 hold, 3 fail``."""
    verdicts = law.lines.isel(where).values
    return counted({verdict: int(np.count_nonzero(verdicts == verdict)) for verdict in VERDICTS})


def _strip(
    ax: Axes, cells: Cells, verdicts: NDArray[np.str_], upward: bool, place: int, inches: tuple[float, float]
) -> None:
    """The verdict on each line as a strip of colours beside the map, or above it."""
    size = inches[0] if upward else inches[1]
    start, thick = 1 + (GAP + place * (THICK + GAP)) / size, THICK / size
    strip = ax.inset_axes((start, 0, thick, 1) if upward else (0, start, 1, thick))
    scale = cells.y if upward else cells.x
    colours = ListedColormap([style.VERDICT_COLOURS[verdict] for verdict in VERDICTS])
    numbers = np.array([VERDICTS.index(verdict) for verdict in verdicts], dtype=float)
    grid = (np.array([0.0, 1.0]), scale.edges, numbers[:, None]) if upward else (scale.edges, [0.0, 1.0], numbers[None])
    strip.pcolormesh(*grid, cmap=colours, vmin=-0.5, vmax=len(VERDICTS) - 0.5, rasterized=True)
    scale.put(strip, "y" if upward else "x", size)
    strip.tick_params(left=False, bottom=False, labelleft=False, labelbottom=False)
    for spine in strip.spines.values():
        spine.set_visible(False)


def _deciding(row: Mapping[str, Any], ds: xr.Dataset, across: str, where: Mapping[str, int]) -> float | None:
    """The value of the other axis of the map on whose line the law is decided, None where it is decided elsewhere."""
    if across not in row["at"]:
        return None
    elsewhere = any(name in row["at"] and row["at"][name] != float(ds[name]) for name in where)
    return None if elsewhere else float(labels.in_label_unit(ds[across], row["at"][across]))
