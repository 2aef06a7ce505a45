"""Files of results with one thing altered: by hand, as somebody may think of, and by rule, everything in every way.

A change takes an HDF5 file that is open for writing, of any kind.
"""

import json
from collections.abc import Callable, Iterator
from typing import Any

import h5py
import numpy as np

Change = Callable[[h5py.File], object]

BOMB, COMMANDS = "[" * 1_000_000, "\x1b[2J\x1b]0;title\x07 \x9b31m \u202eabc\u2028"
FORMS = "one\ntwo $\\mathrm{ $\\frac{$ [red]x[/red] {0.__class__}{{7*7}}%s%n __import__('os').abort()"
TEXTS = {"empty": "", "long": "x" * 50_000, "commands of a terminal": COMMANDS, "forms": FORMS}
VALUES = {**TEXTS, "a number": 3.5, "NaN": np.nan, "a list": [1.0, 2.0], "a NUL": np.bytes_(b"a\x00b"),
          "no UTF-8": np.array(b"\xc8\xcf", dtype=h5py.string_dtype()), "nothing": h5py.Empty("f"), "missing": None,
          "a bomb": BOMB}  # fmt: skip
DECODED = {"scale_factor": 1e300, "add_offset": "x", "missing_value": 0.0, "_FillValue": "$", "dtype": "bool",
           "coordinates": "outcome", "units": "days since 2000-01-01"}  # fmt: skip
