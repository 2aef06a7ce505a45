"""Stretches of a rod behind its cylinder, in outline: the lines of a technical drawing. NumPy only.

They are not drawn in a paler colour, because a pale blue means a small push.
"""

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from ..figures.style import SOFT

LINE = 0.8  # opacity of the outline
SHADE = 0.06  # by which the cylinder is darker there


def lines(
    rods: NDArray[np.float32], everything: NDArray[np.float32], edge: float, sliver: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """The pixels on the outline of hidden rods, and all pixels of them.

    rods, everything: depths of a picture of the rods alone and of the whole picture, (height, width), 1 where nothing
    is. edge: the step of depth that is an edge between two stretches. sliver: the width in pixels of what is left out,
    such as the lower side of a rod beyond the horizon of the cylinder.
    """
    behind = (rods < 1) & (everything < rods - 1e-4)
    for least in (minimum_filter1d, maximum_filter1d):
        for axis in (0, 1):
            behind = least(behind, 2 * int(sliver / 2) + 1, axis=axis)
    behind &= rods < 1
    line = np.zeros_like(behind)
    for axis in (0, 1):
        for step in (1, -1):
            beside = np.roll(rods, step, axis=axis)
            line |= behind & (beside - rods > edge)  # a background, which has depth 1, is deeper too
    return line, behind


def drawn(pixels: NDArray[np.float64], line: NDArray[np.float64], behind: NDArray[np.float64]) -> NDArray[np.float64]:
    """The picture with hidden stretches; line, behind: the share of each pixel on the outline and behind the wall."""
    pixels = pixels * (1 - SHADE * behind[..., None])
    share = LINE * line[..., None]
    return pixels * (1 - share) + 255 * np.array(to_rgb(SOFT)) * share
