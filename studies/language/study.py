"""A study: units, a reading of Table 1, a base case, axes, observables, outputs, and laws; and what follows from them.

`study_checks` says whether the parts of a study fit each other.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Protocol, Self

from numpy.typing import NDArray
from pydantic import BaseModel, Field, PrivateAttr, ValidationInfo, field_validator

from solver import Case, Ends, InputError, Start
from solver.free.free_rods import FREE_TOLERANCE
from solver.observe.observables import OBSERVABLES, error_name
from solver.problem.case import DIRECT
from solver.problem.declared_fields import FIELDS, PAIRS, REPLACED, VARY_LOADS, WOUND
from solver.problem.errors import DEFAULT_TOLERANCE, choices
from solver.problem.shown import Picture, make

from ..grammar import formulas
from ..grammar.axes import (
    CYLINDER,
    ENDS,
    OF_ENDS_ALONE,
    ROD,
    START,
    STRICT,
    WORDS,
    Axis,
    Base,
    Dimension,
    Line,
    Units,
    Which,
    case_from,
    check_names,
    read_units,
)
from ..laws.judgement import Law
from .case_tables import Table
from .printed import as_reading, table_of
from .refinement import OUTCOME, Refine
from .samples import Sample
from .variation import Variation
from .wells_and_cables import of_a_well, under_start_force, unwound

if TYPE_CHECKING:
    from ..laws.law_verdict import LawVerdicts

# The quantities that can be stored along the rod: names of `Solution`.
OUTPUTS = (
    "beta", "dbeta", "alpha", "z", "radius", "gap", "tilt", "gamma", "position", "kappa",
    "F1", "F2", "F3", "FY", "contact", "M1", "M2", "M3_along", "h",
)  # fmt: skip

OFF_WALL, NOT_OFF_WALL = ("radius", "gap", "tilt"), ("h",)  # of rods that may leave the cylinder alone, of others alone


def outputs_of(leaves: bool) -> tuple[str, ...]:
    """The quantities along a rod: off the wall, where it may leave it, there is no first integral, on it no gap."""
    return tuple(name for name in OUTPUTS if name not in (NOT_OFF_WALL if leaves else OFF_WALL))


# The default outputs of a study; of rods that may leave the cylinder also their radius, as it gives their place.
DRAWN = ["beta", "alpha", "z", "contact"]

# The default observables of a study.
OBSERVED = ["bends", "turns_around", "height", "kappa_max", "contact_size_mean", "attached"]

MAX_STATIONS = 100_001


def _leaves(said: Mapping[str, Any]) -> bool:
    """Whether rods may leave the cylinder; said: the keys of a study that come before."""
    return bool(said.get("let_go")) or ("base" in said and said["base"].given.get("contact") == "unilateral")


class SolvedStudy(Protocol):
    """What `Study.run` gives: the `xarray.Dataset` of the cases, the verdicts on the laws, and pictures."""

    ds: Any
    verdicts: "LawVerdicts"

    def plot(self, **at: Any) -> Picture: ...

    def scene(self, **at: Any) -> Picture: ...


class Study(BaseModel):
    """One study. Without axes and samples it is a single case.

    With a `reading`, base and axes are values as Table 1 prints them (F1 is F10, F3 the size of F30; default: the value
    of the table), and the reading converts them to a case. Without one they are the fields of the case. `load` makes
    one from a file; docs/reference/study-file.md says what each key means.

    Examples
    --------
    >>> from solver import observe, solve
    >>> from studies import load
    >>> study = load("fig7_1_modulus")
    >>> observe(solve(study.case()), ["bends"])["bends"]
    array([8, 7, 6, 6, 6, 5, 5, 5, 5])
    """

    model_config = STRICT

    name: str = Field("study", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]*$", max_length=200)
    title: Line
    units: Units
    reading: str | None = None
    base: Base = Base()
    let_go: bool = False
    equilibrium: Which | None = None
    axes: dict[str, Axis] = {}
    sample: Sample | None = None
    zip: dict[str, Annotated[list[float], Field(fail_fast=True)]] | None = None
    table: Table | None = None
    refine: Refine | None = None
    expressions: dict[str, str] = {}
    observables: list[str] = OBSERVED
    outputs: list[str] = Field(default_factory=lambda said: [*DRAWN, *["radius"] * _leaves(said)])
    stations: int = Field(201, ge=2, le=MAX_STATIONS)
    tol: float = Field(default_factory=lambda said: FREE_TOLERANCE if _leaves(said) else DEFAULT_TOLERANCE, gt=0, lt=1)
    method: str = "auto"
    laws: list[Law] = []
    _text: str = PrivateAttr("")
    _samples: Dimension | None = PrivateAttr(None)  # in place of those that `sample` draws

    @field_validator("reading")
    @classmethod
    def _full_reading(cls, value: str | None) -> str | None:
        return None if value is None else as_reading(value).name

    @field_validator("expressions", mode="before")
    @classmethod
    def _expressions_with_units(cls, given: Any) -> Any:
        return {name: _with_unit(item) for name, item in given.items()} if isinstance(given, dict) else given

    @field_validator("observables")
    @classmethod
    def _known_observables(cls, value: list[str], info: ValidationInfo) -> list[str]:
        return check_names("observable", value, (*OBSERVABLES, *info.data.get("expressions", ())))

    @field_validator("outputs")
    @classmethod
    def _known_outputs(cls, value: list[str], info: ValidationInfo) -> list[str]:
        if "push" in value:
            raise ValueError(
                "no output 'push', did you mean 'contact': it is positive outward, so the push is contact outside and "
                f"-contact inside; ds.rod.push computes it from the stored arrays; choose from {choices(OUTPUTS)}"
            )
        if _leaves(info.data):
            for name in {*value}.intersection(NOT_OFF_WALL):
                raise ValueError(f"a rod that may leave the cylinder has no first integral: omit the output {name}")
        return check_names("output", value, OUTPUTS)

    @field_validator("base", "equilibrium", mode="before")
    @classmethod
    def _in_units(cls, given: Any, info: ValidationInfo) -> Any:
        """The fields with numbers that are given with a unit in those of the study."""
        return read_units(given, _units_of(info))

    @field_validator("laws", mode="before")
    @classmethod
    def _places_in_units(cls, given: Any, info: ValidationInfo) -> Any:
        """The laws with their places on axes in the units of the study."""
        if not isinstance(given, list):
            return given
        units = _units_of(info)
        placed = [isinstance(law, dict) and "at" in law for law in given]
        return [
            law | {"at": read_units(law["at"], units)} if known else law
            for law, known in zip(given, placed, strict=True)
        ]

    @field_validator("axes", "sample", "zip", mode="before")
    @classmethod
    def _values_in_units(cls, given: Any, info: ValidationInfo) -> Any:
        """The fields with their values in the units of the study, a followed axis last."""
        read = read_units(given, _units_of(info))
        if not isinstance(read, dict):
            return read
        return dict(sorted(read.items(), key=lambda item: isinstance(item[1], dict) and item[1].get("follow") is True))

    @property
    def variation(self) -> Variation:
        """What varies, and how: the axes, the samples, the refinement; the number of cases and their dimensions."""
        return Variation(self.axes, self._samples or self.sample, self.refine)

    @property
    def text(self) -> str:
        """The TOML text of the study, or an empty text."""
        return self._text

    @property
    def unit_system(self) -> dict[str, str]:
        """``{"length": "cm", "force": "N"}``."""
        return self.units.model_dump()

    @property
    def kind(self) -> type:
        """Start or Ends, from the names of the given fields."""
        said = {*self.base.given, *(name for name in self.variation.fields if name != self.variation.followed)}
        return Ends if said & OF_ENDS_ALONE else Start

    @property
    def held(self) -> tuple[str, ...]:
        """The given fields of Ends that replace a dead load or an end angle."""
        said = {*self.base.given, *self.variation.fields}
        return tuple(partner for _, partner in PAIRS if partner in said)

    @property
    def reactions(self) -> tuple[str, ...]:
        """What is stored of held ends besides the loads: the index, and the end angles that are found."""
        angles = [field for field, partner in PAIRS[:2] if partner in self.held]
        return ("held_index", *angles) if self.held else ()

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of the fields that base may hold."""
        if self.reading:
            return (*table_of(self.reading), "side")
        return (*ROD, *CYLINDER, *((*START, "hole") if self.kind is Start else (*ENDS, *REPLACED)))

    @property
    def has_branches(self) -> bool:
        """Whether each case is labelled with its branch: ends problems over axes, but for helices of their own ends."""
        wound = set(WOUND) & {*self.base.given, *self.variation.fields}
        return bool(self.variation.grid) and self.kind is Ends and not (self.leaves or wound)

    @property
    def sweeps(self) -> bool:
        """Whether the study is a sweep, whose cases continue from one another to tell their branches.

        With weight or friction each case continues from the straight rod, whatever its neighbours are.
        """
        return self.has_branches and not self.varies

    @property
    def leaves(self) -> bool:
        """Whether the rods may leave the cylinder: it only pushes, or they are let go."""
        return _leaves(vars(self))

    @property
    def varies(self) -> bool:
        """Whether loads vary along the rods: weight or friction is given or varied."""
        given, varied = self.base.given, self.variation.fields
        return any(given.get(name) or name in varied for name in VARY_LOADS)

    @property
    def turns_in_place(self) -> bool:
        """Whether the rods turn in place against friction."""
        return self.varies and self.base.given.get("sliding") == "rotating"

    @property
    def known_observables(self) -> tuple[str, ...]:
        """The observables that the rods of the study have: with EI and GJ in place of E there is no stress."""
        given = {*self.base.given, *self.variation.fields}
        return tuple(name for name, row in OBSERVABLES.items() if row.needs != "E" or not given & {*DIRECT})

    @property
    def known_outputs(self) -> tuple[str, ...]:
        """The quantities along the rods of the study."""
        return outputs_of(self.leaves)

    def at_stations(self, stations: int) -> Self:
        """A copy of the study with another number of stations. Raises `InputError`."""
        if not 2 <= stations <= MAX_STATIONS:
            raise InputError(f"stations must be from 2 to {MAX_STATIONS}, got {stations}")
        return self.with_values(stations=stations)

    def with_values(self, **values: Any) -> Self:
        """A copy of the study with other values of some keys, which its text then has too (`study_text.dumps`)."""
        other = self.model_copy(update=values)
        other._text = ""
        return other

    def with_samples(self, samples: Dimension | None) -> Self:
        """A copy of the study with other samples."""
        other = self.model_copy()
        other._samples = samples
        return other

    def meaning(self, field: str) -> str:
        """The meaning of a printed value under the reading of the study, in words; empty if it is the plain field."""
        return as_reading(self.reading).meaning(field) if self.reading else ""

    @property
    def wanted(self) -> list[str]:
        """The observables and expressions to store: those of the study, its laws and its refinement."""
        judged = [name for law in self.laws for name in law.observables]
        used = [name for law in self.laws for formula in law.formulas.values() for name in formula.names]
        stored = [name for name in used if name in OBSERVABLES]
        watched = [name for name in self.refine.watch if name != OUTCOME] if self.refine else []
        torque = ["M30"] if self.turns_in_place else []  # with the load M3 those at both ends
        every = dict.fromkeys([*self.observables, *self.expressions, *judged, *stored, *watched, *torque])
        fields = {*self.held, *self.variation.fields}  # a height that is held is a field
        return [name for name in every if name not in fields]

    @property
    def observed(self) -> list[str]:
        """The observables to compute: those to store, and those that expressions use."""
        used = [name for text in self.expressions.values() for name in formulas.parse(text).names]
        return [name for name in dict.fromkeys([*self.wanted, *used]) if name in OBSERVABLES]

    @property
    def columns(self) -> list[str]:
        """The columns of the observables: each name, followed by the name of its error if it has one."""
        return [column for name in self.wanted for column in (name, self._error_of(name)) if column]

    def _error_of(self, name: str) -> str | None:
        """The name of the error of an observable or expression, or None for a whole number."""
        if name not in self.expressions:
            return error_name(name, self.leaves)
        return None if formulas.parse(self.expressions[name]).whole else f"{name}_error"

    @property
    def constants(self) -> dict[str, Any]:
        """The fields that are the same in all cases, as given: those of the base, of Table 1, or defaults."""
        return {**(table_of(self.reading) or _DEFAULTS), **self.base.given}

    @property
    def constants_of_laws(self) -> dict[str, Any]:
        """The constant numbers that formulas of the laws use."""
        used = {name for law in self.laws for formula in law.formulas.values() for name in formula.names}
        return {name: value for name, value in self.constants.items() if name in used and name not in WORDS}

    def under(self, reading: str | None) -> "Study":
        """A copy of the study under another reading; a missing word keeps that of the study. Raises `InputError`."""
        if reading is None:
            return self
        if self.reading is None:
            raise InputError(f"{self.name} does not use Table 1: the reading {reading!r} does not apply")
        return self.model_copy(update={"reading": as_reading(reading, as_reading(self.reading)).name})

    def coarse(self) -> "Study":
        """A copy of the study without its refinement: the grid of its axes."""
        return self.model_copy(update={"refine": None}).with_samples(None) if self.refine else self

    def run(self) -> SolvedStudy:
        """Solve every case and judge the laws, in memory.

        Returns
        -------
        workbench.notebook.StudyRun
            ``ds``, the dataset; ``verdicts``, one for each law, by number or claim; ``plot()`` and ``scene()``. A
            notebook shows its laws.

        Raises
        ------
        InputError
            For a study that needs too much memory; `workbench run` stores such a study as it is solved.

        Examples
        --------
        >>> from studies import load
        >>> result = load("fig7_1_modulus").run()
        >>> result.verdicts
        (1) bends falls along E: true; measured 8 → 5
        >>> result.verdicts["(1)"].verdict
        'true'
        """
        return make("workbench.notebook", "StudyRun", self)

    def case(self) -> Case:
        """The whole grid as one case, of shape (size of each axis, in order); of a followed study the base case.

        Raises `InputError` for a value that the solver refuses.
        """
        return self.case_of(self.variation.dimensions.open())

    def case_of(self, values: Mapping[str, Any]) -> Case:
        """The base case with other values of some fields: numbers, or arrays that broadcast. Raises `InputError`."""
        values = {**self.base.given, **values}
        if self.reading:
            side = values.pop("side", "outside")
            return as_reading(self.reading).case(values, side)
        return case_from(self.kind, unwound(of_a_well(values, {})))

    def case_to_solve(self, values: Mapping[str, Any]) -> tuple[Case, NDArray[Any]]:
        """The case of `case_of` with the FZ that gives each rod with friction its force at s = 0, found by solving it.

        Returns also, of the shape of the case, why none was found; "" where one was. Raises `InputError`.
        """
        return under_start_force(self.case_of(values), {**self.base.given, **values}, self.unit_system["force"])


_DEFAULTS = {name: row.omitted for name, row in FIELDS.items() if isinstance(row.omitted, float)}


def _units_of(info: ValidationInfo) -> dict[str, str] | None:
    """The units of a study that is being read, angles included; None where they are invalid."""
    units = info.data.get("units")
    return None if units is None else units.model_dump()


def _with_unit(given: Any) -> Any:
    """An expression of a study file as one text: ``{ formula = "a/b", unit = "MPa" }`` is ``a/b in MPa``."""
    if not isinstance(given, dict):
        return given
    if set(given) != {"formula", "unit"} or not all(isinstance(text, str) for text in given.values()):
        raise ValueError(f'an expression is a text, or {{ formula = "...", unit = "..." }}, got {given!r}')
    return f"{given['formula']}{formulas.IN}{given['unit']}"
