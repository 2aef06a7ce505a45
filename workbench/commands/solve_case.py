"""The command solve: one case from a file, from options or from Table 1."""

import math
import re
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.declared_fields import ALL_FIELDS
from solver.problem.errors import DEFAULT_TOLERANCE, InputError
from solver.problem.quantities import quantity

from ..run import atomic
from ..words.unit_habits import IN_TABLES, margin_words, plain, size_shown, unit_shown, value_with_unit, within
from . import console, tables
from .case_options import GivenOptions
from .options import (
    AT,
    CaseFile,
    Choose,
    Fidelity,
    Json,
    Method,
    Reading,
    Table1,
    Tol,
    field_number,
    flag,
    option,
    pairs,
    parse_choose,
)
from .present import Result, presents

if TYPE_CHECKING:
    from solver import Solution
    from solver.equilibria import Equilibria
    from studies import Study
    from studies.language.case_input import CaseInput

    from .fidelity import Fidelity as Level


LOADS = ("FZ", "MZ", "M3")


@presents(
    plot="Picture of the rod, .png, .pdf or .svg.",
    out="The solved case as an .h5 file, which plot, scene, export and explore read, or as a .toml study of it.",
    suffixes=(*atomic.STORED, ".toml"),
    case=tuple(ALL_FIELDS),
)
def solve(
    file: CaseFile = None,
    table1: Table1 = False,
    reading: Reading = None,
    *,
    given: GivenOptions,
    tol: Tol = None,
    method: Method = None,
    level: Fidelity = None,
    choose: Choose = None,
    at: Annotated[list[str] | None, option("AXIS=VALUE", f"Take one case of a study or of a stored file. {AT}")] = None,
    let_go: Annotated[
        bool, flag("Let the rod go: hold both ends as they are, while the cylinder only pushes.", "--let-go")
    ] = False,
    least_bend_radius: Annotated[
        str | None,
        option(
            "LENGTH",
            "Radius to which the rod may be bent, of its centreline: compared with that of the answer; "
            "exit status 1 if it is bent tighter.",
            "--least-bend-radius",
        ),
    ] = None,
    every: Annotated[bool, flag("Print every number that is found, not only ten.", "--all")] = False,
    json: Json = False,
) -> Result:
    """Solve one case and print it.

    The case comes from a TOML file, from Table 1 (--table1, --reading, or no option at all), or from options alone.
    Options alone must give E, nu, a, L and R; for a start problem also beta, dbeta and one of F1, dgamma and M3; for an
    ends problem also beta0 or M10, and betaL or M1L (a moment of 0 is a hinge). In an ends problem height, azimuth and
    rotation can hold the far end in place of the loads FZ, MZ and M3; the command then finds these loads. A cable that
    is wound on a drum has tension and lay in place of all of these.

    An ends problem has many equilibria: --choose selects one, by default the stable equilibrium whose beta goes least
    beyond its end angles; of held ends, where no list is complete, the stable one of least held energy that is found.
    The command equilibria lists all, or searches for them.

    With --weight, --inclination or --friction the loads vary along the rod. The answer then continues from the straight
    rod, and the command says where the rod is straight, sinusoidal or helical. In a hole s runs from the hook to the
    bit: --hole is its inclination, and --wob or --FZ0 gives the force at the bit, s = L, or at the hook, s = 0, in
    place of FZ. The model leaves out joints, and clearance at the ends.

    With --contact unilateral the cylinder only pushes, and a rod between two ends may leave it; these may be off the
    wall too (--radius0, --radiusL, --tilt0, --tiltL). With --let-go any rod is let go. Both need the extra contact.

    Angles: a number in rad, or a form like 30deg or pi/6. Exit status 1 if the case is unsolved.
    """
    from solver import equilibria, observe
    from studies.language.case_input import check_alone, read_case
    from studies.language.loader import dumps, loads

    from ..branches.ends_study import text_of_solution
    from ..run import in_memory, writing
    from ..stored import case_of_file
    from ..stored.case_solving import solve_one
    from ..words import caution_words, free_rod_words, pipe_profile, pipe_words
    from .fidelity import fidelity

    chosen = fidelity(level or "standard")
    if at and file is None:
        raise InputError("--at takes a case of a study or of a stored file: give also its FILE")
    if file is not None and (at or file.suffix.lower() in atomic.STORED):
        check_alone(file, given.units, table1)
        base = case_of_file.case_in(file, pairs("--at", at), given.values)
    else:
        base = read_case(file, given.values, given.units, table1, reading)
    least = _least_radius(least_bend_radius, base.units)
    stations, which = 201, base.which
    let_go = let_go or (base.study is not None and base.study.let_go)
    leaves = let_go or base.case.leaves
    if base.study is not None:
        stations = base.study.stations
        tol = base.study.tol if tol is None and level is None and base.study.leaves == leaves else tol
        method = base.study.method if method is None else method
    tol, stations = chosen.tol_of(leaves) if tol is None else tol, chosen.stations or stations
    if choose is not None:
        which = parse_choose(choose, base.case.given)
    named = which is not None and which.rule is None
    held_to = DEFAULT_TOLERANCE if let_go and not base.case.leaves else tol  # of the rod before it is let go
    listed = equilibria(base.case, held_to, stations) if named else None
    method_of_case = "auto" if method is None or let_go else method
    before = solve_one(base.case, which, held_to, method_of_case, stations, listed=listed)
    sol: Solution = before.let_go(tol) if let_go else before
    whole = every or json or leaves or not base.case.varies
    energies = free_rod_words.release(before, sol) if let_go else {}
    rows = pipe_profile.profile(sol, base.units)
    data = _find(sol, base.units, chosen, whole) | {
        "source": base.source,
        "assumed": base.assumed,
        "wound": base.wound,
        "stand_ins": base.stand_ins,
        "which": _which(before, listed, base),
        "selection": None if sol.selection is None else {**asdict(sol.selection), "rule": sol.selection.rule},
        "caution": caution_words.said(caution_words.of_cases(sol, units=base.units)),
        "left_out": caution_words.sentence_inside(sol.case),
        "free": free_rod_words.sentences(sol, base.units)
        + ([free_rod_words.release_sentence(energies, base.units)] if energies else []),
        "contacts": sol.contacts,
        "point_forces": sol.point_forces,
        "released": energies,
        "pipe": pipe_words.sentences(sol, base.units),
        "limits": [limit._asdict() for limit in pipe_words.limits(sol.case)],
        "profile": [row._asdict() for row in rows],
        "warnings": pipe_words.warnings(sol, base.units, rows),
        "lift_offs": sol.lift_offs,
    }
    data["bend"] = _bend(float(observe(sol, ["kappa_max"])["kappa_max"]), least)

    def study(name: str = "rod") -> "Study":
        taken = which is not None or not (base.case.varies or base.case.leaves)  # else there is no list of equilibria
        title = f"{base.title}, let go" if let_go and not (base.study and base.study.let_go) else base.title
        plain = loads(text_of_solution(title, base.units, before, taken))
        settings: dict[str, Any] = {"name": name, "tol": tol, "stations": sol.t.shape[-1]}
        settings |= ({} if method is None else {"method": method}) | ({"let_go": True} if let_go else {})
        plain = loads(dumps(plain.model_copy(update=settings)))
        settings["observables"] = [*chosen.observables(sol.case.rod, leaves)]
        return loads(dumps(chosen.of(plain).model_copy(update=settings)))

    def write(path: Path) -> None:
        named = study(re.sub(r"[^A-Za-z0-9_-]+", "-", path.stem)[:200].strip("-") or "rod")
        if path.suffix.lower() == ".toml":
            atomic.write_text(path, dumps(named))
        else:
            stored = in_memory.run(named)
            if not stored["solved"].all():
                raise InputError(f"cannot write {path}: {stored['outcome'].item()}")
            writing.write(stored, path, force=True)

    return Result(
        lambda: data,
        lambda: _show(data, every, whole),
        0 if sol.solved and data["bend"]["margin"] >= 0 else 1,
        (lambda: in_memory.run(study())) if sol.solved else None,  # another rule might solve it
        write if sol.solved else None,
    )


