"""The command gallery: the kinds of scene, and the two pictures at the top of the README."""

from collections.abc import Callable
from math import cos, pi
from pathlib import Path
from typing import Annotated, Any

from . import console
from .options import ForceOutput, option
from .present import Result, presents, result_of_files

DPI = 200  # of print
SWEEP, PAGE = "hero_sweep", "hero_page"
HERO_SIZE, HERO_DPI = (5.375, 3.75), 160  # inches of the animated picture: as wide to its height as the other
# there and back: 120 frames; slow near both ends, so that nothing jumps where the loop begins again
FORCES = [-10.0 - 25.0 * (1 - cos(pi * k / 60)) for k in range(61)]
HERO = """
title = "A rod in a tube, pushed"
outputs = ["beta", "dbeta", "alpha", "z"]
stations = 401
[units]
length = "cm"
force = "N"
[base]
E = 1.5e4
nu = 0.25
a = 0.2
L = 8.5
R = 0.9
side = "inside"
beta = 1.27
dbeta = 0.35
F2 = 11.38
M3 = 22.71
"""
INSIDE = """
title = "A soft rod inside a tube, pushed"
outputs = ["beta", "alpha", "z"]
[units]
length = "cm"
force = "N"
[base]
E = 1.07e4
nu = 0.25
a = 0.25
L = 20.0
R = 0.75
side = "inside"
beta = 0.5
dbeta = 0.1
dgamma = 0.5
F3 = -10.0
"""
LONG = """
title = "The rod of Table 1, forty times as long"
reading = "force-first/tension/paper"
outputs = ["beta", "alpha", "z"]
stations = 8001
[units]
length = "cm"
force = "N"
[base]
L = 800.0
"""
OWN = {"inside": INSIDE, "long": LONG}  # drawn as `contact`
ROD, VIEWS, VIEW_DPI = "rod", ("plain", "contact", "curvature", "twist"), 120  # four kinds of one rod, two by two


@presents()
def gallery(
    out: Annotated[Path, option("FOLDER", "Folder for the pictures.")] = Path("gallery"),
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
    from ..scene import opengl
    from ..store import writing
    from ..web.live import live_document
    from . import option_checks

    suffixes = _suffixes(only or [])
    writing.check_folder(out)
    paths = {name: option_checks.check(out / f"{name}{suffix}", (suffix,), force) for name, suffix in suffixes.items()}
    able, advice = opengl.probe() if set(paths) - {PAGE} else (True, "")
    if not able:
        return result_of_files([], warnings=[advice], status=1)
    datasets, drawn, warnings = _datasets(), [], []
    with console.progress(len(paths), lines=True) as step:
        for name, path in paths.items():
            step(name)
            if name == PAGE and (why := live_document.take_picture(path)):
                warnings.append(f"{path.name} is left out: {why}")
                continue
            if name != PAGE:
                draw = {SWEEP: _animate, ROD: _four_views}.get(name, _scene)
                draw(datasets[name](), path)
            drawn.append(path)
    return result_of_files(drawn, warnings=warnings)


def _suffixes(only: list[str]) -> dict[str, str]:
    """The suffix of each picture that is wanted. Raises `InputError` for an unknown name."""
    from solver.problem.errors import InputError, no_such

    from ..scene import scene_kinds

    several = [name for name in scene_kinds.KINDS if name not in VIEWS]
    known = dict.fromkeys([ROD, *several, *OWN], ".png") | {SWEEP: ".webp", PAGE: ".png"}
    for name in only:
        if name in VIEWS:
            raise InputError(f"{name} is one of four views of the picture {ROD}: take --only {ROD}")
        if name not in known:
            raise no_such("picture", name, list(known))
    return {name: suffix for name, suffix in known.items() if not only or name in only}


def _scene(ds: Any, path: Path) -> None:
    """Draw one scene."""
    from ..scene import composition, layout

    kind, axes = "contact" if path.stem in OWN else path.stem, ["F1", "F3"] if path.stem == "grid" else []
    layout.render(ds, path, None, kind, axes, settings=composition.Settings(dpi=DPI), level=9)


def _four_views(ds: Any, path: Path) -> None:
    """Draw a rod in four kinds of scene, two by two."""
    import numpy as np
    from PIL import Image

    from ..scene import composition, layout, page, scene_kinds
    from ..store import atomic

    views = []
    for letter, kind in zip("abcd", VIEWS, strict=True):
        titled = ds.assign_attrs(title=f"{letter}  {scene_kinds.KINDS[kind].description}")
        picture = layout.compose(titled, None, kind, settings=composition.Settings(dpi=VIEW_DPI))
        views.append(page.pixels_of(picture.page.fig))
    high = max(len(view) for view in views)
    views = [np.pad(view, ((0, high - len(view)), (0, 0), (0, 0)), constant_values=255) for view in views]
    both = Image.fromarray(np.block([[[views[0]], [views[1]]], [[views[2]], [views[3]]]]))
    atomic.write(path, lambda aside: both.save(aside, compress_level=9))


def _animate(ds: Any, path: Path) -> None:
    """Draw the rod along the axis and back."""
    from ..scene import film

    shown = film.Film("F3", {}, dpi=HERO_DPI, size=HERO_SIZE)
    film.write([path], film.frames(ds, shown), back=True)


def _datasets() -> dict[str, Callable[[], Any]]:
    """What solves the dataset of each picture."""
    from studies import load
    from studies.grammar.axes import Axis
    from studies.language.loader import loads

    from ..store import in_memory

    def equilibria() -> Any:
        from solver import equilibria as every

        from ..branches.ends_study import ends_problem
        from ..branches.equilibria_dataset import dataset_of

        study = load("fig7_4_end_angle")
        case = ends_problem(study)
        return dataset_of(study, case, every(case))

    def sweep() -> Any:
        axes = {"F3": Axis.model_validate({"values": FORCES[::-1]})}
        return in_memory.run(loads(HERO, default_name="hero").model_copy(update={"axes": axes}))

    def own(text: str) -> Callable[[], Any]:
        return lambda: in_memory.run(loads(text, default_name="rod"))

    return {
        ROD: lambda: in_memory.run(load("fig6")),
        "ghosts": lambda: in_memory.run(load("fig7_1_modulus")),
        "grid": lambda: in_memory.run(load("fig7_5_forces")),
        "equilibria": equilibria,
        SWEEP: sweep,
        **{name: own(text) for name, text in OWN.items()},
    }
