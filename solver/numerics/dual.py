"""Numbers that carry their derivatives: what a formula of an observable is computed with to differentiate it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .arrays import Array, Booleans


@dataclass(frozen=True, eq=False)
class Dual:
    """Values (B,) and their derivatives (B, F).

    Adds, multiplies, divides, raises to a constant power, has a size, and is compared by its value.
    """

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
        return Dual(self.value * value, self.slope * value[..., None] + self.value[..., None] * slope)

    def __truediv__(self, other: Any) -> "Dual":
        return self * (other**-1 if isinstance(other, Dual) else 1 / np.asarray(other))

    def __rtruediv__(self, other: Any) -> "Dual":
        return self**-1 * other

    def __abs__(self) -> "Dual":
        return self * np.sign(self.value)

    def __lt__(self, other: Any) -> Any:
        return self.value < _parts(other)[0]

    def __gt__(self, other: Any) -> Any:
        return self.value > _parts(other)[0]

    def __pow__(self, power: float) -> "Dual":
        rate = power * self.value ** float(power - 1)
        return Dual(self.value ** float(power), rate[..., None] * self.slope)

    __radd__, __rmul__ = __add__, __mul__


def where(condition: Booleans, one: Any, other: Any) -> Any:
    """`one` where the condition (B,) holds, else `other`: numbers, arrays (B,) or `Dual`s.

    A constant has the derivative 0, NaN has none.
    """
    if not isinstance(one, Dual) and not isinstance(other, Dual):
        return np.where(condition, one, other)
    (value, slope), (value2, slope2) = _parts(one), _parts(other)
    slope, slope2 = (s + 0 * v[..., None] for v, s in ((value, slope), (value2, slope2)))
    return Dual(np.where(condition, value, value2), np.where(condition[:, None], slope, slope2))


def _parts(other: Any) -> tuple[Any, Any]:
    return (other.value, other.slope) if isinstance(other, Dual) else (np.asarray(other), 0.0)
