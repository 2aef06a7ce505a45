"""Accuracy against cost, measured: each method over a ladder of its knob, on cases whose answer is known.

The seconds are those of the whole call of `solve`: the answer at the stations, its error estimate and its condition
number. The achieved error is measured against a reference, not taken from the method.
"""

import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.methods import METHODS, OrbitQuadrature
from solver.methods.method import Ladder
from solver.numerics.arrays import Array
from solver.problem.case import Case
from solver.solution import Solution
from solver.solve import solve

STATIONS = 201
REPEATS = 5
_ENOUGH = 0.06  # seconds of repeats, after which no further one is made


@dataclass(frozen=True, eq=False)
class BenchmarkReference:
    """The known answer of a case.

    beta [rad], alpha [rad], z/rho and contact rho^3/A at s/L = u, (n,) each; condition: the condition number.
    """

    u: Array
    beta: Array
    alpha: Array
    z: Array
    contact: Array
    condition: float


@dataclass(frozen=True)
class BenchmarkRow:
    """One rung: what was asked for, and the result.

    Errors: of beta [rad], of position over max(rho, L), of contact over its largest size; estimate: the error that the
    method states. answered: the method whose answer it is: another one where the method handed the rod over. drift: of
    h rho^2, and of FZ and MZ as computed from forces and moments along the rod, over A/rho^2 and A/rho.
    """

    case: str
    ladder: str
    knob: str
    value: float
    solved: bool
    outcome: str
    answered: str
    seconds: float
    evaluations: float
    error_beta: float
    error_position: float
    error_contact: float
    estimate: float
    condition: float
    drift_h: float
    drift_FZ: float
    drift_MZ: float

    @property
    def error(self) -> float:
        """The larger of the errors of beta and of position."""
        return max(self.error_beta, self.error_position)


def ladders() -> dict[str, Ladder]:
    """The ladders of all methods by their names: start methods first, in rising order of convergence."""
    methods = sorted(METHODS.values(), key=lambda method: ("start" not in method.problems, method.order, method.name))
    return {ladder.name: ladder for method in methods for ladder in method.ladders}


def available_ladders() -> dict[str, Ladder]:
    """The ladders of the methods that can run here."""
    return {name: ladder for name, ladder in ladders().items() if METHODS[ladder.method].is_installed()}


def measure(
    cases: Mapping[str, tuple[Case, BenchmarkReference, float | None]], ladders: Mapping[str, Ladder]
) -> list[BenchmarkRow]:
    """Each ladder on each case of a kind that its method solves; one row a rung, failed rungs included.

    Parameters
    ----------
    cases : mapping
        Name -> case, reference and, for an ends problem, beta'(0) of the equilibrium that is meant.
    ladders : mapping of Ladder
        By name.

    Raises
    ------
    InputError
        For what `solve` refuses.
    """
    rows: list[BenchmarkRow] = []
    for name, (case, reference, slope) in cases.items():
        # of ends the equilibrium that is meant is the seed of every method; its cost is not counted
        seed = {} if slope is None else {"seed": solve(case, method="shooting", seed=slope, stations=101)}
        for label, ladder in ladders.items():
            if case.kind in METHODS[ladder.method].problems:
                rows += _climb(name, case, reference, label, ladder, seed)
    return rows


def _climb(
    name: str, case: Case, reference: BenchmarkReference, label: str, ladder: Ladder, seed: Mapping[str, Any]
) -> Iterator[BenchmarkRow]:
    """The rows of one ladder on one case."""
    taken, before = 0.0, ladder.values[0]  # evaluations of the last rung, and its value
    solve(case, stations=STATIONS, **seed, **ladder.options(before))  # warm-up
    for value in ladder.values:
        if taken * max(1.0, value / before) > ladder.most:
            why = f"not run: it would take more than {ladder.most:g} evaluations"
            yield BenchmarkRow(name, label, ladder.knob, value, False, why, "", *[np.nan] * 10)
            continue
        sol, seconds = _time(case, {**seed, **ladder.options(value)}, ladder.cold)
        taken, lost = float(sol.evaluations), np.any(getattr(sol.trajectory.orbit, "lost", False))
        answered = OrbitQuadrature.name if lost else sol.method  # a march that loses its orbit hands it over
        yield BenchmarkRow(name, label, ladder.knob, value, bool(sol.solved), str(sol.outcome), answered, seconds,
                  taken, **errors_against(sol, reference), estimate=float(sol.error), condition=float(sol.condition),
                  **drift(sol))  # fmt: skip
        before = value


def _time(case: Case, options: Mapping[str, Any], cold: bool) -> tuple[Solution, float]:
    """The answer, and the least seconds of a few calls; a short or cold first call is not counted."""
    seconds: list[float] = []
    while True:
        begun = time.perf_counter()
        sol = solve(case, stations=STATIONS, **options)
        seconds.append(time.perf_counter() - begun)
        is_long = seconds[0] > _ENOUGH and not cold
        if is_long or len(seconds) > REPEATS or sum(seconds[1:]) >= _ENOUGH:
            return sol, min(seconds[1:] or seconds)


def errors_against(sol: Solution, reference: BenchmarkReference) -> dict[str, float]:
    """Errors of a single case by their names in `BenchmarkRow`, inf where not finite.

    The stations of the case include those of the reference.
    """
    at = np.rint(reference.u * (sol.beta.size - 1)).astype(int)
    rho, A = float(sol.case.rho), float(sol.case.rod.bending_stiffness)
    with np.errstate(all="ignore"):
        alpha = sol.alpha[at] - sol.alpha[0]
        across = 2 * np.sin((alpha - reference.alpha) / 2)  # the chord
        position = np.hypot(across, sol.z[at] / rho - reference.z) / max(1.0, float(sol.case.rod.L) / rho)
        contact = (sol.contact[at] * (rho**3 / A) - reference.contact) / np.abs(reference.contact).max()
        off = {"error_beta": sol.beta[at] - reference.beta, "error_position": position, "error_contact": contact}
    return {name: _largest(values) for name, values in off.items()}


def drift(sol: Solution) -> dict[str, float]:
    """Largest changes of the constants along a single rod by their names in `BenchmarkRow`; inf where not finite."""
    rho, A = float(sol.case.rho), float(sol.case.rod.bending_stiffness)
    with np.errstate(all="ignore"):
        s, c = np.sin(sol.beta), np.cos(sol.beta)
        FZ = sol.F2 * s + sol.F3 * c
        MZ = rho * (sol.F3 * s - sol.F2 * c) + sol.M2 * s + sol.M3 * c
        off = {
            "drift_h": (sol.h - sol.h[0]) * rho**2,
            "drift_FZ": (FZ - sol.FZ) * (rho**2 / A),
            "drift_MZ": (MZ - sol.MZ) * (rho / A),
        }
    return {name: _largest(values) for name, values in off.items()}


def _largest(values: Array) -> float:
    return float(np.abs(values).max()) if np.isfinite(values).all() else np.inf


def cheapest(rows: Iterable[BenchmarkRow], level: float) -> dict[str, BenchmarkRow | None]:
    """For each case the fastest rung that was solved with an error of at most `level`, or None."""
    best: dict[str, BenchmarkRow | None] = {}
    for row in rows:
        fastest = best.setdefault(row.case, None)
        if row.solved and row.error <= level and (fastest is None or row.seconds < fastest.seconds):
            best[row.case] = row
    return best
