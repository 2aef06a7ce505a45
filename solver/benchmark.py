"""Accuracy against cost, measured: every method over a ladder of its knob, on cases whose answer is known.

The seconds are those of the whole call: the answer at the stations, its error estimate and its condition number, as
whoever calls `solve` pays them. The achieved error is against a reference; no method judges itself.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .methods import METHODS
from .numerics.arrays import Array
from .problem.case import Case, Ends
from .solution import Solution
from .solve import solve

STATIONS = 201
REPEATS = 5
_ENOUGH = 0.06  # seconds of repeats, after which no further one is made
# Evaluations beyond which a ladder is left: what some 0.4 s allow on the machine of docs/reference/trade.md. Not
# seconds, so that a busy machine climbs the same rungs. Methods that call Python for each evaluation, and the others.
MOST_CALLED, MOST_COMPILED = 20_000, 1_000_000
_TRIED = 0.9  # the tolerance that a rung is judged by where its knob is not the tolerance: only the lost ones fail


@dataclass(frozen=True, eq=False)
class Reference:
    """What is known of a case: beta [rad], alpha [rad], z/rho, contact rho^3/A at shares u of the rod, all (n,);
    condition: the growth of a change of the start."""

    u: Array
    beta: Array
    alpha: Array
    z: Array
    contact: Array
    condition: float


@dataclass(frozen=True)
class Ladder:
    """A method, the knob that is turned, its values from cheap to dear, and the other knobs, which stay.

    cold: the first call at a value is slow (it compiles) and does not count. most: evaluations; a rung that would take
    more is not run.
    """

    method: str
    knob: str
    values: tuple[float, ...]
    fixed: Mapping[str, Any] = field(default_factory=dict)
    cold: bool = False
    most: float = MOST_CALLED

    def options(self, value: float) -> dict[str, Any]:
        """What `solve` is asked for on the rung of that value."""
        tol = {} if self.knob == "tol" else {"tol": _TRIED}
        return {"method": self.method, **tol, **self.fixed, self.knob: value}


@dataclass(frozen=True)
class Row:
    """One rung: what was asked and what came of it. Errors: of beta [rad], of position over max(rho, L), of contact
    over its largest size; estimate: what the method said of its error. drift: of h rho^2, and of FZ and MZ worked out
    from forces and moments along the rod, over A/rho^2 and A/rho."""

    case: str
    ladder: str
    knob: str
    value: float
    outcome: str
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
        """The larger of those of beta and of position."""
        return max(self.error_beta, self.error_position)


def tens(first: int, last: int, step: int = 1) -> tuple[float, ...]:
    """10^-first, ..., 10^-last."""
    return tuple(10.0**-k for k in range(first, last + 1, step))


def twos(last: int, times: int = 1) -> tuple[int, ...]:
    """times 1, 2, 4, ..., 2^last."""
    return tuple(times * 2**k for k in range(last + 1))


NODES = tuple(n + 1 for n in twos(9, 64))
LADDERS: dict[str, Ladder] = {
    "euler": Ladder("euler", "steps", twos(9)),
    "rk4": Ladder("rk4", "steps", twos(6)),
    "verlet": Ladder("verlet", "steps", twos(8), {"extrapolate": False}),
    "verlet extrapolated": Ladder("verlet", "steps", twos(7)),
    "dop853": Ladder("dop853", "rtol", (*tens(2, 12, 2), 1e-13), most=3 * MOST_CALLED),
    "lsoda": Ladder("lsoda", "rtol", (*tens(2, 12, 2), 1e-13), most=2 * MOST_CALLED),
    "heyoka": Ladder("heyoka", "rtol", tens(1, 15, 2), cold=True, most=MOST_COMPILED),
    "orbit": Ladder("orbit", "tol", (*tens(1, 11, 2), 1e-12, 1e-13)),
    "swing": Ladder("swing", "tol", (*tens(1, 11, 2), 1e-12, 1e-13)),
    "difference": Ladder("difference", "nodes", NODES, {"extrapolate": False}, most=MOST_COMPILED),
    "difference extrapolated": Ladder("difference", "nodes", NODES, most=MOST_COMPILED),
    "collocation": Ladder("collocation", "rtol", (*tens(1, 11, 2), 1e-12, 1e-13), most=MOST_COMPILED),
    "shooting": Ladder("shooting", "tol", tens(2, 13, 2)),
}


def offered() -> dict[str, Ladder]:
    """The ladders of the methods that can run here."""
    return {name: ladder for name, ladder in LADDERS.items() if ladder.method in METHODS}


def measure(
    cases: Mapping[str, tuple[Case, Reference, float | None]],
    ladders: Mapping[str, Ladder] | None = None,
    told: Callable[[str], None] = lambda _: None,
) -> list[Row]:
    """Every ladder on every single case of a kind it solves; one row a rung, failures among them.

    cases: name -> case, reference, and for an ends problem beta'(0) of the equilibrium that is meant. told: is
    called with the name of each case as its turn comes. Raises `InputError` for what `solve` refuses.
    """
    rows: list[Row] = []
    for name, (case, reference, slope) in cases.items():
        told(name)
        kind = "ends" if isinstance(case.given, Ends) else "start"
        seed = {} if slope is None else {"seed": _coarse(case, slope)}
        for label, ladder in (offered() if ladders is None else ladders).items():
            if kind in METHODS[ladder.method].kinds:
                rows += _climb(name, case, reference, label, ladder, seed)
    return rows


def _coarse(case: Case, slope: float) -> Solution:
    """The shape that is meant at a hundred steps: what every method for ends starts from; its cost is not counted."""
    return solve(case, method="shooting", seed=slope, stations=101)


def _climb(
    name: str, case: Case, reference: Reference, label: str, ladder: Ladder, seed: Mapping[str, Any]
) -> Iterator[Row]:
    taken, before = 0.0, ladder.values[0]  # evaluations, and where
    solve(case, stations=STATIONS, **seed, **ladder.options(before))  # warm-up
    for value in ladder.values:
        if taken * max(1.0, value / before) > ladder.most:
            why = f"not run: it would take more than {ladder.most:g} evaluations"
            yield Row(name, label, ladder.knob, value, why, *[np.nan] * 10)
            continue
        sol, seconds = _timed(case, {**seed, **ladder.options(value)}, ladder.cold)
        taken = float(sol.evaluations)
        yield Row(name, label, ladder.knob, value, str(sol.outcome), seconds, taken,
                  **achieved(sol, reference), estimate=float(sol.error), condition=float(sol.condition),
                  **drift(sol))  # fmt: skip
        before = value


def _timed(case: Case, options: Mapping[str, Any], cold: bool) -> tuple[Solution, float]:
    """The answer, and the least seconds of a few calls; where the first one is short or cold it is not counted."""
    sol, first = _once(case, options)
    if first > _ENOUGH and not cold:
        return sol, first
    again = [_once(case, options)[1]]
    while len(again) < REPEATS and sum(again) < _ENOUGH:
        again.append(_once(case, options)[1])
    return sol, min(again)


def _once(case: Case, options: Mapping[str, Any]) -> tuple[Solution, float]:
    begun = time.perf_counter()
    sol = solve(case, stations=STATIONS, **options)
    return sol, time.perf_counter() - begun


def achieved(sol: Solution, reference: Reference) -> dict[str, float]:
    """Errors of a single case whose stations hold the reference's, by their names in `Row`; inf where not finite."""
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
    """How far what must be constant along a single rod strays, by the names in `Row`; inf where not finite."""
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


def cheapest(rows: Iterable[Row], level: float) -> dict[str, Row | None]:
    """For each case the rung with the least seconds that was solved with an error of at most `level`, or None."""
    best: dict[str, Row | None] = {}
    for row in rows:
        here = best.setdefault(row.case, None)
        if row.outcome.startswith("solved") and row.error <= level and (here is None or row.seconds < here.seconds):
            best[row.case] = row
    return best
