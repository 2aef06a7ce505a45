"""The parts of a study that hold numbers with units: units, base case, choice of equilibrium, axes; its dimensions.

An axis has the values of one field, the samples have those of several. The cases are all combinations: every sample at
every point of the grid of the axes. They are counted along the dimensions, the last fastest.
"""

from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import partial
from math import isfinite, log, prod
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, create_model, model_validator

from solver import Case, Cylinder, InputError, Rod
from solver.problem.declared_fields import ALL_FIELDS, AT_START, CHOICES, PARTS, REPLACED
from solver.problem.errors import check_known, no_such
from solver.problem.field_values import angle
from solver.problem.quantities import QUANTITIES, Quantity, quantity
from solver.problem.units import FORCES, LENGTHS, number_in

Values = NDArray[np.float64]

STRICT = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

ROD, CYLINDER, START, ENDS = (tuple(PARTS[part]) for part in ("rod", "cylinder", "start", "ends"))
OF_ENDS_ALONE = {*ENDS, *REPLACED} - {*START, "hole"}  # what only an ends problem is given
WORDS = tuple(CHOICES)  # the fields that are text

MAX_COUNT = 10_000_000  # values of an axis: 80 MB
MAX_CASES = 1_000_000_000  # cases of a grid: more than a day at 0.1 ms each

CLOSEST = 1e-15  # least relative difference of neighbours on an axis; closer values could round to the same float
# The units of a case that states none.
DEFAULT_UNITS = {"length": "cm", "force": "N"}


class Misplaced(ValueError):
    """An invalid value of a study. path: the key, relative to the model that raises the error."""

    def __init__(self, message: str, *path: str | int) -> None:
        super().__init__(message)
        self.path = path


def no_key(kind: str, name: str, known: Collection[str], *path: str | int) -> Misplaced:
    """The error of a key whose name or value is none of the known ones."""
    return Misplaced(str(no_such(kind, name, known)), *path)


def case_from(problem: type, values: Mapping[str, Any]) -> Case:
    """The case of fields by name: numbers and words, or arrays that broadcast.

    problem: `Start` or `Ends`, which takes the fields of neither rod nor cylinder. Raises `InputError`.
    """
    rod, cylinder = ({name: values[name] for name in names if name in values} for names in (ROD, CYLINDER))
    given = {name: value for name, value in values.items() if name not in (*ROD, *CYLINDER)}
    return Case(Rod(**rod), Cylinder(**cylinder), problem(**given))


def quantity_of(field: str) -> Quantity:
    """The quantity of a field of a case: that of `beta` of Start is beta0."""
    return quantity(AT_START.get(field, field))


def is_angle(field: str) -> bool:
    """Whether a field of a case is an angle [rad]; False for an unknown name."""
    return AT_START.get(field, field) in QUANTITIES and quantity_of(field).dimension == "rad"


def in_words(field: str, value: float, digits: int = 6) -> str:
    """``FZ = -150``; angles in degrees: ``beta0 = 30 deg``."""
    return f"{field} = {np.rad2deg(value):.{digits}g} deg" if is_angle(field) else f"{field} = {value:.{digits}g}"


def in_rad(value: Any) -> Any:
    """A text as an angle in rad; any other value unchanged. Raises `ValueError`."""
    return angle(value) if isinstance(value, str) else value


def number_of(field: str, text: str) -> float:
    """The number that a text gives for a field, of an angle also in a form like 30deg [rad]; NaN for another text."""
    try:
        return float(in_rad(text) if is_angle(field) else text)
    except ValueError:
        return float("nan")


NUMBERS = ("values", "from", "to", "mean", "std")  # keys of an axis or a distribution that are in the unit of its field


def read_units(fields: Any, units: Mapping[str, str] | None) -> Any:
    """The values of fields with each text, such as ``30deg`` or ``2.5in``, as a number in the units of the study.

    Other errors are found later. Raises `Misplaced`.

    Parameters
    ----------
    fields : dict
        Field -> value, list, or table of `NUMBERS`, whose key unit may be any unit of the field.
    units : dict or None
        The units of "length" and "force"; None where they are not known: then only angles are read.
    """
    if not isinstance(fields, dict):
        return fields
    known = [name for name in fields if is_angle(str(name)) or (units and _has_unit(str(name)))]
    return {name: _read(value, units or {}, name) if name in known else value for name, value in fields.items()}


