"""`difference`: the paper's own scheme for a rod given by its two ends.

Central differences (40), Newton's rule on the tridiagonal system (43), and the extrapolation (47): order 2, then 4.
Newton's rule finds the solution next to its seed; without one it starts from the one that the rule `choose` takes.
"""

from dataclasses import dataclass
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

_FIRST, _LARGEST_FIRST, _MOST = 129, 2**13 + 1, 2**17 + 1  # nodes
_FEWEST = 17  # nodes of a mesh that may measure another's error
_FINE = 0.1  # of `_waves`: from there on each halving brings what order 4 promises
_NEWTON = 60


@dataclass(frozen=True, eq=False)
class _Mesh:
    """A difference solution of one problem on equal steps: columns beta, beta_t, alpha, z, swirl, (5, n); whether
    Newton's rule met it; and how much of a step's square its next step was, the same on every mesh."""

    columns: Array
    met: bool
    iterations: int
    bend: float


def run(
    problem: Reduced,
    t: Array,
    tol: float,
    nodes: int | None = None,
    extrapolate: bool = True,
    seed: Seed | None = None,
    choose: str | int = "nearest",
    **_: Any,
) -> Trajectory:
    """Each problem by itself. `nodes` fixes the coarse mesh; without it the mesh is halved until two answers agree.

    With `nodes` the error is measured on a mesh of half as many where these are odd, else of twice as many.

    seed: near which solution to look; see `Seed`.
    """
    taken, why = None, [""] * problem.size
    if seed is None:
        seed, taken, why = selected_seed(problem, choose)
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
    for i in range(problem.size):
        outcome[i] = why[i] or outcome[i]
    beta, dbeta, alpha, z, swirl = columns
    return Trajectory(beta, dbeta, alpha, z, lambda: swirl, outcome, error, condition, work, None, taken)


