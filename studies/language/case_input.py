"""One case from a study file, from Table 1, or from fields by name."""

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import MISSING, dataclass, field
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from solver import Case, Ends, InputError, Rod, Start
from solver.nodes.growth import ENDS_AT, LOADS
from solver.problem.case import DIRECT, ELASTIC, TWISTS, fields_to_add
from solver.problem.declared_fields import PAIRS, PARTS, REPLACED, TILTS, WOUND, CaseField, rivals
from solver.problem.errors import choices, no_such
from solver.problem.field_values import doubt_size, is_met, is_said
from solver.problem.limits import farthest
from solver.problem.notices import UnitWarning, warn
from solver.problem.quantities import unit_of
from solver.problem.units import FORCES, LENGTHS, UnknownUnit, base_unit, dimension_of, split, unit_size

from ..grammar.axes import DEFAULT_UNITS, WORDS, Which, case_from, in_words, number_with_unit, quantity_of
from .loader import load
from .printed import as_reading
from .study import Study
from .wells_and_cables import START_ONLY, of_a_well, under_start_force, unwound

ENDS_ONLY = {*PARTS["ends"]} - {*PARTS["start"]}
OF_MODULUS = (*ELASTIC, "inner_radius")  # the fields of a section of one material

OPTIONS = "the options"  # the source of a case of fields alone


@dataclass(frozen=True)
class CaseInput:
    """A case, its units, and where its numbers come from.

    Attributes
    ----------
    source
        The file, Table 1 or the options, in words.
    title
        Of a study of this case alone: that of the study of the file, with what differs; of fields alone their sizes;
        else what `source` says.
    assumed
        Field -> default value, of the fields that the input did not give.
    study
        The study of the file; None for a case of Table 1 or of fields alone.
    which
        Which equilibrium is meant: that of the study, or the helix of a rod that is wound, without weight and friction.
    wound
        Whether its ends are those of a rod that is wound as a helix.
    place
        Field -> value, where on the axes of the study the case was taken.
    stand_ins
        Field -> number, of what was given in place of fields of the case, as `hole` in place of `inclination`; of a
        file whose fields are changed only the force, which holds: others may no longer describe the case.
    """

    case: Case
    units: dict[str, str]
    source: str
    assumed: dict[str, Any] = field(default_factory=dict)
    study: Study | None = None
    which: Which | None = None
    wound: bool = False
    place: dict[str, float] = field(default_factory=dict)
    stand_ins: dict[str, float] = field(default_factory=dict)
    title: str = ""

    def __post_init__(self) -> None:
        if not self.title:
            title = _in_words(self.case, self.units) if self.source == OPTIONS else f"One rod, from {self.source}"
            object.__setattr__(self, "title", title)


def read_case(
    file: Path | None,
    values: Mapping[str, Any],
    units: Mapping[str, str],
    table1: bool = False,
    reading: str | None = None,
    problem: type | None = None,
) -> CaseInput:
    """A case from a file, from Table 1, or from fields alone.

    Parameters
    ----------
    file
        A TOML study without axes.
    values
        Fields of the case by name, numbers or texts with a unit; they replace those of the file or of Table 1.
    units
        "length" and "force" of the values, for a case of fields alone; default: `units_said`, else cm and N.
    table1
        Start from the rod of Table 1, as of `is_table1`.
    reading
        How Table 1 is read.
    problem
        Of fields alone, as of `from_values`.

    Raises
    ------
    InputError
        For two sources at once, a file with axes, a missing or unknown field, an unknown unit or an invalid value.
    """
    changed = f", except {choices(values)}" if values else ""
    if file is not None:
        check_alone(file, units, table1)
        return case_of_study(_study(file).under(reading), values, file.name)
    if is_table1(values, units, table1 or reading is not None):
        read = as_reading(reading)
        return CaseInput(
            with_values(read.case(), in_units(values, DEFAULT_UNITS), DEFAULT_UNITS),
            dict(DEFAULT_UNITS),
            f"Table 1, read {read.name}{changed}",
        )
    numbers, units, assumed_units = numbers_alone(values, units)
    case, assumed = from_values(unwound(of_a_well(numbers, {})), problem)
    assumed |= assumed_units
    case = _case_of(*under_start_force(case, numbers, units["force"]), units)
    wound = bool(set(WOUND) & set(values))
    which = None  # with weight or friction `solve` begins with the taut rod, off the wall with the bilateral shape
    if wound and not (case.varies or case.leaves):
        which = helix_of(case)
    stand_ins = stand_ins_of(values, units)
    return CaseInput(case, units, OPTIONS, assumed, which=which, wound=wound, stand_ins=stand_ins)


