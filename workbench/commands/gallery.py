"""The command gallery: one picture of every kind of scene."""

from pathlib import Path
from typing import Annotated

from . import console
from .options import ForceOutput, option

DPI = 200  # of print
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


def gallery(
    out: Annotated[Path, option("FOLDER", "Folder for the pictures.")] = Path("gallery"), force: ForceOutput = False
) -> int:
    """Draw one picture of every kind of scene.

    Exit status 1 if OpenGL does not work on this machine.
    """
    from solver import equilibria
    from studies import load
    from studies.loader import loads

    from ..data import writing
    from ..scene import kinds, opengl
    from . import output_file

    writing.check_folder(out)
    names = [*kinds.KINDS, "inside", "long", "longest"]
    paths = {name: output_file.check(out / f"{name}.png", (".png",), force) for name in names}
    able, advice = opengl.probe()
    if not able:
        console.warn(advice)
        return 1
    from ..branches.equilibria import ends_problem
    from ..branches.equilibria_dataset import dataset_of
    from ..run import in_memory
    from ..scene import composition, layout

    one, row, table = (in_memory.run(load(name)) for name in ("fig6", "fig7_1_modulus", "fig7_5_forces"))
    own = {"inside": INSIDE, "long": LONG, "longest": LONGEST}
    solved = {name: in_memory.run(loads(text, default_name="rod")) for name, text in own.items()}
    study = load("fig7_4_end_angle")
    case = ends_problem(study)
    every = dataset_of(study, case, equilibria(case))
    solved |= {"ghosts": row, "grid": table, "equilibria": every}
    for name, path in paths.items():
        axes = ["F1", "F3"] if name == "grid" else []
        settings = composition.Settings(dpi=DPI)
        kind = "contact" if name in own else name
        layout.render(solved.get(name, one), path, None, kind, axes, settings=settings, level=9)
        console.say(str(path))
    return 0
