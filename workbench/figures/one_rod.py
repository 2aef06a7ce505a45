"""The figure of one rod: its angle and its push over s, and its unrolled view."""

from collections.abc import Mapping
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from solver.problem.errors import InputError, choices

from ..stored.stored_study import StoredStudy
from . import along_rods, canvas, colours, drawn_rods, print_heights, push_scale, unrolled
from .sheet import SCREEN, Sheet

NEEDS = {"angle": "beta", "push": "contact", "curve": "alpha"}  # panel -> what the file must store for it
NARROW = 0.55  # the share of the least height that a narrow panel has
LEGEND = 1.25  # inches of the legend, and around the view


def figure(stored: StoredStudy, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN) -> Figure:
    """Draw the angle, the push and the unrolled view of one rod; a panel of what is not stored is left out.

    Parameters
    ----------
    stored : StoredStudy
    at
        Values of axes; an axis that is not named stays where the laws or Table 1 put it.
    sheet : Sheet
        What the figure is drawn for. Its panel is ``angle``, ``push`` or ``curve``.

    Raises
    ------
    InputError
        As of `drawn_rods.choose`, for an unknown panel, and where none is stored.
    """
    whole = stored.coarse()
    place = whole.place(at)
    stored = whole.select(place)
    panels = sheet.choose(NEEDS)
    names = [panel for panel in panels if NEEDS[panel] in stored]
    if not names:
        raise InputError(f"nothing to draw: the file does not store {choices(NEEDS[panel] for panel in panels)}")
    coloured = "contact" in stored
    arrays = {"angle": ["beta"], "push": ["push"], "curve": ["alpha", "z"] + ["push"] * coloured}
    rods = drawn_rods.choose(stored, list(dict.fromkeys(name for panel in names for name in arrays[panel])))
    level = list[str]()
    if sheet.panel is None:
        plotted = [arrays[name][0] for name in names if name != "curve"]
        varied, level = along_rods.without_level(rods, plotted, alone="curve" not in names)
        names = [name for name in names if name == "curve" or arrays[name][0] in varied]
    high = unrolled.STRIPS[not sheet.narrow] * sheet.width
    each = canvas.PANEL * max(min(sheet.width / SCREEN.width, 1.0), NARROW)
    if sheet.style == "paper":
        each = max(each, canvas.ROW)
        high = min(high, max(print_heights.TALLEST - each * (len(names) - 1) - LEGEND, unrolled.LEAST_STRIP))
    room = sheet.width - unrolled.BESIDE, high
    view = unrolled.panel_of(rods, room, sheet.small, coloured) if "curve" in names else None

    def curve(ax: Axes) -> canvas.Said:
        assert view is not None
        pulled = coloured and "push" not in names and any(push_scale.pulls(rod["push"]).any() for rod in rods.solved)
        thin = Line2D([], [], color=colours.PULLED, linewidth=1.0, label=push_scale.PULLS)
        return [*[thin] * pulled, *view.draw(ax)]

    rows: list[canvas.Row] = []
    for name in names:
        over_s = partial(along_rods.alone, rods=rods, name=arrays[name][0])
        rows.append((view.height + unrolled.LABELS, [curve]) if view and name == "curve" else (each, [over_s]))
    held = whole.equations({axis: place[axis] for axis in whole.varied})
    return canvas.page(stored, sheet, rows, [*[f"The rod: {held}."] * bool(held), *level, *rods.notes])
