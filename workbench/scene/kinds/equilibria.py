"""The kind equilibria: every equilibrium between two ends, with its index and energy."""

from dataclasses import replace

import xarray as xr

from solver.problem.errors import InputError

from ...data import labels
from ...data.schema import axes_of
from ..cells import Cell
from .grid import KIND as GRID


def check(ds: xr.Dataset) -> None:
    """Raise `InputError` unless the dataset is one of equilibria."""
    if axes_of(ds) != ["equilibrium"]:
        raise InputError("a scene of kind equilibria takes a dataset that `workbench equilibria --out FILE` stored")


def cell(ds: xr.Dataset, names: list[str], where: dict[str, int], why_empty: str) -> Cell:
    """Its number, in a dot that says whether it is stable, and its energy."""
    one, number = ds.isel(where), where["equilibrium"] + 1
    stable = int(one["index"]) == 0
    word = "stable" if stable else f"index {int(one['index'])}"
    energy = labels.value(float(one["energy"]), one["energy"])
    return Cell(f"{word}\n{energy}", why_empty, number=number, stable=stable)


KIND = replace(
    GRID, name="equilibria", description="every equilibrium between two ends", reads=GRID.reads | {"energy", "index"},
    cell=cell, check=check, most=2 * GRID.most,
    notes=("below each rod its energy",),
)  # fmt: skip
