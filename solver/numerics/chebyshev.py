"""Chebyshev series on [-1, 1], many at once: the last axis holds nodes or coefficients."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev as C

from .arrays import Array

GAUSS = np.polynomial.legendre.leggauss(12)  # places and weights: exact where a panel resolves what is integrated
_ROWS = 384  # OpenBLAS starts threads from 2^18 products on, whose sums differ. x10: bits depend on their number


@dataclass(frozen=True, eq=False)
class Basis:
    """n points of the second kind and the linear maps on them, each applied as ``values @ map``.

    nodes: (n,), rising. analyse: values to coefficients, (n, n). integrate: coefficients to those of the integral
    from -1, (n, n + 1). values: coefficients of a series one longer to values at the nodes, (n + 1, n).
    differentiate: coefficients to values of the derivative at the nodes, (n, n).
    """

    nodes: Array
    analyse: Array
    integrate: Array
    values: Array
    differentiate: Array


@cache
def basis(n: int) -> Basis:
    """The basis of n points."""
    nodes = -np.cos(np.pi * np.arange(n) / (n - 1))
    analyse = np.linalg.inv(C.chebvander(nodes, n - 1)).T
    integrate = np.stack([C.chebint(row, lbnd=-1) for row in np.eye(n)])
    slopes = np.stack([C.chebval(nodes, C.chebder(row)) for row in np.eye(n)])
    return Basis(nodes, analyse, integrate, C.chebvander(nodes, n).T, slopes)


def through(values: Array, linear: Array) -> Array:
    """``values @ linear`` for many short rows (Q, n), in blocks so small that BLAS starts no threads."""
    out = np.empty((values.shape[0], linear.shape[1]))
    for k in range(0, values.shape[0], _ROWS):
        np.matmul(values[k : k + _ROWS], linear, out=out[k : k + _ROWS])
    return out
