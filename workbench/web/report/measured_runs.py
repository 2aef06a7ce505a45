"""Accuracy against cost and the extremes in the report: stored measurements, which are drawn and not repeated."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
import xarray as xr

from solver.methods import METHODS
from solver.problem.errors import InputError

from ...figures import canvas, kinds, robustness, work_precision
from ...store import reading
from ...words import labels

SHIPPED = Path(__file__).parents[2] / "compare" / "measured"  # made with benchmarks/make_measured.py


@dataclass(frozen=True)
class Measured:
    """A diagram (PNG), a sentence on what it shows, and the run and machine that it is from."""

    name: str
    picture: bytes
    shows: str
    source: str


def comparisons(folder: Path) -> list[Measured]:
    """Extremes and trade, of the runs stored in the folder; default: of those that are shipped."""
    return [comparison(folder, "extremes", _extremes), comparison(folder, "trade", _trade)]


def comparison(folder: Path, name: str, shows: Callable[[xr.Dataset], str]) -> Measured:
    """The diagram of `name`.h5; of the shipped run where that cannot be drawn, with the reason."""
    beside, why = Path(folder) / f"{name}.h5", ""
    try:
        if beside.is_file():
            return _make(reading.read(beside, study=False), name, shows, f"{name}.h5 beside this report")
    except (InputError, KeyError, ValueError) as error:  # a readable file may still lack variables
        why = f" ({beside.name} beside this report cannot be drawn: {error})"
    shipped = reading.read(SHIPPED / f"{name}.h5", study=False)
    return _make(shipped, name, shows, f"a run that comes with the workbench{why}")


def _make(ds: xr.Dataset, name: str, shows: Callable[[xr.Dataset], str], source: str) -> Measured:
    picture = BytesIO()
    drawn = kinds.figure(ds.assign_attrs(title=""), name)  # the report gives the title, once
    canvas.save(drawn, picture, drawn.dpi)
    return Measured(name, picture.getvalue(), shows(ds), f"{_run(ds)}; {source}")


def _run(ds: xr.Dataset) -> str:
    versions = json.loads(ds.attrs["versions"])
    named = ", ".join(f"{name} {versions[name]}" for name in ("python", "numpy", "scipy") if name in versions)
    day = str(ds.attrs["created"]).replace("T", " ").removesuffix("+00:00")
    return f"Measured {day} UTC on {ds.attrs.get('machine', 'an unknown machine')}, with {named}"


def _trade(ds: xr.Dataset) -> str:
    shown = len(work_precision.cases_to_show(ds))
    return (
        f"{ds.sizes['ladder']} methods and variants on {ds.sizes['case']} rods, {shown} of them shown: the error "
        "that is achieved against the seconds of the whole call, from the coarsest to the finest setting of each"
    )


def _extremes(ds: xr.Dataset) -> str:
    verdict = ds["verdict"]
    solved = [
        f"{name} {int((verdict.sel({'method': name}) == 'solved').sum())}"
        for name, method in METHODS.items()
        if method.knows_orbit and "start" in method.problems and name in ds["method"].values
    ]
    wrong = int((verdict == "inaccurate").sum())
    honest = "no case reported as solved is wrong" if wrong == 0 else f"cases reported as solved but wrong: {wrong}"
    bound = f"{10**robustness.MOST:g} tol max(1, condition), tol = {float(ds.attrs['tolerance']):g}"
    counts = f"Solved by {', by '.join(solved)}; {honest}{_vague(ds)}. Wrong is an error above the bound {bound}"
    left = [name for name in METHODS if name not in ds["method"].values]
    without = f" (not in this run: {', '.join(left)})" if left else ""
    methods = f"{ds.sizes['method']} methods{without}"
    sentence = f"{ds.sizes['extreme']} named extremes by {methods}. {counts}. Each unsolved case has a reason"
    return labels.typeset(sentence)


def _vague(ds: xr.Dataset) -> str:
    """The number of solved cells in which the bound for wrong is so wide that it proves little, and their errors."""
    cells = robustness.vague(ds)
    if not cells.any():
        return ""
    errors = np.where(cells, ds["error"].values, -1.0)
    i, j = np.unravel_index(errors.argmax(), errors.shape)
    return (
        f", but in {int(cells.sum())} solved cells (blue) the problem itself is ill-conditioned at this tolerance: the "
        f"bound exceeds {robustness.VAGUE:g} rad, so that the error in the cell, and not the word solved, tells how "
        f"good the answer is; the largest is {errors[i, j]:.1g} rad ({ds['method'].values[j]}, "
        f"{ds['extreme'].values[i]})"
    )
