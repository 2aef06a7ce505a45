"""The values of the fields of a case: numbers, arrays and angles as text, validated when a part of the case is made.

An angle may be written as a number in rad, ``30deg``, ``pi/6``, ``-2pi/3``: in Python, in a study and on the command
line. A number without a unit that looks like degrees is read in rad too, with a notice: `doubt` decides where, for all
three.
"""

import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import MISSING, fields
from functools import wraps
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .declared_fields import ANGLES, CHOICES, FIELDS, RANGES, REPLACED, WELL
from .errors import InputError, T, choices, known_name, near, no_such, show
from .notices import is_called_by_a_program, warn
from .quantities import unit_of
from .units import NUMBER, is_angle_unit, unit_size


def refuse_outside(part: Any) -> None:
    """Raise `InputError` for the first field of a part of a case, of those that are given, outside its range."""
    for name in part.__match_args__:
        value, allowed = getattr(part, name), RANGES.get(name)
        if value is not None and allowed is not None:
            refuse(type(part).__name__, name, value, allowed.excludes(value), allowed.rule)


def refuse_strange_words(part: Any) -> None:
    """Raise `InputError` for a field of a part of a case whose value is none of its words."""
    for name in (name for name in part.__match_args__ if name in CHOICES):
        value = getattr(part, name)
        if not (value is None and FIELDS[name].omitted is None) and not known_name(value, CHOICES[name]):
            raise no_such(name, value, CHOICES[name])


def is_met(name: str, values: Mapping[str, Any]) -> bool:
    """Whether a field has what it needs. values: the fields that are given; others may be None."""
    word, _, needed = FIELDS[name].needs.rpartition(" ")
    other = values.get(needed)
    return not needed or (other is not None and word in ("", other))


def refuse_unmet(values: Mapping[str, Any]) -> None:
    """Raise `InputError` for a field that is given without the field that it needs; a value None: not given."""
    for name, value in values.items():
        needs = FIELDS[name].needs
        needed = needs.rpartition(" ")[2]
        is_omitted = value is None or (name in CHOICES and value == FIELDS[name].omitted)
        if is_omitted or needed not in values or is_met(name, values):
            continue
        got = f"no {needed}" if values[needed] is None else f"{needed}={values[needed]!r}"
        raise InputError(f"{name} matters only with {needs}, got {name}={show(value)} and {got}")


ARGUMENTS = {  # of a case, which are no numbers
    "rod": "Rod(...) as its first argument",
    "cylinder": "Cylinder(...) as its second argument",
    "given": "Start(...) or Ends(...) as its third argument",
}


def check_field_names(kind: type[T]) -> type[T]:
    """Decorate a dataclass: an unknown, a missing and a surplus argument raise `InputError` with the choices."""
    known = {field.name: field.default is MISSING for field in fields(kind)}  # type: ignore[arg-type]
    make: Callable[..., None] = kind.__init__

    @wraps(make)
    def init(self: T, *values: Any, **named: Any) -> None:
        given = [*list(known)[: len(values)], *named]
        for name in named:
            if name not in known:
                hint = f"{near(name, known)}; choose from {choices(known)}"
                raise InputError(f"no field {name!r} in {kind.__name__}{hint}")
        if len(values) > len(known) or len(set(given)) < len(given):
            raise InputError(f"{kind.__name__} takes each of {choices(known)} once, got {choices(given)}")
        if missing := [name for name, needed in known.items() if needed and name not in given]:
            if missing[0] in ARGUMENTS:
                raise InputError(f"{kind.__name__} needs {ARGUMENTS[missing[0]]}")
            raise InputError(f"{kind.__name__} needs {choices(missing)}; got {choices(given) or 'nothing'}")
        make(self, *values, **named)

    kind.__init__ = init  # type: ignore[assignment, method-assign]
    return kind


def numbers_of(owner: str, field: str, value: Any) -> NDArray[np.float64] | float:
    """The value as a float or a read-only float array, angles in rad; `InputError` for other and non-finite values.

    owner: the class or the function that takes the field; "" for one that stands in place of others.
    """
    said = _name_in(owner, field)
    try:
        array = np.asarray(value)
        if field in ANGLES and array.dtype.kind in "UO":
            array = in_rad(np.array(value, dtype=object))
        if not _only_numbers(array):
            raise TypeError
        with np.errstate(over="ignore"):  # a number beyond the floats is refused as infinite
            array = np.array(array, dtype=float)
    except OverflowError:
        raise InputError(f"{said} must be a number that a float can hold, got {show(value)}") from None
    except (TypeError, ValueError):
        form = f"{FORMS}; or an array of these" if field in ANGLES else "a number or an array of numbers"
        raise InputError(f"{said} must be {form}, got {show(value)}") from None
    if array.size == 0:
        raise InputError(f"{said} is empty; give at least one value")
    refuse(owner, field, array, ~np.isfinite(array), "finite")
    if array.ndim == 0:
        return float(array)
    array.setflags(write=False)
    return array


