"""What the live page shows of a state (a study of one case as plain data): its rod, observables, equilibria, files.

The rod is solved fast enough for a page. Between two ends it is the equilibrium that the study names, or that the rule
of `solve` selects; as a slider moves, the page itself follows it. A rod that may leave the cylinder continues from that
of the state before. A search that would take minutes is refused. Nothing is kept between calls; an invalid state raises
`InputError`.
"""

import re
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from warnings import catch_warnings, simplefilter

import numpy as np
import tomli_w

from solver import Case, Ends, Solution, Start, equilibria, solve
from solver.equilibria import Equilibrium
from solver.follow import solutions_of
from solver.nodes.loaded_rod import rods_of
from solver.observe.observables import observables_of, observe
from solver.problem.case_fields import value_of, with_field
from solver.problem.dimensionless import fields_held, reduce
from solver.problem.errors import DEFAULT_TOLERANCE, InputError, check_known, choices
from solver.problem.notices import UnitWarning
from studies import Study
from studies.grammar.axes import WORDS, Dimensions, Which
from studies.language.loader import loads

from ...branches.ends_study import row as equilibrium_row
from ...branches.tracing import Piece, Traced, trace_branches
from ...export.file_format import ExportOptions
from ...export.stored_rod import export
from ...run import dataset_assembly
from ...run.block import columns
from ...stored.case_solving import rule_of, solve_one, which_is
from ...stored.stored_study import StoredStudy
from ...words import caution_words, free_rod_words, labels, pipe_profile, pipe_words, unit_habits

SMALL = 240  # points of a small picture
KEYS = ("title", "units", "reading", "base", "equilibrium", "let_go")
KEPT = ("State:", "The rod ", "Caution:")  # how sentences begin that are no details
SLOW = ("overlaps", "index")  # observables that are told later, with all others
TOL = DEFAULT_TOLERANCE
STATIONS, BETWEEN, MOST = 201, 401, 4001  # of a start problem, an ends problem, and a rod with many bends or weight
OFF_WALL_TOL, SENT = 3e-3, 801  # of a rod that may leave the cylinder: some pixels of a view; stations that are sent
LEAST_ERROR = 1e-5  # of its length, which an exported curve may be off
MOST_HALF_WAVES = 100  # of beta between two ends, up to which all equilibria are found, in some tenths of a second
MOST_NODES = 1500  # of a rod with weight or friction: a pipe of some 3 km, which takes seconds
SAME = 1e-3  # relative difference that beta'(0) may have from the one that is named
LEVEL = 1e-6  # beta'(0) in units of 1/rho, below which it is 0
CHORD = 0.4  # rad by which the rod may turn between two stations before more stations are solved
FIELDS = ("FZ", "MZ", "M3", "beta0", "betaL")  # that a diagram may be over
SHOWN = ("height", "turns_around", "energy", "bends", "push_max", "kappa_max", "amplitude")  # that it may show
PATIENCE = 8.0  # s, after which no further branch is followed
MOST_POINTS = 90  # points of a piece of a branch; each is solved, in a millisecond
FEW = 3  # stations of a point; its observables do not need more


def study_of(state: Any) -> Study:
    """The study of a state. Raises `InputError`, whose message names no file and line."""
    if not isinstance(state, dict):
        raise InputError("the state must be a table")
    for key in state:
        if key not in KEYS:
            raise InputError(f"no key {str(key)[:40]!r} in the state; choose from {choices(KEYS)}")
    data = {key: value for key, value in state.items() if value is not None}
    data.setdefault("title", "From the live page")
    base = data.get("base")
    if isinstance(base, dict):
        data["base"] = {str(name): _plain(name, value) for name, value in base.items()}
    try:
        text = tomli_w.dumps(data)
    except (TypeError, ValueError, AttributeError):
        raise InputError("the state must hold numbers, strings and tables of them") from None
    try:
        with catch_warnings():  # a state is in rad, and in the units of the file, which was read with its notices
            simplefilter("ignore", UnitWarning)
            return loads(text, "page", "live")
    except InputError as error:
        raise InputError(re.sub(r"^page(, line \d+)?: ", "", str(error))) from None