def _which(sol: "Solution", listed: "Equilibria | None", base: "CaseInput") -> str:
    """Which equilibrium was taken. listed: all, where it was named by numbers: by a study, or as a wound helix."""
    from solver import observe

    from ..words import pipe_words
    from ..words.outcome_counts import stability

    study = base.study
    if base.wound and sol.case.varies and sol.solved:
        return pipe_words.lay_sentence(sol, base.units["force"])
    if listed is None or not sol.solved:
        lists = "search for all" if sol.held else "list all"
        return f"{sol.selection} (use workbench equilibria to {lists})" if sol.selection is not None else ""
    if study is not None:
        stable = sum(equilibrium.index == 0 for equilibrium in listed)
        return f"{len(listed)} equilibria, {stable} stable; shown: the one that {study.name} names"
    index = int(observe(sol, ["index"])["index"])
    ways = f"{stability(index)} under dead loads: it needs more tension, or a guide" if index else "which is stable"
    return f"shown: the helix of this tension and lay, {ways}"


def _find(sol: "Solution", units: dict[str, str], level: "Level", whole: bool) -> dict[str, Any]:
    """The case, its loads, its accuracy, and the observables and arrays of a fidelity, as plain data.

    whole: whether the outcome says which observables are not defined.
    """
    import numpy as np

    from solver.equilibria_result import energy_as_held
    from solver.observe.observables import observe, why_unknown
    from studies.language.case_input import field_values, with_unit

    wall = sol.case.cylinder
    turning = ["M30", "surface_torque"] if wall.turns_in_place else []  # with M3, the torque at both ends
    pushed = ["reach", "arriving_max"] if wall.friction and wall.side == "inside" and not turning else []
    leaves = sol.case.leaves
    names = [*level.observables(sol.case.rod, leaves), *turning, *pushed]
    held = [*LOADS, *sol.reactions] if leaves else []  # in the table beside the observables
    seen = observe(sol, dict.fromkeys([*names, *held]), errors=leaves)
    errors = {name: np.asarray(seen.pop(f"{name}_error")).item() for name in [*seen] if f"{name}_error" in seen}
    seen = {name: seen[name] for name in names}
    reasons = [reason for name in seen for reason in why_unknown(name, seen[name], leaves)]
    remarks = [words for words, affected in reasons if affected and sol.solved and whole and not leaves]
    listed = "energy" in seen and sol.held and sol.solved and not (sol.case.varies or leaves)  # of held ends
    as_held = {"held_energy": energy_as_held(sol)} if listed else {}
    return {
        "case": field_values(sol.case),
        "given": type(sol.case.given).__name__,
        "units": units,
        "solved": bool(sol.solved),
        "outcome": "; ".join([with_unit(str(sol.outcome), sol.case, units), *remarks]),
        "method": sol.method,
        "tolerance": sol.tol,
        "error": float(sol.error),
        "condition": float(sol.condition),
        "loads": {name: float(getattr(sol, name)) for name in LOADS},
        "held": list(sol.held),
        "reactions": {name: float(value) for name, value in sol.reactions.items()},
        "begun": sol.begun or "",
        "indices": _indices(sol),
        "observables": {name: np.asarray(value).item() for name, value in seen.items()} | as_held,
        "errors": errors,
        "along": {name: getattr(sol, name).tolist() for name in level.along(leaves)},
    }


