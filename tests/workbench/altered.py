"""Changes of a stored file: by hand, as somebody may think of, and by rule, everything in every way; cuts and flips.

A change is a place and a value. ``E`` is an array, ``*`` the largest one, ``E@units`` an attribute of it, ``@laws`` one
of the file, ``E[3]`` the number at station 3 of the first case, "" the file. The value None removes, a function makes
another value of the one that is there.
"""

import json
import re
from collections.abc import Iterator
from random import Random
from typing import Any

import h5py
import numpy as np

Change = tuple[str, Any]

BOMB, COMMANDS = "[" * 1_000_000, "\x1b[2J\x1b]0;title\x07 \x9b31m \u202eabc\u2028"
FORMS = "one\ntwo $\\mathrm{ $\\frac{$ [red]x[/red] {0.__class__}{{7*7}}%s%n __import__('os').abort()"
TEXTS = ("", "x" * 50_000, COMMANDS, FORMS)
OF_BYTES = (np.bytes_(b"a\x00b"), np.array(b"\xc8\xcf", dtype=h5py.string_dtype()))
ATTRIBUTES = (*TEXTS, *OF_BYTES, 3.5, np.nan, [1.0, 2.0], h5py.Empty("f"), None, BOMB)
DECODED = {"scale_factor": 1e300, "add_offset": "x", "missing_value": 0.0, "_FillValue": "$", "dtype": "bool",
           "coordinates": "outcome", "units": "days since 2000-01-01"}  # fmt: skip
