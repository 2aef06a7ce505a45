"""Numbers that carry their derivatives: what a formula of an observable is computed with to differentiate it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Dual:
    """Values (B,) and their derivatives (B, F). Adds, multiplies, divides and raises to a constant power."""

    value: Array
    slope: Array
    __array_ufunc__ = None  # so that an array leaves the operation to this class

    def __add__(self, other: Any) -> "Dual":
        value, slope = _parts(other)
        return Dual(self.value + value, self.slope + slope)

    def __neg__(self) -> "Dual":
        return Dual(-self.value, -self.slope)

    def __sub__(self, other: Any) -> "Dual":
        return self + -other

    def __rsub__(self, other: Any) -> "Dual":
        return -self + other

    def __mul__(self, other: Any) -> "Dual":
        value, slope = _parts(other)
        return Dual(self.value * value, self.slope * _column(value) + _column(self.value) * slope)

    def __truediv__(self, other: Any) -> "Dual":
        return self * (other**-1 if isinstance(other, Dual) else 1 / np.asarray(other))

    def __rtruediv__(self, other: Any) -> "Dual":
        return self**-1 * other

    def __pow__(self, power: float) -> "Dual":
        rate = power * self.value ** float(power - 1)
        return Dual(self.value ** float(power), _column(rate) * self.slope)

    __radd__, __rmul__ = __add__, __mul__


def _parts(other: Any) -> tuple[Any, Any]:
    return (other.value, other.slope) if isinstance(other, Dual) else (np.asarray(other), 0.0)


def _column(value: Any) -> Any:
    return value[..., None] if np.ndim(value) else value