def _indices(sol: "Solution") -> dict[str, int]:
    """The Morse index under held ends and under dead loads, each where it is decided; empty of other ends."""
    if not sol.held or sol.case.varies or sol.case.leaves or not sol.solved:
        return {}
    indices = {"held ends": float(sol.held_index), "dead loads": float(sol.dead_index)}
    return {loading: int(index) for loading, index in indices.items() if math.isfinite(index)}


def _least_radius(text: str | None, units: dict[str, str]) -> float | None:
    """The radius of --least-bend-radius in these units. Raises `InputError`."""
    least = None if text is None else field_number("--least-bend-radius", "R", text, units)
    if least is not None and not 0 < least < math.inf:
        raise InputError(f"--least-bend-radius must be a positive length, got {text!r}")
    return least


def _bend(kappa: float, least: float | None) -> dict[str, float]:
    """The least bend radius of the centreline and the one that is asked for, and by which share the first is larger."""
    radius = 1 / kappa if kappa else math.inf
    return {"radius": radius, "least": least or 0.0, "margin": radius / least - 1 if least else math.inf}


FLAT = 1.0  # deg: how little beta varies is said beside the bends
PROFILE = ("start", "middle", "largest", "at", "far")
# what is printed without --all: of every rod; on the wall, wound as a helix, off the wall
COMMON = {"turns_around", "height", "F3_size_max", "push_max"}
ON_WALL = COMMON | {"push_min", "attached", "index"}
WOUND = ON_WALL | {"pitch", "bending_stress_max"}  # with the bend radius
BENT = {"kappa_max", "bending_moment_max"}
OFF_WALL = COMMON | BENT | {"gap_max", "contact_share", "contact_count", "point_force_max"}
HEADLINES = ON_WALL | BENT | {"bends", "M30", "surface_torque", "reach", "arriving_max"}


