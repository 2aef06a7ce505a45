"""Whether the parts of a study fit each other; and its samples from [zip] or [table]."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from solver import Ends, InputError, Start
from solver.observe.observables import OBSERVABLES
from solver.problem.errors import choices, near
from solver.problem.quantities import unit_of

from ..grammar.axes import (
    CYLINDER,
    DEFAULT_UNITS,
    MAX_CASES,
    MAX_COUNT,
    ROD,
    SAMPLE,
    START,
    WORDS,
    Axis,
    Dimension,
    Misplaced,
    Values,
    check_names,
    no_key,
    quantity_of,
)
from ..laws.judgement import Law
from . import case_tables, expressions, refine_table
from .printed import table_of
from .refine_table import check_equilibrium
from .samples import Distribution
from .study import Study
from .variation import SOURCES


def check(study: Study) -> None:
    """Raise `Misplaced` unless the parts of the study fit each other."""
    _check_base(study)
    _check_axes(study)
    if study.refine is not None:
        refine_table.check(study)
    else:
        _check_samples(study)
        for name, distribution in study.sample.fields.items() if study.sample else ():
            _check_unit(study, distribution, "sample", name)
    _check_units(study)
    _check_equilibrium(study)
    if study.expressions:
        expressions.check(study)
    known = study.known_observables
    for name in study.wanted:
        if name in OBSERVABLES and name not in known:
            raise Misplaced(f"{name} needs E, which a rod with EI and GJ does not have: remove it", "observables")
    for number, law in enumerate(study.laws):
        _check_law(study, number, law)


def read_samples(study: Study, folder: Path) -> Dimension | None:
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


def _source(study: Study) -> str:
    """The table of the study that gives the samples."""
    return next((name for name in SOURCES if getattr(study, name) is not None), SAMPLE)


def key_of(study: Study, field: str) -> tuple[str, str]:
    """The key of a sampled field in the study's file."""
    table = _source(study)
    return (table, "file") if table == "table" else (table, field)


def _check_base(study: Study) -> None:
    """Raise `Misplaced` for a field that a study of its kind has not."""
    fields = study.fields
    for name in study.base.given:
        if name not in fields:
            kind = "an ends problem" if study.kind is Ends else "a start problem"
            why = "Table 1 prints no" if study.reading else f"{kind} has no field"
            raise Misplaced(f"{why} {name!r}{near(name, fields)}; choose from {choices(fields)}", "base", name)


def _check_axes(study: Study) -> None:
    """Raise `Misplaced` unless each axis is one of a number that base leaves open, and the grid is not too large."""
    numeric = [name for name in study.fields if name not in WORDS]
    _check_followed(study)
    for name, axis in study.axes.items():
        if name in study.base.given and not axis.from_base:
            raise Misplaced(f"{name} is given in base and as an axis: remove one of them", "axes", name)
        if name not in numeric and not axis.from_base:
            raise no_key("axis", name, numeric, "axes", name)
        _check_unit(study, axis, "axes", name)
        if axis.size > MAX_COUNT:
            raise Misplaced(f"{axis.size} values, more than the limit of {MAX_COUNT}", "axes", name)
    if study.variation.size > MAX_CASES:
        raise Misplaced(f"the grid has {study.variation.size} cases, more than the limit of {MAX_CASES}", "axes")


def _check_unit(study: Study, given: Axis | Distribution, *where: str) -> None:
    """Raise `Misplaced` unless the key unit of an axis or distribution fits its field, the last of `where`."""
    unit = unit_of(quantity_of(where[-1]).name, study.unit_system)
    allowed = [unit, "deg"] if unit == "rad" else [unit]
    if given.unit is not None and given.unit not in allowed:
        why = f"{where[-1]} is in {' or '.join(allowed)}, got unit {given.unit!r}"
        raise Misplaced(why, *where, "unit")


def _check_units(study: Study) -> None:
    """Raise `Misplaced` for other units than those of Table 1 where a number with such a unit comes from it."""
    given = (*study.base.given, *study.variation.fields)
    rows = {name: quantity_of(name).name for name in table_of(study.reading) if name not in given}
    taken = [name for name, row in rows.items() if unit_of(row, study.unit_system) != unit_of(row, DEFAULT_UNITS)]
    if taken:
        units = study.unit_system.items()
        others = " and ".join(f"{kind} = {unit!r}" for kind, unit in units if unit != DEFAULT_UNITS[kind])
        why = f"the numbers of Table 1 are in cm and N: with {others} the study must give {', '.join(taken)} itself"
        raise Misplaced(why, "units")


def _check_equilibrium(study: Study) -> None:
    """Raise `Misplaced` where the key equilibrium has no equilibria to choose from."""
    if study.equilibrium is not None and (study.reading or study.kind is Start):
        why = "equilibrium selects a solution of an ends problem; it excludes a reading and a start problem"
        raise Misplaced(why, "equilibrium")
    if study.equilibrium is not None and study.equilibrium.rule is None and study.held:
        why = (
            f"dbeta0 and energy name one of a complete list, which {choices(study.held)} has not: give choose or index"
        )
        raise Misplaced(why, "equilibrium", "dbeta0")


