"""The rule that selects one of the equilibria between two ends.

Under dead loads the equilibrium of lowest energy of a long compressed rod points backwards: beta passes pi, which
lets the load do more work. A user mostly means the stable equilibrium that stays near its end angles. So the default
is: among the stable equilibria the one whose beta goes least beyond its two end angles; among equal
ones the one of lower energy, then the one with positive beta'(0). If none is stable, all equilibria are compared.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Integers
from ..problem.errors import InputError

NEAREST, LOWEST = "nearest", "lowest"
RULES = (NEAREST, LOWEST)

Choose = str | int  # "nearest", "lowest", or a Morse index

INCOMPLETE = "selected from a list of equilibria that may be incomplete"  # the remark on a solved case

_EQUAL = 1e-9  # relative difference below which two strays or energies count as equal: mirror images differ by rounding
_FINEST = 1e-12  # rad: the same for strays next to zero


@dataclass(frozen=True)
class Selection:
    """How one equilibrium was taken from those found.

    count: equilibria found. stable: how many of them have Morse index 0. choose: the rule asked for. complete: whether
    no test says that one is missing (`equilibria.Equilibria`).
    """

    count: int
    stable: int
    choose: Choose
    complete: bool

    def __str__(self) -> str:
        words = f"{self.count} equilibri{'um' if self.count == 1 else 'a'}{'' if self.complete else ' found'}"
        known = f"{words}, {self.stable} stable" + ("" if self.complete else ", the list is incomplete")
        return f"{known}; {self.rule}"

    @property
    def rule(self) -> str:
        """Which equilibrium the rule takes, in words."""
        if self.choose == LOWEST:
            return "shown: the shape of lowest energy"
        if self.choose == NEAREST:
            return f"shown: the {'stable ' if self.stable else ''}shape that swings least"
        return f"shown: of those of index {self.choose} the shape that swings least"


def check(choose: Any) -> Choose:
    """The rule as given; raises `InputError` unless it is one of `RULES` or a Morse index."""
    if isinstance(choose, str) and choose in RULES:
        return choose
    if isinstance(choose, (int, np.integer)) and not isinstance(choose, bool) and choose >= 0:
        return int(choose)
    raise InputError(f"choose must be 'nearest', 'lowest' or a Morse index (0, 1, 2, ...), got {choose!r}")


def select(choose: Choose, index: Array, energy: Array, strays: Array, slope: Array) -> int | None:
    """Which of K equilibria the rule takes; None where no equilibrium has the index asked for, or K is 0.

    index: Morse indices. energy: in any unit. strays: how far beta goes beyond its two end angles.
    slope: beta'(0), in any unit. (K,) each.
    """
    if choose == LOWEST:
        among: Integers = np.arange(index.size)
    elif choose == NEAREST:
        among = np.flatnonzero(index == 0) if (index == 0).any() else np.arange(index.size)
    else:
        among = np.flatnonzero(index == choose)
    if not among.size:
        return None
    if choose != LOWEST:
        least = strays[among].min()
        among = among[strays[among] <= least + _EQUAL * least + _FINEST]
    lowest = energy[among].min()
    among = among[energy[among] <= lowest + _EQUAL * np.abs(energy[among]).max()]
    positive = among[slope[among] > 0]
    among = positive if positive.size else among
    return int(among[np.argmax(slope[among])])


def selection(choose: Choose, index: Array, total: int, complete: bool) -> Selection:
    """The record of a selection among `total` equilibria; index: (K,), Morse indices, at least of all stable ones."""
    return Selection(total, int(np.count_nonzero(index == 0)), choose, complete)


def none_of(choose: Choose, index: Array, total: int) -> str:
    """The outcome of a case where the rule admits no equilibrium; index: (K,), Morse indices of those solved."""
    known = sorted({int(i) for i in index})
    shown = ", ".join(map(str, known[:8])) + (f", ... up to {known[-1]}" if len(known) > 8 else "")
    return f"failed: none of the {total} equilibria found has index {choose}; their indices: {shown}"
