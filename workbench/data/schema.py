"""The schema of a stored study: its format, names, dimensions, labels and packing. Needs no xarray."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.quantities import quantity, unit_of

if TYPE_CHECKING:
    import xarray as xr

    from studies import Study

FORMAT = 1  # of the file; one with a higher number is refused

Columns = dict[str, NDArray[Any]]  # name -> (cases, ...), as named in `Solution` and `OBSERVABLES`

LOADS = ("FZ", "MZ", "M3")
TEXTS = ("outcome", "caution")  # of each case
COMPONENTS = {"xyz": ("x", "y", "z"), "director": ("d1", "d2", "d3")}
INNER = {"position": ("xyz",)}  # dimensions after u, of an output that is not one number at each station
PACKED: Mapping[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def inner_shape(output: str) -> tuple[int, ...]:
    """How many numbers an output has at each station, as a shape: () for one."""
    return tuple(len(COMPONENTS[dim]) for dim in INNER.get(output, ()))


def packing(ndim: int, dtype: "np.dtype[Any]") -> dict[str, Any]:
    """How an array is compressed in the file; scalars and text are not."""
    return dict(PACKED) if ndim and dtype.kind in "biuf" else {}


def axes_of(ds: "xr.Dataset") -> list[str]:
    """The names of the study's axes, in order."""
    return [str(dim) for dim in ds["outcome"].dims]


def remaining_axes(ds: "xr.Dataset", study: "Study") -> list[str]:
    """The study's axes that the dataset still has; an axis on which one value was selected is gone."""
    return [name for name in study.axes if name in ds.dims]


def along(ds: "xr.Dataset", name: str) -> "xr.DataArray":
    """An output along the rod, whether or not an axis has taken its name."""
    return ds[f"{name}_along"] if f"{name}_along" in ds else ds[name]


def labels(name: str, units: Mapping[str, str]) -> dict[str, str]:
    """The attributes of a variable of that quantity: units, long_name, symbol."""
    row = quantity(name)
    return {"units": unit_of(name, units), "long_name": row.long_name, "symbol": row.symbol}
