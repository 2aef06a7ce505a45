"""The commands plot and scene: from a stored dataset to a picture."""

import math
from pathlib import Path

import xarray as xr

from solver.errors import InputError, choices, no_such

from . import console, dataset, store

PLOTS = (".png", ".pdf", ".svg")
SCENES = (".png", ".jpg")


def plot_file(file: Path, out: Path | None) -> None:
    """Draw a dataset's developed curves and observables. Raises `InputError`."""
    ds = store.read(file)
    path = _picture(out or file.with_suffix(".png"), PLOTS)
    from . import plots

    plots.figure(ds, path)
    console.say(str(path))


def scene_file(file: Path, at: list[str], out: Path | None) -> int:
    """Draw a dataset's rod in three dimensions; 0, or 1 where this machine cannot. Raises `InputError`."""
    ds = store.read(file)
    where = chosen(ds, at)
    path = _picture(out or file.with_name(f"{file.stem}_scene.png"), SCENES)
    from . import gl

    able, advice = gl.probe()
    if not able:
        console.err.print(f"workbench: {advice}", markup=False)
        return 1
    from . import scenes

    scenes.render(ds, path, where or None)
    told = ", ".join(f"{name}={value:g}" for name, value in where.items())
    console.say(f"{path}{f' at {told}' if told else ''}")
    return 0


def chosen(ds: xr.Dataset, at: list[str]) -> dict[str, float]:
    """The stored value nearest to each `E=1.07e4` or `beta=30deg`; `InputError` where there is none."""
    axes = dataset.axes_of(ds)
    found: dict[str, float] = {}
    for text in at:
        name, equals, said = text.partition("=")
        if not equals:
            raise InputError(f"--at takes NAME=VALUE, got {text!r}")
        if name not in axes:
            raise no_such("axis", name, axes) if axes else InputError(f"--at {text}: the dataset has no axes")
        found[name] = _nearest(ds[name], text, said)
    return found


def _nearest(axis: xr.DataArray, text: str, said: str) -> float:
    is_angle = axis.attrs.get("units") == "rad"
    try:
        value = math.radians(float(said[:-3])) if is_angle and said.endswith("deg") else float(said)
    except ValueError:
        raise InputError(f"--at {text}: {said!r} is not a number") from None
    low, high = float(axis.min()), float(axis.max())
    slack = 1e-9 * max(abs(low), abs(high))
    if not low - slack <= value <= high + slack:
        raise InputError(f"--at {text} is outside the axis, which goes from {low:.6g} to {high:.6g}")
    return float(axis.sel({axis.name: value}, method="nearest"))


def _picture(path: Path, kinds: tuple[str, ...]) -> Path:
    if path.suffix.lower() not in kinds:
        raise InputError(f"cannot draw {path.name!r}: choose a name that ends in {choices(kinds)}")
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file")
    store.check_parent(path)
    return path
