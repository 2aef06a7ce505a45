"""What is written beside a scene: which case it is, how much of the rod is drawn, what a real rod could not do."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import xarray as xr

from studies.dimensions import SAMPLE

from ..data import labels
from ..data.schema import dimension, sampled_fields

if TYPE_CHECKING:
    from .body import Body
    from .colours import Bar

ITSELF = "the rod passes through itself"
UNSEEN = "\n(no ring where the cylinder hides it)"
BEHIND = "a stretch behind the cylinder"
ASKED = 6  # digits of a value with which --at finds its case again


def impossible(bodies: Sequence["Body"]) -> list[str]:
    """What a real rod could not do, beyond what colours show; of several rods how many."""
    each = {id(body.line): body.caution for body in bodies}.values()
    found = []
    for key, one, more in (
        ("overlaps", ITSELF, "pass through themselves"),
        ("too tight", "bent tighter than its own radius (κa > 1)", "bent tighter than their own radius (κa > 1)"),
    ):
        count = sum(key in caution for caution in each)
        if count:
            found.append(one if len(each) == 1 else f"{count} of {len(each)} {more}")
    return found


def beyond(bodies: Sequence["Body"], bar: "Bar | None", chosen: tuple[float, float]) -> list[str]:
    """The extremes of the rods where they lie outside the chosen scale of colours."""
    if not bodies or bar is None:
        return []
    extremes = [body.extremes() for body in bodies]
    low, high = min(one for one, _ in extremes), max(one for _, one in extremes)
    said = [f"up to {labels.number(high)}"] if high > chosen[1] else []
    said += [f"down to {labels.number(low)}"] if low < chosen[0] and not bar.pulls else []
    return [f"{bar.label}: {', '.join(said)}"] if said else []


def part_drawn(bodies: Sequence["Body"], unit: str) -> list[str]:
    """Which part of the rods is drawn, where it is not all of them."""
    parts = [body for body in bodies if not body.whole]
    if not parts:
        return []
    low, high = parts[0].span
    L = labels.number(parts[0].line.L)
    return [f"only s = {labels.number(low)} to {labels.number(high)} {unit} of {L} {unit}"]


def axis_values(ds: xr.Dataset, names: list[str], where: dict[str, int]) -> str:
    """The text below the cell of a case: its values along the axes that are shown."""
    if len(names) == 1:
        return labels.value(float(ds[names[0]].values[where[names[0]]]), ds[names[0]])
    return "\n".join(values(ds, {name: where[name] for name in names}))


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
            names += map(dimension, sampled_fields(ds))
        each += [f"{labels.axis_symbol(n)} = {labels.value(ds[n].values[i].item(), ds[n], digits)}" for n in names]
    return each
