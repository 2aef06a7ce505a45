"""The entry point of the command line: it registers the commands and turns errors into one sentence on stderr.

Exit status: 0 done; 1 done, but for example a case is unsolved or a law fails; 2 invalid input; 130 interrupted.
The modules of the commands import heavy libraries inside their functions, so that --help answers at once.
"""

import errno
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache, partial, wraps
from typing import Annotated, Any

try:
    import typer
except ModuleNotFoundError:
    sys.exit("workbench: the command line needs more than the solver: pip install rod-workbench, without --no-deps")

from . import __version__
from .commands import (
    animate,
    check,
    docs,
    doctor,
    equilibria,
    explore,
    export,
    extremes,
    fit,
    folds,
    gallery,
    help_pages,
    list_studies,
    loops,
    merge,
    plot,
    reproduce,
    run,
    scene,
    sensitivity,
    solve,
    summary,
    trade,
)
from .words import escaping

OF_SCENE = ("pyvista", "trimesh", "vtkmodules")  # packages of the extra scene
NOTICE = r".* is read as .* rad = "  # the warnings of `solver.problem.angles`, which --help does not import
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # a disk that takes no more
LONGEST = 200  # characters of a value in a message; a path of a usual length stays whole
INTERRUPTED = 130  # 128 and the number of the signal that Ctrl-C sends

COMMANDS: dict[str, Callable[..., int]] = {  # in the order of --help; each returns the exit status
    "reproduce": reproduce.reproduce,
    "list": list_studies.list_studies,
    "run": run.run,
    "check": check.check,
    "summary": summary.summary,
    "merge": merge.merge,
    "plot": plot.plot,
    "scene": scene.scene,
    "animate": animate.animate,
    "gallery": gallery.gallery,
    "export": export.export,
    "solve": solve.solve,
    "equilibria": equilibria.equilibria,
    "folds": folds.folds,
    "loops": loops.loops,
    "sensitivity": sensitivity.sensitivity,
    "fit": fit.fit,
    "explore": explore.explore,
    "trade": trade.trade,
    "extremes": extremes.extremes,
    "doctor": doctor.doctor,
    "docs": docs.docs,
}

app = typer.Typer(
    cls=help_pages.Overview,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["--help", "-h"], "max_content_width": 110},
)


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"workbench {__version__}")
        raise typer.Exit()


@app.callback()
def start(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", is_eager=True, callback=_show_version)
    ] = False,
) -> None:
    """The shape of an elastic rod on a cylinder: solve, study, store, draw and check."""


OLD = {  # name of a command that goes -> what does the same
    "animate": "scene --out film.mp4",
}


def _with_exit_status(name: str, command: Callable[..., int]) -> Callable[..., None]:
    """The command as the parser calls it: it exits with its status, and an interruption keeps its message."""

    @wraps(command)
    def run(*args: Any, **options: Any) -> None:
        try:
            status = command(*args, **options)
            if name in OLD:
                print(f"workbench: {name} will go: use {OLD[name]}", file=sys.stderr)
            raise typer.Exit(status)
        except KeyboardInterrupt as error:
            stopped = typer.TyperException(str(error) or "interrupted; the stored files are complete")
            stopped.exit_code = INTERRUPTED
            raise stopped from None

    return run


for _name, _command in COMMANDS.items():
    app.command(_name, cls=help_pages.CommandHelp)(_with_exit_status(_name, _command))


def main(args: list[str] | None = None) -> None:
    """Run the command line and exit; an error is one sentence on stderr, and so is a notice."""
    words = (sys.argv[1:] if args is None else args) or ["--help"]
    if sys.stderr is None:  # as a shell closes it with 2>&-
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115  (to the end of the process)
    if sys.stdout is None:
        print("workbench: stdout is closed; give it a file or a pipe, or /dev/null", file=sys.stderr)
        sys.exit(2)
    with warnings.catch_warnings():
        warnings.filterwarnings("always", NOTICE)
        warnings.showwarning = _printer_of_warnings(warnings.showwarning)
        _run(words)


