"""The command run: solve, store and judge every case of a study."""

from functools import partial
from pathlib import Path
from typing import Annotated

from . import console
from .options import Fidelity, ForceStudy, Json, Method, Reading, Tol, argument, flag, option
from .present import Result, presents
from .study_result import result_of

READ = (".toml", ".csv", ".parquet")  # the files of studies and tables


@presents()
def run(
    study: Annotated[str, argument("STUDY", "Name of a shipped study (see list) or TOML file.")],
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
        int | None, option("CASES", "Cases in one task of a worker; default: a few seconds of work.", min=1)
    ] = None,
    restart: Annotated[
        bool, flag("Discard the results of an earlier run and solve every case again.", "--restart")
    ] = False,
    force: ForceStudy = False,
    json: Json = False,
) -> Result:
    """Solve and store every case of a study and judge its laws.

    An interrupted run is resumed. If values were added to an axis of a complete study, only the new cases are solved.
    If anything else in the study has changed, all cases are solved again, the results in the file are replaced, and a
    line says what differs.

    Exit status 1 if a case is unsolved, or if a law fails, is not decided or is true in part only.
    """
    from solver.problem.errors import InputError
    from studies import load

    from ..store import worker_processes
    from ..store.study_store import Options, run_to_file
    from .fidelity import fidelity

    chosen = load(study, cases).under(reading)
    if level is not None:
        chosen = fidelity(level).of(chosen)
    if stations is not None:
        chosen = chosen.at_stations(stations)
    path = out or Path(f"{chosen.name}.h5")
    if path.suffix.lower() in READ:
        raise InputError(
            f"a run reads {path.suffix} files and writes none, got {str(path)!r}; give a name such as {path.stem}.h5"
        )
    changes = {name: value for name, value in (("tol", tol), ("method", method)) if value is not None}
    chosen = chosen.model_copy(update=changes)
    _check_free(path, chosen.name, force)
    worker_processes.keep_memory()
    options = Options(workers, scheduler, chunk, restart)
    say = (lambda text: None) if json else _say
    ran = run_to_file(chosen, path, options, say, partial(console.progress_bar, as_json=json))
    found = {"title": chosen.title, "study": chosen.name, "reading": chosen.reading or "", "file": str(path)}
    return result_of({**found, **ran.statistics}, ran)


def _say(text: str) -> None:
    """Print a line; the runner would take an error of stdout for one of the file that it writes."""
    from solver.problem.errors import InputError

    try:
        console.say(text)
    except OSError as error:
        raise InputError(f"cannot write the output: {error.strerror}") from None


def _check_free(path: Path, name: str, force: bool) -> None:
    """Raise `InputError` if `path` holds something that may not be replaced; imports xarray only if it must look."""
    from ..store.growth import look

    there = look(path)
    if force or (there is not None and there.name == name):
        return
    from ..store import writing

    writing.check_free(path, name)
