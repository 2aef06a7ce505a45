"""Numbers beside points of a diagram: each is placed where it covers no other number, no point and few lines."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from . import style

SAME = 0.03  # inches: nearer points have one text
AWAY = (0.13, 0.2, 0.28, 0.38, 0.5, 0.64)  # inches from a point to the middle of its number
FAR = 0.17  # inches: a number that is farther away has a line to its point
WAYS = np.radians([60, 120, 300, 240, 90, 270, 0, 180, 30, 150, 330, 210])
STEP = 0.03  # inches between the places of a line that are looked at

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Point:
    """A point of a diagram in the units of its axes, and what it is called: a number, perhaps with a letter."""

    x: float
    y: float
    name: str


def write(
    ax: Axes, points: Sequence[Point], lines: Sequence[Any], marks: Sequence[Any], inches: tuple[float, float]
) -> None:
    """Write the numbers of points beside them; points at one place share a text, ``3, 4``.

    Parameters
    ----------
    ax
        The diagram; its limits are final.
    points
        What is numbered.
    lines
        What the numbers should not cover, (n, 2) each in the units of the axes.
    marks
        Points that they may not cover, (2,) each.
    inches
        Width and height of the diagram.
    """
    low = np.array([ax.get_xlim()[0], ax.get_ylim()[0]])
    per = np.array(inches) / (np.array([ax.get_xlim()[1], ax.get_ylim()[1]]) - low)
    dots = np.array([[point.x, point.y] for point in points]).reshape(-1, 2)
    places = (dots - low) * per
    covered = np.concatenate([np.empty((0, 2)), *(_along((np.asarray(line) - low) * per) for line in lines)])
    kept = [places, *((np.asarray(mark, dtype=float)[None] - low) * per for mark in marks)]
    taken: list[Values] = []
    for group in _groups(places):
        text = joined([points[i].name for i in group])
        size = np.array([style.width_of(text, style.small()) + 0.03, style.small() * 1.15 / 72])
        middle = _best(places[group[0]], size, (covered, np.concatenate(kept), taken), np.array(inches))
        taken.append(np.stack([middle - size / 2, middle + size / 2]))
        shift = middle - places[group[0]]
        far = np.linalg.norm(shift) > FAR
        ax.annotate(text, dots[group[0]], 72 * shift, textcoords="offset points", ha="center", va="center",
                    size=style.small(), color=style.INK, zorder=20, annotation_clip=False,
                    path_effects=[withStroke(linewidth=2.0, foreground="white", alpha=0.9)],
                    arrowprops={"arrowstyle": "-", "color": style.INK, "linewidth": 0.5, "shrinkA": 1,
                                "shrinkB": 2} if far else None)  # fmt: skip


def joined(names: Sequence[str]) -> str:
    """``1, 4–6``; names with a letter one by one."""
    if not all(name.isdigit() for name in names):
        return ", ".join(names)
    runs: list[list[int]] = []
    for number in sorted(map(int, names)):
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    parts = [[str(n) for n in run] if len(run) < 3 else [f"{run[0]}–{run[-1]}"] for run in runs]
    return ", ".join(part for run in parts for part in run)


def _groups(places: Values) -> list[list[int]]:
    """The points that lie at one place, in order."""
    groups: list[list[int]] = []
    for i, place in enumerate(places):
        near = next((group for group in groups if np.linalg.norm(places[group[0]] - place) < SAME), None)
        if near is None:
            groups.append([i])
        else:
            near.append(i)
    return groups


def _best(place: Values, size: Values, others: tuple[Values, Values, list[Values]], inches: Values) -> Values:
    """The middle of a text of that size near a place: of those that cover least, the nearest."""
    lines, dots, taken = others
    best, least = place, np.inf
    for away, way in product(AWAY, WAYS):
        middle = place + (away + np.array([size[0] / 2 - 0.05, 0]) * abs(np.cos(way))) * [np.cos(way), np.sin(way)]
        box = np.stack([middle - size / 2, middle + size / 2])
        cost = 6 * away + 1.2 * _inside(lines, box).sum() + 40 * _inside(dots, box, 0.04).sum()
        cost += 40 * sum(bool((box[0] < other[1]).all() and (box[1] > other[0]).all()) for other in taken)
        cost += 40 * bool((box[0] < 0).any() or (box[1] > inches).any())
        if cost < least:
            best, least = middle, float(cost)
    return best


def _inside(some: Values, box: Values, margin: float = 0.0) -> NDArray[np.bool_]:
    return np.asarray(((some > box[0] - margin) & (some < box[1] + margin)).all(axis=1))


def _along(line: Values) -> Values:
    """Places along a line, `STEP` apart at most."""
    if len(line) < 2:
        return line
    parts = [a + (b - a) * np.linspace(0, 1, 2 + int(np.linalg.norm(b - a) / STEP))[:, None] for a, b in pairwise(line)]
    return np.concatenate(parts)
