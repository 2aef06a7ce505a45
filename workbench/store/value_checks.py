"""Validate the texts and numbers of a stored dataset before they are used.

`reading` calls `texts`, `fields` and `each` for every file; they read no array along the rod. `curves` does, block by
block: for a dataset that is read whole, for its summary and for its check. All raise `InputError` with the file and
the variable, and change nothing.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.observe.observables import OBSERVABLES
from solver.problem.case import SIDES, SLIDING
from solver.problem.errors import InputError, choices
from solver.problem.rod import DIRECT, ELASTIC, GIVEN
from studies.grammar.axes import LONGEST_LINE
from studies.grammar.units import FORCES, LENGTHS

from ..words import escaping
from . import schema
from .file_checks import show
from .grid_io import pieces
from .schema import CURVES, JUDGED, LOADS, SECTION, TEXTS

LINE, LABEL = LONGEST_LINE, 1000  # characters of an attribute of the file, and of a variable
LONG = ("study", "laws", "versions", "recipe", "statistics", "branches", "rows")  # of many lines, or JSON; not printed
BLOCK = 100_000  # cases that are read at a time
BLOCK_ALONG = 2**20  # stations of their curves
COUNTED = ("held_index", "branch")  # whole numbers of each case that are no observables
LABELS = ("units", "long_name", "symbol", "reading")
WORDS: Mapping[str, Any] = {
    "side": SIDES,
    "sliding": SLIDING,
    "stiffness": schema.SECTIONS,
    "length_unit": LENGTHS,
    "force_unit": FORCES,
}
POSITIVE = ("E", "EI", "GJ", "a", "R", "L", "rho")
LIMITS = {"nu": (np.nextafter(-1.0, 0.0), 0.5), "inner_radius": (0.0, 1e50),
          "weight": (0.0, 1e50), "friction": (0.0, 1e50), "inclination": (0.0, 3.1415926535897936)}  # fmt: skip
# Of fields in their own units, and of dimensionless loads and lengths: beyond, squares and fourth powers overflow.
SMALLEST, LARGEST, MOST = 1e-50, 1e50, 1e30
MOST_ANGLE = 1e12  # rad: beyond, a float cannot hold the direction to 1e-4
SAME = 1e-9  # relative, between a stored number and what it follows from
STRAIGHT = 1e-6  # share of the arc by which its chord may exceed it: rounding and the error of the method


def texts(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless every text is printable and every word is one of its choices."""
    for key, value in ds.attrs.items():
        longest = None if key in LONG else LINE
        _text(str(key), LABEL, f"{path}: the name of an attribute")
        if isinstance(value, str):
            _text(value, longest, f"{path}: the attribute {key}")
    for key, known in WORDS.items():
        if key in ds.attrs and ds.attrs[key] not in (*known,):
            raise InputError(f"{path}: the attribute {key} is {show(ds.attrs[key])}; it can be {choices(known)}")
    for name, variable in ds.variables.items():
        _text(str(name), LABEL, f"{path}: the name of a variable")
        for key, value in variable.attrs.items():
            what = f"{path}: the attribute {show(key)} of {show(name)}"
            if isinstance(value, str):
                _text(value, LABEL, what)
            elif key in LABELS:
                raise InputError(f"{what} is not text")


def _text(text: str, longest: int | None, what: str) -> None:
    """Raise `InputError` unless it is a line of at most so many characters; None: lines without control characters."""
    try:
        text.encode()
    except UnicodeEncodeError:
        raise InputError(f"{what} is not UTF-8 text: {show(text)}") from None
    if longest is None:
        if any(ord(one) < 32 and one not in "\n\r\t" for one in text) or any("\x7f" <= one <= "\x9f" for one in text):
            raise InputError(f"{what} holds control characters")
    elif not escaping.is_line(text, longest):
        raise InputError(f"{what} must be one line of text, got {show(text)}")


