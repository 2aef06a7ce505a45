"""Many rods along an axis as a map: s to the right, at each value of the axis a row, whose colours say what is there.

Between two rows nothing is drawn, as nothing is solved there.
"""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..stored import derived_arrays
from ..words import labels
from . import canvas, colours, fonts, push_scale
from .drawn_rods import DrawnRod, DrawnRods
from .scales import is_logarithmic
from .sheet import Sheet

LEAST = 13  # rods: fewer have a curve each
FILL = 0.8  # height of a row over the least distance of two values
TALL = 2.6  # inches of a panel


def states_of(rods: DrawnRods, rod: DrawnRod) -> Sequence[Any]:
    """The stretches of a rod that are straight, sinusoidal or helical; none of a rod without weight."""
    if not rods.source.loads_vary:
        return ()
    return derived_arrays.states_of(rod.case, *(rod[name] for name in ("s", "beta", "alpha", "push")))


def figure(rods: DrawnRods, sheet: Sheet, said: Sequence[str]) -> Figure:
    """Draw the states of rods with weight, and the push. said: below the panels."""
    panels: list[canvas.Panel] = [partial(_draw_push, rods)]
    if rods.source.loads_vary:
        panels.insert(0, partial(_draw_states, rods))
    rows: list[canvas.Row] = [(TALL, [panel]) for panel in panels] if sheet.narrow else [(TALL, panels)]
    return canvas.page(rods.source, sheet, rows, said, 0.75)


def _rows(rods: DrawnRods) -> Iterator[tuple[DrawnRod, float, float]]:
    """Each rod with numbers, and the lower and the upper edge of its row."""
    assert rods.axis is not None
    axis = rods.source[rods.axis]
    to, back = (np.log, np.exp) if is_logarithmic(axis) else (np.asarray, np.asarray)
    values = [float(rod.case[rods.axis]) for rod in rods.rods]
    middles = to(labels.in_label_unit(axis, values))
    half = FILL * float(np.abs(np.diff(np.sort(middles))).min()) / 2
    for rod, middle in zip(rods.rods, middles, strict=True):
        if rod.arrays is not None:
            yield rod, float(back(middle - half)), float(back(middle + half))


def _draw_states(rods: DrawnRods, ax: Axes) -> None:
    for rod, low, high in _rows(rods):
        for state in states_of(rods, rod):
            ax.broken_barh(
                [(state.begin, state.end - state.begin)],
                (low, high - low),
                linewidth=0,
                label=state.word,
                facecolors=colours.STATES[state.word],
                gid=f"{rod.name}, {state.word}",
            )
    _finish(ax, rods, "state")


def _draw_push(rods: DrawnRods, ax: Axes) -> None:
    norm = push_scale.scale([rod["push"] for rod in rods.solved])
    for rod, low, high in _rows(rods):
        s = rod["s"]
        edges = np.concatenate([s[:1], (s[1:] + s[:-1]) / 2, s[-1:]])
        ax.pcolormesh(
            edges, [low, high], rod["push"][None], cmap=colours.push_ramp(), norm=norm, rasterized=True, gid=rod.name
        )
    _finish(ax, rods, "push of the cylinder per length")
    push_scale.bar(ax, push_scale.unit(rods.source), fonts.inches(ax)[0])


def _finish(ax: Axes, rods: DrawnRods, title: str) -> None:
    assert rods.axis is not None
    axis = rods.source[rods.axis]
    if is_logarithmic(axis):
        ax.set_yscale("log")
    edges = [edge for _, low, high in _rows(rods) for edge in (low, high)]
    ax.set_ylim(min(edges), max(edges))
    ax.set_xlim(0, max(float(rod["s"][-1]) for rod in rods.solved))
    ax.set_xlabel(f"s [{labels.unit(rods.source.units['length'])}]")
    ax.set_ylabel(labels.axis_label(axis))
    ax.set_title(title, loc="left")
