"""The commands plot and scene: from a stored dataset to a picture."""

import math
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.angles import angle
from solver.problem.errors import InputError, choices, no_such

from ..data import case_selection, dataset, reading, writing
from ..scene import kinds
from . import console, needed_cases

PLOTS = (".png", ".pdf", ".svg")
SCENES = (".png", ".jpg")
WRITTEN = 4  # digits of a value in a diagram
LOOSEST = 0.001  # of the value: what is written with one or two digits is not taken for less exact than that


def plot_file(file: Path, out: Path | None, force: bool = False, dpi: int = 200) -> None:
    """Draw a dataset's developed curves and observables; dpi: of a PNG. Raises `InputError`."""
    ds = writing.read(file)
    path = free_picture(out or file.with_suffix(".png"), PLOTS, force)
    from ..figures import trends

    trends.figure(ds, path, dpi)
    console.say(str(path))


def scene_file(
    file: Path, at: list[str], out: Path | None, force: bool = False, kind: str | None = None,
    axes: list[str] | None = None, along: str | None = None, span: tuple[float | None, float | None] = (None, None),
    pixel_error: float = 0.5, dpi: int = 200,
) -> int:  # fmt: skip
    """Draw a scene of a dataset or a study; 0, or 1 where this machine cannot or the stations are too few for the pixel
    error.

    file: of a dataset, or the name or TOML file of a study, which is then solved at the stations that the picture
    needs. kind: a name of `kinds.KINDS`; where left out equilibria for a dataset of them, else contact. Raises
    `InputError`.
    """
    study = None
    if needed_cases.is_study(file):
        study, ds = needed_cases.rough(file)
        file = Path(f"{study.name}.h5")
    else:
        ds = _read(file)
    found = kinds.kind_of(kind or ("equilibria" if dataset.axes_of(ds) == ["equilibrium"] else "contact"))
    where = chosen(ds, at)
    told = [f"{name}={_written(ds[name], value)}" for name, value in where.items()]
    named = [] if found.name in ("contact", "equilibria") else [found.name, *(axes or [])]
    path = free_picture(out or file.with_name("_".join([file.stem, "scene", *named, *told]) + ".png"), SCENES, force)
    from ..scene import opengl

    able, advice = opengl.probe()
    if not able:
        console.warn(advice)
        return 1
    from ..scene import composition, layout

    stretch = stretch_of(ds, span)

    def draw(ds: xr.Dataset, exactly: bool) -> Any:
        look = composition.Look(pixel_error, dpi, stretch, exactly)
        return layout.render(ds, path, where or None, found.name, axes or [], along, look)

    if found.cells == "one":  # which of the cases it is, also where it was not asked for
        case = case_selection.case(ds, where).items()
        told = [f"{name}={_written(ds[name], float(ds[name].values[i]))}" for name, i in case]
    said = [str(path), *([", ".join(told)] if told else [])]
    if study is None:
        taken, stations = draw(ds, False), ds.sizes["u"]
    else:
        shown = axes or ([] if found.cells == "one" else dataset.axes_of(ds)[:1])
        taken, stations = needed_cases.at_need(needed_cases.only(study, ds, found, where, [*shown, along or ""]), draw)
    console.say(" at ".join(said) + (f", solved at {stations} stations" if study else ""))
    if taken.off > pixel_error * (1 + 1e-9):
        kept = f"{taken.off:.1f} pixels, not {pixel_error:g}: {stations} stations are too few for that"
        console.warn(f"drawn to within {kept}, about {taken.stations} would do")
        return 1
    return 0


def _read(file: Path) -> xr.Dataset:
    """A study's dataset, or one of equilibria. Raises `InputError`."""
    try:
        return writing.read(file)
    except InputError:
        with reading.raw(file) as ds:
            other = ds.attrs.get("study_name") != "equilibria" or "equilibrium" not in ds.dims or "outcome" not in ds
        if other:
            raise
    return writing.read(file, study=False)


def stretch_of(ds: xr.Dataset, span: tuple[float | None, float | None]) -> tuple[float, float] | None:
    """The stretch that --from and --to ask for, or None where neither is given."""
    if span == (None, None):
        return None
    low, high = span
    return (low or 0.0, float(ds["s"].max()) if high is None else high)


def chosen(ds: xr.Dataset, at: list[str]) -> dict[str, float]:
    """The stored value that each `E=10905` or `beta=30deg` means; `InputError` where there is none."""
    axes = dataset.axes_of(ds)
    found: dict[str, float] = {}
    for text in at:
        name, equals, said = text.partition("=")
        if not equals:
            raise InputError(f"--at takes NAME=VALUE, got {text!r}")
        if name not in axes:
            raise no_such("axis", name, axes) if axes else InputError(f"--at {text}: the dataset has no axes")
        if name in found:
            raise InputError(f"--at {text}: {name} is given twice")
        found[name] = _meant(ds[name], text, said)
    return found


def free_picture(path: Path, kinds: tuple[str, ...], force: bool) -> Path:
    """The path, of a kind that can be drawn and where nothing is yet (or `force`). Raises `InputError`."""
    if path.suffix.lower() not in kinds:
        raise InputError(f"cannot draw {path.name!r}: choose a name that ends in {choices(kinds)}")
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file")
    writing.check_parent(path)
    if path.exists() and not force:
        raise InputError(f"{path} exists; give --force to replace it")
    return path


def _meant(axis: xr.DataArray, text: str, said: str) -> float:
    """The one value of an axis that, rounded to as many digits as were given, is what was given.

    The noughts at the end of a whole number are digits, but a diagram writes 10910 for 10905, to four of them.
    """
    is_angle = axis.attrs.get("units") == "rad"
    try:
        value = angle(said) if is_angle else float(said)
    except ValueError as error:
        raise InputError(f"--at {text}: {error if is_angle else f'{said!r} is not a number'}") from None
    away = np.abs(axis.values - value)
    equal = 1e-9 * np.abs(axis.values).max()
    near = np.zeros(0, dtype=int)
    for half in (_half_digit(said), _half_digit(said, noughts=False)):
        near = np.flatnonzero(away <= max(equal, min(half, LOOSEST * abs(value))))
        if near.size > 1:  # one of them may be it to the last digit
            near = near[away[near] <= equal]
        if near.size:
            break
    if near.size != 1:
        listed = ", ".join(_written(axis, float(v)) for v in axis.values)
        raise InputError(f"--at {text}: the axis {axis.name} has no such value; its values are {listed}")
    return float(axis.values[near[0]])


def _half_digit(said: str, noughts: bool = True) -> float:
    """Half a unit in the last digit of a number as it is written, in rad where degrees are; 0 for pi/6.

    noughts: whether those at its end count as digits; where not, at least `WRITTEN` others have to be there.
    """
    number, deg = (said.strip().removesuffix("deg"), True) if said.strip().endswith("deg") else (said.strip(), False)
    try:
        written = Decimal(number.strip())
        exact = written.normalize().as_tuple()
        exponent = written.as_tuple().exponent if noughts or len(exact.digits) < WRITTEN else exact.exponent
    except InvalidOperation:
        return 0.0
    half = 0.5 * 10.0**exponent if isinstance(exponent, int) else 0.0
    return math.radians(half) if deg else half


def _written(axis: xr.DataArray, value: float) -> str:
    """A value of an axis as --at takes it."""
    return f"{math.degrees(value):.6g}deg" if axis.attrs.get("units") == "rad" else f"{value:.6g}"
