"""What is written beside a scene: which case it is, and what stands below each rod."""

from collections.abc import Mapping
from dataclasses import dataclass

import xarray as xr

from studies.grammar.axes import SAMPLE

from ..store.schema import dimension, fields_of_samples
from ..words import labels

ASKED = 6  # digits of a value with which --at finds its case again


@dataclass(frozen=True)
class Cell:
    """The words of a view.

    Attributes
    ----------
    caption
        Below it.
    why_empty
        Why there is no rod.
    number, stable
        The number of an equilibrium, in a dot that is filled where it is stable; default: no dot.
    """

    caption: str = ""
    why_empty: str = ""
    number: int | None = None
    stable: bool = False


def value_cell(ds: xr.Dataset, names: list[str], where: dict[str, int]) -> Cell:
    """A cell with the case's values along the axes below it."""
    if len(names) == 1:
        return Cell(labels.value(float(ds[names[0]].values[where[names[0]]]), ds[names[0]]))
    return Cell("\n".join(values(ds, {name: where[name] for name in names})))


def equilibrium(ds: xr.Dataset, names: list[str], where: dict[str, int]) -> Cell:
    """A cell with the number of an equilibrium, whether it is stable, and its energy."""
    one = ds.isel(where)
    index = int(one["index"])
    words = "stable\n" if index == 0 else f"unstable\nin {index} way{'s' * (index > 1)}"
    energy = labels.value(float(one["energy"]), one["energy"])
    return Cell(f"{words}\n{energy}", number=int(one["equilibrium"]), stable=index == 0)


def headings(ds: xr.Dataset, name: str, cases: list[dict[str, int]]) -> list[str]:
    """The headings of a table: the quantity of an axis with its unit, and the value of each case without."""
    array = ds[name]
    each = labels.in_label_unit(array, array.values[[where[name] for where in cases]])
    return [labels.axis_label(name, array), *(labels.minus_signs(labels.number(float(value))) for value in each)]


def case_values(ds: xr.Dataset, where: Mapping[str, int], digits: int = ASKED) -> str:
    """The values of a case along all axes, in one line; default: with as many digits as --at needs."""
    return ", ".join(values(ds, where, digits))


def values(ds: xr.Dataset, where: Mapping[str, int], digits: int = 4) -> list[str]:
    """The value of a case along each of these axes, with its unit; an equilibrium's number is none.

    The number of a sample is followed by the values of its fields.
    """
    each = []
    for axis, i in where.items():
        names = [] if axis == "equilibrium" else [axis]
        if axis == SAMPLE:
            names += map(dimension, fields_of_samples(ds))
        each += [labels.equations(ds, {name: i}, digits) for name in names]
    return each
