"""Stored studies with one thing altered: every variable and every attribute, each in a dozen ways, by rule."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

Change = Callable[[Path], None]

LONG = "x" * 50_000
TEXTS: dict[str, Any] = {
    "empty": "",
    "very long": LONG,
    "mathtext": "$\\mathrm{",
    "mathtext closed": "$\\frac{$ $\\nothing$",
    "a terminal's command": "\x1b[2J\x1b]0;title\x07",
    "a terminal's command of one byte": "\x9b31m",
    "a new line": "one\ntwo",
    "a carriage return": "one\rtwo",
    "text from right to left": "\u202eabc\u2066",
    "a line separator": "a\u2028b",
    "markup": "[red]x[/red][/nothing]",
    "a template": "{0.__class__}{{7*7}}%s%n",
}
OTHERS: dict[str, Any] = {
    "a number": 3.5,
    "NaN": np.nan,
    "a list": np.array([1.0, 2.0]),
    "a NUL": np.bytes_(b"a\x00b"),
    "no text in UTF-8": np.array(b"\xc8\xcf", dtype=h5py.string_dtype()),
    "nothing": h5py.Empty("f"),
    "missing": None,
}
DECODED: dict[str, Any] = {
    "scale_factor": 1e300, "add_offset": "x", "missing_value": 0.0, "units": "days since 2000-01-01",
    "coordinates": "outcome", "dtype": "bool",
}  # fmt: skip
# Of the attributes of a variable these alone: there are many.
LABELS = ("empty", "very long", "mathtext", "a terminal's command", "a new line", "a number", "a NUL", "missing")
HDF5S_OWN = ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates",
             "_NCProperties", "_nc3_strict")  # fmt: skip


def alterations(path: Path) -> Iterator[tuple[str, str, Change]]:
    """Place, way and change of every altered file that is made of the one at `path`."""
    with xr.open_dataset(path, engine="h5netcdf") as ds:
        variables = {str(name): (variable.dtype.kind, variable.ndim) for name, variable in ds.variables.items()}
    with h5py.File(path) as file:
        own = [key for key in file.attrs if key not in HDF5S_OWN]
        theirs = {name: [key for key in file[name].attrs if key not in HDF5S_OWN] for name in file}
    for name, (kind, ndim) in variables.items():
        for what, change in (_numbers() if kind in "biuf" else _words()).items():
            yield name, what, _in_place(name, change)
        for what, made in _structures(ndim).items():
            yield name, what, _rewritten(name, made)
    for where, keys in {"": own, **theirs}.items():
        for key in keys:
            for what, value in {**TEXTS, **OTHERS}.items():
                if where and what not in LABELS:
                    continue
                yield f"{where} @{key}", what, _attribute(where, key, value)
        if where:
            for key, value in DECODED.items():
                yield f"{where} @{key}", "that is decoded", _attribute(where, key, value)


def _numbers() -> dict[str, Callable[[Any], Any]]:
    def first(value: float) -> Callable[[Any], Any]:
        def change(values: Any) -> Any:
            values = values.copy()
            values[(0,) * values.ndim] = value
            return values

        return change

    return {
        "all NaN": lambda v: np.full_like(v, np.nan),
        "all inf": lambda v: np.full_like(v, np.inf),
        "all -inf": lambda v: np.full_like(v, -np.inf),
        "all 0": np.zeros_like,
        "negative": lambda v: -np.abs(v) - 1,
        "huge": lambda v: np.full_like(v, 1e300),
        "tiny": lambda v: np.full_like(v, 5e-324),
        "one NaN": first(np.nan),
        "one inf": first(np.inf),
        "one huge": first(1e300),
        "reversed": lambda v: v[::-1] if v.ndim == 1 else v[..., ::-1] if v.ndim else v * 2,
    }


def _words() -> dict[str, Callable[[Any], Any]]:
    return {f"all {what}": lambda v, text=text: np.full(v.shape, text, dtype=object) for what, text in TEXTS.items()}


def _structures(ndim: int) -> dict[str, Callable[[xr.Variable], xr.Variable | None]]:
    found: dict[str, Callable[[xr.Variable], xr.Variable | None]] = {
        "missing": lambda v: None,
        "of another shape": lambda v: xr.Variable(("other",), np.zeros(7) if v.dtype.kind in "iuf" else ["a"] * 7),
        "of text": lambda v: xr.Variable(v.dims, np.full(v.shape, "text")),
        "of bytes": lambda v: xr.Variable(v.dims, np.zeros(v.shape, dtype="i1")),
        "of single precision": lambda v: xr.Variable(v.dims, np.zeros(v.shape, dtype="f4")),
        "with a dimension more": lambda v: v.set_dims({"other": 3, **dict(zip(v.dims, v.shape, strict=True))}),
    }
    if ndim:
        found["of one value"] = lambda v: xr.Variable((), v.values.ravel()[0], v.attrs)
    if ndim > 1:
        found["transposed"] = lambda v: v.transpose()
    return found


def _in_place(name: str, change: Callable[[Any], Any]) -> Change:
    def work(path: Path) -> None:
        with h5py.File(path, "a") as file, np.errstate(all="ignore"):
            values = file[name][...]
            if values.dtype.kind in "iu":
                values = change(values.astype(float))
                values = np.nan_to_num(values, nan=-1, posinf=2**31, neginf=-(2**31)).clip(-(2**62), 2**62)
            else:
                values = change(values)
            file[name][...] = values

    return work


def _rewritten(name: str, make: Callable[[xr.Variable], xr.Variable | None]) -> Change:
    """The whole file written again with another variable; dimensions that no longer fit lose their names."""

    def work(path: Path) -> None:
        with h5py.File(path, "a") as file:
            old = file[name]
            dims = [dim[0].name.strip("/") if len(dim) else f"own {i}" for i, dim in enumerate(old.dims)]
            made = make(xr.Variable(dims, old[...], dict.fromkeys(())))
            attrs = {key: value for key, value in old.attrs.items() if key not in HDF5S_OWN}
            scales = [other for other in file if other != name and any(_scaled(dim, old) for dim in file[other].dims)]
            del file[name]
            if made is None:
                return
            values = made.values
            kind = h5py.string_dtype() if values.dtype.kind in "UO" else values.dtype
            new = file.create_dataset(name, data=values.astype(object) if values.dtype.kind in "UO" else values,
                                      dtype=kind)  # fmt: skip
            for key, value in attrs.items():
                new.attrs[key] = value
            if dims == [name] and made.ndim == 1 and made.dims == (name,):
                new.make_scale(name)
                for other in scales:
                    _scale_again(file[other], name, new)
            else:
                for i, dim in enumerate(made.dims):
                    if dim in file and file[dim].is_scale:
                        new.dims[i].attach_scale(file[dim])

    return work


def _scaled(dim: Any, scale: Any) -> bool:
    return any(dim[i] == scale for i in range(len(dim)))


def _scale_again(other: Any, name: str, new: Any) -> None:
    for dim, size in zip(other.dims, other.shape, strict=True):
        if not any(True for i in range(len(dim)) if dim[i]) and size == new.shape[0]:
            dim.attach_scale(new)


def _attribute(where: str, key: str, value: Any) -> Change:
    def work(path: Path) -> None:
        with h5py.File(path, "a") as file:
            at = file[where] if where else file
            at.attrs.pop(key, None)
            if value is not None:
                at.attrs[key] = value

    return work
