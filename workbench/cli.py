"""The command line. Each command imports what is heavy itself, so that --help answers at once.

Exit status: 0 done; 1 done, but a law does not hold in full or a case is unsolved; 2 asked wrongly; 130 interrupted.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from . import __version__
from .commands import case_options as of
from .commands.case_options import angled, numbered
from .data import escaping

INTERRUPTED = 130  # 128 and the number of the signal that Ctrl-C sends

app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["--help", "-h"], "max_content_width": 110},
)


File = Annotated[Path, typer.Argument(metavar="FILE", help="A stored dataset, made by run or reproduce.")]
Reading = Annotated[
    str | None,
    typer.Option(
        help="How Table 1 is read: words of force-first|twist-first|shear, tension|compression, paper|solid, "
        "joined by /. What is left out stays as the study has it."
    ),
]
Tol = Annotated[float | None, numbered("The error allowed, times max(1, condition).")]
Level = Annotated[
    str | None,
    typer.Option(
        "--fidelity", help="draft, standard, fine or exact: a tolerance and what is computed. --tol goes first."
    ),
]
Method = Annotated[str | None, typer.Option(help="auto, or the name of a method.")]
Choose = Annotated[
    str | None,
    typer.Option(help="Between two ends: nearest, lowest, or a Morse index (0, 1, 2, ...). Default: nearest."),
]
Replace = Annotated[bool, typer.Option("--force", help="Replace a picture that is there.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON.")]


@contextmanager
def _saying_what_is_kept() -> Iterator[None]:
    """An interruption's own sentence, which the parser of the command line would drop, and its exit status."""
    try:
        yield
    except KeyboardInterrupt as error:
        stopped = typer.TyperException(str(error) or "interrupted")
        stopped.exit_code = INTERRUPTED
        raise stopped from None


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"workbench {__version__}")
        raise typer.Exit()


@app.callback()
def start(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version and stop.", is_eager=True, callback=_show_version),
    ] = False,
) -> None:
    """The shape of an elastic rod on a cylinder: solve, study, store, draw and check."""


@app.command()
def reproduce(
    out: Annotated[Path, typer.Option(help="The folder for everything.")] = Path("results"),
    reading: Reading = None,
) -> None:
    """Figures 6 and 7 from Table 1: solve, store, draw, check, report."""
    from .commands.reproduce import reproduce as work

    raise typer.Exit(work(out, reading))


@app.command("list")
def list_studies(json: Json = False) -> None:
    """The studies that come with the workbench."""
    from .commands.run import list_studies as work

    work(json)


@app.command()
def run(
    study: Annotated[str, typer.Argument(metavar="STUDY", help="A study's name (see list) or TOML file.")],
    out: Annotated[Path | None, typer.Option(help="The file to store; NAME.h5 where left out.")] = None,
    reading: Reading = None,
    tol: Tol = None,
    method: Method = None,
    level: Level = None,
    stations: Annotated[int | None, typer.Option(help="Points stored along the rod, in place of the study's.")] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes on this machine; as many as are of use where left out.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="tcp://host:port of a Dask cluster that solves instead.")
    ] = None,
    chunk: Annotated[
        int | None, typer.Option(min=1, metavar="CASES", help="Cases handed out at a time; a few seconds' work.")
    ] = None,
    restart: Annotated[
        bool, typer.Option("--restart", help="Drop what an earlier run has kept, and solve a finished study again.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is not this study's.")] = False,
    json: Json = False,
) -> None:
    """Solve every case of a study, store them, judge its laws; go on where an earlier run stopped."""
    from .commands.run import run_study
    from .run.study_store import Options

    options = Options(workers, scheduler, chunk, restart)
    with _saying_what_is_kept():
        raise typer.Exit(run_study(study, out, reading, tol, method, force, level, stations, options, json))


