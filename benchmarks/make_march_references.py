"""Writes tests/march_references.npz: random start problems by Taylor series in 25 digits, and what is observed on them.

Run from the root: python -m benchmarks.make_march_references (some minutes).

`shapes KIND`: rows of lam, mu, phi, span, beta0, beta_t0, then beta, alpha and z at a quarter, a half, three quarters
and the end of the length, (n, 18). `observed few` and `observed many`: the numbers of `observed` for each of the random
rods of `test_measurement`, NaN where the march does not arrive; `names`: what they are. `push few`: the place of the
largest push, in units of rho, and that push in A/rho^3.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyval
from scipy.optimize import minimize_scalar

from benchmarks.march_25_digits import march
from benchmarks.observed_march import numbers_along, push_and_curvature, steps
from solver import Case, solve
from solver.problem.dimensionless import StartProblem, reduce
from tests.cases import random_rods
from tests.extreme_cases import KINDS, draw

FILE = Path(__file__).resolve().parents[1] / "tests" / "march_references.npz"
CHECKED = 100  # of each kind
WORK = 100.0  # radians at the most that a checked rod swings through: what the series reach in minutes

# lam = mu or lam = -mu with next to no axial force: H and H' vanish together at an end of the axis
FOLDS = (
    (-1.624957889013431e16, -1.624957889013431e16, 0.0, 1.047873735409384e-06, -3.56483e-09, 0.0),  # at rest beside it
    (0.08093040900290258, 0.08093040900290258, 1.7339489e-24, 643.14, -3.3099853e-13, 0.0),  # at rest in it
    (213318.48152251344, 213318.48152251344, 0.0, 0.6788103234863304, 0.0, 0.00012751809749),  # passing slowly
    (438257676.9481662, 438257676.9481662, 1.411321621e-06, 0.0059093586, 0.0, 0.00049688),  # a second root of H
    (-20.926543405315606, -20.926543405315606, 9.481167631e-12, 5.0, -3.96777388e-15, 0.0),  # between the two roots
    (15700.0, 15700.0, 0.0, 0.3, -3.87e-13, 0.00169),  # passing quickly
    (2187e9, -2187e9, 0.0, 7.08e-05, np.pi, 0.00144),  # at the other end of the axis
    (-45653644739.585785, 45653644739.585785, 1.02e-30, 0.00101274527, np.pi, 4.92332e-05),  # there, once told too good
    (180e9, -180e9, -6.82e-22, 0.00019, -np.pi, 0.000989),  # there, backwards
    (-2187.0, 2187.0, 0.0, 2.0, np.pi - 1e-6, 0.0),  # there, from rest beside it
)


def shapes(problem: StartProblem, most: int) -> Any:
    """Rows of the problems on which the march arrives in so many steps, with beta, alpha and z, (n, 18)."""
    given = np.stack([problem.lam, problem.mu, problem.phi, problem.span, problem.beta0, problem.dbeta0], axis=1)
    t = problem.span[:, None] * np.linspace(0.25, 1, 4)
    true = march(problem.lam, problem.mu, problem.phi, problem.beta0, problem.dbeta0, t, most=most)
    rows = np.concatenate([given, *true], axis=1)
    return rows[np.isfinite(rows).all(axis=1)]


def moderate(kind: str) -> StartProblem:
    """Random problems of one kind that `orbit` solves, and that swing through no more than WORK."""
    with np.errstate(all="ignore"):
        case = draw(6 * CHECKED, 7, kind)
        p = reduce(case)
        swung = p.span * (np.abs(p.dbeta0) + np.sqrt(np.abs(p.lam) + np.abs(p.mu) + np.abs(p.phi) + 1))
        return p.take(np.flatnonzero(solve(case, stations=5).solved & (swung < WORK))[:CHECKED])


def numbers_of(case: Case) -> Any:
    p = solve(case, stations=2).problem
    return np.stack([p.lam, p.mu, p.phi, p.span, p.beta0, p.dbeta0], axis=1)


def observables(case: Case) -> list[dict[str, float]]:
    """The observables of each rod; empty where its march does not arrive."""
    given = numbers_of(case)
    return [numbers_along(row, way) if way else {} for row, way in zip(given, steps(given), strict=True)]


def largest_pushes(case: Case) -> list[tuple[float, float]]:
    """The place of the largest push, the first of equal ones, and that push, of each rod."""
    rows, found = numbers_of(case), []
    for row, sign, way in zip(rows, np.broadcast_to(case.outward, case.shape), steps(rows), strict=True):
        begin, best = 0.0, (0.0, -1e300)
        for series, h in way:

            def push(x: Any, series: Any = series, row: Any = row, sign: Any = sign) -> Any:
                return sign * push_and_curvature(row, np.stack([polyval(x, one) for one in series]))[0]

            x = np.linspace(0, h, 101)
            m = int(np.argmax(push(x)))
            beside = x[max(m - 1, 0)], x[min(m + 1, 100)]
            near = minimize_scalar(lambda y, f=push: -f(y), bounds=beside, method="bounded", options={"xatol": 1e-13})
            for y in (near.x,) if 0 < m < 100 else (x[m], near.x):
                if push(y) > best[1] + 1e-9 * abs(best[1]):
                    best = begin + y, float(push(y))
            begin += h
        found.append(best)
    return found


def main() -> None:
    arrays = {"shapes folds": shapes(StartProblem(*np.array(FOLDS).T), most=1000)}
    arrays |= {f"shapes {kind}": shapes(moderate(kind), most=600) for kind in KINDS}
    few, many = observables(random_rods(4, 1, 12.0)), observables(random_rods(100, 2))
    names = [*few[0]]
    for name, rows in (("few", few), ("many", many)):
        arrays[f"observed {name}"] = np.array([[row.get(name, np.nan) for name in names] for row in rows])
    arrays["push few"] = np.array(largest_pushes(random_rods(30, 17, 6.0)))
    np.savez_compressed(FILE, names=np.array(names), **arrays)
    print(f"{FILE}: " + ", ".join(f"{name} {rows.shape}" for name, rows in arrays.items()))


if __name__ == "__main__":
    main()
