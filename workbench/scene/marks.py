"""Labels beside rods, each where it hides least. No OpenGL; lengths in pixels at `style.DPI`."""

from collections.abc import Sequence

import numpy as np

from ..figures import style
from ..geometry.centreline import Array
from . import measure

AWAY = (16.0, 26.0)  # from a place of the rod to the middle of the near side of its label
SIDES = 16  # directions that are tried
ALONG = 40  # places along a rod that are tried
APART = 2.0  # heights of a label between two labels
CLEAR = 6.0  # pixels between a label and the middle line of a rod

Box = tuple[float, float, float, float]


def beside(
    places: Sequence[Array], texts: Sequence[str], curves: Sequence[Array], size: tuple[float, float], wide: float
) -> list[tuple[float, float]]:
    """The left edge and the middle line of each label; at the far end of its rod where that is as good a place.

    Parameters
    ----------
    places
        Where the label of each rod may stand, in order along it, (m, 2) each.
    curves
        All that may be hidden, (n, 2) for each rod.
    size
        Of the picture, in which the labels stay.
    wide
        Half the width of a rod.
    """
    placed: list[Box] = []
    high = measure.height("1", style.SMALL) * 1.2
    for k, (own, text) in enumerate(zip(places, texts, strict=True)):
        others = np.concatenate([curve for j, curve in enumerate(curves) if j != k] or [np.zeros((0, 2))])
        label = measure.width(text, style.SMALL, bold=True), high
        anchors = own[:: -max(len(own) // ALONG, 1)]
        best: tuple[float, Box] | None = None
        for late, anchor in enumerate(anchors):
            for away in AWAY:
                for box in _around(anchor, label, away + wide):
                    cost = _hidden(box, curves[k], wide) + 3 * _hidden(box, others, 3 * wide) + 0.2 * late
                    cost += 10_000 * sum(_near(box, other, APART * high) for other in placed)
                    cost += 10_000 * (box[0] < 0 or box[1] < 0 or box[2] > size[0] or box[3] > size[1])
                    if best is None or cost < best[0]:
                        best = cost, box
        assert best is not None
        placed.append(best[1])
    return [(box[0], (box[1] + box[3]) / 2) for box in placed]


def gap(place: tuple[float, float], text: str, curve: Array) -> float:
    """The least distance from a label, of which the left edge and the middle line are given, to a curve."""
    wide, high = measure.width(text, style.SMALL, bold=True), measure.height("1", style.SMALL)
    inside = np.clip(curve, [place[0], place[1] - high / 2], [place[0] + wide, place[1] + high / 2])
    return float(np.hypot(*(curve - inside).T).min())


def _around(anchor: Array, label: tuple[float, float], away: float) -> list[Box]:
    """The boxes of a label around a place."""
    found, (wide, high) = [], label
    for angle in 2 * np.pi * np.arange(SIDES) / SIDES:
        x = float(anchor[0] + np.cos(angle) * (away + wide / 2))
        y = float(anchor[1] + np.sin(angle) * (away + high / 2))
        found.append((x - wide / 2, y - high / 2, x + wide / 2, y + high / 2))
    return found


def _hidden(box: Box, points: Array, gap: float) -> float:
    """How many points lie behind a label or less than a gap from it."""
    gap += CLEAR
    inside = (points > np.array(box[:2]) - gap) & (points < np.array(box[2:]) + gap)
    return float(inside.all(axis=1).sum())


def _near(one: Box, other: Box, gap: float) -> bool:
    """Whether two boxes are less than a gap apart, both to the right and up."""
    return one[0] - gap < other[2] and other[0] - gap < one[2] and one[1] - gap < other[3] and other[1] - gap < one[3]
