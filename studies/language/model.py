"""A study: units, a reading of Table 1, a base case, axes, observables, outputs, and laws."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationInfo, field_validator, model_validator

from solver import Case, Ends, InputError, Start
from solver.observe.observables import OBSERVABLES
from solver.problem.errors import choices, near, no_such
from solver.problem.quantities import unit_of
from solver.problem.shown import make

from ..grammar import axes as parts
from ..grammar.axes import (
    CYLINDER,
    MAX_COUNT,
    ROD,
    SAMPLE,
    START,
    WORDS,
    Axis,
    Dimension,
    Dimensions,
    Misplaced,
    Values,
    case_from,
    no_key,
)
from ..laws.verdicts import Law
from . import case_tables, expressions, refine
from .readings import TABLE_1, TABLE_UNITS, parse
from .refinement import OUTCOME
from .samples import Distribution
from .study_data import OUTPUTS, SOURCES, StudyData, check_equilibrium


class Study(StudyData):
    """One study. Without axes and samples it is a single case.

    With a `reading`, base and axes are values as Table 1 prints them (F1 is F10, F3 the size of F30; default: the value
    of the table), and the reading converts them to a case. Without one they are the fields of the case. `load` makes
    one from a file; docs/reference/study-file.md says what each key means.

    Examples
    --------
    >>> from solver import observe, solve
    >>> from studies import load
    >>> study = load("fig7_1_modulus")
    >>> observe(solve(study.case()), ["turns"])["turns"]
    array([8, 7, 6, 6, 6, 5, 5, 5, 5])
    """

    @field_validator("reading")
    @classmethod
    def _full_reading(cls, value: str | None) -> str | None:
        return None if value is None else parse(value).name

    @field_validator("expressions", mode="before")
    @classmethod
    def _expressions_with_units(cls, given: Any) -> Any:
        return {name: expressions.with_unit(item) for name, item in given.items()} if isinstance(given, dict) else given

    @field_validator("observables")
    @classmethod
    def _known_observables(cls, value: list[str], info: ValidationInfo) -> list[str]:
        return _known("observable", value, (*OBSERVABLES, *info.data.get("expressions", ())))

    @field_validator("outputs")
    @classmethod
    def _known_outputs(cls, value: list[str]) -> list[str]:
        if "push" in value:
            raise ValueError(
                "no output 'push', did you mean 'contact': it is positive outward, so the push is contact outside and "
                f"-contact inside; ds.rod.push computes it from the stored arrays; choose from {choices(OUTPUTS)}"
            )
        return _known("output", value, OUTPUTS)

    @field_validator("axes", "sample", "zip", mode="before")
    @classmethod
    def _angles_in_rad(cls, given: Any) -> Any:
        """The fields with angles given as text in rad, a followed axis last."""
        read = parts.read_angles(given)
        if not isinstance(read, dict):
            return read
        return dict(sorted(read.items(), key=lambda item: isinstance(item[1], dict) and item[1].get("follow") is True))

    @model_validator(mode="after")
    def _fits(self, info: ValidationInfo) -> "Study":
        """Take the samples of the context, or of [zip] or [table]; those of [sample] are drawn later (`samples`).

        The context holds "samples", as a dataset stored them, or "folder" of the study's file. Then raise `Misplaced`
        unless the parts of the study fit each other.
        """
        context = info.context or {}
        given = "samples" in context
        self._samples = context["samples"] if given else _samples_of(self, context.get("folder", Path()))
        self._check_base()
        self._check_axes()
        if self.refine is not None:
            refine.check(self)
        else:
            _check_samples(self)
            for name, distribution in self.sample.fields.items() if self.sample else ():
                self._check_unit(distribution, "sample", name)
        self._check_units()
        self._check_equilibrium()
        if self.expressions:
            expressions.check(self)
        for name in self.wanted:
            if name in OBSERVABLES and name not in self.known_observables:
                raise Misplaced(f"{name} needs E, which a rod with EI and GJ does not have: remove it", "observables")
        for number, law in enumerate(self.laws):
            self._check_law(number, law)
        return self

    def _check_base(self) -> None:
        fields = self.fields
        for name in self.base.given:
            if name not in fields:
                why = "Table 1 prints no" if self.reading else f"a study of {self.kind.__name__} has no field"
                raise Misplaced(f"{why} {name!r}{near(name, fields)}; choose from {choices(fields)}", "base", name)

    def _check_axes(self) -> None:
        numeric = [name for name in self.fields if name not in parts.WORDS]
        _check_followed(self)
        for name, axis in self.axes.items():
            if name in self.base.given and axis is not self.follow:
                raise Misplaced(f"{name} is given in base and as an axis: remove one of them", "axes", name)
            if name not in numeric and axis is not self.follow:
                raise no_key("axis", name, numeric, "axes", name)
            self._check_unit(axis, "axes", name)
            if axis.size > parts.MAX_COUNT:
                raise Misplaced(f"{axis.size} values, more than the limit of {parts.MAX_COUNT}", "axes", name)
        if self.size > parts.MAX_CASES:
            raise Misplaced(f"the grid has {self.size} cases, more than the limit of {parts.MAX_CASES}", "axes")

    def _check_unit(self, given: Axis | Distribution, *where: str) -> None:
        """Raise `Misplaced` unless the key unit of an axis or distribution fits its field, the last of `where`."""
        unit = unit_of(parts.quantity_of(where[-1]).name, self.unit_system)
        allowed = [unit, "deg"] if unit == "rad" else [unit]
        if given.unit is not None and given.unit not in allowed:
            why = f"{where[-1]} is in {' or '.join(allowed)}, got unit {given.unit!r}"
            raise Misplaced(why, *where, "unit")

    def _check_units(self) -> None:
        """Raise `Misplaced` for other units than those of Table 1 where a number with such a unit comes from it."""
        given = (*self.base.given, *self.varied)
        rows = {name: parts.quantity_of(name).name for name in TABLE_1 if self.reading and name not in given}
        taken = [name for name, row in rows.items() if unit_of(row, self.unit_system) != unit_of(row, TABLE_UNITS)]
        if taken:
            units = self.unit_system.items()
            others = " and ".join(f"{kind} = {unit!r}" for kind, unit in units if unit != TABLE_UNITS[kind])
            why = f"the numbers of Table 1 are in cm and N: with {others} the study must give {', '.join(taken)} itself"
            raise Misplaced(why, "units")

    def _check_equilibrium(self) -> None:
        if self.equilibrium is not None and (self.reading or self.kind is Start):
            why = "equilibrium selects a solution of an ends problem; it excludes a reading and a start problem"
            raise Misplaced(why, "equilibrium")
        if self.equilibrium is not None and self.held:
            why = f"equilibrium selects among the equilibria under dead loads, got {choices(self.held)}"
            raise Misplaced(why, "equilibrium")

    def _check_law(self, number: int, law: Law) -> None:
        sampled = self.sampled if self.refine is None else ()  # laws are judged on the coarse grid
        lines = [*self.axes, *([SAMPLE] if sampled else [])]
        if law.axis in (*sampled, *lines[len(self.axes) :]):
            is_drawn = "" if law.axis == SAMPLE else f"{law.axis} is sampled, and "
            why = f"{is_drawn}samples have no order in which an observable rises or falls"
            raise Misplaced(f"{why}: a law needs an axis, such as [axes.{sampled[0]}]", "laws", number, "axis")
        if law.axis not in self.axes:
            raise no_key("axis", law.axis, self.axes, "laws", number, "axis")
        for name in law.at:
            if name not in lines or name == law.axis:
                named = choices(axis for axis in lines if axis != law.axis)
                others = f"choose from {named}" if named else "there is none"
                raise Misplaced(f"no other axis {name!r}; {others}", "laws", number, "at")
        for key, names in law.model_dump(include={"observable", "alternatives", "also"}).items():
            try:
                _known("observable", [names] if key == "observable" else names, (*OBSERVABLES, *self.expressions))
            except ValueError as error:
                raise Misplaced(str(error), "laws", number, key) from None
        if law.formulas:
            expressions.check_law(self, number, law)

    @property
    def samples(self) -> Dimension | None:
        """The samples; None if there are none.

        Those of [sample] are drawn when they are first needed; of a refined study they begin as the coarse grid.
        """
        if self._samples is None and self.refine is not None:
            self._samples = refine.coarse(self)
        if self._samples is None and self.sample is not None:
            self._samples = Dimension(SAMPLE, self.sample.points())
        return self._samples

    @property
    def wanted(self) -> list[str]:
        """The observables and expressions to store: those of the study, its laws and its refinement."""
        judged = [name for law in self.laws for name in law.observables]
        used = [name for law in self.laws for formula in law.formulas.values() for name in formula.names]
        stored = [name for name in used if name in OBSERVABLES]
        watched = [name for name in self.refine.watch if name != OUTCOME] if self.refine else []
        every = dict.fromkeys([*self.observables, *self.expressions, *judged, *stored, *watched])
        return [name for name in every if name not in (*self.held, *self.varied)]  # a height that is held is a field

    @property
    def recorded(self) -> list[str]:
        """The columns of the observables: each name, followed by the name of its error if it has one."""
        names = ((name, expressions.error_of(self, name)) for name in self.wanted)
        return [column for pair in names for column in pair if column]

    def under(self, reading: str | None) -> "Study":
        """The same study under another reading; a missing word keeps that of the study. Raises `InputError`."""
        if reading is None:
            return self
        if self.reading is None:
            raise InputError(f"{self.name} does not use Table 1: the reading {reading!r} does not apply")
        return self.model_copy(update={"reading": parse(reading, parse(self.reading)).name})

    def coarse(self) -> "Study":
        """The same study without its refinement: the grid of its axes."""
        return self.model_copy(update={"refine": None}).with_samples(None) if self.refine else self

    def run(self) -> Any:
        """Solve every case and judge the laws, in memory.

        Returns
        -------
        workbench.notebook.StudyRun
            ``ds``, the dataset; ``verdicts``, one for each law; ``plot()`` and ``scene()``. A notebook shows its laws.

        Raises
        ------
        InputError
            For a study that needs too much memory; `workbench run` stores such a study as it is solved.

        Examples
        --------
        >>> from studies import load
        >>> result = load("fig7_1_modulus").run()
        >>> result.verdicts[0]
        ('turns falls along E', 'holds')
        """
        return make("workbench.notebook", "StudyRun", self)

    def dimensions(self) -> Dimensions:
        """The samples, and each axis that is not followed from a start problem."""
        axes = {name: axis.numbers() for name, axis in self.grid.items() if axis is not self.follow}
        return Dimensions.of(axes, self.samples)

    def coordinates(self) -> dict[str, NDArray[np.float64]]:
        """The values of each field that varies and is not followed from a start problem, angles in rad."""
        return self.dimensions().fields

    def case(self) -> Case:
        """The whole grid as one case, of shape (size of each axis, in order); of a followed study the base case.

        Raises `InputError` for a value that the solver refuses.
        """
        return self.case_of(self.dimensions().open())

    def case_of(self, values: Mapping[str, Any]) -> Case:
        """The base case with other values of some fields: numbers, or arrays that broadcast. Raises `InputError`."""
        values = {**self.base.given, **values}
        if self.reading:
            side = values.pop("side", "outside")
            return parse(self.reading).case(values, side)
        return case_from(self.kind, values)


def _known(kind: str, names: list[str], known: Any) -> list[str]:
    """The names, if all are known and none is repeated; raises `ValueError`."""
    for name in names:
        if name not in known:
            raise no_such(kind, name, known)
    if twice := [name for name in names if names.count(name) > 1]:
        raise ValueError(f"the {kind} {twice[0]!r} is given twice")
    return names


def _samples_of(study: StudyData, folder: Path) -> Dimension | None:
    """The samples of [zip] or [table]; None where a study has neither. folder: of its file. Raises `Misplaced`."""
    said = [name for name in SOURCES if getattr(study, name) is not None]
    if study.refine is not None and said:
        raise Misplaced(f"refine and {said[0]} exclude each other: refine adds cases to the grid of the axes", "refine")
    if len(said) > 1:
        raise Misplaced(f"{said[0]} and {said[1]} exclude each other: each gives the samples", said[1])
    if study.table is not None:
        try:
            return Dimension(SAMPLE, case_tables.read(folder / study.table.file, study.table.columns))
        except InputError as error:
            raise Misplaced(str(error), "table", "file") from None
    return None if study.zip is None else Dimension(SAMPLE, _pair(study.zip))


def _pair(lists: Mapping[str, list[float]]) -> dict[str, Values]:
    if not lists or not all(lists.values()):
        empty = [name for name, values in lists.items() if not values]
        raise Misplaced("zip is empty: give at least one field a list of at least one value", "zip", *empty[:1])
    sizes = {name: len(values) for name, values in lists.items()}
    first, size = next(iter(sizes.items()))
    for name, other in sizes.items():
        if other != size:
            counts = f"{size} in {first} and {other} in {name}"
            raise Misplaced(f"the lists of zip are paired and must be equally long, got {counts}", "zip", name)
    if size > MAX_COUNT:
        raise Misplaced(f"{size} values, more than the limit of {MAX_COUNT}", "zip", first)
    return {name: np.array(values) for name, values in lists.items()}


def key_of(study: StudyData, field: str) -> tuple[str, str]:
    """The key of a sampled field in the study's file."""
    table = study.source
    return (table, "file") if table == "table" else (table, field)