def _show(found: dict[str, Any], every: bool, whole: bool) -> None:
    """Print a case. whole: with tables of what is given and found; else what an engineer asks of a pipe."""
    if whole:
        _print_tables(found, every)
    else:
        console.say_units(found["units"])
        known = {name: value for name, value in found["case"].items() if name not in found["assumed"]}
        words = (
            f"{name} {value}" if isinstance(value, str) else _in_words(name, value, found["units"])
            for name, value in {**known, **found["stand_ins"]}.items()
        )
        console.say(", ".join(words))
    accuracy = f": error {found['error']:.1e}, condition {found['condition']:.3g}"
    if found["case"].get("contact"):
        accuracy = f" of the length: error {found['error']:.1e}"
    if not math.isfinite(found["error"]):
        accuracy = ""
    console.say(f"\n{found['outcome']} ({found['method']}, tolerance {found['tolerance']:g}{accuracy})")
    for sentence in (found["which"], *found["pipe"], *found["free"]):
        if sentence:
            console.say(sentence)
    if found["limits"]:
        heads = ["local compression of a long pipe", "name", f"value ({found['units']['force']})"]
        console.say("")
        tables.print_table(heads, [[row["load"], row["name"], plain(row["value"])] for row in found["limits"]])
    if found["profile"]:
        heads = ["", "unit", "s = 0", "middle", "largest", f"at s ({found['units']['length']})", "s = L"]
        rows = [
            [row["name"], row["unit"], *(plain(row[name]).replace("nan", "everywhere") for name in PROFILE)]
            for row in found["profile"]
        ]
        console.say("")
        tables.print_table(heads, rows)
        console.say("middle: the mean of the middle third\n")
    if found["begun"] and not found["pipe"] and not found["case"].get("contact"):
        console.say(f"held: {', '.join(found['held'])}; the search began at {found['begun']}")
    if found["indices"]:
        said = ", ".join(f"{index} under {loading}" for loading, index in found["indices"].items())
        console.say(f"held: {', '.join(found['held'])}; index {said}")
    for sentence in found["warnings"]:
        console.say(sentence)
    if found["bend"]["margin"] < 0:
        console.say(
            f"caution: the rod is bent too tight: its bend radius is {margin_words(found['bend'], 'R', found['units'])}"
        )
    elif found["bend"]["least"] and found["profile"]:
        console.say(f"bend radius: {margin_words(found['bend'], 'R', found['units'])}")
    if found["caution"] and not found["profile"]:
        console.say(f"caution: {found['caution']}")
    if found["left_out"]:
        console.say(found["left_out"])