@app.command()
def check(file: File, json: Json = False) -> None:
    """Judge each law of a stored study; exit status 1 where one does not hold in full or a case is unsolved."""
    from .commands.run import check_file

    raise typer.Exit(check_file(file, json))


@app.command()
def summary(file: File, json: Json = False) -> None:
    """What a stored study holds: axes, observables, outcomes, the worst error, laws, versions."""
    from .commands.summary import summarise

    raise typer.Exit(summarise(file, json))


@app.command()
def merge(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="Stored datasets of one study, two or more.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The file to store.")],
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is not this study's.")] = False,
    json: Json = False,
) -> None:
    """Join studies that extend one another along one axis; exit status as of check."""
    from .commands.merge import merge_files

    raise typer.Exit(merge_files(files, out, force, json))


@app.command()
def plot(
    file: File,
    out: Annotated[Path | None, typer.Option(help="The picture, .png, .pdf or .svg; FILE.png where left out.")] = None,
    dpi: Annotated[int, typer.Option(min=50, max=1200, help="Pixels an inch of a .png; the others have none.")] = 200,
    force: Replace = False,
) -> None:
    """Developed curves, and observables against the axis with their laws."""
    from .commands.plot import plot_file

    plot_file(file, out, force, dpi)


@app.command()
def scene(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE|STUDY",
            help="A stored dataset; or a study's name or TOML file, solved at the stations that the picture needs.",
        ),
    ],
    at: Annotated[
        list[str] | None,
        typer.Option(help="E=10905 or beta=30deg: a value of that axis, as exact as you write it."),
    ] = None,
    kind: Annotated[
        str | None, typer.Option(help="plain, contact, curvature, twist, ghosts, grid or equilibria.")
    ] = None,
    axis: Annotated[list[str] | None, typer.Option(help="For ghosts, the axis shown; for grid, one or two.")] = None,
    along: Annotated[
        str | None, typer.Option(help="An axis whose cases together fix the camera and the colours, as in animate.")
    ] = None,
    low: Annotated[float | None, numbered("Draw the rod from here [length].", "--from")] = None,
    high: Annotated[float | None, numbered("Draw the rod up to here [length].", "--to")] = None,
    pixel_error: Annotated[float, numbered("How far the drawn surface may be off [pixels].")] = 0.5,
    dpi: Annotated[int, typer.Option(help="Pixels an inch; 200 gives 1600 x 1200 for one case.")] = 200,
    out: Annotated[
        Path | None, typer.Option(help="The picture; FILE_scene.png or FILE_scene_E=10905.png where left out.")
    ] = None,
    force: Replace = False,
) -> None:
    """The rod on its cylinder in three dimensions, off-screen."""
    from .commands.scene import scene_file

    raise typer.Exit(scene_file(file, at or [], out, force, kind, axis, along, (low, high), pixel_error, dpi))


@app.command()
def animate(
    file: File,
    axis: Annotated[
        str | None, typer.Option(help="The axis along which it runs; may be left out if it is one.")
    ] = None,
    at: Annotated[list[str] | None, typer.Option(help="R=0.75: a value of another axis.")] = None,
    kind: Annotated[str, typer.Option(help="plain, contact, curvature or twist.")] = "contact",
    show: Annotated[str | None, typer.Option(help="The observable whose curve grows; a law's where left out.")] = None,
    out: Annotated[
        list[Path] | None,
        typer.Option("--out", "-o", help="The film, .mp4 or .gif; more than one may be given. FILE_E.mp4."),
    ] = None,
    fps: Annotated[float, numbered("Frames a second, one a stored case.")] = 3.0,
    pixel_error: Annotated[float, numbered("How far the drawn surface may be off [pixels].")] = 0.5,
    dpi: Annotated[int, typer.Option(help="Pixels an inch; 120 gives 1488 x 720.")] = 120,
    force: Replace = False,
) -> None:
    """The cases along an axis as a film, an observable's curve growing beside the rod."""
    from .commands.animate import animate_file

    raise typer.Exit(animate_file(file, axis, at or [], kind, show, out or [], fps, pixel_error, dpi, force))


