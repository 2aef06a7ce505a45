"""The commands run, check and merge: the cases of a study solved, judged or joined, and what they print of it."""

import re
from collections.abc import Mapping
from functools import partial
from math import floor, log10
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.errors import InputError

from . import console
from .options import Fidelity, File, ForceStudy, Json, Method, Reading, Tol, argument, flag, option
from .present import Result, presents
from .stored_words import JUDGED, SAMPLING, print_sentences, print_verdicts

if TYPE_CHECKING:
    from ..run.run_and_resume import Ran


@presents()
def run(
    study: Annotated[str, argument("STUDY", "Name of a shipped study (see summary) or TOML file.")],
    out: Annotated[Path | None, option("FILE", "File of the stored study; default: STUDY.h5.", "--out", "-o")] = None,
    cases: Annotated[
        Path | None, option("FILE", "Solve the cases of this table, .csv or .parquet; default: [table] of the study.")
    ] = None,
    reading: Reading = None,
    tol: Tol = None,
    method: Method = None,
    level: Fidelity = None,
    stations: Annotated[int | None, option("COUNT", "Stations stored along the rod; default: the study's.")] = None,
    workers: Annotated[
        int | None, option("COUNT", "Processes on this machine; default: chosen automatically.", min=1)
    ] = None,
    scheduler: Annotated[
        str | None, option("ADDRESS", "Solve on the Dask cluster at tcp://host:port instead of this machine.")
    ] = None,
    chunk: Annotated[
        int | None, option("CASES", "Cases in one task of a worker, at most; default: chosen automatically.", min=1)
    ] = None,
    part: Annotated[
        str | None, option("K/N", "Solve the K-th of N parts alone, such as 1/2: each on a machine of its own.")
    ] = None,
    restart: Annotated[
        bool, flag("Discard the results of an earlier run, of all parts, and solve again.", "--restart")
    ] = False,
    force: ForceStudy = False,
    json: Json = False,
) -> Result:
    """Solve and store every case of a study and judge its laws.

    An interrupted run is resumed. If values were added to an axis of a complete study, only the new cases are solved.
    If anything else in the study has changed, all cases are solved again, the results in the file are replaced, and a
    line says what differs.

    Exit status 1 if a case is unsolved, or if a law is false, not decided or is true in part only.
    """
    from studies import load

    from ..run import atomic
    from ..run.block import keep_memory
    from ..run.run_and_resume import RunOptions, run_to_file
    from .fidelity import fidelity

    chosen = load(study, cases).under(reading)
    if level is not None:
        chosen = fidelity(level).of(chosen)
    if stations is not None:
        chosen = chosen.at_stations(stations)
    path = atomic.check_name(out or Path(f"{chosen.name}.h5"), atomic.STORED)
    if changes := {name: value for name, value in (("tol", tol), ("method", method)) if value is not None}:
        chosen = chosen.with_values(**changes)
    _check_free(path, chosen.name, force)
    keep_memory()
    options = RunOptions(workers, scheduler, chunk, restart, None if part is None else _part_of(part))
    say = (lambda text: None) if json else _say
    ran = run_to_file(chosen, path, options, say, partial(console.progress_bar, as_json=json))
    if ran.kept:
        data = {"study": chosen.name, "part": part, "kept": ran.kept, "solved_now": ran.solved, "seconds": ran.seconds}
        return Result(lambda: {**data, "status": 0}, lambda: console.say(ran.kept))
    named = {"title": chosen.title, "study": chosen.name, "reading": chosen.reading or "", "file": str(path)}
    return result_of({**named, **ran.statistics}, ran)


def _part_of(text: str) -> tuple[int, int]:
    """The numbers of ``1/2``. Raises `InputError`."""
    if (match := re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)) and 1 <= int(match[1]) <= int(match[2]):
        return int(match[1]), int(match[2])
    raise InputError(f"--part takes K/N, such as 1/2, with K from 1 to N, got {text!r}")


def _say(text: str) -> None:
    """Print a line; the runner would take an error of stdout for one of the file that it writes."""
    try:
        console.say(text)
    except OSError as error:
        raise InputError(f"cannot write the output: {error.strerror}") from None


def _check_free(path: Path, name: str, force: bool) -> None:
    """Raise `InputError` if `path` holds something that may not be replaced; imports xarray only if it must look."""
    from ..run.recipe import look

    existing = look(path)
    if force or (existing is not None and existing.name == name):
        return
    from ..run import writing

    writing.check_free(path, name, force=False)


@presents()
def check(file: File) -> Result:
    """Judge the laws of a stored study.

    Exit status 1 if a case is unsolved, or if a law is false, not decided or is true in part only.
    """
    from solver.problem.notices import kind_of, warn
    from studies.language.loader import notices

    from ..stored import reading
    from ..stored.stored_verdicts import statistics

    with reading.open_study(file, whole=True) as ds:
        named = {"title": ds.attrs["title"], "study": ds.attrs["study_name"], "reading": ds.attrs["reading"]}
        data = {**named, "file": str(file), **statistics(ds)}
        text = str(ds.attrs.get("study", ""))
    for sentence in notices(text, f"{file.name}, its study"):
        warn(sentence, kind_of(sentence))
    return result_of(data)


