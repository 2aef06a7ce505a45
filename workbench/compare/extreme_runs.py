"""Robustness: every method at every named extreme, as a dataset."""

import multiprocessing
import os
import signal
import time
import warnings
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from solver import Case, Ends, Solution, solve
from solver.methods import OrbitQuadrature, available

from ..store import dataset
from .extreme_cases import SHARES, Extreme, Reference, extremes, references

TOL = 1e-6
_NO_ANSWER = ("finite", "evaluations", "gave up")  # in the outcome of an overflow, a spent budget, an integrator's end
SOLVED, REFUSED, INACCURATE, NONFINITE = VERDICTS = ("solved", "refused", "inaccurate", "non-finite")
_MARGIN = 10.0  # an error of this many times tol * max(1, condition) is inaccurate
NUMBERS = {
    "error": ("rad", "largest error of the angle, against the reference"),
    "estimate": ("1", "the error that the method itself states"),
    "condition": ("1", "the condition number that the method itself states"),
    "seconds": ("s", "time of the whole call"),
    "evaluations": ("1", "evaluations of the equation"),
}


@dataclass(frozen=True)
class Attempt:
    """The result of one method at one extreme."""

    verdict: str
    outcome: str
    error: float
    estimate: float
    condition: float
    seconds: float
    evaluations: float


def rows_of(named: Sequence[Extreme], step: Callable[[str], None]) -> Generator[tuple[str, dict[str, Attempt]]]:
    """The name and the attempts of each extreme, in the order in which the processes of this machine finish them.

    The processes end when the generator is closed. step: called with the name of each extreme that is finished.
    """
    known = references()
    pool = ProcessPoolExecutor(os.cpu_count(), initializer=signal.signal, initargs=(signal.SIGINT, signal.SIG_IGN))
    try:
        waited = {pool.submit(attempts_at, extreme, known[extreme.name]): extreme.name for extreme in named}
        for done in as_completed(waited):
            yield waited[done], done.result()
            step(waited[done])
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for worker in multiprocessing.active_children():  # they would finish the extreme in hand
            worker.terminate()
        raise
    pool.shutdown()


def attempts_at(one: Extreme, reference: Reference) -> dict[str, Attempt]:
    """Each method at one extreme; methods for ends problems get the angle at the far end and the solution as seed."""
    best = solve(one.case, tol=1e-12, stations=_stations(one.case))
    known = reference.beta if reference.beta is not None else best.beta[1:]
    rows = {}
    for name, method in available().items():
        if "start" in method.problems:
            rows[name] = _attempt(one.case, name, known)
        elif not np.isfinite(best.beta).all():
            rows[name] = Attempt(REFUSED, "failed: not tried, no finite solution as seed", *[np.nan] * 5)
        else:
            given = Ends(best.problem.beta0[0], known[-1], best.FZ, best.MZ, best.M3)
            rows[name] = _attempt(Case(one.case.rod, one.case.cylinder, given), name, known, best)
    return rows


def _stations(case: Case) -> np.ndarray:
    return float(case.rod.L) * np.array((0.0, *SHARES))


def _attempt(case: Case, method: str, known: Any, seed: Solution | None = None) -> Attempt:
    began = time.perf_counter()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # scipy repeats what the outcome says
        sol = solve(case, TOL, method, stations=_stations(case), seed=seed)
    seconds = time.perf_counter() - began
    finite = bool(np.isfinite([sol.beta, sol.dbeta, sol.alpha, sol.z]).all())
    error = float(np.abs(sol.beta[1:] - known).max()) if finite else np.nan
    if seed is not None and finite:  # another equilibrium between the same ends is not an error
        exact = OrbitQuadrature().run(sol.problem.with_start(sol.trajectory.dbeta[:, 0]), sol.t, 1e-12).beta
        error = min(error, float(np.abs(sol.trajectory.beta - exact).max()))
    allowed = _MARGIN * TOL * max(1.0, float(sol.condition))
    if sol.solved:
        verdict = NONFINITE if not finite else SOLVED if error <= allowed else INACCURATE
    else:
        verdict = REFUSED if finite or not any(word in sol.outcome for word in _NO_ANSWER) else NONFINITE
    numbers = float(sol.error), float(sol.condition), seconds, float(sol.evaluations)
    return Attempt(verdict, str(sol.outcome), error, *numbers)


def dataset_of(found: Mapping[str, Mapping[str, Attempt]]) -> xr.Dataset:
    """The attempts over (extreme, method), extremes in the order of the map; found: extreme -> method -> attempt."""
    named, known = [extreme for extreme in extremes() if extreme.name in found], references()
    methods = list(dict.fromkeys(method for rows in found.values() for method in rows))
    full = ("extreme", "method")
    table = [[found[extreme.name][method] for method in methods] for extreme in named]
    data: dict[str, Any] = {}
    for name, words in {"verdict": "result of the method", "outcome": "solved, or why not"}.items():
        data[name] = (full, [[str(getattr(row, name)) for row in line] for line in table], {"long_name": words})
    for name, (units, words) in NUMBERS.items():
        values = np.array([[getattr(row, name) for row in line] for line in table], dtype=float)
        data[name] = (full, values, {"units": units, "long_name": words})
    problems = [solve(extreme.case, stations=2).problem for extreme in named]
    for name in ("lam", "mu", "phi", "span", "beta0", "dbeta0"):
        data[name] = (("extreme",), np.concatenate([getattr(p, name) for p in problems]), {"units": "1"})
    sources = [
        "taylor series to 25 digits" if known[extreme.name].beta is not None else "orbit at 1e-12" for extreme in named
    ]
    data["reference"] = (("extreme",), sources, {"long_name": "what the error is measured against"})
    data["group"] = (("extreme",), [extreme.group for extreme in named], {"long_name": "what is extreme"})
    return xr.Dataset(data, {"extreme": [extreme.name for extreme in named], "method": methods}, _attributes())


def _attributes() -> dict[str, Any]:
    return {
        "title": f"Result of every method at every extreme, tolerance {TOL:g}",
        "study_name": "extremes",
        "laws": "[]",
        "tolerance": TOL,
        **dataset.provenance(measured=True),
    }
