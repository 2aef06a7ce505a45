"""The command trade: accuracy against cost of every method, and its result at every named extreme."""

from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from solver.problem.errors import InputError

from ..commands import console, tables
from ..commands.options import flag, names, option
from ..commands.present import Result, presents

if TYPE_CHECKING:
    import xarray as xr


@presents()
def trade(
    cases: Annotated[list[str] | None, option("NAMES", "Cases to measure, separated by commas; default: all.")] = None,
    methods: Annotated[
        list[str] | None, option("NAMES", "Methods to measure, separated by commas; default: all.")
    ] = None,
    extremes: Annotated[
        bool, flag("Instead test every method at forty named extremes of the parameters.", "--extremes")
    ] = False,
    out: Annotated[
        Path | None,
        option("FOLDER", "Folder for the data and the pictures; default: trade or extremes.", "--out", "-o"),
    ] = None,
    force: Annotated[bool, flag("Replace a file in the folder even if no trade wrote it.", "--force")] = False,
) -> Result:
    """Measure the accuracy and the cost of every method, or its robustness.

    Each method solves cases with a known solution, at several values of its own setting of accuracy (steps, nodes or
    a tolerance). The folder receives trade.h5, and trade_seconds.png and trade_evaluations.png with six cases at most.

    With --extremes each method solves one case at each extreme. The folder receives extremes.h5 and extremes.png, a map
    of methods against extremes. Exit status 1 if a method calls an inaccurate answer solved.

    When interrupted, the command stores and draws what is finished as trade_interrupted or extremes_interrupted; the
    file of an earlier run stays unchanged.
    """
    if extremes and (cases or methods):
        raise InputError("--extremes tests every method at every extreme; it takes no --cases and no --methods")
    from ..run import writing

    folder = out or Path("extremes" if extremes else "trade")
    with writing.folder_of_results(folder):
        return _extremes(folder, force) if extremes else _trade(cases or [], methods or [], folder, force)


def _trade(cases: list[str], methods: list[str], out: Path, force: bool) -> Result:
    from . import trade_runs as comparison
    from .trade_figure import COSTS

    named, ladders = comparison.choose(names(cases)), comparison.ladders_of(names(methods))
    comparison.check_kinds(named, ladders)

    def to_dataset(pieces: "Sequence[Any]") -> "xr.Dataset":
        return comparison.as_dataset([row for rows in pieces for row in rows], ladders)

    pictures = {f"_{cost}": {"kind": "trade", "cost": cost} for cost in COSTS}
    measure = partial(comparison.rows_of, named, ladders)
    ds, files = _measure(measure, len(named), "cases", to_dataset, out / "trade.h5", pictures, force)
    summary = comparison.summary_of(ds)
    stored = {"file": str(files[0]), "pictures": [str(picture) for picture in files[1:]]}
    return Result(lambda: summary | stored, lambda: _print(summary, files))


def _print(found: Mapping[str, Any], files: Sequence[Path]) -> None:
    rows = [
        [
            row["case"],
            *(f"{b['method']}  {1e3 * b['seconds']:.2g} ms" if b["method"] else "none" for b in row["cheapest"]),
        ]
        for row in found["table"]
    ]
    levels = [f"{best['level']:.0e}" for best in found["table"][0]["cheapest"]]
    tables.print_table(["cheapest method for", *levels], rows)
    console.say("")
    counts = f"{found['solved']} runs solved, {found['failed']} failed, {found['not run']} omitted as too slow"
    console.say(f"{counts}; {found['machine']}")
    console.say("")
    for row in found["advice"]:
        console.say(_advice(row))
    for file in files:
        console.say(str(file))


def _advice(row: Mapping[str, Any]) -> str:
    """``For an error of 1e-06 in start problems: swing (17 of 17 cases, median 0.19 ms).``"""
    goal = f"For an error of {row['level']:.0e} in {row['kind']} problems:"
    if row["method"] is None:
        return f"{goal} no method reaches it."
    return f"{goal} {row['method']} ({row['reached']} of {row['cases']} cases, median {1e3 * row['seconds']:.2g} ms)."


def _extremes(out: Path, force: bool) -> Result:
    from . import extreme_runs
    from .extreme_runs import INACCURATE, VERDICTS, as_dataset, rows_of

    named = extreme_runs.extremes()

    def to_dataset(pieces: "Sequence[Any]") -> "xr.Dataset":
        return as_dataset(dict(pieces))

    measure = partial(rows_of, named)
    ds, files = _measure(measure, len(named), "extremes", to_dataset, out / "extremes.h5", {"": {}}, force)
    counts = {
        str(method): {verdict: int((ds["verdict"].sel({"method": method}) == verdict).sum()) for verdict in VERDICTS}
        for method in ds["method"].values
    }

    def show() -> None:
        rows = [[method, *map(str, row.values())] for method, row in counts.items()]
        tables.print_table(["method", *VERDICTS], rows, str(ds.attrs["title"]))
        console.say("\n".join(map(str, files)))

    status = 1 if any(row[INACCURATE] for row in counts.values()) else 0
    return Result(lambda: {"methods": counts, "files": [str(file) for file in files]}, show, status)


def _measure(
    begin: Callable[[Callable[[str], None]], Generator[Any]],
    total: int,
    what: str,
    dataset: "Callable[[list[Any]], xr.Dataset]",
    path: Path,
    pictures: Mapping[str, Mapping[str, Any]],
    force: bool,
) -> "tuple[xr.Dataset, list[Path]]":
    """Work piece by piece, with a bar, and store the pieces, interrupted the finished ones: the dataset and the files.

    Parameters
    ----------
    begin
        Yields the pieces; it takes what is called with a text when each of them begins. An empty piece does not count.
    total, what
        The number of pieces, and their name: cases.
    dataset
        That of pieces.
    path
        Of the dataset; interrupted: NAME_interrupted.
    pictures
        What is added to the name of the file for each picture -> the options of its figure.
    force
        Whether a file of another kind is replaced.
    """
    from ..figures import canvas, figure_kinds
    from ..run import writing
    from ..stored.stored_study import StoredStudy

    writing.check_free(path, path.stem, force)
    pieces: list[Any] = []

    def store(path: Path) -> "tuple[xr.Dataset, list[Path]]":
        ds, files = dataset(pieces), [path]
        writing.write(ds, path, force)
        for more, options in pictures.items():
            files.append(path.with_name(f"{path.stem}{more}.png"))
            drawn = figure_kinds.figure(StoredStudy(ds), **options)
            canvas.save(drawn, files[-1], drawn.dpi)
        return ds, files

    try:
        with console.progress(total, lines=True) as step, closing(begin(step)) as work:
            for piece in work:
                pieces += [piece] if piece else []
    except BaseException as error:
        kept = "nothing was finished yet"
        if pieces:
            _, files = store(path.with_name(f"{path.stem}_interrupted.h5"))
            kept = f"{len(pieces)} of {total} {what} are stored in {', '.join(map(str, files))}"
        if isinstance(error, KeyboardInterrupt):
            error.args = (f"interrupted; {kept}",)
        else:
            console.warn(kept)
        raise
    return store(path)