def _plain(name: object, value: Any) -> Any:
    """A field's value as TOML stores it: numbers as floats. Raises `InputError` for anything else."""
    if name in WORDS:
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        got = "nothing" if value is None or value == "" else f"{value!r:.40}"
        raise InputError(f"{str(name)[:40]} must be a number, got {got}")
    return float(value)


def field_of(message: str) -> str:
    """The field that an error message is about, or nothing: ``Rod.E must be ...`` is about E."""
    match = re.match(r"(?:Rod|Cylinder|Start|Ends|base)\.(\w+)", message) or re.match(
        r"(\w+) must be a number", message
    )
    return match[1] if match else ""


@dataclass(frozen=True, eq=False)
class LiveRod:
    """A solved rod: its study and solution. Of a rod with very many bends only the beginning is solved and shown.

    held: of a rod between two ends that was let go the solution before, on a cylinder that holds it on; else None.
    """

    study: Study
    sol: Solution
    held: Solution | None = None

    @property
    def shown(self) -> float:
        return float(self.sol.s[-1])

    @property
    def whole(self) -> bool:
        return self.shown >= float(self.sol.case.rod.L) * (1 - 1e-9)


def is_searched(study: Study) -> bool:
    """Whether the rod of a state is one of several, between two ends.

    Raises `InputError` for ends that the page does not show.
    """
    case = study.case()
    if study.leaves:
        return True
    if not case.varies and (held := fields_held(case)):
        raise InputError(f"the live page shows ends under dead loads, got {choices(held)}: use workbench solve")
    return isinstance(case.given, Ends)


def shape(study: Study, lost: bool = False, before: LiveRod | None = None) -> LiveRod:
    """The rod of a state; between two ends the one that the study names, or that `solve` selects.

    lost: the study names the equilibrium of an earlier state, which could not be followed. before: the rod from which
    one that may leave the cylinder continues. Raises `InputError` for an unsolved rod, and for ends that the page does
    not show.
    """
    case = study.case()
    if study.leaves:
        return _beside(study, case, lost, before)
    if not is_searched(study):
        return _resolve(study, case, solve(case, TOL, stations=STATIONS))
    sol = _with_weight(case) if case.varies else _between(study, case, lost)
    check(sol)
    return LiveRod(study, sol)


def _beside(study: Study, case: Case, lost: bool, before: LiveRod | None) -> LiveRod:
    """The rod that may leave the cylinder: near that of the state before where there is one, else as `solve` has it."""
    held = None
    if study.let_go:
        plain, known = study.model_copy(update={"let_go": False}), None if before is None else before.held
        if known is not None and is_searched(plain) and not case.varies:
            held = solve(case, TOL, stations=MOST, seed=known)
        if held is None or not held.solved:
            rod = shape(plain, lost)
            held = rod.sol
            if not rod.whole:
                raise InputError("only a part of this rod is shown, so it cannot be let go: make it shorter")
            if isinstance(case.given, Start) and held.s.size < MOST:
                held = solve(case, TOL, stations=MOST)
    else:
        _refuse_long(case)

    def near(seed: Solution | None) -> Solution:
        if held is None:
            return solve(case, OFF_WALL_TOL, stations=MOST, seed=seed)
        return held.let_go(OFF_WALL_TOL, seed)

    sol = near(None if before is None else before.sol)
    if before is not None and not sol.solved:
        sol = near(None)
    check(sol)
    return LiveRod(study, sol, held if isinstance(case.given, Ends) else None)


def _with_weight(case: Case) -> Solution:
    """The rod that `solve` selects. Raises `InputError` for one so long that the page would wait."""
    _refuse_long(case)
    return solve(case, TOL, stations=MOST)


