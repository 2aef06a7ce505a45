"""The dimensions of a drawing: lines with arrows between extension lines, leaders, angles, and point forces."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from . import canvas, colours, fonts
from .sheet import MILLIMETRES
from .views_on_paper import PAST, SPARE, Views

FINE = 0.5  # points: of a dimension line
AWAY, ARC = 7.0, 9.0  # millimetres of a dimension line from what it measures; radius of the arc of an angle
BEYOND = 1.0  # of extension lines beyond their dimension line; its words stand past them
LEADER = (5.0, 6.0)  # to the left of the rod and away from it: below the words of the pitch
CLOSE = 1e-3  # relative: of the distance of two turns to the pitch
BETWEEN = "<|-|>,head_length=0.35,head_width=0.13"  # the arrow of a dimension line
PLATE: dict[str, Any] = {"facecolor": "white", "edgecolor": "none", "pad": 1}

Length = Callable[[str, float], str]  # the name of a quantity and its value, in words with its unit


def dimension(
    ax: Axes, view: Views, first: Any, last: Any, text: str, away: float, starts: Sequence[float] = ()
) -> None:
    """A dimension line with its extension lines, so many millimetres to the left of what it measures, or above it.

    starts: how far up the extension lines begin [length]; default: at what it measures.
    """
    upright = first[0] == last[0]
    shift = np.array([-away, 0.0] if upright else [0.0, away]) / view.mm
    for end, start in zip((first, last), starts or (first[1], last[1]), strict=True):
        beyond = np.array(end) + shift * (1 + BEYOND / abs(away))
        ax.plot(*np.transpose([(end[0], start), beyond]), color=colours.INK, linewidth=FINE, zorder=5, label="_samples")
    p, q = np.array(first) + shift, np.array(last) + shift
    canvas.draw_arrow(ax, q, p, BETWEEN, width=FINE, order=5)
    beside = ("right", "center") if upright else ("center", "bottom" if away > 0 else "top")
    _write(ax, (p + q) / 2 + shift / abs(away) * BEYOND, text, *beside, rotation=90 * upright)


def _write(ax: Axes, place: Any, text: str, across: str = "center", upright: str = "center", **look: Any) -> None:
    ax.text(place[0], place[1], text, size=fonts.small(), zorder=6, ha=across, va=upright, **look)


def dimension_pitch(ax: Axes, view: Views, top: float, pitch: float, unit: Length) -> None:
    """The pitch between two neighbouring turns at the top; nothing where they are not a pitch apart."""
    k = np.flatnonzero((np.diff(np.sign(view.near)) != 0) & (view.y[1:] > 0))
    at = view.x[k] - view.near[k] * (view.x[k + 1] - view.x[k]) / (view.near[k + 1] - view.near[k])
    for first, last in pairwise(at.tolist()):
        if abs(abs(last - first) - abs(pitch)) <= CLOSE * abs(pitch):
            dimension(ax, view, (first, top), (last, top), unit("L", abs(pitch)), AWAY)
            return


def dimension_rod(ax: Axes, view: Views, a: float, text: str) -> None:
    """The diameter of the rod, at a leader to its outer edge where it is first seen."""
    k = int(np.argmax(view.near >= 0))
    away = 1.0 if view.y[k] >= 0 else -1.0
    place = float(view.x[k]), float(view.y[k]) + away * a
    words = place[0] - LEADER[0] / view.mm, place[1] + away * LEADER[1] / view.mm
    _lead(ax, place, words, text, "right")


def _lead(ax: Axes, place: Any, words: Any, text: str, across: str) -> None:
    """Words with a leader from them to a place."""
    look = {"arrowstyle": "-|>", "shrinkA": 0, "shrinkB": 0, "linewidth": FINE, "color": colours.INK}
    ax.annotate(text, place, words, size=fonts.small(), ha=across, va="center", zorder=6, arrowprops=look)


def dimension_lay(ax: Axes, view: Views, a: float, text: str) -> None:
    """The lay, between the axis and the rod where it crosses the axis before it; nothing where it crosses nowhere.

    Its words stand where they cover no edge of the rod, else beside the cylinder.
    """
    crossings = np.flatnonzero((np.diff(np.sign(view.y)) != 0) & (view.near[1:] > 0))
    if not crossings.size:
        return
    turned = -math.degrees(float(view.beta[crossings[0]]))
    toward = np.array([math.cos(math.radians(turned / 2)), math.sin(math.radians(turned / 2))])
    place, edge = toward * (ARC + BEYOND) / view.mm, float(view.x.max()) + SPARE / view.mm
    wide, high = (size(text, fonts.small()) * MILLIMETRES / view.mm for size in (fonts.width_of, fonts.height_of))
    near = a + BEYOND / view.mm

    def has_place(k: int) -> bool:
        first = view.x[k] + place[0]
        above = np.abs(view.y - place[1]) < high / 2 + near
        return bool(first + wide + near < edge) and not np.any(
            above & (view.x > first - near) & (view.x < first + wide + near)
        )

    inside = next(filter(has_place, crossings[crossings.size // 2 :]), None)
    x = float(view.x[crossings[-1] if inside is None else inside])
    ends = sorted((0.0, turned))
    arc = Path.arc(ends[0], ends[1]).transformed(Affine2D().scale(ARC / view.mm).translate(x, 0))
    ax.add_patch(
        FancyArrowPatch(
            path=arc, arrowstyle=BETWEEN, mutation_scale=fonts.small(), color=colours.INK, linewidth=FINE, zorder=5
        )
    )
    for angle in map(math.radians, ends):  # along the axis, and in the middle of the rod
        long = 1.3 * ARC / view.mm
        ax.plot(
            [x, x + long * math.cos(angle)],
            [0, long * math.sin(angle)],
            color=colours.INK,
            linewidth=FINE,
            zorder=5,
            label="_samples",
        )
    if inside is not None:
        _write(ax, [x + place[0], place[1]], text, "left", bbox=PLATE)
    else:
        mark = np.array([x, 0.0]) + toward * ARC / view.mm
        _lead(ax, mark, (max(edge, mark[0]) + PAST / view.mm, mark[1]), text, "left")


def has_room(view: Views, k: int, R: float, text: str, spare: float = BEYOND) -> bool:
    """Whether the words of the distance of the k-th place of the rod from the axis have room outside the cylinder.

    spare: millimetres at both ends of the words.
    """
    outside = (float(np.hypot(*view.end[k])) - R) * view.mm
    return fonts.width_of(text, fonts.small()) * MILLIMETRES <= outside - 2 * spare


def dimension_distance(ax: Axes, view: Views, k: int, R: float, text: str) -> None:
    """The distance of the k-th place of the rod from the axis, in the end view; nothing where its words have no room.

    They stand on the line, or where that is short beside it, on the side where the rod is not.
    """
    if not has_room(view, k, R, text):
        return
    place = view.end[k]
    size = float(np.hypot(*place))
    canvas.draw_arrow(ax, view.middle, view.middle + place, width=FINE, order=5)
    turned = (math.degrees(math.atan2(place[1], place[0])) + 90) % 180 - 90
    middle = view.middle + place * (R / size + 1) / 2
    if has_room(view, k, R, text, AWAY):
        _write(ax, middle, text, rotation=turned, rotation_mode="anchor", bbox=PLATE)
        return
    left = np.array([-place[1], place[0]]) / size
    beside = np.array_split(view.end, 2)[k]  # the half of the rod that ends there
    free = -np.sign(np.mean(beside @ left) or 1.0) * left
    aside = BEYOND + fonts.height_of(text, fonts.small()) * MILLIMETRES / 2
    _write(ax, middle + aside / view.mm * free, text, rotation=turned, rotation_mode="anchor")


def draw_forces(ax: Axes, view: Views) -> None:
    """The point forces of the wall as arrows in the end view, with their words."""
    for force in view.forces or ():
        place = view.middle + force.place
        tip = place + force.long / view.mm * force.away
        canvas.draw_arrow(ax, place, tip, order=5)
        if force.words:
            _write(ax, tip + PAST / view.mm * force.away, force.words, *force.beside, bbox=PLATE)