def _has_unit(field: str) -> bool:
    """Whether a name is that of a number with a unit."""
    return field not in CHOICES and AT_START.get(field, field) in QUANTITIES and quantity_of(field).dimension != "text"


def _read(given: Any, units: Mapping[str, str], *where: str) -> Any:
    if isinstance(given, dict):
        numbers = {key: given[key] for key in NUMBERS if key in given}
        each = [value for entry in numbers.values() for value in (entry if isinstance(entry, list) else [entry])]
        texts = [value for value in each if isinstance(value, str)]
        if texts and "unit" in given:
            raise Misplaced(f"{texts[0]!r} has its own unit: remove the key unit", *where, "unit")
        table = given | {key: _read(value, units, *where, key) for key, value in numbers.items()}
        return table if texts else _in_own_unit(where[0], table, units)
    try:
        read = partial(number_with_unit, where[0], units=units)
        return [read(value) for value in given] if isinstance(given, list) else read(given)
    except ValueError as error:
        key = ".".join(where)
        raise Misplaced(str(error) if str(error).startswith(f"{key} ") else f"{key}: {error}", *where) from None


def _in_own_unit(field: str, given: dict[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    """A table of `NUMBERS` whose key unit is another unit of the field than that of the study, in that of the study."""
    unit = given.get("unit")
    if not (units and isinstance(unit, str)) or is_angle(field):
        return given
    try:
        size = number_in(field, f"1 {unit}", units)
    except InputError:  # which `study_checks` says
        return given

    def times_size(value: Any) -> Any:
        if isinstance(value, list):
            return [times_size(each) for each in value]
        return value * size if isinstance(value, int | float) and not isinstance(value, bool) else value

    return {key: times_size(value) if key in NUMBERS else value for key, value in given.items() if key != "unit"}


def number_with_unit(field: str, value: Any, units: Mapping[str, str]) -> Any:
    """A text as the number that it gives for a field, in these units, an angle in rad; any other value unchanged.

    Raises `ValueError`.
    """
    if not isinstance(value, str) or field in CHOICES:
        return value
    return angle(value) if is_angle(field) else number_in(field, value, units)


LONGEST_LINE = 10_000  # characters of a text that a file of results holds in one line


def _on_one_line(text: str) -> str:
    if not text or not text.isprintable():
        raise ValueError(f"{text[:60]!r} must be one line of printable text")
    if len(text) > LONGEST_LINE:
        raise ValueError(f"the text has {len(text)} characters; the limit is {LONGEST_LINE}")
    return text


@dataclass(frozen=True)
class _OneOf(AfterValidator):
    """A validator whose names stand in the schema."""

    known: tuple[str, ...] = ()

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {**handler(schema), "enum": [*self.known]}


def one_of(kind: str, known: Collection[str]) -> AfterValidator:
    """That a text is one of the known names; the error names the kind, the text and the choices."""

    def check(value: str) -> str:
        check_known(kind, value, known)
        return value

    return _OneOf(check, tuple(known))


def check_names(kind: str, names: list[str], known: Collection[str]) -> list[str]:
    """The names, if all are known and none is repeated. Raises `ValueError`."""
    for name in names:
        check_known(kind, name, known)
    if twice := [name for name in names if names.count(name) > 1]:
        raise ValueError(f"the {kind} {twice[0]!r} is given twice")
    return names


Line = Annotated[str, AfterValidator(_on_one_line)]  # text shown on terminals and in pictures
Angle = Annotated[float, BeforeValidator(in_rad)]


class Units(BaseModel):
    """The units of all numbers of a study."""

    model_config = STRICT

    length: Annotated[str, one_of("unit of length", LENGTHS)]
    force: Annotated[str, one_of("unit of force", FORCES)]


def _type_of(field: str) -> Any:
    """The type of a field in a study file: a number, an angle, or one of its words."""
    if field in CHOICES:
        return Literal[CHOICES[field]] | None
    return (Angle if is_angle(field) else float) | None


_TYPES: dict[str, Any] = {name: (_type_of(name), None) for name in ALL_FIELDS}
_Fields: Any = create_model("_Fields", __config__=STRICT, **_TYPES)  # the fields of the solver, each may be left out


class Base(_Fields):  # type: ignore[misc]
    """The base case, which the axes vary: numbers of Rod, Cylinder, and Start or Ends; an angle may be text."""

    @property
    def given(self) -> dict[str, Any]:
        """The given fields and their values."""
        fields: dict[str, Any] = self.model_dump(exclude_none=True)
        return fields


class Which(BaseModel):
    """Which equilibrium of an ends problem: by a rule, by its Morse index, or by beta'(0) and energy.

    choose: a rule of `solve`. index: a Morse index; of its equilibria the one whose beta goes least beyond its end
    angles, or of held ends that of least held energy. dbeta0 [rad/length] and energy [force length]: the equilibrium
    nearest to both.
    """

    model_config = STRICT

    choose: Literal["nearest", "lowest"] | None = None
    index: int | None = Field(None, ge=0)
    dbeta0: float | None = None
    energy: float | None = None

    @model_validator(mode="after")
    def _one_way(self) -> "Which":
        ways = "give choose, or index, or dbeta0 and energy"
        if (self.dbeta0 is None) != (self.energy is None):
            raise Misplaced(
                f"dbeta0 and energy must be given together: {ways}", "energy" if self.dbeta0 is None else "dbeta0"
            )
        said = [name for name in ("choose", "index", "dbeta0") if getattr(self, name) is not None]
        if not said:
            raise ValueError(f"equilibrium is empty: {ways}")
        if len(said) > 1:
            raise Misplaced(f"{said[0]} and {said[1]} exclude each other: {ways}", said[1])
        return self

    @property
    def rule(self) -> str | int | None:
        """The value of `choose` for `solve`; None if the equilibrium is given by beta'(0) and energy."""
        return self.index if self.choose is None else self.choose


class Axis(BaseModel):
    """The values of one axis: a list, or from, to and count.

    follow: whether each case continues the equilibrium of the one before it. Over a start problem the axis begins at
    the value of the base case and has no from.
    unit: that of the values, such as "deg" or "ksi"; default: the unit of the study, rad for an angle. A value may also
    be text with its unit. Values are used and stored in the units of the study, angles in rad.
    """

    model_config = STRICT

    values: list[float] | None = Field(None, fail_fast=True)
    from_: float | None = Field(None, alias="from")
    to: float | None = None
    # the limit of a grid is checked later; this one keeps its arithmetic within floats
    count: int | None = Field(None, le=10**15)
    spacing: Literal["linear", "geometric"] = "linear"
    unit: str | None = None
    follow: bool = False

    @model_validator(mode="after")
    def _one_way(self) -> "Axis":
        ways = "give values, or from, to and count"
        given = self.model_dump(by_alias=True, exclude_unset=True)
        if self.values is not None:
            also = [key for key in ("from", "to", "count", "spacing") if key in given]
            if also:
                raise Misplaced(f"values and {also[0]} exclude each other: {ways}", also[0])
            if not self.values:
                raise Misplaced("the axis is empty: give at least one value", "values")
            if len(set(self.values)) < len(self.values):
                twice = Counter(self.values).most_common(1)[0][0]
                raise Misplaced(f"the value {twice!r} is given twice", "values")
            return self
        needed = ("to", "count") if self.follow else ("from", "to", "count")
        missing = [key for key in needed if key not in given]
        if missing:
            raise ValueError(f"the axis has no {', '.join(missing)}: {ways}")
        if given["count"] < 1:
            raise Misplaced(f"the axis is empty: count must be at least 1, got {self.count}", "count")
        if "from" in given:
            self._check_range(given["from"], given["to"], given["count"])
        return self

    def _check_range(self, first: float, last: float, count: int) -> None:
        """Refuse values that are not finite or not distinct, judged by the ends alone: count may be very large."""
        if (count == 1) != (first == last):
            fits = "count must be at least 2" if count == 1 else "count must be 1"
            raise Misplaced(f"{fits} for an axis from {first:g} to {last:g}, got {count}", "count")
        if self.spacing == "geometric":
            if not first * last > 0:
                why = f"geometric spacing needs both ends of one sign and not 0, got {first:g} to {last:g}"
                raise Misplaced(why, "spacing")
            step = abs(log(abs(last)) - log(abs(first))) / max(count - 1, 1)
        else:
            step = abs(last - first) / max(count - 1, 1) / max(abs(first), abs(last), 5e-324)
        if not isfinite(step) or (count > 1 and step <= CLOSEST):
            raise Misplaced(f"{count} distinct values do not fit between {first!r} and {last!r}", "count")

    @property
    def size(self) -> int:
        """Number of values."""
        return len(self.values) if self.values is not None else int(self.count or 0)

    def numbers(self) -> NDArray[np.float64]:
        """The values, (size,), angles in rad; not defined for a followed axis."""
        if self.values is not None:
            values = np.array(self.values, dtype=float)
        else:
            assert self.from_ is not None
            assert self.to is not None
            space = np.geomspace if self.spacing == "geometric" else np.linspace
            values = space(self.from_, self.to, self.size)
        return np.deg2rad(values) if self.unit == "deg" else values

    @property
    def from_base(self) -> bool:
        """Whether the axis has no first value: it begins at that of the base case, a start problem."""
        return self.values is None and self.from_ is None

    @property
    def limit(self) -> float:
        """The largest value of a followed axis [rad]."""
        assert self.to is not None
        return float(np.deg2rad(self.to)) if self.unit == "deg" else self.to


SAMPLE = "sample"  # the name of the dimension of the samples, whose coordinate is their number


@dataclass(frozen=True, eq=False)
class Dimension:
    """One dimension.

    name: that of its field, or `SAMPLE`. fields: field -> its values, (size,). numbers: of the samples, where they are
    some of others; default: 0, 1, 2, ...
    """

    name: str
    fields: Mapping[str, Values]
    numbers: NDArray[np.int64] | None = None

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Dimension)
            and (self.name, *self.fields) == (other.name, *other.fields)
            and all(np.array_equal(values, other.fields[name]) for name, values in self.fields.items())
        )

    @property
    def size(self) -> int:
        """Number of values."""
        return next(iter(self.fields.values())).size

    @property
    def coordinate(self) -> NDArray[np.float64] | NDArray[np.int64]:
        """The values of its field; of the samples their numbers."""
        if self.name != SAMPLE:
            return self.fields[self.name]
        return np.arange(self.size) if self.numbers is None else self.numbers

    def only(self, places: NDArray[np.int64]) -> "Dimension":
        """The dimension with the values at these places alone; samples keep their numbers."""
        fields = {name: values[places] for name, values in self.fields.items()}
        return Dimension(self.name, fields, np.arange(self.size)[places] if self.name == SAMPLE else None)


