"""The pixels of a picture as means of samples, rendered a few at a time. Needs OpenGL."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from . import hidden

FINER = 4  # a pixel has 4 x 4 places; every second has a sample, as on a chessboard, so each row and column has two
AT_ONCE = 5_000_000  # pixels of a picture, up to which 2 x 2 samples of each are rendered at once


@dataclass(frozen=True, eq=False)
class Window:
    """What renders: a plotter, width and height of the picture in pixels, `block` x `block` samples of each at once.

    finer: the places of samples along each side of a pixel.
    """

    plotter: Any
    size: tuple[int, int]
    block: int
    finer: int = FINER

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width in samples."""
        return self.size[1] * self.block, self.size[0] * self.block

    def colours(self) -> NDArray[np.uint8]:
        """The colours of what was rendered, (*shape, 3)."""
        found = pv.convert_array(np.zeros(1, dtype=np.uint8))
        self.plotter.ren_win.GetPixelData(0, 0, self.shape[1] - 1, self.shape[0] - 1, 0, found, 0)
        return np.asarray(pv.convert_array(found)).reshape(*self.shape, 3)

    def depths(self) -> NDArray[np.float32]:
        """The depths of what was rendered, from 0 at the camera to 1 where nothing is, `shape`."""
        found = pv.convert_array(np.zeros(1, dtype=np.float32))
        self.plotter.ren_win.GetZbufferData(0, 0, self.shape[1] - 1, self.shape[0] - 1, found)
        return np.asarray(pv.convert_array(found)).reshape(self.shape)

    @property
    def moves(self) -> list[tuple[float, float]]:
        """By how much the picture is moved for each rendering, in samples to the right and up."""
        steps = self.finer // self.block
        places = [place for place in np.ndindex(steps, steps) if sum(place) % 2 == 0]
        return [((i + 0.5) / steps - 0.5, (j + 0.5) / steps - 0.5) for i, j in places]

    def move(self, right: float, up: float) -> None:
        """Move the picture by parts of a sample."""
        self.plotter.camera.SetWindowCenter(2 * right / self.shape[1], 2 * up / self.shape[0])

    def render(self) -> None:
        """Render everything."""
        self.plotter.ren_win.Render()

    def render_before(self, walls: Sequence[Any]) -> NDArray[np.float32]:
        """Render everything, the walls last; returns the depths without the walls."""
        rods = [actor for actor in self.plotter.actors.values() if actor not in walls]
        _show(walls, False)
        self.render()
        depths = self.depths()
        _show(walls, True)
        _show(rods, False)
        self.plotter.renderer.SetErase(False)
        self.render()
        self.plotter.renderer.SetErase(True)
        _show(rods, True)
        return depths

    def add_samples(self, samples: NDArray[Any], into: NDArray[Any]) -> None:
        """Add the samples of each pixel to it."""
        for i, j in np.ndindex(self.block, self.block):
            into += samples[i :: self.block, j :: self.block]


def block_for(size: tuple[int, int], finer: int) -> int:
    """How many samples along each direction are rendered at once."""
    return min(finer, 2 if size[0] * size[1] <= AT_ONCE else 1)


def mean(
    window: Window, walls: Sequence[Any], drawn: hidden.Drawn | None, transparent: bool
) -> tuple[NDArray[np.uint8], NDArray[np.uint8], bool]:
    """The mean of all samples of each pixel: colours, (height, width, 3), and what is covered, (height, width, 1).

    The third value is whether an outline of a hidden stretch is drawn.

    walls: what hides stretches of the rods. drawn: how these are drawn; default: not at all.
    """
    wide, high = window.size
    sums, covered = np.zeros((high, wide, 3), dtype=np.uint16), np.zeros((high, wide, 1), dtype=np.uint16)
    line, behind = np.zeros((2, high, wide), dtype=np.uint8)
    for k, move in enumerate(window.moves):
        window.move(*move)
        if k == 0 and drawn:
            rods = window.render_before(walls)
            for found, into in zip(hidden.lines(rods, window.depths(), drawn), (line, behind), strict=True):
                window.add_samples(found, into)
        else:
            window.render()
        window.add_samples(window.colours(), sums)
        if transparent:
            window.add_samples((window.depths() < 1)[..., None], covered)
    samples = len(window.moves) * window.block**2
    pixels = sums * np.float32(1 / samples)
    if drawn:
        hidden.over(pixels, *((found / window.block**2).astype(np.float32) for found in (line, behind)))
    if transparent:  # what is seen beside white in a pixel
        share = np.maximum(covered, 1) / samples
        pixels = np.where(covered > 0, (pixels - 255 * (1 - share)) / share, 255)
    alpha = np.round(covered * (255 / samples)).astype(np.uint8)
    return (np.clip(pixels, 0, 255) + np.float32(0.5)).astype(np.uint8)[::-1], alpha[::-1], bool(line.any())


def _show(actors: Sequence[Any], shown: bool) -> None:
    for actor in actors:
        actor.SetVisibility(shown)
