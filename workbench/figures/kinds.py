"""The one table of pictures: what each kind draws, by which options, and the kind that a dataset has by default."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from solver.problem.errors import InputError, choices, no_such
from studies.grammar.axes import SAMPLE

from ..store import refined, schema, selection
from . import (
    along,
    bars,
    bifurcation,
    equilibria_figure,
    fit_figure,
    map_cells,
    map_figure,
    portrait,
    region_map,
    robustness,
    study_figure,
    unrolled,
    work_precision,
)
from .sheet import SCREEN, Sheet


@dataclass(frozen=True)
class Kind:
    """A kind of picture: its figure of a dataset and a sheet, its further keywords, and the data that it draws."""

    figure: Callable[..., Figure]
    options: tuple[str, ...] = ()
    of: str = "study"


KINDS = {
    "map": Kind(map_figure.figure, ("x", "y", "show", "at", "shapes")),
    "lines": Kind(study_figure.figure, ("x", "show")),
    "curves": Kind(unrolled.figure, ("x", "at")),
    "ridge": Kind(along.figure, ("x", "at", "show")),
    "portrait": Kind(portrait.figure, ("x", "at")),
    "states": Kind(along.states, ("x", "at")),
    "pipe": Kind(along.pipe, ("x", "at")),
    "bars": Kind(bars.of_cases, ("x", "at", "show")),
    "equilibria": Kind(equilibria_figure.figure, ("show",), of="equilibria"),
    "loops": Kind(equilibria_figure.loops, of="loops"),
    "branches": Kind(bifurcation.figure, ("show",), of="branches"),
    "folds": Kind(region_map.figure, ("show",), of="folds"),
    "trade": Kind(work_precision.figure, ("cost",), of="trade"),
    "extremes": Kind(robustness.figure, of="extremes"),
    "fit": Kind(fit_figure.figure, of="fit"),
    "indices": Kind(bars.indices, of="indices"),
    "tornado": Kind(bars.tornado, of="tornado"),
}
OF_STUDIES = {name: kind for name, kind in KINDS.items() if kind.of == "study"}


def figure(ds: xr.Dataset, kind: str | None = None, sheet: Sheet = SCREEN, **options: Any) -> Figure:
    """The picture of a dataset of any kind; kind: a name of `KINDS`, by default as the dataset says.

    Raises `InputError` as of `kind_of` and of the figure.
    """
    name = kind or schema.kind_of(ds).figure
    if name in ("", "study"):
        name = kind_of(ds, None, [option for option in options if option != "verdicts"])
    return KINDS[name].figure(ds, sheet=sheet, **options)


def kind_of(ds: xr.Dataset, kind: str | None = None, given: Sequence[str] = ()) -> str:
    """The kind of picture of a study: the one that is asked for; default: a map over two axes, else lines.

    given: options; a study whose default kind does not have them is drawn in the first kind that does.

    Raises `InputError` for an unknown kind, and for an option that the kind does not have.
    """
    if kind is None:
        default = _default_kind(ds)
        kind = next(
            (candidate for candidate in (default, *OF_STUDIES) if set(given) <= set(KINDS[candidate].options)), default
        )
    elif kind not in OF_STUDIES:
        raise no_such("kind of picture", kind, OF_STUDIES)
    for name in given:
        if name not in KINDS[kind].options:
            takers = choices(other for other, row in OF_STUDIES.items() if name in row.options)
            raise InputError(f"--{name} is no option of --kind {kind}; choose --kind from {takers}")
    return kind


def _default_kind(ds: xr.Dataset) -> str:
    if axes := refined.axes_of(ds):
        return "map" if len(axes) > 1 else "lines"
    is_map = len(map_cells.mappable(ds)) > 1 and SAMPLE not in schema.axes_of(ds) and selection.observables(ds)
    return "map" if is_map else "lines"