NUMBERS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, 5e-324)
OTHERS: dict[str, Callable[[Any], Any]] = {
    "an axis more": lambda v: np.stack([v, v]),
    "other sizes": lambda v: np.zeros(7),
    "text": lambda v: np.full(v.shape, b"x"),
    "bytes": lambda v: np.zeros(v.shape, "i1"),
    "half precision": lambda v: np.zeros(v.shape, "f2"),
    "turned": lambda v: v.T,
    "one number": lambda v: v.flat[0],
    "complex numbers": lambda v: np.zeros(v.shape, complex),
}
HDF5S_OWN = {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates"}


def largest(file: h5py.File) -> str:
    """The name of the largest array of numbers."""
    return max(file, key=lambda name: file[name].size if file[name].dtype.kind == "f" else 0)


def put(value: Any, name: str = "") -> Change:
    """Another array, link or nothing in place of an array, by default the largest."""

    def change(file: h5py.File) -> None:
        place = name or largest(file)
        del file[place]
        if value is not None:
            file[place] = value

    return change


def label(key: str, value: Any, name: str = "") -> Change:
    """Another attribute, or none, of an array, by default the largest; of the file itself with the name /."""

    def change(file: h5py.File) -> None:
        attrs = file[name or largest(file)].attrs
        attrs.pop(key, None)
        if value is not None:
            attrs[key] = value

    return change


def number(name: str, value: float, at: int = 0) -> Change:
    """Another number in the first case: the one at a station."""

    def change(file: h5py.File) -> None:
        values = file[name][...].astype(float)
        values[(*[0] * (values.ndim - 1), at)[: values.ndim]] = value
        file[name][...] = values

    return change


def array(name: str, values: Any = None, **settings: Any) -> Change:
    """One more array."""
    return lambda file: file.create_dataset(name, data=values, **settings)


def _virtual(file: h5py.File) -> None:
    source = h5py.VirtualLayout(shape=(2,), dtype=float)
    source[:] = h5py.VirtualSource("/etc/passwd", "x", shape=(2,))
    file.create_virtual_dataset("virtual", source)


def _claim(size: int, chunk: int, stored: bool = False) -> Change:
    """The largest array with so many numbers along its last axis, of which hardly any is stored."""

    def change(file: h5py.File) -> None:
        ones, name = (1,) * (file[largest(file)].ndim - 1), largest(file)
        del file[name]
        new = file.create_dataset(name, (*ones, size), float, chunks=(*ones, chunk), compression="gzip")
        if stored:
            new[(0,) * new.ndim] = 1.0

    return change


def _plug_in(file: h5py.File) -> None:
    plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plist.set_chunk((4,))
    plist.set_filter(400, h5py.h5z.FLAG_OPTIONAL, ())
    h5py.h5d.create(file.id, b"packed", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((4,)), plist)


# Of a file of any kind: each is refused.
STRUCTURES: dict[str, Change] = {
    "a link to another file": put(h5py.ExternalLink("../whole.h5", "/beta")),
    "a link to itself": lambda file: put(h5py.SoftLink(f"/{largest(file)}"))(file),
    "a group in itself": lambda file: file.create_group("group").__setitem__("group", file["group"]),
    "another file's bytes": array("external", shape=(16,), dtype="i1", external=[("/etc/passwd", 0, 16)]),
    "another file's array": _virtual,
    "a filter that needs a plug-in": _plug_in,
    "references": lambda file: file.create_dataset("objects", data=[file.ref], dtype=h5py.ref_dtype),
    "compound numbers": array("compound", np.zeros(3, dtype=[("a", float), ("b", int)])),
    "a terabyte": _claim(21 * 10**10, 10**6),
    "a chunk of 320 MB": _claim(4 * 10**7, 4 * 10**7, stored=True),
    "no values": array("more", shape=(0, 3), dtype=float),
    "a name of commands": array("v\x1b[2J", 1.0),
    "an attribute that is a reference": lambda file: file.attrs.update(place=file.ref),
    "an attribute of compound numbers": label("method", np.zeros(2, dtype=[("a", float)]), "/"),
    "an empty attribute": label("method", h5py.Empty("f"), "/"),
    "checksums that are none": label("checksums", BOMB, "/"),
    "scaled numbers": label("add_offset", "x"),
    "numbers for missing ones": label("_FillValue", 1.0),
}
LAW = {"claim": "c", "observable": "bends", "axis": "x", "direction": "falls", "source": "s"}
# Of a study over E and R: each is refused.
OF_STUDY: dict[str, Change] = {
    **{f"no {name}": put(None, name) for name in ("outcome", "error", "R")},
    "outcomes that are numbers": put(np.zeros((2, 3)), "outcome"),
    "an axis of words": put([b"soft", b"stiff"], "E"),
    "an axis of two dimensions": put(np.zeros((2, 2)), "E"),
    "an axis with NaN": number("E", np.nan),
    "an axis with a value twice": number("E", 2e4),
    "curves of other sizes": put(np.zeros((7, 7)), "beta"),
    "curves of texts": put(np.full((2, 3, 21), b"x"), "beta"),
    "another unit": label("units", "Pa", "E"),
    **{f"no @{key}": label(key, None, "/") for key in ("laws", "study", "tolerance")},
    "laws that are code": label("laws", "__import__('os').abort()", "/"),
    "laws without end": label("laws", BOMB, "/"),
    "a law about no axis": label("laws", json.dumps([LAW]), "/"),
    "a list for a text": label("length_unit", ["cm", "N"], "/"),
    "a tolerance of NaN": label("tolerance", np.nan, "/"),
    "a newer format": label("format", 99, "/"),
    "an older format": label("format", 1, "/"),
    "a format in words": label("format", "new", "/"),
    **{f"{name} {value:g}": number(name, value, at) for name, value, at in (
        ("z", np.nan, 10), ("z", 1000.0, 10), ("beta", 1e200, 3), ("bends", -1, 0), ("attached", 7, 0), ("rho", 0.0, 0),
        ("rho", 17.0, 0), ("FZ", np.nan, 0), ("M3", 1e300, 0), ("s", -1.0, 0), ("u", 0.5, 0), ("error", np.nan, 0),
        ("kappa_max", 1e300, 0))},
}  # fmt: skip


def by_rule(file: h5py.File) -> Iterator[tuple[str, Change]]:
    """The name and the change of every altered file that is made of this one."""
    for name in file:
        if file[name].dtype.kind in "iuf":
            yield from ((f"{name} all {value:g}", _fill(name, value)) for value in NUMBERS)
            yield from ((f"{name} first {value:g}", number(name, value)) for value in NUMBERS)
            yield from ((f"{name} {what}", _alter(name, other)) for what, other in OTHERS.items())
        else:
            yield from ((f"{name} all {what}", _fill(name, text)) for what, text in TEXTS.items())
        yield f"{name} missing", put(None, name)
    for name in ("/", *file):
        for key in [key for key in file[name].attrs if key not in HDF5S_OWN]:
            yield from ((f"{name} @{key} {what}", label(key, value, name)) for what, value in VALUES.items())
        yield from (
            (f"{name} @{key} {value}", label(key, value, name)) for key, value in DECODED.items() if name != "/"
        )


def _fill(name: str, value: Any) -> Change:
    def change(file: h5py.File) -> None:
        kind = file[name].dtype.kind
        file[name][...] = (
            np.nan_to_num(value, posinf=2**31, neginf=-(2**31)).clip(-100, 2**62) if kind in "iu" else value
        )

    return change


def _alter(name: str, other: Callable[[Any], Any]) -> Change:
    """Another array under the same labels, which bears no dimensions where it has others."""

    def change(file: h5py.File) -> None:
        attrs, values = dict(file[name].attrs), other(file[name][...])
        keep = {
            key: value for key, value in attrs.items() if key not in HDF5S_OWN or np.ndim(values) == file[name].ndim
        }
        del file[name]
        file[name] = values
        for key, value in keep.items():
            file[name].attrs[key] = value

    return change
