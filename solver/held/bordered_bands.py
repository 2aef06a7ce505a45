"""Symmetric banded matrices with a few borders: Newton's step, and how many directions curve down.

A band (d, k) holds the diagonals of a symmetric matrix, the main one first: band[i, j] is its entry (j + i, j). Borders
are further rows (b, k), with a diagonal corner (b,). All is of the order k, and no product is so large that BLAS starts
threads, which a machine with other work to do waits for.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts are imported when used

from ..numerics.arrays import Array

_LARGEST = 1e300  # below minus this no eigenvalue is looked for: none is, and its inverse is a float. x10: as good


@dataclass(frozen=True, eq=False)
class Bordered:
    """A symmetric matrix in bands with borders."""

    band: Array
    borders: Array
    corner: Array

    def plus(self, band: Array) -> "Bordered":
        """With another band added to its own."""
        return Bordered(self.band + band, self.borders, self.corner)

    @cached_property
    def _factor(self) -> tuple[Callable[[Array], Array], int] | None:
        """What solves the band alone, and its number of negative eigenvalues; None of a singular one."""
        lapack = scipy.linalg.lapack
        lower, failed = lapack.dpbtrf(self.band, lower=1)
        if not failed:
            return lambda right: lapack.dpbtrs(lower, right, lower=1)[0], 0
        size, k = self.band.shape[0] - 1, self.band.shape[1]
        every = np.zeros((3 * size + 1, k))  # the first rows are for what exchanges of rows add
        every[2 * size :] = self.band
        for i in range(1, size + 1):
            every[2 * size - i, i:] = self.band[i, : k - i]
        factors, order, failed = lapack.dgbtrf(every, size, size)
        if failed:
            return None
        return lambda right: lapack.dgbtrs(factors, size, size, right, order)[0], _count_negative(self.band)

    @cached_property
    def _schur(self) -> tuple[Array, Array] | None:
        """The band's answers to the borders (k, b), and what is left of the corner (b, b); None of a singular one."""
        if self._factor is None:
            return None
        answers = self._factor[0](self.borders.T) if self.corner.size else self.borders.T
        return answers, np.diag(self.corner) - self.borders @ answers

    @cached_property
    def negative(self) -> int | None:
        """The number of negative directions among those that the borders leave; None of a singular matrix."""
        if self._factor is None or self._schur is None:
            return None
        schur = self._schur[1]
        scale = 1 / np.sqrt(np.maximum(np.abs(schur).max(axis=1, initial=0), 1 / _LARGEST))
        below = np.count_nonzero(np.linalg.eigvalsh(schur * scale * scale[:, None]) < 0)
        return self._factor[1] + int(below) - self.corner.size

    def solve(self, right: Array) -> Array:
        """The solution (k,) for a right side (k,) that is zero at the borders, of a matrix that is not singular."""
        assert self._factor is not None
        assert self._schur is not None
        answers, schur = self._schur
        alone = self._factor[0](right)
        return np.asarray(alone + answers @ np.linalg.solve(schur, self.borders @ alone))


def _count_negative(band: Array) -> int:
    """The number of negative eigenvalues."""
    least = scipy.linalg.eig_banded(
        band, lower=True, eigvals_only=True, select="v", select_range=(-_LARGEST, 0.0), check_finite=False
    )
    return int(least.size)


def times(band: Array, x: Array) -> Array:
    """The product of a band and a vector (k,)."""
    out = band[0] * x
    for i in range(1, band.shape[0]):
        out[i:] += band[i, :-i] * x[:-i]
        out[:-i] += band[i, :-i] * x[i:]
    return np.asarray(out)