@presents()
def merge(
    files: Annotated[
        list[Path], argument("FILE...", "Two or more stored studies that differ in the values of one axis only.")
    ],
    out: Annotated[Path, option("FILE", "File of the joined study.", "--out", "-o")],
    force: ForceStudy = False,
) -> Result:
    """Join stored studies that extend each other along one axis.

    Exit status 1 if a case is unsolved, or if a law is false, not decided or is true in part only.
    """
    from studies.laws.law_words import count_of

    from ..run import atomic
    from ..run.file_merge import merge as join
    from ..stored import stored_verdicts

    done = join(files, atomic.check_name(out, atomic.STORED), force)
    status = stored_verdicts.status(done["unsolved"], done["laws"])

    def show() -> None:
        if done["laws"]:
            print_verdicts(done["laws"])
        console.say(f"{out}: {done['values']} values of {done['axis']} from {len(files)} files")
        console.say(f"{count_of(done['cases'], 'case')}, {done['unsolved']} unsolved")
        print_sentences(done, ["caution"])

    return Result(lambda: {**done, "status": status}, show, status)


def _print_outcomes(outcomes: Mapping[str, int], file: Path) -> None:
    """Print how often each outcome occurs but the plain one; of cases with fewer digits also which is the worst."""
    from solver.held.equilibrium_choice import INCOMPLETE
    from solver.problem.outcomes import FEWER

    from ..words.outcome_counts import group

    fewer = 0
    for text, count in sorted(group(outcomes).items()):
        if text == f"solved; {INCOMPLETE}":
            continue
        if FEWER in text:
            fewer += count
        elif text != "solved":
            console.say(f"  {count} x {text}")
    if fewer:
        console.say(f"  {_fewer_digits(fewer, file)}")


def _warnings(outcomes: Mapping[str, int], file: Path) -> list[str]:
    """In how many cases the list of equilibria may be incomplete, and where this is stored."""
    from solver.held.equilibrium_choice import INCOMPLETE

    count = sum(cases for text, cases in outcomes.items() if INCOMPLETE in text)
    said = (
        f"in {count} of {sum(outcomes.values())} cases the equilibrium was {INCOMPLETE}, so the number of "
        f"equilibria there is a lower bound; the outcome of each of these cases in {file} says so"
    )
    return [said] if count else []


def _fewer_digits(count: int, file: Path) -> str:
    """What cases have lost whose error is above the tolerance, how many digits remain, and which case is the worst."""
    from solver.problem.outcomes import BECAUSE
    from studies.laws import law_words

    from ..stored.file_summary import least_accurate

    worst = least_accurate(file)
    digits = max(floor(-log10(worst["error"])), 0)
    at = f"at {worst['at']}" if worst["at"] else ""
    which = f"the least accurate, {at}, has" if count > 1 else f"{at} it has".strip()
    are, lost = "are" if count > 1 else "is", law_words.count_of(digits, "digit")
    why = worst["outcome"].partition(BECAUSE)[2].partition(";")[0]
    return (
        f"{law_words.count_of(count, 'case')} {are} solved to fewer digits than the tolerance asks for: {which} "
        f"about {lost} (estimated error {worst['error']:.1e}), because {why}"
    )


def result_of(found: dict[str, Any], ran: "Ran | None" = None) -> Result:
    """What a stored study holds, and after a run what the run did; status 1 if a case is unsolved or a law is false."""
    from studies.laws import law_words

    from ..stored import stored_verdicts
    from ..words import caution_words

    outcomes, file = found["outcomes"], Path(found["file"])
    cases, unsolved = sum(outcomes.values()), found["unsolved"]
    status = stored_verdicts.status(unsolved, found["laws"])
    caution = caution_words.tell(found["cautions"])

    def data() -> dict[str, Any]:
        counts = {"cases": cases, "unsolved": unsolved, "outcomes": sorted(outcomes), "caution": caution}
        run = {} if ran is None else {"solved_now": ran.solved, "seconds": ran.seconds}
        named = {name: found[name] for name in ("study", "reading", "file")}
        named |= {name: found[name] for name in (*SAMPLING, *JUDGED[:2]) if found.get(name)}
        laws = {"verdicts": law_words.tally(found["laws"]), "laws": found["laws"]}
        return {**named, **counts, **run, **laws, "status": status}

    def show() -> None:
        console.say(f"{found['title']}, {found['reading']}" if found["reading"] else found["title"])
        if found["laws"]:
            print_verdicts(found["laws"], alternatives=True)
        console.say(f"{file}: {law_words.count_of(cases, 'case')}, {unsolved} unsolved")
        _print_outcomes(outcomes, file)
        print_sentences({**found, "caution": caution}, (*SAMPLING, *JUDGED))
        if ran is not None and ran.finished_before:
            console.say("already complete; use --restart to solve again")

    return Result(data, show, status, warnings=_warnings(outcomes, file))
