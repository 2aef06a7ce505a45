"""The rods along one axis of a dataset: what a time series for ParaView and numbered files are made of."""

from dataclasses import dataclass

import xarray as xr

from solver.problem.errors import InputError, choices

from ..data import schema, selection
from ..geometry import stored_line
from .base import Options, Rod


@dataclass(frozen=True, eq=False)
class Series:
    """The solved rods along an axis and their values there; skipped: how many cases have no shape."""

    name: str
    axis: str
    values: list[float]
    rods: list[Rod]
    skipped: int

    @property
    def at(self) -> dict[str, float]:
        """The values of the other axes."""
        ds, where = self.rods[0].ds, self.rods[0].where
        return {name: float(ds[name].values[i]) for name, i in where.items() if name != self.axis}


def along(ds: xr.Dataset, name: str, options: Options) -> Series:
    """The rods along the one axis that the options do not name. name: of the file, without its ending.

    Raises `InputError` where no axis or more than one remains, or no case along it is solved.
    """
    named = {selection.axis_of(ds, key) for key in options.at}
    free = [axis for axis in schema.axes_of(ds) if axis not in named]
    free = [axis for axis in free if ds.sizes[axis] > 1] or free
    if len(free) != 1:
        said = f"the axes {choices(free)} remain: name all but one with --at" if free else "no axis remains"
        raise InputError(f"these files go along one axis, and {said}")
    (axis,) = free
    cases = selection.line(ds, axis, options.at)
    rods = []
    for case in cases:
        if ds["solved"].isel(case):
            title = f"{ds.attrs['study_name']} {axis}={float(ds[axis][case[axis]]):.6g}"
            rods.append(Rod(ds, case, stored_line.read(ds, case), title, options))
    if not rods:
        raise InputError(f"no case along {axis} is solved: there is nothing to export")
    values = [float(ds[axis][rod.where[axis]]) for rod in rods]
    return Series(name, axis, values, rods, len(cases) - len(rods))
