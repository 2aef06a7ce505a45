"""`collocation`: scipy's solve_bvp, cubic splines that obey the equation at three points a step; ends problems.

Order 4 on a mesh that it refines where the residual is large. Its tolerance bounds that residual, not the error; so the
error is measured against a run at thirty times the tolerance, and the tolerance is tightened until the two agree.
Like `difference` it finds the solution next to its seed, or next to the one that the rule `choose` takes. Newton's own
stop keeps the error from falling much below 1e-11.
"""

import math
from typing import Any

import numpy as np
import scipy

from ..boundary.end_conditioning import response
from ..boundary.selected_equilibrium import selected_seed
from ..mechanics.potential import slope, slope_rate
from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from ..problem.trajectory import Seed, Trajectory, verdicts
from .base import Knob, Method

_FIRST, _MOST = (257, 2049), 10_000  # nodes: of the first mesh, and of the next where that was too coarse for the seed
_TIGHTEST, _LOOSEST = 3e-14, 1e-2
_GAUSS = np.polynomial.legendre.leggauss(5)


def run(
    problem: Reduced,
    t: Array,
    tol: float,
    rtol: float | None = None,
    nodes: int | None = None,
    seed: Seed | None = None,
    choose: str | int = "nearest",
    **_: Any,
) -> Trajectory:
    """Each problem by itself. `rtol` fixes scipy's own tolerance instead of seeking `tol`; nodes: of the first mesh."""
    taken, why = None, [""] * problem.size
    if seed is None:
        seed, taken, why = selected_seed(problem, choose)
    columns = np.full((5, problem.size, t.shape[1]), np.nan)
    error, condition = np.full(problem.size, np.inf), np.full(problem.size, np.inf)
    work, outcome = np.zeros(problem.size, dtype=np.int64), np.full(problem.size, "", dtype=object)
    for i in range(problem.size):
        one, near = problem.take(slice(i, i + 1)), seed.take(i)
        if np.isfinite(near.beta).all():
            columns[:, i], error[i], condition[i], work[i], outcome[i] = _one(one, t[i], tol, rtol, nodes, near)
        else:
            outcome[i] = why[i] or "failed: the seed is no shape"
    lost = outcome != ""
    outcome = np.where(lost, outcome, verdicts(columns[0], error, condition, tol))
    beta, dbeta, alpha, z, swirl = columns
    return Trajectory(beta, dbeta, alpha, z, lambda: swirl, outcome, error, condition, work, None, taken)


def _one(
    problem: Reduced, t: Array, tol: float, rtol: float | None, nodes: int | None, seed: Seed
) -> tuple[Array, float, float, int, str]:
    """Columns (5, n), error, condition, evaluations, and why it failed or nothing."""
    span, work = float(problem.span[0]), 0
    wanted = float(np.clip(0.1 * tol if rtol is None else rtol, _TIGHTEST, _LOOSEST))
    answer: Any = None
    for size in _FIRST if nodes is None else (nodes,):
        x = np.linspace(0, span, size)
        guess = seed.on(problem, size)
        answer, more = _collocated(problem, x, np.stack([guess, np.gradient(guess, x)]), 30 * wanted)
        work += more
        if answer.status == 0:
            break
    coarse = _columns(answer, t)
    while True:
        if answer.status == 0:
            answer, more = _collocated(problem, answer.x, answer.y, wanted)
            work += more
        if answer.status != 0:
            said = answer.message.rstrip(".").lower()
            return np.full((5, t.size), np.nan), math.inf, math.inf, work, f"failed: solve_bvp: {said}"
        fine = _columns(answer, t)
        off = np.abs(fine - coarse).max(axis=1)
        even = np.linspace(0, span, max(answer.x.size, 1025))
        condition = float(response(problem, even[1:2], answer.sol(even)[:1])[0])
        error = float(max(off[0], max(off[2], off[3]) / max(1.0, span))) + 1e-15 * condition
        if rtol is not None or error <= tol or wanted <= _TIGHTEST:
            return fine, error, condition, work, ""
        coarse, wanted = fine, max(_TIGHTEST, wanted / 30)


def _collocated(problem: Reduced, x: Array, y: Array, rtol: float) -> tuple[Any, int]:
    """scipy's answer from a first guess y (2, m) at x (m,), and at how many points it asked for the equation."""
    assert problem.betaL is not None
    first, last, points = problem.beta0[0], problem.betaL[0], 0

    def rates(x: Array, y: Array) -> Array:
        nonlocal points
        points += x.size
        return np.stack([y[1], -slope(problem, y[0])])

    def change(_: Array, y: Array) -> Array:
        jacobian = np.zeros((2, 2, y.shape[1]))
        jacobian[0, 1], jacobian[1, 0] = 1, -slope_rate(problem, y[0])
        return jacobian

    def ends(ya: Array, yb: Array) -> Array:
        return np.array([ya[0] - first, yb[0] - last])

    def ends_change(*_: Array) -> tuple[Array, Array]:
        return np.array([[1.0, 0.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])

    with np.errstate(all="ignore"):
        answer = scipy.integrate.solve_bvp(
            rates, ends, x, y, tol=rtol, max_nodes=_MOST, fun_jac=change, bc_jac=ends_change
        )
    return answer, points


def _columns(answer: Any, t: Array) -> Array:
    """beta, beta_t and (by Gauss's rule on each piece of the spline) alpha, z, swirl at the stations, (5, n)."""
    cuts = np.union1d(answer.x, t)
    half = np.diff(cuts)[:, None] / 2
    beta = answer.sol(cuts[:-1, None] + half * (1 + _GAUSS[0]))[0]
    s, c = np.sin(beta), np.cos(beta)
    sums = [np.append(0.0, np.cumsum((v * half) @ _GAUSS[1])) for v in (s, c, s * c)]
    at = np.searchsorted(cuts, t)
    return np.stack([*answer.sol(t), *(total[at] for total in sums)])


COLLOCATION = Method(
    "collocation",
    run,
    ("ends",),
    4,
    "collocation by cubic splines on a mesh of its own (scipy's solve_bvp)",
    {"rtol": Knob(float), "nodes": Knob(int, 5)},
)
