"""Numbers beside points of a diagram: each is placed where it covers no other number, no point and few lines.

A number is nearer to its own point than to any other, or a thin line leads from it to its point.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from . import colours, fonts

SAME = 0.03  # inches: nearer points have one text
AWAY = (0.13, 0.2, 0.28, 0.38, 0.5, 0.64)  # inches from a point to the middle of its number
NEXT = 0.08  # inches: numbers nearer to each other are taken for one
FAR, SEEN = 0.12, 0.1  # inches: numbers farther away have a line to their point; the least length of such a line
CLEAR = 0.7  # a number is nearer to its point by this factor than to any other, or has a line to its point
WAYS = np.radians([60, 120, 300, 240, 90, 270, 0, 180, 30, 150, 330, 210])
HALO = 0.02  # inches around a number that are white
STEP = 0.03  # inches between the places of a line that are looked at

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Point:
    """A point of a diagram in the units of its axes, and what it is called: a number, perhaps with a letter."""

    x: float
    y: float
    name: str


@dataclass(frozen=True)
class _Others:
    """What stands in a diagram, in inches: places along its lines, its points, its size, and the numbers so far."""

    lines: Values
    dots: Values
    inches: Values
    boxes: list[Values]
    leaders: list[Values]


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
    dots_of = np.concatenate([places, *((np.asarray(mark, dtype=float)[None] - low) * per for mark in marks)])
    others = _Others(covered, dots_of, np.array(inches), [], [])
    for group in _groups(places):
        text, place = join([points[i].name for i in group]), places[group[0]]
        size = np.array([fonts.width_of(text, fonts.small()) + 0.03, fonts.small() * 1.15 / 72])
        middle = _best(place, size, others)
        box = np.stack([middle - size / 2, middle + size / 2])
        led = _is_led(place, box, others.dots)
        others.boxes.append(box)
        if led:
            others.leaders.append(_along(np.stack([place, middle])))
        ax.annotate(text, dots[group[0]], 72 * (middle - place), textcoords="offset points", ha="center", va="center",
                    size=fonts.small(), color=colours.INK, zorder=20, annotation_clip=False,
                    path_effects=[withStroke(linewidth=2.0, foreground="white", alpha=0.9)],
                    arrowprops={"arrowstyle": "-", "color": colours.INK, "linewidth": 0.5, "shrinkA": 0,
                                "shrinkB": 1} if led else None)  # fmt: skip


def join(names: Sequence[str]) -> str:
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


def _best(place: Values, size: Values, others: _Others) -> Values:
    """The middle of a text of that size near a place: of those that cover least, the nearest."""
    best, least = place, np.inf
    near = others.lines[_inside(others.lines, np.stack([place, place]), AWAY[-1] + size.max())]
    for away, way in product(AWAY, WAYS):
        if 6 * away >= least:
            break  # what is covered adds to this
        middle = place + (away + np.array([size[0] / 2 - 0.05, 0]) * abs(np.cos(way))) * [np.cos(way), np.sin(way)]
        box = np.stack([middle - size / 2, middle + size / 2])
        cost = 6 * away + 1.2 * _inside(near, box, HALO).sum() + 40 * _inside(others.dots, box, 0.04).sum()
        cost += 40 * sum(bool((box[0] < other[1]).all() and (box[1] > other[0]).all()) for other in others.boxes)
        cost += 4 * sum(bool((np.maximum(box[0] - other[1], other[0] - box[1]) < NEXT).all()) for other in others.boxes)
        cost += 10 * max(_share(place, box, others.dots) - 0.3, 0)
        cost += 40 * sum(bool(_inside(line, box, 0.02).any()) for line in others.leaders)
        cost += 40 * bool((box[0] < 0).any() or (box[1] > others.inches).any())
        if _is_led(place, box, others.dots):
            cost += _cost_of_leader(place, box, others)
        if cost < least:
            best, least = middle, float(cost)
    return best


def _is_led(place: Values, box: Values, dots: Values) -> bool:
    """Whether a number in a box needs a line to its place: it is far away, or as near to another point."""
    return bool(_gaps(box, place[None])[0] > FAR or _share(place, box, dots) > CLEAR)


def _share(place: Values, box: Values, dots: Values) -> float:
    """The distance of a box from its own place over that from the nearest other point, 2 at most."""
    gap, apart = float(_gaps(box, place[None])[0]), dots[np.linalg.norm(dots - place, axis=1) >= SAME]
    return min(gap / max(float(_gaps(box, apart).min(initial=np.inf)), 1e-9), 2.0)


def _cost_of_leader(place: Values, box: Values, others: _Others) -> float:
    """A line that is too short to see, passes another point or a number, or crosses another line says less."""
    line = _along(np.stack([place, box.mean(axis=0)]))
    apart = others.dots[np.linalg.norm(others.dots - place, axis=1) >= SAME]
    passed = np.linalg.norm(apart[:, None] - line, axis=2).min(axis=1) < 0.06
    crossed = [np.linalg.norm(line[1:, None] - other[1:], axis=2).min() < STEP for other in others.leaders]
    covered = [_inside(line, other).any() for other in others.boxes]
    return float(
        5 + 20 * (_gaps(box, place[None])[0] < SEEN) + 15 * passed.sum() + 15 * sum(crossed) + 30 * sum(covered)
    )


def _gaps(box: Values, some: Values) -> Values:
    """The distance of each point from a box."""
    return np.asarray(np.linalg.norm(np.maximum(np.maximum(box[0] - some, some - box[1]), 0), axis=1))


def _inside(some: Values, box: Values, margin: float = 0.0) -> NDArray[np.bool_]:
    (left, low), (right, high) = box[0] - margin, box[1] + margin
    x, y = some.T
    return np.asarray((x > left) & (x < right) & (y > low) & (y < high))


def _along(line: Values) -> Values:
    """Places along a line, `STEP` apart at most."""
    if len(line) < 2:
        return line
    steps = np.diff(line, axis=0)
    counts = 2 + (np.linalg.norm(steps, axis=1) / STEP).astype(int)
    ends = counts.cumsum()
    shares = (np.arange(ends[-1]) - (ends - counts).repeat(counts)) / (counts - 1).repeat(counts)
    return np.asarray(line[:-1].repeat(counts, axis=0) + steps.repeat(counts, axis=0) * shares[:, None])
