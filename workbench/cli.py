"""The entry point of the command line: it registers the commands and turns errors into one sentence on stderr.

Exit status: 0 done; 1 done, but for example a case is unsolved or a law is false; 2 invalid input; 130 interrupted.
The modules of the commands import heavy libraries inside their functions, so that --help answers at once.
"""

import errno
import io
import os
import re
import sys
import traceback
import warnings
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache, partial, wraps
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

try:
    import typer
    from typer.core import TyperCommand, TyperGroup
except ModuleNotFoundError:
    sys.exit("workbench: the command line needs more than the solver: pip install rod-workbench, without --no-deps")

from solver.problem.errors import InputError, near

from . import __version__
from .commands import (
    docs,
    doctor,
    draw_scene,
    explore,
    export_rod,
    fit,
    folds,
    list_equilibria,
    list_loops,
    plot,
    print_schema,
    run_study,
    sensitivity,
    solve_case,
    summary,
)
from .run import atomic
from .words import escaping

OF_SCENE = ("pyvista", "trimesh", "vtkmodules")  # packages of the extra scene
NOTICE = r".* is (read as .* = |now called )"  # the warnings of `solver.problem`, which --help does not import
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # a disk that takes no more
LONGEST = 200  # characters of a value in a message; a path of a usual length stays whole
INTERRUPTED = 130  # 128 and the number of the signal that Ctrl-C sends

# heading of --help -> its commands: name -> what runs it and returns the exit status, and examples
GROUPS: dict[str, dict[str, tuple[Any, ...]]] = {
    "One rod": {
        "solve": (
            solve_case.solve,
            "solve",
            "solve --table1 --E 2e4 --beta 45deg",
            "solve --length-unit m --force-unit kN --E 2.06e8 --nu 0.3 --a 0.06 --L 20 --R 0.11 --side inside "
            "--beta0 0 --betaL 0 --FZ -200",
            "solve --length-unit mm --E 2e5 --nu 0.3 --a 1 --L 1500 --R 60 --tension 500 --lay 80deg",
        ),
        "explore": (explore.explore, "explore", "explore fig7_1_modulus"),
        "fit": (
            fit.fit,
            "fit fig7_1_modulus --at E=10905 --target height=9 --vary F1 --bounds F1=1:9",
            "fit my_rod.toml --points points.csv --vary E,M3 --plot fit.png",
        ),
    },
    "Studies": {
        "run": (run_study.run, "run fig7_1_modulus", "run study.toml --out study.h5 --tol 1e-10"),
        "summary": (summary.summary, "summary", "summary fig7_1_modulus.h5"),
        "check": (run_study.check, "check fig7_1_modulus.h5"),
        "merge": (run_study.merge, "merge first.h5 second.h5 --out both.h5"),
        "sensitivity": (
            sensitivity.sensitivity,
            "sensitivity fig7_1_modulus --at E=5000 --show height,turns_around --plot tornado.pdf",
            "sensitivity study.h5 --global --plot indices.png",
        ),
    },
    "Pictures and files": {
        "plot": (plot.plot, "plot regimes.h5 --show bends --shapes 6x4", "plot fig7_1_modulus.h5 --out figure.pdf"),
        "scene": (
            draw_scene.scene,
            "scene fig6 --kind contact",
            "scene fig7_1_modulus --at E=5000 --out soft.png",
            "scene fig7_4_end_angle.h5 --out end.mp4",
        ),
        "export": (
            export_rod.export,
            "export fig6.h5 --out rod.step",
            "export fig7_1_modulus.h5 --at E=5000 --out rod.glb",
        ),
    },
    "Equilibria": {
        "equilibria": (
            list_equilibria.equilibria,
            "equilibria --plot all.png",
            "equilibria --axis betaL=-90deg:60deg:41",
        ),
        "folds": (folds.folds, "folds --axis betaL=-60deg:90deg --axis FZ=4:12 --plot map.png"),
        "loops": (
            list_loops.loops,
            "loops --table1 --a 0.05 --R 0.95 --L 12 --folds 1,2,3 -o loops.png",
            "loops --length-unit nm --force-unit pN --EI 207 --GJ 310 --a 1 --L 40 --R 3 --out loops.h5",
        ),
    },
    "Help and machine": {
        "docs": (docs.docs, "docs", "docs --print"),
        "schema": (print_schema.schema, "schema"),
        "doctor": (doctor.doctor, "doctor"),
    },
}
# The tenants: a package that is deleted takes its command with it, and nothing else.
if find_spec("workbench.paper"):
    from .paper import reproduce

    GROUPS["The paper"] = {"reproduce": (reproduce.reproduce, "reproduce --out results")}
