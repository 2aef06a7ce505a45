"""The kind equilibria: every equilibrium between two ends, with its index and energy."""

from dataclasses import replace

import xarray as xr

from solver.problem.errors import InputError

from ...data import labels
from ...data.schema import axes_of
from .grid import KIND as GRID


def check(ds: xr.Dataset) -> None:
    """Raise `InputError` unless the dataset is one of equilibria."""
    if axes_of(ds) != ["equilibrium"]:
        raise InputError("a scene of kind equilibria takes a dataset that `workbench equilibria --out FILE` stored")


def caption(ds: xr.Dataset, names: list[str], where: dict[str, int]) -> str:
    """Its number, whether it is stable, and its energy."""
    one = ds.isel(where)
    stable = "stable" if int(one["index"]) == 0 else f"index {int(one['index'])}"
    return f"{where['equilibrium'] + 1}: {stable}\n{labels.value(float(one['energy']), one['energy'])}"


KIND = replace(
    GRID, name="equilibria", description="every equilibrium between two ends", reads=GRID.reads | {"energy", "index"},
    caption=caption, check=check, most=2 * GRID.most, notes=("below each rod its energy",),
)  # fmt: skip
