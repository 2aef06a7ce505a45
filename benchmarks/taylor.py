"""`swing` and `orbit` against heyoka, Taylor's method compiled: one rod, and ten thousand; needs the extra taylor.

Both get the loosest tolerance, in decades, that achieves the error asked for on every rod that is looked at; both give
beta, beta', alpha and z at the same stations, on one core, compiled before the clock starts. heyoka gives no error and
no condition number with them.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.core import threads
from benchmarks.timing import compare_times, peak_gigabytes, table1
from solver import solve
from solver.problem.dimensionless import reduce


def one_rod(L: float, wanted: float = 1e-12) -> dict[str, float]:
    """Milliseconds of one call each, medians, and the median ratio heyoka / ours."""
    case = table1(L)
    problem = reduce(case)
    t = problem.span[0] * np.linspace(0, 1, 201)
    exact = solve(case, tol=1e-14, method="orbit").beta
    marches = {tol: _march(tol) for tol in _decades()}

    def integrate(tol: float) -> Any:
        march = marches[tol]
        march.time = 0.0
        march.state[:] = problem.beta0[0], problem.dbeta0[0], 0.0, 0.0  # type: ignore[index]
        march.pars[:] = problem.lam[0], problem.mu[0], problem.phi[0]
        return march.propagate_grid(t)[-1][:, 0]

    theirs = _loosest(lambda tol: np.abs(integrate(tol) - exact).max(), wanted)
    out = {"heyoka tolerance": theirs}
    for method in ("swing", "orbit"):
        ours = _loosest(
            lambda tol, method=method: np.abs(solve(case, tol=tol, method=method).beta - exact).max(), wanted
        )
        slow, fast, ratio = compare_times(
            lambda: integrate(theirs), lambda o=ours, m=method: solve(case, tol=o, method=m), 60, (20, 20)
        )
        out |= {f"{method} tolerance": ours, f"{method} ms": 1e3 * fast, f"heyoka / {method}": ratio}
    return out | {"heyoka ms": 1e3 * slow}


def many_rods(L: float, cases: int = 10_000, wanted: float = 1e-10) -> dict[str, float]:
    """Seconds for all rods, and the ratio heyoka / ours; the modulus varies from rod to rod."""
    E = np.geomspace(5e3, 4e4, cases)
    case, few = table1(L, E), table1(L, E[:: cases // 100])
    exact = solve(few, tol=1e-13, method="orbit", stations=400).beta
    problem = reduce(case)
    out = np.empty((cases, 400, 4))

    def integrate(tol: float, some: slice = slice(None)) -> Any:
        return _together(marches[tol], problem.take(some), out[some])[..., 0]

    looked_at = slice(None, None, cases // 100)
    marches = {tol: _march(tol, together=True) for tol in _decades()}
    theirs = _loosest(lambda tol: np.abs(integrate(tol, looked_at) - exact).max(), wanted)
    ours = _loosest(lambda tol: np.abs(solve(few, tol=tol, method="swing", stations=400).beta - exact).max(), wanted)
    with threads(1):
        slow, fast, ratio = compare_times(
            lambda: integrate(theirs), lambda: solve(case, tol=ours, method="swing", stations=400), 5, (1, 5)
        )
    return {
        "heyoka tolerance": theirs,
        "swing tolerance": ours,
        "heyoka s": slow,
        "swing s": fast,
        "heyoka / swing": ratio,
        "peak GB of both": peak_gigabytes(),
    }


def _decades() -> list[float]:
    return [10.0**-k for k in range(9, 17)]


def _loosest(error: Callable[[float], float], wanted: float) -> float:
    """The first of the decades with which the error is small enough; the last where none is."""
    tols = [tol for tol in _decades() if tol > 1e-15] if wanted > 1e-11 else _decades()
    return next((tol for tol in tols if error(tol) <= wanted), tols[-1])


def _march(tol: float, together: bool = False) -> Any:
    """heyoka's integrator of one rod, or of as many at once as the machine's registers hold."""
    import heyoka as hy

    beta, v, alpha, z = hy.make_vars("beta", "v", "alpha", "z")
    lam, mu, phi = hy.par[0], hy.par[1], hy.par[2]
    s, c = hy.sin(beta), hy.cos(beta)
    rates = [(beta, v), (v, -(lam * c - mu * (c * c - s * s) - (phi + 2.0 * c * s * s) * s)), (alpha, s), (z, c)]
    tol = max(tol, 2.3e-16)
    if not together:
        return hy.taylor_adaptive(rates, [0.0] * 4, tol=tol, pars=[0.0] * 3)
    lanes = 8
    return hy.taylor_adaptive_batch(rates, np.zeros((4, lanes)), tol=tol, pars=np.zeros((3, lanes)))


def _together(march: Any, problem: Any, out: Any) -> Any:
    """All problems, as many at a time as the integrator has lanes; beta, v, alpha, z into out (B, n, 4)."""
    lanes, n = march.state.shape[1], out.shape[1]
    for first in range(0, problem.size, lanes):
        rows = np.minimum(np.arange(first, first + lanes), problem.size - 1)
        march.set_time(0.0)
        march.state[:] = problem.beta0[rows], problem.dbeta0[rows], 0 * rows, 0 * rows
        march.pars[:] = problem.lam[rows], problem.mu[rows], problem.phi[rows]
        states = march.propagate_grid(np.linspace(0, 1, n)[:, None] * problem.span[rows])[-1]
        kept = min(lanes, problem.size - first)
        out[first : first + kept] = np.moveaxis(states, 2, 0)[:kept]
    return out


PARTS: dict[str, Callable[[], dict[str, float]]] = {
    "against heyoka, one rod, L = 20, 201 stations, within 1e-12": lambda: one_rod(20.0),
    "against heyoka, one rod, L = 200, 201 stations, within 1e-12": lambda: one_rod(200.0),
    "against heyoka, 10,000 rods x 400 stations, L = 20, within 1e-10": lambda: many_rods(20.0),
    "against heyoka, 10,000 rods x 400 stations, L = 200, within 1e-10": lambda: many_rods(200.0),
}
