"""Pixels put on a figure as they are, and a figure as pixels."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..data import atomic
from ..figures import style

Pixels = NDArray[np.uint8]

QUALITY = 92  # of JPEG
RUNS = 3  # the strategy of zlib that looks for runs alone: at level 1 the size of level 3 in two thirds of the time


class _Kept(Artist):
    """A picture of which each pixel is a pixel of the figure; x, y: its lower left. Matplotlib's would resample it."""

    def __init__(self, pixels: Pixels, x: int, y: int) -> None:
        super().__init__()
        full = np.full((*pixels.shape[:2], 4), 255, dtype=np.uint8)
        full[..., : pixels.shape[2]] = pixels
        self.pixels, self.at = full[::-1], (x, y)

    def draw(self, renderer: Any) -> None:
        """Draw it."""
        context = renderer.new_gc()
        renderer.draw_image(context, *self.at, self.pixels)
        context.restore()


def put(fig: Figure, pixels: Pixels, x: int, y: int) -> None:
    """Put a picture, (height, width, 3 or 4), on a figure; x, y: its lower left in pixels of the figure."""
    fig.add_artist(_Kept(pixels, x, y))


def drawn(fig: Figure) -> Pixels:
    """The figure as pixels, (height, width, 3), or 4 where its background is transparent."""
    canvas: Any = fig.canvas
    with rc_context(style.RC):
        canvas.draw()
    channels = 3 if fig.patch.get_alpha() is None else 4
    return np.array(canvas.buffer_rgba())[..., :channels]


def save(fig: Figure, path: Path, level: int = 1) -> None:
    """Save the figure as PNG or JPEG by the suffix of the path; level: how hard a PNG is compressed, from 1 to 9.

    Raises `InputError` where the file cannot be written; an existing file then stays as it was.
    """
    from PIL import Image

    picture = Image.fromarray(drawn(fig))
    how: dict[str, Any] = {"quality": QUALITY}
    if path.suffix.lower() == ".png":
        how = {"compress_level": level, "compress_type": RUNS if level == 1 else 0}
    atomic.write(path, lambda aside: picture.save(aside, dpi=(fig.dpi, fig.dpi), **how))
