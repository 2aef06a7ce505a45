"""Numbers of points and lines of a diagram. One beside a point covers no other number, no point and few lines.

A number is nearer to its own point than to any other, or a thin line leads from it to its point. One that is not
needed is written only where it covers nothing. What stands in a diagram is one list of places, each with what it costs
to cover it: so lines, points, numbers and leading lines are avoided by one rule. The number of a line stands on it,
where it covers nothing else. Lengths are in inches.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, product
from string import ascii_lowercase
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray
from scipy.spatial import KDTree

from . import colours, fonts
from .halo import Halo

SAME = 0.03  # nearer points have one text
AWAY = (0.13, 0.2, 0.28, 0.38, 0.5, 0.64)  # from a point to the middle of its number
WAYS = np.radians([60, 120, 300, 240, 90, 270, 0, 180, 30, 150, 330, 210])
FAR = 0.12  # a number farther away has a line to its point
CLEAR = 0.7  # a number is nearer to its point by this factor than to any other, or has a line to its point
SEEN = 0.1  # the least length of such a line
STEP = 0.03  # between the places of lines and numbers, and around a number or a line what it covers
LINE, POINT, LED = 1.2, 40.0, 5.0  # what it costs to cover a place of a line, and any other; to need a leading line

DIGIT = 0.8  # height of a digit on a line, in the size of the letters
ENDS = 1.5  # widths of its number from either end of a line: of a shorter one too little would be left
AS_FREE = 3.0  # times the place that a number needs: with more room none is better
MOST_LINES = 60  # more have no room for numbers on them on the height of a page

Values = NDArray[np.float64]


@dataclass(frozen=True)
class NumberedPoint:
    """A point of a diagram in the units of its axes, and what it is called: a number, perhaps with a letter.

    needed: whether the number is written also where it covers a line or has a line to its point. bare: whether the
    point has no dot, and so a line from its number.
    """

    x: float
    y: float
    name: str
    needed: bool = True
    bare: bool = False


def write(
    ax: Axes,
    points: Sequence[NumberedPoint],
    lines: Sequence[Any],
    marks: Sequence[Any],
    inches: tuple[float, float],
    on: Sequence[tuple[Sequence[str], Any]] = (),
) -> tuple[list[int], set[str]]:
    """Write the numbers of points beside them; points at one place share a text, ``3, 4``, the needed ones if any is.

    Returns the places of the points in their list whose numbers are written, and all numbers that are written, without
    letters.

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
    on
        Further lines, (n, 2) each, with the numbers that belong to each. Those which no point has are written on the
        line, if they cover nothing else there.
    """
    low, high = np.transpose([ax.get_xlim(), ax.get_ylim()])
    per = np.array(inches) / (high - low)
    places = (np.array([[point.x, point.y] for point in points]).reshape(-1, 2) - low) * per
    dots = np.concatenate([places, *((np.asarray(mark, dtype=float)[None] - low) * per for mark in marks)])
    taken = np.concatenate([_at_cost(dots, POINT), *(_at_cost(_along((line - low) * per), LINE) for line in lines)])
    written = list[int]()
    groups = [[i for i in group if points[i].needed] or group for group in _groups(places)]
    for group in sorted(groups, key=lambda group: not points[group[0]].needed):
        text, place = join([points[i].name for i in group]), places[group[0]]
        size = np.array([fonts.width_of(text, fonts.small()) + STEP, fonts.small() * 1.15 / 72])
        others = dots[np.linalg.norm(dots - place, axis=1) >= SAME]
        middle, led, clean = _best(place, size, taken, others, np.array(inches), points[group[0]].bare)
        if not (clean or points[group[0]].needed):
            continue
        written += group
        taken = np.concatenate([taken, _box(middle, size)])
        if led:
            taken = np.concatenate([taken, _at_cost(_along(np.stack([place, middle]))[1:], POINT)])
        ax.annotate(text, (points[group[0]].x, points[group[0]].y), 72 * (middle - place), textcoords="offset points",
                    ha="center", va="center", size=fonts.small(), color=colours.INK, zorder=20, annotation_clip=False,
                    path_effects=[Halo(2.0, 0.9)],
                    arrowprops={"arrowstyle": "-", "color": colours.INK, "linewidth": 0.5, "shrinkA": 0,
                                "shrinkB": 1} if led else None)  # fmt: skip
    said = {points[i].name.rstrip(ascii_lowercase) for i in written}
    paths = [_along((line - low) * per) for _, line in on]
    for k, (names, _) in enumerate(on if len(on) <= MOST_LINES else ()):
        if text := join([name for name in names if name not in said]):
            size = np.array([fonts.width_of(text, fonts.small()), DIGIT * fonts.small() / 72])
            others = np.concatenate([taken[taken[:, 2] > LINE, :2], *paths[:k], *paths[k + 1 :]])
            if (at := _free_place(paths[k], size, others, np.array(inches))) is not None:
                said |= {*names}
                taken = np.concatenate([taken, _box(at, size)])
                ax.annotate(text, low + at / per, ha="center", va="center", size=fonts.small(), color=colours.INK,
                            zorder=20, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.3})  # fmt: skip
    return written, said


def _free_place(line: Values, size: Values, others: Values, inches: Values) -> Values | None:
    """The middle of a text of that size on a line, (n, 2), where other places are farthest; None where none is free."""
    reach, cut = size / 2 + STEP, int(ENDS * size[0] / STEP)
    places = line[cut : len(line) - cut]
    places = places[((places >= reach) & (places <= inches - reach)).all(axis=1)]
    if not len(places):
        return None
    away = KDTree(others / reach).query(places / reach, p=np.inf)[0] if len(others) else np.full(len(places), np.inf)
    best = int(np.argmax(np.minimum(away, AS_FREE) - 0.1 * np.abs(np.linspace(-1, 1, len(places)))))
    return np.asarray(places[best]) if away[best] > 1 else None


def _box(middle: Values, size: Values) -> Values:
    """The places that a text of that size takes, with their costs, (n, 3)."""
    shares = np.stack(np.meshgrid(*(np.linspace(-0.5, 0.5, 2 + int(side / STEP)) for side in size)), axis=-1)
    return _at_cost(middle + shares.reshape(-1, 2) * size, POINT)


def join(names: Sequence[str]) -> str:
    """``1, 4–6``; names with a letter one by one."""
    if not all(name.isdigit() for name in names):
        return ", ".join(names)
    numbers = enumerate(sorted(map(int, names)))
    runs = [[n for _, n in run] for _, run in groupby(numbers, lambda pair: pair[1] - pair[0])]
    parts = [map(str, run) if len(run) < 3 else [f"{run[0]}–{run[-1]}"] for run in runs]
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


def _best(
    place: Values, size: Values, taken: Values, others: Values, inches: Values, bare: bool
) -> tuple[Values, bool, bool]:
    """The middle of a text of that size where it covers least, nearly the nearest, whether a line leads to it, and
    whether it stands inside, beside its point and on nothing.

    others: the other points. taken: what stands in the diagram, with its costs, (n, 3). bare: as of `NumberedPoint`.
    """
    best, least = (place, False, False), np.inf
    taken = taken[np.abs(taken[:, :2] - place).max(axis=1) < AWAY[-1] + 1.5 * size.max()]
    for away, way in product(AWAY, WAYS):
        middle = place + (away + np.array([size[0] / 2 - 0.05, 0]) * abs(np.cos(way))) * [np.cos(way), np.sin(way)]
        box = np.stack([middle - size / 2, middle + size / 2])
        gap = float(_gaps(box, place[None])[0])
        share = min(gap / max(float(_gaps(box, others).min(initial=np.inf)), 1e-9), 2.0)
        led = bare or gap > FAR or share > CLEAR
        covers = taken[_gaps(box, taken[:, :2]) < STEP, 2].sum()
        covers += POINT * bool((box[0] < 0).any() or (box[1] > inches).any())
        cost = 6 * away + covers + 10 * max(share - 0.3, 0)
        if led:
            line = _along(np.stack([place, middle]))[1:]
            near = np.linalg.norm(taken[:, None, :2] - line, axis=2).min(axis=1) < STEP
            cost += LED + POINT / 2 * (gap < SEEN) + taken[near & (taken[:, 2] > LINE), 2].sum() / 2
        if cost < least:
            best, least = (middle, led, covers == 0 and not led), float(cost)
    return best


def _at_cost(places: Values, cost: float) -> Values:
    """Places, (n, 2), with what it costs to cover one, (n, 3)."""
    return np.column_stack([places, np.full(len(places), cost)])


def _gaps(box: Values, some: Values) -> Values:
    """The distance of each point from a box."""
    return np.asarray(np.linalg.norm(np.maximum(np.maximum(box[0] - some, some - box[1]), 0), axis=1))


def _along(line: Values) -> Values:
    """Places along a line, `STEP` apart at most."""
    length = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    at = np.linspace(0, length[-1], 2 + int(length[-1] / STEP))
    return np.column_stack([np.interp(at, length, line[:, k]) for k in (0, 1)])
