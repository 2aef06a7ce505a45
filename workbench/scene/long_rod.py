"""A long rod set in lines, as text is: each line continues the one above it, all at one scale. No OpenGL."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..geometry import lines
from ..geometry.centreline import Array
from ..geometry.lines import Lines
from ..words import labels
from .body import Body, part_in_view

PITCH = lines.PITCH
SQUEEZED = 10.0  # diameters of the cylinder, to which a long rod is compressed: at 24 it is 7 % of a frame high
WORTH = 0.5  # a rod that is compressed less than to so much of its length is not compressed
TIGHTEST = 0.5  # of its own radius: the curvature of a bend as it is drawn
THINNEST = 4.0  # width of a cylinder in pixels; below, nothing of its rod is seen
UPRIGHT = 1e-9  # of the weight, along the axis: less is none


def cut(setting: Lines, body: Body) -> list[Body]:
    """The rod line by line."""
    return [replace(body, span=span) for span in setting.cut(*body.span)]


def is_long(bodies: Sequence[Body]) -> bool:
    """Whether one of the rods would be too thin to see in one view."""
    return any(lines.is_long(float(np.ptp(body.z)), body.reach) for body in bodies)


def squeeze_of(bodies: Sequence[Body]) -> float:
    """The factor of the heights of rods that are compressed to `SQUEEZED` diameters of the cylinder, or so little that
    their bends stay round."""
    fits = min(SQUEEZED * 2 * body.reach / float(np.ptp(body.z)) for body in bodies)
    bends = max(float(np.sqrt(body.a * body.line.kappa(body.line.s).max() / TIGHTEST)) for body in bodies)
    return min(max(fits, bends), 1.0)


def compress(bodies: Sequence[Body]) -> list[Body]:
    """The rods, all compressed along the axis where one of them is long, and their bends allow it."""
    factor = squeeze_of(bodies) if is_long(bodies) else 1.0
    return [replace(body, squeeze=factor if factor <= WORTH else 1.0) for body in bodies]


def in_view(bodies: Sequence[Body], down: Array | None) -> list[Body]:
    """The compressed rods, and of those that are long even so the beginning, or where that is higher, the last part."""
    last = down is not None and bool(down[2] > UPRIGHT)
    return [part_in_view(body, last) for body in compress(bodies)]


def notes_on(bodies: Sequence[Body], unit: str) -> list[str]:
    """How much rods are compressed along the axis, and which part of them is drawn where it is not all."""
    factor = bodies[0].squeeze if bodies else 1.0
    notes = [f"axis compressed 1 : {1 / factor:.3g}"] * (factor < 1)
    for body in [body for body in bodies if not body.whole][:1]:
        low, high, L = (labels.number(value) for value in (*body.span, body.line.L))
        notes.append(f"only s = {low} to {high} {unit} of {L} {unit}")
    return notes


def lines_for(bodies: Sequence[Body], room: tuple[int, int]) -> tuple[Lines, tuple[float, float]]:
    """The lines in which rods on one cylinder are largest in a room of pixels (width, height), the same for all rods.

    Where a cylinder would then be less than `THINNEST` pixels wide, it has that width, and the lines show pieces of the
    rod only. Returns with them the heights between which the cylinder of each line stands [length].
    """
    beyond = bodies[0].a + 0.3 * bodies[0].R
    tall = max(float(np.ptp(body.z)) for body in bodies)
    rise = max(float(np.ptp(body.z)) / (body.span[1] - body.span[0]) for body in bodies)
    setting = lines.set_in_lines(tall, 2 * bodies[0].reach, rise, room, THINNEST, beyond)
    pieces = [piece for body in bodies for piece in cut(setting, body)]
    return setting, (min(float(p.z.min()) for p in pieces) - beyond, max(float(p.z.max()) for p in pieces) + beyond)
