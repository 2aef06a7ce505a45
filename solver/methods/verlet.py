"""`verlet`: the paper's central difference equation (41), marched from the start, with its extrapolation (47).

beta_{k+1} - 2 beta_k + beta_{k-1} = -h^2 H(beta_k): Stoermer's rule, written in the summed (velocity) form that keeps
rounding from growing with 1/h^2. Symplectic; order 2, order 4 once (4 y_{h/2} - y_h)/3 is taken. alpha, z and the swirl
by the trapezoidal rule on the same points, whose error has the same expansion in h^2.
"""

from itertools import pairwise
from typing import Any

import numpy as np

from ..growth import growth
from ..landscape import slope
from ..reduced import Array, Reduced
from .base import Knob, Method, Trajectory, verdicts

_MOST_STEPS = 2**17


def run(
    problem: Reduced, t: Array, tol: float, steps: int | None = None, extrapolate: bool = True, **_: Any
) -> Trajectory:
    """March all problems at once, with `steps` equal steps between neighbouring stations.

    Without `steps` the number is doubled until two answers agree to `tol` or 2^17 steps in all are reached.
    """
    intervals = max(1, t.shape[1] - 1)
    if steps is not None:
        marches = [
            _march(problem, t, n) for n in ((steps, 2 * steps, 4 * steps) if extrapolate else (steps, 2 * steps))
        ]
        answers = [_extrapolated(a, b) for a, b in pairwise(marches)] if extrapolate else marches
        work = intervals * steps * (3 if extrapolate else 1)
        return _trajectory(problem, t, tol, answers[0], np.abs(answers[0] - answers[1]), work)
    steps, work, marches, answers = 1, 0, [], []
    while True:
        marches.append(_march(problem, t, steps))
        work += intervals * steps
        if extrapolate and len(marches) > 1:
            answers.append(_extrapolated(*marches[-2:]))
        elif not extrapolate:
            answers.append(marches[-1])
        if len(answers) > 1:
            off = np.abs(answers[-1] - answers[-2])
            if _error(t, off).max(initial=0.0) <= tol or 2 * steps * intervals > _MOST_STEPS:
                return _trajectory(problem, t, tol, answers[-1], off, work)
        steps *= 2


def _march(problem: Reduced, t: Array, steps: int) -> Array:
    """beta, beta_t, alpha, z, swirl at the stations, (5, B, n)."""
    assert problem.dbeta0 is not None
    out = np.empty((5, *t.shape))
    beta, v = problem.beta0.copy(), problem.dbeta0.copy()
    alpha, z, swirl = (np.zeros(problem.size) for _ in range(3))
    with np.errstate(over="ignore", invalid="ignore"):
        kick, s, c = slope(problem, beta), np.sin(beta), np.cos(beta)
        gap = np.diff(t, axis=1, prepend=0.0) / steps  # the first interval is empty where t begins at 0
        for k in range(t.shape[1]):
            h = gap[:, k]
            for _ in range(steps if h.any() else 0):
                v = v - h / 2 * kick
                beta = beta + h * v
                kick, s_new, c_new = slope(problem, beta), np.sin(beta), np.cos(beta)
                v = v - h / 2 * kick
                alpha, z = alpha + h / 2 * (s + s_new), z + h / 2 * (c + c_new)
                swirl = swirl + h / 2 * (s * c + s_new * c_new)
                s, c = s_new, c_new
            out[:, :, k] = beta, v, alpha, z, swirl
    return out


def _extrapolated(coarse: Array, fine: Array) -> Array:
    """Eq. (47)."""
    return (4 * fine - coarse) / 3


def _error(t: Array, off: Array) -> Array:
    """Error measure of a difference of two answers, (B,): beta, and alpha and z over max(1, t)."""
    reach = np.maximum(1, t[:, -1:])
    return np.nan_to_num(np.max(np.maximum(off[0], np.maximum(off[2], off[3]) / reach), axis=1), nan=np.inf)


def _trajectory(problem: Reduced, t: Array, tol: float, answer: Array, off: Array, work: int) -> Trajectory:
    beta, dbeta, alpha, z, swirl = answer
    condition = growth(problem, t, beta)
    error = _error(t, off) + 2e-16 * np.sqrt(work) * condition
    evaluations = np.full(problem.size, work, dtype=np.int64)
    outcome = verdicts(beta, error, condition, tol)
    return Trajectory(beta, dbeta, alpha, z, lambda: swirl, outcome, error, condition, evaluations)


VERLET = Method(
    "verlet",
    run,
    ("start",),
    4,
    "the paper's difference equation marched; order 2, extrapolated 4",
    {"steps": Knob(int, 1), "extrapolate": Knob(bool)},
)
