"""The command equilibria: list, draw, store and export all equilibria between two ends, or follow them over an axis."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.errors import InputError, choices

from ..words import unit_habits
from . import console, tables
from .case_options import ENDS_FIELDS, HELD, GivenOptions, parse_axis
from .options import Choose, OneCase, Table1, option, parse_choose, ranges
from .present import Result, presents
from .tables import unit_printed

if TYPE_CHECKING:
    import numpy as np

    from solver import Case
    from solver.equilibria import Equilibria
    from studies import Study


HEADS = {"stray": "overshoot"}  # of columns that are not named as in files
OWN = ("stray", "dead_index")  # columns that are no quantities
MOST_FOLDS = 10  # that are printed


@presents(
    "Picture, .png, .pdf or .svg: curves and energies; with --axis branches and folds.",
    "HDF5 file of the equilibria, or with --axis of the branches.",
    kind="equilibria",
    force="Replace an existing picture, and the file of --out even if it holds no equilibria.",
    case=(*ENDS_FIELDS, *HELD),
)
def equilibria(
    file: OneCase = None,
    table1: Table1 = False,
    *,
    given: GivenOptions,
    axis: Annotated[
        str | None,
        option(
            "NAME=FROM:TO:COUNT",
            "Follow all equilibria while one field varies, such as betaL=-90deg:60deg:41 or FZ=4:12:41, in the units "
            "of the case, and print the branches.",
        ),
    ] = None,
    show: Annotated[
        str | None,
        option("NAME", "What the picture of --axis shows: an observable such as height, bends, energy, or dbeta0."),
    ] = None,
    within: Annotated[
        list[str] | None,
        option(
            "NAME=LOW:HIGH",
            "Range of a reaction of held ends over which to search, such as FZ=-50:10 with a held height, in the units "
            "of the case; repeatable.",
        ),
    ] = None,
    values: Annotated[
        int | None,
        option("COUNT", "Values of each reaction of held ends from which to search; default: 61 of one, 13 of two."),
    ] = None,
    tries: Annotated[
        int | None,
        option("COUNT", "Deflations without a new equilibrium after which a search of held ends stops; default: 10."),
    ] = None,
    points: Annotated[
        int | None,
        option(
            "COUNT",
            "Points of each branch of --axis in either direction, at most; default: 1000, and ten for each value.",
        ),
    ] = None,
    export: Annotated[
        Path | None, option("FOLDER", "Folder for one TOML file per equilibrium, which the command solve reads.")
    ] = None,
    choose: Choose = None,
) -> Result:
    """List all equilibria between two end angles under dead loads, or those of held ends that a search finds.

    The list is sorted by energy, lowest first, and gives the Morse index (0: stable). Exit status 1 if there is none
    or the list is incomplete.

    With --height, --azimuth, --rotation, --M10 or --M1L the ends are held. Such a list is never proved complete; the
    command states the range of the reactions over which it searched (--within), and what it tried.

    With --axis the equilibria are followed while one field varies. If this field is height, azimuth, rotation, M10 or
    M1L, it is held, and the list is not proved complete.

    With --table1, or without any option of the case, omitted fields come from Table 1 (cm, N; read
    force-first/tension/paper): its beta(0), its loads, and for beta(L) the angle at which its rod ends. Else the
    options describe the whole rod: E, nu, a, L, R, beta0 and betaL are required, and omitted loads are 0.

    Angles: a number in rad, or a form like 30deg or pi/6.
    """
    from solver import equilibria as all_equilibria
    from solver.problem.dimensionless import fields_held

    from ..branches.ends_study import study_and_case, write_cases
    from ..run import writing

    study, case = study_and_case(file, given.values, given.units, table1, held=axis is None)
    held = fields_held(case)
    loads = ranges("--within", within, study.unit_system, "FZ=-50:10")
    every = {"within": loads or None, "values": values, "tries": tries}
    search: dict[str, Any] = {name: value for name, value in every.items() if value is not None}
    if search and (axis is not None or not held):
        name = next(iter(search))
        raise InputError(f"--{name} belongs to the search of held ends, so it excludes dead loads and --axis")
    if show is not None and axis is None:
        raise InputError(f"--show {show} names what --axis shows; give --axis too")
    if show is not None:
        from ..branches.branch_dataset import check_shown

        show = check_shown(show)
    if points is not None and axis is None:
        raise InputError("--points is for the branches of --axis: give --axis too")
    if points is not None and points < 1:
        raise InputError(f"--points must be at least 1, got {points}")
    if axis is not None and export is not None:
        raise InputError("--export writes the equilibria of one case, so it excludes --axis")
    if export is not None and held:
        raise InputError(f"--export writes cases under dead loads, got {choices(held)}; --out stores this list")
    if export is not None:
        writing.check_folder(export)
    if axis is not None:
        return _over_axis(study, case, *parse_axis(axis, study.unit_system), show, points)
    listed = all_equilibria(case, **search)
    if export is not None:
        write_cases(study, case, listed, export)
    return _list(study, case, listed, choose, _source(study, file, given, table1), export)


def _source(study: "Study", file: Path | None, given: GivenOptions, table1: bool) -> str:
    from studies.language.case_input import OPTIONS, is_table1

    if file is None and not is_table1(given.values, given.units, table1):
        return OPTIONS
    end_angle = "" if {"betaL", "M1L"} & {*given.values} else " (betaL: the angle at which its own rod ends)"
    changed = f", with {', '.join(given.values)} as given" if given.values else ""
    return f"{study.title if file else f'Table 1{end_angle}'}{changed}"


def _list(
    study: "Study", case: "Case", found: "Equilibria", choose: str | None, source: str, export: Path | None
) -> Result:
    """The equilibria and which of them the rule selects, as they are handed over."""
    from solver.equilibria import choice
    from solver.equilibria_result import HeldEquilibria
    from solver.problem.dimensionless import fields_held
    from studies.language.case_input import field_values, with_unit

    from ..branches.ends_study import row
    from ..branches.equilibria_dataset import as_dataset
    from ..stored.case_solving import rule_of
    from ..words import caution_words

    rule = rule_of(study.equilibrium) if choose is None else parse_choose(choose).rule
    assert rule is not None
    searched = found.search if isinstance(found, HeldEquilibria) else None
    taken, how = choice(found, rule)
    rows = [{**row(equilibrium), "taken": equilibrium is taken} for equilibrium in found]
    remark = with_unit(found.remark, case, study.unit_system)
    search = {} if searched is None else {"search": asdict(searched)}
    held = fields_held(case)

    def show() -> None:
        _print_table(study, rows, list(searched.within) if searched else [])
        if rows:
            console.say(
                _energy_in_words(rows, bool(held), bool(case.rod.weight), unit_printed("energy", study.unit_system))
            )
        ends = f"under held ends: {choices(held)}" if held else "with the end angles held and dead loads"
        noun = "equilibrium" if len(rows) == 1 else "equilibria"
        console.say(f"{len(rows)} {noun}, {sum(r['index'] == 0 for r in rows)} stable {ends}")
        if not found.complete:
            console.say(remark if held else f"the list may be incomplete: {remark}")
        _say_unsolved([str(equilibrium.solution.outcome) for equilibrium in found])
        if found:
            console.say(f"* {how.rule}" if taken else f"none has index {rule}")
        console.say(f"rod: {source}")
        console.say_units(study.unit_system)
        if left_out := caution_words.sentence_inside(case):
            console.say(left_out)
        if export:
            console.say(f"{len(found)} cases in {export}")

    def data() -> dict[str, Any]:
        return {
            "case": field_values(case),
            "units": study.unit_system,
            "selection": {**asdict(how), "rule": how.rule},
            "equilibria": rows,
            "complete": found.complete,
            "remark": remark,
            **search,
        }

    status = 0 if found and (found.complete or held) else 1
    return Result(data, show, status, (lambda: as_dataset(study, case, found)) if found else None)


def _print_table(study: "Study", rows: Sequence[dict[str, Any]], reactions: Sequence[str]) -> None:
    """The equilibria, a row each; reactions: of held ends, shown with the index under dead loads."""
    energy = "held_energy" if rows and "held_energy" in rows[0] else "energy"
    dead = ["dead_index"] if reactions else []
    names = (*reactions, "dbeta0", energy, "bending_energy", "bends", "index", *dead, "stray", "attached")
    units = {name: unit_printed(name, study.unit_system) for name in names if name not in OWN} | {"stray": "deg"}
    least = _base_energy([row[energy] for row in rows])
    heads = {name: HEADS.get(name, name).replace("_", " ") for name in names}
    table = []
    slopes = unit_habits.distinct_texts([row["dbeta0"] for row in rows], unit_habits.plain, unit_habits.IN_TABLES)
    for i, (row, slope) in enumerate(zip(rows, slopes, strict=True), 1):
        numbers = {"dbeta0": slope} | ({energy: row[energy] - least} if least else {})
        table.append({"": f"{i} *" if row["taken"] else f"{i}", **row, **row.get("reactions", {}), **numbers})
    tables.print_rows(table, {"": "", **heads}, units)
    if least:
        console.say(f"energies are listed above the least, {least:.10g} {units[energy]}")


def _base_energy(energies: Sequence[float]) -> float:
    """The energy above which five digits tell these apart: the least, if they differ by less than 0.1 %; else 0."""
    least, most = min(energies, default=0.0), max(energies, default=0.0)
    return least if 0 < most - least < 1e-3 * abs(least) else 0.0


def _energy_in_words(rows: Sequence[dict[str, Any]], held: bool, heavy: bool, unit: str) -> str:
    """What the energy of a list consists of; held: whether ends are held, whose reactions do no work."""
    twist = [row["twist_energy"] for row in rows]
    same = max(twist) - min(twist) <= 1e-9 * max(twist)
    number = f" ({twist[0]:.6g} {unit}{' in each' if len(rows) > 1 else ''})"
    part = f"twist energy{number if same else ''}"
    loads = "the given loads and end moments" if held else "FZ, MZ and M3"
    weight = " + potential of the weight" if heavy else ""
    return f"{'held ' if held else ''}energy = bending energy + {part}{weight} - work of {loads}"


def _say_unsolved(texts: Sequence[str]) -> None:
    """Say of how many listed equilibria no shape is known, and why; texts: the outcome of each, "" for none."""
    from ..words import outcome_counts

    failed = Counter(text for text in texts if text not in ("", "solved"))
    for text, count in outcome_counts.group(failed).items():
        console.say(f"{count} equilibri{'um is' if count == 1 else 'a are'} listed, but {text}")


def _over_axis(
    study: "Study", case: "Case", name: str, values: "np.ndarray", show: str | None, points: int | None
) -> Result:
    """The branches of equilibria over an axis; status 1 if there is none."""

    from ..branches import branch_dataset
    from ..stored.stored_study import StoredStudy
    from ..words import outcome_counts

    with console.progress(values.size, lines=True) as step:
        stored = StoredStudy(branch_dataset.sweep(study, case, name, values, step, show, points))
    rows, folds, remarks = stored.data("branches"), branch_dataset.folds(stored), stored.data("remarks")

    def data() -> dict[str, Any]:
        numbered = [{"number": row["branch"] + 1, **row} for row in rows]
        return {"axis": name, "units": study.unit_system, "branches": numbered, "folds": folds, "remarks": remarks}

    def tell() -> None:
        unit = unit_printed(name, study.unit_system)
        keys = list(rows[0]) if rows else ["branch"]
        heads = {key: tables.column_title(key, unit if key in ("from", "to") else "") for key in keys}
        tables.print_rows([{**row, "branch": row["branch"] + 1} for row in rows], heads)
        counts = f"{len(rows)} branch{'es' * (len(rows) != 1)}, {len(folds)} fold{'s' * (len(folds) != 1)}"
        console.say(f"{counts} over {values.size} values of {name}")
        _print_folds(folds, name, unit)
        console.say_units(study.unit_system)
        for remark, count in outcome_counts.group(Counter(remarks)).items():
            console.say(f"{'a branch stops' if count == 1 else f'branches stop {count} times,'} at {remark}")
        if any("the limit of" in remark for remark in remarks):
            console.say("--points COUNT follows branches over more points")
        _say_unsolved(stored["outcome"].values.ravel().tolist() if "outcome" in stored else [])

    return Result(data, tell, 0 if rows else 1, lambda: stored.ds)


def _print_folds(folds: Sequence[dict[str, Any]], name: str, unit: str) -> None:
    """Where folds lie on the axis and which branches meet there, so many as `MOST_FOLDS`."""
    rows = [{"fold": fold["fold"], "branches": "{} and {}".format(*fold["numbers"])} for fold in folds[:MOST_FOLDS]]
    if rows:
        tables.print_rows(rows, {"fold": f"{name} at the fold", "branches": "branches that meet"}, {"fold": unit})
    if len(folds) > MOST_FOLDS:
        console.say(f"and {len(folds) - MOST_FOLDS} more; --json lists all")