def _refuse_long(case: Case) -> None:
    """Raise `InputError` for a rod between ends that is so long that the page would wait."""
    nodes = rods_of(case)[0].nodes().size
    if nodes > MOST_NODES:
        raise InputError(
            f"the shape of this rod may change on {nodes} lengths, and the page computes at most {MOST_NODES}: "
            "use workbench solve"
        )


def _resolve(study: Study, case: Case, sol: Solution) -> LiveRod:
    """The start problem at as many stations as its bends need, or the part of the rod that fits into `MOST`."""
    check(sol)
    turn = float((sol.kappa.max() if sol.kappa.size else 0.0) * sol.s[-1] / (sol.s.size - 1))
    if turn <= CHORD:
        return LiveRod(study, sol)
    n = int(np.ceil(STATIONS * turn / CHORD))
    length = float(case.rod.L) * min(1.0, MOST / n)
    sol = solve(case, TOL, stations=np.linspace(0.0, length, min(n, MOST)))
    check(sol)
    return LiveRod(study, sol)


def _between(study: Study, case: Case, lost: bool) -> Solution:
    which, half_periods = study.equilibrium, _half_periods(case)
    many = half_periods > MOST_HALF_WAVES
    if which is None or which.dbeta0 is None or (lost and many):
        return solve(case, TOL, stations=BETWEEN, choose=rule_of(None if lost and many else which))
    near: tuple[dict[str, Any], ...] = ({"seed": which.dbeta0}, {"choose": rule_of(which)})
    for sol in (solve(case, TOL, stations=BETWEEN, **how) for how in near):
        if sol.solved and _same(sol, which):
            return sol
    if many:
        raise InputError(f"the named equilibrium is not the one selected by default, and {_too_many(half_periods)}")
    return solve_one(case, which, TOL, "auto", BETWEEN)


def _same(sol: Solution, which: Which) -> bool:
    assert which.dbeta0 is not None
    slope, rho = float(sol.dbeta[0]), float(sol.case.rho)
    return abs(slope - which.dbeta0) <= SAME * max(abs(which.dbeta0), LEVEL / rho)


def refuse_many(case: Case) -> None:
    """Raise `InputError` where finding all equilibria of a rod would take too long for the page."""
    if case.varies:
        raise InputError("of a rod with weight or friction the page shows the equilibrium of workbench solve alone")
    if (half_periods := _half_periods(case)) > MOST_HALF_WAVES:
        raise InputError(_too_many(half_periods))


def _too_many(half_periods: float) -> str:
    return (
        f"between these ends and under these loads beta may have some {half_periods:.0f} half waves, and the page "
        f"searches at most {MOST_HALF_WAVES}: use workbench equilibria"
    )


def _half_periods(case: Case) -> float:
    """A bound on the half periods of beta: L over the shortest that the loads and the cylinder allow."""
    p = reduce(case)
    frequency = np.sqrt(np.abs(p.lam) + 2 * np.abs(p.mu) + np.abs(p.phi) + 1)
    return float(p.span[0] * frequency[0] / np.pi)


def check(sol: Solution) -> None:
    """Raise `InputError` for a rod that is not solved."""
    if not sol.solved:
        raise InputError(f"this rod is not solved: {sol.outcome}")


def stations(one: LiveRod) -> dict[str, Any]:
    """The rod at its stations, arrays by name, in the units of the study and rad: s, beta, dbeta, alpha, z.

    Of a rod that the page cannot compute also push, kappa and tension (F3), and the axial force `axial`; of one that
    may leave the cylinder its place x, y, its tilt, and the gap.
    """
    sol, leaves = one.sol, one.sol.case.leaves
    names = {name: name for name in ("s", "beta", "dbeta", "alpha", "z")}
    if is_served(one):
        names |= {"push": "push", "kappa": "kappa", "tension": "F3"}
    if leaves:
        names |= {"tilt": "tilt", "gap": "gap"}
    arrays = {name: np.asarray(getattr(sol, of), dtype=float) for name, of in names.items()}
    if leaves:
        arrays["x"], arrays["y"] = sol.position[:, 0], sol.position[:, 1]
    elif sol.case.varies:
        arrays["axial"] = pipe_profile.axial_force(sol)
    kept = np.unique(np.linspace(0, sol.s.size - 1, min(sol.s.size, SENT)).round().astype(int))
    return {name: row[kept] for name, row in arrays.items()} if leaves else arrays


