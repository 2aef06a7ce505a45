"""The command plot: the figure of a stored study."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from . import console
from .options import At, File, ForceOutput, option

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


def plot(
    file: File,
    out: Annotated[
        Path | None, option("FILE", "Picture, .png, .pdf or .svg; default: FILE with the ending .png.")
    ] = None,
    kind: Annotated[
        str | None,
        option(
            "KIND",
            "map: each observable over two axes; lines: developed curves, and observables along each axis with their "
            "laws, or against the sampled fields. Default: map for a grid of two axes or more, else lines.",
        ),
    ] = None,
    x: Annotated[str | None, option("AXIS", "Axis of a map to the right; default: the study's first.", "--x")] = None,
    y: Annotated[str | None, option("AXIS", "Axis of a map upward; default: the study's next.", "--y")] = None,
    show: Annotated[
        list[str] | None, option("NAMES", "Observables of a map, separated by commas; default: all that are stored.")
    ] = None,
    at: At = None,
    shapes: Annotated[
        str | None, option("NxM", "Draw N x M developed shapes over the first map, such as 5x5 (at most 12x12).")
    ] = None,
    dpi: Annotated[int, option("DPI", "Resolution of a .png [pixels/inch].", min=50, max=1200)] = 200,
    force: ForceOutput = False,
) -> int:
    """Draw the observables of a stored study, as maps over two axes or along each axis.

    A map shows where the rod would lift off or passes through itself, and on which lines a law holds. A third axis has
    a map for each of some values; further axes have one value (--at). A developed curve is the centreline on the
    unrolled cylinder.
    """
    from ..data import writing
    from ..figures import canvas
    from . import output_file

    ds = writing.read(file)
    path = output_file.check(out or file.with_suffix(".png"), canvas.DIAGRAMS, force)
    canvas.save(_figure(ds, kind, x, y, show or [], at or [], shapes), path, dpi)
    console.say(str(path))
    return 0


def _figure(
    ds: "xr.Dataset", kind: str | None, x: str | None, y: str | None, show: Sequence[str], at: list[str],
    shapes: str | None,
) -> "Figure":  # fmt: skip
    """The figure of that kind. Raises `InputError` for an option that the kind does not have."""
    from solver.problem.errors import InputError

    from ..figures import study_pictures, thumbnails
    from . import at_option

    given: dict[str, Any] = {"x": x, "y": y, "show": show, "at": at, "shapes": shapes}
    of_map = {name: value for name, value in given.items() if value}
    if of_map and kind is None:
        kind = "map"
    kind = study_pictures.kind_of(ds, kind)
    if kind != "map":
        if of_map:
            raise InputError(f"--{next(iter(of_map))} is an option of maps, got --kind {kind}; give --kind map")
        return study_pictures.KINDS[kind](ds)
    of_map |= {"at": at_option.values(ds, at)} if at else {}
    of_map |= {"show": [name.strip() for text in show for name in text.split(",")]} if show else {}
    of_map |= {"shapes": thumbnails.read(shapes)} if shapes else {}
    return study_pictures.KINDS[kind](ds, **of_map)
