"""`collocation`: scipy's solve_bvp for ends problems: cubic splines that obey the equation at three points a step.

Order 4, on a mesh that it refines where the residual is large. Its tolerance bounds the residual, not the error; so the
error is measured against a run at thirty times the tolerance, and the tolerance is tightened until the two agree. Each
run begins with half the steps of the run before: on one mesh both would have the same error, and would agree. It finds
the solution near its seed; without a seed, near the equilibrium that the rule `choose` selects. The stop rule of its
Newton iteration limits the error to about 1e-11.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..numerics.chebyshev import GAUSS
from ..orbits.mesh_index import response
from ..orbits.potential import slope, slope_rate
from ..problem.dimensionless import EndsProblem
from ..problem.trajectory import Seed
from .method import MOST_COMPILED, TIGHTEST, TOLERANCES, Ladder, SeededMethod, SingleAnswer, knob, tighten

# nodes: of the first mesh, and of the next if that is too coarse for the seed; of any mesh. x10: time
_FIRST, _MOST = (257, 2049), 10_000


@dataclass(frozen=True)
class Collocation(SeededMethod):
    """Collocation by cubic splines.

    rtol: scipy's own tolerance; default: sought so that `tol` is met. nodes: of the first mesh; default: 257, or 2049
    if that is too coarse for the seed.
    """

    name = "collocation"
    summary = "collocation by cubic splines on a mesh of its own (scipy's solve_bvp)"
    order = 4
    ladders = (Ladder("collocation", "rtol", TOLERANCES, "#c94fc9", "D", most=MOST_COMPILED),)

    rtol: float | None = knob(float)
    nodes: int | None = knob(int, least=5)

    def solve_one(self, problem: EndsProblem, t: Array, tol: float, seed: Seed) -> SingleAnswer:
        span, condition = float(problem.span[0]), np.inf
        answer: Any = None

        def attempt(rtol: float) -> tuple[Array, int, str]:
            nonlocal answer
            work, sizes = 0, _FIRST if self.nodes is None else (self.nodes,)
            for x, y in [_half_steps(answer)] if answer else _guesses(problem, seed, sizes):
                answer, more = _collocate(problem, x, y, rtol)
                work += more
                if answer.status == 0:
                    return _columns(answer, t), work, ""
            return np.full((5, t.size), np.nan), work, f"failed: solve_bvp: {answer.message.rstrip('.').lower()}"

        def round_off(_: int) -> float:
            nonlocal condition
            even = np.linspace(0, span, max(answer.x.size, 1025))
            condition = float(response(problem, even[1:2], answer.sol(even)[:1])[0])
            return 1e-15 * condition

        columns, error, work, why = tighten(attempt, round_off, span, tol, self.rtol, TIGHTEST)
        return columns, error, np.inf if why else condition, work, why


def _guesses(problem: EndsProblem, seed: Seed, sizes: tuple[int, ...]) -> Iterator[tuple[Array, Array]]:
    """Equal steps x (m,) of so many nodes, and the seed there, (2, m)."""
    for size in sizes:
        x, beta = np.linspace(0, float(problem.span[0]), size), seed.on(problem, size)
        yield x, np.stack([beta, np.gradient(beta, x)])


def _half_steps(answer: Any) -> tuple[Array, Array]:
    """The mesh of half the steps of scipy's answer, (m,), and the answer there, (2, m)."""
    x = np.sort(np.append(answer.x, (answer.x[1:] + answer.x[:-1]) / 2))
    return x, answer.sol(x)


def _collocate(problem: EndsProblem, x: Array, y: Array, rtol: float) -> tuple[Any, int]:
    """scipy's answer from a first guess y (2, m) at x (m,), and the number of points at which it took the equation."""
    beta0, betaL, points = problem.beta0[0], problem.betaL[0], 0

    def rates(x: Array, y: Array) -> Array:
        nonlocal points
        points += x.size
        return np.stack([y[1], -slope(problem, y[0])])

    def change(_: Array, y: Array) -> Array:
        jacobian = np.zeros((2, 2, y.shape[1]))
        jacobian[0, 1], jacobian[1, 0] = 1, -slope_rate(problem, y[0])
        return jacobian

    def ends(ya: Array, yb: Array) -> Array:
        return np.array([ya[0] - beta0, yb[0] - betaL])

    def ends_change(*_: Array) -> tuple[Array, Array]:

        return np.array([[1.0, 0.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [1.0, 0.0]])

    import scipy

    with np.errstate(all="ignore"):
        answer = scipy.integrate.solve_bvp(
            rates, ends, x, y, tol=rtol, max_nodes=_MOST, fun_jac=change, bc_jac=ends_change
        )
    return answer, points


def _columns(answer: Any, t: Array) -> Array:
    """beta, beta_t, and alpha, z, swirl by Gauss's rule on each piece of the spline, at the stations, (5, n)."""
    cuts = np.union1d(answer.x, t)
    half = np.diff(cuts)[:, None] / 2
    beta = answer.sol(cuts[:-1, None] + half * (1 + GAUSS[0]))[0]
    s, c = np.sin(beta), np.cos(beta)
    sums = [np.append(0.0, np.cumsum((v * half) @ GAUSS[1])) for v in (s, c, s * c)]
    at = np.searchsorted(cuts, t)
    return np.stack([*answer.sol(t), *(total[at] for total in sums)])