def is_served(one: LiveRod) -> bool:
    """Whether the page cannot compute the numbers of a rod itself."""
    return bool(one.sol.case.varies or one.sol.case.leaves)


def answer(one: LiveRod) -> dict[str, Any]:
    """A solved rod at its stations and its facts, as plain data."""
    return {**facts(one), "arrays": {name: array.tolist() for name, array in stations(one).items()}}


def facts(one: LiveRod) -> dict[str, Any]:
    """Outcome, error, condition number, notes and details of a solved rod, as plain data; what the page cannot compute.

    That are observables; intervals of contact and point forces of a rod that may leave the cylinder, and which
    equilibrium was let go.
    """
    sol, study = one.sol, one.study
    units = study.unit_system
    notes = []
    if not one.whole:
        notes.append(
            f"Only the first {labels.number(one.shown)} {units['length']} are shown: the rod bends too often for more."
        )
    words = [*free_rod_words.sentences(sol, units), *pipe_words.all_sentences(sol, units)]
    said = [labels.minus_signs(labels.sentence(sentence)) for sentence in words]
    return {
        "outcome": str(sol.outcome),
        "error": float(sol.error),
        "condition": float(sol.condition),
        "method": sol.method,
        "stations": sol.s.size,
        "notes": notes + [sentence for sentence in said if sentence.startswith(KEPT)],
        "details": [sentence for sentence in said if not sentence.startswith(KEPT)],
        "numbers": _observations(sol, units, SLOW) if is_served(one) else None,
        **({"contacts": sol.contacts, "point_forces": sol.point_forces} if sol.case.leaves else {}),
        **({} if one.held is None else {"equilibrium": which_is(one.held).model_dump(exclude_none=True)}),
    }


def _observations(sol: Solution, units: Mapping[str, str], left_out: Sequence[str] = ()) -> dict[str, Any]:
    """The observables of a rod, of which those with a known error have the digits of the command line."""
    names = [name for name in observables_of(sol.case.rod, sol.case.leaves) if name not in left_out]
    seen = {name: np.asarray(value).item() for name, value in observe(sol, names, errors=True).items()}

    def number(name: str) -> Any:
        error, unit = seen.get(f"{name}_error"), unit_habits.unit_shown(name, units)
        size = np.degrees(1.0) if unit == "rad" else unit_habits.size_shown(name, units)
        return seen[name] if error is None else float(unit_habits.within(seen[name] * size, error * size, 10)) / size

    return {name: number(name) for name in names}


def numbers(one: LiveRod) -> dict[str, Any]:
    """Loads and every observable as a row, in the units of the study and rad, and what a real rod could not do."""
    sol = one.sol
    observed = {name: float(getattr(sol, name)) for name in ("FZ", "MZ", "M3")}
    observed |= _observations(sol, one.study.unit_system)
    parts = caution_words.parts(str(caution_words.of_cases(sol, units=one.study.unit_system)))
    return {
        "rows": [{"name": name, "value": value} for name, value in observed.items()],
        "warnings": [labels.minus_signs(f"The rod {caution_words.phrase(part)}.") for part in parts],
    }


def list_equilibria(study: Study) -> list[dict[str, Any]]:
    """All equilibria of a rod between two ends, lowest energy first, as plain data. Raises `InputError`."""
    case = study.case()
    if not isinstance(case.given, Ends):
        raise InputError("a start problem has one solution only; hold both ends to list equilibria")
    refuse_many(case)
    listed: list[Equilibrium] = equilibria(case, TOL, STATIONS)
    return [_list_row(equilibrium, float(case.rho)) for equilibrium in listed]


