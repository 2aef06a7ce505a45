"""An animated picture of the rods along an axis and back, one frame a case: one camera, one scale of colours.

Pillow writes it, which Matplotlib needs anyway. Frames need OpenGL. Lengths are in pixels at `style.DPI`.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from solver.problem.errors import InputError

from ..data import atomic, labels, selection
from ..figures import canvas, style
from ..figures.scales import WIDE
from . import body as rods
from . import camera as cameras
from . import drawing, footer, kinds, pixels
from .body import Body
from .cells import Cell
from .page import MARGIN
from .pixels import Pixels
from .settings import Settings
from .views import View, ends_of

SIZE = (860, 600)  # of a frame
TOP, FOOT = 118, 112  # the room above the views for the value, and below them for the colours
DIGITS = 3  # of the value
SECONDS = 5.0  # for the way along the axis and back
SIDES = (0.0, 90.0)  # degrees about the axis
QUALITY = 80  # of WebP


def suffix() -> str:
    """``.webp``, or ``.gif`` where this Pillow cannot write WebP."""
    from PIL import features

    return ".webp" if features.check("webp") else ".gif"


def write(ds: xr.Dataset, axis: str, path: Path) -> int:
    """Write the animated picture, WebP or GIF by its suffix; returns the number of its frames.

    Raises `InputError` for an axis with fewer than two solved cases.
    """
    from PIL import Image

    made = [Image.fromarray(frame) for frame in frames(ds, axis)]
    shown = [*made, *made[-2:0:-1]]
    how: dict[str, Any] = {"quality": QUALITY, "method": 4} if path.suffix == ".webp" else {"optimize": True}

    def save(aside: Path) -> None:
        duration = round(1000 * SECONDS / len(shown))
        shown[0].save(aside, save_all=True, append_images=shown[1:], duration=duration, loop=0, **how)

    atomic.write(path, save)
    return len(shown)


def frames(ds: xr.Dataset, axis: str, dpi: int = style.DPI) -> list[Pixels]:
    """The frames along the axis, (height, width, 3) each; a case that is not solved has none. Raises `InputError`."""
    kind = kinds.kind_of("contact")
    found = [(where, rods.of_case(ds, where, kind)[0]) for where in selection.line(ds, axis)]
    solved = [(where[axis], body) for where, body in found if body is not None]
    if len(solved) < 2:
        raise InputError(f"a sweep needs two solved cases along {axis}, got {len(solved)}")
    context = [body for _, body in solved]
    return [_frame(ds, axis, i, body, context, dpi) for i, body in solved]


def _frame(ds: xr.Dataset, axis: str, i: int, body: Body, context: Sequence[Body], dpi: int) -> Pixels:
    """The pixels of the i-th case: its value on the axis, the rod from two sides, the scale of colours."""
    from . import composition  # VTK, which ends the process where OpenGL does not work

    finer = dpi / style.DPI
    room = SIZE[0] - MARGIN, SIZE[1] - TOP - FOOT
    settings = Settings(dpi=dpi, bare=True, size=(round(room[0] * finer), round(room[1] * finer)))
    kind, camera, ends = kinds.kind_of("contact"), cameras.facing(context, lying=True), ends_of(context)
    rows = [[View([body], Cell(""), -np.radians(side), ends, context)] for side in SIDES]
    scene = composition.Scene(ds, kind, rows, context, "", camera, settings, outlined=False)  # the legend has no room
    page = composition.composed(scene).page
    bar = kind.paint(ds, context)[1]

    def draw(fig: Figure) -> None:
        _axis(fig, ds[axis], axis, i)
        high, wide = (n / finer for n in page.pixels.shape[:2])
        left, low = (SIZE[0] - wide) / 2, FOOT + (room[1] - high) / 2
        pixels.put(fig, page.pixels, round(left * finer), round(low * finer))
        x = float(MARGIN)
        if bar:
            below = footer.colour_bar(replace(bar, label="push of the cylinder [" + bar.label.partition("[")[2]))
            below.draw(fig, x, 12)
            x += below.width + footer.APART
        for colour, words in kind.legend(context):
            entry = footer.entry(colour, words)
            entry.draw(fig, x, 36)
            x += entry.width + footer.APART

    return pixels.drawn(canvas.figure((SIZE[0] / style.DPI, SIZE[1] / style.DPI), draw, dpi=dpi, layout=None))


def _share(values: NDArray[np.float64], i: int) -> float:
    """Where the i-th of rising values stands between the first and the last; by their ratios over a wide range."""
    wide = values[0] > 0 and values[-1] > WIDE * values[0]
    first, here, last = np.log(values[[0, i, -1]]) if wide else values[[0, i, -1]]
    return float((here - first) / (last - first))


def _axis(fig: Figure, array: xr.DataArray, axis: str, i: int) -> None:
    """The i-th value in words, and where it stands among the values of the axis."""
    y = SIZE[1] - 0.7 * MARGIN
    said = f"{labels.axis_symbol(axis)} = {labels.value(float(array[i]), array, DIGITS)}"
    name = labels.long_name(array)
    drawing.text(fig, MARGIN, y, said, size=style.LARGE, va="top", weight="bold")
    drawing.text(fig, SIZE[0] - MARGIN, y - 4, name[:1].upper() + name[1:], color=style.SOFT, va="top", ha="right")
    share = _share(array.values, i)
    y, left, right = y - 62, float(MARGIN), float(SIZE[0] - MARGIN)
    drawing.line(fig, (left, y), (right, y), color=style.FAINT, linewidth=2.5)
    drawing.line(fig, (left, y), (left + share * (right - left), y), color=style.PUSHED, linewidth=2.5)
    drawing.spot(fig, left + share * (right - left), y, 9.0, style.PUSHED)
