"""The lines on which a watched law is judged while a study is refined."""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .lattice import Places, Values


@dataclass(eq=False)
class Lines:
    """The complete lines of the coarse grid along one axis, for a law that is judged on each.

    along: the axis of the lines. column: of the number that is judged. judge: from its values on lines, (lines, cases),
    to the verdict on each. at: the places of the lines on the other axis, rising. verdicts: of the lines known so far.
    """

    along: int
    column: int
    judge: Callable[[Values], NDArray[np.str_]]
    at: Places = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    verdicts: dict[int, str] = field(default_factory=dict)

    def gaps(self) -> tuple[Places, Places]:
        """The places of neighbouring lines that have another verdict: of the lower, and of the upper."""
        changes = [self.verdicts[a] != self.verdicts[b] for a, b in pairwise(self.at.tolist())]
        where = np.flatnonzero(changes)
        return self.at[where], self.at[where + 1]