def numbers_in_place(values: Mapping[str, Any]) -> dict[str, Any]:
    """The values that stand in place of fields of a case (`REPLACED`), as `numbers_of` reads them; None is none.

    Raises `InputError`, which names the field as it was given, for what is no number or is outside its range.
    """
    read = {name: numbers_of("", name, values[name]) for name in REPLACED if values.get(name) is not None}
    for name, value in read.items():
        if allowed := REPLACED[name].range:
            refuse("", name, value, allowed.excludes(value), allowed.rule)
    return read


def floats_in(value: Any) -> NDArray[np.float64]:
    """A value as an array of floats; NaN alone in place of one that holds what is no number."""
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        return np.array(np.nan)


def read_range(name: str, given: Any, what: str = "range") -> tuple[float, float]:
    """The two ends of a range of a field; angles may be texts. Raises `InputError`.

    what: how a refusal calls it; "bounds" may be infinite.
    """
    try:
        low, high = (angle(v) if isinstance(v, str) and name in ANGLES else float(v) for v in given)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"the {what} of {name} must be two numbers (from, to), got {show(given)}") from None
    finite = "" if what == "bounds" else "finite "
    if not low < high or (finite and not np.isfinite([low, high]).all()):
        raise InputError(f"the {what} of {name} must be two {finite}numbers, the first lower, got {show(given)}")
    return low, high


def in_rad(values: NDArray[Any]) -> NDArray[Any]:
    """An array of objects with each text replaced by its angle. Raises `ValueError`."""
    read = [angle(element) if isinstance(element, str) else element for element in values.flat]
    return np.array(read, dtype=object).reshape(values.shape)


def _only_numbers(array: NDArray[Any]) -> bool:
    """Whether each element is a real number; text is not a number, even "5", and neither is True."""
    if array.dtype.kind == "O":
        return not any(element is None or isinstance(element, (str, bytes, bool)) for element in array.flat)
    return array.dtype.kind in "iuf"


def refuse(owner: str, field: str, value: ArrayLike, bad: ArrayLike, rule: str) -> None:
    """Raise `InputError` with the first bad value, if there is any; the values broadcast to what is said of them."""
    bad = np.atleast_1d(bad)
    if bad.any():
        worst = np.broadcast_to(value, bad.shape)[bad].flat[0]
        index = ", ".join(map(str, np.argwhere(bad)[0]))
        more = f"; the first of {bad.sum()} such values" if bad.sum() > 1 else ""
        where = f" (at index {index} of {bad.size} values{more})" if bad.size > 1 else ""
        said = f"{worst:.10g}" if isinstance(worst, float) else f"{worst!s}"
        said += f" rad ({math.degrees(worst):.6g} deg)" if " rad (" in rule else ""
        raise InputError(f"{_name_in(owner, field)} must be {rule}, got {said}{where}")


def _name_in(owner: str, field: str) -> str:
    return f"{owner}.{field}" if owner else field


def check_values(self: Any) -> None:
    """Turn each number of a part of a case into a float or a read-only array, and refuse values that it cannot take.

    Raises `InputError` for what is no number, is none of its words, or is outside its range.
    """
    for field in fields(self):
        value = getattr(self, field.name)
        optional = field.default is None
        if field.name not in CHOICES and not (optional and value is None):
            read = numbers_of(type(self).__name__, field.name, value)
            object.__setattr__(self, field.name, read)
            if field.name in ANGLES:
                _notice(field.name, value, read)
    refuse_strange_words(self)
    refuse_outside(self)


def write_fields(self: Any, skip: tuple[str, ...] = ()) -> str:
    """A part of a case as it would be made: ``Cylinder(R=0.75, side='inside')``, without fields that are None."""
    values = ((name, getattr(self, name)) for name in self.__match_args__ if name not in skip)
    return f"{type(self).__name__}({choices(f'{name}={value!r}' for name, value in values if is_said(name, value))})"


def is_said(name: str, value: Any) -> bool:
    """Whether a list of the fields of a case mentions this one: it is given, and is no default of a quiet field."""
    return value is not None and not (FIELDS[name].is_quiet and value == FIELDS[name].default)


def _notice(field: str, value: Any, read: NDArray[np.float64] | float) -> None:
    """Warn of an angle that a program gives without a unit if it may be meant in degrees."""
    large = np.abs(read) > np.pi
    if np.any(large) and is_called_by_a_program():
        numbers = value[large] if isinstance(value, np.ndarray) and value.dtype.kind in "if" else value
        if sentence := doubt(field, numbers):
            warn(sentence)


FORMS = "a number in rad, or a form like 30deg, pi/6 or 2pi/3"


def angle(text: str) -> float:
    """The angle that a text denotes [rad].

    Raises `ValueError`, whose message names the text and the accepted forms.

    >>> angle("30deg") == angle("pi/6")
    True
    """
    said = text.strip()
    if (match := re.fullmatch(rf"([+-]?{NUMBER})\s*([a-z°]+)", said)) and is_angle_unit(match[2]):
        return float(match[1]) * unit_size(match[2])[0]
    if match := re.fullmatch(rf"([+-]?)\s*({NUMBER})?\s*\*?\s*(?:pi|π)(?:\s*/\s*({NUMBER}))?", said):
        below = float(match[3] or 1)
        if below:
            size = float(match[2] or 1) * math.pi / below
            return -size if match[1] == "-" else size
    try:
        return float(said)
    except ValueError:
        raise ValueError(f"{text!r} is not an angle: give {FORMS}") from None