def _printer_of_warnings(others: Callable[..., None]) -> Callable[..., None]:
    """What shows a warning: a notice as one sentence, and only once; any other as before."""
    said = set()

    def show(message: Warning | str, *where: Any, **more: Any) -> None:
        sentence = str(message)
        if not re.match(NOTICE, sentence):
            others(message, *where, **more)
        elif sentence not in said:
            said.add(sentence)
            print(f"workbench: notice: {escaping.line(sentence)}", file=sys.stderr)

    return show


@cache
def _parser() -> Any:
    """The commands as the parser reads them; a process that runs many makes them once."""
    return typer.main.get_command(app)


def _run(words: list[str]) -> None:
    fail = partial(_fail, words)
    try:
        status = _parser()(words, prog_name="workbench", standalone_mode=False)
        sys.stdout.flush()
        sys.exit(status)
    except typer.TyperException as error:
        fail(_sentence(error), error.exit_code)
    except (KeyboardInterrupt, typer.Abort):  # before the command begins
        fail("interrupted", INTERRUPTED)
    except BrokenPipeError:  # the reader of the output has ended, as head does
        sys.stderr.close()
        sys.exit(0)
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            fail(f"cannot open {error.filename!r}: {error.strerror}", 2)
        if error.errno not in NO_ROOM:
            raise
        fail(f"cannot write {error.filename or 'the output'}: {error.strerror}", 2)
    except ImportError as error:
        from solver.core.library import MissingCore

        from .scene.opengl import MISSING

        if isinstance(error, MissingCore):
            fail(str(error), 2)
        if (error.name or "").partition(".")[0] not in OF_SCENE:
            raise
        fail(f"{MISSING} ({error.name} is missing)", 2)
    except ValueError as error:
        from solver.problem.errors import InputError

        if not isinstance(error, InputError):
            raise
        fail(str(error), 2)


def _sentence(error: typer.TyperException) -> str:
    """The message of the parser, with the choices if it omits them."""
    message = error.format_message().rstrip(".")
    context = getattr(error, "ctx", None)
    command: Any = context.command if context else None
    if command and message.startswith("No such command"):
        known = list(command.commands)
        return f"{message.partition('. Did')[0]}{_near(message, known)}; choose from {', '.join(known)}"
    if command and message.startswith("No such option"):
        spelt = [[name for name in param.opts if name.startswith("-")] for param in command.params]
        each = [max(names, key=lambda name: name.startswith("--")) for names in spelt if names]  # of two spellings one
        stated = message.partition(" (")[0]
        if command.name == "solve" and stated.endswith(" --seed"):
            return f"{stated}; a shape to begin with is given in Python: solve(case, seed='straight') or seed=solution"
        return f"{stated}{_near(message, each)}; choose from {', '.join(each)}"
    return message


def _near(message: str, known: Iterable[str]) -> str:
    """What may have been meant instead of the name that a message of the parser quotes."""
    from solver.problem.errors import near

    quoted = re.search(r"['\"]([^'\"]*)['\"]|: (\S+)", message)
    if quoted is None:
        return ""
    name = quoted[1] or quoted[2]
    dashes = "--" if name.startswith("--") else ""  # they are no likeness
    return near(name.removeprefix(dashes), [word.removeprefix(dashes) for word in known]).replace(" '", f" '{dashes}")


def _fail(words: list[str], sentence: str, status: int) -> None:
    with suppress(OSError):  # stderr may be full as well; then the status alone says it
        print(f"workbench: {escaping.line(_cut(sentence, words))}", file=sys.stderr)
    _end_output()
    sys.exit(status)


def _cut(sentence: str, words: list[str]) -> str:
    """The sentence in which a long word of the command line, or any other long word, is cut; lists stay whole."""
    for word in words:
        for given in (word, repr(word)[1:-1]):
            if len(given) > LONGEST:
                sentence = sentence.replace(given, f"{given[:LONGEST]}...")
    return re.sub(rf"(\S{{{LONGEST}}})\S+?(['\",:;]*(?:\s|$))", r"\1...\2", sentence)


def _end_output() -> None:
    """Write what the streams still hold, or discard it where that fails, so that Python does not try again at exit."""
    for stream in (sys.stdout, sys.stderr):
        if stream is None:
            continue
        try:
            stream.flush()
        except OSError:
            with open(os.devnull, "w") as nothing:
                os.dup2(nothing.fileno(), stream.fileno())


if __name__ == "__main__":
    main()