def _one(
    problem: Reduced, t: Array, tol: float, nodes: int | None, extrapolate: bool, seed: Seed, halves: bool = True
) -> tuple[Array, float, float, int, bool]:
    """Columns (5, n), error, condition, work, and whether Newton's rule met; `halves`: a coarser mesh may be used."""
    span, most = float(problem.span[0]), _MOST if nodes is None else 0
    halved = halves and nodes is not None and extrapolate and nodes % 2 == 1 and nodes >= 2 * _FEWEST
    mesh, work = _first(problem, seed, (nodes + 1) // 2 if nodes is not None and halved else nodes)
    guess = _refined(mesh.columns[0])
    answers: list[Array] = []
    error = apart = np.inf
    while True:
        finer = _newton(problem, guess, mesh.bend, 1e-3 * tol if nodes is None else 1e-13)
        work += finer.iterations * finer.columns.shape[1]
        if not (mesh.met and finer.met):
            if halved:
                return _one(problem, t, tol, nodes, extrapolate, seed, halves=False)
            return np.full((5, t.size), np.nan), np.inf, np.inf, work, False
        answers.append((4 * finer.columns[:, ::2] - mesh.columns) / 3 if extrapolate else mesh.columns)
        if len(answers) > 1:
            before, apart = apart, _difference(answers[-2], answers[-1][:, ::2], span)
            if nodes is None:
                converges = apart < before / (8 if extrapolate else 3)
            else:
                converges = halved and _waves(problem, mesh.columns[0]) < _FINE
            # the finer answer is better than the two agree: by 15 at order 4, by 3 at order 2
            error = apart / (8 if extrapolate else 2) if converges else apart
            if error <= tol or 2 * finer.columns.shape[1] > most:
                break
        # what halving changed once more, less its four-fold: order 2
        guess = _refined(finer.columns[0]) + _refined(_refined(finer.columns[0, ::2] - mesh.columns[0])) / 4
        mesh = finer
    shown = answers[-1] if nodes is None or halved else answers[-2]
    h = np.array([span / (shown.shape[1] - 1)])
    if _waves(problem, shown[0]) > 1:
        error = max(error, np.pi)  # fewer than six nodes a swing: both meshes see the same false, slower wave
    condition = float(response(problem, h, shown[:1])[0])
    return _read(problem, shown, t), error + 4e-16 * condition, condition, work, True


def _waves(problem: Reduced, beta: Array) -> float:
    """h^2 |H'| at its largest: 1 is six nodes to the quickest wave, 0.1 twenty."""
    h = problem.span[0] / (beta.size - 1)
    return float(h * h * np.abs(slope_rate(problem, beta)).max())


def _first(problem: Reduced, seed: Seed, nodes: int | None) -> tuple[_Mesh, int]:
    """The coarsest mesh on which Newton's rule finds the seed's solution, and the work; the one asked for, if any."""
    size, work = nodes or _FIRST, 0
    while True:
        mesh = _newton(problem, seed.on(problem, size))
        work += mesh.iterations * size
        if mesh.met or nodes is not None or 2 * size > _LARGEST_FIRST:
            return mesh, work
        size = 2 * size - 1


def _newton(problem: Reduced, beta: Array, bend: float = np.inf, goal: float = 1e-13) -> _Mesh:
    """Solve beta'' = -H on equal steps from a first guess (n,), its ends moved to the right ones.

    Done when the step after the last would be below `goal`: a step is `bend` times the square of the one before.
    """
    assert problem.betaL is not None
    h = float(problem.span[0]) / (beta.size - 1)
    one = _numbers(problem)
    beta = beta.copy()
    beta[0], beta[-1] = problem.beta0[0], problem.betaL[0]
    floor = 16 * 2.0**-52 * np.abs(beta).max() + 1e-300  # what rounding leaves of the residual, which is times h^2
    (off, rate), met, iteration, last = _residual(one, beta, h), False, 0, np.inf
    while iteration < _NEWTON and not met:
        iteration += 1
        step = _step(rate, off, h)
        if step is None:
            break
        size, length = np.abs(off).max(), np.abs(step).max()
        share = min(1.0, 1.0 / max(length, 1e-300))
        if bend < np.inf and length < last and length * length * bend <= goal:
            beta[1:-1] += step
            met = True
            break
        for _ in range(14):
            tried = beta.copy()
            tried[1:-1] += share * step
            left, steep = _residual(one, tried, h)
            if np.abs(left).max() < max(size, floor):
                break
            share /= 2
        else:
            met = size <= 4 * floor  # no step helps: rounding, or lost
            break
        beta, off, rate = tried, left, steep
        if last < 0.1:  # near enough for the rule's own pace to show; where rounding rules, steps stop shrinking
            bend = length / last**2 if bend == np.inf else max(bend, length / last**2)
        stale = np.abs(off).max() <= floor and length > last / 2
        met, last = share == 1.0 and bool(length <= 1e-8 or stale), length
    return _Mesh(_columns(problem, beta, h), met, iteration, bend)


@dataclass(frozen=True)
class _Numbers:
    """The loads of one problem."""

    lam: float
    mu: float
    phi: float


def _numbers(problem: Reduced) -> _Numbers:
    return _Numbers(float(problem.lam[0]), float(problem.mu[0]), float(problem.phi[0]))


def _pull(one: _Numbers, s: Array, c: Array) -> tuple[Array, Array]:
    """H and H' by the sine and cosine of beta, in few operations: next to the axis h^2 hides their rounding."""
    s2, twice = s * s, (2 * one.mu) * c
    pull = (one.lam - twice) * c + one.mu - (one.phi + 2 * c * s2) * s
    rate = (2 * twice - one.lam) * s - one.phi * c - s2 * (6 - 8 * s2)
    return pull, rate


def _residual(one: _Numbers, beta: Array, h: float) -> tuple[Array, Array]:
    """h^2 times what eq. (41) leaves at the inner nodes, and H' there."""
    pull, rate = _pull(one, np.sin(beta[1:-1]), np.cos(beta[1:-1]))
    rise = beta[1:] - beta[:-1]  # between neighbours, and so exact
    return rise[1:] - rise[:-1] + h * h * pull, rate


def _step(rate: Array, off: Array, h: float) -> Array | None:
    """Newton's step from the tridiagonal system (43); None where it is singular."""
    beside = np.ones(off.size - 1)
    solve = scipy.linalg.lapack.dgtsv
    step, info = solve(beside, h * h * rate - 2, beside.copy(), -off, overwrite_d=1, overwrite_b=1)[3:]
    return step if info == 0 and np.isfinite(step).all() else None


def _columns(problem: Reduced, beta: Array, h: float) -> Array:
    """beta, beta_t, alpha, z, swirl at the nodes, each with an error that has only even powers of h, (5, n)."""
    pull = slope(problem, beta[[0, -1]])
    out = np.zeros((5, beta.size))
    out[0] = beta
    out[1, 1:-1] = (beta[2:] - beta[:-2]) / (2 * h)
    out[1, 0] = (beta[1] - beta[0]) / h + h / 2 * pull[0]
    out[1, -1] = (beta[-1] - beta[-2]) / h - h / 2 * pull[1]
    s, c = np.sin(beta), np.cos(beta)
    for row, v in zip(out[2:], (s, c, s * c), strict=True):
        np.cumsum((v[1:] + v[:-1]) * (h / 2), out=row[1:])
    return out


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
    """The columns at the stations, (5, k): polynomials of degree five through values and two derivatives at nodes."""
    h = problem.span[0] / (columns.shape[1] - 1)
    k = np.clip(np.rint(t / h).astype(int), 0, columns.shape[1] - 1)
    k = np.where(np.abs(t - k * h) <= 1e-12 * problem.span[0], k, np.minimum((t / h).astype(int), columns.shape[1] - 2))
    x = t / h - k
    far = np.minimum(k + 1, columns.shape[1] - 1)
    y0, y1 = columns[:, k], columns[:, far]
    first, second = _slopes(problem, np.concatenate([y0, y1], axis=1), h)
    (d0, d1), (e0, e1) = np.split(first, 2, axis=1), np.split(second, 2, axis=1)
    # Hermite's quintic, in powers of x about the near node
    jump, climb, curve = y1 - y0 - d0 - e0 / 2, d1 - d0 - e0, e1 - e0
    c3, c4, c5 = (
        10 * jump - 4 * climb + curve / 2,
        -15 * jump + 7 * climb - curve,
        6 * jump - 3 * climb + curve / 2,
    )
    return y0 + x * (d0 + x * (e0 / 2 + x * (c3 + x * (c4 + x * c5))))


def _slopes(problem: Reduced, columns: Array, h: float) -> tuple[Array, Array]:
    """h times the first and h^2 times the second derivative of the columns at some nodes."""
    beta, rate = columns[:2]
    s, c = np.sin(beta), np.cos(beta)
    pull, steep = _pull(_numbers(problem), s, c)
    first = np.stack([rate, -pull, s, c, s * c])
    second = np.stack([-pull, -steep * rate, c * rate, -s * rate, (c - s) * (c + s) * rate])
    return h * first, h * h * second


DIFFERENCE = Method(
    "difference",
    run,
    ("ends",),
    4,
    "the paper's scheme: central differences, Newton, extrapolation; order 2, then 4",
    {"nodes": Knob(int, 5), "extrapolate": Knob(bool)},
)
