"""Stretches of a rod behind its cylinder, in outline: the lines of a technical drawing. NumPy only.

They are not drawn in a paler colour, because a pale blue means a small push.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from ..figures.colours import HIDDEN_LINE, HIDDEN_SHADE, OUTLINE


@dataclass(frozen=True)
class Drawn:
    """How hidden stretches are drawn.

    Attributes
    ----------
    edge
        The step of depth that is an edge between two stretches; all depths together are 1.
    sliver
        The width in samples of what is left out, such as the lower side of a rod beyond the horizon of the cylinder.
    line
        The width of the outline in samples.
    """

    edge: float
    sliver: float
    line: float


def lines(
    rods: NDArray[np.float32], everything: NDArray[np.float32], drawn: Drawn
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The samples on the outline of hidden rods, and all samples of them.

    rods, everything: depths of a picture of the rods alone and of the whole picture, (height, width), 1 where nothing
    is.
    """
    hidden = (rods < 1) & (everything < rods - 1e-4)
    line, behind = np.zeros_like(hidden), np.zeros_like(hidden)
    some = _where(hidden, 2 * int(drawn.sliver / 2) + 2)
    line[some], behind[some] = _lines(rods[some], hidden[some], drawn)
    return line, behind


def _where(found: NDArray[Any], margin: int = 0) -> tuple[slice, slice]:
    """The rows and columns of a picture outside of which it is zero, with some around them."""
    places = [np.flatnonzero(found.any(axis=axis)) for axis in (1, 0)]
    rows, columns = (slice(max(n[0] - margin, 0), n[-1] + margin + 1) if n.size else slice(0) for n in places)
    return rows, columns


def _lines(
    rods: NDArray[np.float32], hidden: NDArray[np.bool_], drawn: Drawn
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The same of the part of a picture where rods are hidden."""
    behind = hidden
    for least in (minimum_filter1d, maximum_filter1d):
        for axis in (0, 1):
            behind = least(behind, 2 * int(drawn.sliver / 2) + 1, axis=axis)
    behind &= rods < 1
    line = np.zeros_like(behind)
    for axis in (0, 1):
        for step in (1, -1):
            beside = np.roll(rods, step, axis=axis)
            line |= behind & (beside - rods > drawn.edge)  # a background, which has depth 1, is deeper too
    for axis in (0, 1):
        line = maximum_filter1d(line, max(round(drawn.line), 1), axis=axis)
    return line & behind, behind


def over(pixels: NDArray[np.float32], line: NDArray[np.float32], behind: NDArray[np.float32]) -> None:
    """Draw hidden stretches; line, behind: the share of each pixel on the outline and behind the wall."""
    some = _where(behind)  # the line is part of it
    share = HIDDEN_LINE * line[some][..., None]
    pixels[some] *= (1 - HIDDEN_SHADE * behind[some][..., None]) * (1 - share)
    pixels[some] += np.float32(255) * np.array(to_rgb(OUTLINE), dtype=np.float32) * share
