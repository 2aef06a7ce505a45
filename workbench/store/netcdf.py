"""netCDF4 files opened and written by xarray in half the time: each array is looked up in HDF5 once."""

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import xarray as xr
from xarray.backends import CachingFileManager, H5NetCDFStore


class _Arrays(h5py.File):  # type: ignore[misc]
    """An HDF5 file that remembers its arrays: h5netcdf asks for each about fifty times."""

    def __init__(self, path: str | BytesIO, mode: str) -> None:
        super().__init__(path, mode, **({} if mode == "r" else {"track_order": True}))  # as h5netcdf wants it
        self._found: dict[str, Any] = {}

    def __getitem__(self, name: Any) -> Any:
        if not isinstance(name, str):
            return super().__getitem__(name)  # a reference
        if name == "/":
            return self
        if name not in self._found:
            self._found[name] = super().__getitem__(name)
        return self._found[name]

    def __delitem__(self, name: str) -> None:
        super().__delitem__(name)
        self._found.clear()


class File(h5netcdf.File):  # type: ignore[misc]
    """Such a file as netCDF; it is closed with its arrays."""

    def __init__(self, arrays: _Arrays, mode: str, **options: Any) -> None:
        self._arrays = arrays
        super().__init__(arrays, mode, **options)

    def close(self) -> None:
        super().close()
        self._arrays.close()


def file(path: str | Path | BytesIO, mode: str, **options: Any) -> File:
    """A netCDF4 file: "r" is read, "a" gets more variables, "w" is new."""
    return File(_Arrays(path if isinstance(path, BytesIO) else str(path), mode), mode, **options)


def open_file(path: str | Path, **options: Any) -> xr.Dataset:
    """The dataset of a netCDF4 file, opened lazily; to be closed after use.

    options: keywords of `xarray.open_dataset`. Arrays without names for their dimensions get some.
    """
    keywords = {"decode_vlen_strings": True, "phony_dims": "access"}
    manager = CachingFileManager(file, str(path), mode="r", kwargs=keywords)  # keeps at most 128 files open
    return xr.open_dataset(H5NetCDFStore(manager, mode="r"), cache=False, **options)


def write(ds: xr.Dataset, path: str | Path | BytesIO, encoding: Mapping[str, Mapping[str, Any]]) -> None:
    """Write a dataset to a new file, as `Dataset.to_netcdf` does. encoding: how each variable is packed.

    How a file was packed that it was read from does not count: a longer text would be cut to the length of that file.
    """
    with file(path, "w") as target:
        ds.drop_encoding().dump_to_store(H5NetCDFStore(target, mode="w"), encoding=encoding)
