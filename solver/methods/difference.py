"""`difference`: the paper's own scheme for a rod given by its two ends.

Central differences (40), Newton's rule on the tridiagonal system (43), and the extrapolation (47). Order 2, extrapolated
4. Newton's rule finds the solution next to its seed: without one it starts from the equilibrium of lowest energy.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import solve_banded

from ..landscape import slope, slope_rate
from ..reduced import Array, Reduced
from ..stability import response
from .base import Method, Seed, Trajectory, verdicts

_FIRST, _MOST = 129, 2**17 + 1  # nodes
_NEWTON = 60


@dataclass(frozen=True, eq=False)
class _Mesh:
    """A converged difference solution of one problem on equal steps: columns beta, beta_t, alpha, z, swirl, (5, n)."""

    h: float
    columns: Array
    met: bool
    iterations: int


def run(
    problem: Reduced,
    t: Array,
    tol: float,
    nodes: int | None = None,
    extrapolate: bool = True,
    seed: Seed | None = None,
    **_: Any,
) -> Trajectory:
    """Each problem by itself. `nodes` fixes the coarse mesh; without it the mesh is halved until two answers agree.

    seed: near which solution to look; see `Seed`.
    """
    if seed is None:
        from ..equilibria import lowest  # the search stands above the methods; it is asked only where nothing is given

        seed = lowest(problem)
    n = t.shape[1]
    columns = np.full((5, problem.size, n), np.nan)
    error, condition = np.full(problem.size, np.inf), np.full(problem.size, np.inf)
    work, missed = np.zeros(problem.size, dtype=np.int64), np.zeros(problem.size, dtype=bool)
    for i in range(problem.size):
        one = problem.take(slice(i, i + 1))
        columns[:, i], error[i], condition[i], work[i], met = _one(one, t[i], tol, nodes, extrapolate, seed.take(i))
        missed[i] = not met
    outcome = verdicts(columns[0], error, condition, tol)
    outcome[missed] = "failed: Newton's rule found no solution of the difference equation near the seed"
    beta, dbeta, alpha, z, swirl = columns
    return Trajectory(beta, dbeta, alpha, z, lambda: swirl, outcome, error, condition, work)


def _one(
    problem: Reduced, t: Array, tol: float, nodes: int | None, extrapolate: bool, seed: Seed
) -> tuple[Array, float, float, int, bool]:
    span = float(problem.span[0])
    size = _FIRST if nodes is None else nodes
    fixed = nodes is not None
    meshes = [_newton(problem, seed.on(problem, size))]
    answers: list[Array] = []
    while True:
        meshes.append(_newton(problem, _refined(meshes[-1].columns[0])))
        work = sum(m.iterations * m.columns.shape[1] for m in meshes)
        if not (meshes[-1].met and meshes[-2].met):
            return np.full((5, t.size), np.nan), np.inf, np.inf, work, False
        coarse, fine = meshes[-2].columns, meshes[-1].columns[:, ::2]
        if extrapolate:
            answers.append((4 * fine - coarse) / 3)
        else:
            answers.append(coarse)
        after = 2 if extrapolate else 1
        error = np.inf
        if len(answers) >= 2:
            error = _difference(answers[-2], answers[-1][:, ::2], span)
            shown = answers[-2] if fixed else answers[-1]
            if fixed or error <= tol or (answers[-1].shape[1] - 1) * 2**after > _MOST:
                break
    h = np.array([span / (shown.shape[1] - 1)])
    condition = float(response(problem, h, shown[:1])[0])
    error += 4e-16 * condition
    return _read(problem, shown, t), error, condition, work, True


def _newton(problem: Reduced, beta: Array) -> _Mesh:
    """Solve beta'' = -H on equal steps from a first guess (n,) that holds the right ends."""
    h = float(problem.span[0]) / (beta.size - 1)
    beta = beta.copy()
    assert problem.betaL is not None
    beta[0], beta[-1] = problem.beta0[0], problem.betaL[0]
    floor = 16 * 2.0**-52 * np.abs(beta).max() + 1e-300  # what rounding leaves of the residual times h^2

    def residual(at: Array) -> Array:
        return np.diff(at, 2) + h * h * slope(problem, at[1:-1])

    off = residual(beta)
    met = False
    bands = np.ones((3, beta.size - 2))
    for iteration in range(1, _NEWTON + 1):
        bands[1] = -2 + h * h * slope_rate(problem, beta[1:-1])
        with np.errstate(all="ignore"):
            try:
                step = solve_banded((1, 1), bands, -off)
            except (np.linalg.LinAlgError, ValueError):
                break
        if not np.isfinite(step).all():
            break
        share, size = min(1.0, 1.0 / max(np.abs(step).max(), 1e-300)), np.abs(off).max()
        while share > 1e-4:
            tried = beta.copy()
            tried[1:-1] += share * step
            off_tried = residual(tried)
            if np.abs(off_tried).max() < size or np.abs(off_tried).max() <= floor:
                break
            share /= 2
        else:
            met = size <= 4 * floor
            break
        beta, off = tried, off_tried
        if share == 1.0 and (np.abs(step).max() <= 1e-9 or np.abs(off).max() <= floor):
            met = True  # the step after this one would be its square, or rounding
            break
    return _Mesh(h, _columns(problem, beta, h), met, iteration)


def _columns(problem: Reduced, beta: Array, h: float) -> Array:
    """beta, beta_t, alpha, z, swirl at the nodes, each with an error that has only even powers of h, (5, n)."""
    pull = slope(problem, beta)
    rate = np.empty_like(beta)
    rate[1:-1] = (beta[2:] - beta[:-2]) / (2 * h)
    rate[0] = (beta[1] - beta[0]) / h + h / 2 * pull[0]
    rate[-1] = (beta[-1] - beta[-2]) / h - h / 2 * pull[-1]
    s, c = np.sin(beta), np.cos(beta)
    sums = [np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) * (h / 2))]) for v in (s, c, s * c)]
    return np.stack([beta, rate, *sums])


def _refined(beta: Array) -> Array:
    """A guess on twice as many steps, by cubics through four neighbours."""
    fine = np.empty(2 * beta.size - 1)
    fine[::2] = beta
    inner = (-beta[:-3] + 9 * beta[1:-2] + 9 * beta[2:-1] - beta[3:]) / 16
    fine[3:-3:2] = inner
    fine[1] = (3 * beta[0] + 6 * beta[1] - beta[2]) / 8
    fine[-2] = (3 * beta[-1] + 6 * beta[-2] - beta[-3]) / 8
    return fine


def _difference(coarse: Array, fine: Array, span: float) -> float:
    off = np.abs(coarse - fine).max(axis=1)
    return float(max(off[0], max(off[2], off[3]) / max(1, span)))


def _read(problem: Reduced, columns: Array, t: Array) -> Array:
    """The columns at the stations: polynomials of degree five through values and two derivatives at the nodes, (5, k)."""
    beta, rate = columns[:2]
    h = problem.span[0] / (beta.size - 1)
    pull = slope(problem, beta)
    s, c = np.sin(beta), np.cos(beta)
    first = np.stack([rate, -pull, s, c, s * c])
    second = np.stack([-pull, -slope_rate(problem, beta) * rate, c * rate, -s * rate, (c - s) * (c + s) * rate])
    k = np.clip(np.rint(t / h).astype(int), 0, beta.size - 1)
    k = np.where(np.abs(t - k * h) <= 1e-12 * problem.span[0], k, np.minimum((t / h).astype(int), beta.size - 2))
    x = t / h - k
    far = np.minimum(k + 1, beta.size - 1)
    y0, y1 = columns[:, k], columns[:, far]
    d0, d1, e0, e1 = h * first[:, k], h * first[:, far], h * h * second[:, k], h * h * second[:, far]
    # Hermite's quintic, in powers of x about the near node
    jump, climb, curve = y1 - y0 - d0 - e0 / 2, d1 - d0 - e0, e1 - e0
    c3, c4, c5 = 10 * jump - 4 * climb + curve / 2, -15 * jump + 7 * climb - curve, 6 * jump - 3 * climb + curve / 2
    return y0 + x * (d0 + x * (e0 / 2 + x * (c3 + x * (c4 + x * c5))))


DIFFERENCE = Method(
    "difference", run, ("ends",), 4, "nodes", "the paper's scheme: central differences, Newton, extrapolation; order 2, then 4", ("nodes", "extrapolate"))
