"""The map of the extremes: a row an extreme, a column a method, the colour of each cell the outcome.

A solved cell is the paler, the nearer its error is to what the method promises: tol max(1, condition). A cell counts as
wrong from ten times that. Where ten times that exceeds `VAGUE`, being within it proves little: the cell has a colour of
its own.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from ..figures import canvas, colours, fonts
from ..figures.sheet import SCREEN, Sheet
from ..stored.stored_study import StoredStudy
from ..words import labels

VAGUE = 0.1  # rad
WORDS = {
    "refused": "refused, with a reason",
    "inaccurate": "reported as solved, but wrong",
    "non-finite": "no finite answer: overflow, or out of steps; reported",
    "vague": f"solved; ill-conditioned at this tolerance (bound > {VAGUE:g} rad)",
}
SOLVED = LinearSegmentedColormap.from_list("solved", list(colours.SOLVED))
LEAST, MOST = -8.0, 1.0  # log10 of error over promise, at the ends of the colours of solved cells
_ROW, _COLUMN, _NAMES = 0.165, 0.42, 1.75  # inches: with all methods two columns of a journal
LEAST_WIDTH = 5.0  # inches, for the legend
LETTERS = 6.2  # points of the numbers in the cells
DPI = 300  # its letters are small


def figure(stored: StoredStudy, sheet: Sheet = SCREEN) -> Figure:
    """Draw the map of a dataset of `compare.extremes`, as wide as its table is; on a narrow sheet without numbers.

    sheet: whether it has a title, and its width where that is narrow.
    """
    rows, columns = stored.sizes["extreme"], stored.sizes["method"]

    def draw(ax: Axes) -> None:
        scale = ScalarMappable(Normalize(LEAST, MOST), SOLVED)
        said = "solved: log₁₀ of the error over tol max(1, condition)"
        said += "" if sheet.narrow else "; the number in a cell is the error in radians"
        canvas.colour_bar(
            [panel(stored, ax, not sheet.narrow)],
            scale,
            fonts.break_lines(said, page.width * (0.5 if sheet.narrow else 1.0), fonts.small()),
            orientation="horizontal",
            shrink=1.0 if sheet.narrow else 0.5,
            aspect=40,
            pad=0.035,
            ticks=range(-8, 2, 3 if sheet.narrow else 1),
        )

    titled = stored.with_title(labels.powers_of_ten(str(stored.attrs["title"])))
    width = sheet.width if sheet.narrow else max(_NAMES + _COLUMN * (columns + 2), LEAST_WIDTH)
    page = Sheet(width, "paper", sheet.titled)
    return canvas.page(titled, page, [(_ROW * rows, [draw])], more=1.9, high=False, dpi=DPI)


def promise_kept(stored: StoredStudy) -> Any:
    """log10 of the error over the promise tol max(1, condition) of each cell, (extremes, methods)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.log10(stored["error"].values / _promise(stored))


def vague(stored: StoredStudy) -> Any:
    """Whether a cell is solved and its bound, above which an error is wrong, exceeds `VAGUE`, (extremes, methods)."""
    return (stored["verdict"].values == "solved") & (10**MOST * _promise(stored) > VAGUE)


def _promise(stored: StoredStudy) -> Any:
    return float(stored.attrs["tolerance"]) * np.fmax(1.0, stored["condition"].values)


def panel(stored: StoredStudy, ax: Axes, numbers: bool = True) -> Axes:
    """The map on given axes; numbers: whether they stand in the cells, and beside them condition and length."""
    names, methods = [str(v) for v in stored["extreme"].values], [str(v) for v in stored["method"].values]
    verdict, error, kept = stored["verdict"].values, stored["error"].values, promise_kept(stored)
    condition = stored["condition"].sel({"method": "orbit"}).values
    kind = np.where(vague(stored), "vague", verdict.astype("<U10"))
    for i in range(len(names)):
        for j in range(len(methods)):
            share = (kept[i, j] - LEAST) / (MOST - LEAST)
            colour = SOLVED(share) if kind[i, j] == "solved" else colours.EXTREMES[str(kind[i, j])]
            ax.add_patch(Rectangle((j, i), 1, 1, facecolor=colour, edgecolor="white", linewidth=1))
            if numbers and verdict[i, j] in ("solved", "inaccurate"):
                _write(ax, j + 0.5, i + 0.5, _number(error[i, j]))
        for k, beside in enumerate((condition[i], stored["span"].values[i]) if numbers else ()):
            _write(ax, len(methods) + k + 0.5, i + 0.5, _number(float(beside)))
    heads = [*methods, *["condition", "L/ρ"] * numbers]
    _groups(ax, [str(v) for v in stored["group"].values], len(heads))
    ax.set(xlim=(0, len(heads)), ylim=(len(names), 0))
    ax.set_yticks(np.arange(len(names)) + 0.5, [labels.minus_signs(labels.powers_of_ten(name)) for name in names])
    ax.set_xticks(np.arange(len(heads)) + 0.5, heads, rotation=35 if numbers else 60, ha="left", rotation_mode="anchor")
    ax.tick_params(length=0, pad=2, labelsize=fonts.small() - 0.5, colors=colours.INK)
    ax.tick_params(top=True, labeltop=True, bottom=False, labelbottom=False)
    ax.spines[:].set_visible(False)
    handles = [Patch(facecolor=colour, label=WORDS[name]) for name, colour in colours.EXTREMES.items()]
    ax.legend(handles=handles, loc="upper right", bbox_to_anchor=(1, -0.005), ncols=1 + numbers)
    return ax


def _write(ax: Axes, x: float, y: float, text: str) -> None:
    ax.text(x, y, text, ha="center", va="center", fontsize=LETTERS, color=colours.INK)


def _number(value: Any) -> str:
    """One digit of a number: ``2·10⁻⁹``, ``50``; nothing for NaN."""
    if not np.isfinite(value):
        return "∞" if value == np.inf else ""
    plain = value == 0 or 0.1 <= value < 1000
    return f"{float(f'{value:.0e}'):g}" if plain else labels.powers_of_ten(f"{value:.0e}")


def _groups(ax: Axes, groups: list[str], width: float) -> None:
    """A line between groups of extremes."""
    changes = [i for i in range(1, len(groups)) if groups[i] != groups[i - 1]]
    ax.hlines(changes, 0, width, color=colours.SOFT, linewidth=0.8)
