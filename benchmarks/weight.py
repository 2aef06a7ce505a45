"""Rods with weight: start problems against DOP853 and heyoka, ends problems of a pipe against solve_bvp, branches.

Run from the checkout: `.venv/bin/python -m benchmarks.weight` (some minutes; the rows against heyoka need the extra
taylor). Prints seconds and ratios; nothing is asserted: machines differ.
"""

import math
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp

from benchmarks.core import threads
from benchmarks.taylor import _loosest
from benchmarks.timing import compare_times, seconds_of_processor
from solver import Case, Cylinder, Ends, Rod, Start, follow, methods, solve, trace_fold
from solver.nodes.loaded_rod import starts_of

STATIONS, WANTED = 201, 1e-10
PIPE: dict[str, Any] = {"EI": 1.228e6, "GJ": 9.45e5, "a": 0.0635, "weight": 242.0}  # 5 inch, in N and m
HOLE: dict[str, Any] = {"R": 0.10795, "side": "inside", "inclination": "90deg"}
BUCKLES = 2 * math.sqrt(1.228e6 * 242 / (0.10795 - 0.0635))


def rods(count: int) -> Case:
    """Rods of other moduli, half of them of any inclination."""
    rod = Rod(E=np.geomspace(5e3, 4e4, count), nu=0.25, a=0.25, L=20.0, weight=1.0)
    return Case(rod, Cylinder(R=0.75, inclination="60deg"), Start(beta=0.5, dbeta=0.3, F3=5.0, M3=3.0, alpha=0.4))


def rates(sin: Any, cos: Any, y: Any, mu: Any, along: Any, across: Any) -> list[Any]:
    """beta, beta_t, alpha, t - z's partner z, lam and phi, differentiated."""
    beta, v, alpha, _, lam, phi = y
    s, c = sin(beta), cos(beta)
    pull = lam * c - mu * (c * c - s * s) - (phi + 2.0 * c * s * s) * s
    return [v, -1.0 * pull, s, c, across * sin(alpha), along + 0.0 * s]


def start_problems(count: int = 10_000) -> dict[str, float]:
    """Seconds of a rod, and ratios, each with the loosest tolerance that achieves the wanted error."""
    case, few = rods(count), rods(20)
    exact = solve(few, tol=1e-13, stations=STATIONS).beta
    problem, numbers, begin, _ = starts_of(few)

    def dop853(rtol: float, some: int = 20) -> np.ndarray:
        out = []
        for i in range(some):
            mu, (_, along, across) = float(problem.mu[i]), map(float, numbers[i, :3])
            y0 = [float(v) for v in (*begin[i, :3], 0.0, problem.lam[i], problem.phi[i])]
            t = problem.span[i] * np.linspace(0, 1, STATIONS)

            def right(_: float, y: np.ndarray, m: float = mu, a: float = along, b: float = across) -> list[float]:
                return rates(math.sin, math.cos, y.tolist(), m, a, b)

            out.append(solve_ivp(right, (0, t[-1]), y0, "DOP853", t_eval=t, rtol=rtol, atol=rtol).y[0])
        return np.array(out)

    theirs = _loosest(lambda tol: np.abs(dop853(tol) - exact).max(), WANTED)
    with threads(1):
        slow, fast, _ = compare_times(lambda: dop853(theirs), lambda: solve(case, tol=WANTED, stations=STATIONS), 3)
    out = {"DOP853 ms a rod": 1e3 * slow / 20, "taylor ms a rod": 1e3 * fast / count}
    out["DOP853 / taylor"] = out["DOP853 ms a rod"] / out["taylor ms a rod"]
    return out | (against_heyoka(case, few, exact) if "heyoka" in methods.available() else {})


def against_heyoka(case: Case, few: Case, exact: np.ndarray) -> dict[str, float]:
    """All rods by heyoka, as many at once as the registers hold, against ours, which give error and condition too."""
    import heyoka as hy

    names = hy.make_vars("beta", "v", "alpha", "z", "lam", "phi")
    right = rates(hy.sin, hy.cos, names, hy.par[0], hy.par[1], hy.par[2])
    lanes = 8

    def integrator(tol: float) -> Any:
        system = list(zip(names, right, strict=True))
        return hy.taylor_adaptive_batch(system, np.zeros((6, lanes)), tol=tol, pars=np.zeros((3, lanes)))

    marches = {10.0**-k: integrator(10.0**-k) for k in range(9, 15)}

    def integrate(tol: float, of: Case) -> np.ndarray:
        problem, numbers, begin, _ = starts_of(of)
        march, out = marches[tol], np.empty((problem.size, STATIONS, 6))
        for first in range(0, problem.size, lanes):
            rows = np.minimum(np.arange(first, first + lanes), problem.size - 1)
            march.set_time(0.0)
            march.state[:] = *begin[rows, :3].T, 0 * rows, problem.lam[rows], problem.phi[rows]
            march.pars[:] = problem.mu[rows], numbers[rows, 1], numbers[rows, 2]
            states = march.propagate_grid(np.linspace(0, 1, STATIONS)[:, None] * problem.span[rows])[-1]
            kept = min(lanes, problem.size - first)
            out[first : first + kept] = np.moveaxis(states, 2, 0)[:kept]
        return out[:, :, 0]

    tol = next((one for one in marches if np.abs(integrate(one, few) - exact).max() <= WANTED), 1e-14)
    with threads(1):
        slow, fast, ratio = compare_times(
            lambda: integrate(tol, case), lambda: solve(case, tol=WANTED, stations=STATIONS), 3
        )  # fmt: skip
    return {"heyoka tolerance": tol, "heyoka s": slow, "taylor s": fast, "heyoka / taylor": ratio}


