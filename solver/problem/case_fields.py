"""The numeric fields of a case by the names of their quantities, and a case with another value of one of them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace
from functools import cache
from typing import Any

import numpy as np

from .case import Case, Cylinder, Rod
from .declared_fields import ALL_FIELDS
from .errors import InputError, choices, known_name, names_of, near
from .field_values import numbers_of
from .quantities import AT_START

MOST_LISTED = 12  # values of a field that a message lists. x10: a message of many lines


def fields_of(case: Case) -> tuple[str, ...]:
    """The names of the fields of a case with respect to which there are derivatives."""
    return tuple(AT_START.get(name, name) if part is case.given else name for part, name, _ in case._numeric)


def check_fields(case: Case, names: Any, known: Iterable[str] | None = None) -> tuple[str, ...]:
    """The names of the quantities of fields as a tuple.

    known: those that may be named. Default: the fields of the case.

    Raises `InputError` for a name that is no numeric field of the case or is repeated.
    """
    known = fields_of(case) if known is None else tuple(known)
    fields = tuple(of_quantity(case, name) for name in names_of(names))
    for name in fields:
        if not known_name(name, known):
            raise _no_field(name, known)
    if not fields or len(set(fields)) < len(fields):
        raise InputError(f"fields must be one or several different names, got {choices(fields) or 'none'}")
    return fields


def _no_field(name: Any, known: Sequence[str]) -> InputError:
    """The refusal of a name; of one that stands in place of a known field, such as wob, it names that."""
    row = ALL_FIELDS.get(name) if isinstance(name, str) else None
    given = row is not None and row.in_place_of in known
    hint = f": {name} stands in place of {row.in_place_of}, so name that" if row and given else near(name, known)
    return InputError(f"no field {name!r} in this case{hint}; choose from {choices(known)}")


def of_quantity(case: Case, name: Any) -> Any:
    """The name of the quantity of a field: beta0 for the beta of a start; what names no field as it is."""
    given: Any = type(case.given)
    places = _places(given)
    return AT_START.get(places[name][1], name) if known_name(name, places) else name


def _place_of(case: Case, name: str) -> tuple[str, str]:
    """The part of a case that has a field, named as its quantity, and the field's name there."""
    given: Any = type(case.given)
    place = _places(given).get(name)
    if place is None:
        known = fields_of(case)
        raise _no_field(name, known)
    return place


@cache
def _places(given: Any) -> dict[str, tuple[str, str]]:
    """The part and the field there, by the name of the field and by that of its quantity, with such a start or ends."""
    parts = ("rod", Rod), ("cylinder", Cylinder), ("given", given)
    places = {field.name: (part, field.name) for part, kind in parts for field in fields(kind)}
    return {AT_START.get(name, name): place for name, place in places.items()} | places


def with_field(case: Case, name: str, value: Any) -> Case:
    """The case with another value of one numeric field, named as its quantity. Raises `InputError`."""
    return with_fields(case, {name: value})


def with_fields(case: Case, values: Mapping[str, Any]) -> Case:
    """The case with other values of some numeric fields. Raises `InputError` for values that a case cannot have."""
    case = with_fields_unchecked(case, values)
    return Case(replace(case.rod), replace(case.cylinder), replace(case.given))


def with_fields_unchecked(case: Case, values: Mapping[str, Any]) -> Case:
    """The case with other, valid values of some numeric fields, several times as fast."""
    changes: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        part, field = _place_of(case, name)
        changes.setdefault(part, {})[field] = value
    return _copy(case, {part: _copy(getattr(case, part), changed) for part, changed in changes.items()})


def _copy(value: Any, changes: dict[str, Any]) -> Any:
    """A copy of a frozen dataclass that is not validated."""
    new, known = object.__new__(type(value)), vars(value)
    vars(new).update({name: changes[name] if name in changes else known[name] for name in value.__match_args__})
    return new


def value_of(case: Case, name: str) -> float:
    """The value of one numeric field of a single case."""
    return float(values_of(case, name))


def values_of(case: Case, name: str) -> Any:
    """The value or the values of one numeric field, named as its quantity."""
    part, field = _place_of(case, name)
    return getattr(getattr(case, part), field)


def cases_at(case: Case, index: Any) -> Case:
    """The cases of a grid at an index as of NumPy; a field that is one number for all of them stays one."""
    every = case._numeric
    parts = {}
    for name in ("rod", "cylinder", "given"):
        part = getattr(case, name)
        arrays = {field: value for of, field, value in every if of is part and np.ndim(value)}
        picked = {field: np.broadcast_to(value, case.shape)[index] for field, value in arrays.items()}
        parts[name] = _copy(part, {field: value if np.ndim(value) else float(value) for field, value in picked.items()})
    return _copy(case, parts)


def place_along(case: Case, name: str, value: Any) -> tuple[int, Any]:
    """The axis of a grid of cases along which a field varies, and the place on it of a value, or of several.

    Values are met to nine digits; an angle may be text. Raises `InputError` for a field that varies along none or
    several axes, and for what is no finite number or no case has.
    """
    every = np.broadcast_to(values_of(case, name), case.shape)
    along = [k for k in range(every.ndim) if (every != every.take([0], axis=k)).any()]
    if len(along) != 1:
        how = f"{len(along)} axes" if along else "no axis"
        raise InputError(f"{name} varies along {how} of these cases, so no value of it selects some; use an index")
    known = np.moveaxis(every, along[0], -1).reshape(-1, case.shape[along[0]])[0]
    listed = choices(f"{number:.10g}" for number in known[:MOST_LISTED]) + ", ..." * (known.size > MOST_LISTED)
    numbers = numbers_of("selected", name, value)
    places = []
    for number in np.ravel(numbers):
        near_it = np.flatnonzero(np.isclose(known, number, rtol=1e-9, atol=0))
        if not near_it.size:
            raise InputError(f"no case has {name} = {number:.10g}; there are {listed}")
        places.append(int(near_it[0]))
    return along[0], places[0] if np.ndim(numbers) == 0 else places
