"""The equilibria between two ends: the ends problem of a study, rows as plain data, one TOML file for each."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from solver import Case, Ends, InputError, Solution, observe, solve
from solver.equilibria import Equilibrium
from solver.held.equilibrium_choice import NEAREST
from solver.problem.dimensionless import fields_held
from solver.problem.errors import choices
from solver.solve import ends_case
from studies import Study, load
from studies.language.case_input import (
    case_to_solve,
    check_alone,
    field_values,
    force_kept,
    in_units,
    is_table1,
    read_case,
    with_values,
)
from studies.language.loader import loads

from ..run import writing
from ..stored.case_solving import which_is
from ..words.free_rod_words import ELASTIC

DEFAULT = "fig7_4_end_angle"  # the study whose rod is that of Table 1


def study_and_case(
    file: Path | None, values: Mapping[str, Any], units: Mapping[str, str], table1: bool = False, held: bool = False
) -> tuple[Study, Case]:
    """The ends problem of a file or of Table 1 with some fields replaced, or of the fields alone, as of `read_case`.

    Raises `InputError` for held ends unless `held`, and as of `ends_problem`.
    """
    if file is not None:
        check_alone(file, units, table1)
    if file is not None or is_table1(values, units, table1):
        study = load(DEFAULT if file is None else str(file))
        changes = in_units(force_kept(study.base.given, values) | dict(values), study.unit_system)
        case = with_values(ends_problem(study, held=True), changes, study.unit_system)
    else:
        read = read_case(None, values, units, problem=Ends)
        case = read.case
        study = loads(study_text("a rod of the options", read.units, field_values(case)), "equilibria")
    if not held:
        refuse_held(case)
    return study, case


def ends_problem(study: Study, held: bool = False) -> Case:
    """The case of a study as an ends problem; held: whether its ends may hold displacements or give moments.

    A start problem keeps its loads; its end angles become beta(0) and beta(L) of its solution.

    Raises
    ------
    InputError
        For a study with axes, one of held ends unless `held`, or a start problem that is not solved.
    """
    if study.variation.dimensions.each:
        raise InputError(f"{study.name} has {study.variation.words}: equilibria takes one case")
    case = case_to_solve(study, {})
    if not held:
        refuse_held(case)
    if isinstance(case.given, Ends):
        return case
    sol = solve(case, tol=1e-12, stations=2)
    if not sol.solved:
        raise InputError(f"{study.name}: its start problem is not solved: {sol.outcome}")
    return ends_case(sol)


def refuse_held(case: Case) -> None:
    """Raise `InputError` for a case with held ends."""
    if held := fields_held(case):
        raise InputError(
            f"branches begin from equilibria under dead loads and between two angles, got {choices(held)}: "
            "workbench equilibria without --axis lists those of held ends"
        )


def row(one: Equilibrium) -> dict[str, Any]:
    """The numbers of an equilibrium as plain data; under held ends `held_energy`, reactions and both indices."""
    held: dict[str, Any] = {}
    elastic = {name: float(value) for name, value in observe(one.solution, ELASTIC).items()}
    energy = "held_energy" if one.solution.held else "energy"
    if one.solution.held:
        reactions = {name: float(value) for name, value in one.solution.reactions.items()}
        held = {"reactions": reactions, "dead_index": one.dead_index, "found_by": one.found_by}
    return {
        "dbeta0": one.dbeta0,
        energy: one.energy,
        **elastic,
        "bends": one.bends,
        "index": one.index,
        "stray": one.stray,
        "attached": one.attached,
        **held,
        "outcome": str(one.solution.outcome),
        "error": float(one.solution.error),
    }


def study_text(title: str, units: Mapping[str, str], values: Mapping[str, Any]) -> str:
    """The TOML text of a study of one case; values: fields of the case by name, in the units."""
    base = "\n".join(f'{k} = "{v}"' if isinstance(v, str) else f"{k} = {v!r}" for k, v in values.items())
    return f'title = "{title}"\n\n[units]\nlength = "{units["length"]}"\nforce = "{units["force"]}"\n\n[base]\n{base}\n'


def text_of_solution(title: str, units: Mapping[str, str], sol: Solution, named: bool = True) -> str:
    """The TOML text of a study of one case that takes the same solution again.

    named: whether it names the equilibrium of two ends, by which it is found among all. Held ends have the solution of
    their rule, and start problems one.
    """
    text = study_text(title, units, field_values(sol.case))
    if sol.held and sol.selection is not None and sol.selection.choose != NEAREST:
        rule = sol.selection.choose
        return f"{text}\n[equilibrium]\n" + (f"index = {rule}\n" if isinstance(rule, int) else f'choose = "{rule}"\n')
    if not (named and isinstance(sol.case.given, Ends) and sol.solved) or sol.held:
        return text
    which = which_is(sol)
    return f"{text}\n[equilibrium]\ndbeta0 = {which.dbeta0!r}\nenergy = {which.energy!r}\n"


def write_cases(study: Study, case: Case, found: Sequence[Equilibrium], folder: Path) -> None:
    """Write each equilibrium as a TOML case that `workbench solve` and `run` read.

    Raises `InputError` if the folder cannot be written.
    """
    texts = []
    for i, equilibrium in enumerate(found, 1):
        title = f"Equilibrium {i} of {len(found)}: index {equilibrium.index}, {equilibrium.bends} bends"
        texts.append(
            f"{study_text(title, study.unit_system, field_values(case))}\n"
            f"[equilibrium] # selects one of the {len(found)}: the nearest to both values\n"
            f"dbeta0 = {equilibrium.dbeta0!r}\nenergy = {equilibrium.energy!r}\n"
        )
    write_texts(texts, folder, "equilibrium")


def write_texts(texts: Sequence[str], folder: Path, name: str) -> None:
    """Write studies as NAME_1.toml and so on. Raises `InputError` if the folder cannot be written."""
    writing.check_folder(folder)
    for i, text in enumerate(texts, 1):
        (folder / f"{name}_{i:0{len(str(len(texts)))}d}.toml").write_text(text, encoding="utf-8")