@app.command()
def gallery(
    out: Annotated[Path, typer.Option(help="The folder for the pictures.")] = Path("gallery"),
    force: Replace = False,
) -> None:
    """One picture of every kind of scene, as in docs/reference/scenes.md."""
    from .commands.gallery import draw_all

    raise typer.Exit(draw_all(out, force))


@app.command()
def export(
    file: File,
    out: Annotated[
        Path,
        typer.Option("--out", "-o", help="The file, of the kind it ends in: .step .stl .obj .glb .gltf .vtp .csv."),
    ],
    at: Annotated[
        list[str] | None,
        typer.Option(help="E=10905 or beta=30deg: a value of that axis, as exact as you write it."),
    ] = None,
    tolerance: Annotated[
        float | None, numbered("The most that the file may miss the rod, in the study's unit of length.")
    ] = None,
    centreline: Annotated[bool, typer.Option("--centreline", help="STEP with the curve alone, no solid.")] = False,
    overlap: Annotated[bool, typer.Option("--overlap", help="STEP also of a rod that passes through itself.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
    json: Json = False,
) -> None:
    """One stored rod for other programs: CAD, meshes, tables. Exit status 1 where the rod passes through itself."""
    from .commands.export import export_file

    raise typer.Exit(export_file(file, at or [], out, tolerance, centreline, overlap, force, json))


@app.command()
def solve(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="[FILE]", help="A TOML study without axes; options change its fields."),
    ] = None,
    table1: Annotated[bool, typer.Option("--table1", help="The rod of Table 1; options change its fields.")] = False,
    reading: Reading = None,
    length_unit: of.LengthUnit = None,
    force_unit: of.ForceUnit = None,
    E: of.E = None,
    nu: of.nu = None,
    a: of.a = None,
    L: of.L = None,
    stiffness: of.stiffness = None,
    R: of.R = None,
    side: of.side = None,
    beta: of.beta = None,
    dbeta: of.dbeta = None,
    F1: of.F1 = None,
    dgamma: of.dgamma = None,
    M3: of.M3 = None,
    F2: of.F2 = None,
    F3: of.F3 = None,
    beta0: of.beta0 = None,
    betaL: of.betaL = None,
    FZ: of.FZ = None,
    MZ: of.MZ = None,
    alpha: of.alpha = None,
    gamma: of.gamma = None,
    tol: Tol = None,
    method: Method = None,
    level: Level = None,
    choose: Choose = None,
    json: Json = False,
) -> None:
    """One case, from a TOML file, from options, or from Table 1.

    A rod given by options needs E, nu, a, L, R; then beta, dbeta and one of F1, dgamma, M3 at its start; or
    beta0 and betaL at its ends. Nothing comes from Table 1 unless --table1 or --reading asks for it, or nothing is
    given at all. Of the many equilibria between two ends the one that --choose says is solved, by default the stable
    one whose beta strays least from between its end angles; equilibria lists them all.
    Angles: a number in rad, or a form like 30deg, pi/6.
    """
    from .commands.solve import solve_case

    options: dict[str, Any] = {
        "E": E, "nu": nu, "a": a, "L": L, "stiffness": stiffness, "R": R, "side": side, "beta": beta,
        "dbeta": dbeta, "F1": F1, "dgamma": dgamma, "M3": M3, "F2": F2, "F3": F3, "beta0": beta0, "betaL": betaL,
        "FZ": FZ, "MZ": MZ, "alpha": alpha, "gamma": gamma,
    }  # fmt: skip
    given = {name: value for name, value in options.items() if value is not None}
    units = {kind: unit for kind, unit in (("length", length_unit), ("force", force_unit)) if unit is not None}
    raise typer.Exit(solve_case(file, given, tol, method, json, level, table1, reading, units, choose))


