"""The command extremes: every method at every named extreme; what came of it, stored and drawn as a map."""

import json
import multiprocessing
import os
import platform
import signal
import time
import warnings
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver import Case, Ends, Solution, solve
from solver.methods import METHODS

from ..commands import console
from ..data import dataset, writing
from ..figures import canvas, robustness
from .extreme_cases import SHARES, Extreme, Reference, extremes, references

TOL = 1e-6
_NO_ANSWER = ("finite", "evaluations", "gave up")  # words of an overflow, a spent budget, an integrator's own end
SOLVED, REFUSED, INACCURATE, NONFINITE = VERDICTS = ("solved", "refused", "inaccurate", "non-finite")
_SLACK = 10.0  # an answer this many times past tol * max(1, condition) is inaccurate
NUMBERS = {
    "error": ("rad", "largest error of the angle, against the reference"),
    "estimate": ("1", "the error that the method itself states"),
    "condition": ("1", "the condition number that the method itself states"),
    "seconds": ("s", "time of the whole call"),
    "evaluations": ("1", "evaluations of the equation"),
}


@dataclass(frozen=True)
class Met:
    """What a method made of an extreme."""

    verdict: str
    outcome: str
    error: float
    estimate: float
    condition: float
    seconds: float
    evaluations: float


def run_extremes(out: Path, as_json: bool) -> int:
    """Run every method at every extreme; store extremes.h5 and draw extremes.png in the folder. Raises `InputError`.

    0, or 1 where a method calls solved what is not. Interrupted, it stores and draws the extremes that are finished as
    extremes_interrupted; extremes.h5 stays as it was.
    """
    writing.check_folder(out)
    writing.check_free(out / "extremes.h5", "extremes")
    named, known = extremes(), references()
    met: dict[str, dict[str, Met]] = {}
    try:
        _meet(named, known, met)
    except BaseException as error:
        files = _stored(named, known, met, out, "extremes_interrupted")[1] if met else []
        console.stopped(error, f"{len(met)} of {len(named)} extremes", files)
        raise
    ds, files = _stored(named, known, met, out, "extremes")
    _tell(ds, files, as_json)
    return 1 if (ds["verdict"] == INACCURATE).any() else 0


def _meet(named: Sequence[Extreme], known: dict[str, Reference], met: dict[str, dict[str, Met]]) -> None:
    """Fill in what each method makes of each extreme, as the processes of this machine finish them."""
    pool = ProcessPoolExecutor(os.cpu_count(), initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))
    try:
        with console.progress(len(named), lines=True) as step:
            waited = {pool.submit(at_one, one, known[one.name]): one.name for one in named}
            for done in as_completed(waited):
                met[waited[done]] = done.result()
                step(waited[done])
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for worker in multiprocessing.active_children():  # they would finish the extreme that they are at
            worker.terminate()
        raise
    pool.shutdown()


def _stored(
    named: Sequence[Extreme], known: dict[str, Reference], met: dict[str, dict[str, Met]], out: Path, name: str
) -> tuple[xr.Dataset, list[Path]]:
    """The dataset of the extremes that were met, and the files made of it: NAME.h5 and NAME.png."""
    rows = {(extreme, method): row for extreme, rows in met.items() for method, row in rows.items()}
    ds = labelled([one for one in named if one.name in met], known, rows)
    picture = out / f"{name}.png"
    canvas.save(robustness.figure(ds), picture)
    return ds, [writing.write(ds, out / f"{name}.h5"), picture]


def at_one(one: Extreme, reference: Reference) -> dict[str, Met]:
    """Each method at one extreme; methods for ends are given the angle at the far end, and the shape to look near."""
    best = solve(one.case, tol=1e-12, stations=_stations(one.case))
    known = reference.beta if reference.beta is not None else best.beta[1:]
    rows = {}
    for name, method in METHODS.items():
        if "start" in method.kinds:
            rows[name] = _met(one.case, name, known)
        elif not np.isfinite(best.beta).all():
            rows[name] = Met(REFUSED, "failed: not tried, no shape to look near", *[np.nan] * 5)
        else:
            given = Ends(best.problem.beta0[0], known[-1], best.FZ, best.MZ, best.M3)
            rows[name] = _met(Case(one.case.rod, one.case.cylinder, given), name, known, best)
    return rows


