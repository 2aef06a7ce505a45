"""A film of the cases along an axis, or of a rod that is let go, by the command scene."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

from solver.problem.errors import InputError, choices

from ..export.stored_rod import name_of_file
from ..figures import trends
from ..run import shards
from ..run.in_order import run_in_order
from ..scene import film, opengl, scene_kinds
from ..scene.film import Film
from ..scene.page import Pixels
from ..scene.settings import PICTURES, check_name
from ..stored.enough_stations import at_needed_stations
from ..stored.stored_study import StoredStudy
from . import console, study_scene
from .options import axis_values, check_file
from .present import Result, result_of_files
from .scene_options import SceneOptions

DPI = 160  # gives frames of 1280 x 720 pixels
MOST = 480  # frames that are solved for a film
STAYS = 1 / 3  # seconds for which a stored case stays where no others can be solved
MOTION = 72  # frames of a rod that is let go
ONE_BY_ONE = (
    "rods off the wall are solved one by one for a film, each from the one before, up to seconds each; an interrupted "
    "film keeps them; --stored films the stored ones alone"
)
MOTION_STATIONS = 401  # of its shapes

Cases = tuple[StoredStudy, Film, str, int]  # the rods of the frames, the film, what they are, frames of each


def film_of(file: Path, out: Path, wanted: SceneOptions) -> Result:
    """Make a film of the cases along an axis, or of a rod that is let go.

    Each frame shows the rod and the curve of a number up to that case. The result has status 1 if OpenGL does not work
    on this machine. Raises `InputError`.
    """
    fps, kind = film.FPS if wanted.fps is None else wanted.fps, wanted.kind or "contact"
    settings, paths, suffixes = wanted.settings(DPI), [out], PICTURES if wanted.has_film_pictures else film.SUFFIXES
    film.check_counts(wanted.frames, fps)
    if wanted.has_film_pictures:
        paths = [out.with_name(name_of_file(out.name, i)) for i in range(wanted.frames or 0)]
        if settings.transparent or wanted.fps is not None:
            raise InputError("pictures of a film have a background and no speed: leave out --transparent and --fps")
    for path in paths:
        check_name(check_file(path, suffixes, wanted.force), settings)
    film.check_writers(paths)
    rods = study_scene.open_rods(file, whole=kind != scene_kinds.LET_GO)[1]
    rods.check_any_solved()
    where = axis_values(rods, wanted.at)
    shown = film.Film("", where, None, kind, settings)
    if kind == scene_kinds.LET_GO:
        cases = _of_motion(rods, shown, wanted)
    else:
        cases = _along_axis(file, out, rods, shown, wanted)
    opengl.check()
    rods, shown, said, each = cases(fps)
    count = len(film.cases_of(rods, shown))
    drawn = scene_kinds.kind_of(shown.kind)
    solve = None if rods.leaves else study_scene.solver_of(rods, drawn, shown.at, [shown.axis])
    with console.progress(count, lines=True) as step:

        def frames(rods: StoredStudy, strict: bool) -> Iterator[Pixels]:
            return film.frames(rods, shown, step, strict)

        pictures = at_needed_stations(rods, solve, frames)[0]
        if wanted.has_film_pictures:
            film.write_pictures(paths, pictures)
        else:
            film.write(paths, pictures, fps, each, stay=0.0 if wanted.frames else film.HOLD)
    for folder in _folders(out):
        shards.clear(folder)
    line = rods.trend(shown.observable, shown.axis, shown.at) if shown.observable else None
    errors = [] if line is None or settings.bare else trends.say_errors(line)
    speed = "" if wanted.has_film_pictures else f", {fps:g} frames per second"
    return result_of_files(paths, [f"{out}: {count} {said}{speed}", *errors])


def _of_motion(rods: StoredStudy, shown: Film, wanted: SceneOptions) -> Callable[[float], Cases]:
    """The shapes of a rod that is let go, in a viscous medium, as frames. Raises `InputError` for alien options."""
    if alien := wanted.flags_of("axis", "along", "show", "stored"):
        raise InputError(f"a film of the kind {scene_kinds.LET_GO} shows one case, and takes no {choices(alien)}")
    solve = study_scene.release_of(rods, shown.at, wanted.frames or MOTION)

    def cases(fps: float) -> Cases:
        motion = solve(MOTION_STATIONS)
        shapes = replace(shown, axis=scene_kinds.RELEASED, at={}, observable=study_scene.ENERGY[0], kind="contact")
        return motion, shapes, f"shapes, {motion.attrs[scene_kinds.NOTE]}", 1

    return cases


def _along_axis(
    file: Path, out: Path, rods: StoredStudy, shown: Film, wanted: SceneOptions
) -> Callable[[float], Cases]:
    """The cases along an axis as frames: between those of a study others are solved, as many as let the rod move
    smoothly, and they are kept beside the film until it is written.

    Raises `InputError` where the axis is not known, and for a kind that makes no film.
    """
    axis = (
        wanted.along
        or next(iter(wanted.axes), None)
        or rods.axis_left(shown.at, f"a film of {file} runs", "choose one with --axis")
    )
    if axis in shown.at:
        raise InputError(f"--at {axis}: the film runs along {axis}, so that axis takes no value")
    is_solved = not wanted.stored and study_scene.field_between(rods, axis) is not None
    measured = rods.study.known_observables if is_solved else ()
    name = film.observable_of(rods, axis, wanted.show, shown.at, measured)
    shown = replace(shown, axis=axis, observable=name)
    film.cases_of(rods, shown)

    def cases(fps: float) -> Cases:
        solving = rods, axis, shown.at, scene_kinds.kind_of(shown.kind), name, MOST, wanted.frames
        more = None
        if not wanted.stored:
            if rods.leaves:
                console.warn(ONE_BY_ONE)
            with console.progress(wanted.frames or MOST, lines=True) as step:
                run_first, run = (partial(run_in_order, folder=folder, step=step) for folder in _folders(out))
                more = study_scene.film_cases(*solving, run, run_first)
        if more is not None:
            return more, replace(shown, at={}), "cases, solved for this film", 1
        each = 1 if wanted.frames else max(round(STAYS * fps), 1)
        return rods, replace(shown, count=wanted.frames), "stored cases", each

    return cases


def _folders(out: Path) -> list[Path]:
    """Where the cases that tell the pace of a film are kept, and its own."""
    return [shards.folder_of(path) for path in (out.with_stem(f"{out.stem}_pace"), out)]
