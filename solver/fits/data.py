"""The data of a fit: targets of observables and measured points, each with its standard deviation if that is known."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..observe.observable_rates import check_observables
from ..observe.observables import OBSERVABLES, is_count
from ..problem.case import SLIDING, Case
from ..problem.dimensionless import natural_unit
from ..problem.errors import InputError, check_known, choices, known_name, no_such, show
from ..problem.field_values import floats_in
from ..problem.quantities import current, quantity

COLUMNS = ("alpha", "z", "beta")  # what is measured at a point
DISTANCE = "distance"  # of points without arc length
MOTION = "@"  # between an observable and how the rod slides, in the name of a target


@dataclass(frozen=True, eq=False)
class MeasuredPoints:
    """P measured points, (P,) each, in the order of s where that is known.

    columns: of `COLUMNS`, the measured values. sizes: the error of each column that counts as 1. s: arc lengths, or
    None. order: the number of each point as it was given. wrapped: whether alpha is known up to whole turns.
    """

    columns: dict[str, Array]
    sizes: dict[str, Array]
    s: Array | None
    order: Any
    wrapped: bool

    @property
    def size(self) -> int:
        return int(self.order.size)

    @property
    def groups(self) -> tuple[str, ...]:
        """The names of the data of a point: the columns, or the distance."""
        return (DISTANCE,) if self.s is None else tuple(self.columns)


@dataclass(frozen=True, eq=False)
class Data:
    """All N data of a fit: first the targets, then each column of the points, or their distances.

    targets: observable -> value, of the rod that slides in another way as ``FZ0@axial-backward``. points: or None.
    known: whether the errors are standard deviations. measured: the data, (N,), 0 for a distance. scales: the error of
    each that counts as 1, (N,); a distance is in units of those of its point.
    """

    targets: dict[str, float]
    points: MeasuredPoints | None
    known: bool
    measured: Array
    scales: Array

    @property
    def size(self) -> int:
        """Number of data."""
        return self.measured.size

    @property
    def groups(self) -> list[str]:
        """The group of each datum: its observable, or its column of the points."""
        points = self.points
        return [*self.targets, *([name for name in points.groups for _ in range(points.size)] if points else [])]

    @cached_property
    def as_given(self) -> Any:
        """The indices that put points back into the order in which they were given, (N,)."""
        count, points = len(self.targets), self.points
        parts = [np.arange(count)]
        if points is not None:
            parts += [count + k * points.size + np.argsort(points.order) for k in range(len(points.groups))]
        return np.concatenate(parts)


def check_data(case: Case, targets: Any, points: Any, sigma: Any, wrapped: bool) -> Data:
    """The data. Raises `InputError` where they are invalid."""
    goals = {name: _number(f"the target {name}", value) for name, value in _numbers_by_name("targets", targets).items()}
    _check_targets(case, goals)
    columns, s = _columns(points) if points is not None else ({}, None)
    if not goals and not columns:
        raise InputError("fit needs data: give targets, such as height = 10, or measured points")
    sigmas = _sigmas(_numbers_by_name("sigma", sigma), goals, columns, s)
    sizes = [float(sigmas[name]) if sigmas else scale_of(case, name, value) for name, value in goals.items()]
    targets = np.array(list(goals.values()))
    if not columns:
        return Data(goals, None, bool(sigmas), targets, np.array(sizes))
    if s is not None and s.max() > float(case.rod.L):
        raise InputError(f"a point has s = {s.max():g}, beyond the end of the rod at L = {float(case.rod.L):g}")
    count = next(iter(columns.values())).size
    order = np.arange(count) if s is None else np.argsort(s, kind="stable")
    units = {"alpha": 1.0, "beta": 1.0, "z": float(case.rho)}
    each = {name: np.broadcast_to(sigmas[name] if sigmas else units[name], count)[order] for name in columns}
    points = MeasuredPoints(
        {name: v[order] for name, v in columns.items()}, each, None if s is None else s[order], order, wrapped
    )
    numbers = {DISTANCE: (np.zeros(count), np.ones(count))}
    if s is not None:
        numbers = {name: (points.columns[name], each[name]) for name in columns}
    measured, scales = zip(*numbers.values(), strict=True)
    return Data(goals, points, bool(sigmas), np.concatenate([targets, *measured]), np.concatenate([sizes, *scales]))


def _numbers_by_name(name: str, value: Any) -> Mapping[str, Any]:
    """A mapping of names to numbers; an empty one for None. Raises `InputError` for anything else."""
    if value is not None and not isinstance(value, Mapping):
        raise InputError(f"{name} must be a mapping of names to numbers, got {show(value)}")
    return {current(key): number for key, number in (value or {}).items()}


def target_parts(name: str) -> tuple[str, str]:
    """The observable of a target, and how the rod slides there; "" for as in the case."""
    observable, _, sliding = str(name).partition(MOTION)
    return observable, sliding


def _check_targets(case: Case, targets: Mapping[str, float]) -> None:
    for target in targets:
        sliding = target_parts(target)[1]
        if MOTION in str(target) and not known_name(sliding, SLIDING):
            raise no_such("sliding", sliding, SLIDING)
        if sliding and case.cylinder.friction is None:
            raise InputError(f"the target {target} needs a rod with friction, and the case has none")
    names = list(dict.fromkeys(target_parts(target)[0] for target in targets))
    for name in names:
        if not known_name(name, OBSERVABLES):
            raise no_such("observable", name, OBSERVABLES)
        if is_count(name):
            raise InputError(
                f"the target {name} is a whole number, which does not change with a small change of a field, so no "
                "derivative leads to it; a law of kind boundary or a map finds where it changes"
            )
    if names:
        check_observables(names)


def _columns(points: Any) -> tuple[dict[str, Array], Array | None]:
    if not isinstance(points, Mapping) and not hasattr(points, "keys"):
        raise InputError(f"points must be a mapping of columns to values, got {type(points).__name__}")
    known = ("s", *COLUMNS)
    for name in points.keys():  # noqa: SIM118  (a table of pandas iterates over its columns only by keys)
        check_known("column of points", name, known)
    table = {name: _array(name, points[name]) for name in known if name in points.keys()}  # noqa: SIM118
    sizes = {name: values.size for name, values in table.items()}
    if len(set(sizes.values())) > 1:
        raise InputError(f"the columns of the points must have one length, got {sizes}")
    s = table.pop("s", None)
    if s is not None and (s < 0).any():
        raise InputError(f"arc lengths of points must not be negative, got s = {s.min():g}")
    if not table or (s is None and set(table) != {"alpha", "z"}):
        given = choices([*(["s"] if s is not None else []), *table]) or "none"
        raise InputError(f"points need alpha and z, or s and one of {choices(COLUMNS)}, got {given}")
    return table, s


def _array(name: str, values: Any) -> Array:
    numbers = floats_in(values)
    if numbers.ndim != 1 or not numbers.size or not np.isfinite(numbers).all():
        raise InputError(f"the column {name} of the points must be a list of finite numbers, got {values!r:.60}")
    return numbers


def _number(what: str, value: Any) -> float:
    number = floats_in(value)
    if number.ndim or not np.isfinite(number):
        raise InputError(f"{what} must be a finite number, got {show(value)}")
    return float(number)


def _sigmas(
    sigma: Mapping[str, Any], targets: Mapping[str, float], columns: Mapping[str, Array], s: Array | None
) -> dict[str, Any]:
    """The standard deviations of all data, or none. Raises `InputError`."""
    names = [*targets, *columns]
    for name in sigma:
        check_known("datum", name, names)
    sigmas: dict[str, Any] = {}
    for name, value in sigma.items():
        count = 1 if name in targets else columns[name].size
        numbers = floats_in(value)
        if numbers.shape not in ((), (count,)) or not (np.isfinite(numbers) & (numbers > 0)).all():
            shape = "a positive number" if name in targets else f"a positive number, or {count} of them"
            raise InputError(f"sigma of {name} must be {shape}, got {value!r:.60}")
        sigmas[name] = numbers if numbers.ndim == 0 or name not in targets else numbers[0]
    if sigma and (missing := [name for name in names if name not in sigma]):
        raise InputError(f"sigma is given of {choices(sigma)} and not of {choices(missing)}: give it of all or of none")
    return sigmas


def scale_of(case: Case, name: str, value: float) -> float:
    """The error of a target that counts as 1 where none is known: its size, or the natural unit of the case."""
    observable = target_parts(name)[0]
    quantity(observable)
    return abs(value) or float(natural_unit(case, observable)[0])
