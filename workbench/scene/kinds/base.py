"""What a kind of scene is: what it reads of a dataset, what its cells hold, and how it colours the rods."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import xarray as xr

from ...geometry import centreline
from ...geometry.centreline import Array, Centreline
from .. import captions, colours
from ..cells import Cell

if TYPE_CHECKING:
    from ..body import Body

CURVE = frozenset(centreline.NEEDED)


def no_legend(bodies: Sequence["Body"]) -> list[tuple[str, str]]:
    """No entries."""
    return []


def named(ds: xr.Dataset, names: list[str], where: dict[str, int], why_empty: str) -> Cell:
    """A cell with the case's values along the axes below it."""
    return Cell(captions.axis_values(ds, names, where) if names else "", why_empty)


def any_dataset(ds: xr.Dataset) -> None:
    """Accept every dataset."""


@dataclass(frozen=True)
class Kind:
    """A kind of scene.

    Attributes
    ----------
    reads
        Variables of the dataset that it opens, beside the case's outcome, caution and arc length. Nothing else is read.
    cells
        What stands on the page: one rod from two sides, each case of an axis in a cell of its own, or all cases of an
        axis in one cell.
    value
        What the colour shows along a rod at s, (k,); nothing else is computed there. Default: one colour a rod.
    paint
        The colours of all rods and their bar; for "together" each rod has the colour of its value on the axis instead.
    legend
        Colours that the bar does not explain, each with its meaning.
    cell
        The words of the cell of a case, from the dataset, the axes named below it, the case's indices, and why it has
        no shape.
    check
        Raises `InputError` for a dataset that the kind cannot show.
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
    paint: Callable[[xr.Dataset, Sequence["Body"]], colours.Painted] = colours.one_colour
    legend: Callable[[Sequence["Body"]], list[tuple[str, str]]] = no_legend
    cell: Callable[[xr.Dataset, list[str], dict[str, int], str], Cell] = named
    check: Callable[[xr.Dataset], None] = any_dataset
    most: int = 9
    notes: tuple[str, ...] = ()
