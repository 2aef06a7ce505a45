"""The command loops: closed rods on the cylinder, listed, drawn and stored."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.errors import InputError
from solver.problem.quantities import current

from . import console, tables
from .case_options import ROD_FIELDS, GivenOptions
from .options import Table1, argument, flag, option
from .present import Result, presents
from .tables import unit_printed

if TYPE_CHECKING:
    from solver import Cylinder, Loop, Rod

MOST_FOLDS = 50
OWN = {"folds": "", "about": "rad", "lam": ""}  # units of the columns that are no quantities
COLUMNS = ("turns_around", "folds", "about", "lam", "energy", "index", "push_min", "push_max", "attached")


@presents(
    "Picture of the unrolled views, .png, .pdf or .svg.",
    "HDF5 file of the loops, which scene and export read.",
    kind="equilibria",
    force="Replace an existing picture, and the file of --out even if it holds no loops.",
    short="plot",
    case=ROD_FIELDS,
)
def loops(
    file: Annotated[Path | None, argument("FILE", "TOML study of one rod; default: the rod of Table 1.")] = None,
    table1: Table1 = False,
    *,
    given: GivenOptions,
    turns_around: Annotated[int, option("COUNT", "Turns of the closed rod around the axis.")] = 1,
    wraps: Annotated[int | None, option("COUNT", "Former name of --turns-around.", hidden=True)] = None,
    folds: Annotated[
        str, option("COUNT[,COUNT...]", "Periods of the angle along the closed rod, one or several numbers.")
    ] = "1,2,3",
    all_of_them: Annotated[
        bool, flag("List also the loops that oscillate about -pi/2; they intersect themselves.", "--all")
    ] = False,
    export: Annotated[
        Path | None, option("FOLDER", "Folder for one TOML file per loop, a start problem that run and solve read.")
    ] = None,
) -> Result:
    """List the shapes of a closed rod on the cylinder.

    A closed rod comes back to its start in position and direction, and carries no axial force and no twist. It goes
    around the axis --turns-around times, and on its way its angle oscillates --folds times about pi/2. It must be
    longer than the ring: L > 2 pi rho times the number of turns. The list gives the axial moment that it carries (lam =
    MZ rho/A), its bending energy, the Morse index of the closed rod on the surface (0: stable), and the push: where it
    is negative, a rod that is free to unbind lifts off.

    With --table1, or without any option of the rod, omitted fields come from Table 1 (cm, N). Exit status 1 if a loop
    of the numbers given was not found.
    """
    from solver import loops as closed_rods

    from ..branches import ends_study, equilibria_dataset

    if wraps is not None:
        turns_around = wraps
        current("wraps")
    rod, cylinder, units = _rod(file, given, table1)
    counts = parse_folds(folds)
    listed, remarks = [], []
    for count in counts:
        rods = closed_rods(rod, cylinder, turns_around, count)
        listed += [loop for loop in rods if all_of_them or loop.about > 0]
        sentences = [remark for remark in rods.remarks if all_of_them or "-pi/2" not in remark]
        remarks += [f"{count} folds: {sentence}" for sentence in sentences]
    complete = {loop.folds for loop in listed if loop.about > 0} == set(counts)
    if export:
        texts = [equilibria_dataset.study_of_loop(loop, units).text for loop in listed]
        ends_study.write_texts(texts, export, "loop")

    def data() -> dict[str, Any]:
        rows = [row(loop) for loop in listed]
        return {"units": units, "loops": rows, "complete": complete, "remarks": remarks}

    dataset = (lambda: equilibria_dataset.loops_as_dataset(listed, units)) if listed else None
    return Result(data, lambda: _print(listed, remarks, units), 0 if complete else 1, dataset)


def parse_folds(text: str) -> list[int]:
    """``1,2,3`` as numbers. Raises `InputError`."""
    parts = text.split(",")
    if not all(part.strip().isdecimal() and 1 <= int(part) <= MOST_FOLDS for part in parts):
        raise InputError(f"--folds takes whole numbers from 1 to {MOST_FOLDS} with commas between, got {text!r}")
    return list(dict.fromkeys(int(part) for part in parts))


def _rod(file: Path | None, given: GivenOptions, table1: bool) -> "tuple[Rod, Cylinder, dict[str, str]]":
    """The rod and the cylinder of a file, of Table 1 or of the options alone, and their units."""
    from dataclasses import fields

    from solver import Cylinder, Rod
    from studies.language.case_input import is_table1, numbers_alone, read_case

    if file is None and not is_table1(given.values, given.units, table1):
        values, units, _ = numbers_alone(given.values, given.units)
        rod, cylinder = (
            {field.name: values[field.name] for field in fields(kind) if field.name in values}
            for kind in (Rod, Cylinder)
        )
        return Rod(**rod), Cylinder(**cylinder), units
    base = read_case(file, given.values, given.units, table1)
    return base.case.rod, base.case.cylinder, base.units


def _print(found: "list[Loop]", remarks: list[str], units: dict[str, str]) -> None:
    from studies.laws import law_words

    rows = [row(loop) for loop in found]
    shown = {name: OWN[name] if name in OWN else unit_printed(name, units) for name in COLUMNS}
    heads = {"": "", **dict.fromkeys(COLUMNS, ""), "self_intersection": "self-intersection"}
    tables.print_rows([{"": i, **r} for i, r in enumerate(rows, 1)], heads, shown)
    stable = sum(r["index"] == 0 for r in rows)
    counted = law_words.count_of(len(rows), "loop")
    console.say(f"{counted}, {stable} stable as closed rods on the surface, the section free to turn")
    pulled = [str(i) for i, r in enumerate(rows, 1) if r["lifts_off"]]
    if pulled:
        numbers = ", ".join(pulled)
        console.say(f"loop {numbers}: the push is below 0 somewhere, where the rod would lift off")
    for remark in remarks:
        console.say(remark)
    console.say_units(units)


def row(one: "Loop") -> dict[str, Any]:
    """The numbers of a loop as plain data."""
    from ..branches import equilibria_dataset
    from ..words import caution_words

    keys = caution_words.keys(equilibria_dataset.caution_of_loop(one))
    decided = one.overlaps is not None
    return {name: getattr(one, name) for name in COLUMNS} | {
        "MZ": float(one.solution.MZ),
        "dbeta0": float(one.solution.dbeta[0]),
        "beta0": float(one.solution.beta[0]),
        "lifts_off": "pulled" in keys,
        "self_intersection": ("yes" if one.overlaps else "no") if decided else "not decided",
        "closure": one.closure,
        "outcome": str(one.solution.outcome),
        "error": float(one.solution.error),
    }
