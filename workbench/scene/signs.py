"""The signs beside the pictures of a scene: bars, the cylinder from above, arrows, marks, and those of the legend.

Lengths on the page are in inches, to the right and down.
"""

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from matplotlib.path import Path
from numpy.typing import NDArray

from ..figures import canvas, colours, crossing_rings, fonts
from ..figures.axis_scales import round_below
from ..figures.halo import Halo
from ..words import labels
from .scene_kinds import Cell, Paint
from .views import BELOW, DOT, ROUND

GLYPH, SCALE = 0.76, 1.0  # widths: the cylinder from above, the longest scale bar
TALL = 0.45  # the longest scale bar that stands
DIAL = 0.15  # the radius of the cylinder from above
EYE = 0.078  # from a cylinder that is seen from above to the middle of the eye
RING, OUTLINE = "ring", "outline"  # in place of a colour: an open circle, the outline of a hidden stretch
# in place of a colour: a line between two marks, an arrow, a tick, a line to words
GAP, FORCE, EDGE, LEADER = "gap", "force", "edge", "leader"
# the gap upright between its two ends, the force, and the hidden end of a rod, as they are in the picture
SHAPES = {
    OUTLINE: Path([(-1, 0.35), (1, 0.35), (1, -0.35), (-1, -0.35)]),
    GAP: Path([(-0.3, 1), (0.3, 1), (0, 1), (0, -1), (-0.3, -1), (0.3, -1)], [1, 2] * 3),
    FORCE: Path([(-1, 0), (0.3, 0), (0.3, 0.3), (1, 0), (0.3, -0.3), (0.3, 0.3)], [1, 2, 1, 2, 2, 79]),
}
PAST = 0.06  # from the end of a mark to its words
HALO = [Halo(2.2)]  # a mark stands on the background, on the rod and on the cylinder
PLATE = [Halo(7.0)]  # of words on their own line, which it interrupts
LONG = 2.0  # lengths of its words: a gap longer than that has them within it
STYLES = {GAP: "|-|, widthA=0.25, widthB=0.25", FORCE: "-|>", LEADER: "-"}


def draw_mark(ax: Axes, places: NDArray[np.float64], sign: str, words: str) -> None:
    """A gap as a line with its size within it, a force as an arrow with its size at the tip, or a tick.

    The size of a short gap, within which it would cover the rod, stands behind the wall. Words that would leave the
    panel beyond the end of the line stand beside it.

    places: (2, 2) in inches of the panel, of a gap first that on the wall. sign: a gap, a force, an edge, or a leader.
    """
    if sign == EDGE:
        ax.plot(*places.T, color=colours.INK, linewidth=1.4, zorder=6, clip_on=False, gid=EDGE, path_effects=HALO)
        return
    canvas.draw_arrow(ax, places[0], places[1], STYLES[sign], width=1.1, order=6, path_effects=HALO)
    first, end = places[::-1] if sign == GAP else places
    way, halo = end - first, HALO
    half = np.array([fonts.width_of(words, fonts.SMALL), fonts.height_of(words, fonts.SMALL)]) / 2
    upright = sign != LEADER and abs(way[1]) >= abs(way[0])
    panel = np.array([ax.get_xlim()[1], ax.get_ylim()[0]])
    beyond, beside = (end + np.copysign(PAST + half, way) * axis for axis in np.eye(2)[[int(upright), 1 - upright]])
    x, y = beyond if (half <= beyond).all() and (beyond <= panel - half).all() else np.clip(beside, half, panel - half)
    if sign == GAP and (np.abs(way) > 2 * LONG * (half + PAST)).any():
        (x, y), halo = places.mean(axis=0), PLATE
    ax.text(x, y, words, ha="center", va="center", size=fonts.SMALL, zorder=7, path_effects=halo)


def legend_sign(colour: str, text: str) -> Artist:
    """What stands beside a text in the legend."""
    if colour == EDGE:
        return Line2D(
            [], [], color=colours.INK, linestyle="none", marker="|", markersize=7, markeredgewidth=1.4, label=text
        )
    if colour in SHAPES:
        ink, inner = (colours.SOFT, "none") if colour == OUTLINE else (colours.INK, colours.INK)
        return Line2D([], [], color=ink, linestyle="none", marker=SHAPES[colour], markerfacecolor=inner, label=text,
                      markersize=8 if colour == GAP else 12, markeredgewidth=1.1)  # fmt: skip
    if colour == RING:
        return crossing_rings.entry(text)
    edge = colour if colour == "none" else colours.OUTLINE
    return Patch(facecolor=colour, edgecolor=edge, linewidth=0.6, label=text)


