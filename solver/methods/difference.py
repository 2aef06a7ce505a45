"""`difference`: the paper's own scheme for an ends problem.

Central differences (40), Newton's rule on the tridiagonal system (43), and the extrapolation (47): order 2, then 4.
Newton's rule finds the solution near its seed; without a seed, near the equilibrium that the rule `choose` selects.
"""

from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import EPS, Array
from ..numerics.roots import ROUNDS
from ..orbits.mesh_index import response
from ..orbits.potential import Loads, slope, slope_rate
from ..problem.dimensionless import EndsProblem
from ..problem.trajectory import Seed
from .method import MOST_COMPILED, Ladder, SeededMethod, SingleAnswer, knob, largest, twos

# nodes; coarser first meshes lose seeds. x10: 1.5 to 1.9 times the time, and the digits of other meshes
_FIRST, _LARGEST_FIRST, _MOST = 129, 2**13 + 1, 2**17 + 1
# nodes of the coarsest mesh that may measure the error of another: below, halving shows no order. x10: fewer answers
# state an error
_FEWEST = 17
# of `_waves`: on finer meshes each halving reduces the error as order 4 says. x10: stated errors that are too small
_FINE = 0.1
_NODES = tuple(n + 1 for n in twos(9, 64))


@dataclass(frozen=True)
class Difference(SeededMethod):
    """The paper's scheme for an ends problem.

    nodes: of the coarse mesh; default: the mesh is halved until two answers agree. With `nodes` the error is measured
    on a mesh of half as many if they are odd, else of twice as many. extrapolate: whether Richardson's combination (47)
    is taken, which raises the order from 2 to 4.
    """

    name = "difference"
    summary = "the paper's scheme: central differences, Newton, extrapolation; order 2, then 4"
    order = 4
    ladders = (
        Ladder("difference", "nodes", _NODES, "#989000", "d", fixed={"extrapolate": False}, most=MOST_COMPILED),
        Ladder(
            "difference", "nodes", _NODES, "#5c5a00", "*", "--", label="difference extrapolated", most=MOST_COMPILED
        ),
    )

    nodes: int | None = knob(int, least=5)
    extrapolate: bool = knob(bool, default=True)

    def solve_one(self, problem: EndsProblem, t: Array, tol: float, seed: Seed) -> SingleAnswer:
        return _solve_one(problem, t, tol, self.nodes, self.extrapolate, seed)


@dataclass(frozen=True, eq=False)
class _Mesh:
    """A difference solution of one problem on equal steps.

    columns: beta, beta_t, alpha, z, swirl, (5, n). met: whether Newton's rule converged. bend: a Newton step over the
    square of the step before, which is the same on every mesh.
    """

    columns: Array
    met: bool
    iterations: int
    bend: float


