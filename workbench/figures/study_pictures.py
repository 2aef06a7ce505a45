"""The pictures of a stored study by their kind, and the kind that a study has by default."""

from collections.abc import Callable

import xarray as xr
from matplotlib.figure import Figure

from solver.problem.errors import no_such
from studies.dimensions import SAMPLE

from ..data import observed, refined, schema
from . import map_cells, map_figure, study_figure

# kind -> the figure of a dataset
KINDS: dict[str, Callable[..., Figure]] = {"map": map_figure.figure, "lines": study_figure.figure}


def kind_of(ds: xr.Dataset, kind: str | None = None) -> str:
    """The kind of picture: the one that is asked for; default: a map over two axes, with samples and else lines.

    Raises `InputError` for an unknown kind.
    """
    if kind is not None and kind not in KINDS:
        raise no_such("kind of picture", kind, KINDS)
    if kind is None and refined.is_refined(ds):
        return "map" if len(refined.axes_of(ds)) > 1 else "lines"
    axes = map_cells.mappable(ds)
    is_map = len(axes) > 1 and SAMPLE not in schema.axes_of(ds) and observed.observables(ds)
    return kind or ("map" if is_map else "lines")
