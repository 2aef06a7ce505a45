"""Hand the result of a command to its reader: sentences and tables or JSON, a dataset in a file, a picture."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import console

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ..figures.sheet import Sheet


@dataclass(frozen=True)
class Files:
    """The files that a command is asked for, each checked before anything is computed.

    picture, out: of the figure and of the dataset, or None. force: whether `out` may replace a file of another kind.
    """

    picture: Path | None
    out: Path | None
    force: bool


NO_FILES = Files(None, None, False)


@dataclass(frozen=True)
class Result:
    """What a command found.

    data: it as plain data. show: prints it for people. dataset: it as a dataset, which is drawn, and stored unless
    `write` writes it in another form; None where no file is asked for. figure: the kind of its figure;
    default: that of the kind of file.
    """

    data: Callable[[], Any]
    show: Callable[[], None]
    dataset: "Callable[[], xr.Dataset] | None" = None
    write: Callable[[Path], object] | None = None
    figure: str | None = None


def files(plot: Path | None, out: Path | None, force: bool, kind: str = "", suffixes: tuple[str, ...] = ()) -> Files:
    """The files of these options. Raises `InputError`.

    kind: of the dataset, as of `writing.check_free`: what `out` holds already may be replaced if it is of this kind.
    suffixes: those of `out` where it is no dataset.
    """
    from ..store import writing
    from . import option_checks

    if plot is not None:
        from ..figures import canvas

        option_checks.check(plot, canvas.DIAGRAMS, force)
    if out is not None and suffixes:
        option_checks.check(out, suffixes, force)
    elif out is not None:
        writing.check_parent(out)
        if not force:
            writing.check_free(out, kind)
    return Files(plot, out, force)


def present(
    result: Result, as_json: bool, asked: Files = NO_FILES, dpi: int = 200, sheet: "Sheet | None" = None
) -> "Figure | None":
    """Store and draw what was asked for, then print it; the figure. sheet: of the picture."""
    drawn, ds = None, None
    if result.dataset is not None and (asked.picture or (asked.out and result.write is None)):
        ds = result.dataset()
    if asked.out and result.write is not None:
        result.write(asked.out)
    elif asked.out and ds is not None:
        from ..store import writing

        writing.write(ds, asked.out, asked.force)
    if asked.picture and ds is not None:
        from ..figures import canvas, kinds
        from ..figures.sheet import SCREEN

        drawn = kinds.figure(ds, result.figure, sheet or SCREEN)
        canvas.save(drawn, asked.picture, dpi)
    if as_json:
        console.print_json(result.data())
    else:
        result.show()
    return drawn
