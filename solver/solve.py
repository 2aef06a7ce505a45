"""The one way from a case to its solution: reduce, run a method, label."""

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from .boundary.selection import NEAREST, checked
from .core.loader import INSTALLED
from .numerics.arrays import Array
from .problem.case import Case
from .problem.errors import InputError, choices, no_such
from .problem.limits import OUT_OF_RANGE, TOO_LARGE, dimensionless, representable, units_held
from .problem.reduced import Reduced, flat, reduce
from .problem.trajectory import Seed, Trajectory, blanked, stood_in
from .solution import Solution

if TYPE_CHECKING:
    from .methods import Method

AUTO = {"start": "swing" if INSTALLED else "orbit", "ends": "shooting"}  # as measured: docs/reference/trade.md


def solve(
    case: Case,
    tol: float = 1e-8,
    method: str = "auto",
    stations: Any = 201,
    seed: Any = None,
    choose: str | int = NEAREST,
    **knobs: Any,
) -> Solution:
    """The shape of a case, or of every case of a grid at once.

    tol: the error allowed, times max(1, condition): of beta [rad], and of alpha and z/rho over max(1, L/rho).
    method: "auto" or one of `METHODS`. stations: how many equal steps of s plus one, or the values of s [length],
    rising within [0, L], (n,) or (*cases, n). seed: for an ends problem, which of its many solutions: the one with
    beta'(0) [rad/length] near the seed, or near a Solution. choose: without a seed, which of them: "nearest", of the
    stable ones the one whose beta strays least from between its end angles (where none is stable, of all); "lowest",
    the one of lowest energy; or K, of those of Morse index K the one that strays least. `selection` of the answer says
    how many there are. knobs: the method's own.

    Each case's `outcome` says whether it was solved; a case that was not leaves its neighbours alone.
    Raises `InputError` for a bad tolerance, method, knob, rule or stations.
    """
    from .methods import METHODS, MISSING  # only a call of `solve` loads the methods

    tol = _tolerance(tol)
    problem = reduce(case)
    name = AUTO[problem.kind] if method == "auto" else method
    if name in MISSING and name not in METHODS:
        raise InputError(MISSING[name])
    if name not in METHODS:
        raise no_such("method", name, ["auto", *METHODS])
    if problem.kind not in METHODS[name].kinds:
        able = ", ".join(m.name for m in METHODS.values() if problem.kind in m.kinds)
        given = type(case.given).__name__
        raise InputError(f"method {name!r} does not solve problems given by {given}; choose from {able}")
    t = _stations(case, problem, stations)
    for knob, value in knobs.items():
        _check_knob(METHODS[name], knob, value)
    choose = checked(choose)
    if problem.kind == "start" and (seed is not None or choose != NEAREST):
        word = f"choose = {choose!r}" if seed is None else "a seed"
        raise InputError(f"{word} chooses among the solutions of an ends problem; a start problem has only one")
    if seed is not None:
        if choose != NEAREST:
            raise InputError(f"a seed and choose = {choose!r} exclude each other: each names an equilibrium")
        knobs["seed"] = _seed(case, problem, seed)
    elif problem.kind == "ends":
        knobs["choose"] = choose
    return Solution(case, problem, _run(case, problem, METHODS[name], t, tol, knobs), t, name, tol)


def _run(case: Case, problem: Reduced, method: "Method", t: Array, tol: float, knobs: dict[str, Any]) -> Trajectory:
    """The method's answer; cases whose numbers no float can hold are refused by their outcome."""
    from .methods.blocks import run_in_blocks

    held, finite = representable(case, problem), dimensionless(problem)
    fit = held & finite
    if not fit.all():
        t = np.where(fit[:, None], t, np.linspace(0, 1, t.shape[1]))
    run = method.run if problem.kind == "ends" else partial(run_in_blocks, method)
    told = run(stood_in(problem, fit), t, tol, **knobs)
    if problem.kind == "ends":  # only now is beta'(0) known
        slope = np.where(np.isfinite(told.dbeta[:, 0]), told.dbeta[:, 0], 0.0)
        held &= ~fit | representable(case, problem.started(slope))
    for fine, why in ((held, OUT_OF_RANGE), (finite, TOO_LARGE), (units_held(case), OUT_OF_RANGE)):
        told = blanked(told, fine, why)
    return told


