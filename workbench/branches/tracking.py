"""Equilibria at neighbouring values of an axis joined into branches, by following each from value to value.

Between two values all equilibria are found again at the middle, and so on, until each has one like it at the next
value and no other that is nearly as like; what has none after the last halving has ended, next to a fold. So a coarse
axis has the branches of a fine one. (Newton's rule from shape to shape would not do: where a rod lies along a saddle
and swings once, the place of the swing hangs on digits that no mesh keeps.)
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from solver.equilibria import Equilibrium

LIKE = 0.35  # rad, the mean distance of beta of two shapes that may be one branch
CLEAR = 3.0  # how many times as far the next like must be
HALVINGS = 7
MEETING = 0.8  # rad, up to which two that end together met in a fold

Found = Callable[[float], list[Equilibrium]]
Last = tuple[float, Equilibrium]  # the value up to which a branch was followed, and its equilibrium there


@dataclass(frozen=True)
class Meet:
    """Two branches that end (or begin) in a fold: members i and j at value k, the last (or first) that both have; how
    far both were followed, and the value at which neither was found."""

    k: int
    i: int
    j: int
    first: Last
    second: Last
    beyond: float


@dataclass
class Links:
    """How the members at one value go on to those at another: which becomes which, where the others end or begin."""

    to: dict[int, int]
    ends: dict[int, Last]
    starts: dict[int, Last]
    gap: float  # between a branch's last value and the next one looked at


def apart(a: list[Equilibrium], b: list[Equilibrium]) -> Any:
    """Mean distance of beta along the rod, (len(a), len(b)); infinite between two of different index."""
    if not a or not b:
        return np.empty((len(a), len(b)))
    first, second = (np.array([one.solution.beta for one in some]) for some in (a, b))
    same = np.array([one.index for one in a])[:, None] == np.array([one.index for one in b])
    return np.where(same, np.abs(first[:, None] - second[None]).mean(axis=2), np.inf)


def _alike(a: list[Equilibrium], b: list[Equilibrium]) -> dict[int, int]:
    """Members of a and b that are one branch beyond doubt."""
    far = apart(a, b)
    if not far.size:
        return {}
    out = {}
    for i, j in zip(*linear_sum_assignment(np.minimum(far, 1e3)), strict=True):
        others = min(np.delete(far[i], j).min(initial=np.inf), np.delete(far[:, j], i).min(initial=np.inf))
        if far[i, j] < LIKE and CLEAR * far[i, j] < others:
            out[int(i)] = int(j)
    return out


def linked(
    at: Found, x: float, a: list[Equilibrium], y: float, b: list[Equilibrium], halvings: int = HALVINGS
) -> Links:
    """The branches from the members a at x to the members b at y; `at`: all equilibria at a value."""
    to = _alike(a, b)
    if halvings == 0 or len(to) == len(a) == len(b):
        ends = {i: (x, one) for i, one in enumerate(a) if i not in to}
        starts = {j: (y, one) for j, one in enumerate(b) if j not in to.values()}
        return Links(to, ends, starts, abs(y - x))
    middle = (x + y) / 2
    between = at(middle)
    near, far = linked(at, x, a, middle, between, halvings - 1), linked(at, middle, between, y, b, halvings - 1)
    whole = {i: far.to[m] for i, m in near.to.items() if m in far.to}
    ends = near.ends | {i: far.ends[m] for i, m in near.to.items() if m in far.ends}
    starts = far.starts | {j: near.starts[m] for m, j in far.to.items() if m in near.starts}
    return Links(whole, ends, starts, min(near.gap, far.gap))


def joined(
    at: Found, values: list[float], step: Callable[[float], None]
) -> tuple[list[list[Equilibrium]], list[list[int]], list[Meet]]:
    """The equilibria at each of the values, the branch of each, and the folds; `step` is told each value in turn."""
    step(values[0])
    found = [at(values[0])]
    branch, total, meets = [list(range(len(found[0])))], len(found[0]), list[Meet]()
    for k in range(1, len(values)):
        step(values[k])
        found.append(at(values[k]))
        links = linked(at, values[k - 1], found[k - 1], values[k], found[k])
        numbers = [-1] * len(found[k])
        for i, j in links.to.items():
            numbers[j] = branch[-1][i]
        meets += _meets(k - 1, links.ends, links.gap) + _meets(k, links.starts, -links.gap)
        for j in range(len(numbers)):
            if numbers[j] < 0:
                numbers[j] = total
                total += 1
        branch.append(numbers)
    return found, branch, meets


def _meets(k: int, loose: dict[int, Last], gap: float) -> list[Meet]:
    """Of those that end (or begin) next to value k the two and two that meet in a fold: the nearest where they end, of
    neighbouring index."""
    near = []
    for i, (x, one) in loose.items():
        for j, (y, other) in loose.items():
            if i < j and abs(one.index - other.index) == 1 and abs(x - y) <= abs(gap) * (1 + 1e-9):
                near.append((float(np.abs(one.solution.beta - other.solution.beta).mean()), i, j))
    left, out = set(loose), list[Meet]()
    for distance, i, j in sorted(near):
        if distance < MEETING and {i, j} <= left:
            left -= {i, j}
            both = min if gap > 0 else max
            out.append(Meet(k, i, j, loose[i], loose[j], both(loose[i][0], loose[j][0]) + gap))
    return out
