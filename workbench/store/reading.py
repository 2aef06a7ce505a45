"""Stored datasets opened lazily, after their file (`file_checks`), layout (`study_checks`) and values are validated."""

import os
import warnings
from pathlib import Path

import h5py
import xarray as xr

from solver.problem.errors import InputError

from . import checksums, file_checks, file_kinds, netcdf, study_checks, value_checks
from .file_checks import open_valid, refusing


def open_study(path: str | Path, whole: bool = False) -> xr.Dataset:
    """A study's dataset, opened lazily; to be closed after use. whole: arrays along the rod are validated too.

    Raises `InputError` where the file is missing, damaged, of another format, or not a study's dataset.
    """
    ds = raw(path)
    try:
        with refusing(path):
            study_checks.check_kind(ds, path)
            study_checks.check(ds, path, study_checks.STUDY)
            check_sums(path)
            if whole:
                study_checks.check(ds, path, [value_checks.curves])
    except InputError:
        ds.close()
        raise
    return ds


def raw(path: str | Path) -> xr.Dataset:
    """Any netCDF4 file of plain arrays, opened lazily; `InputError` where it is not one."""
    with open_valid(path):
        pass
    with refusing(path), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of xarray, on files that are refused below
        ds = netcdf.open_file(path, decode_times=False)
    ds.attrs.pop(checksums.KEY, None)  # a selection that is stored has others
    return ds


def kind_of_file(path: str | Path) -> file_kinds.Kind:
    """The kind of a stored file. Raises `InputError` where it is none."""
    with raw(path) as ds:
        return file_kinds.kind_of(ds)


def check_sums(path: str | Path) -> None:
    """Raise `InputError` where an attribute, a text or a single number is not what was stored."""
    with refusing(path), h5py.File(path, "r") as file:
        checksums.check(file, path)


def read(path: str | Path, study: bool = True) -> xr.Dataset:
    """A study's dataset (or, where `study` is False, any that the workbench wrote), all in memory.

    Raises `InputError` where the file is missing, damaged, foreign or too large, or holds invalid values.
    """
    with open_study(path) if study else raw(path) as ds:
        if ds.nbytes > _memory():
            held = f"{path} holds {ds.nbytes / 1e9:.3g} GB, more than this machine's memory of {_memory() / 1e9:.3g} GB"
            raise InputError(f"{held}; open it with xarray.open_dataset and select from it")
        with file_checks.refusing(path):
            ds.load()
        if not study:
            study_checks.check(ds, path, [value_checks.texts, value_checks.fields])
            check_sums(path)
        if "solved" in ds:
            study_checks.check(ds, path, [value_checks.each, value_checks.curves])
        return ds


def _memory() -> int:
    """The memory of this machine [bytes]."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
