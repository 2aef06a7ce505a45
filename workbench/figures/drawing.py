"""A dimensioned drawing of one rod on its cylinder: a side view at true scale, as a workshop draws it.

The axis lies to the right, alpha = 0 is up, and the eye looks from alpha = 90 degrees. In a hole with a low side, which
is at alpha = 0, this side is down, and the eye looks from alpha = -90 degrees. What the cylinder hides is dashed.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Rectangle
from numpy.typing import NDArray

from solver.problem.errors import InputError
from solver.problem.units import LENGTHS

from ..stored.stored_study import StoredStudy
from ..words import labels
from ..words.habits import plain, size_shown, unit_shown
from . import canvas, colours, drawn_rods, fonts
from .drawn_numbers import CASING
from .sheet import MILLIMETRES, SCREEN, Sheet

SCALES = [step * 10.0**power for power in range(9, -10, -1) for step in (5.0, 2.0, 1.0)]  # of a drawing, falling
LEFT, RIGHT, ABOVE, BELOW = 24.0, 12.0, 15.0, 24.0  # millimetres on paper around the cylinder
HIGH = (110.0, 70.0)  # of the cylinder with its rod at most, on a wide and on a narrow sheet
THICK, HAIR = 0.8, 0.3  # of the rod: thinner, the drawing shows a part of it; is refused
SPARE = 4.0  # of cylinder beyond both ends of the rod
EDGE, FINE = 0.9, 0.5  # points: of an outline, and of a dimension line
AWAY, ARC = 7.0, 9.0  # of a dimension line from what it measures; radius of the arc of an angle
BEYOND = 1.0  # of extension lines beyond their dimension line; its words stand past them
LEADER = (5.0, 6.0)  # to the left of the rod and away from it: below the words of the pitch
ARROW: dict[str, Any] = {
    "arrowstyle": "<|-|>,head_length=0.35,head_width=0.13",
    "shrinkA": 0,
    "shrinkB": 0,
    "linewidth": FINE,
    "color": colours.INK,
}
HIDDEN = (0, (4, 2.5))
AXIS = (0, (12, 2.5, 2, 2.5))
EVEN = math.radians(0.05)  # by which a lay varies that is one angle
LEVEL = 1e-9  # sine of the inclination of a hole that stands, and has no low side
CLOSE = 1e-3  # relative: of the distance of two turns to the pitch
PER_TURN = 240  # points of a turn

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SideView:
    """The rod in the view: to the right, upwards and towards the eye, (n,) each [length]; its angle, (n,).

    scale: millimetres on paper of a millimetre. mm: of paper in a unit of length. whole: whether all of it is drawn.
    low_side: whether alpha = 0 is the low side of the cylinder, and down.
    """

    x: Values
    y: Values
    near: Values
    beta: Values
    scale: float
    mm: float
    whole: bool
    low_side: bool


def figure(stored: StoredStudy, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN) -> Figure:
    """Draw one rod and its cylinder with their dimensions: diameters, pitch, lay, length along the axis.

    Parameters
    ----------
    stored : StoredStudy
    at : mapping, optional
        The values of axes; an axis that is not named stays where the laws or Table 1 put it.
    sheet : Sheet
        What it is drawn for.

    Raises
    ------
    InputError
        For a rod that is thinner than a line at true scale, and as of `drawn_rods.choose`.
    """
    stored = stored.coarse()
    chosen = stored.select(stored.place(at))
    rods = drawn_rods.choose(chosen, ("alpha", "beta", "z"))
    rod = rods.solved[0]
    turns, height, pitch, kappa = (
        float(value) for value in drawn_rods.numbers(chosen, "turns_around", "height", "pitch", "kappa_max")
    )
    R = float(chosen["R"])
    radius = max(R, float(np.max(rod.radius)) + rod.a)
    view = _view(rod, chosen.units["length"], radius, sheet)
    unit = partial(_with_unit, units=chosen.units)
    even = float(np.ptp(view.beta)) < EVEN
    lay = f"{plain(round(math.degrees(float(view.beta.mean())), 6))}°"
    along = "" if view.whole else f"along the axis {unit('L', abs(height))}, "
    line = (
        f"length {unit('L', float(chosen['L']))}, {along}wrap {plain(turns)} turns = {plain(360 * turns)}°, "
        f"{f'lay {lay}, ' * even}scale {_scale_words(view.scale)}"
    )
    said = [f"The rod: {line}.", f"Its least bend radius, of the centreline: {unit('L', 1 / kappa)}."] if kappa else []
    hides = str(chosen.attrs["side"]) == "outside"
    eye = "−90°, with the low side down" if view.low_side else "90°"
    said.append(f"A side view, seen from α = {eye}{'; dashed: behind the cylinder' * hides}.")
    said += [] if view.whole else ["A part of the rod is drawn, from s = 0."]

    def draw(fig: Figure) -> None:
        title = canvas.write_title(fig, str(stored.attrs["title"]), "") if sheet.titled else 0.0
        wide, high = fig.get_size_inches()
        ax = fig.add_axes((0, 0, 1, 1 - title / high))
        ax.set_axis_off()
        first, drawn = float(view.x.min()), float(np.ptp(view.x)) * view.mm
        left = LEFT + SPARE + (wide * MILLIMETRES - LEFT - RIGHT - 2 * SPARE - drawn) / 2
        ax.set_xlim(first - left / view.mm, first + (wide * MILLIMETRES - left) / view.mm)
        ax.set_ylim(radius - ((high - title) * MILLIMETRES - ABOVE) / view.mm, radius + ABOVE / view.mm)
        _draw_body(ax, view, R, rod.a, str(chosen.attrs["side"]))
        _dimension(
            ax,
            view,
            (view.x.min() - SPARE / view.mm, -R),
            (view.x.min() - SPARE / view.mm, R),
            f"Ø {unit('R', 2 * R)}",
            AWAY,
        )
        _dimension_pitch(ax, view, radius, pitch, unit)
        if view.whole:
            _dimension(ax, view, (view.x[0], -radius), (view.x[-1], -radius), unit("L", abs(height)), -AWAY)
        _dimension_rod(ax, view, rod.a, unit)
        if even:
            _dimension_lay(ax, view, lay)
        room = wide - 8 / MILLIMETRES
        ax.text(
            4 / MILLIMETRES / wide,
            3 / MILLIMETRES / (high - title),
            fonts.break_lines(line, room),
            transform=ax.transAxes,
            va="bottom",
            color=colours.INK,
        )
        canvas.add_to_caption(fig, [*said, *rods.notes])

    size = sheet.width, (2 * radius * view.mm + ABOVE + BELOW) / MILLIMETRES + canvas.TITLE * sheet.titled
    return canvas.figure(size, draw, layout=None, sheet=sheet)


def _with_unit(name: str, value: float, units: Mapping[str, str]) -> str:
    """A length as its users state it: a radius in feet is in inches."""
    return f"{plain(value * size_shown(name, units))} {labels.unit(unit_shown(name, units))}"


def _scale_words(scale: float) -> str:
    return f"1:{1 / scale:g}" if scale < 1 else f"{scale:g}:1"


def _view(rod: drawn_rods.DrawnRod, unit: str, radius: float, sheet: Sheet) -> SideView:
    """The side view of a rod, at the largest round scale with which it fits. Raises `InputError`."""
    alpha, z = rod["alpha"], rod["z"]
    count = int(max(PER_TURN * np.abs(np.diff(alpha)).sum() / (2 * np.pi), alpha.size, 400))
    s = np.linspace(0, float(rod["s"][-1]), min(count, 200_000))
    alpha, beta, z = (np.interp(s, rod["s"], rod[name]) for name in ("alpha", "beta", "z"))
    r = np.interp(s, rod["s"], np.broadcast_to(rod.radius, rod["s"].shape))
    mm = 1e3 * LENGTHS[unit]
    room = sheet.width * MILLIMETRES - LEFT - RIGHT - 2 * SPARE
    upright = [scale for scale in SCALES if 2 * radius * mm * scale <= HIGH[sheet.narrow]]
    scale = next(scale for scale in upright if np.ptp(z) * mm * scale <= room)
    whole = 2 * rod.a * mm * scale >= THICK
    if not whole:
        scale = upright[0]
    if 2 * rod.a * mm * scale < HAIR:
        raise InputError(
            f"at {_scale_words(scale)}, at which {plain(2 * radius)} {unit} across the axis fit the sheet, this rod is "
            "thinner than a line: choose --kind curves, which unrolls it, or a scene"
        )
    k = s.size if whole else int(np.argmax(np.append(np.abs(z - z[0]) * mm * scale > room, True)))
    whole = whole or k == s.size
    case = rod.case.case
    low_side = bool(np.any(case.rod.weight or 0.0)) and abs(math.sin(case.cylinder.inclination or 0.0)) > LEVEL
    up, near = (-1 if low_side else 1) * r * np.array([np.cos(alpha), np.sin(alpha)])
    return SideView(z[:k], up[:k], near[:k], beta[:k], scale, mm * scale, whole, low_side)


def _parts(view: SideView, front: bool) -> Iterator[slice]:
    """The parts of the rod before the plane of the axis, or behind it; neighbours share a point."""
    is_front = view.near >= 0
    cuts = [0, *(np.flatnonzero(np.diff(is_front)) + 1).tolist(), view.x.size]
    for begin, end in pairwise(cuts):
        if bool(is_front[begin]) == front:
            yield slice(max(begin - 1, 0), min(end + 1, view.x.size))


def _draw_body(ax: Axes, view: SideView, R: float, a: float, side: str) -> None:
    """The cylinder with its axis, and the rod: solid where it is seen, dashed where the cylinder hides it."""
    spare = SPARE / view.mm
    low, high = float(view.x.min()) - spare, float(view.x.max()) + spare
    thick = 2 * a * view.mm / MILLIMETRES * 72  # points

    behind = 1.0 if side == "outside" else 3.0  # the order of drawing

    def strand(of: slice, order: float, name: str) -> None:
        """A part of the rod: flat at an end of the rod, round where it passes the plane of the axis.

        The outline there lies below all parts, so that none shows inside the rod.
        """
        middle = (of.start + of.stop) // 2
        inner = slice(middle if of.start == 0 else of.start, middle if of.stop == view.x.size else of.stop)
        inside = max(thick - 2 * EDGE, 0.3 * thick)
        for colour, width, below in ((colours.INK, thick, behind - 0.1), ("white", inside, order)):
            look: dict[str, Any] = {"color": colour, "linewidth": width, "solid_joinstyle": "round", "snap": False}
            ax.plot(view.x[of], view.y[of], solid_capstyle="butt", zorder=order, gid=name, **look)
            ax.plot(view.x[inner], view.y[inner], solid_capstyle="round", zorder=below, label=CASING, **look)

    for of in _parts(view, front=False):
        strand(of, behind, "rod, behind the plane of the axis")
    ax.add_patch(Rectangle((low, -R), high - low, 2 * R, facecolor=colours.CUT, edgecolor="none", zorder=2))
    for y in (-R, R):
        ax.plot([low, high], [y, y], color=colours.INK, linewidth=EDGE, zorder=2.1, gid="cylinder")
    for end in (low, high):
        ax.plot([end, end], [-R, R], color=colours.INK, linewidth=FINE, zorder=2.1, gid="end of the drawn cylinder")
    ax.plot(
        [low - spare / 2, high + spare / 2],
        [0, 0],
        color=colours.SOFT,
        linewidth=FINE,
        linestyle=AXIS,
        zorder=2.2,
        gid="axis",
    )
    for of in _parts(view, front=False) if side == "outside" else ():
        for edge in (-a, a) if 2 * a * view.mm > 1 else (0.0,):
            right, up = _beside(view.x[of], view.y[of], edge)
            seen = np.where(np.abs(up) < R, right, np.nan)
            ax.plot(seen, up, color=colours.SOFT, linewidth=FINE, linestyle=HIDDEN, zorder=2.3, gid="hidden edge")
    for of in _parts(view, front=True):
        strand(of, 4, "rod, before the plane of the axis")


def _beside(x: Values, y: Values, distance: float) -> tuple[Values, Values]:
    """A curve at a distance to the left of another one."""
    dx, dy = np.gradient(x), np.gradient(y)
    length = np.maximum(np.hypot(dx, dy), 1e-300)
    return x - distance * dy / length, y + distance * dx / length


def _dimension(ax: Axes, view: SideView, first: Any, last: Any, text: str, away: float) -> None:
    """A dimension line with its extension lines, so many millimetres to the left of what it measures, or above it."""
    upright = first[0] == last[0]
    shift = np.array([-away, 0.0] if upright else [0.0, away]) / view.mm
    for end in (first, last):
        beyond = np.array(end) + shift * (1 + BEYOND / abs(away))
        ax.plot(*np.transpose([end, beyond]), color=colours.INK, linewidth=FINE, zorder=5, label="_samples")
    p, q = np.array(first) + shift, np.array(last) + shift
    ax.annotate("", tuple(p), tuple(q), arrowprops=ARROW, zorder=5)
    x, y = (p + q) / 2 + shift / abs(away) * BEYOND
    ax.text(
        x,
        y,
        text,
        size=fonts.small(),
        zorder=6,
        rotation=90 if upright else 0,
        ha="right" if upright else "center",
        va="center" if upright else "bottom" if away > 0 else "top",
    )


def _dimension_pitch(ax: Axes, view: SideView, top: float, pitch: float, unit: Any) -> None:
    """The pitch between two neighbouring turns at the top; nothing where they are not a pitch apart."""
    k = np.flatnonzero((np.diff(np.sign(view.near)) != 0) & (view.y[1:] > 0))
    at = view.x[k] - view.near[k] * (view.x[k + 1] - view.x[k]) / (view.near[k + 1] - view.near[k])
    for first, last in pairwise(at.tolist()):
        if abs(abs(last - first) - abs(pitch)) <= CLOSE * abs(pitch):
            _dimension(ax, view, (first, top), (last, top), unit("L", abs(pitch)), AWAY)
            return


def _dimension_rod(ax: Axes, view: SideView, a: float, unit: Any) -> None:
    """The diameter of the rod, at a leader to its outer edge where it is first seen."""
    k = int(np.argmax(view.near >= 0))
    away = 1.0 if view.y[k] >= 0 else -1.0
    place = float(view.x[k]), float(view.y[k]) + away * a
    ax.annotate(
        f"Ø {unit('a', 2 * a)}",
        place,
        (place[0] - LEADER[0] / view.mm, place[1] + away * LEADER[1] / view.mm),
        size=fonts.small(),
        ha="right",
        va="center",
        zorder=6,
        arrowprops=ARROW | {"arrowstyle": "-|>"},
    )


def _dimension_lay(ax: Axes, view: SideView, text: str) -> None:
    """The lay, between the axis and the rod where it crosses the axis before it; nothing where it crosses nowhere."""
    crossings = np.flatnonzero((np.diff(np.sign(view.y)) != 0) & (view.near[1:] > 0))
    if not crossings.size:
        return
    k = int(crossings[crossings.size // 2])
    x, across, turned = float(view.x[k]), 2 * ARC / view.mm, -math.degrees(float(view.beta[k]))
    ends = sorted((0.0, turned))
    ax.add_patch(
        Arc((x, 0), across, across, theta1=ends[0], theta2=ends[1], color=colours.INK, linewidth=FINE, zorder=5)
    )
    half = math.radians(turned / 2)
    ax.plot([x, x + 1.3 * ARC / view.mm], [0, 0], color=colours.INK, linewidth=FINE, zorder=5, label="_samples")
    place = np.array([math.cos(half), math.sin(half)]) * (ARC + 1.0) / view.mm
    ax.text(
        x + place[0],
        place[1],
        text,
        size=fonts.small(),
        ha="left",
        va="center",
        zorder=6,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1},
    )
