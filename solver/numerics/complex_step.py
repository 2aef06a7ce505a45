"""Derivatives by a complex step: a formula of numbers that have small imaginary parts has the derivative as its own.

Nothing is subtracted, so the derivative is exact to rounding, and a formula of real numbers is differentiated as it
stands, by all fields at once. It adds, multiplies, divides, takes constant powers, sines and cosines, distinguishes
cases by `np.where` on real numbers, and takes sizes by `size_of`.
"""

from typing import Any

import numpy as np

from .arrays import Array

STEP = 2.0**-200  # its square is far below rounding, whatever the derivative


def with_slopes(value: Array, slopes: Array) -> Array:
    """Numbers (B,) that carry their derivatives (B, F), (F, B)."""
    number = np.empty(slopes.shape[::-1], dtype=complex)
    number.real, number.imag = value, slopes.T
    number.imag *= STEP
    return number


def slopes_of(number: Any) -> Array:
    """The derivatives (..., B, F) that numbers (..., F, B) carry."""
    return np.asarray(number.imag.swapaxes(-1, -2) / STEP)


def size_of(number: Any) -> Any:
    """The size of real numbers, and of those that carry derivatives."""
    return number * np.sign(np.real(number))
