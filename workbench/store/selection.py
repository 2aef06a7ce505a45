"""Which case of a dataset a user means: values of its axes, as numbers or as written, and the cases along an axis.

A number means the stored value that agrees with it to nine digits. A text such as ``10910`` or ``30deg`` means the one
stored value that it abbreviates: the one that, rounded to the digits written, is that text.
"""

import json
import math
from collections.abc import Mapping, Sequence
from decimal import Decimal, InvalidOperation
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError, choices, near, no_such
from studies import TABLE_1
from studies.grammar.axes import FIELDS, SAMPLE, in_rad, is_angle
from studies.laws.line_verdicts import NOISE

from . import schema
from .schema import COMPONENTS, axes_of, dimension, fields_of_samples

if TYPE_CHECKING:
    import xarray as xr

SAME = 1e-9  # share by which a number may differ from the stored value that it means
LISTED = 12  # values of an axis that a message lists
WRITTEN = 4  # digits of a value in a diagram
LOOSEST = 0.001  # share of a value by which a text of one or two digits may differ from it

Array = NDArray[np.float64]
Value = float | str


def case(ds: "xr.Dataset", at: Mapping[str, Value] | None = None) -> dict[str, int]:
    """The indices of the case at these values; an axis that is not named stays where the laws or Table 1 put it.

    Raises `InputError` for a name that is no axis or a value that is not stored.
    """
    chosen = {axis_of(ds, name): value for name, value in (at or {}).items()}
    return {name: index(ds, name, chosen[name]) if name in chosen else _base(ds, name) for name in axes_of(ds)}


def line(ds: "xr.Dataset", axis: str, at: Mapping[str, Value] | None = None) -> list[dict[str, int]]:
    """The indices of each case along an axis in its rising order, the other axes as in `case`."""
    axis = axis_of(ds, axis)
    place = case(ds, at)
    return [{**place, axis: int(i)} for i in np.argsort(ds[axis].values, kind="stable")]


def spread(places: list[dict[str, int]], count: int) -> list[dict[str, int]]:
    """At most so many of them, evenly chosen, both ends among them."""
    if len(places) <= count:
        return places
    return [places[i] for i in np.linspace(0, len(places) - 1, count).round().astype(int)]


def axis_of(ds: "xr.Dataset", name: str) -> str:
    """The axis of that name, or of that field of the study (`beta` is beta0). Raises `InputError` with the axes."""
    dims = axes_of(ds) if "outcome" in ds else list(map(str, ds.dims))
    axes = [dim for dim in dims if dim in ds.coords and dim not in ("u", *COMPONENTS)]
    for known in (name, dimension(name) if name in FIELDS else name):
        if known in axes:
            return known
    if SAMPLE in axes and name in (fields := fields_of_samples(ds)):
        raise InputError(f"{name} is no axis: the samples are of {choices(fields)}; give the number of one, sample=0")
    if name in ds.coords and not ds[name].ndim:
        raise InputError(f"{name} is selected already: it is {ds[name].item():.10g}")
    if not axes:
        raise InputError(f"no axis {name!r}: the dataset has none")
    raise no_such("axis", name, axes)


def index(ds: "xr.Dataset", name: str, value: Value) -> int:
    """The index of the value of an axis that is meant. Raises `InputError` with the stored values."""
    axis = np.asarray(ds[name].values, dtype=float)
    number = real(name, value)
    away = np.abs(axis - number)
    nearest = int(away.argmin())
    if away[nearest] <= _tolerance(axis, number):
        return nearest
    for half in (_half_digit(value), _half_digit(value, zeros=False)) if isinstance(value, str) else ():
        close = np.flatnonzero(away <= min(half, LOOSEST * abs(number)))
        if close.size == 1:
            return int(close[0])
        if close.size:
            break
    shown = value if isinstance(value, str) else write(name, number, 10)
    raise InputError(f"{name} = {shown} is not on the axis; {_list(axis, name, number)}")