def fields(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless rod, cylinder and stations are finite, positive, in order and consistent."""
    number = {name: ds[name] for name in (*POSITIVE, *LIMITS) if name in ds.variables}
    for name, variable in number.items():
        if variable.dtype.kind != "f":
            raise InputError(f"{path}: {name} must be a floating-point number, got {variable.dtype}")
        values = variable.values.astype(float)
        if not np.isfinite(values).all():
            raise InputError(f"{path}: {name} must be finite, got {_worst(values, np.isfinite(values))}")
        low, high = LIMITS.get(name, (SMALLEST, LARGEST))
        good = (values >= low) & (values <= high)
        if not good.all():
            raise InputError(f"{path}: {name} must be from {low:g} to {high:g}, got {_worst(values, good)}")
    _section(ds, number, path)
    if {"R", "a", "rho"} <= set(number) and ds.attrs.get("side") in SIDES:
        expected = number["R"] + SIDES[ds.attrs["side"]] * number["a"]
        if bool((np.abs(number["rho"] - expected) > SAME * (number["R"] + number["a"])).any()):
            raise InputError(f"{path}: rho is not R {'+-'[ds.attrs['side'] == 'inside']} a")
    if {"L", "rho"} <= set(number) and not bool((number["L"] / number["rho"] < MOST).all()):
        raise InputError(f"{path}: L is more than {MOST:g} times rho")
    _places(ds, number.get("L"), path)


def _section(ds: xr.Dataset, number: Mapping[str, xr.DataArray], path: str | Path) -> None:
    """Raise `InputError` unless the fields of the section fit the attribute stiffness, and a tube has a wall."""
    word = ds.attrs.get("stiffness")
    allowed = DIRECT if word == GIVEN else (*ELASTIC, *(["inner_radius"] if word == "solid" else []))
    for name in SECTION:
        if name in number and name not in allowed:
            raise InputError(f"{path}: the attribute stiffness is {show(word)}, which excludes {name}")
    if {"inner_radius", "a"} <= set(number) and not bool((number["inner_radius"] < number["a"]).all()):
        raise InputError(f"{path}: inner_radius is not less than a")


def _places(ds: xr.Dataset, L: xr.DataArray | None, path: str | Path) -> None:
    """Raise `InputError` unless u rises from 0 to 1 and s is u L."""
    if "u" not in ds.variables or ds["u"].dims != ("u",):
        return
    u = ds["u"].values
    if u.dtype.kind != "f" or not np.isfinite(u).all() or u.min() < 0 or u.max() > 1 or not (np.diff(u) > 0).all():
        raise InputError(f"{path}: u must rise from 0 to 1")
    along = [str(name) for name, one in ds.data_vars.items() if name in CURVES and "u" in one.dims]
    if "s" not in ds.variables and along:
        raise InputError(f"{path}: {along[0]} is an array along the rod, but s is missing")
    if "s" not in ds.variables or L is None:
        return
    expected = L * ds["u"]
    missing = {*expected.dims} - {*ds["s"].dims}  # an axis of one value is none of a field's
    fits = {*ds["s"].dims} <= {*expected.dims} and all(expected.sizes[dim] == 1 for dim in missing)
    if not fits or not bool((np.abs(ds["s"] - expected) <= SAME * L).all()):
        raise InputError(f"{path}: s must be u L")


def each(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless the texts, errors, loads and observables of each case are valid, block by block."""
    for name in (*JUDGED, *LOADS):
        if name in ds.variables and ds[name].dtype.kind not in "iuf":
            raise InputError(f"{path}: {name} must hold numbers, got {ds[name].dtype}")
    sizes = (*schema.stiffness_fields(ds), "rho", "L")
    dims = ds["outcome"].dims
    numbers = [str(name) for name, one in ds.data_vars.items() if one.dims == dims and one.dtype.kind in "iuf"]
    names = [name for name in dict.fromkeys(("solved", *TEXTS, *numbers, *LOADS, *sizes)) if name in ds.variables]
    for block in pieces(ds, names, BLOCK):
        _check_words(block, path)
        _check_numbers(block, numbers, path)
        _check_loads(block, path)


def _check_words(ds: xr.Dataset, path: str | Path) -> None:
    for name in TEXTS:
        if name in ds.data_vars:
            for text in set(ds[name].values.ravel().tolist()):
                _text(str(text), LABEL, f"{path}: one of {name}")


def _check_numbers(ds: xr.Dataset, names: Iterable[str], path: str | Path) -> None:
    """Raise `InputError` for a number that no solved case can have; NaN says that it is not known."""
    solved = ds["solved"].values
    length = _over(ds["L"], ds).values[solved] * (1 + STRAIGHT) if "L" in ds.variables else np.inf
    for name in names:
        values = ds[name].values[solved]
        if name in JUDGED and not (values >= 0).all():
            raise InputError(f"{path}: {name} of a solved case must be a number and not negative")
        counted = name in COUNTED or schema.is_count(ds[name])
        row = OBSERVABLES.get(name)
        least = 0.0 if counted or name.endswith("_error") else -np.inf if row is None else row.least
        most = np.inf if row is None else length if row.most == "L" else float(row.most) * (1 + SAME)
        with np.errstate(invalid="ignore"):
            bad = (values < least) | (np.abs(values) > most)
            bad |= counted & (values != np.round(values)) & ~np.isnan(values)
        if bad.any():
            raise InputError(f"{path}: {name} of a solved case cannot be {values[bad][0]:g}")


def _check_loads(ds: xr.Dataset, path: str | Path) -> None:
    if not {*schema.stiffness_fields(ds), "rho"} <= {*ds.variables}:
        return
    unit = schema.bending_stiffness(str(ds.attrs["stiffness"]), ds) / ds["rho"]  # of moment
    with np.errstate(all="ignore"):
        for name in LOADS:
            if name in ds.variables:
                size = abs(ds[name]) / (unit / ds["rho"] if name == "FZ" else unit)
                if not (_over(size, ds).values[ds["solved"].values] < MOST).all():
                    raise InputError(f"{path}: {name} of a solved case is not finite, or far too large for its rod")


def curves(ds: xr.Dataset, path: str | Path) -> None:
    """Raise `InputError` unless the curves of solved cases are finite, and no chord is longer than its arc."""
    keys = [key for key in CURVES if key in ds.data_vars and "u" in ds[key].dims]
    dims = ds["solved"].dims
    for key in keys:
        if ds[key].dtype.kind not in "iuf" or ds[key].dims[: len(dims)] != dims:
            raise InputError(f"{path}: {show(key)} is not an array of numbers along each rod")
    names = [name for name in ("solved", *keys, "s", "rho") if name in ds.variables]
    for block in pieces(ds, names, max(1, BLOCK_ALONG // ds.sizes.get("u", 1))):
        _check_block(block, keys, path)


def _check_block(ds: xr.Dataset, keys: Iterable[str], path: str | Path) -> None:
    solved = ds["solved"].variable
    for key in keys:
        most = MOST_ANGLE if CURVES[key] in ("beta", "alpha", "gamma") else MOST
        if not (np.abs(ds[key].values[solved.values]) < most).all():
            raise InputError(f"{path}: {show(key)} of a solved case is not finite, or beyond {most:g}")
    if not {"s", "rho"} <= set(ds.variables) or "u" not in ds.dims:
        return
    arc = ds["s"].diff("u")
    for name, scale in (("alpha", ds["rho"]), ("z", 1.0)):
        if name in ds.data_vars and "u" in ds[name].dims:
            with np.errstate(all="ignore"):
                far = np.abs(ds[name].diff("u") * scale) > arc * (1 + STRAIGHT) + STRAIGHT * ds["rho"]
            if bool((far & solved).any()):
                raise InputError(f"{path}: {name} of a solved case moves farther than the rod is long")


def _over(values: xr.DataArray, ds: xr.Dataset) -> xr.DataArray:
    """The values over all axes of the cases, in their order."""
    return values.broadcast_like(ds["outcome"]).transpose(*ds["outcome"].dims)


def _worst(values: NDArray[Any], good: NDArray[np.bool_]) -> str:
    return f"{values[~good].flat[0]:g}"
