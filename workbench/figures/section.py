"""The section of a wound rod through the axis of its cylinder: its turns and the gaps between them."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Rectangle
from numpy.typing import NDArray
from scipy.optimize import brentq

from solver.problem.errors import InputError
from studies.laws.line_verdicts import FAILS

from ..geometry.centreline import Centreline
from ..stored.stored_study import StoredStudy
from ..words import labels
from ..words.unit_habits import plain
from . import canvas, colours, fonts
from .sheet import SCREEN, Sheet

DENSE = 32  # places for each station at which a crossing is looked for
SEEN, ABOVE = 2.5, 2.8  # radii of the rod: of the cylinder that is drawn, and of the room beyond the rod at least
WORDS, LINE = 1.5, 1.5  # from the middle of the rod to the size of a gap, in its radii; room for it, in its letters
LEAST_PART = 0.05  # of a turn: nearer to its ends a rod is not cut
HIGH = 2.4  # inches of the panel at most
LEAST = 0.04  # inches of a turn, below which nothing of it and of its distance from the cylinder is read

Window = tuple[tuple[float, float], tuple[float, float]]  # along the axis, and away from it [length]


@dataclass(frozen=True, eq=False)
class Section:
    """Where a rod crosses a half plane that begins at the axis, upward along the axis.

    z, radius
        Of its centreline at each crossing, (n,) [length].
    half
        Half the size of its section along the axis, a/|sin beta|, (n,) [length]; that of a straight rod.
    """

    z: NDArray[np.float64]
    radius: NDArray[np.float64]
    half: NDArray[np.float64]

    @property
    def gaps(self) -> NDArray[np.float64]:
        """The gaps between neighbouring turns along the axis, (n - 1,) [length]; below 0 they pass through each
        other."""
        return np.diff(self.z) - self.half[1:] - self.half[:-1]


def section_of(line: Centreline) -> Section:
    """The section of a rod where most of its turns are cut. Raises `InputError` where less than two are."""
    s = np.linspace(line.s[0], line.s[-1], DENSE * line.s.size)
    turns = line.at(s)[0] / (2 * np.pi)
    first, wound = float(turns.min()), float(np.ptp(turns))
    part = wound % 1
    shift = first + (part if part > LEAST_PART else 1.0) / 2
    turns -= shift
    low, high = np.floor(turns[:-1]), np.floor(turns[1:])

    def off(at: float, number: float) -> float:
        return float(line.at(np.array([at]))[0][0]) / (2 * np.pi) - shift - number

    places = [brentq(off, s[k], s[k + 1], args=(max(low[k], high[k]),)) for k in np.flatnonzero(low != high)]
    if len(places) < 2:
        raise InputError(
            f"a section needs two turns of the rod side by side, and it makes {wound:.3g} turns around the cylinder; "
            "choose --kind lines or curves"
        )
    at = np.array(places)
    place, (_, beta, _) = line.frame(at)[0], line.at(at)
    order = np.argsort(place[:, 2])
    half = line.a / np.abs(np.sin(beta))
    return Section(place[order, 2], np.hypot(place[order, 0], place[order, 1]), half[order])


def figure(stored: StoredStudy, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN) -> Figure:
    """The turns of one rod in a section through the axis of its cylinder, with the gaps between them.

    at: values of axes; default: where the laws or Table 1 put the case. Raises `InputError` for a rod of less than two
    turns, a case without a shape, and a dataset without the arrays of a shape.
    """
    stored = stored.coarse()
    where = stored.place(at)
    line = stored.select(where).centreline
    section, unit = section_of(line), stored.units["length"]
    gaps = section.gaps
    wide = sheet.width - 0.9
    across, upward = window = _window(line, section, wide)
    if 2 * line.a * wide / np.ptp(across) < LEAST:
        apart = plain(gaps.mean() / (2 * line.a), 2)
        raise InputError(
            f"a section shows its {gaps.size + 1} turns at one scale, and these are {apart} times as far apart "
            "as they are thick: choose --kind drawing or curves"
        )
    high = min(wide * np.ptp(upward) / np.ptp(across), HIGH)
    case = stored.equations(where)
    held = [f"The rod: {case}."] if case else []
    ends = [labels.value(float(gap), _length(stored, gap)) for gap in (gaps.min(), gaps.max())]
    between = ends[0] if ends[0] == ends[1] else " to ".join(ends)
    said = [
        *held,
        f"Section through the axis of the cylinder: {gaps.size + 1} turns of radius {labels.number(line.a)} {unit}, "
        f"with gaps of {between} between them along the axis.",
        "Each turn is cut as a straight rod in its direction.",
    ]
    if (gaps < 0).any():
        said.append("Below 0 neighbouring turns pass through each other.")
    draw = partial(_draw, stored, line, section, window)
    return canvas.page(stored, sheet, [(max(high + canvas.LABELS, 1.2), [draw])], said, high=False)


def _length(stored: StoredStudy, number: float) -> xr.DataArray:
    return xr.DataArray(number, attrs={"units": stored.units["length"]})


def _window(line: Centreline, section: Section, inches: float) -> Window:
    """What of the half plane is drawn, so many inches wide, with room for words beyond the rod."""
    beyond = 1.5 * line.a
    across = section.z[0] - section.half[0] - beyond, section.z[-1] + section.half[-1] + beyond
    room = max(ABOVE * line.a, WORDS * line.a + LINE * fonts.small() / 72 * np.ptp(across) / inches)
    if line.side == "inside":
        return across, (max(float(section.radius.min()) - room, 0), line.R + SEEN * line.a)
    return across, (max(line.R - SEEN * line.a, 0), float(section.radius.max()) + room)


def _draw(stored: StoredStudy, line: Centreline, section: Section, window: Window, ax: Axes) -> canvas.Said:
    """The cylinder below, or around, the turns; each gap has its size where there is room, else the least has."""
    across, away = window
    inside = line.side == "inside"
    foot = (line.R, away[1]) if inside else (away[0], line.R)
    ax.add_patch(
        Rectangle(
            (across[0], foot[0]),
            np.ptp(across),
            foot[1] - foot[0],
            facecolor=colours.SURFACE,
            edgecolor="none",
            zorder=1,
        )
    )
    ax.axhline(line.R, color=colours.SOFT, linewidth=0.8, zorder=2)
    for z, radius, half in zip(section.z, section.radius, section.half, strict=True):
        ax.add_patch(Ellipse((z, radius), 2 * half, 2 * line.a, facecolor=colours.NEUTRAL, edgecolor=colours.INK,
                             linewidth=0.8, zorder=3))  # fmt: skip
    ax.plot(section.z, section.radius, "+", color=colours.INK, markersize=3, zorder=4, gid="turns")
    ax.set(xlim=across, ylim=away)
    ax.set_aspect("equal", adjustable="box")
    _write_gaps(stored, line, section, ax)
    unit = labels.unit(stored.units["length"])
    ax.set_xlabel(f"along the axis  z [{unit}]")
    ax.set_ylabel(f"from the axis [{unit}]")
    return ()


def _write_gaps(stored: StoredStudy, line: Centreline, section: Section, ax: Axes) -> None:
    """The size of each gap beside it, or of the least alone."""
    inches = min(np.divide(fonts.inches(ax), np.ptp([ax.get_xlim(), ax.get_ylim()], axis=1)))  # of a unit, both ways
    texts = [labels.value(float(gap), _length(stored, gap)) for gap in section.gaps]
    room = min(np.diff(section.z)) * inches
    has_room = max(fonts.width_of(text, fonts.small()) for text in texts) + 0.06 < room
    shown = range(len(texts)) if has_room else [int(np.argmin(section.gaps))]
    sign = -1 if line.side == "inside" else 1
    for k in shown:
        middle = (section.z[k] + section.half[k] + section.z[k + 1] - section.half[k + 1]) / 2
        ax.annotate(
            texts[k],
            (middle, section.radius[k]),
            (middle, section.radius[k] + sign * WORDS * line.a),
            ha="center",
            va="bottom" if sign > 0 else "top",
            size=fonts.small(),
            color=colours.VERDICTS[FAILS] if section.gaps[k] < 0 else colours.INK,
            arrowprops={"arrowstyle": "-", "color": colours.SOFT, "linewidth": 0.6, "shrinkA": 1, "shrinkB": 0},
        )
