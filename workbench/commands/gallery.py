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
STUDY = "fig7_1_modulus"
# there and back: 60 frames; slow near both ends, so that nothing jumps where the loop begins again
MODULI = [5e3 * 8 ** ((1 - cos(pi * k / 30)) / 2) for k in range(31)]
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
LONGEST = LONG.replace("forty", "two thousand").replace("8001", "100001").replace("800.0", "40000.0")
OWN = {"inside": INSIDE, "long": LONG, "longest": LONGEST}  # drawn as `contact`


def gallery(
    out: Annotated[Path, option("FOLDER", "Folder for the pictures.")] = Path("gallery"),
    only: Annotated[
        list[str] | None, option("NAME", "A picture to draw, such as contact or hero_sweep; repeatable; default: all.")
    ] = None,
    force: ForceOutput = False,
) -> int:
    """Draw one picture of every kind of scene, and the two at the top of the README.

    hero_sweep.webp is animated: a rod whose modulus rises and falls. hero_page.png shows the live page; without a
    Chromium on PATH it is left out. Exit status 1 if OpenGL does not work on this machine.
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
            from ..scene import sweep

            sweep.write(datasets[SWEEP](), "E", path)
        else:
            _scene(name, datasets.get(name, datasets["contact"])(), path)
        console.say(str(path))
    return 0


def _suffixes(only: list[str]) -> dict[str, str]:
    """The suffix of each picture that is wanted. Raises `InputError` for an unknown name."""
    from solver.problem.errors import no_such

    from ..scene import kinds, sweep

    known = dict.fromkeys([*kinds.KINDS, *OWN], ".png") | {SWEEP: sweep.suffix(), PAGE: ".png"}
    for name in only:
        if name not in known:
            raise no_such("picture", name, list(known))
    return {name: suffix for name, suffix in known.items() if not only or name in only}


def _scene(name: str, ds: Any, path: Path) -> None:
    """Draw one scene."""
    from ..scene import composition, layout

    kind, axes = "contact" if name in OWN else name, ["F1", "F3"] if name == "grid" else []
    layout.render(ds, path, None, kind, axes, settings=composition.Settings(dpi=DPI), level=9)


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
        axes = {"E": Axis.model_validate({"values": MODULI})}
        return in_memory.run(load(STUDY).model_copy(update={"axes": axes, "laws": []}))

    def own(text: str) -> Callable[[], Any]:
        return lambda: in_memory.run(loads(text, default_name="rod"))

    return {
        "contact": cache(lambda: in_memory.run(load("fig6"))),
        "ghosts": lambda: in_memory.run(load(STUDY)),
        "grid": lambda: in_memory.run(load("fig7_5_forces")),
        "equilibria": equilibria,
        SWEEP: sweep,
        **{name: own(text) for name, text in OWN.items()},
    }