def indices(ds: "xr.Dataset", name: str, value: Any) -> Any:
    """The index of a value, those of a list of values, or those of the values in a slice. Raises `InputError`."""
    if isinstance(value, slice):
        return _between(ds, name, value)
    if isinstance(value, list | tuple | np.ndarray):
        return [index(ds, name, each) for each in value]
    return index(ds, name, value)


def real(name: str, value: Any) -> float:
    """The value of a field as a finite number, an angle's also from text as `30deg`; or `InputError`."""
    try:
        number = in_rad(value) if is_angle(name) else value
    except ValueError as error:
        raise InputError(f"{name}: {error}") from None
    try:
        number = float(number)
    except (TypeError, ValueError, OverflowError):
        number = np.nan
    if not np.isfinite(number):
        raise InputError(f"{name} must be a finite number, got {value!r}")
    return number


def write(name: str, value: float, digits: int = 6) -> str:
    """A value of an axis as a user writes it: ``10905``, and ``30deg`` for an angle; a number of a sample in full."""
    if name == SAMPLE and value.is_integer():
        return str(int(value))
    return f"{math.degrees(value):.{digits}g}deg" if is_angle(name) else f"{value:.{digits}g}"


def _tolerance(axis: Array, value: float) -> float:
    """How far a stored value may be from the one given: for rounding in its size, and in the steps of the axis."""
    steps = np.diff(np.sort(axis))
    return SAME * max(abs(value), float(steps.min()) if steps.size else 0.0)


def _half_digit(text: str, zeros: bool = True) -> float:
    """Half a unit in the last digit of a number as it is written, in rad where degrees are; 0 for pi/6.

    zeros: whether those at its end count as digits; otherwise at least `WRITTEN` others are needed, as a diagram writes
    10910 for 10905.
    """
    number = text.strip().removesuffix("deg")
    try:
        decimal = Decimal(number.strip())
        exact = decimal.normalize().as_tuple()
        exponent = decimal.as_tuple().exponent if zeros or len(exact.digits) < WRITTEN else exact.exponent
    except InvalidOperation:
        return 0.0
    half = 0.5 * 10.0**exponent if isinstance(exponent, int) else 0.0
    return math.radians(half) if number != text.strip() else half


def _between(ds: "xr.Dataset", name: str, bounds: slice) -> NDArray[np.intp]:
    if bounds.step is not None:
        raise InputError(f"{name} takes a slice without a step, got {bounds}")
    axis = np.asarray(ds[name].values, dtype=float)
    low = -np.inf if bounds.start is None else real(name, bounds.start)
    high = np.inf if bounds.stop is None else real(name, bounds.stop)
    inside = (axis >= low - _tolerance(axis, low)) & (axis <= high + _tolerance(axis, high))
    if not inside.any():
        near = low if np.isfinite(low) else high
        ends = f"from {write(name, low, 10)} to {write(name, high, 10)}"
        raise InputError(f"{name} has no values {ends}; {_list(axis, name, near)}")
    return np.flatnonzero(inside)


def _list(axis: Array, name: str, near: float) -> str:
    if axis.size <= LISTED:
        return f"its values are {choices(write(name, v, 10) for v in axis)}"
    nearest = np.sort(axis[np.argsort(np.abs(axis - near))[:2]])
    ends = f"from {write(name, axis.min(), 10)} to {write(name, axis.max(), 10)}"
    return f"its {axis.size} values go {ends}, the nearest are {choices(write(name, v, 10) for v in nearest)}"


def _base(ds: "xr.Dataset", name: str) -> int:
    """The index nearest to where the laws or Table 1 put an axis; else its middle."""
    values = ds[name].values.astype(float)
    for row in json.loads(ds.attrs.get("laws", "[]")):
        if name in row.get("at", {}):
            return int(np.abs(values - row["at"][name]).argmin())
    at_start = {dimension(field): value for field, value in TABLE_1.items() if field in FIELDS}
    base = at_start.get(name) if ds.attrs.get("reading") else None
    return values.size // 2 if base is None else int(np.abs(values - base).argmin())


