"""A study: units, a reading of Table 1, a base case, axes, observables, outputs, and laws."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationInfo, field_validator, model_validator

from solver import Case, Cylinder, InputError, Rod, Start
from solver.observe.observables import OBSERVABLES
from solver.problem.case import from_fields
from solver.problem.errors import choices, near, no_such
from solver.problem.quantities import unit_of
from solver.problem.shown import make

from ..grammar import axes as parts
from ..grammar.axes import CYLINDER, ROD, Axis, Misplaced, no_key
from ..grammar.dimensions import SAMPLE, Dimension, Dimensions
from . import expressions, paired, refine
from .lattice import OUTCOME
from .readings import TABLE_1, TABLE_UNITS, Reading, parse
from .samples import Distribution
from .study_data import OUTPUTS, StudyData


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
    def _samples_found(self, info: ValidationInfo) -> "Study":
        """The samples of the context, or of [zip] or [table]; those of [sample] are drawn later (`samples`).

        The context holds "samples", as a dataset stored them, or "folder" of the study's file.
        """
        context = info.context or {}
        given = "samples" in context
        self._samples = context["samples"] if given else paired.given(self, context.get("folder", Path()))
        return self

    @model_validator(mode="after")
    def _base_fits(self) -> "Study":
        fields = self.fields
        for name in self.base.given:
            if name not in fields:
                why = "Table 1 prints no" if self.reading else f"a study of {self.kind.__name__} has no field"
                raise Misplaced(f"{why} {name!r}{near(name, fields)}; choose from {choices(fields)}", "base", name)
        return self

    @model_validator(mode="after")
    def _axes_fit(self) -> "Study":
        numeric = [name for name in self.fields if name not in parts.WORDS]
        paired.check_followed(self)
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
        return self

    @model_validator(mode="after")
    def _samples_fit(self) -> "Study":
        if self.refine is not None:
            refine.check(self)
            return self
        paired.check(self)
        for name, distribution in self.sample.fields.items() if self.sample else ():
            self._check_unit(distribution, "sample", name)
        return self

    def _check_unit(self, given: Axis | Distribution, *where: str) -> None:
        """Raise `Misplaced` unless the key unit of an axis or distribution fits its field, the last of `where`."""
        unit = unit_of(parts.quantity_of(where[-1]).name, self.unit_system)
        allowed = [unit, "deg"] if unit == "rad" else [unit]
        if given.unit is not None and given.unit not in allowed:
            why = f"{where[-1]} is in {' or '.join(allowed)}, got unit {given.unit!r}"
            raise Misplaced(why, *where, "unit")

    @model_validator(mode="after")
    def _units_fit(self) -> "Study":
        """Other units than those of Table 1 only where no number with such a unit comes from the table."""
        if not self.reading:
            return self
        given = (*self.base.given, *self.varied)
        taken = [name for name in TABLE_1 if name not in given and self._has_other_unit(name)]
        if taken:
            units = self.unit_system.items()
            others = " and ".join(f"{kind} = {unit!r}" for kind, unit in units if unit != TABLE_UNITS[kind])
            why = f"the numbers of Table 1 are in cm and N: with {others} the study must give {', '.join(taken)} itself"
            raise Misplaced(why, "units")
        return self

    def _has_other_unit(self, field: str) -> bool:
        """Whether the unit of a field is another one than in Table 1."""
        name = parts.quantity_of(field).name
        return unit_of(name, self.unit_system) != unit_of(name, TABLE_UNITS)

    @model_validator(mode="after")
    def _equilibrium_fits(self) -> "Study":
        if self.equilibrium is not None and (self.reading or self.kind is Start):
            why = "equilibrium selects a solution of an ends problem; it excludes a reading and a start problem"
            raise Misplaced(why, "equilibrium")
        if self.equilibrium is not None and self.held:
            why = f"equilibrium selects among the equilibria under dead loads, got {choices(self.held)}"
            raise Misplaced(why, "equilibrium")
        return self

    @model_validator(mode="after")
    def _expressions_fit(self) -> "Study":
        if self.expressions:
            expressions.check(self)
        return self

    @model_validator(mode="after")
    def _observables_fit(self) -> "Study":
        for name in self.wanted:
            if name in OBSERVABLES and name not in self.known_observables:
                raise Misplaced(f"{name} needs E, which a rod with EI and GJ does not have: remove it", "observables")
        return self

    @model_validator(mode="after")
    def _laws_fit(self) -> "Study":
        sampled = self.sampled if self.refine is None else ()  # laws are judged on the coarse grid
        lines = [*self.axes, *([SAMPLE] if sampled else [])]
        for i, law in enumerate(self.laws):
            if law.axis in (*sampled, *lines[len(self.axes) :]):
                is_drawn = "" if law.axis == SAMPLE else f"{law.axis} is sampled, and "
                why = f"{is_drawn}samples have no order in which an observable rises or falls"
                raise Misplaced(f"{why}: a law needs an axis, such as [axes.{sampled[0]}]", "laws", i, "axis")
            if law.axis not in self.axes:
                raise no_key("axis", law.axis, self.axes, "laws", i, "axis")
            for name in law.at:
                if name not in lines or name == law.axis:
                    named = choices(axis for axis in lines if axis != law.axis)
                    others = f"choose from {named}" if named else "there is none"
                    raise Misplaced(f"no other axis {name!r}; {others}", "laws", i, "at")
            for key, names in (
                ("observable", [law.observable]),
                ("alternatives", law.alternatives),
                ("also", law.also),
            ):
                try:
                    _known("observable", names, (*OBSERVABLES, *self.expressions))
                except ValueError as error:
                    raise Misplaced(str(error), "laws", i, key) from None
            if law.formulas:
                expressions.check_law(self, i, law)
        return self

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

    def with_sample(self, place: int) -> "Study":
        """The same study with one of its samples, which keeps its number."""
        assert self.samples is not None
        return self.with_samples(self.samples.only(np.array([place])))

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
        rod, cylinder = ({k: values[k] for k in names if k in values} for names in (ROD, CYLINDER))
        given = {k: v for k, v in values.items() if k not in (*ROD, *CYLINDER)}
        return Case(from_fields(Rod, rod), from_fields(Cylinder, cylinder), from_fields(self.kind, given))


def reading_of(study: Study) -> Reading | None:
    """The reading of a study, or None where it does not use Table 1."""
    return parse(study.reading) if study.reading else None


def _known(kind: str, names: list[str], known: Any) -> list[str]:
    """The names, if all are known and none is repeated; raises `ValueError`."""
    for name in names:
        if name not in known:
            raise no_such(kind, name, known)
    if twice := [name for name in names if names.count(name) > 1]:
        raise ValueError(f"the {kind} {twice[0]!r} is given twice")
    return names
