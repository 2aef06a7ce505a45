"""A film of the cases along an axis, by the command scene."""

from dataclasses import replace
from pathlib import Path

from solver.problem.errors import InputError, choices

from . import console
from .options import axis_values, check_file
from .present import Result, result_of_files
from .scene_options import SceneOptions

DPI = 160  # gives frames of 1280 x 720 pixels
RATES = (0.1, 60.0)  # frames a second
MOST = 480  # frames that are solved for a film
STAYS = 1 / 3  # seconds for which a stored case stays where no others can be solved


def film_of(file: Path, out: Path, wanted: SceneOptions) -> Result:
    """Make a film of the cases along an axis.

    Each frame shows the rod and the curve of an observable up to that case. Between the stored cases others are solved,
    as many as let the rod move smoothly. The result has status 1 if OpenGL does not work on this machine. Raises
    `InputError`.
    """
    from ..run import in_memory
    from ..scene import film, opengl
    from ..scene.scene_kinds import kind_of
    from ..scene.settings import check, look_of
    from ..stored.stored_study import StoredStudy
    from . import study_scene

    fps, frames = film.FPS if wanted.fps is None else wanted.fps, wanted.frames
    study, rods = study_scene.open_rods(file)
    if study is not None:
        rods = StoredStudy(in_memory.run(study))
    rods.check_any_solved()
    axes, axis = rods.axes, wanted.along or next(iter(wanted.axes), None)
    if not axes:
        raise InputError(f"{file} has one case and no axis, so nothing changes from frame to frame")
    if axis is None and len(axes) > 1:
        raise InputError(f"{file} has several axes: choose one with --axis from {choices(axes)}")
    axis = axis or axes[0]
    where = axis_values(rods, wanted.at)
    if axis in where:
        raise InputError(f"--at {axis}: the film runs along {axis}, so that axis takes no value")
    kind = wanted.kind or "contact"
    look = look_of(wanted.theme, wanted.background, wanted.color)
    check(look)
    name = film.observable_of(rods, axis, wanted.show, where)
    shown = film.Film(axis, where, name, kind, wanted.pixel_error, wanted.dpi or DPI, settings=look)
    path = check_file(out, film.SUFFIXES, wanted.force)
    cases = film.cases_of(rods, shown)
    if not RATES[0] <= fps <= RATES[1]:
        raise InputError(f"--fps must be between {RATES[0]:g} and {RATES[1]:g}, got {fps:g}")
    film.check_count(frames)
    film.check_writers([path])
    able, advice = opengl.probe()
    if not able:
        return result_of_files([], warnings=[advice], status=1)
    solving = rods, axis, where, kind_of(kind), str(shown.observable), MOST, frames
    more = None if wanted.stored else study_scene.film_cases(*solving)
    if more is None and frames:
        shown, cases = (less := replace(shown, count=frames)), film.cases_of(rods, less)
    if more is not None:
        rods, shown, cases = more, replace(shown, at={}), film.cases_of(more, replace(shown, at={}))
    each = 1 if frames or more is not None else max(round(STAYS * fps), 1)
    with console.progress(len(cases), lines=True) as step:
        film.write([path], film.frames(rods, shown, step), fps, each, stay=0.0 if frames else film.HOLD)
    solved = "stored cases" if more is None else "cases, solved for this film"
    return result_of_files([path], [f"{path}: {len(cases)} {solved}, {fps:g} frames per second"])