def case_of_study(
    study: Study, values: Mapping[str, Any], named: str, place: Mapping[str, float] | None = None
) -> CaseInput:
    """The case of a study at a place on its axes; of one that follows an equilibrium its base case.

    values: fields that replace those of the case. named: what it comes from, in words. Raises `InputError`.
    """
    place, units, followed = dict(place or {}), study.unit_system, study.variation.from_base
    case = study.case() if followed else study.case_of(place)
    given = {**study.base.given, **place}
    changes = values if followed else force_kept(given, values) | dict(values)
    changed = f", except {choices(values)}" if values else ""
    return CaseInput(
        with_values(case, in_units(changes, units), units),
        units,
        f"{named}{changed}",
        study=study,
        which=study.equilibrium,
        place=place,
        stand_ins=stand_ins_of(changes if values else given, units),
        title=", ".join([study.title, *(in_words(field, value) for field, value in place.items())]) + changed,
    )


def is_table1(values: Mapping[str, Any], units: Mapping[str, str], asked: bool) -> bool:
    """Whether fields change the rod of Table 1: where it is asked for, and where nothing else is given.

    Else they describe the whole rod, and loads that are omitted are 0. Raises `InputError` for units of Table 1.
    """
    if asked and units:
        raise InputError("Table 1 is in cm and N: omit the units")
    return asked or not (values or units)


def numbers_alone(
    values: Mapping[str, Any], units: Mapping[str, str]
) -> tuple[dict[str, Any], dict[str, str], dict[str, str]]:
    """Fields that describe a whole rod as numbers, their units, and which of these are assumed. Raises `InputError`.

    units: "length" and "force", where they are stated; default: `units_said`, else cm and N.
    """
    check_units(units)
    units = units_said(values, units) | dict(units)
    assumed = {f"unit of {kind}": unit for kind, unit in DEFAULT_UNITS.items() if kind not in units}
    units = {**DEFAULT_UNITS, **units}
    return in_units(values, units), units, assumed


def _in_words(case: Case, units: Mapping[str, str]) -> str:
    """``A rod 1500 mm long, of diameter 2 mm, on a cylinder of diameter 120 mm``."""
    rod, wall, unit = case.rod, case.cylinder, units["length"]
    where = "inside" if wall.side == "inside" else "on"
    thin, inches = ("in", LENGTHS["ft"] / LENGTHS["in"]) if unit == "ft" else (unit, 1.0)  # of radii, as tables
    sizes = (rod.L, unit), (2 * rod.a * inches, thin), (2 * wall.R * inches, thin)
    long, across, wide = (f"{f'{size:.0f}' if 1e4 <= size < 1e10 else f'{size:.4g}'} {each}" for size, each in sizes)
    return f"A rod {long} long, of diameter {across}, {where} a cylinder of diameter {wide}"


def stand_ins_of(values: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, float]:
    """The fields among values that stand in place of others, as numbers."""
    return in_units({name: values[name] for name in REPLACED if name in values}, units)


