"""The commands plot and scene: from a stored dataset to a picture."""

from pathlib import Path
from typing import Any

import xarray as xr

from solver.problem.errors import InputError, choices

from ..data import reading, schema, selection, writing
from ..scene import kinds
from . import console, needed_cases

PLOTS = (".png", ".pdf", ".svg")
SCENES = (".png", ".jpg")


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
    found = kinds.kind_of(kind or ("equilibria" if schema.axes_of(ds) == ["equilibrium"] else "contact"))
    where = chosen(ds, at)
    told = [f"{name}={selection.written(name, value)}" for name, value in where.items()]
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
        case = selection.case(ds, where).items()
        told = [f"{name}={selection.written(name, float(ds[name].values[i]))}" for name, i in case]
    said = [str(path), *([", ".join(told)] if told else [])]
    if study is None:
        taken, stations = draw(ds, False), ds.sizes["u"]
    else:
        shown = axes or ([] if found.cells == "one" else schema.axes_of(ds)[:1])
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
            other = ds.attrs.get("study_name") != "equilibria" or "equilibrium" not in ds.dims or "solved" not in ds
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
    found: dict[str, float] = {}
    for text in at:
        name, equals, said = text.partition("=")
        if not equals:
            raise InputError(f"--at takes NAME=VALUE, got {text!r}")
        try:
            name = selection.axis_of(ds, name)
            value = float(ds[name].values[selection.index(ds, name, said)])
        except InputError as error:
            raise InputError(f"--at {text}: {error}") from None
        if name in found:
            raise InputError(f"--at {text}: {name} is given twice")
        found[name] = value
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
