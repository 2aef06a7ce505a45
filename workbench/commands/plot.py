"""The command plot: the figure of a stored study."""

from pathlib import Path
from typing import Annotated

from . import console
from .options import File, ForceOutput, option


def plot(
    file: File,
    out: Annotated[
        Path | None, option("FILE", "Picture, .png, .pdf or .svg; default: FILE with the ending .png.")
    ] = None,
    dpi: Annotated[int, option("DPI", "Resolution of a .png [pixels/inch].", min=50, max=1200)] = 200,
    force: ForceOutput = False,
) -> int:
    """Draw the developed curves and observables of a stored study.

    A developed curve is the centreline on the unrolled cylinder. The panel of a law shows its verdict.
    """
    from ..data import writing
    from ..figures import canvas, study_figure
    from . import output_file

    ds = writing.read(file)
    path = output_file.check(out or file.with_suffix(".png"), canvas.DIAGRAMS, force)
    canvas.save(study_figure.figure(ds), path, dpi)
    console.say(str(path))
    return 0
