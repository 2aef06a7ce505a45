"""The numeric fields of a case by the names of their quantities, and a case with another value of one of them."""

from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from typing import Any

from .case import Case
from .errors import InputError, choices, near
from .quantities import AT_START

FIELD = {name: field for field, name in AT_START.items()}  # of `Start` and `Ends`; `Ends` has fields beta0 and betaL


def fields_of(case: Case) -> tuple[str, ...]:
    """The names of the fields of a case with respect to which there are derivatives."""
    return tuple(AT_START.get(name, name) if part is case.given else name for part, name, _ in case._numeric)


def check_fields(case: Case, names: Any) -> tuple[str, ...]:
    """The names as a tuple. Raises `InputError` for a name that is no numeric field of the case or is repeated."""
    fields = (names,) if not isinstance(names, Iterable) or isinstance(names, str) else tuple(names)
    known = fields_of(case)
    for name in fields:
        if name not in known:
            raise InputError(f"no field {name!r} in this case{near(name, known)}; choose from {choices(known)}")
    if not fields or len(set(fields)) < len(fields):
        raise InputError(f"fields must be one or several different names, got {choices(fields) or 'none'}")
    return fields


def _place_of(case: Case, name: str) -> tuple[str, str]:
    """The part of a case that has a field, named as its quantity, and the field's name there."""
    for field in (name, FIELD.get(name, name)):
        for part in ("rod", "cylinder", "given"):
            if hasattr(getattr(case, part), field):
                return part, field
    known = fields_of(case)
    raise InputError(f"no field {name!r} in this case{near(name, known)}; choose from {choices(known)}")


def with_field(case: Case, name: str, value: Any) -> Case:
    """The case with another value of one numeric field, named as its quantity. Raises `InputError`."""
    return with_fields(case, {name: value})


def with_fields(case: Case, values: Mapping[str, Any]) -> Case:
    """The case with other values of some numeric fields. Raises `InputError` for values that a case cannot have."""
    case = unchecked_with_fields(case, values)
    return Case(replace(case.rod), replace(case.cylinder), replace(case.given))


def unchecked_with_fields(case: Case, values: Mapping[str, Any]) -> Case:
    """The case with other, valid values of some numeric fields, several times as fast."""
    changes: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        part, field = _place_of(case, name)
        changes.setdefault(part, {})[field] = value
    return _copy(case, {part: _copy(getattr(case, part), changed) for part, changed in changes.items()})


def _copy(value: Any, changes: dict[str, Any]) -> Any:
    """A copy of a frozen dataclass that is not validated."""
    new = object.__new__(type(value))
    vars(new).update({field.name: changes.get(field.name, getattr(value, field.name)) for field in fields(value)})
    return new


def value_of(case: Case, name: str) -> float:
    """The value of one numeric field of a single case."""
    return float(values_of(case, name))


def values_of(case: Case, name: str) -> Any:
    """The value or the values of one numeric field, named as its quantity."""
    part, field = _place_of(case, name)
    return getattr(getattr(case, part), field)
