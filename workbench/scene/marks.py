"""Labels at the ends of rods, each where it hides least. No OpenGL; lengths in pixels at `style.DPI`."""

from collections.abc import Sequence

import numpy as np

from ..figures import style
from ..geometry.centreline import Array
from . import measure

AWAY = (16.0, 34.0, 60.0)  # from the end to the middle of the near side of its label
SIDES = 16  # directions that are tried


def beside(
    ends: Sequence[tuple[float, float]], texts: Sequence[str], curves: Sequence[Array], size: tuple[float, float]
) -> list[tuple[float, float]]:
    """The left edge and the middle line of each label.

    Parameters
    ----------
    ends
        The places that are labelled, in the picture.
    curves
        The rods there, (n, 2) each.
    size
        Of the picture, in which the labels stay.
    """
    points, found = np.concatenate(curves), []
    placed: list[tuple[float, float, float, float]] = []
    high = measure.height("1", style.SMALL) * 1.2
    for (x, y), text in zip(ends, texts, strict=True):
        wide = measure.width(text, style.SMALL, bold=True)
        best: tuple[float, tuple[float, float, float, float]] | None = None
        for k, away in enumerate(AWAY):
            for angle in 2 * np.pi * np.arange(SIDES) / SIDES:
                right, down = np.cos(angle), np.sin(angle)
                middle = x + right * (away + wide / 2), y + down * (away + high / 2)
                box = middle[0] - wide / 2, middle[1] - high / 2, middle[0] + wide / 2, middle[1] + high / 2
                cost = _hidden(box, points) + 10_000 * sum(_overlap(box, other) for other in placed) + 4 * k
                cost += 10_000 * (box[0] < 0 or box[1] < 0 or box[2] > size[0] or box[3] > size[1])
                if best is None or cost < best[0]:
                    best = cost, box
        assert best is not None
        placed.append(best[1])
        found.append((best[1][0], (best[1][1] + best[1][3]) / 2))
    return found


def _hidden(box: tuple[float, float, float, float], points: Array) -> float:
    """How many points of the rods lie behind a label."""
    inside = (points > np.array(box[:2]) - 6) & (points < np.array(box[2:]) + 6)
    return float(inside.all(axis=1).sum())


def _overlap(one: tuple[float, float, float, float], other: tuple[float, float, float, float]) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]