def pipe(L: float, load: float) -> Case:
    """A lying 5 inch pipe under a share of the load of Dawson and Paslay."""
    return Case(Rod(L=L, **PIPE), Cylinder(**HOLE), Ends(beta0=0.0, betaL=0.0, azimuth=0.0, FZ=-load * BUCKLES))


def pipes() -> dict[str, float]:
    """Seconds of the whole answer, from the straight pipe, and of one from a seed; peak memory of NumPy."""
    out = {}
    for L in (1000.0, 2000.0, 5000.0):
        case = pipe(L, 1.2)
        seed = solve(case)
        fast, again, _ = compare_times(lambda c=case: solve(c), lambda c=case, s=seed: solve(c, seed=s), 3)
        tracemalloc.start()
        solve(case)
        peak = tracemalloc.get_traced_memory()[1] / 2**20
        tracemalloc.stop()
        out |= {f"{L:g} m s": fast, f"{L:g} m from a seed s": again, f"{L:g} m MB": peak}
        out[f"{L:g} m error"] = float(seed.error) if seed.solved else math.nan
    return out


def against_solve_bvp(L: float = 300.0) -> dict[str, float]:
    """A buckled pipe by solve_bvp, at errors down to ours, and by ours, both from the shape at another load."""
    case = pipe(L, 1.2)
    sol, near = solve(case, stations=401), solve(pipe(L, 1.18))
    A, rho = float(case.rod.bending_stiffness), float(case.rho)
    omega, phi, span = 242 * rho**3 / A, -1.2 * BUCKLES * rho**2 / A, L / rho
    B = 0.02  # of beta, so that all numbers are of order 1
    T = 1 / math.sqrt(-phi)

    def right(_: np.ndarray, y: np.ndarray) -> np.ndarray:
        beta, s = B * y[0], np.sin(B * y[0])
        lam = y[3] * B / T**2
        pull = lam * np.cos(beta) - (phi + 2 * np.cos(beta) * s * s) * s
        return np.stack([y[1], -pull * T * T / B, s * T, omega * np.sin(y[2]) * T**3 / B])

    def ends(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.array([a[0], b[0], a[2], b[2]])

    x = np.linspace(0, span / T, 401)
    start = solve(pipe(L, 1.18), stations=401, seed=near)
    assert start.trajectory.loads is not None
    guess = np.stack([start.beta / B, start.dbeta * rho * T / B, start.alpha, start.trajectory.loads[0, 0] * T**2 / B])

    def bvp(tol: float) -> Any:
        return solve_bvp(right, ends, x, guess, tol=tol, max_nodes=200_000)

    out: dict[str, float] = {}
    for tol in (1e-6, 1e-9, 1e-10):
        out[f"solve_bvp error, tol {tol:g}"] = float(np.abs(B * bvp(tol).sol(x)[0] - sol.beta).max())
        slow, fast, ratio = compare_times(lambda t=tol: bvp(t), lambda: solve(case, stations=401, seed=near), 3)  # type: ignore[misc]
        out |= {f"  s, tol {tol:g}": slow, "  ours s": fast, f"  ratio, tol {tol:g}": ratio}
    return out | {"our estimated error": float(sol.error)}


def branches() -> dict[str, float]:
    """Milliseconds of a point of a branch over the load and over the length, and of a point of a fold curve."""
    wall, ends = Cylinder(R=0.75, inclination="60deg"), {"beta0": 0.5, "betaL": 0.8}
    long = solve(Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0, weight=0.1), wall, Ends(FZ=-8.66, **ends)))
    short = solve(Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=3.0, weight=0.1), wall, Ends(FZ=-40.0, **ends)))
    folded = follow(short, FZ=[-60.0, -20.0])
    ways: dict[str, Callable[[], Any]] = {
        "over FZ": lambda: follow(long, FZ=[-20.0, 0.0]),
        "over L": lambda: follow(long, L=[10.0, 20.0]),
        "of a fold over FZ and weight": lambda: trace_fold(folded, weight=(0.05, 0.2)),
    }
    return {f"ms a point {name}": 1e3 * seconds_of_processor(way) / len(way().values) for name, way in ways.items()}


PARTS = {
    "start problems with weight, within 1e-10": start_problems,
    "a lying 5 inch pipe at 1.2 times its critical load": pipes,
    "a buckled pipe of 300 m against solve_bvp": against_solve_bvp,
    "branches with weight": branches,
}


def main() -> None:
    for title, work in PARTS.items():
        print(title)
        for name, value in work().items():
            print(f"  {name:<36} {value:.3g}", flush=True)


if __name__ == "__main__":
    main()
