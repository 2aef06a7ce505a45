"""The branches of a sweep: their numbers, and a sentence about them."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

NONE = -1  # the branch of a case without a solution


def number(branch: NDArray[np.int64], every: Iterable[int]) -> NDArray[np.int64]:
    """Branches renumbered from 0 in the order of the cases where they begin; every: all the old numbers."""
    order = sorted(set(every) - {NONE})
    ranks = np.array([NONE, *range(len(order))])
    return ranks[np.searchsorted(np.array([NONE, *order]), branch)]


def counts(branch: NDArray[Any]) -> dict[int, int]:
    """How many cases each branch has; NaN counts as `NONE`."""
    known = np.nan_to_num(np.asarray(branch, dtype=float), nan=NONE, posinf=NONE, neginf=NONE)
    found, counts = np.unique(known, return_counts=True)
    return {int(one): int(count) for one, count in zip(found, counts, strict=True)}


def sentence(counts: Mapping[int, int]) -> str:
    """One sentence about the branches of a grid; counts: branch -> how many cases."""
    sizes = [count for branch, count in sorted(counts.items()) if branch != NONE]
    if not sizes:
        return "no case has an equilibrium"
    if len(sizes) == 1:
        return "all cases lie on one branch of equilibria"
    listed = ", ".join(map(str, sizes[:8])) + (", ..." if len(sizes) > 8 else "")
    return (
        f"the grid shows {len(sizes)} branches of equilibria ({listed} cases): the outcome of a case says where a "
        "branch begins, and no law counts a step from one to another"
    )