NOT_OBSERVED = ("rho", "condition", "dbeta0", "level")  # numbers of each case, not observables
FOUND = ("FZ", "MZ", "M3", "beta0", "betaL")  # observables where they are found of held ends
_ROUNDING = 1e-9  # of the largest: a load that is 0 by symmetry differs by less
HELD_INDEX = "held_index"  # stored of held ends alone


def observables(ds: "xr.Dataset") -> list[str]:
    """The observables that are stored for each case, in the order of the file; of a sweep, its branches too."""
    names = [str(name) for name in ds.data_vars if _is_number_of_each_case(ds, str(name))]
    return [name for name in names if not name.endswith("error") and name not in NOT_OBSERVED and _is_told(ds, name)]


def all_observables(ds: "xr.Dataset") -> list[str]:
    """The observables and expressions in their order, then what else of `observables` the file has of its cases: loads
    and end moments that the study names, and what is found of held ends."""
    first = [name for name in schema.observables_of(ds) if _is_number_of_each_case(ds, name)]
    return list(dict.fromkeys([*first, *observables(ds)]))


def _is_told(ds: "xr.Dataset", name: str) -> bool:
    """Whether a number tells something: not the only branch, nor a load or an end angle that was given."""
    if name == "branch":
        return bool(np.unique(of_solved(ds, name).values[ds["solved"].values]).size > 1)
    if name not in FOUND:
        return True
    if HELD_INDEX not in ds.data_vars:
        return False
    largest = max(float(abs(ds[other]).max()) for other in FOUND if other in ds.data_vars)
    return float(ds[name].max() - ds[name].min()) > _ROUNDING * largest


def of_solved(ds: "xr.Dataset", name: str) -> "xr.DataArray":
    """A number of each case, NaN where it is not solved: the number of a branch is stored as -1 there."""
    return ds[name].where(ds["solved"]) if name == "branch" else ds[name]


def is_count(ds: "xr.Dataset", name: str) -> bool:
    """Whether a stored variable is a whole number: a count, a comparison, or the number of a branch."""
    return name == HELD_INDEX or schema.is_count(ds[name]) or ds[name].dtype.kind in "iu"


def is_level(ds: "xr.Dataset", name: str) -> bool:
    """Whether a number is the same in all cases, but for rounding and its estimated errors: one value lies within the
    error of each."""
    low, high = level(ds, name)
    return low <= high


def level(ds: "xr.Dataset", name: str) -> tuple[float, float]:
    """The ends of what all cases may have in common of a number, within rounding and their estimated errors; the first
    is the larger where they have nothing in common."""
    values = np.asarray(ds[name].values, dtype=float)
    known = np.isfinite(values)
    if not known.any():
        return np.inf, -np.inf
    errors = ds[f"{name}_error"].values if f"{name}_error" in ds else np.zeros(values.shape)
    errors = np.maximum(np.nan_to_num(errors), NOISE / 2 * np.abs(values[known]).max())[known]
    return float((values[known] - errors).max()), float((values[known] + errors).min())


def known_cases(array: "xr.DataArray") -> str:
    """The cases that have a number, in words: ``all cases``, or ``the 10 of 16 cases that have a number``."""
    known = int(np.isfinite(np.asarray(array.values, dtype=float)).sum())
    return "all cases" if known == array.size else f"the {known} of {array.size} cases that have a number"


def names_of(ds: "xr.Dataset", names: Sequence[str]) -> list[str]:
    """The names, each once. Raises `InputError` for one that is no number of each case, with the observables."""
    for name in names:
        if not _is_number_of_each_case(ds, name):
            known = observables(ds)
            raise InputError(f"no observable {name!r}{near(name, known)}; the file has {choices(known) or 'none'}")
    return list(dict.fromkeys(names))


def _is_number_of_each_case(ds: "xr.Dataset", name: str) -> bool:
    """Also the estimated errors, the condition number and the loads are numbers of each case."""
    return name in ds.data_vars and ds[name].dtype.kind in "iuf" and set(ds[name].dims) == set(ds["outcome"].dims)
