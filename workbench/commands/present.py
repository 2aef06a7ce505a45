"""Present the result of a command: sentences and tables or JSON, a dataset in a file, a picture.

A command returns a `Result`; `presents` gives it the options of what it writes, and calls `present`.
"""

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from . import console
from .options import Dpi, ForceOutput, Json, NoTitle, Style, Width, flag, option

if TYPE_CHECKING:
    import xarray as xr

    from ..figures.sheet import Sheet


@dataclass(frozen=True)
class Files:
    """The files that a command is asked for, each checked before anything is computed.

    picture, out: of the figure and of the dataset, or None. force: whether `out` may replace a file of another kind.
    sheet, dpi: of the picture; sheet: default: that of the screen.
    """

    picture: Path | None = None
    out: Path | None = None
    force: bool = False
    sheet: "Sheet | None" = None
    dpi: int = 200


@dataclass(frozen=True)
class Result:
    """What a command found.

    data: it as plain data. show: prints it for people. status: the exit status. dataset: it as a dataset, which is
    drawn, and stored unless `write` writes it in another form; without the two no file is written. figure: the kind of
    its figure; default: that of the kind of file. warnings: sentences for stderr. names_files: whether the written
    files are named below what is shown. afterwards: what the command does once all is presented, as serve a page.
    """

    data: Callable[[], Any]
    show: Callable[[], None]
    status: int = 0
    dataset: "Callable[[], xr.Dataset] | None" = None
    write: Callable[[Path], object] | None = None
    figure: str | None = None
    warnings: Sequence[str] = ()
    names_files: bool = False
    afterwards: Callable[[], None] | None = None


def result_of_files(
    paths: Sequence[Path], sentences: Sequence[str] = (), warnings: Sequence[str] = (), status: int = 0
) -> Result:
    """The result of a command that has written files; sentences: that it prints, default: their paths."""
    said = [*(sentences or map(str, paths))]
    data = {"files": [*map(str, paths)], "said": said, "warnings": [*warnings], "status": status}
    return Result(lambda: data, lambda: console.say("\n".join(said)) if said else None, status, warnings=warnings)


def presents(
    plot: str = "",
    out: str = "",
    kind: str = "",
    suffixes: tuple[str, ...] = (),
    force: str = "",
    short: str = "",
) -> Callable[[Callable[..., Result]], Callable[..., int]]:
    """Decorate a command that returns a `Result`: it is presented, and the command returns its exit status.

    Parameters
    ----------
    plot, out : str
        The help of the options --plot and --out of a command that draws and stores; else it has none of these, and
        --json alone.
    kind, suffixes : str, tuple of str
        Of `out`, as of `check_files`.
    force : str
        The help of --force; default: that of other commands.
    short : str
        Of the options --plot and --out the one that is also -o.
    """
    written = _options(plot, out, force, short) if plot else {}
    shared: dict[str, tuple[Any, Any]] = {**written, "json": (Json, False)}

    def decorate(command: Callable[..., Result]) -> Callable[..., int]:
        signature = inspect.signature(command)
        takes_json = "json" in signature.parameters

        @wraps(command)
        def run(*args: Any, **options: Any) -> int:
            chosen = {name: options.pop(name, default) for name, (_, default) in shared.items()}
            as_json = chosen.pop("json")
            files = check_files(**chosen, kind=kind, suffixes=suffixes) if written else Files()
            result = command(*args, **options, **({"json": as_json} if takes_json else {}))
            present(result, as_json, files)
            if result.afterwards is not None:
                result.afterwards()
            return result.status

        keyword = inspect.Parameter.KEYWORD_ONLY
        parameters = [*signature.parameters.values()]
        parameters += [
            inspect.Parameter(name, keyword, default=default, annotation=annotation)
            for name, (annotation, default) in shared.items()
            if name not in signature.parameters
        ]
        run.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        return run

    return decorate


def _options(plot: str, out: str, force: str, short: str) -> dict[str, tuple[Any, Any]]:
    """The options of what a command writes: name -> type and default."""
    o = {name: [f"--{name}", *(["-o"] if name == short else [])] for name in ("plot", "out")}
    return {
        "plot": (Annotated[Path | None, option("FILE", plot, *o["plot"])], None),
        "out": (Annotated[Path | None, option("FILE", out, *o["out"])], None),
        "style": (Style, "screen"),
        "width": (Width, None),
        "no_title": (NoTitle, False),
        "dpi": (Dpi, 200),
        "force": (Annotated[bool, flag(force, "--force")] if force else ForceOutput, False),
    }


def check_files(
    plot: Path | None,
    out: Path | None,
    style: str,
    width: float | None,
    no_title: bool,
    dpi: int,
    force: bool,
    kind: str = "",
    suffixes: tuple[str, ...] = (),
) -> Files:
    """The files of these options. Raises `InputError`, also for an option of a picture without a picture.

    kind: of the dataset, as of `writing.check_free`: what `out` holds already may be replaced if it is of this kind.
    suffixes: those of `out` where it is no dataset.
    """
    from ..store import writing
    from . import option_checks

    sheet = option_checks.page(plot, style, width, no_title)
    if plot is not None:
        from ..figures import canvas

        option_checks.check(plot, canvas.DIAGRAMS, force)
    if out is not None and suffixes:
        option_checks.check(out, suffixes, force)
    elif out is not None:
        writing.check_parent(out)
        if not force:
            writing.check_free(out, kind)
    return Files(plot, out, force, sheet, dpi)


def present(result: Result, as_json: bool, files: Files) -> None:
    """Store and draw what is asked for, then print it; of a picture also what it leaves to its caption."""
    notes: Sequence[str] = ()
    ds = None
    if result.dataset is not None and (files.picture or (files.out and result.write is None)):
        ds = result.dataset()
    if files.out and result.write is not None:
        result.write(files.out)
    elif files.out and ds is not None:
        from ..store import writing

        writing.write(ds, files.out, files.force)
    if files.picture and ds is not None:
        from ..figures import canvas, kinds, legend
        from ..figures.sheet import SCREEN

        drawn = kinds.figure(ds, result.figure, files.sheet or SCREEN)
        canvas.save(drawn, files.picture, files.dpi)
        notes = legend.notes_of(drawn)
    if as_json:
        console.print_json(result.data())
    else:
        result.show()
        for note in notes:
            console.say(note)
        for path in (files.out, files.picture) if result.names_files else ():
            if path is not None:
                console.say(str(path))
    if (files.out or files.picture) and result.dataset is None and result.write is None:
        console.warn("no file is written: there is no solved case to store or draw")
    for sentence in result.warnings:
        console.warn(sentence)
