"""The option --at: which stored value of an axis a text such as ``E=10905`` or ``beta=30deg`` means."""

import math
from decimal import Decimal, InvalidOperation

import numpy as np
import xarray as xr

from solver.problem.errors import InputError, no_such
from studies.angles import angle

from ..data import dataset

WRITTEN = 4  # digits of a value in a diagram
LOOSEST = 0.001  # of the value: what is written with one or two digits is not taken for less exact than that


def values(ds: xr.Dataset, at: list[str]) -> dict[str, float]:
    """The stored value that each `E=10905` or `beta=30deg` means; `InputError` where there is none."""
    axes = dataset.axes_of(ds)
    found: dict[str, float] = {}
    for text in at:
        name, equals, said = text.partition("=")
        if not equals:
            raise InputError(f"--at takes NAME=VALUE, got {text!r}")
        if name not in axes:
            raise no_such("axis", name, axes) if axes else InputError(f"--at {text}: the dataset has no axes")
        if name in found:
            raise InputError(f"--at {text}: {name} is given twice")
        found[name] = _meant(ds[name], text, said)
    return found


def _meant(axis: xr.DataArray, text: str, said: str) -> float:
    """The one value of an axis that, rounded to as many digits as were given, is what was given.

    The noughts at the end of a whole number are digits, but a diagram writes 10910 for 10905, to four of them.
    """
    is_angle = axis.attrs.get("units") == "rad"
    try:
        value = angle(said) if is_angle else float(said)
    except ValueError as error:
        raise InputError(f"--at {text}: {error if is_angle else f'{said!r} is not a number'}") from None
    away = np.abs(axis.values - value)
    equal = 1e-9 * np.abs(axis.values).max()
    near = np.zeros(0, dtype=int)
    for half in (_half_digit(said), _half_digit(said, noughts=False)):
        near = np.flatnonzero(away <= max(equal, min(half, LOOSEST * abs(value))))
        if near.size > 1:  # one of them may be it to the last digit
            near = near[away[near] <= equal]
        if near.size:
            break
    if near.size != 1:
        listed = ", ".join(written(axis, float(v)) for v in axis.values)
        raise InputError(f"--at {text}: the axis {axis.name} has no such value; its values are {listed}")
    return float(axis.values[near[0]])


def _half_digit(said: str, noughts: bool = True) -> float:
    """Half a unit in the last digit of a number as it is written, in rad where degrees are; 0 for pi/6.

    noughts: whether those at its end count as digits; where not, at least `WRITTEN` others have to be there.
    """
    number, deg = (said.strip().removesuffix("deg"), True) if said.strip().endswith("deg") else (said.strip(), False)
    try:
        written = Decimal(number.strip())
        exact = written.normalize().as_tuple()
        exponent = written.as_tuple().exponent if noughts or len(exact.digits) < WRITTEN else exact.exponent
    except InvalidOperation:
        return 0.0
    half = 0.5 * 10.0**exponent if isinstance(exponent, int) else 0.0
    return math.radians(half) if deg else half


def written(axis: xr.DataArray, value: float) -> str:
    """A value of an axis as --at takes it."""
    return f"{math.degrees(value):.6g}deg" if axis.attrs.get("units") == "rad" else f"{value:.6g}"