def _check_samples(study: StudyData) -> None:
    """Raise `Misplaced` unless every sampled field is a number of the case, given once, and what else is given fits."""
    table, numeric = study.source, [name for name in study.fields if name not in WORDS]
    for name in study.sampled:
        where = key_of(study, name)
        for other, names in (("base", study.base.given), ("axes", study.axes)):
            if name in names:
                raise Misplaced(f"{name} is given in {other} and in {table}: remove one of them", *where)
        if name not in numeric:
            what = "column" if table == "table" else "field"
            more = "; [table] columns names those to be read" if table == "table" else ""
            raise Misplaced(f"no {what} {name!r}{near(name, numeric)}; choose from {choices(numeric)}{more}", *where)
    if not study.sampled:
        return
    if study.followed is not None:
        why = f"a followed axis excludes {table}: it is solved for one base case"
        raise Misplaced(why, "axes", study.followed, "follow")
    if study.axes and study.kind is Ends:
        why = f"the cases of an ends problem are compared along an axis, and those of {table} have no order"
        raise Misplaced(f"{why}: give {choices(study.axes)} in {table} too, or remove {table}", "axes")
    check_equilibrium(study, f"{table} gives {study.samples_count}")


OF_ENDS = ("betaL", "FZ", "MZ", "M3")  # of the ends problem that a start problem solves