@dataclass(frozen=True, eq=False)
class Dimensions:
    """All dimensions of a study, in order."""

    each: tuple[Dimension, ...] = ()

    @classmethod
    def of(cls, axes: Mapping[str, Values], samples: Dimension | None = None) -> "Dimensions":
        """The dimensions of axes, field -> values; before them the samples, if there are any."""
        first = () if samples is None else (samples,)
        return cls((*first, *(Dimension(name, {name: values}) for name, values in axes.items())))

    @property
    def names(self) -> tuple[str, ...]:
        """The name of each dimension."""
        return tuple(dimension.name for dimension in self.each)

    @property
    def shape(self) -> tuple[int, ...]:
        """The size of each dimension."""
        return tuple(dimension.size for dimension in self.each)

    @property
    def size(self) -> int:
        """Number of cases."""
        return prod(self.shape)

    @property
    def fields(self) -> dict[str, Values]:
        """Every field that varies, with its values along its own dimension."""
        return {name: values for dimension in self.each for name, values in dimension.fields.items()}

    def at(self, flat: NDArray[np.int64]) -> dict[str, Values]:
        """The fields of the cases of these flat indices, (cases,) each."""
        if not self.each:
            return {}
        places = zip(self.each, np.unravel_index(flat, self.shape), strict=True)
        return {name: values[i] for dimension, i in places for name, values in dimension.fields.items()}

    def open(self) -> dict[str, Values]:
        """Every field along its own dimension: together they broadcast to the shape of the grid."""
        rank = len(self.each)
        return {
            name: values.reshape([-1 if i == k else 1 for k in range(rank)])
            for i, dimension in enumerate(self.each)
            for name, values in dimension.fields.items()
        }
