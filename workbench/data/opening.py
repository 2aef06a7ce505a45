"""Datasets in netCDF4 files, opened and written such that HDF5 looks up each array of the file once.

h5netcdf looks an array up anew for each of its properties, some forty times, which was half of the time to open or to
write a file of few cases.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import xarray as xr


class _File(h5py.File):  # type: ignore[misc]  # h5py has no types
    """An HDF5 file that keeps the arrays that were looked up in it."""

    def __init__(self, path: str | Path, mode: str) -> None:
        super().__init__(path, mode, track_order=mode == "w" or None)  # netCDF4 needs the order of creation
        self._found: dict[str, Any] = {}

    def __getitem__(self, name: Any) -> Any:
        if not isinstance(name, str):
            return super().__getitem__(name)
        if name == "/":
            return self
        if name not in self._found:
            self._found[name] = super().__getitem__(name)
        return self._found[name]

    def __delitem__(self, name: Any) -> None:
        self._found.clear()
        super().__delitem__(name)


def opened(path: str | Path) -> xr.Dataset:
    """The dataset of a netCDF4 file, lazily; to be closed after use. Raises what h5py, h5netcdf and xarray raise."""
    file = _File(path, "r")
    try:
        root = h5netcdf.File(file, "r", phony_dims="access", decode_vlen_strings=True)
        ds = xr.open_dataset(xr.backends.H5NetCDFStore(root), cache=False, decode_times=False)
    except BaseException:
        file.close()
        raise

    def close() -> None:
        root.close()
        file.close()

    ds.set_close(close)
    return ds


def write(ds: xr.Dataset, path: str | Path, encoding: Mapping[Any, Mapping[str, Any]]) -> None:
    """Write a dataset to a new netCDF4 file. Raises what h5py, h5netcdf and xarray raise."""
    with _File(path, "w") as file, h5netcdf.File(file, "w") as root:
        ds.dump_to_store(xr.backends.H5NetCDFStore(root, mode="w"), encoding=encoding)
