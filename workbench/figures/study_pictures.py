"""The pictures of a stored study by their kind, and the kind that a study has by default."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import xarray as xr
from matplotlib.figure import Figure

from solver.problem.errors import InputError, choices, no_such
from studies.dimensions import SAMPLE

from ..data import observed, refined, schema
from . import along, map_cells, map_figure, portrait, study_figure, unrolled


@dataclass(frozen=True)
class Kind:
    """A kind of picture. figure: of a dataset. options: keywords of `figure` besides the sheet."""

    figure: Callable[..., Figure]
    options: tuple[str, ...] = ()


KINDS = {
    "map": Kind(map_figure.figure, ("x", "y", "show", "at", "shapes")),
    "lines": Kind(study_figure.figure, ("x", "show")),
    "curves": Kind(unrolled.figure, ("x", "at")),
    "ridge": Kind(along.figure, ("x", "at", "show")),
    "portrait": Kind(portrait.figure, ("x", "at")),
    "states": Kind(along.states, ("x", "at")),
}


def kind_of(ds: xr.Dataset, kind: str | None = None, given: Sequence[str] = ()) -> str:
    """The kind of picture: the one that is asked for; default: a map over two axes, with samples and else lines.

    given: options; a study whose default kind does not have them is drawn in the first kind that does.

    Raises `InputError` for an unknown kind, and for an option that the kind does not have.
    """
    if kind is None:
        default = _default_kind(ds)
        kind = next((one for one in (default, *KINDS) if set(given) <= set(KINDS[one].options)), default)
    elif kind not in KINDS:
        raise no_such("kind of picture", kind, KINDS)
    for name in given:
        if name not in KINDS[kind].options:
            takers = choices(other for other, row in KINDS.items() if name in row.options)
            raise InputError(f"--{name} is no option of --kind {kind}; choose --kind from {takers}")
    return kind


def _default_kind(ds: xr.Dataset) -> str:
    if refined.is_refined(ds):
        return "map" if len(refined.axes_of(ds)) > 1 else "lines"
    is_map = len(map_cells.mappable(ds)) > 1 and SAMPLE not in schema.axes_of(ds) and observed.observables(ds)
    return "map" if is_map else "lines"
