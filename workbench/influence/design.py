"""Saltelli's design, found in the values of samples: which of them form blocks.

A block is A, A with one coordinate of B each, and B; where it was drawn for pairs also B with one coordinate of A each.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studies.language.samples import block_of

Values = NDArray[np.float64]

_SAME = 1e-12  # relative: equal values, as a table may have printed them


@dataclass(frozen=True)
class Design:
    """The design of samples of some fields. blocks: their number. second: whether pairs of fields are told apart."""

    fields: int
    blocks: int
    second: bool

    @property
    def block(self) -> int:
        """The number of samples of a block."""
        return block_of(self.fields, self.second)


def design_of(samples: Values) -> Design | None:
    """The design of samples (n, fields), which are in the order of `[sample]`; None where they form no blocks."""
    n, d = samples.shape
    for second in (False, True):
        size = block_of(d, second)
        if n % size == 0 and _is_design(samples.reshape(n // size, size, d), second):
            return Design(d, n // size, second)
    return None


def _is_design(blocks: Values, second: bool) -> bool:
    """Whether every block (blocks, size, d) is one."""
    d = blocks.shape[2]
    a, b = blocks[:, :1], blocks[:, -1:]
    mixed = np.eye(d, dtype=bool)
    parts = [np.where(mixed, b, a), *([np.where(mixed, a, b)] if second else [])]
    return bool(np.allclose(blocks[:, 1:-1], np.concatenate(parts, axis=1), rtol=_SAME, atol=0))