def draw_scale(ax: Axes, x: float, y: float, per_unit: float, unit: str, along: float, upright: bool = False) -> None:
    """A bar of a round length; where the axis is seen at a slant, of a length along it and with its direction.

    per_unit: inches. upright: whether the axis goes up the page.
    """
    stands = upright and along < 1 - 1e-9
    length = round_below((TALL if stands else SCALE) / per_unit)
    half = length * per_unit / 2
    look: dict[str, Any] = {"color": colours.INK, "linewidth": 1.2, "capsize": 2.5, "capthick": 1.2}
    words = f"{labels.number(length)} {unit}"
    if stands:
        ax.errorbar(x + 0.04, y, yerr=half, **look)
        ax.text(x + 0.14, y - 0.02, words, va="bottom", size=fonts.SMALL)
    else:
        ax.errorbar(x + half, y, xerr=half, **look)
        ax.text(x + half, y - 0.06, words, ha="center", va="bottom", size=fonts.SMALL)
    if along < 1 - 1e-9:
        place = (x + 0.14, y + 0.02) if stands else (x, y + 0.06)
        ax.text(*place, "along the axis", va="top", size=fonts.SMALL, color=colours.SOFT)


def draw_glyph(ax: Axes, x: float, y: float, toward: NDArray[np.float64]) -> None:
    """The cylinder seen along its axis, where alpha = 0, and an eye where the viewer is."""
    middle, radius = np.array([x + DIAL + 0.11, y]), DIAL
    ax.add_patch(Circle(tuple(middle), radius, facecolor=colours.SURFACE, edgecolor=colours.SOFT, linewidth=0.8))
    ax.plot([middle[0], middle[0] + radius], [y, y], color=colours.SOFT, linewidth=0.8)
    way = np.asarray(toward[:2]) * [1, -1] / max(float(np.hypot(*toward[:2])), 1e-9)
    draw_eye(ax, middle + (radius + EYE) * way, way)
    place, across, upright = (middle[0] + radius + 0.03, y), "left", "center"
    if way[0] >= 0.8:  # the eye is there
        place, across, upright = (middle[0], y - radius - 0.03), "center", "bottom"
    ax.text(*place, "α = 0", size=fonts.SMALL, color=colours.SOFT, ha=across, va=upright)


def draw_eye(ax: Axes, eye: NDArray[np.float64], way: NDArray[np.float64]) -> None:
    """The eye of a viewer in a direction from the axis, (2,), on a page whose heights go down."""
    across = np.array([-way[1], way[0]])
    t = np.linspace(-1, 1, 31)[:, None]
    lid = 0.022 * (1 - t**2) * way
    for side in (1, -1):
        ax.plot(*(eye + 0.06 * t * across + side * lid).T, color=colours.INK, linewidth=0.9)
    ax.add_patch(Circle(tuple(eye), 0.014, facecolor=colours.INK, linewidth=0))


def draw_weight(ax: Axes, x: float, y: float, down: NDArray[np.float64]) -> None:
    """An arrow along the weight of the rods; down: its direction on a page whose heights go up, (2,)."""
    way = 0.17 * np.asarray(down) * [1, -1] / max(float(np.hypot(*down)), 1e-9)
    middle = np.array([x + 0.14, y])
    canvas.draw_arrow(ax, middle - way, middle + way)
    ax.text(x + 0.3, y, "weight", size=fonts.SMALL, color=colours.SOFT, va="center")


def draw_bar(ax: Axes, paint: Paint, corner: tuple[float, float], size: tuple[float, float]) -> None:
    """A colour bar with a few round values below and its quantity above; corner and size in inches of the panel."""
    place = ax.inset_axes((*corner, *size), transform=ax.transData)
    scale = ScalarMappable(Normalize(paint.low, paint.high), paint.ramp)
    canvas.colour_bar([ax], scale, cax=place, orientation="horizontal", extend=paint.extend)
    place.set_xlim(paint.low if paint.foot is None else paint.foot, paint.high)
    place.tick_params(labelcolor=colours.INK, pad=1)
    place.set_title(paint.label, size=fonts.SMALL, loc="left", pad=2)


def draw_cell(ax: Axes, cell: Cell, box: NDArray[np.float64]) -> None:
    """The words below and in place of a view."""
    x, y, wide, high = box
    middle, foot = x + wide / 2, y + high + BELOW
    dot = DOT / 2 if cell.number is not None else 0.0
    for k, line in enumerate(cell.caption.split("\n")):
        ax.text(middle + dot * (k == 0), foot + k * fonts.NORMAL * fonts.LINE, line, ha="center", va="top")
    if cell.number is not None:
        at = middle + dot - fonts.width_of(cell.caption.split("\n")[0], fonts.NORMAL) / 2 - DOT + ROUND
        down, size = foot + fonts.NORMAL / 72 / 2 - 0.01, fonts.SMALL * (1.0 if cell.number < 10 else 0.9)
        face, ink = (colours.INK, "white") if cell.stable else ("white", colours.INK)
        ax.add_patch(Circle((at, down), ROUND, edgecolor=colours.INK, linewidth=0.9, facecolor=face))
        ax.text(at, down, str(cell.number), ha="center", va="center_baseline", size=size, color=ink)
    if cell.why_empty:
        words = fonts.break_lines(cell.why_empty, wide, fonts.SMALL)
        ax.text(middle, y + high / 2, words, color=colours.SOFT, ha="center", va="center", size=fonts.SMALL)