def _check_knob(method: "Method", knob: str, value: Any) -> None:
    if knob not in method.knobs:
        known = choices(method.knobs) or "none"
        raise InputError(f"no knob {knob!r} in method {method.name!r}; its knobs: {known}")
    if value is not None and not method.knobs[knob].accepts(value):
        raise InputError(f"{knob} must be {method.knobs[knob].rule}, got {value!r}")


def _tolerance(tol: Any) -> float:
    try:
        value = float(tol)
    except (TypeError, ValueError):
        value = np.nan
    if not 0 < value < 1:
        raise InputError(f"tol must be a number between 0 and 1, got {tol!r}")
    return value


def _stations(case: Case, problem: Reduced, stations: Any) -> Array:
    """The stations in units of rho, (B, n)."""
    if isinstance(stations, (int, np.integer)) and not isinstance(stations, bool):
        if not 2 <= stations <= 10_000_000:
            raise InputError(f"stations must be from 2 to 10000000, got {stations}")
        with np.errstate(invalid="ignore", over="ignore"):  # a span that no float holds is refused by its outcome
            return problem.span[:, None] * np.linspace(0, 1, int(stations))
    try:
        s = np.asarray(stations, dtype=float)
        s = np.broadcast_to(s, (*case.shape, s.shape[-1])).reshape(problem.size, -1)
    except (TypeError, ValueError, IndexError):
        shape = f"(n,) or {(*case.shape, 'n')}"
        raise InputError(f"stations must be a number or values of s, {shape}, got {stations!r}") from None
    length = flat(case.rod.L, case.shape)[:, None]
    if not s.size:
        raise InputError("stations is empty; give at least one value of s, or how many there should be")
    inside = np.isfinite(s) & (s >= 0) & (s <= length * (1 + 4e-16))
    if not inside.all() or (np.diff(s, axis=1) < 0).any():
        raise InputError(f"stations must rise within [0, L], L = {length.min()}, got {s.min()} to {s.max()}")
    with np.errstate(all="ignore"):
        return np.minimum(s / flat(case.rho, case.shape)[:, None], problem.span[:, None])


def _seed(case: Case, problem: Reduced, seed: Any) -> Seed:
    """A seed in units of rho, from beta'(0) [rad/length] or from a solution near the one wanted."""
    if isinstance(seed, Solution):
        if seed.case.shape not in ((), case.shape):
            raise InputError(f"the seed's cases have shape {seed.case.shape}, these {case.shape or '()'}")
        told = seed.trajectory
        row = np.arange(problem.size) if seed.case.shape else np.zeros(problem.size, dtype=np.int64)
        own = _between_ends(seed).take(row)
        u = seed.t / seed.problem.span[:, None]
        return Seed(told.dbeta[row, 0], u[row], told.beta[row], own, told.orbit, row)
    try:
        with np.errstate(over="ignore"):
            slope = flat(np.asarray(seed, dtype=float) * case.rho, case.shape)
    except (TypeError, ValueError):
        raise InputError(f"seed must be beta'(0) or a Solution, got {seed!r}") from None
    from .methods import METHODS

    start = problem.started(slope)
    u = np.linspace(0, 1, 2001)
    beta = METHODS["orbit"].run(start, start.span[:, None] * u, 1e-8).beta
    return Seed(slope, np.tile(u, (problem.size, 1)), beta)


def _between_ends(sol: Solution) -> Reduced:
    """The ends problems that a solution solves; of a start problem, by the far angles that came out."""
    problem, told = sol.problem, sol.trajectory
    if problem.betaL is not None:
        return problem
    far = told.beta[:, -1] if told.orbit is None else told.orbit.at(problem.span[:, None])[0][:, 0]
    return replace(problem, dbeta0=None, betaL=far)
