"""The states along rods: where each is straight, sinusoidal or helical, a row for each value of an axis."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from solver.shooting.state import HELICAL, SINUSOIDAL, STRAIGHT, states

from ..data import labels
from . import canvas, drawn_rods, legend, push_scale, style
from .drawn_rods import DrawnRods
from .sheet import SCREEN, Sheet

COLOURS = {STRAIGHT: "#d9d9d4", SINUSOIDAL: "#7fb8d6", HELICAL: "#2c5f8a"}
MOST = 60
EACH, TALL = 0.32, (0.5, 7.0)  # inches of a row, and of all rows
THICK, LINE = 0.62, 0.1  # of a row: its bar, and above it the line where the cylinder would have to pull


def figure(
    ds: xr.Dataset, x: str | None = None, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN
) -> Figure:
    """Draw where the rods along an axis are straight, sinusoidal or helical, as `solver.shooting.state.states` says.

    Parameters
    ----------
    ds : xr.Dataset
    x, at
        As `axis` and `at` of `drawn_rods.choose`.
    sheet : Sheet
        What the figure is drawn for.

    Raises
    ------
    InputError
        As of `drawn_rods.choose`.
    """
    found = drawn_rods.choose(ds, ["beta", "alpha", "push"], x, at, MOST)
    tall = float(np.clip(EACH * len(found.rods), *TALL))
    pulled = any(push_scale.pulls(rod["push"]) for rod in found.solved)

    def draw(fig: Figure) -> None:
        _draw_rows(fig, found)
        entries = [Patch(color=colour, label=word) for word, colour in COLOURS.items()]
        if pulled:
            entries.append(Patch(color=push_scale.PULL, label="the cylinder would have to pull"))
        legend.below(fig, entries, [*found.said(), *found.notes], sheet)

    return canvas.figure((sheet.width, tall + 1.3 + 0.7 * sheet.titled), draw, found.source, sheet=sheet)


def _draw_rows(fig: Figure, found: DrawnRods) -> None:
    ax = fig.add_subplot()
    for k, rod in enumerate(found.rods):
        if rod.arrays is None:
            ax.text(0.5, k, "unsolved", transform=ax.get_yaxis_transform(), ha="center", va="center", color=style.SOFT)
            continue
        s = rod["s"]
        for state in states(s, rod["beta"], rod["alpha"]):
            ax.barh(k, state.end - state.begin, THICK, state.begin, color=COLOURS[state.word])
        pulls = rod["push"] < -1e-9 * np.abs(rod["push"]).max()
        ax.fill_between(s, k + THICK / 2, k + THICK / 2 + LINE, where=pulls, color=push_scale.PULL, linewidth=0)
    ax.set_xlim(0, max(float(rod["s"][-1]) for rod in found.solved))
    ax.set_ylim(-0.6, len(found.rods) - 0.4)
    every = range(0, len(found.rods), -(-len(found.rods) // 20))
    ax.set_yticks(list(every), [found.rods[k].value for k in every])
    ax.tick_params(axis="y", length=0)
    if found.axis is not None:
        ax.set_ylabel(labels.axis_label(found.axis, found.source[found.axis], False))
    ax.set_xlabel(f"s [{labels.unit(str(found.source.attrs['length_unit']))}]")