@app.command()
def trade(
    cases: Annotated[
        list[str] | None, typer.Option(help="Names of cases, commas between; all of them where left out.")
    ] = None,
    methods: Annotated[
        list[str] | None, typer.Option(help="Names of methods, commas between; all of them where left out.")
    ] = None,
    out: Annotated[Path, typer.Option(help="The folder for the dataset and the diagrams.")] = Path("trade"),
    json: Json = False,
) -> None:
    """Accuracy against cost: every method over a ladder of its knob, on cases whose answer is known."""
    from .compare.trade import trade as work

    with _saying_what_is_kept():
        raise typer.Exit(work(cases or [], methods or [], out, json))


@app.command()
def equilibria(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="[FILE]", help="A study's name or TOML file of one case, by its start or its ends."),
    ] = None,
    length_unit: Annotated[str | None, typer.Option(help="Of every length given, with a rod of one's own.")] = None,
    force_unit: Annotated[str | None, typer.Option(help="Of every force given, with a rod of one's own.")] = None,
    E: Annotated[float | None, numbered("Young's modulus [force/length^2].", "--E")] = None,
    nu: Annotated[float | None, numbered("Poisson ratio.")] = None,
    a: Annotated[float | None, numbered("Radius of the rod [length].", "--a")] = None,
    L: Annotated[float | None, numbered("Length of the rod [length].", "--L")] = None,
    stiffness: Annotated[str | None, typer.Option(help="solid or paper.")] = None,
    R: Annotated[float | None, numbered("Radius of the cylinder [length].", "--R")] = None,
    side: Annotated[str | None, typer.Option(help="outside or inside.")] = None,
    beta0: Annotated[float | None, angled("Angle from the axis at the start.", "--beta0")] = None,
    betaL: Annotated[float | None, angled("Angle at the far end, whole turns counted.", "--betaL")] = None,
    FZ: Annotated[float | None, numbered("Axial force, tension positive.", "--FZ")] = None,
    MZ: Annotated[float | None, numbered("Axial moment [force length].", "--MZ")] = None,
    M3: Annotated[float | None, numbered("Twisting moment [force length].", "--M3")] = None,
    axis: Annotated[
        str | None,
        typer.Option(help="NAME=FROM:TO:COUNT, as betaL=-90deg:60deg:41: follow all of them over that field."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="A picture: the curves and their energies; with --axis the branches and folds.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="A file for the dataset.")] = None,
    export: Annotated[
        Path | None, typer.Option(help="A folder: each equilibrium as a case that solve FILE reproduces.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a picture, or another kind of file.")] = False,
    choose: Choose = None,
    json: Json = False,
) -> None:
    """Every shape between two end angles under dead loads, lowest energy first, with its stability.

    What is left out comes from Table 1, read force-first/tension/paper: its beta(0), the loads that this start has,
    and the angle at which its own rod ends; in cm and N. With --length-unit or --force-unit the rod is one's own and
    nothing comes from Table 1: it needs E, nu, a, L, R, beta0 and betaL; loads left out are 0.
    """
    from .commands.list_equilibria import run as work

    options: dict[str, Any] = {
        "E": E, "nu": nu, "a": a, "L": L, "stiffness": stiffness, "R": R, "side": side, "beta0": beta0,
        "betaL": betaL, "FZ": FZ, "MZ": MZ, "M3": M3,
    }  # fmt: skip
    given = {name: value for name, value in options.items() if value is not None}
    units = {kind: unit for kind, unit in (("length", length_unit), ("force", force_unit)) if unit is not None}
    raise typer.Exit(work(file, given, axis, plot, out, export, json, force, units, choose))


@app.command()
def extremes(
    out: Annotated[Path, typer.Option(help="The folder for the dataset and the map.")] = Path("extremes"),
    json: Json = False,
) -> None:
    """Where each method breaks: every method at every named extreme, stored and drawn as a map."""
    from .compare.extremes import run_extremes

    with _saying_what_is_kept():
        raise typer.Exit(run_extremes(out, json))


@app.command()
def explore(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="[FILE]", help="A TOML study without axes, to begin with; options change its fields."),
    ] = None,
    host: Annotated[str, typer.Option(help="The address to listen at; left out, this machine alone.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="The port; 0 takes a free one.", min=0, max=65535)] = 8765,
    name: Annotated[
        list[str] | None, typer.Option(help="A further name by which browsers may call this machine.")
    ] = None,
    length_unit: of.LengthUnit = None,
    force_unit: of.ForceUnit = None,
    E: of.E = None,
    nu: of.nu = None,
    a: of.a = None,
    L: of.L = None,
    stiffness: of.stiffness = None,
    R: of.R = None,
    side: of.side = None,
    beta: of.beta = None,
    dbeta: of.dbeta = None,
    F1: of.F1 = None,
    dgamma: of.dgamma = None,
    M3: of.M3 = None,
    F2: of.F2 = None,
    F3: of.F3 = None,
    beta0: of.beta0 = None,
    betaL: of.betaL = None,
    FZ: of.FZ = None,
    MZ: of.MZ = None,
    alpha: of.alpha = None,
    gamma: of.gamma = None,
) -> None:
    """The live page: sliders for a rod, its shape, forces and equilibria, in the browser.

    It begins with Table 1, or with the rod of a file or of options, which need the same as those of solve.
    """
    from .commands.explore import explore as work

    options: dict[str, Any] = {
        "E": E, "nu": nu, "a": a, "L": L, "stiffness": stiffness, "R": R, "side": side, "beta": beta,
        "dbeta": dbeta, "F1": F1, "dgamma": dgamma, "M3": M3, "F2": F2, "F3": F3, "beta0": beta0, "betaL": betaL,
        "FZ": FZ, "MZ": MZ, "alpha": alpha, "gamma": gamma,
    }  # fmt: skip
    given = {name: value for name, value in options.items() if value is not None}
    units = {kind: unit for kind, unit in (("length", length_unit), ("force", force_unit)) if unit is not None}
    raise typer.Exit(work(host, port, name or [], file, given, units))


@app.command()
def doctor(json: Json = False) -> None:
    """What works on this machine, found by trying it: OpenGL, HDF5, fonts, optional parts; versions."""
    from .commands.doctor import examine

    raise typer.Exit(examine(json))


def main(args: list[str] | None = None) -> None:
    """Run the command line; every refusal is one sentence on stderr."""
    words = (sys.argv[1:] if args is None else args) or ["--help"]
    status = 0
    try:
        status = app(words, prog_name="workbench", standalone_mode=False)
    except typer.TyperException as error:
        _refuse(_sentence(error), error.exit_code)
    except (KeyboardInterrupt, typer.Abort):
        status = INTERRUPTED
    except BrokenPipeError:  # the reader of our output went away, as head does
        sys.stderr.close()
        sys.exit(0)
    except ValueError as error:
        from solver.problem.errors import InputError

        if not isinstance(error, InputError):
            raise
        _refuse(str(error), 2)
    if status == INTERRUPTED:
        _refuse("interrupted; what was stored is whole", INTERRUPTED)
    sys.exit(status or 0)


def _sentence(error: typer.TyperException) -> str:
    """What the parser says, and the choices where it left them out."""
    said = error.format_message().rstrip(".")
    context = getattr(error, "ctx", None)
    command: Any = context.command if context else None
    if command and said.startswith("No such command"):
        return f"{said}; choose from {', '.join(command.commands)}"
    if command and said.startswith("No such option"):
        options = [name for param in command.params for name in param.opts if name.startswith("-")]
        return f"{said.partition(' (')[0]}; choose from {', '.join(options)}"
    return said


def _refuse(sentence: str, status: int) -> None:
    print(f"workbench: {escaping.line(sentence)}", file=sys.stderr)
    sys.exit(status)


if __name__ == "__main__":
    main()
