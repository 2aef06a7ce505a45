"""What is written beside a scene: of which case it is, what its colours mean, how much of the rod is drawn."""

from collections.abc import Mapping, Sequence

import xarray as xr

from ..figures import style
from ..geometry.tube import Body
from .kinds import Kind

ASKED = 6  # digits of a value by which its case can be asked for again


def legend(kind: Kind, bodies: Sequence[Body]) -> list[tuple[str, str]]:
    """Colours that the bar does not explain, and what they mean."""
    if kind.tint == "stripe":
        return [(style.PUSHED, "a stripe along the material: it turns as the rod is twisted and bent")]
    if kind.tint == "contact" and any(body.extremes()[0] < 0 for body in bodies):
        return [(style.LIFTED, "the cylinder would have to\npull: the rod would lift off")]
    return []


def impossible(bodies: Sequence[Body]) -> list[str]:
    """What a real rod could not do, but for what colours show; of several rods how many."""
    each = {id(body.line): body.caution for body in bodies}.values()
    told = []
    for key, one, more in (
        ("overlaps", "the rod passes through itself", "pass through themselves"),
        ("too tight", "bent tighter than it is thick", "bent tighter than thick"),
    ):
        count = sum(key in caution for caution in each)
        if count:
            told.append(one if len(each) == 1 else f"{count} of {len(each)} {more}")
    return told


def covered(pieces: Sequence[Body], unit: str) -> list[str]:
    """What part of the rod is drawn, where not all of it."""
    if not pieces:
        return []
    low, high = pieces[0].span
    L = style.number(pieces[0].line.L)
    return [f"only s = {style.number(low)} to {style.number(high)} {unit} of {L} {unit}"]


def under(ds: xr.Dataset, kind: Kind, names: list[str], where: dict[str, int]) -> str:
    """What stands under the cell of a case: the values along the axes that are shown, or which equilibrium it is."""
    if kind.name == "equilibria":
        one = ds.isel(where)
        stable = "stable" if int(one["index"]) == 0 else f"index {int(one['index'])}"
        return f"{where['equilibrium'] + 1}: {stable}\n{style.shown(float(one['energy']), one['energy'])}"
    if len(names) == 1:
        return style.shown(float(ds[names[0]].values[where[names[0]]]), ds[names[0]])
    return "\n".join(facts(ds, {name: where[name] for name in names}))


def described(ds: xr.Dataset, where: Mapping[str, int]) -> str:
    """The values of a case along all axes, in one line, as exact as --at takes them."""
    return ", ".join(facts(ds, where, ASKED))


def facts(ds: xr.Dataset, where: Mapping[str, int], digits: int = 4) -> list[str]:
    """The value of a case along each of these axes, with its unit."""
    return [f"{style.symbol(n)} = {style.shown(float(ds[n].values[i]), ds[n], digits)}" for n, i in where.items()
            if n != "equilibrium"]  # fmt: skip
