"""The figure of one long rod: its developed curve in lines, in the colours of the push."""

from matplotlib.artist import Artist
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..data import cautions, labels
from . import canvas, legend, long_curve, push_scale, style
from .drawn_rods import DrawnRods
from .sheet import Sheet

BAR, LABELS = 0.95, 1.5  # inches of the bar of colours beside the lines, and of the labels and sentences below


def figure(found: DrawnRods, sheet: Sheet) -> Figure | None:
    """The figure of the one rod; None for several, and for one that is no hair in one piece."""
    if len(found.rods) > 1:
        return None
    (rod,) = found.rods
    across, z = rod.developed()
    curve = long_curve.Curve(rod["s"], z, across, rod["push"], rod.rho, rod.rho + rod.a)
    lines = long_curve.lines_for(curve, long_curve.room(sheet.width - (0.0 if sheet.narrow else BAR)))
    if lines is None:
        return None
    unit = labels.unit(str(found.source.attrs["length_unit"]))

    def draw(fig: Figure) -> None:
        ax = fig.add_subplot(label=rod.name)
        notes = long_curve.draw(ax, curve, lines, unit, name=rod.name)
        drawn = next(one for one in ax.collections if isinstance(one, LineCollection))
        inches = sheet.width - 0.3 if sheet.narrow else lines.height + 0.3
        push_scale.bar(fig, drawn, [ax], push_scale.unit(found.source), inches, below=sheet.narrow)
        if "overlaps" in cautions.keys(rod.caution):
            notes.append("The rod passes through itself; the places are not marked in lines.")
        said = ["Unrolled view, seen from outside.", *notes, *found.said(), *found.notes]
        legend.below(fig, _entries(curve), said, sheet)

    height = lines.height + LABELS + 0.7 * sheet.titled + (0.9 if sheet.narrow else 0.0)
    return canvas.figure((sheet.width, height), draw, found.source, sheet=sheet)


def _entries(curve: long_curve.Curve) -> list[Artist]:
    """The legend."""
    said = "the cylinder would have to pull: the rod would lift off"
    pulled = curve.push is not None and push_scale.pulls(curve.push)
    orange: list[Artist] = [Line2D([], [], color=push_scale.PULL, linewidth=2.2, label=said)] if pulled else []
    start = Line2D([], [], color=style.INK, linestyle="none", marker="o", markersize=4, label="s = 0")
    return [*orange, start]
