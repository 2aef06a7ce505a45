"""The command gallery: one picture of every kind of scene, and the two at the top of the README."""

from collections.abc import Callable
from functools import cache
from math import cos, pi
from pathlib import Path
from typing import Annotated, Any

from . import console
from .options import ForceOutput, option

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


def gallery(
    out: Annotated[Path, option("FOLDER", "Folder for the pictures.")] = Path("gallery"),
    only: Annotated[
        list[str] | None, option("NAME", "A picture to draw, such as contact or hero_sweep; repeatable; default: all.")
    ] = None,
    force: ForceOutput = False,
) -> int:
    """Draw one picture of every kind of scene, and the two at the top of the README.

    hero_sweep.webp is animated: a rod in a tube that is pushed and released. hero_page.png shows the live page; without
    a Chromium on PATH it is left out. Exit status 1 if OpenGL does not work on this machine.
    """
    from ..data import writing
    from ..scene import opengl
    from . import output_file

    suffixes = _suffixes(only or [])
    writing.check_folder(out)
    paths = {name: output_file.check(out / f"{name}{suffix}", (suffix,), force) for name, suffix in suffixes.items()}
    able, advice = opengl.probe() if set(paths) - {PAGE} else (True, "")
    if not able:
        console.warn(advice)
        return 1
    datasets = _datasets()
    for name, path in paths.items():
        if name == PAGE:
            _page(path)
            continue
        if name == SWEEP:
            _animate(datasets[SWEEP](), path)
        else:
            _scene(name, datasets.get(name, datasets["contact"])(), path)
        console.say(str(path))
    return 0


def _suffixes(only: list[str]) -> dict[str, str]:
    """The suffix of each picture that is wanted. Raises `InputError` for an unknown name."""
    from solver.problem.errors import no_such

    from ..scene import kinds

    known = dict.fromkeys([*kinds.KINDS, *OWN], ".png") | {SWEEP: ".webp", PAGE: ".png"}
    for name in only:
        if name not in known:
            raise no_such("picture", name, list(known))
    return {name: suffix for name, suffix in known.items() if not only or name in only}


def _scene(name: str, ds: Any, path: Path) -> None:
    """Draw one scene."""
    from ..scene import composition, layout

    kind, axes = "contact" if name in OWN else name, ["F1", "F3"] if name == "grid" else []
    layout.render(ds, path, None, kind, axes, settings=composition.Settings(dpi=DPI), level=9)


def _animate(ds: Any, path: Path) -> None:
    """Draw the rod along the axis and back."""
    from ..scene import film

    shown = film.Film("F3", {}, dpi=HERO_DPI, size=HERO_SIZE)
    film.write([path], film.frames(ds, shown), back=True)


def _page(path: Path) -> None:
    """Take the picture of the live page, or say why there is none."""
    from ..web.live import still

    why = still.take(path)
    if why:
        console.warn(f"{path.name} is left out: {why}")
    else:
        console.say(str(path))


def _datasets() -> dict[str, Callable[[], Any]]:
    """What solves the dataset of each picture; of a kind that is not named, that of `contact`."""
    from studies import load
    from studies.axes import Axis
    from studies.loader import loads

    from ..run import in_memory

    def equilibria() -> Any:
        from solver import equilibria as every

        from ..branches.equilibria import ends_problem
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
        "contact": cache(lambda: in_memory.run(load("fig6"))),
        "ghosts": lambda: in_memory.run(load("fig7_1_modulus")),
        "grid": lambda: in_memory.run(load("fig7_5_forces")),
        "equilibria": equilibria,
        SWEEP: sweep,
        **{name: own(text) for name, text in OWN.items()},
    }