def in_units(values: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    """The values of fields with each text such as ``2.5in`` as a number in these units.

    A `UnitWarning` says of a plain number that it may be meant in another unit. Raises `InputError`.
    """
    try:
        numbers = {name: number_with_unit(name, value, units) for name, value in values.items()}
    except ValueError as error:
        raise InputError(str(error)) from None
    for name, value in values.items():
        if sentence := doubt_size(name, value, units, values):
            warn(sentence, UnitWarning)
    return numbers


def units_said(values: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, str]:
    """The units in which all values are given that the units do not count: none where one of these is a plain number.

    units: of "length" and "force", where they are stated. Of several units that of the length L, or of a force, is
    taken. The number 0 has every unit.
    """
    said: dict[str, str] = {}
    for kind, place, first in (("length", 0, "L"), ("force", 1, "FZ")):
        counted = [
            name
            for name, value in values.items()
            if kind not in units and name not in WORDS and value != 0 and dimension_of(name)[place]
        ]
        if any(not isinstance(values[name], str) for name in counted):
            return {}
        counted.sort(key=lambda name: (name != first, dimension_of(name) != dimension_of(first)))
        named = [base_unit(kind, split(values[name])[1]) for name in counted]
        said.update([(kind, unit) for unit in named if unit][:1])
    return said


def check_alone(file: Path, units: Mapping[str, str], table1: bool = False) -> None:
    """Raise `InputError` for units, or Table 1, beside a file, and for a unit in place of a file."""
    if not file.exists():
        with suppress(UnknownUnit):
            unit_size(str(file))
            raise InputError(f"{file} stands apart from its number: write both as one word, 5{file}, or in quotes")
    if table1:
        raise InputError(f"{file.name} and --table1 exclude each other: each describes a whole rod")
    if units:
        raise InputError(f"{file.name} states its own units: change them in the file")


def check_units(units: Mapping[str, str]) -> None:
    """Raise `InputError` for an unknown unit of length or force."""
    for kind, known in (("length", LENGTHS), ("force", FORCES)):
        if units.get(kind, "") not in ("", *known):
            raise no_such(f"unit of {kind}", units[kind], known)


def _study(file: Path) -> Study:
    if file.suffix.lower() != ".toml":
        raise InputError(f"a case is read from a .toml file, got {str(file)!r}")
    study = load(file)
    if study.variation.fields:
        raise InputError(f"{file.name} has {study.variation.words}: use workbench run to solve it")
    return study


def from_values(values: Mapping[str, Any], problem: type | None = None) -> tuple[Case, dict[str, Any]]:
    """A case of fields alone, and the defaults of the fields that were omitted.

    Parameters
    ----------
    values
        Fields of the rod, the cylinder and the start or the ends, by name.
    problem
        `Start` or `Ends`; default: decided by the names of the values.

    Returns
    -------
    The case, and the defaults that it took, field -> value. Only loads, alpha, gamma, stiffness and side have one.

    Raises
    ------
    InputError
        For missing fields, which it lists, and for fields of both a start and the ends.
    """
    problem = _problem(values) if problem is None else problem
    known = PARTS["rod"] | PARTS["cylinder"] | PARTS[problem.__name__.lower()]
    _check_complete(problem, known, values)
    case = case_from(problem, {name: values[name] for name in known if name in values})
    taken = {row.in_place_of for name, row in known.items() if name in values}
    assumed = {
        name: row.default
        for name, row in known.items()
        if name not in values and name not in taken and is_said(name, row.default) and is_met(name, values)
    }
    return case, assumed


def helix_of(case: Case) -> Which:
    """The helix between the ends of a case, by its energy, that of `observables.energy`."""
    A, C, rho, (FZ, MZ, M3) = case.rod.bending_stiffness, case.rod.torsional_stiffness, case.rho, case.loads
    beta = field_values(case)["beta0"]
    s, c = math.sin(beta), math.cos(beta)
    density = A / 2 * s**4 / rho**2 + M3 * s * c / rho - FZ * c - MZ * s / rho - M3**2 / (2 * C)
    return Which(index=None, dbeta0=0.0, energy=float(density * case.rod.L))


def force_kept(given: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """What fields give in place of FZ, by name, that changes of other fields leave as it is; {} where none is.

    A case of these fields has the FZ that belongs to its former length, weight and friction.
    """
    named = [name for name in ("wob", "FZ0") if name in given]
    return {name: given[name] for name in named if not {name, *rivals(name)} & {*changes}}


def with_values(case: Case, values: Mapping[str, Any], units: Mapping[str, str]) -> Case:
    """The case with some fields replaced, those of `of_a_well` too. Raises `InputError`."""
    known = {name: value for name, value in fields_of(case).items() if value is not None}
    return _case_of(*under_start_force(with_fields(case, of_a_well(values, known)), values, units["force"]), units)


def case_to_solve(study: Study, values: Mapping[str, Any]) -> Case:
    """The case of `Study.case_to_solve`. Raises `InputError` where no FZ was found, too."""
    return _case_of(*study.case_to_solve(values), study.unit_system)


def _case_of(case: Case, why: NDArray[Any], units: Mapping[str, str]) -> Case:
    """The case; raises `InputError` where a reason says why no FZ was found."""
    for reason in filter(None, why.flat):
        raise InputError(with_unit(reason.removeprefix("failed: "), case, units))
    return case


def with_fields(case: Case, changes: Mapping[str, Any]) -> Case:
    """The case with some fields replaced; a new F1, dgamma or M3 of a start replaces the other two, a new
    load or end angle what is held in its place, and the other way round.

    New EI and GJ replace E, nu and inner_radius, and the other way round.

    Raises `InputError` for a field that the case does not have.
    """
    values = fields_of(case)
    for name in changes:
        if name not in values:
            kind, names = _name(type(case.given)), choices(PARTS[case.kind])
            raise InputError(f"this case is {kind}, which has no {name}; choose from {names}")
    groups = (TWISTS,) if isinstance(case.given, Start) else (*PAIRS, *TILTS)
    replaced = {*_other_section(changes), *(name for group in groups if {*group} & {*changes} for name in group)}
    kept = {name: value for name, value in values.items() if value is not None and name not in replaced}
    return case_from(type(case.given), {**kept, **changes})


def field_values(case: Case) -> dict[str, Any]:
    """The fields of a case by name, as plain numbers and words; without those that are None."""
    values = fields_of(case)
    said = {name: value for name, value in values.items() if is_said(name, value) and is_met(name, values)}
    return {name: value if isinstance(value, str) else float(value) for name, value in said.items()}


def fields_of(case: Case) -> dict[str, Any]:
    """Every field of a case by name, None where it is not given."""
    return {name: getattr(part, name) for part in (case.rod, case.cylinder, case.given) for name in part.__match_args__}


def with_unit(sentence: str, case: Case, units: Mapping[str, str]) -> str:
    """A sentence of the solver on one case, with the unit behind an extreme value or a load at s = L."""
    force = units["force"]
    bound = r"((?:above|up to|less than|more than) [-+.\de]+)"
    sentence = re.sub(rf"{bound}( at s = L \(FZ = [-+.\de]+)", rf"\1 {force}\2 {force}", sentence)
    FZ = getattr(case.given, "FZ", None)
    if FZ and (ended := re.search(rf"{ENDS_AT} ([-+.\de]+) of the way to {LOADS}", sentence)):
        reached = f" (FZ = {float(ended[1]) * FZ:.4g} {force}; give a smaller load)"
        sentence = f"{sentence[: ended.end()]}{reached}{sentence[ended.end() :]}"
    name, value = (part[0] for part in farthest(case))
    unit, said = unit_of(quantity_of(name).name, units), f"{name} = {value:g}"
    return sentence if unit == "1" else sentence.replace(said, f"{said} {unit}")


def _other_section(changes: Mapping[str, Any]) -> tuple[str, ...]:
    """The fields of a rod's section that the changes replace."""
    elastic, direct = ({*names} & {*changes} for names in (OF_MODULUS, DIRECT))
    if bool(elastic) == bool(direct):  # neither, or a mixture, which `Rod` refuses
        return ()
    return DIRECT if elastic else (*OF_MODULUS, "stiffness")


def _problem(values: Mapping[str, Any]) -> type:
    """Start or Ends, by the names that only one of them has."""
    start, ends = ([name for name in values if name in names] for names in (START_ONLY, ENDS_ONLY))
    if start and ends:
        raise InputError(
            f"a case is a start problem or an ends problem, not both: {start[0]} is a field of the start, "
            f"{ends[0]} of the ends"
        )
    return Ends if ends else Start


def _check_complete(problem: type, known: Mapping[str, CaseField], values: Mapping[str, Any]) -> None:
    section = {name: values[name] for name in PARTS["rod"] if name in values}
    if set(OF_MODULUS) & set(section) and set(DIRECT) & set(section):
        Rod(**section)  # which refuses two sections
    missing = fields_to_add(section)
    missing += [name for name, row in known.items() if row.omitted is MISSING and name not in values]
    if problem is Ends:
        missing += [f"{end} (or {other})" for end, other in PAIRS[:2] if end not in values and other not in values]
    if problem is Start and not any(name in values for name in TWISTS):
        missing.append(f"one of {choices(TWISTS)}")
    if missing:
        undecided = problem is Start and not START_ONLY & set(values)
        other = "; an ends problem needs beta0 and betaL instead" if undecided else ""
        said = f"{choices(missing[:-1])} and {missing[-1]}" if len(missing) > 1 else missing[0]
        raise InputError(f"{_name(problem)} also needs {said}{other}; --table1 takes the rod of Table 1")


def _name(problem: type) -> str:
    return "a start problem" if problem is Start else "an ends problem"
