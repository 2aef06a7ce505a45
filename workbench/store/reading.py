"""Stored datasets opened lazily, after their file (`file_checks`) and what it holds (`checks`) are validated."""

import os
import warnings
from pathlib import Path

import h5py
import xarray as xr

from solver.problem.errors import InputError

from . import checks, file_checks, schema, writing
from .file_checks import open_valid, refusing


def open_study(path: str | Path, whole: bool = False) -> xr.Dataset:
    """A study's dataset, opened lazily; to be closed after use. whole: arrays along the rod are validated too.

    Raises `InputError` where the file is missing, damaged, of another format, or not a study's dataset.
    """
    ds = raw(path)
    try:
        with refusing(path):
            checks.check_kind(ds, path)
            checks.check(ds, path, checks.STUDY)
            _check_sums(path)
            if whole:
                checks.check(ds, path, [checks.curves])
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
        ds = writing.open_file(path)
    ds.attrs.pop(file_checks.SUMS, None)  # a selection that is stored has others
    return ds


def kind_of_file(path: str | Path) -> schema.Kind:
    """The kind of a stored file. Raises `InputError` where it is none."""
    with raw(path) as ds:
        return schema.kind_of(ds)


def _check_sums(path: str | Path) -> None:
    """Raise `InputError` where an attribute, a text or a single number is not what was stored."""
    with refusing(path), h5py.File(path, "r") as file:
        file_checks.check_sums(file, path)


def read(path: str | Path, study: bool = True) -> xr.Dataset:
    """A study's dataset (or, where `study` is False, any that the workbench wrote), all in memory.

    Raises `InputError` where the file is missing, damaged, foreign or too large, or holds invalid values.
    """
    with open_study(path) if study else raw(path) as ds:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")  # bytes
        if ds.nbytes > memory:
            held = f"{path} holds {ds.nbytes / 1e9:.3g} GB, more than this machine's memory of {memory / 1e9:.3g} GB"
            raise InputError(f"{held}; open it with xarray.open_dataset and select from it")
        with refusing(path):
            ds.load()
        if study:
            checks.check(ds, path, [checks.curves])  # the others have been asked when it was opened
        else:
            checks.check_any(ds, path)
            _check_sums(path)
        return ds
