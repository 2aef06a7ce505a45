"""Fields that vary together, a value of each for every sample ([sample], [zip], [table]), and a followed axis."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from solver import Ends, Start
from solver.problem.errors import InputError, choices, near

from ..grammar.axes import CYLINDER, MAX_COUNT, ROD, START, WORDS, Axis, Misplaced
from ..grammar.dimensions import SAMPLE, Dimension, Values
from . import case_tables
from .study_data import StudyData

SOURCES = ("sample", "zip", "table")  # the tables of a study that give them


def given(study: StudyData, folder: Path) -> Dimension | None:
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


def source(study: StudyData) -> str:
    """The table of the study that gives the samples."""
    return next((name for name in SOURCES if getattr(study, name) is not None), SAMPLE)


def key(study: StudyData, field: str) -> tuple[str, str]:
    """The key of a sampled field in the study's file."""
    table = source(study)
    return (table, "file") if table == "table" else (table, field)


def check(study: StudyData) -> None:
    """Raise `Misplaced` unless every sampled field is a number of the case, given once, and what else is given fits."""
    table, numeric = source(study), [name for name in study.fields if name not in WORDS]
    for name in study.sampled:
        where = key(study, name)
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


def check_equilibrium(study: StudyData, several: str) -> None:
    """Raise `Misplaced` where a study of several cases, as the words say, names the equilibrium of one."""
    if study.equilibrium is not None and study.equilibrium.dbeta0 is not None:
        why = f"dbeta0 and energy name the equilibrium of one case, and {several}: give choose or index"
        raise Misplaced(why, "equilibrium", "dbeta0")


def tell(study: StudyData) -> str:
    """Where the samples of a study come from, in one sentence; empty where there are none."""
    if not study.sampled:
        return ""
    if study.refine is not None:
        return ""
    count = f"{study.samples_count} sample{'s' * (study.samples_count != 1)} of {choices(study.sampled)}"
    if study.sample is not None:
        return f"{count}: {study.sample.sentence}"
    return f"{count}, from {study.table.file if study.table is not None else 'the lists of zip'}"


def caution(study: StudyData) -> str:
    """A sentence on a size that does not suit the method of sampling; empty where there is nothing to say."""
    return study.sample.caution if study.sample is not None else ""


OF_ENDS = ("betaL", "FZ", "MZ", "M3")  # of the ends problem that a start problem solves


def check_followed(study: StudyData) -> None:
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
