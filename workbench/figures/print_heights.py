"""The heights of a figure in print: its axes are high enough, or it has fewer panels, or it is refused."""

from collections.abc import Callable
from contextlib import suppress
from warnings import catch_warnings, filterwarnings

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from solver.problem.errors import InputError

from .sheet import MILLIMETRES

TALLEST = 185 / MILLIMETRES  # inches of a figure in print
LEAST_AXES = 25 / MILLIMETRES  # inches of axes in print at least
DRAWN = 0.95  # share of its own height that a view keeps: with less the words of two columns meet
SPARE = 0.06  # inches below a view that are not taken away
TRIES = 6  # to give axes that height: what a figure gains is shared with its views


class TooLow(InputError):
    """The axes of a picture would be lower than print needs."""


def with_room(draw: Callable[[int], Figure], most: int) -> Figure:
    """The figure of most panels, at most so many, whose axes are high enough; draw: takes their number.

    Raises `TooLow` where one panel is too many.
    """
    for count in range(most, 1, -1):
        with suppress(TooLow):
            return draw(count)
    return draw(min(most, 1))


def heighten_axes(fig: Figure) -> None:
    """Let a figure grow, up to `TALLEST`, until its axes are `LEAST_AXES` high and its views have their own inches, and
    shrink by what views have beyond these.

    Raises `TooLow` where axes are lower.
    """
    axes = [ax for ax in fig.axes if ax.axison and ax.get_label() != "<colorbar>" and ax.get_subplotspec() is not None]
    for _ in range(TRIES):
        with catch_warnings():
            filterwarnings("ignore", "constrained_layout not applied")  # it is seen below, and the figure grows
            fig.draw_without_rendering()
        boxes = [ax.get_window_extent() for ax in axes]
        lowest = min((box.height / fig.dpi for box in boxes), default=LEAST_AXES)
        rows = len({round(box.y0) for box in boxes})
        bottom = min((box.y0 for box in boxes), default=np.inf)
        if any(key.get_window_extent().y1 > bottom for key in fig.legends):
            lowest = 0.0  # the layout was given up: what stands around the axes leaves them no room
        wide, high = map(float, fig.get_size_inches())
        apart = _shortfalls(fig)
        short = {ax: inches for ax, inches in apart.items() if inches > (1 - DRAWN) * np.ptp(ax.get_ylim())}
        if lowest >= LEAST_AXES and not short:
            if not (spare := {ax: inches for ax, inches in apart.items() if inches < -SPARE}):
                return
            for ax, inches in spare.items():
                _heighten_row(ax, inches)
            resize(fig, (wide, high + sum(spare.values())))
            continue
        more_height = max(1.02 * rows * (LEAST_AXES - lowest) + 0.01, 0.0) + sum(short.values())
        if (grown := min(high + more_height, TALLEST)) > high:
            for ax, inches in short.items():
                _heighten_row(ax, inches * (grown - high) / more_height)
            resize(fig, (wide, grown))
        elif lowest < LEAST_AXES:
            at_least = f"{MILLIMETRES * LEAST_AXES:.0f} mm in print"
            raise TooLow(
                f"the axes would be {MILLIMETRES * lowest:.1f} mm high, and are at least {at_least}: choose fewer "
                "panels with --show or --panel, or another --width"
            )


def _shortfalls(fig: Figure) -> dict[Axes, float]:
    """By how many inches the panels of views are lower than their own axes, below 0 higher."""
    views = [ax for ax in fig.axes if not ax.axison and ax.get_aspect() == 1 and ax.get_subplotspec() is not None]
    heights = [float(np.ptp(ax.get_ylim())) for ax in views]
    cells = [ax.get_position(original=True).height * fig.get_figheight() for ax in views]
    return {ax: high - cell for ax, high, cell in zip(views, heights, cells, strict=True)}


def _heighten_row(ax: Axes, more: float) -> None:
    """Give the row of axes so many inches more of what the layout of `page` has."""
    spec = ax.get_subplotspec()
    assert spec is not None
    for place in dict.fromkeys((spec, spec.get_topmost_subplotspec())):
        ratios = np.array(place.get_gridspec().get_height_ratios(), dtype=float)
        ratios[place.rowspan.start] += more
        place.get_gridspec().set_height_ratios(ratios)


def resize(fig: Figure, size: tuple[float, float]) -> float:
    """Give a figure with a constrained layout another size; returns the height that its title and legends leave.

    All in inches. The title keeps its height.
    """
    engine, shown = fig.get_layout_engine(), fig.canvas
    assert isinstance(engine, ConstrainedLayoutEngine)
    assert isinstance(shown, FigureCanvasAgg)
    used = (1 - engine.get()["rect"][3]) * fig.get_figheight()
    fig.set_size_inches(size)
    engine.set(rect=(0, 0, 1, max(1 - used / size[1], 0.0)))
    return size[1] - used - sum(key.get_window_extent(shown.get_renderer()).height / fig.dpi for key in fig.legends)
