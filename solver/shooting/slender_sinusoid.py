"""The sinusoid of least energy of a slender rod that lies inside a cylinder, for each compression.

Of a slender rod, with F the compression in units of sqrt(A w sin(theta)/rho), x in (A rho/(w sin(theta)))^(1/4), and
the mean over a wave in brackets: the energy e = <alpha''^2 + alpha'^4 - F alpha'^2>/2 + <1 - cos(alpha)> is least over
the harmonics of alpha and over the wave number k.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import Array

OVER = (1e-3, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4, 2.8, 3.2)  # F - 2, of the rows of the table
HARMONICS = np.array([[1.0], [3.0], [5.0]])
PHASES = np.linspace(0, 2 * np.pi, 64, endpoint=False)
STEPS = 20  # of Newton's method, at most


class Row(NamedTuple):
    """Of the sinusoid at F: its wave number, what its energy and its push say, as smooth functions of F.

    size, third: a/(F - 2)^(1/2) and a3/a^3 of the first and third harmonics a, a3. stiffness: d2e/dk2/(F - 2). push:
    <P>. itself, axis: what friction takes from the phase, over F - 2 of a rod that slides along itself and over
    (F - 2)^2 of one that moves along the axis, as of `local_waves`.
    """

    k: float
    size: float
    third: float
    stiffness: float
    push: float
    itself: float
    axis: float


def row(over: float, sizes: Array, k: float) -> tuple[Row, Array]:
    """The sinusoid at F - 2, and the sizes (3,) of its harmonics, from those and a wave number near it."""
    F, n = 2 + over, HARMONICS
    sine, slope, bend = np.sin(n * PHASES), n * np.cos(n * PHASES), -n * n * np.sin(n * PHASES)
    hessian = np.empty((4, 4))
    alpha = a = b = np.zeros(PHASES.size)
    for _ in range(STEPS):
        alpha, a, b = sizes @ sine, sizes @ slope, sizes @ bend
        by_size = k**4 * b * bend + (2 * k**4 * a**3 - F * k**2 * a) * slope + np.sin(alpha) * sine
        by_k = 2 * k**3 * (b**2 + a**4) - F * k * a**2
        stiff = 6 * k**4 * a**2 - F * k**2
        hessian[:3, :3] = ((k**4 * bend[:, None] * bend) + stiff * slope[:, None] * slope).mean(axis=2)
        hessian[:3, :3] += (np.cos(alpha) * sine[:, None] * sine).mean(axis=2)
        hessian[3, :3] = hessian[:3, 3] = (4 * k**3 * b * bend + (8 * k**3 * a**3 - 2 * F * k * a) * slope).mean(axis=1)
        hessian[3, 3] = (6 * k**2 * (b**2 + a**4) - F * a**2).mean()
        step = np.linalg.solve(hessian, np.append(by_size.mean(axis=1), by_k.mean()))
        sizes, k = sizes - step[:3], k - step[3]
        if np.abs(step).max() < 1e-13:
            break
    stiffness = hessian[3, 3] - hessian[3, :3] @ np.linalg.solve(hessian[:3, :3], hessian[:3, 3])
    square, P = (k * a) ** 2, np.cos(alpha) + k**4 * (4 * a * (sizes @ (-(n**2) * slope)) + 3 * b**2 - a**4)
    P += F * square
    one, both = np.mean(P * square) / (2 * k), np.mean(P) * np.mean(square) / (2 * k)
    scaled = sizes[0] / np.sqrt(over), sizes[1] / sizes[0] ** 3, stiffness / over
    return Row(k, *scaled, P.mean(), (one + both) / over, (both - one) / over**2), sizes


def rows() -> list[Row]:
    """Those of the table."""
    k, sizes, found, last = 1.0, np.sqrt([8 / 11, 0.0, 0.0]), [], 1.0
    for over in OVER:
        one, sizes = row(over, sizes * np.sqrt(over / last), k)
        k, last = one.k, over
        found.append(one)
    return found


@cache
def curves() -> Array:
    """The polynomials in F - 2 through the table, (8, 7): powers, numbers of a row."""
    return np.asarray(np.polynomial.polynomial.polyfit(OVER, np.array(rows()), 7))
