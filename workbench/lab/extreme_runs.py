"""Robustness: every method at named start problems with extreme parameters, as a dataset."""

import json
import multiprocessing
import os
import signal
import time
import warnings
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver import Case, Ends, Solution, solve
from solver.methods import OrbitQuadrature, available

from ..stored import provenance
from .trade_runs import in_units_of_rho, table_1

SHARES = (0.25, 0.5, 0.75, 1.0)  # of the length: where answer and reference are compared
FILE = Path(__file__).with_name("extremes.json")
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
class Extreme:
    """A start problem, its name, and the group of the map to which it belongs."""

    name: str
    group: str
    case: Case


@dataclass(frozen=True)
class Reference:
    """beta [rad] at `SHARES` of the length, (4,), and its source; None and empty if no series reaches the end."""

    beta: NDArray[np.float64] | None
    source: str


@cache
def references() -> dict[str, Reference]:
    """The references by name, which benchmarks/make_extremes.py computed to 25 digits."""
    rows = json.loads(FILE.read_text(encoding="utf-8"))
    return {
        name: Reference(None if row["beta"] is None else np.array(row["beta"]), row["source"])
        for name, row in rows.items()
    }


def extremes() -> list[Extreme]:
    """All extremes, in the order of the map."""
    printed, twisted = (partial(table_1, twist, "tension") for twist in ("force-first", "twist-first"))
    below, above = float(np.nextafter(np.pi, 0)), float(np.nextafter(np.pi / 2, 4))
    near = -float(np.sqrt(1e4 * 2 - _potential(0.5, 1e4)))
    groups: dict[str, list[tuple[str, Case | tuple[float, ...]]]] = {
        "rod": [
            ("Table 1 as printed", printed()),
            ("E = 1e-9 N/cm²", printed(E=1e-9)),
            ("E = 1e15 N/cm²", printed(E=1e15)),
            ("ν = 0.5", twisted(nu=0.5)),
            ("ν one bit above −1", twisted(nu=float(np.nextafter(-1, 0)))),
        ],
        "cylinder": [("R = 1e-9 a", printed(R=0.25e-9)), ("R = 1e9 a", printed(R=0.25e9))],
        "length": [(f"L/ρ = {_power(span)}", (0.2, 0.1, -0.5, span, 0.7, 0.3)) for span in (1e-6, 1e3, 1e6, 1e9)],
        "loads": [
            ("no loads", (0, 0, 0, 20.0, np.pi / 6, 0.0)),
            *((f"loads {_power(size)}", (0.3 * size, 0.2 * size, -0.5 * size, 20.0, 0.7, 0.3))
              for size in (1e-12, 1e3, 1e6, 1e12)),
            ("loads 1e12, short", (3e11, 2e11, -5e11, 2e-5, 0.7, 0.3)),
        ],
        "angle": [
            (f"β₀ {words}", (0.3, 0.2, 0.1, 20.0, angle, 0.4))
            for words, angle in (("= 0", 0.0), ("= 5e-324", 5e-324), ("= π/2", np.pi / 2), ("one bit above π/2", above),
                                 ("= π", np.pi), ("one bit below π", below))
        ],
        "helix": [
            ("on a centre helix", (_on_helix(1.1, 0.9, -0.4), 0.9, -0.4, 20.0, 1.1, 0.0)),
            ("centre helix, L = 1e6 ρ", (_on_helix(1.1, 0.9, -0.4), 0.9, -0.4, 1e6, 1.1, 0.0)),
            ("on a saddle helix", (_on_helix(1.1, 0.4, 0.2), 0.4, 0.2, 20.0, 1.1, 0.0)),
            ("on a steep saddle helix", (_on_helix(0.4, -0.3, 0.1), -0.3, 0.1, 40.0, 0.4, 0.0)),
            ("where H only touches zero", (-3.0, -3.0, 0.0, 20.0, 1e-6, 0.0)),
        ],
        "separatrix": [
            ("on a separatrix", (0, 0, 1.0, 15.0, 0.5, -float(np.sqrt(2 - _potential(0.5))))),
            *((f"turns {_power(gap)} before a saddle", (0, 0, 1.0, 25.0, gap, 0.0))
              for gap in (1e-4, 1e-8, 1e-12, 1e-16, 1e-100)),
            ("passes a saddle at 1e-12", (0, 0, 1.0, 40.0, 0.0, 1e-12)),
        ],
        "tension": [
            ("tension φ = 1e4, straight", (0, 0, 1e4, 20.0, 0.0, 0.0)),
            ("tension φ = 1e4, 1e-3 off", (0, 0, 1e4, 20.0, 1e-3, 0.0)),
            ("tension φ = 1e4, next to e⁻ˢ", (0, 0, 1e4, 0.4, 0.5, near)),
            ("tension φ = 1e8, 1e-3 off", (0, 0, 1e8, 20.0, 1e-3, 0.0)),
            ("compression φ = −1e8", (0, 0, -1e8, 20.0, 1e-3, 0.0)),
        ],
    }  # fmt: skip
    return [
        Extreme(name, group, case if isinstance(case, Case) else in_units_of_rho(*case))
        for group, rows in groups.items()
        for name, case in rows
    ]


def _power(number: float) -> str:
    """``1e6``, ``1e-12``."""
    return f"{number:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def _on_helix(beta: float, mu: float, phi: float) -> float:
    """lam of the helix of that angle: H(beta) = 0."""
    s, c = np.sin(beta), np.cos(beta)
    return float((mu * np.cos(2 * beta) + (phi + 2 * c * s * s) * s) / c)


def _potential(beta: float, phi: float = 1.0) -> float:
    """G(beta) with lam = mu = 0; its saddle is beta = 0, where G = 2 phi."""
    return float(-(np.sin(beta) ** 4) + 2 * phi * np.cos(beta))


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


def as_dataset(found: Mapping[str, Mapping[str, Attempt]]) -> xr.Dataset:
    """The attempts over (extreme, method), extremes in the order of the map; found: extreme -> method -> attempt."""
    named, known = [extreme for extreme in extremes() if extreme.name in found], references()
    methods = list(dict.fromkeys(method for rows in found.values() for method in rows))
    full = ("extreme", "method")
    table = [[found[extreme.name][method] for method in methods] for extreme in named]
    words = {"verdict": {"long_name": "result of the method"}, "outcome": {"long_name": "solved, or why not"}}
    words |= {name: {"units": units, "long_name": text} for name, (units, text) in NUMBERS.items()}
    data: dict[str, Any] = {
        name: (full, [[getattr(row, name) for row in line] for line in table], attrs) for name, attrs in words.items()
    }
    problems = [solve(extreme.case, stations=2).problem for extreme in named]
    for name in ("lam", "mu", "phi", "span", "beta0", "dbeta0"):
        data[name] = (("extreme",), np.concatenate([getattr(p, name) for p in problems]), {"units": "1"})
    sources = [
        "taylor series to 25 digits" if known[extreme.name].beta is not None else "orbit at 1e-12" for extreme in named
    ]
    data["reference"] = (("extreme",), sources, {"long_name": "what the error is measured against"})
    data["group"] = (("extreme",), [extreme.group for extreme in named], {"long_name": "what is extreme"})
    attributes = {
        "title": f"Result of every method at every extreme, tolerance {TOL:g}",
        "study_name": "extremes",
        "laws": "[]",
        "tolerance": TOL,
        **provenance.provenance(measured=True),
    }
    return xr.Dataset(data, {"extreme": [extreme.name for extreme in named], "method": methods}, attributes)
