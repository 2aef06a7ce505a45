"""The kinds of scene: one table, which `scene`, `gallery` and `animate` read; a new kind is a row of it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import xarray as xr

from solver.problem.errors import no_such

from ..figures import colours
from ..geometry import centreline
from ..geometry.centreline import Array, Centreline
from ..store.schema import axes_of
from . import captions
from . import paint as paints
from .captions import Cell

CURVE = frozenset(centreline.NEEDED)


@dataclass(frozen=True)
class Kind:
    """A kind of scene.

    Attributes
    ----------
    cells
        What stands on the page: one rod, each case of an axis in a cell of its own, or all cases of an axis in one.
    reads
        Variables of the dataset that it opens, beside the case's outcome, caution and arc length. Nothing else is read.
    value
        What the colour shows along a rod at s, (k,); nothing else is computed there. Default: one colour a rod.
    paint
        The colours of all rods and their bar, from the units and the extremes of the value; for "together" each rod has
        the colour of its value on the axis instead.
    legend
        Colours that the bar does not explain, each with its meaning.
    cell
        The words of the cell of a case, from the dataset, the axes named below it and the case's indices.
    of_equilibria
        Whether it shows stored equilibria alone.
    most
        Cells of one axis that are shown.
    notes
        Sentences beside the legend.
    """

    name: str
    description: str
    cells: Literal["one", "each", "together"]
    reads: frozenset[str] = CURVE
    value: Callable[[Centreline, Array], Array] | None = None
    paint: Callable[[dict[str, str], paints.Extremes], paints.Painted] = paints.one_colour
    legend: tuple[tuple[str, str], ...] = ()
    cell: Callable[[xr.Dataset, list[str], dict[str, int]], Cell] = captions.value_cell
    of_equilibria: bool = False
    most: int = 9
    notes: tuple[str, ...] = ()


TURNS = (colours.STRIPE, "a stripe along the material: it turns as the rod is twisted and bent")
PUSH: dict[str, Any] = {"value": lambda line, s: line.push(s), "paint": paints.by_push}
TABLE = (
    Kind("plain", "the rod on its cylinder", "one"),
    Kind("contact", "how hard the cylinder pushes, and where it would have to pull", "one", **PUSH),
    Kind("curvature", "how tightly the rod is bent", "one", value=lambda line, s: line.kappa(s),
         paint=paints.by_curvature),
    Kind("twist", "a stripe on the rod that turns with its material", "one", CURVE | {"gamma"},
         paint=paints.with_stripe, legend=(TURNS,)),
    Kind("ghosts", "every case of an axis in one scene", "together", most=3),
    Kind("grid", "every case of one axis or two, side by side at one scale", "each", **PUSH),
    Kind("equilibria", "every equilibrium between two ends", "each", CURVE | {"energy", "index"}, **PUSH,
         cell=captions.equilibrium, of_equilibria=True, most=18, notes=("below each rod its energy",)),
)  # fmt: skip
KINDS = {kind.name: kind for kind in TABLE}


def kind_of(name: str) -> Kind:
    """The kind of that name. Raises `InputError` with the choices."""
    if name not in KINDS:
        raise no_such("kind of scene", name, KINDS)
    return KINDS[name]


def default_kind(ds: xr.Dataset) -> str:
    """The kind by which a dataset is drawn unless another is asked for."""
    return "equilibria" if axes_of(ds) == ["equilibrium"] else "contact"