NUMBERS = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, 5e-324)
OTHERS = (
    lambda v: np.stack([v, v]),
    lambda v: np.zeros(7),
    lambda v: np.full(v.shape, b"x"),
    lambda v: np.zeros(v.shape, "i1"),
    lambda v: np.zeros(v.shape, "f2"),
    lambda v: np.zeros(v.shape, complex),
    lambda v: v.T,
    lambda v: v.flat[0],
)
HDF5S_OWN = {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_Netcdf4Coordinates"}


def make(file: h5py.File, place: str, value: Any) -> None:
    """Make one change in a file that is open for writing."""
    largest = max(file, key=lambda name: file[name].size if file[name].dtype.kind == "f" else 0)
    name, at, key = re.fullmatch(r"([^@[]*)(?:\[(\d+)\]|@(.*))?", place.replace("*", largest), re.DOTALL).groups()
    if key is not None:
        attrs = file[name or "/"].attrs
        attrs.pop(key, None)
        if value is not None:
            attrs[key] = value
    elif not name:
        value(file)
    elif at is not None:
        values = file[name][...]
        fit = np.nan_to_num(value).clip(-100, 2**31) if values.dtype.kind in "iu" else value
        values[(*[0] * (values.ndim - 1), int(at))[: values.ndim]] = fit
        file[name][...] = values
    else:
        attrs, values = dict(file[name].attrs), value(file[name][...]) if callable(value) else value
        same = values is not None and np.shape(values) == file[name].shape
        del file[name]
        if value is not None:
            file[name] = values
        for key in attrs if callable(value) else ():
            if same or key not in HDF5S_OWN:
                file[name].attrs[key] = attrs[key]


def _virtual(file: h5py.File) -> None:
    source = h5py.VirtualLayout(shape=(2,), dtype=float)
    source[:] = h5py.VirtualSource("/etc/passwd", "x", shape=(2,))
    file.create_virtual_dataset("virtual", source)


def _plug_in(file: h5py.File) -> None:
    plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    plist.set_chunk((4,))
    plist.set_filter(400, h5py.h5z.FLAG_OPTIONAL, ())
    h5py.h5d.create(file.id, b"packed", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((4,)), plist)


def _chunk(file: h5py.File) -> None:
    file.create_dataset("chunk", (40_000_000,), float, chunks=(40_000_000,), compression="gzip")[0] = 1.0


# Of a file of any kind: each is refused.
STRUCTURES: tuple[Change, ...] = (
    ("*", h5py.ExternalLink("../whole.h5", "/beta")),
    ("*", h5py.SoftLink("/u")),
    ("", lambda file: file.create_group("group").__setitem__("group", file["group"])),
    ("", lambda file: file.create_dataset("external", (16,), "i1", external=[("/etc/passwd", 0, 16)])),
    ("", _virtual),
    ("", _plug_in),
    ("", lambda file: file.create_dataset("objects", data=[file.ref], dtype=h5py.ref_dtype)),
    ("", lambda file: file.create_dataset("compound", data=np.zeros(3, dtype=[("a", float), ("b", int)]))),
    ("", lambda file: file.create_dataset("claim", (21 * 10**10,), float, chunks=(10**6,), compression="gzip")),
    ("", _chunk),
    ("", lambda file: file.create_dataset("more", (0, 3), float)),
    ("", lambda file: file.create_dataset("v\x1b[2J", data=1.0)),
    ("", lambda file: file.attrs.update(place=file.ref)),
    ("@method", np.zeros(2, dtype=[("a", float)])),
    ("@method", h5py.Empty("f")),
    ("@checksums", BOMB),
    ("*@add_offset", "x"),
    ("*@_FillValue", 1.0),
)
LAW = {"claim": "c", "observable": "bends", "axis": "x", "direction": "falls", "source": "s"}
# Of a study over E and R: each is refused.
OF_STUDY: tuple[Change, ...] = (
    *((place, None) for place in ("outcome", "error", "R", "@laws", "@study", "@tolerance")),
    ("outcome", np.zeros((2, 3))), ("E", [b"soft", b"stiff"]), ("E", np.zeros((2, 2))), ("beta", np.zeros((7, 7))),
    ("beta", np.full((2, 3, 21), b"x")), ("E@units", "Pa"), ("@laws", "__import__('os').abort()"), ("@laws", BOMB),
    ("@laws", json.dumps([LAW])), ("@length_unit", ["cm", "N"]), ("@tolerance", np.nan), ("@format", 99),
    ("@format", "new"), ("E[0]", np.nan), ("E[0]", 2e4), ("z[10]", np.nan), ("z[10]", 1000.0), ("beta[3]", 1e200),
    ("bends[0]", -1), ("attached[0]", 7), ("rho[0]", 0.0), ("FZ[0]", np.nan), ("M3[0]", 1e300),
    ("s[0]", -1.0), ("u[0]", 0.5), ("error[0]", np.nan), ("kappa_max[0]", 1e300), ("kappa_max[0]", np.inf),
    ("R[0]", 0.6), ("a[0]", 0.1), ("alpha[10]", 1000.0), ("@side", "nonsense"), ("@format", 1),
)  # fmt: skip


def by_rule(file: h5py.File) -> Iterator[Change]:
    """Every change of this file: all its numbers, texts, arrays and attributes."""
    for name in file:
        if file[name].dtype.kind in "iuf":
            yield from ((f"{name}[0]", value) for value in NUMBERS)
            yield from ((name, lambda v, value=value: np.full(v.shape, value)) for value in NUMBERS)
            yield from ((name, other) for other in OTHERS)
        else:
            yield from ((name, lambda v, text=text: np.full(v.shape, text, dtype=object)) for text in TEXTS)
        yield name, None
    for name in ("", *file):
        for key in (key for key in file[name or "/"].attrs if key not in HDF5S_OWN):
            yield from ((f"{name}@{key}", value) for value in ATTRIBUTES)
        yield from ((f"{name}@{key}", value) for key, value in DECODED.items() if name)


def damage(whole: bytes, random: Random) -> bytes:
    """A file that is cut short, or has some bytes changed, a few or a stretch of them."""
    content, at = bytearray(whole), random.randrange(len(whole))
    if random.random() < 0.2:
        return whole[:at]
    for k in range(random.choice([1, 1, 8, 512])):
        content[(at + k) % len(whole)] = random.randrange(256)
    return bytes(content)
