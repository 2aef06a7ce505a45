"""The parameters of a fit: fields of a case, their bounds, and the numbers x by which a search moves them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..problem.case import Case
from ..problem.case_fields import check_fields, value_of
from ..problem.declared_fields import POSITIVE, RANGES
from ..problem.dimensionless import natural_unit
from ..problem.errors import InputError, choices, names_of
from ..problem.field_values import read_range

# starts of a positive field without bounds: from its value over this to its value times this. x10: starts that have no
# shape
_SPREAD = 4.0


@dataclass(frozen=True)
class Parameter:
    """A field that a fit varies; a positive one by its logarithm.

    low, high: bounds, infinite where there are none. first: the value of the case. scale: of x = value/scale, or 0
    where x = log(value). reach: how far in x starts are drawn where there is no bound.
    """

    name: str
    low: float
    high: float
    first: float
    scale: float
    reach: float

    def x(self, value: float) -> float:
        """The number x of a value."""
        if self.scale:
            return value / self.scale
        return float(np.log(value)) if value > 0 else -np.inf

    def value(self, x: float) -> float:
        """The value of x."""
        return float(x * self.scale if self.scale else np.exp(x))

    def rate(self, value: float) -> float:
        """d value/dx."""
        return self.scale or value

    @property
    def bounds(self) -> tuple[float, float]:
        """The bounds of x."""
        return self.x(self.low), self.x(self.high)

    @property
    def between(self) -> str:
        """`` from 1 to 9``, or nothing where there are no bounds."""
        return f" from {self.low:g} to {self.high:g}" if np.isfinite([self.low, self.high]).all() else ""

    @property
    def span(self) -> tuple[float, float]:
        """The x between which starts are drawn."""
        low, high = self.bounds
        middle = self.x(self.first)
        return (
            low if np.isfinite(low) else min(middle, high) - self.reach,
            high if np.isfinite(high) else max(middle, low) + self.reach,
        )

    @property
    def start(self) -> float:
        """The x of the case's own value, or the middle of the bounds where these exclude it."""
        low, high = self.bounds
        value = self.x(self.first)
        return value if low <= value <= high else sum(self.span) / 2


def check_parameters(case: Case, vary: Any) -> list[Parameter]:
    """The parameters. Raises `InputError` for an unknown or repeated field and for invalid bounds."""
    if case.shape:
        raise InputError(f"fit takes a single case, got a grid of shape {case.shape}")
    pairs = list(vary.items()) if isinstance(vary, Mapping) else [(name, None) for name in names_of(vary)]
    names = check_fields(case, [name for name, _ in pairs])
    return [_parameter(case, name, bounds) for name, (_, bounds) in zip(names, pairs, strict=True)]


def _parameter(case: Case, name: str, bounds: Any) -> Parameter:
    first = value_of(case, name)
    low, high = limits = _limits(case, name)
    if bounds is not None:
        given = read_range(name, bounds, "bounds")
        if name in POSITIVE and given[0] <= 0:
            raise InputError(f"the bounds of {name} must be positive, got {given[0]:g} to {given[1]:g}")
        if np.isfinite(limits).all() and not (low <= given[0] and given[1] <= high):
            raise InputError(f"the bounds of {name} must lie in {low:g} to {high:g}, got {given[0]:g} to {given[1]:g}")
        low, high = given
    natural = float(natural_unit(case, name)[0])
    if name in POSITIVE:
        return Parameter(name, low, high, first, 0.0, float(np.log(_SPREAD)))
    scale = max(abs(first), 1e-3 * natural) if first else natural
    return Parameter(name, low, high, first, scale, max(abs(first), natural) / scale)


def _limits(case: Case, name: str) -> tuple[float, float]:
    """The least and the greatest value of a field; infinite where there is none."""
    if name == "inner_radius":
        if float(case.rod.inner_radius) == 0:
            why = "where every derivative by it is 0; give the case another value"
            raise InputError(f"a fit cannot begin at inner_radius = 0, {why}")
        return 0.0, float(case.rod.a)
    return (float(RANGES[name].low), RANGES[name].high) if name in RANGES else (-np.inf, np.inf)


def values_at(parameters: Sequence[Parameter], x: Array) -> dict[str, float]:
    """Field -> its value."""
    return {parameter.name: parameter.value(float(v)) for parameter, v in zip(parameters, x, strict=True)}


def rates_at(parameters: Sequence[Parameter], x: Array) -> Array:
    """The derivative of each value by its x, (F,)."""
    return np.array([parameter.rate(parameter.value(float(v))) for parameter, v in zip(parameters, x, strict=True)])


def values_in_words(parameters: Sequence[Parameter], x: Array) -> str:
    """``E = 1.07e+04, F1 = 5``."""
    return choices(f"{name} = {value:.6g}" for name, value in values_at(parameters, x).items())