def _check_followed(study: StudyData) -> None:
    """Raise `Misplaced` for several followed axes, and for one that the base case cannot be followed along."""
    names = [name for name, axis in study.axes.items() if axis.follow]
    if len(names) > 1:
        raise Misplaced(f"one axis may be followed, got {choices(names)}", "axes", names[1], "follow")
    for name in names:
        if study.varies:
            why = "with weight or friction each case continues from the straight rod, not from the one before it"
            raise Misplaced(f"{why}: remove follow", "axes", name, "follow")
        if study.kind is Start:
            _check_of_a_start(study, name, study.axes[name])
        else:
            _check_of_ends(name, study.axes[name])


def _check_of_ends(name: str, axis: Axis) -> None:
    if axis.is_open:
        give = f"give {name} from, to and count, or values"
        raise Misplaced(f"a followed axis over an ends problem begins at its first value: {give}", "axes", name)
    if axis.size < 2:
        raise Misplaced(f"a followed axis needs at least 2 values, got {axis.size}", "axes", name)
    steps = np.diff(axis.values) if axis.values is not None else np.ones(1)
    if not ((steps > 0).all() or (steps < 0).all()):
        raise Misplaced("the values of a followed axis must rise or fall", "axes", name, "values")


def _check_of_a_start(study: StudyData, name: str, axis: Axis) -> None:
    known = [*OF_ENDS, *(() if study.reading else (field for field in (*ROD, *CYLINDER) if field in study.base.given))]
    known = [field for field in known if field not in WORDS]
    if name in START and name not in known:
        why = f"a start problem has only one solution at each {name}, which is not followed: remove follow"
        raise Misplaced(why, "axes", name, "follow")
    if name not in known or len(study.axes) > 1:
        why = f"over a start problem, follow needs one axis, of {choices(known)}, got {choices(study.axes)}"
        raise Misplaced(f"{why}; give the base by its ends for others", "axes", name, "follow")
    if not axis.is_open:
        key = "values" if axis.values is not None else "from"
        raise Misplaced(f"a followed axis starts at the value of the base case: leave out {key}", "axes", name, key)
