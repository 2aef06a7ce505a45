"""What a picture shows, from its pixels."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread
from numpy.typing import NDArray

from workbench.scene import opengl

# A test that draws a scene.
draws = pytest.mark.skipif(not opengl.probe()[0], reason=opengl.probe()[1])


def pixels(path: Path) -> NDArray[np.float64]:
    """(height, width, 3) between 0 and 1."""
    return np.asarray(imread(path), dtype=float)[..., :3]


def share_of_hue(picture: NDArray[np.float64], colour: str, slack: float = 0.06) -> float:
    """The share of the pixels whose colour, whatever its brightness, is that one."""
    wanted = np.array(to_rgb(colour))
    strong = np.ptp(picture, axis=-1) > 0.25  # greys have no hue
    bright = picture / np.maximum(picture.max(axis=-1, keepdims=True), 1e-9)
    near = np.abs(bright - wanted / wanted.max()).max(axis=-1) < slack
    return float((near & strong).mean())


def shares_of_push(picture: NDArray[np.float64]) -> tuple[float, float]:
    """The shares of the pixels in the orange of a pull and in the blue of a push, where both are strong."""
    warm = picture[..., 0] - picture[..., 2]
    return float((warm > 0.3).mean()), float((warm < -0.3).mean())


def share_of_ink(picture: NDArray[np.float64]) -> float:
    """The share of the pixels that are not white."""
    return float((picture.min(axis=-1) < 0.98).mean())
