"""Values of a dataset's axes: where they stand, and a refusal that lists them."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.problem.errors import InputError, choices, no_such
from studies.axes import in_rad, is_angle

SAME = 1e-9  # a value is an axis's when it agrees with it this far: what a person copies from a table
LISTED = 12  # values of an axis that a refusal lists
INNER = ("u", "xyz", "director")  # dimensions that are no axes


def indices(ds: xr.Dataset, name: str, value: Any) -> Any:
    """Where a value, each value of a list, or what lies in a slice stands on an axis. Raises `InputError`."""
    axes = [str(dim) for dim in ds.dims if dim in ds.coords and dim not in INNER]
    if name not in axes:
        if name in ds.coords and not ds[name].ndim:
            raise InputError(f"{name} is selected already: it is {ds[name].item():.10g}")
        raise no_such("axis", name, axes) if axes else InputError(f"no axis {name!r}: the dataset has none")
    axis = np.asarray(ds[name].values, dtype=float)
    if isinstance(value, slice):
        return _between(axis, name, value)
    if isinstance(value, (list, tuple, np.ndarray)):
        return [_index(axis, name, one) for one in value]
    return _index(axis, name, value)


def real(name: str, value: Any) -> float:
    """The value of a field as a finite number, an angle's also from text as `30deg`; or `InputError`."""
    try:
        number = float(in_rad(value) if is_angle(name) else value)
    except (TypeError, ValueError, OverflowError):
        number = np.nan
    if not np.isfinite(number):
        raise InputError(f"{name} must be a finite number, got {value!r}")
    return number


def _index(axis: NDArray[np.float64], name: str, value: Any) -> int:
    wanted = real(name, value)
    i = int(np.abs(axis - wanted).argmin())
    if abs(axis[i] - wanted) > _slack(wanted):
        told = f"{name} = {wanted:.10g} is not on the axis; {_listed(axis, wanted)}"
        raise InputError(f"{told}; ds.rod.at({name}={wanted:.10g}) solves there")
    return i


def _between(axis: NDArray[np.float64], name: str, wanted: slice) -> NDArray[np.intp]:
    if wanted.step is not None:
        raise InputError(f"{name} takes a slice without a step, got {wanted}")
    low = -np.inf if wanted.start is None else real(name, wanted.start)
    high = np.inf if wanted.stop is None else real(name, wanted.stop)
    inside = (axis >= low - _slack(low)) & (axis <= high + _slack(high))
    if not inside.any():
        raise InputError(f"{name} has no values from {low:.10g} to {high:.10g}; {_listed(axis, low)}")
    return np.flatnonzero(inside)


def _slack(value: float) -> float:
    return SAME * abs(value) if np.isfinite(value) else 0.0


def _listed(axis: NDArray[np.float64], near: float) -> str:
    if axis.size <= LISTED:
        return f"its values are {choices(f'{v:.10g}' for v in axis)}"
    nearest = np.sort(axis[np.argsort(np.abs(axis - near))[:2]])
    ends = f"from {axis.min():.10g} to {axis.max():.10g}"
    return f"its {axis.size} values go {ends}, the nearest are {choices(f'{v:.10g}' for v in nearest)}"