def _print_tables(found: dict[str, Any], every: bool) -> None:
    from studies.grammar.axes import quantity_of

    console.say(f"rod: {found['source']}")
    console.say_units(found["units"], found["assumed"])
    console.say("")
    rows = []
    for name, value in {**found["case"], **found["stand_ins"]}.items():
        row = None if isinstance(value, str) else quantity_of(name)
        unit = _unit(row.name, found) if row else ""
        turned = math.degrees(value) if unit == "rad" else 0.0
        degrees = f" ({turned:.6g} deg)" if turned and math.isfinite(turned) else ""
        shown = f"{value * size_shown(name, found['units']):.10g}" if isinstance(value, float) else value
        rows.append([name, shown, unit, f"{row.long_name}{degrees}" if row else ""])
    tables.print_table(["given", "value", "unit", ""], rows)
    console.say("")
    if results := _results(found):
        heads = OFF_WALL if found["case"].get("contact") else WOUND if found["wound"] else HEADLINES
        others = set(found["observables"]) | set(found["case"]) - heads  # a load that is given stands above
        shown = [name for name in results if every or name in heads or name not in others]
        turn = math.degrees(results.get("amplitude", math.inf))
        varies = f"; beta varies by {turn:.2g} deg" * (turn < FLAT and bool(results.get("bends")))
        rows = []
        for name in shown:
            value = results[name] if isinstance(results[name], int) else _number(name, results[name], found)
            rows.append([name, value, _unit(name, found), quantity(name).long_name + varies * (name == "bends")])
        if found["wound"] or found["bend"]["least"]:
            radius = found["bend"]["radius"] * size_shown("R", found["units"])
            words = ", ".join(
                filter(None, ("least bend radius of the centreline", margin_words(found["bend"], "R", found["units"])))
            )
            rows.append(["bend radius", radius, unit_shown("R", found["units"]), words])
        tables.print_table(["found", "value", "unit", ""], rows)
        if more := len(results) - len(shown):
            console.say(f"{more} more numbers with --all")


def _number(name: str, value: float, found: dict[str, Any]) -> str:
    """A number of a table in its unit, in the digits that its error allows, where that is known."""
    from solver.observe.observables import OBSERVABLES

    from ..words.free_rod_words import amount

    unit = size_shown(name, found["units"])
    write = amount if name in OBSERVABLES and OBSERVABLES[name].least == 0 else within
    return write(value * unit, found["errors"].get(name, 0.0) * unit, IN_TABLES)


def _results(found: dict[str, Any]) -> dict[str, float]:
    """Loads, reactions and observables; of an unsolved case those that are known, or none if no observable is known."""
    results = {**found["loads"], **found["reactions"], **found["observables"]}
    if found["solved"] and not found["pipe"]:
        return results
    known = {name: value for name, value in results.items() if not math.isnan(value)}
    return known if known.keys() & found["observables"].keys() else {}


def _unit(name: str, found: dict[str, Any]) -> str:
    """The unit of a number in a table; an angle is in rad."""
    unit = unit_shown(name, found["units"])
    return "" if unit == "1" else unit


def _in_words(name: str, value: float, units: dict[str, str]) -> str:
    """``R = 4.25 in``, ``inclination = 60 deg``."""
    from studies.grammar.axes import in_words, is_angle

    is_number = is_angle(name) or unit_shown(name, units) == "1"
    return in_words(name, value) if is_number else f"{name} = {value_with_unit(name, value, units, 6)}"
