"""The pictures of a stored study by their kind, and the kind that a study has by default."""

from collections.abc import Callable
from dataclasses import dataclass

import xarray as xr
from matplotlib.figure import Figure

from solver.problem.errors import InputError, choices, no_such
from studies.dimensions import SAMPLE

from ..data import observed, refined, schema
from . import curves, map_cells, map_figure, portrait, ridge, study_figure


@dataclass(frozen=True)
class Kind:
    """A kind of picture. figure: of a dataset. options: keywords of `figure` besides the sheet."""

    figure: Callable[..., Figure]
    options: tuple[str, ...] = ()


KINDS = {
    "map": Kind(map_figure.figure, ("x", "y", "show", "at", "shapes")),
    "lines": Kind(study_figure.figure),
    "curves": Kind(curves.figure, ("x", "at")),
    "ridge": Kind(ridge.figure, ("x", "at")),
    "portrait": Kind(portrait.figure, ("x", "at")),
}


def check_options(kind: str, given: list[str]) -> None:
    """Raise `InputError` for an option that the kind does not have."""
    for name in given:
        if name not in KINDS[kind].options:
            takers = choices(other for other, row in KINDS.items() if name in row.options)
            raise InputError(f"--{name} is no option of --kind {kind}; choose --kind from {takers}")


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
