"""Stored datasets opened lazily, after their file (`file_checks`) and what it holds (`checks`) are validated."""

import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray
from xarray.backends import AbstractDataStore, BackendArray, CachingFileManager
from xarray.core import indexing

from solver.problem.errors import InputError

from . import bounds, checks, file_checks, file_kinds
from .file_checks import Contents, FileArray, refusing
from .former_names import dataset_in_current_names
from .stored_study import StoredStudy

# Attributes of many lines, or JSON.
LONG = ("study", "laws", "versions", "recipe", "statistics", "merged", "refined", "sampled", "rows", "branches",
        "remarks", "special_points", "fields")  # fmt: skip


class _Array(BackendArray):
    """An array that is read from its file when its numbers are asked for."""

    def __init__(self, files: CachingFileManager[h5py.File], name: str, stored: FileArray) -> None:
        self.files, self.name, self.shape, self.path = files, name, stored.values.shape, stored.values.file.filename
        self.dtype = np.dtype(object) if _is_text(stored) else stored.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER_1VECTOR, self._read)

    def _read(self, key: Any) -> Any:
        with refusing(self.path), self.files.acquire_context() as file:
            values = file[self.name][key]
        return _texts(values) if self.dtype.kind == "O" else values


class _Store(AbstractDataStore):
    """What a file holds, in the way in which `xr.open_dataset` asks for it."""

    def __init__(self, files: CachingFileManager[h5py.File], held: Contents) -> None:
        self.files, self.held = files, held

    def get_attrs(self) -> dict[str, Any]:
        return {key: _attribute(key, value) for key, value in self.held.attrs.items()}

    def get_variables(self) -> dict[str, xr.Variable]:
        return {name: self._variable(name, stored) for name, stored in self.held.arrays.items()}

    def close(self) -> None:
        self.files.close()

    def _variable(self, name: str, stored: FileArray) -> xr.Variable:
        values = stored.values
        if isinstance(values, h5py.Dataset):
            values = indexing.LazilyIndexedArray(_Array(self.files, name, stored))
        elif _is_text(stored):
            values = _texts(values)
        attrs = {key: _attribute(key, value) for key, value in stored.attrs.items()}
        return xr.Variable(stored.dims, values, attrs, {"dtype": str if _is_text(stored) else stored.dtype})


def _is_text(stored: FileArray) -> bool:
    """Whether it holds texts of any length; others stay bytes."""
    kind = h5py.check_string_dtype(stored.dtype)
    return kind is not None and kind.length is None


def _texts(values: Any) -> NDArray[Any]:
    """The texts of cases or labels, each made printable."""
    texts = [bounds.fit_text(text.decode(errors="replace")) for text in np.ravel(values).tolist()]
    return np.array(texts, dtype=object).reshape(np.shape(values))


def _attribute(key: str, value: Any) -> Any:
    """The value of an attribute, a text made printable; of a list of one value that value."""
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.flat[0]
    if isinstance(value, str):  # h5py keeps bytes that are no UTF-8 in it
        value = value.encode(errors="surrogateescape")
    if not isinstance(value, bytes):
        return value
    text = value.decode(errors="replace")
    return bounds.fit_lines(text) if key in LONG else bounds.fit_text(text, bounds.LINE)


def open_study(path: str | Path, whole: bool = False) -> xr.Dataset:
    """A study's dataset, opened lazily; to be closed after use. whole: arrays along the rod are validated too.

    Raises `InputError` where the file is missing, damaged, of another format, or not a study's dataset.
    """
    return _open(path, True, whole)


def read(path: str | Path, study: bool = True) -> xr.Dataset:
    """A study's dataset (or, where `study` is False, any that the workbench wrote), all in memory.

    Raises `InputError` where the file is missing, damaged, foreign or too large, or holds invalid values.
    """
    with _open(path, is_study=study) as ds:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")  # bytes
        if ds.nbytes > memory:
            held = f"{path} holds {ds.nbytes / 1e9:.3g} GB, more than this machine's memory of {memory / 1e9:.3g} GB"
            raise InputError(f"{held}; open it with xarray.open_dataset and select from it")
        with refusing(path):
            ds.load()
        checks.check(ds, path)
        return ds


def read_stored(path: str | Path, study: bool = True) -> StoredStudy:
    """A file that the workbench wrote, as `read` checks and loads it, as an object that is asked."""
    return StoredStudy(read(path, study))


def kind_of_file(path: str | Path) -> file_kinds.FileKind:
    """The kind of a stored file. Raises `InputError` where it is none."""
    with raw(path) as ds:
        return file_kinds.kind_of(ds)


def raw(path: str | Path, without: Sequence[str] = ()) -> xr.Dataset:
    """The dataset of any file of plain arrays, opened lazily and not validated; to be closed after use.

    No number is read as a time. without: names of variables to leave out; texts are read when a dataset is opened, and
    take more memory than all else. Raises `InputError` where it is no such file.
    """
    return _as_dataset(path, without)[0]


def _open(path: str | Path, is_study: bool, along: bool | None = None) -> xr.Dataset:
    """A dataset, opened lazily, that has not changed since it was stored.

    is_study: whether it must be that of a study. along: as of `checks.check`; default: it is not asked. Raises
    `InputError`.
    """
    ds, held = _as_dataset(path)
    try:
        if is_study:
            checks.check_kind(ds, path)
        with refusing(path):
            file_checks.check_sums(held, path)
        if along is not None:
            checks.check(ds, path, along)
    except BaseException:
        ds.close()
        raise
    return ds


def _as_dataset(path: str | Path, without: Sequence[str] = ()) -> tuple[xr.Dataset, Contents]:
    """The dataset of a file, without these variables, and without its checksums, as a selection that is stored has
    others; what the file holds."""
    file_checks.check_file(Path(path))
    files = CachingFileManager(h5py.File, str(path), mode="r")  # keeps at most 128 files open
    with refusing(path), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of xarray, on files that are refused later
        try:
            with files.acquire_context(needs_lock=False) as file:
                held = file_checks.contents(file, path)
            ds = xr.open_dataset(
                _Store(files, held), cache=False, decode_times=False, mask_and_scale=False, drop_variables=[*without]
            )
        except BaseException:
            files.close()
            raise
    ds.attrs.pop(file_checks.SUMS, None)
    return dataset_in_current_names(ds), held
