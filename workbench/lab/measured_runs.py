"""Accuracy against cost and the extremes in the report: stored measurements, which are drawn and not repeated."""

from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from solver.methods import METHODS
from solver.problem.errors import InputError

from ..figures import canvas, figure_kinds
from ..figures.sheet import COLUMN, SCREEN, Sheet
from ..stored import reading
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import robustness, trade_figure

SHIPPED = Path(__file__).parent / "measured"  # made with benchmarks/make_measured.py


@dataclass(frozen=True)
class MeasuredRun:
    """A diagram (PNG), a sentence on what it shows, and the run and machine that it is from.

    column: the diagram as wide as one column, where it fits.
    """

    name: str
    picture: bytes
    column: bytes | None
    shows: str
    source: str


def comparisons(folder: Path) -> list[MeasuredRun]:
    """Extremes and trade, of the runs stored in the folder; default: of those that are shipped."""
    return [comparison(folder, "extremes", _extremes), comparison(folder, "trade", _trade)]


def comparison(folder: Path, name: str, shows: Callable[[StoredStudy], str]) -> MeasuredRun:
    """The diagram of `name`.h5; of the shipped run where that cannot be drawn, with the reason."""
    beside, why = Path(folder) / f"{name}.h5", ""
    try:
        if beside.is_file():
            return _make(reading.read_stored(beside, study=False), name, shows, f"{name}.h5 beside this report")
    except (InputError, KeyError, ValueError) as error:  # a readable file may still lack variables
        why = f" ({beside.name} beside this report cannot be drawn: {error})"
    shipped = reading.read_stored(SHIPPED / f"{name}.h5", study=False)
    return _make(shipped, name, shows, f"a run that comes with the workbench{why}")


def _make(stored: StoredStudy, name: str, shows: Callable[[StoredStudy], str], source: str) -> MeasuredRun:
    def picture(of: Sheet) -> bytes | None:
        # the report gives the title, once
        packed, drawn = BytesIO(), figure_kinds.figure(stored.with_title(""), name, of)
        canvas.save(drawn, packed, drawn.dpi)
        return packed.getvalue() if drawn.get_figwidth() <= of.width + 0.01 else None

    wide, narrow = picture(SCREEN), picture(COLUMN)
    assert wide
    return MeasuredRun(name, wide, narrow, shows(stored), f"{_run(stored)}; {source}")


def _run(stored: StoredStudy) -> str:
    versions = stored.versions
    named = ", ".join(f"{name} {versions[name]}" for name in ("python", "numpy", "scipy") if name in versions)
    day = str(stored.attrs["created"]).replace("T", " ").removesuffix("+00:00")
    return f"Measured {day} UTC on {stored.attrs.get('machine', 'an unknown machine')}, with {named}"


def _trade(stored: StoredStudy) -> str:
    shown = len(trade_figure.cases_to_show(stored))
    return (
        f"{stored.sizes['ladder']} methods and variants on {stored.sizes['case']} rods, {shown} of them shown: the "
        "error that is achieved against the seconds of the whole call, from the coarsest to the finest setting of each"
    )


def _extremes(stored: StoredStudy) -> str:
    verdict = stored["verdict"]
    solved = [
        f"{name} {int((verdict.sel({'method': name}) == 'solved').sum())}"
        for name, method in METHODS.items()
        if method.knows_orbit and "start" in method.problems and name in stored["method"].values
    ]
    wrong = int((verdict == "inaccurate").sum())
    honest = "no case reported as solved is wrong" if wrong == 0 else f"cases reported as solved but wrong: {wrong}"
    bound = f"{10**robustness.MOST:g} tol max(1, condition), tol = {float(stored.attrs['tolerance']):g}"
    counts = f"Solved by {', by '.join(solved)}; {honest}{_vague(stored)}. Wrong is an error above the bound {bound}"
    left = [name for name in METHODS if name not in stored["method"].values]
    without = f" (not in this run: {', '.join(left)})" if left else ""
    methods = f"{stored.sizes['method']} methods{without}"
    sentence = f"{stored.sizes['extreme']} named extremes by {methods}. {counts}. Each unsolved case has a reason"
    return labels.typeset(sentence)


def _vague(stored: StoredStudy) -> str:
    """The number of solved cells in which the bound for wrong is so wide that it proves little, and their errors."""
    cells = robustness.vague(stored)
    if not cells.any():
        return ""
    errors = np.where(cells, stored["error"].values, -1.0)
    i, j = np.unravel_index(errors.argmax(), errors.shape)
    return (
        f", but in {int(cells.sum())} solved cells (blue) the problem itself is ill-conditioned at this tolerance: the "
        f"bound exceeds {robustness.VAGUE:g} rad, so that the error in the cell, and not the word solved, tells how "
        f"good the answer is; the largest is {errors[i, j]:.1g} rad ({stored['method'].values[j]}, "
        f"{stored['extreme'].values[i]})"
    )