def _list_row(equilibrium: Equilibrium, rho: float) -> dict[str, Any]:
    """The numbers of an equilibrium, with what a branch diagram shows of it, and its small picture."""
    shown = {name: np.asarray(value).item() for name, value in observe(equilibrium.solution, SHOWN).items()}
    return equilibrium_row(equilibrium) | shown | {"line": _line(equilibrium.solution, rho)}


def _line(sol: Solution, rho: float) -> dict[str, list[float]]:
    """The unrolled centreline, z to the right and the distance around the cylinder downward, for a small picture."""
    step = -(-(sol.s.size - 1) // SMALL)
    return round_rows({"z": sol.z[::step], "around": -rho * (sol.alpha - sol.alpha[0])[::step]}, 5)


def round_rows(rows: Mapping[str, Any], digits: int) -> dict[str, list[float]]:
    """Rows of numbers as plain data, rounded to so many digits."""
    return {name: [float(f"{value:.{digits}g}") for value in row] for name, row in rows.items()}


def rod_as_dataset(one: LiveRod) -> Any:
    """The dataset of a solved rod, as `workbench run` stores it. Raises `InputError` for a part of a rod."""
    if not one.whole:
        raise InputError("only a part of this rod is shown: run it as a study to export it")
    outputs = ["beta", "dbeta", "alpha", "z", "contact"]
    stored: dict[str, Any] = {"stations": one.sol.s.size, "outputs": outputs}
    if one.sol.case.leaves:
        stored |= {"outputs": [*outputs, "radius"], "tol": one.sol.tol}
    study = one.study.model_copy(update=stored)
    return dataset_assembly.make(study, Dimensions(), columns(study, one.sol))


def file(one: LiveRod, kind: str) -> bytes:
    """The bytes of an exported file with that suffix. Raises `InputError` as `stored_rod.export` does."""
    stored, sol, options = StoredStudy(rod_as_dataset(one)), one.sol, ExportOptions()
    if sol.case.leaves and kind == "step":  # whose default is finer than the places are known
        options = ExportOptions(tolerance=max(float(sol.error), LEAST_ERROR) * float(sol.case.rod.L))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"rod.{kind}"
        try:
            export(stored, path, options)
        except InputError as error:  # the page has none of the options that the rest of it names
            raise InputError(str(error).partition("; --")[0]) from None
        return path.read_bytes()


def follow_branches(study: Study, field: str, low: float, high: float) -> dict[str, Any]:
    """All branches that pass the state of a study or an end of the range of a field, between the ends of the range.

    Raises
    ------
    InputError
        For a start problem, a field that no diagram is over, and a rod with more equilibria than the page lists.
    """
    case = study.case()
    if not isinstance(case.given, Ends):
        raise InputError("a start problem has one solution only; hold both ends to follow its branches")
    check_known("field of a branch diagram", field, FIELDS)
    values = list(dict.fromkeys((float(value_of(case, field)), float(low), float(high))))  # those of the list first
    for value in values:
        refuse_many(with_field(case, field, value))
    begun = time.monotonic()
    seen = trace_branches(case, field, values, FEW, lambda *_: None, until=begun + PATIENCE)
    rows = [_row(seen, piece) for piece in seen.pieces]
    missing = sum(branch < 0 for row in seen.branch for branch in row)
    return {"field": field, "low": min(values), "high": max(values), "pieces": rows, "missing": missing}


def _row(seen: Traced, piece: Piece) -> dict[str, Any]:
    """Of a piece of a branch its index, and at each of its points the field, beta'(0) and what may be shown."""
    branch = seen.curves[piece.curve]
    whole = np.arange(piece.first, piece.last + 1)
    at = whole[np.unique(np.linspace(0, whole.size - 1, MOST_POINTS).round().astype(int))]
    part = replace(branch, points=tuple(branch.points[k] for k in at))
    sol = solutions_of(part, FEW)
    columns = observe(sol, SHOWN) | {"field": part.values, "dbeta0": sol.dbeta[:, 0]}
    return {"index": int(branch.index[whole[whole.size // 2]]), **round_rows(columns, 8)}
