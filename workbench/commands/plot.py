"""The command plot: the figure of a stored dataset."""

from pathlib import Path

from ..data import writing
from . import console, output_file


def plot_file(file: Path, out: Path | None, force: bool = False, dpi: int = 200) -> None:
    """Draw a dataset's developed curves and observables; dpi: of a PNG. Raises `InputError`."""
    from ..figures import canvas, study_figure

    ds = writing.read(file)
    path = output_file.check(out or file.with_suffix(".png"), canvas.DIAGRAMS, force)
    canvas.save(study_figure.figure(ds), path, dpi)
    console.say(str(path))
