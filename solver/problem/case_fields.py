"""A case with another value of one of its numeric fields, named as its quantity."""

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

from .case import Case
from .errors import InputError, choices, near
from .field_rates import fields_of

FIELD = {"alpha0": "alpha", "gamma0": "gamma"}  # the fields of `Ends` whose quantity has another name


def with_field(case: Case, name: str, value: Any) -> Case:
    """The case with another value of one numeric field, named as its quantity. Raises `InputError`."""
    name = FIELD.get(name, name)
    for part in ("rod", "cylinder", "given"):
        owner = getattr(case, part)
        if hasattr(owner, name):
            return replace(case, **{part: replace(owner, **{name: value})})
    known = fields_of(case)
    raise InputError(f"no field {name!r} in this case{near(name, known)}; choose from {choices(known)}")


def unchecked_with_field(case: Case, name: str, value: float) -> Case:
    """The same for a valid value, several times as fast."""
    name = FIELD.get(name, name)
    parts: dict[str, Any] = {}
    for part in fields(case):
        owner = getattr(case, part.name)
        parts[part.name] = _copy(owner, {name: value}) if hasattr(owner, name) else owner
    return _copy(case, parts)


def numbers_over(case: Case, name: str) -> Callable[[float], tuple[float, ...]]:
    """lam, mu, phi, span, beta(0) and beta(L) of an ends problem over one of its fields: those of `reduced.reduce`."""
    name = FIELD.get(name, name)
    given, rod = case.given, case.rod
    own = {one: getattr(given, one) for one in ("MZ", "M3", "FZ", "beta0", "betaL")}
    alters_section = name != "L" and not hasattr(given, name)

    def numbers(value: float) -> tuple[float, ...]:
        one = unchecked_with_field(case, name, value) if alters_section else case
        A, rho, L = one.rod.bending_stiffness, one.rho, value if name == "L" else rod.L
        MZ, M3, FZ, beta0, betaL = (value if key == name else known for key, known in own.items())
        return MZ / A * rho, M3 / A * rho, FZ / A * rho * rho, L / rho, beta0, betaL

    return numbers


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
    name = FIELD.get(name, name)
    return next(getattr(p, name) for p in (case.rod, case.cylinder, case.given) if hasattr(p, name))
