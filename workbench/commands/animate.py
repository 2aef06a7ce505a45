"""The command animate: a film of the cases along an axis."""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

from solver.problem.errors import InputError, choices

from . import console
from .options import At, File, ForceOutput, PixelError, axis_values, check_file, flag, number_option, option
from .present import Result, presents, result_of_files

RATES = (0.1, 60.0)  # frames a second
MOST = 480  # frames that are solved for a film
STAYS = 1 / 3  # seconds for which a stored case stays where no others can be solved

Show = Annotated[
    str | None, option("OBSERVABLE", "Observable drawn beside a film; default: that of the axis's first law.")
]
Fps = Annotated[float | None, number_option("Frames per second of a film; default: 24.")]
Frames = Annotated[
    int | None,
    option("NUMBER", "Frames of a film, no more and no fewer; default: as many as let the rod move smoothly, with the "
           "first and the last for half a second more."),
]  # fmt: skip
Theme = Annotated[str | None, option("THEME", "light or dark: background and words; default: as suits --background.")]
Background = Annotated[str | None, option("COLOUR", "Colour of the background, such as '#14181e' or navy.")]
Color = Annotated[str | None, option("COLOUR", "Colour of the rods, of the kind plain.")]
Stored = Annotated[bool, flag("Film the stored cases alone, each for a third of a second.", "--stored")]


def film_of(
    file: File,
    axis: Annotated[str | None, option("AXIS", "Axis of the film; required if the study has several axes.")] = None,
    at: At = None,
    kind: Annotated[str, option("KIND", "plain, contact, curvature or twist.")] = "contact",
    show: Show = None,
    out: Annotated[
        list[Path] | None,
        option("FILE", "Film, .mp4, .webp or .gif; repeatable; default: FILE_AXIS.mp4.", "--out", "-o"),
    ] = None,
    fps: Fps = None,
    stored: Stored = False,
    pixel_error: PixelError = 0.5,
    dpi: Annotated[int, option("DPI", "Resolution [pixels/inch]; 160 gives 1280 x 720 pixels.")] = 160,
    force: ForceOutput = False,
    frames: Frames = None,
    theme: Theme = None,
    background: Background = None,
    color: Color = None,
) -> Result:
    """Make a film of the cases along an axis.

    Each frame shows the rod and the curve of an observable up to that case. Between the stored cases others are solved,
    as many as let the rod move smoothly. Exit status 1 if OpenGL does not work on this machine.
    """
    from ..run import in_memory
    from ..scene import film, opengl
    from ..scene.scene_kinds import kind_of
    from ..scene.settings import check, look_of
    from ..stored.stored_study import StoredStudy
    from . import study_scene

    fps = film.FPS if fps is None else fps
    study, rods = study_scene.open_rods(file)
    if study is not None:
        rods = StoredStudy(in_memory.run(study))
    rods.check_any_solved()
    axes = rods.axes
    if not axes:
        raise InputError(f"{file} has one case and no axis, so nothing changes from frame to frame")
    if axis is None and len(axes) > 1:
        raise InputError(f"{file} has several axes: choose one with --axis from {choices(axes)}")
    axis = axis or axes[0]
    where = axis_values(rods, at)
    if axis in where:
        raise InputError(f"--at {axis}: the film runs along {axis}, so that axis takes no value")
    look = look_of(theme, background, color)
    check(look)
    name = film.observable_of(rods, axis, show, where)
    shown = film.Film(axis, where, name, kind, pixel_error, dpi, settings=look)
    default = file.with_name(f"{file.stem}_{axis}.mp4")
    paths = [check_file(path, film.SUFFIXES, force) for path in out or [default]]
    cases = film.cases_of(rods, shown)
    if not RATES[0] <= fps <= RATES[1]:
        raise InputError(f"--fps must be between {RATES[0]:g} and {RATES[1]:g}, got {fps:g}")
    film.check_count(frames)
    film.check_writers(paths)
    able, advice = opengl.probe()
    if not able:
        return result_of_files([], warnings=[advice], status=1)
    solving = rods, axis, where, kind_of(kind), str(shown.observable), MOST, frames
    more = None if stored else study_scene.film_cases(*solving)
    if more is None and frames:
        shown, cases = (less := replace(shown, count=frames)), film.cases_of(rods, less)
    if more is not None:
        rods, shown, cases = more, replace(shown, at={}), film.cases_of(more, replace(shown, at={}))
    each = 1 if frames or more is not None else max(round(STAYS * fps), 1)
    with console.progress(len(cases), lines=True) as step:
        film.write(paths, film.frames(rods, shown, step), fps, each, stay=0.0 if frames else film.HOLD)
    solved = "stored cases" if more is None else "cases, solved for this film"
    return result_of_files(paths, [f"{path}: {len(cases)} {solved}, {fps:g} frames per second" for path in paths])


animate = presents()(film_of)  # the command
