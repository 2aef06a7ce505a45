"""Join the equilibria at neighbouring values of an axis into branches.

Between two values all equilibria are computed again at the middle, recursively, until each equilibrium has one near
neighbour at the next value and no second one that is almost as near. An equilibrium without a neighbour after the
last halving is the end of a branch, next to a fold. So a coarse axis gives the branches of a fine one.
(Newton's method from one value to the next would not do: where a rod stays near a saddle and bends once, the position
of that bend depends on digits that no mesh resolves.)
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from solver.equilibria import Equilibrium

SAME_BRANCH = 0.35  # rad, largest mean distance of beta between two equilibria of one branch
CLEAR = 3.0  # the second nearest equilibrium must be this many times as far as the nearest
HALVINGS = 7
SAME_FOLD = 0.8  # rad, largest mean distance of beta between two branches that end in one fold

Search = Callable[[float], list[Equilibrium]]  # an axis value -> all equilibria there
End = tuple[float, Equilibrium]  # the last axis value of a branch, and its equilibrium there


@dataclass(frozen=True)
class Meeting:
    """Two branches that end (or begin) in one fold.

    Attributes
    ----------
    k, i, j
        Members i and j at value number k, the last (or first) value of the axis at which both exist.
    first, second
        The end of each branch.
    beyond
        An axis value at which neither exists.
    """

    k: int
    i: int
    j: int
    first: End
    second: End
    beyond: float


@dataclass
class Links:
    """The branches between two axis values.

    Attributes
    ----------
    to
        Member at the first value -> member at the second value, of one branch.
    ends, starts
        Members of the first (second) value whose branch ends (begins) between the two.
    gap
        Distance from the end of a branch to the next axis value that was examined.
    """

    to: dict[int, int]
    ends: dict[int, End]
    starts: dict[int, End]
    gap: float


def track(
    at: Search, values: list[float], step: Callable[[float], None]
) -> tuple[list[list[Equilibrium]], list[list[int]], list[Meeting]]:
    """The equilibria at each value, the number of the branch of each, and the folds.

    Parameters
    ----------
    at
        Computes all equilibria at an axis value.
    values
        The values of the axis, in order; at least one.
    step
        Called with each value before it is solved.
    """
    step(values[0])
    found = [at(values[0])]
    branch, total, meetings = [list(range(len(found[0])))], len(found[0]), list[Meeting]()
    for k in range(1, len(values)):
        step(values[k])
        found.append(at(values[k]))
        links = linked(at, values[k - 1], found[k - 1], values[k], found[k])
        numbers = [-1] * len(found[k])
        for i, j in links.to.items():
            numbers[j] = branch[-1][i]
        meetings += _meetings(k - 1, links.ends, links.gap) + _meetings(k, links.starts, -links.gap)
        for j in range(len(numbers)):
            if numbers[j] < 0:
                numbers[j] = total
                total += 1
        branch.append(numbers)
    return found, branch, meetings


def linked(
    at: Search, x: float, a: list[Equilibrium], y: float, b: list[Equilibrium], halvings: int = HALVINGS
) -> Links:
    """The branches between the equilibria a at x and the equilibria b at y; at: as for `track`."""
    to = _matched(a, b)
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


def distances(a: list[Equilibrium], b: list[Equilibrium]) -> Any:
    """Mean distance of beta along the rod [rad], (len(a), len(b)); infinite between different Morse indices."""
    if not a or not b:
        return np.empty((len(a), len(b)))
    first, second = (np.array([one.solution.beta for one in some]) for some in (a, b))
    same = np.array([one.index for one in a])[:, None] == np.array([one.index for one in b])
    return np.where(same, np.abs(first[:, None] - second[None]).mean(axis=2), np.inf)


def _matched(a: list[Equilibrium], b: list[Equilibrium]) -> dict[int, int]:
    """Members of a and b that belong to one branch beyond doubt."""
    far = distances(a, b)
    if not far.size:
        return {}
    out = {}
    for i, j in zip(*linear_sum_assignment(np.minimum(far, 1e3)), strict=True):
        others = min(np.delete(far[i], j).min(initial=np.inf), np.delete(far[:, j], i).min(initial=np.inf))
        if far[i, j] < SAME_BRANCH and CLEAR * far[i, j] < others:
            out[int(i)] = int(j)
    return out


def _meetings(k: int, loose: dict[int, End], gap: float) -> list[Meeting]:
    """The pairs of branches that end (gap > 0) or begin next to value k in one fold.

    Candidates have neighbouring Morse indices; the nearest are paired first.
    """
    near = []
    for i, (x, one) in loose.items():
        for j, (y, other) in loose.items():
            if i < j and abs(one.index - other.index) == 1 and abs(x - y) <= abs(gap) * (1 + 1e-9):
                near.append((float(np.abs(one.solution.beta - other.solution.beta).mean()), i, j))
    left, out = set(loose), list[Meeting]()
    for distance, i, j in sorted(near):
        if distance < SAME_FOLD and {i, j} <= left:
            left -= {i, j}
            both = min if gap > 0 else max
            out.append(Meeting(k, i, j, loose[i], loose[j], both(loose[i][0], loose[j][0]) + gap))
    return out