def _solve_one(
    problem: EndsProblem, t: Array, tol: float, nodes: int | None, extrapolate: bool, seed: Seed, halves: bool = True
) -> SingleAnswer:
    """Columns (5, n), error, condition, work, and that Newton's rule did not converge, or an empty text.

    halves: whether a coarser mesh may be used.
    """
    span, most = float(problem.span[0]), _MOST if nodes is None else 0
    halved = halves and nodes is not None and extrapolate and nodes % 2 == 1 and nodes >= 2 * _FEWEST
    mesh, work = _first(problem, seed, (nodes + 1) // 2 if nodes is not None and halved else nodes)
    guess = _refine(mesh.columns[0])
    answers: list[Array] = []
    error = apart = np.inf
    while True:
        finer = _newton(problem, guess, mesh.bend, 1e-3 * tol if nodes is None else 1e-13)
        work += finer.iterations * finer.columns.shape[1]
        if not (mesh.met and finer.met):
            if halved:
                return _solve_one(problem, t, tol, nodes, extrapolate, seed, halves=False)
            why = "failed: Newton's rule found no solution of the difference equation near the seed"
            return np.full((5, t.size), np.nan), np.inf, np.inf, work, why
        answers.append((4 * finer.columns[:, ::2] - mesh.columns) / 3 if extrapolate else mesh.columns)
        if len(answers) > 1:
            before, apart = apart, float(largest(np.abs(answers[-2] - answers[-1][:, ::2]), span))
            if nodes is None:
                converges = apart < before / (8 if extrapolate else 3)
            else:
                converges = halved and _waves(problem, mesh.columns[0]) < _FINE
            # the error of the finer answer is below the difference: by 15 at order 4, by 3 at order 2
            error = apart / (8 if extrapolate else 2) if converges else apart
            if error <= tol or 2 * finer.columns.shape[1] > most:
                break
        # plus a quarter of the last change, as order 2 predicts
        guess = _refine(finer.columns[0]) + _refine(_refine(finer.columns[0, ::2] - mesh.columns[0])) / 4
        mesh = finer
    shown = answers[-1] if nodes is None or halved else answers[-2]
    h = np.array([span / (shown.shape[1] - 1)])
    if _waves(problem, shown[0]) > 1:
        error = max(error, np.pi)  # fewer than six nodes a swing: both meshes see the same false, slower wave
    condition = float(response(problem, h, shown[:1])[0])
    return _read(problem, shown, t), error + 4e-16 * condition, condition, work, ""


def _waves(problem: EndsProblem, beta: Array) -> float:
    """The largest h^2 |H'|: 1 means six nodes in the shortest wave, 0.1 twenty."""
    h = problem.span[0] / (beta.size - 1)
    return float(h * h * np.abs(slope_rate(problem, beta)).max())


def _first(problem: EndsProblem, seed: Seed, nodes: int | None) -> tuple[_Mesh, int]:
    """The mesh of `nodes`, default: the coarsest on which Newton's rule finds the seed's solution; and the work."""
    size, work = nodes or _FIRST, 0
    while True:
        mesh = _newton(problem, seed.on(problem, size))
        work += mesh.iterations * size
        if mesh.met or nodes is not None or 2 * size > _LARGEST_FIRST:
            return mesh, work
        size = 2 * size - 1


def _newton(problem: EndsProblem, beta: Array, bend: float = np.inf, goal: float = 1e-13) -> _Mesh:
    """Solve beta'' = -H on equal steps from a first guess (n,), with the end angles set.

    It ends when the next step would be below `goal`: a step is `bend` times the square of the step before.
    """
    h = float(problem.span[0]) / (beta.size - 1)
    loads = _numbers(problem)
    beta = beta.copy()
    beta[0], beta[-1] = problem.beta0[0], problem.betaL[0]
    floor = 16 * EPS * np.abs(beta).max() + 1e-300  # rounding of the residual, which has a factor h^2
    (off, rate), met, iteration, last = _residual(loads, beta, h), False, 0, np.inf
    while iteration < ROUNDS and not met:
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
            left, steep = _residual(loads, tried, h)
            if np.abs(left).max() < max(size, floor):
                break
            share /= 2
        else:
            met = size <= 4 * floor  # no step helps: rounding, or divergence
            break
        beta, off, rate = tried, left, steep
        if last < 0.1:  # in the range of quadratic convergence; at rounding, steps stop shrinking
            bend = length / last**2 if bend == np.inf else max(bend, length / last**2)
        stale = np.abs(off).max() <= floor and length > last / 2
        met, last = share == 1.0 and bool(length <= 1e-8 or stale), length
    return _Mesh(_columns(problem, beta, h), met, iteration, bend)


def _numbers(problem: EndsProblem) -> Loads:
    return Loads(float(problem.lam[0]), float(problem.mu[0]), float(problem.phi[0]))


def _pull(loads: Loads, s: Array, c: Array) -> tuple[Array, Array]:
    """H and H' from the sine and cosine of beta, in few operations: the factor h^2 makes their rounding small."""
    s2, twice = s * s, (2 * loads.mu) * c
    pull = (loads.lam - twice) * c + loads.mu - (loads.phi + 2 * c * s2) * s
    rate = (2 * twice - loads.lam) * s - loads.phi * c - s2 * (6 - 8 * s2)
    return pull, rate


def _residual(loads: Loads, beta: Array, h: float) -> tuple[Array, Array]:
    """The residual of eq. (41) times h^2 at the inner nodes, and H' there."""
    pull, rate = _pull(loads, np.sin(beta[1:-1]), np.cos(beta[1:-1]))
    rise = beta[1:] - beta[:-1]  # exact for neighbours
    return rise[1:] - rise[:-1] + h * h * pull, rate


def _step(rate: Array, off: Array, h: float) -> Array | None:
    """Newton's step from the tridiagonal system (43); None if it is singular."""
    import scipy

    beside = np.ones(off.size - 1)
    solve = scipy.linalg.lapack.dgtsv
    step, info = solve(beside, h * h * rate - 2, beside.copy(), -off, overwrite_d=1, overwrite_b=1)[3:]
    return step if info == 0 and np.isfinite(step).all() else None


def _columns(problem: EndsProblem, beta: Array, h: float) -> Array:
    """beta, beta_t, alpha, z, swirl at the nodes, with errors in even powers of h only, (5, n)."""
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


def _refine(beta: Array) -> Array:
    """A first guess on twice as many steps, by cubics through four neighbours."""
    fine = np.empty(2 * beta.size - 1)
    fine[::2] = beta
    inner = (-beta[:-3] + 9 * beta[1:-2] + 9 * beta[2:-1] - beta[3:]) / 16
    fine[3:-3:2] = inner
    fine[1] = (3 * beta[0] + 6 * beta[1] - beta[2]) / 8
    fine[-2] = (3 * beta[-1] + 6 * beta[-2] - beta[-3]) / 8
    return fine


def _read(problem: EndsProblem, columns: Array, t: Array) -> Array:
    """The columns at the stations, (5, k), by quintics through values and two derivatives at the nodes."""
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


def _slopes(problem: EndsProblem, columns: Array, h: float) -> tuple[Array, Array]:
    """h times the first and h^2 times the second derivative of the columns at some nodes."""
    beta, rate = columns[:2]
    s, c = np.sin(beta), np.cos(beta)
    pull, steep = _pull(_numbers(problem), s, c)
    first = np.stack([rate, -pull, s, c, s * c])
    second = np.stack([-pull, -steep * rate, c * rate, -s * rate, (c - s) * (c + s) * rate])
    return h * first, h * h * second