def doubt(name: str, value: object) -> str:
    """The notice about the angle of that name if it may be meant in degrees, else an empty text.

    value: as a user gives it: a number, a text, or a list or an array of these; its largest doubtful number is named.

    >>> doubt("beta0", 5)
    'beta0 = 5 is read as 5 rad = 286.48 degrees; write "5 deg" if degrees are meant, or "5 rad"'
    >>> doubt("beta0", "5 rad"), doubt("beta0", 3), doubt("beta0", 6.283185307179586)
    ('', '', '')
    """
    doubtful = [number for number in _plain_numbers(value) if _looks_like_degrees(number)]
    if not doubtful:
        return ""
    worst = max(doubtful, key=abs)
    said = f"{worst:.10g}"
    return (
        f"{name} = {said} is read as {said} rad = {math.degrees(worst):.2f} degrees; "
        f'write "{said} deg" if degrees are meant, or "{said} rad"'
    )


# field -> its least and largest usual value in metres and newtons, units of other tables of pipes, and one to state it
# in. E: of metals, from magnesium to tungsten; radii: to 30 cm, of a hole to 55 cm; weight: less than solid steel of
# this radius has.
# x10: no number that is meant in inches, psi or lbf/ft is doubted
_USUAL = {
    "E": (40e9, 450e9, ("psi", "ksi", "GPa"), "GPa"),
    "a": (0.0, 0.3, ("in",), "mm"),
    "inner_radius": (0.0, 0.3, ("in",), "mm"),
    "R": (0.0, 0.55, ("in",), "mm"),
    "weight": (0.0, 2e4, ("lbf/ft",), "kN/m"),
}


def doubt_size(name: str, value: object, units: Mapping[str, str], beside: Collection[str] = ()) -> str:
    """The notice about a field of rods in feet that would be usual in psi, in or lbf/ft alone, else an empty text.

    value: as a user gives it, as in `doubt`. units: of "length" and "force". beside: the fields that are given: only
    words of a well say that R is that of a hole, and not of a drum, which may have any.

    >>> doubt_size("E", 30e6, {"length": "ft", "force": "lbf"}).partition("; ")[2]
    'write "30000000 psi" if psi is meant, or "30000000 lbf/ft^2"'
    >>> doubt_size("E", 30e6, {"length": "ft", "force": "klbf"}).partition("; ")[0]
    'E = 30000000 is read as 30000000 klbf/ft^2 = 1436 GPa'
    >>> doubt_size("E", 4.32e9, {"length": "ft", "force": "lbf"})
    ''
    >>> doubt_size("weight", 19.5, {"length": "ft", "force": "klbf"})
    'weight = 19.5 is read as 19.5 klbf/ft = 284.6 kN/m; write "19.5 lbf/ft" if lbf/ft is meant, or "19.5 klbf/ft"'
    >>> doubt_size("R", 4.25, {"length": "ft", "force": "klbf"}, ["L", "hole"])
    'R = 4.25 is read as 4.25 ft = 1295 mm; write "4.25 in" if in is meant, or "4.25 ft"'
    >>> doubt_size("R", 4.25, {"length": "ft", "force": "klbf"}, ["L", "lay"])
    ''
    """
    if name not in _USUAL or units["length"] != "ft" or (name == "R" and WELL.keys().isdisjoint(beside)):
        return ""
    low, high, others, stated = _USUAL[name]
    unit = unit_of(name, units)
    size, numbers = unit_size(unit)[0], [*_plain_numbers(value)]
    for other in others:
        meant = unit_size(other)[0]
        doubtful = [x for x in numbers if low <= x * meant <= high and not low <= x * size <= high]
        if doubtful:
            worst = max(doubtful)
            return (
                f"{name} = {worst:.10g} is read as {worst:.10g} {unit} = {worst * size / unit_size(stated)[0]:.4g} "
                f'{stated}; write "{worst:.10g} {other}" if {other} is meant, or "{worst:.10g} {unit}"'
            )
    return ""


def _plain_numbers(value: object) -> Iterator[float]:
    """The finite numbers without a unit in a value."""
    value = getattr(value, "tolist", lambda: value)()
    if isinstance(value, (list, tuple)):
        for element in value:
            yield from _plain_numbers(element)
        return
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return
    if math.isfinite(number):
        yield number


def _looks_like_degrees(number: float) -> bool:
    """Whether a number of rad may be meant in degrees: above pi it has at most one decimal, above 13 at most four.

    A computed angle has more decimals, also one that was given in degrees and converted.
    """
    return abs(number) < 1e6 and any(  # nobody writes as many degrees
        abs(number) > size and round(number, decimals) == number for size, decimals in ((math.pi, 1), (13.0, 4))
    )
