"""Present the result of a command: sentences and tables or JSON, a dataset in a file, a picture.

A command returns a `Result`; `presents` gives it the options of its case and of what it writes, and calls `present`.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, fields, is_dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

from solver.problem.errors import InputError

from ..run.atomic import Undone
from . import case_options, console
from .options import Dpi, ForceOutput, Json, NoTitle, Style, Width, check_file, flag, option

if TYPE_CHECKING:
    import xarray as xr

    from ..figures.sheet import Sheet


@dataclass(frozen=True)
class Result:
    """What a command found.

    data: it as plain data. show: prints it for people. status: the exit status. dataset: it as a dataset, which is
    drawn, and stored unless `write` writes it in another form; without the two no file is written. figure: the kind of
    its figure; default: that of the kind of file. warnings: sentences for stderr. afterwards: what the command does
    once all is presented, as serve a page.
    """

    data: Callable[[], Any]
    show: Callable[[], None]
    status: int = 0
    dataset: "Callable[[], xr.Dataset] | None" = None
    write: Callable[[Path], object] | None = None
    figure: str | None = None
    warnings: Sequence[str] = ()
    afterwards: Callable[[], None] | None = None


@dataclass(frozen=True)
class _Files:
    """What a command is asked to write, and how a picture is drawn."""

    plot: Path | None = None
    out: Path | None = None
    style: Style = "screen"
    width: Width = None
    no_title: NoTitle = False
    dpi: Dpi = 200
    force: bool = False


OF_PICTURES = tuple(field.name for field in fields(_Files) if field.name not in ("plot", "out", "force"))


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
    short: str = "out",
    case: Sequence[str] = (),
) -> Callable[[Callable[..., Result]], Callable[..., int]]:
    """Decorate a command that returns a `Result`: it is presented, and the command returns its exit status.

    In place of a parameter that is a dataclass stand its fields, each an option.

    Parameters
    ----------
    plot, out : str
        The help of the options --plot and --out of a command that draws and stores; else it has none of these, and
        --json alone.
    kind, suffixes : str, tuple of str
        Of `out`: what it holds already may be replaced if it is a dataset of this kind; its suffixes where it is none.
    force : str
        The help of --force; default: that of other commands.
    short : str
        The option that is also -o.
    case : sequence of str
        The fields of a case: their options, and those of the two units, stand in place of the parameter `given`.
    """
    written = _options(plot, out, force, short) if plot else {}
    given = {name: (kind_, None) for name, kind_ in case_options.of_case(case).items()} if case else {}

    def decorate(command: Callable[..., Result]) -> Callable[..., int]:
        signature = inspect.signature(command)
        types = {name: each.annotation for name, each in signature.parameters.items() if name != "given"}
        records: dict[str, Any] = {name: record for name, record in types.items() if is_dataclass(record)}
        takes_json = "json" in signature.parameters
        shared = written if takes_json else written | {"json": (Json, False)}

        @wraps(command)
        def run(*args: Any, **options: Any) -> int:
            files = _Files(**{name: options.pop(name) for name in written if name in options})
            as_json = options.get("json", False) if takes_json else options.pop("json", False)
            sheet = _sheet_of(files, kind, suffixes) if written else None
            if case:
                options["given"] = case_options.case_given_by(options, case)
            for name, record in records.items():
                named = [field.name for field in fields(record) if field.name in options]
                options[name] = record(**{field: options.pop(field) for field in named})
            try:
                with console.remark_on_time() if case else nullcontext():
                    result = command(*args, **options)
            except Undone as error:
                result = result_of_files([], warnings=[str(error)], status=1)
            present(result, as_json, files, sheet)
            if result.afterwards is not None:
                result.afterwards()
            return result.status

        replaced = {name: _options_of(record) for name, record in records.items()} | {"given": given}
        run.__signature__ = _signature_with(signature, replaced, shared)  # type: ignore[attr-defined]
        return run

    return decorate


def _signature_with(
    signature: inspect.Signature, options: Mapping[str, dict[str, Any]], shared: dict[str, Any]
) -> inspect.Signature:
    """The signature with options in place of the parameters of these names, and the shared options behind them."""
    parameters: list[inspect.Parameter] = []
    for name, parameter in signature.parameters.items():
        parameters += _parameters(options[name]) if name in options else [parameter]
    return signature.replace(parameters=parameters + _parameters(shared))


def _options_of(record: Any) -> dict[str, tuple[Any, Any]]:
    """The type and the default of each field of a dataclass."""
    types = get_type_hints(record, include_extras=True)
    return {field.name: (types[field.name], field.default) for field in fields(record)}


def _parameters(options: dict[str, tuple[Any, Any]]) -> list[inspect.Parameter]:
    """The parameters of options: name -> type and default."""
    return [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)
        for name, (kind, default) in options.items()
    ]


def _options(plot: str, out: str, force: str, short: str) -> dict[str, tuple[Any, Any]]:
    """The options of what a command writes: name -> type and default."""
    o = {name: [f"--{name}", *(["-o"] if name == short else [])] for name in ("plot", "out")}
    return {
        "plot": (Annotated[Path | None, option("FILE", plot, *o["plot"])], None),
        "out": (Annotated[Path | None, option("FILE", out, *o["out"])], None),
        **{name: kind for name, kind in _options_of(_Files).items() if name in OF_PICTURES},
        "force": (Annotated[bool, flag(force, "--force")] if force else ForceOutput, False),
    }


def _sheet_of(files: _Files, kind: str, suffixes: tuple[str, ...]) -> "Sheet | None":
    """The sheet of the picture, before anything is computed; None without a picture.

    Raises `InputError` for a file that cannot be written, and for an option of a picture without a picture.
    """
    from ..run import writing

    if files.out is not None and suffixes:
        check_file(files.out, suffixes, files.force)
    elif files.out is not None:
        writing.check_free(files.out, kind, files.force)
    if files.plot is None:
        for name in OF_PICTURES:
            if getattr(files, name) != getattr(_Files(), name):
                raise InputError(f"--{name.replace('_', '-')} is an option of the picture: give also --plot FILE")
        return None
    from ..figures import canvas
    from ..figures.sheet import sheet

    check_file(files.plot, canvas.DIAGRAMS, files.force)
    return sheet(files.style, files.width, not files.no_title)


def present(result: Result, as_json: bool, files: _Files, sheet: "Sheet | None") -> None:
    """Store and draw what is asked for, then print it, the caption of a picture, and the files that are written."""
    plot, out, caption, written, dataset = files.plot, files.out, list[str](), list[Path](), None
    if result.dataset is not None and (plot or (out and result.write is None)):
        dataset = result.dataset()
    if out and result.write is not None:
        result.write(out)
        written.append(out)
    elif out and dataset is not None:
        from ..run import writing

        writing.write(dataset, out, files.force)
        written.append(out)
    if plot and dataset is not None:
        from ..figures import canvas, figure_kinds
        from ..stored.stored_study import StoredStudy

        assert sheet is not None
        drawn = figure_kinds.figure(StoredStudy(dataset), result.figure, sheet)
        canvas.save(drawn, plot, files.dpi)
        written.append(plot)
        caption = canvas.caption(drawn)
    if as_json:
        console.print_json(result.data())
    else:
        result.show()
        for line in (*caption, *map(str, written)):
            console.say(line)
    if (out or plot) and not written:
        console.warn("no file is written: there is no solved case to store or draw")
    for sentence in result.warnings:
        console.warn(sentence)
