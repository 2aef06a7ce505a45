"""The command gallery: the kinds of scene, and the two pictures at the top of the README."""

from collections.abc import Callable
from functools import partial
from math import cos, pi
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from solver.problem.errors import InputError, no_such

from ..run import atomic
from . import console
from .options import ForceOutput, check_file, option
from .present import Result, presents, result_of_files

if TYPE_CHECKING:
    from ..stored.stored_study import StoredStudy

DPI = 200  # of print
SWEEP, PAGE = "hero_sweep", "hero_page"
HERO_SIZE, HERO_DPI = (5.375, 3.75), 160  # inches of the animated picture: as wide to its height as the other
# there and back: 120 frames; slow near both ends, so that nothing jumps where the loop begins again
FORCES = [-10.0 - 25.0 * (1 - cos(pi * k / 60)) for k in range(61)]
OWN = ("inside", "long")  # drawn as `contact`
RODS = Path(__file__).with_name("gallery_rods")  # the studies of the pictures that are of no shipped study
ROD, VIEWS, VIEW_DPI = "rod", ("plain", "contact", "curvature", "twist"), 120  # four kinds of one rod, two by two


@presents()
def gallery(
    out: Annotated[Path, option("FOLDER", "Folder for the pictures.", "--out", "-o")] = Path("gallery"),
    only: Annotated[
        list[str] | None, option("NAME", "A picture to draw, such as rod or hero_sweep; repeatable; default: all.")
    ] = None,
    force: ForceOutput = False,
) -> Result:
    """Draw every kind of scene, and the two pictures at the top of the README.

    rod.png shows one rod in the four kinds of scene that show one. hero_sweep.webp is animated: a rod in a tube that
    is pushed and released. hero_page.png shows the live page; without a Chromium on PATH it is left out. Exit status 1
    if OpenGL does not work on this machine.
    """
    from ..run import writing
    from ..scene import opengl
    from ..web.live import live_document

    suffixes = _suffixes(only or [])
    writing.check_folder(out)
    paths = {name: check_file(out / f"{name}{suffix}", (suffix,), force) for name, suffix in suffixes.items()}
    able, advice = opengl.probe() if set(paths) - {PAGE} else (True, "")
    if not able:
        return result_of_files([], warnings=[advice], status=1)
    datasets, drawn, warnings = _datasets(), [], []
    with console.progress(len(paths), lines=True) as step:
        for name, path in paths.items():
            step(name)
            why = live_document.take_picture(path) if name == PAGE else None
            if name != PAGE:
                (_four_views if name == ROD else _scene)(datasets[name](), path)
            if why:
                warnings.append(f"{path.name} is left out: {why}")
            else:
                drawn.append(path)
    return result_of_files(drawn, warnings=warnings)


def _suffixes(only: list[str]) -> dict[str, str]:
    """The suffix of each picture that is wanted. Raises `InputError` for an unknown name."""
    from ..scene import scene_kinds

    several = [name for name in scene_kinds.KINDS if name not in VIEWS]
    known = dict.fromkeys([ROD, *several, *OWN], ".png") | {SWEEP: ".webp", PAGE: ".png"}
    for name in only:
        if name in VIEWS:
            raise InputError(f"{name} is one of four views of the picture {ROD}: take --only {ROD}")
        if name not in known:
            raise no_such("picture", name, list(known))
    return {name: suffix for name, suffix in known.items() if not only or name in only}


def _scene(rods: "StoredStudy", path: Path) -> None:
    """Draw one scene, or the rod along the axis of the film and back."""
    from ..scene import composition, film, layout

    if path.stem == SWEEP:
        film.write([path], film.frames(rods, film.Film("F3", {}, dpi=HERO_DPI, size=HERO_SIZE)), back=True)
        return
    kind, axes = "contact" if path.stem in OWN else path.stem, ["F1", "F3"] if path.stem == "grid" else []
    layout.render(rods, path, None, kind, axes, settings=composition.Settings(dpi=DPI), level=9)


def _four_views(rods: "StoredStudy", path: Path) -> None:
    """Draw a rod in four kinds of scene, two by two."""
    import numpy as np
    from PIL import Image

    from ..scene import composition, layout, page, scene_kinds

    views = []
    for letter, kind in zip("abcd", VIEWS, strict=True):
        titled = rods.with_title(f"{letter}  {scene_kinds.KINDS[kind].description}")
        picture = layout.compose(titled, None, kind, settings=composition.Settings(dpi=VIEW_DPI))
        views.append(page.pixels_of(picture.fig))
    high = max(len(view) for view in views)
    views = [np.pad(view, ((0, high - len(view)), (0, 0), (0, 0)), constant_values=255) for view in views]
    image = Image.fromarray(np.block([[[views[0]], [views[1]]], [[views[2]], [views[3]]]]))
    atomic.write(path, lambda aside: image.save(aside, compress_level=9))


def _datasets() -> "dict[str, Callable[[], StoredStudy]]":
    """What solves the dataset of each picture."""
    from solver import equilibria as every
    from studies import load
    from studies.grammar.axes import Axis

    from ..branches.ends_study import ends_problem
    from ..branches.equilibria_dataset import dataset_of
    from ..run import in_memory
    from ..stored.stored_study import StoredStudy

    def equilibria() -> StoredStudy:
        study = load("fig7_4_end_angle")
        case = ends_problem(study)
        return StoredStudy(dataset_of(study, case, every(case)))

    def run(study: str | Path, **axes: list[float]) -> StoredStudy:
        values = {name: Axis.model_validate({"values": each}) for name, each in axes.items()}
        return StoredStudy(in_memory.run(load(study).model_copy(update={"axes": values}) if axes else load(study)))

    shipped = {ROD: "fig6", "ghosts": "fig7_1_modulus", "grid": "fig7_5_forces"}
    return {
        **{name: partial(run, study) for name, study in shipped.items()},
        "equilibria": equilibria,
        **{name: partial(run, RODS / f"{name}.toml") for name in OWN},
        SWEEP: partial(run, RODS / f"{SWEEP}.toml", F3=FORCES[::-1]),
    }
