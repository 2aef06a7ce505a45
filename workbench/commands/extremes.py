"""The command extremes: store, draw and print the result of every method at every named extreme."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from . import console, tables
from .options import option
from .present import Result, presents

if TYPE_CHECKING:
    import xarray as xr

    from ..compare.extreme_runs import Attempt


@presents()
def extremes(
    out: Annotated[Path, option("FOLDER", "Folder for extremes.h5 and its map.")] = Path("extremes"),
) -> Result:
    """Test the robustness of every method at extreme parameters.

    The folder receives extremes.h5 and extremes.png, a map of methods against extremes. Exit status 1 if a method
    calls an inaccurate answer solved.

    When interrupted, the command stores and draws the finished extremes as extremes_interrupted; extremes.h5 stays
    unchanged.
    """
    from ..compare import extreme_cases
    from ..compare.extreme_runs import INACCURATE, VERDICTS, rows_of
    from ..store import writing

    writing.check_folder(out)
    writing.check_free(out / "extremes.h5", "extremes")
    named = extreme_cases.extremes()
    measure, store = partial(rows_of, named), partial(_store, out)
    ds, files = console.keep_finished(measure, len(named), "extremes", store, "extremes")
    counts = {
        str(method): {verdict: int((ds["verdict"].sel({"method": method}) == verdict).sum()) for verdict in VERDICTS}
        for method in ds["method"].values
    }

    def show() -> None:
        rows = [[method, *map(str, row.values())] for method, row in counts.items()]
        tables.print_table(["method", *VERDICTS], rows, str(ds.attrs["title"]))
        for file in files:
            console.say(str(file))

    status = 1 if any(row[INACCURATE] for row in counts.values()) else 0
    return Result(lambda: {"methods": counts, "files": [str(file) for file in files]}, show, status)


def _store(
    out: Path, finished: "Sequence[tuple[str, Mapping[str, Attempt]]]", name: str
) -> "tuple[xr.Dataset, list[Path]]":
    """The dataset of the finished extremes, and the files made of it: NAME.h5 and NAME.png."""
    from ..compare.extreme_runs import dataset_of
    from ..figures import canvas, kinds
    from ..store import writing

    ds = dataset_of(dict(finished))
    picture = out / f"{name}.png"
    drawn = kinds.figure(ds)
    canvas.save(drawn, picture, drawn.dpi)
    return ds, [writing.write(ds, out / f"{name}.h5"), picture]