def _stations(case: Case) -> np.ndarray:
    return float(case.rod.L) * np.array((0.0, *SHARES))


def _met(case: Case, method: str, known: Any, seed: Solution | None = None) -> Met:
    began = time.perf_counter()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # scipy speaks of what the outcome says
        sol = solve(case, TOL, method, stations=_stations(case), seed=seed)
    seconds = time.perf_counter() - began
    finite = bool(np.isfinite([sol.beta, sol.dbeta, sol.alpha, sol.z]).all())
    error = float(np.abs(sol.beta[1:] - known).max()) if finite else np.nan
    if seed is not None and finite:  # another shape between the same ends is no error
        own = METHODS["orbit"].run(sol.problem.started(sol.trajectory.dbeta[:, 0]), sol.t, 1e-12).beta
        error = min(error, float(np.abs(sol.trajectory.beta - own).max()))
    allowed = _SLACK * TOL * max(1.0, float(sol.condition))
    if sol.solved:
        verdict = NONFINITE if not finite else SOLVED if error <= allowed else INACCURATE
    else:
        verdict = REFUSED if finite or not any(word in sol.outcome for word in _NO_ANSWER) else NONFINITE
    numbers = float(sol.error), float(sol.condition), seconds, float(sol.evaluations)
    return Met(verdict, str(sol.outcome), error, *numbers)


def labelled(named: Sequence[Extreme], known: dict[str, Reference], met: dict[tuple[str, str], Met]) -> xr.Dataset:
    """The rows over (extreme, method)."""
    methods = list(dict.fromkeys(method for _, method in met))
    full = ("extreme", "method")
    table = [[met[one.name, method] for method in methods] for one in named]
    data: dict[str, Any] = {}
    for name, words in {"verdict": "what came of it", "outcome": "solved, or why not"}.items():
        data[name] = (full, [[str(getattr(row, name)) for row in line] for line in table], {"long_name": words})
    for name, (units, words) in NUMBERS.items():
        values = np.array([[getattr(row, name) for row in line] for line in table], dtype=float)
        data[name] = (full, values, {"units": units, "long_name": words})
    problems = [solve(one.case, stations=2).problem for one in named]
    for name in ("lam", "mu", "phi", "span", "beta0", "dbeta0"):
        data[name] = (("extreme",), np.concatenate([getattr(p, name) for p in problems]), {"units": "1"})
    sources = ["taylor series to 25 digits" if known[one.name].beta is not None else "orbit at 1e-12" for one in named]
    data["reference"] = (("extreme",), sources, {"long_name": "what the error is measured against"})
    data["group"] = (("extreme",), [one.group for one in named], {"long_name": "what is extreme"})
    return xr.Dataset(data, {"extreme": [one.name for one in named], "method": methods}, _attributes())


def _attributes() -> dict[str, Any]:
    return {
        "title": f"What each method makes of the extremes, tolerance {TOL:g}",
        "study_name": "extremes",
        "laws": "[]",
        "tolerance": TOL,
        "machine": f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}",
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": json.dumps(dataset.versions()),
    }


def _tell(ds: xr.Dataset, files: Sequence[Path], as_json: bool) -> None:
    counts = {
        str(method): {verdict: int((ds["verdict"].sel({"method": method}) == verdict).sum()) for verdict in VERDICTS}
        for method in ds["method"].values
    }
    if as_json:
        console.print_json({"methods": counts, "files": [str(file) for file in files]})
        return
    rows = [[method, *(str(n) for n in row.values())] for method, row in counts.items()]
    console.print_table(["method", *VERDICTS], rows, str(ds.attrs["title"]))
    for file in files:
        console.say(str(file))
