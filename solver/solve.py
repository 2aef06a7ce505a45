"""The one way from a case to its solution: reduce, run a method, label."""

from typing import Any

import numpy as np

from .case import Case
from .errors import InputError, no_such
from .methods import METHODS
from .reduced import Array, Reduced, flat, reduce
from .solution import Solution

AUTO = {"start": "orbit", "ends": "difference"}


def solve(case: Case, tol: float = 1e-8, method: str = "auto", stations: Any = 201, **knobs: Any) -> Solution:
    """The shape of a case, or of every case of a grid at once.

    tol: the error allowed, times max(1, condition): of beta [rad], and of alpha and z/rho over max(1, L/rho).
    method: "auto" or one of `METHODS`. stations: how many equal steps of s plus one, or the values of s [length],
    rising within [0, L], (n,) or (*cases, n). knobs: the method's own.

    Each case's `outcome` says whether it was solved; a case that was not leaves its neighbours alone.
    Raises `InputError` for a bad tolerance, method, knob or stations.
    """
    if not (np.isscalar(tol) and 0 < float(tol) < 1):
        raise InputError(f"tol must be a number between 0 and 1, got {tol!r}")
    problem = reduce(case)
    name = AUTO[problem.kind] if method == "auto" else method
    if name not in METHODS:
        raise no_such("method", name, ["auto", *METHODS])
    if problem.kind not in METHODS[name].kinds:
        able = ", ".join(m.name for m in METHODS.values() if problem.kind in m.kinds)
        given = type(case.given).__name__
        raise InputError(f"method {name!r} does not solve problems given by {given}; choose from {able}")
    t = _stations(case, problem, stations)
    return Solution(case, problem, METHODS[name].run(problem, t, float(tol), **knobs), t, name, float(tol))


def _stations(case: Case, problem: Reduced, stations: Any) -> Array:
    """The stations in units of rho, (B, n)."""
    if isinstance(stations, (int, np.integer)) and not isinstance(stations, bool):
        if not 2 <= stations <= 10_000_000:
            raise InputError(f"stations must be from 2 to 10000000, got {stations}")
        return problem.span[:, None] * np.linspace(0, 1, int(stations))
    try:
        s = np.asarray(stations, dtype=float)
        s = np.broadcast_to(s, (*case.shape, s.shape[-1])).reshape(problem.size, -1)
    except (TypeError, ValueError, IndexError):
        shape = f"(n,) or {(*case.shape, 'n')}"
        raise InputError(f"stations must be a number or values of s, {shape}, got {stations!r}") from None
    length = flat(case.rod.L, case.shape)[:, None]
    inside = np.isfinite(s) & (s >= 0) & (s <= length * (1 + 4e-16))
    if s.shape[1] < 1 or not inside.all() or (np.diff(s, axis=1) < 0).any():
        raise InputError(f"stations must rise within [0, L], L = {length.min()}, got {s.min()} to {s.max()}")
    return np.minimum(s / flat(case.rho, case.shape)[:, None], problem.span[:, None])
