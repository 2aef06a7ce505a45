"""A file of branches in three dimensions, by the command scene: the stable rods beside their diagram, or a snap."""

from dataclasses import replace
from pathlib import Path

from matplotlib.figure import Figure

from solver.problem.errors import InputError, check_known, choices
from studies.grammar.axes import in_words

from ..branches import snap
from ..figures import bifurcation, canvas
from ..scene import film, opengl, scene_kinds
from ..scene.page import Page
from ..scene.settings import check_name
from ..stored.enough_stations import at_needed_stations
from ..stored.stored_study import StoredStudy
from . import console, scene_film, study_scene
from .options import check_file
from .present import Result, result_of_files
from .scene_options import OF_PICTURE, SceneOptions

RODS, SNAP = "branches", "snap"  # kinds of scene of such a file
FRAMES = 144  # of a film of a snap
MOST = 9  # rods of a picture
SUFFIXES = (".png",)


def scene_of(file: Path, stored: StoredStudy, wanted: SceneOptions) -> Result:
    """Draw a file of branches, or film the snap of one of its rods. Raises `InputError`."""
    out = wanted.out
    is_film = out is not None and out.suffix.lower() in film.SUFFIXES
    kind = wanted.kind or (SNAP if is_film else RODS)
    check_known("kind of scene of branches", kind, (RODS, SNAP))
    if (kind == SNAP) != is_film:
        raise InputError(f"of branches {choices(film.SUFFIXES)} are films of the kind {SNAP}, other files of {RODS}")
    alien = wanted.flags_of("axis", "along", "at", "show", "stored")
    alien += ["{} in --out"] * (out is not None and "{" in out.name)
    if alien := alien + ([] if is_film else wanted.flags_of(*OF_PICTURE)):
        axis = stored.attrs["axis"]
        raise InputError(
            f"a scene of branches takes no {choices(alien)}: store the rods at one value of {axis}, or another "
            f"diagram, with workbench equilibria, --{axis} VALUE or --show OBSERVABLE, and --out FILE"
        )
    if out is not None and is_film:
        return _film(stored, out, wanted)
    return _picture(file, stored, wanted)


def _picture(file: Path, stored: StoredStudy, wanted: SceneOptions) -> Result:
    """Draw the stable rods of branches below their diagram."""
    settings = wanted.settings()
    suffixes = (*SUFFIXES, *film.SUFFIXES)
    path = check_file(wanted.out or file.with_name(f"{file.stem}_scene.png"), suffixes, wanted.force)
    opengl.check()
    from ..scene import branch_rods  # it loads PyVista

    stable = bifurcation.stable_shapes(stored)
    if not stable:
        raise InputError("no branch of this file is stable, so there is no rod to show")
    unsolved = dict[int, str]()

    def shapes() -> list[int]:
        return [k for k in stable[:MOST] if k not in unsolved]

    def solve(stations: int) -> StoredStudy:
        rods, others = snap.rods_of_shapes(stored, shapes(), stations)
        unsolved.update(others)
        return StoredStudy(rods)

    def draw(rods: StoredStudy, strict: bool) -> tuple[Figure, Page]:
        return branch_rods.figure(stored, shapes(), rods, replace(settings, strict=strict))

    (fig, _), stations = at_needed_stations(solve(study_scene.FIRST), solve, draw)
    canvas.save(fig, path, settings.dpi)
    count = f", {MOST} of {len(stable)} stable rods" if len(stable) > MOST else ""
    name, names = str(stored.attrs["axis"]), bifurcation.names_of_shapes(stored)
    warnings = [
        f"rod {names[k]}, at {in_words(name, float(stored[f'shape_{name}'].values[k]))}, is not drawn: {why}"
        for k, why in unsolved.items()
    ]
    return result_of_files([path], [f"{path}, solved at {stations} stations{count}"], warnings)


def _film(stored: StoredStudy, out: Path, wanted: SceneOptions) -> Result:
    """Film a rod whose load is changed until it snaps, beside the diagram of its branches."""
    fps = film.FPS if wanted.fps is None else wanted.fps
    path, settings = check_file(out, film.SUFFIXES, wanted.force), wanted.settings(scene_film.DPI)
    check_name(path, settings)
    film.check_counts(wanted.frames, fps)
    film.check_writers([path])
    opengl.check()
    shapes = snap.evenly(snap.as_dataset(stored, snap.way_of(stored)), wanted.frames or FRAMES)
    said = f"where the rod snaps: {study_scene.MOTION}"
    rods = StoredStudy(shapes.assign_attrs({scene_kinds.NOTE: said}))
    axis, shown = str(stored.attrs["axis"]), str(stored.attrs["shown"])
    of = film.Film(axis, {}, shown, "plain", settings, branches=stored)
    with console.progress(rods.sizes[axis], lines=True) as step:
        film.write([path], film.frames(rods, of, step), fps, stay=0.0 if wanted.frames else film.HOLD)
    return result_of_files([path], [f"{path}: {rods.sizes[axis]} shapes, {said}, {fps:g} frames per second"])