def _check_law(study: Study, number: int, law: Law) -> None:
    """Raise `Misplaced` unless axes and observables of a law are those of the study."""
    sampled = study.variation.sampled if study.refine is None else ()  # a refined study has its axes
    lines = [*study.axes, *([SAMPLE] if sampled else [])]
    if law.axis in (*sampled, *lines[len(study.axes) :]):
        is_drawn = "" if law.axis == SAMPLE else f"{law.axis} is sampled, and "
        why = f"{is_drawn}samples have no order in which an observable rises or falls"
        raise Misplaced(f"{why}: a law needs an axis, such as [axes.{sampled[0]}]", "laws", number, "axis")
    if law.axis not in study.axes:
        raise no_key("axis", law.axis, study.axes, "laws", number, "axis")
    for name in law.at:
        if name not in lines or name == law.axis:
            named = choices(axis for axis in lines if axis != law.axis)
            others = f"choose from {named}" if named else "there is none"
            raise Misplaced(f"no other axis {name!r}; {others}", "laws", number, "at")
    for key, names in law.model_dump(include={"observable", "alternatives", "also"}).items():
        try:
            check_names("observable", [names] if key == "observable" else names, (*OBSERVABLES, *study.expressions))
        except ValueError as error:
            raise Misplaced(str(error), "laws", number, key) from None
    if law.formulas:
        expressions.check_law(study, number, law)


def _check_samples(study: Study) -> None:
    """Raise `Misplaced` unless every sampled field is a number of the case, given once, and what else is given fits."""
    table, numeric = _source(study), [name for name in study.fields if name not in WORDS]
    for name in study.variation.sampled:
        where = key_of(study, name)
        for other, names in (("base", study.base.given), ("axes", study.axes)):
            if name in names:
                raise Misplaced(f"{name} is given in {other} and in {table}: remove one of them", *where)
        if name not in numeric:
            what = "column" if table == "table" else "field"
            more = "; [table] columns names those to be read" if table == "table" else ""
            raise Misplaced(f"no {what} {name!r}{near(name, numeric)}; choose from {choices(numeric)}{more}", *where)
    given = study.variation.given
    if given is None:
        return
    if study.variation.followed is not None:
        why = f"a followed axis excludes {table}: it is solved for one base case"
        raise Misplaced(why, "axes", study.variation.followed, "follow")
    if study.axes and study.kind is Ends:
        why = f"the cases of an ends problem are compared along an axis, and those of {table} have no order"
        raise Misplaced(f"{why}: give {choices(study.axes)} in {table} too, or remove {table}", "axes")
    check_equilibrium(study, f"{table} gives {given.size}")


OF_ENDS = ("betaL", "FZ", "MZ", "M3")  # of the ends problem that a start problem solves


def _check_followed(study: Study) -> None:
    """Raise `Misplaced` for several followed axes, and for one that the base case cannot be followed along."""
    names = [name for name, axis in study.axes.items() if axis.follow]
    if len(names) > 1:
        raise Misplaced(f"one axis may be followed, got {choices(names)}", "axes", names[1], "follow")
    for name in names:
        if study.leaves or study.varies:
            why = "with weight or friction each case continues from the straight rod, not from the one before it"
            if study.leaves:
                why = (
                    "a rod that may leave the cylinder continues from its own bilateral shape, not from the case before"
                )
            raise Misplaced(f"{why}: remove follow", "axes", name, "follow")
        if study.kind is Start:
            _check_of_a_start(study, name, study.axes[name])
        else:
            _check_of_ends(name, study.axes[name])


def _check_of_ends(name: str, axis: Axis) -> None:
    if axis.from_base:
        give = f"give {name} from, to and count, or values"
        raise Misplaced(f"a followed axis over an ends problem begins at its first value: {give}", "axes", name)
    if axis.size < 2:
        raise Misplaced(f"a followed axis needs at least 2 values, got {axis.size}", "axes", name)
    steps = np.diff(axis.values) if axis.values is not None else np.ones(1)
    if not ((steps > 0).all() or (steps < 0).all()):
        raise Misplaced("the values of a followed axis must rise or fall", "axes", name, "values")


def _check_of_a_start(study: Study, name: str, axis: Axis) -> None:
    known = [*OF_ENDS, *(() if study.reading else (field for field in (*ROD, *CYLINDER) if field in study.base.given))]
    known = [field for field in known if field not in WORDS]
    if name in START and name not in known:
        why = f"a start problem has only one solution at each {name}, which is not followed: remove follow"
        raise Misplaced(why, "axes", name, "follow")
    if name not in known or len(study.axes) > 1:
        why = f"over a start problem, follow needs one axis, of {choices(known)}, got {choices(study.axes)}"
        raise Misplaced(f"{why}; give the base by its ends for others", "axes", name, "follow")
    if not axis.from_base:
        key = "values" if axis.values is not None else "from"
        raise Misplaced(f"a followed axis starts at the value of the base case: leave out {key}", "axes", name, key)
