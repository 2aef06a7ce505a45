"""The command export: one stored rod as a file for other programs."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from ..export import FORMATS
from ..words.unit_habits import plain
from . import console
from .options import AT, File, ForceOutput, axis_values, flag, number_option, option
from .present import Result, presents

# with words of their own
APART = ("volume", "spans", "within", "tolerance", "solution_error", "unit", "R", "values", "solved_at")


@presents()
def export(
    file: File,
    out: Annotated[
        Path,
        option(
            "FILE",
            f"File to write: {' '.join(FORMATS)}; frame_{{:03d}}.stl: a file for each value of an axis.",
            "--out",
            "-o",
        ),
    ],
    at: Annotated[
        list[str] | None,
        option(
            "AXIS=VALUE",
            AT + " Default: the value at which the laws of the study are decided, else that nearest "
            "to Table 1 if the study has a reading, else the middle of the axis; .pvd and names with a number in "
            "braces take all values of the axis that is not named.",
        ),
    ] = None,
    tolerance: Annotated[
        float | None,
        number_option(
            "Largest distance between the shape in the file and the stored rod [length], whose own error, "
            "which --tol of run and solve bounds, comes on top; default for .step: 1e-6 of the distance from "
            "the axis of the cylinder to the centreline; for meshes and .usda: 1e-3 of the rod's radius. The "
            "formats .vtp, .pvd and .csv hold the stored stations and take no tolerance."
        ),
    ] = None,
    triangles: Annotated[
        int | None,
        option(
            "NUMBER",
            "Most triangles of a mesh; its tolerance is then the default one, or the least larger one that they allow.",
        ),
    ] = None,
    centreline: Annotated[bool, flag("Write the centreline to STEP, without a solid.", "--centreline")] = False,
    overlap: Annotated[bool, flag("Write a solid to STEP even if the rod intersects itself.", "--overlap")] = False,
    color: Annotated[
        str | None,
        option(
            "COLOUR",
            "Colour of the rod in .glb, .gltf and .usda, such as '#14181e' or navy; default: two colours, "
            "of push and of lift-off.",
        ),
    ] = None,
    force: ForceOutput = False,
) -> Result:
    """Export one stored rod to CAD, mesh, curve or table formats; the rods along an axis to .pvd, or to one file each.

    A name with a number in braces, such as frame_{:03d}.stl, writes each rod along the axis that --at does not name.
    Exit status 1 if a rod intersects itself or is bent tighter than its own radius, or is left out for such a reason.
    """
    from ..export import stored_rod
    from ..export.file_format import ExportOptions
    from ..scene.settings import color_of
    from ..stored import reading

    stored_rod.format_of(out)  # before a large file is read
    stored = reading.read_stored(file)
    shade = color_of("--color", color)
    options = ExportOptions(axis_values(stored, at), tolerance, centreline, overlap, triangles, shade)
    done = stored_rod.export(stored, out, options, force, console.warn)
    status = 1 if done.warnings else 0

    def show() -> None:
        where = ", ".join(f"{name}={value:g}" for name, value in done.at.items())
        unit = stored.units["length"]
        console.say(f"{done.path}{f' at {where}' if where else ''}: {_in_words(done.facts, unit)}")

    data = {"file": str(done.path), "at": done.at, **done.facts, "warnings": done.warnings, "status": status}
    return Result(lambda: data, show, status, warnings=done.warnings)


def _in_words(facts: Mapping[str, Any], unit: str) -> str:
    """The numbers about a file in words; unit: that of length in the study, which is that of the tolerance."""
    written = str(facts.get("unit", unit))
    said = [f"solid, {facts['volume']:.6g} {written}3"] if "volume" in facts else []
    said += ["centreline"] if "spans" in facts and "volume" not in facts else []
    counted = {name: value for name, value in facts.items() if name not in APART}
    said += [f"{name} {n}" if isinstance(n, str) else f"{n} {name}" for name, n in counted.items()]
    if "solved_at" in facts:
        said.append(f"solved at {facts['solved_at']} stations")
    if "tolerance" in facts:
        said.append(f"within {plain(facts['tolerance'], 2)} {unit} of the rod")
    if facts.get("solution_error", 0.0) > facts.get("tolerance", math.inf):
        said.append(f"whose own error is estimated at {facts['solution_error']:.2g} {unit} at most")
    apart = f" (in {written}; the cylinder of radius {facts['R']:g} is not in the file)" if "R" in facts else ""
    return f"{', '.join(said)}{apart}"