if find_spec("workbench.lab"):
    from .lab import trade

    GROUPS["The methods"] = {"trade": (trade.trade, "trade", "trade --extremes")}
COMMANDS = {name: entry for group in GROUPS.values() for name, entry in group.items()}


class Overview(TyperGroup):
    """The commands under headings, each with its whole first sentence."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands of each heading."""
        for heading, names in GROUPS.items():
            with formatter.section(heading):
                formatter.write_dl([(name, first_sentence(self.commands[name])) for name in names])


class CommandHelp(TyperCommand):
    """The arguments and options of a command under headings, then its examples."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the options under the headings that they name, in the order of their first option."""
        for heading, records in option_records(self, ctx).items():
            with formatter.section(heading):
                formatter.write_dl(records)
        with formatter.section("Examples"):
            for example in COMMANDS[str(self.name)][1:]:
                formatter.write_text(f"workbench {example}")


def first_sentence(command: Any) -> str:
    """The first sentence of the help of a command."""
    return " ".join((command.help or "").split("\n\n")[0].split())


def option_records(command: Any, context: Any) -> dict[str, list[tuple[str, str]]]:
    """Heading -> the names and the help of the arguments and options of a command."""
    records: dict[str, list[tuple[str, str]]] = {}
    for param in command.get_params(context):
        record = param.get_help_record(context)
        if record is not None:
            usual = "Arguments" if param.param_type_name == "argument" else "Options"
            records.setdefault(getattr(param, "rich_help_panel", None) or usual, []).append(record)
    return records


app = typer.Typer(
    cls=Overview,
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


def _with_exit_status(command: Callable[..., int]) -> Callable[..., None]:
    """The command as the parser calls it: it exits with its status, and an interruption keeps its message."""

    @wraps(command)
    def run(*args: Any, **options: Any) -> None:
        with atomic.record_files() as files:
            try:
                raise typer.Exit(command(*args, **options))
            except KeyboardInterrupt as error:
                kept = f"stored: {', '.join(map(str, files))}" if files else "nothing was stored"
                stopped = typer.TyperException(str(error) or f"interrupted; {kept}")
                stopped.exit_code = INTERRUPTED
                raise stopped from None

    return run


for _name, (_command, *_) in COMMANDS.items():
    app.command(_name, cls=CommandHelp)(_with_exit_status(_command))


def main(args: list[str] | None = None) -> None:
    """Run the command line and exit; an error is one sentence on stderr, and so is a notice."""
    words = (sys.argv[1:] if args is None else args) or ["--help"]
    if sys.stderr is None:  # as a shell closes it with 2>&-
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115  (to the end of the process)
    if sys.stdout is None:
        print("workbench: stdout is closed; give it a file or a pipe, or /dev/null", file=sys.stderr)
        sys.exit(2)
    for stream in (sys.stdout, sys.stderr):  # whatever their encoding, no text of a file or of a case fails there
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=escaping.SPELL)
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
            fail(_fault(words, error), 2)
        fail(f"cannot write {error.filename or 'the output'}: {error.strerror}", 2)
    except ImportError as error:
        from solver.core.library import MissingCore

        from .scene.opengl import MISSING

        if isinstance(error, MissingCore):
            fail(str(error), 2)
        if (error.name or "").partition(".")[0] not in OF_SCENE:
            raise
        fail(f"{MISSING} ({error.name} is missing)", 2)
    except InputError as error:
        fail(str(error), 2)
    except Exception as error:
        fail(_fault(words, error), 2)


def _fault(words: list[str], error: Exception) -> str:
    """What is said of an error that nothing foresaw in a command on a stored file, which may be altered or foreign.

    Raises the error itself where no file is named, and in Python's development mode (``python -X dev``).
    """
    import h5py

    from .stored import file_checks

    paths = [word for word in words if h5py.is_hdf5(word)]
    if not paths or sys.flags.dev_mode:
        raise error
    place = traceback.extract_tb(error.__traceback__)[-1]
    said = f"{type(error).__name__}: {str(error)[:LONGEST]} ({Path(place.filename).name}, line {place.lineno})"
    if altered := [path for path in paths if not file_checks.is_as_stored(path)]:
        return f"{altered[0]} cannot be used, as it is altered or not of the workbench: {said}"
    return f"a fault of the workbench, please report it, as {paths[0]} is as it was stored: {said}"


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
