"""Many rods along an axis as a map: s to the right, at each value of the axis a row, whose colours say what is there.

A row reaches halfway to the next one; a short tick marks the value at which its rod is solved.
"""

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solver.nodes.pipe_states import BENT, STRAIGHT

from ..stored import derived_arrays
from ..words import labels
from . import canvas, colours, fonts, push_scale
from .drawn_rods import DrawnRod, DrawnRods
from .sheet import Sheet

LEAST = 13  # rods: fewer have a curve each
TALL = 2.6  # inches of a panel
BUT = "but for slight bends"  # of a straight state in a legend
SLIGHT_BENDS = (
    f"A bend is slight that goes less than {BENT:g} rad around, or that dies away from an end of the rod. A short "
    "slight piece beside a larger bend counts with that."
)


def states_of(rods: DrawnRods, rod: DrawnRod) -> Sequence[Any]:
    """The stretches of a rod that are straight, sinusoidal or helical; none of a rod without weight."""
    if not rods.source.loads_vary:
        return ()
    return derived_arrays.states_of(rod.case, *(rod[name] for name in ("s", "beta", "alpha", "push")))


def words(rods: DrawnRods) -> dict[str, str]:
    """What states are called in a legend where that is more than their name: a straight one that has bends, larger than
    the error of its rod."""
    for rod in rods.solved:
        s, size = rod["s"], np.abs(rod["beta"])
        for state in states_of(rods, rod):
            of = (s >= state.begin) & (s <= state.end)
            if state.word == STRAIGHT and size[of].max(initial=0.0) > float(rod.case["error"]):
                return {STRAIGHT: f"{STRAIGHT} {BUT}"}
    return {}


def figure(rods: DrawnRods, sheet: Sheet, said: Sequence[str]) -> Figure:
    """Draw the states of rods with weight, and the push. said: below the panels."""
    panels: list[canvas.Panel] = [partial(_draw_push, rods)]
    if rods.source.loads_vary:
        panels.insert(0, partial(_draw_states, rods))
    rows: list[canvas.Row] = [(TALL, [panel]) for panel in panels] if sheet.narrow else [(TALL, panels)]
    return canvas.page(rods.source, sheet, rows, said, 0.75)


def _rows(rods: DrawnRods) -> Iterator[tuple[DrawnRod, float, float]]:
    """Each rod, and the lower and the upper edge of its row."""
    assert rods.axis is not None
    to, back = (np.log, np.exp) if rods.source.is_logarithmic(rods.axis) else (np.asarray, np.asarray)
    values = to(_values(rods))
    order = np.argsort(values)
    middles = (values[order][1:] + values[order][:-1]) / 2
    edges = back(np.concatenate([2 * values[order[:1]] - middles[:1], middles, 2 * values[order[-1:]] - middles[-1:]]))
    for k, low, high in zip(order, edges, edges[1:], strict=False):
        yield rods.rods[k], float(low), float(high)


def _values(rods: DrawnRods) -> Any:
    """The value of the axis of each rod, in the unit of its label."""
    assert rods.axis is not None
    return labels.in_label_unit(rods.source[rods.axis], [float(rod.case[rods.axis]) for rod in rods.rods])


def _draw_states(rods: DrawnRods, ax: Axes) -> None:
    names = words(rods)
    for rod, low, high in _rows(rods):
        for state in states_of(rods, rod) if rod.arrays is not None else ():
            ax.broken_barh(
                [(state.begin, state.end - state.begin)],
                (low, high - low),
                linewidth=0,
                antialiased=False,  # else a white hair shows between two rows
                label=names.get(state.word, state.word),
                facecolors=colours.STATES[state.word],
                gid=f"{rod.name}, {state.word}",
            )
    _finish(ax, rods, "state")


def _draw_push(rods: DrawnRods, ax: Axes) -> None:
    norm = push_scale.scale([push_scale.away_from_ends(rod["push"]) for rod in rods.solved])
    for rod, low, high in _rows(rods):
        if rod.arrays is None:
            continue
        s = rod["s"]
        edges = np.concatenate([s[:1], (s[1:] + s[:-1]) / 2, s[-1:]])
        ax.pcolormesh(
            edges, [low, high], rod["push"][None], cmap=colours.push_ramp(), norm=norm, rasterized=True, gid=rod.name
        )
    _finish(ax, rods, "push of the cylinder per length")
    push_scale.bar(ax, rods.source.units, fonts.inches(ax)[0])


def _finish(ax: Axes, rods: DrawnRods, title: str) -> None:
    assert rods.axis is not None
    axis = rods.source[rods.axis]
    if rods.source.is_logarithmic(rods.axis):
        ax.set_yscale("log")
    rows = [*_rows(rods)]
    longest = max(float(rod["s"][-1]) for rod in rods.solved)
    for rod, low, high in rows:
        if rod.arrays is None:
            ax.broken_barh([(0.0, longest)], (low, high - low), **colours.UNSOLVED)
    ax.set_ylim(rows[0][1], rows[-1][2])
    ax.set_yticks(_values(rods), minor=True)
    ax.tick_params(axis="y", which="minor", length=2, labelleft=False)
    ax.set_xlim(0, longest)
    ax.set_xlabel(f"arc length  s [{labels.unit(rods.source.units['length'])}]")
    ax.set_ylabel(labels.axis_label(axis))
    ax.set_title(title, loc="left")
