"""Over the whole range of a float: no exception, no warning, nothing that is not finite in a case called solved.

Quick part: a few thousand seeded cases. `pytest -m slow tests/numerics/test_extremes.py` runs 100,000 of them and
checks 2,000 against Taylor series to 25 digits (some minutes).
"""

import warnings
from typing import Any

import numpy as np
import pytest

from solver import Solution, solve
from solver.methods import OrbitQuadrature, available
from solver.problem.reduced import StartProblem
from tests.cases import in_units_of_rho
from tests.extreme_cases import KINDS, draw
from tests.taylor import march

ALONG = ("beta", "dbeta", "alpha", "z", "gamma", "position", "tangent", "kappa", "contact", "F1", "F2", "F3", "h")

# lam, mu, phi, span, beta0, beta_t0: each once brought the method down
ONCE_FATAL = {
    "H only touches zero": (-10.820287450478478, -10.820287450478478, 0.0, 20.0, 0.5, 0.1),
    "at rest where H touches zero": (-10.820287450478478, -10.820287450478478, 0.0, 20.0, 0.0, 0.0),
    "turns at a fold": (85316758.99164146, 85316758.99164146, 4.19e-12, 20244.9, -np.pi, -2.6975905233492718e-06),
    "starts at a fold": (1549106237747.348, 1549106237747.348, -0.16477971541963907, 694.8, 0.0, 2.7e-09),
    "one bit below pi": (1.8e-46, 0.0, -1.3075725558958222, 0.085, 3.1415926535897927, 0.0),
    "the smallest angle": (0.0, 0.0, -31681.26751537264, 11007093.45, -5e-324, 0.0),
    "the smallest load": (5365600742102866.0, -0.006271832964915074, 2.65e-308, 0.0067, -5e-324, 8.6e-08),
}


# lam = mu or lam = -mu with next to no axial force: H and H' vanish together at an end of the axis
FOLDS = {
    "at rest beside it": (-1.624957889013431e16, -1.624957889013431e16, 0.0, 1.047873735409384e-06, -3.56483e-09, 0.0),
    "at rest in it": (0.08093040900290258, 0.08093040900290258, 1.7339489e-24, 643.14, -3.3099853e-13, 0.0),
    "passing slowly": (213318.48152251344, 213318.48152251344, 0.0, 0.6788103234863304, 0.0, 0.00012751809749),
    "passing a second root of H": (
        438257676.9481662,
        438257676.9481662,
        1.411321621e-06,
        0.0059093586,
        0.0,
        0.00049688,
    ),
    "between the two roots": (-20.926543405315606, -20.926543405315606, 9.481167631e-12, 5.0, -3.96777388e-15, 0.0),
    "passing quickly": (15700.0, 15700.0, 0.0, 0.3, -3.87e-13, 0.00169),
    "at the other end of the axis": (2187e9, -2187e9, 0.0, 7.08e-05, np.pi, 0.00144),
    "there, once told too good": (-45653644739.585785, 45653644739.585785, 1.02e-30, 0.00101274527, np.pi, 4.92332e-05),
    "there, backwards": (180e9, -180e9, -6.82e-22, 0.00019, -np.pi, 0.000989),
    "there, from rest beside it": (-2187.0, 2187.0, 0.0, 2.0, np.pi - 1e-6, 0.0),
}


BOTH = pytest.mark.parametrize("method", [name for name in ("orbit", "swing") if name in available()])


def quietly(case: Any, **more: Any) -> Solution:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return solve(case, **more)


def finite(sol: Solution) -> Any:
    """Whether every number of a case is finite, (*cases)."""
    fine = np.isfinite(sol.error) & (sol.condition >= 1)
    for name in ALONG:
        values = getattr(sol, name).reshape(*np.shape(fine), -1)
        fine &= np.isfinite(values).all(axis=-1)
    return fine


@pytest.mark.parametrize("name", ONCE_FATAL)
def test_orbit_answers_or_says_why_not_next_to_every_degeneracy(name: str) -> None:
    sol = quietly(in_units_of_rho(*ONCE_FATAL[name]))
    assert (sol.solved and finite(sol)) or "failed: " in sol.outcome


def test_a_rod_at_rest_where_G_is_flat_stays() -> None:
    sol = quietly(in_units_of_rho(-3.0, -3.0, 0.0, 20.0, 0.0, 0.0))
    assert sol.solved
    np.testing.assert_array_equal(sol.beta, 0.0)


def test_a_rod_next_to_a_fold_is_solved_and_its_error_is_honest() -> None:
    lam, mu, phi, span, beta0, dbeta0 = np.array(list(FOLDS.values())).T
    problem = StartProblem(lam, mu, phi, span, beta0, dbeta0=dbeta0)
    t = span[:, None] * np.linspace(0, 1, 5)
    true = march(lam, mu, phi, beta0, dbeta0, t, most=1000)
    told = OrbitQuadrature().run(problem, t, 1e-8)
    off = np.abs(told.beta - true[0]).max(axis=1)
    for k, name in enumerate(FOLDS):
        assert told.outcome[k].startswith("solved"), (name, told.outcome[k])
        assert off[k] <= 1e-8 * told.condition[k], (name, off[k], told.condition[k])
        assert told.error[k] >= 0.1 * off[k] - 1e-15, (name, told.error[k], off[k])  # the last bits of the angle


@BOTH
@pytest.mark.parametrize("side", ("outside", "inside"))
@pytest.mark.parametrize("kind", KINDS)
def test_nearly_every_random_case_that_can_be_is_solved(kind: str, side: str, method: str) -> None:
    with np.errstate(all="ignore"):
        case = draw(250, 1, kind, side)
    sol = quietly(case, stations=17, method=method)
    with np.errstate(all="ignore"):
        assert not (sol.solved & ~finite(sol)).any()
    easy = sol.condition < 1e10
    unsolved = np.count_nonzero(easy & ~sol.solved)
    assert unsolved <= 3, sol.outcome[easy & ~sol.solved]
    assert all(text.startswith("failed: ") for text in sol.outcome[~sol.solved])


# The bar over the whole range: pytest -m slow -s tests/numerics/test_extremes.py.
# Its figures are in docs/reference/methods.md.

BATCH, BATCHES = 1400, 6  # times kinds and sides: 100,800 cases
CHECKED = 340  # of each kind, 2,040 in all
WORK = 100.0  # radians at the most that a checked rod swings through: what Taylor series reach in minutes


@pytest.mark.slow
@BOTH
def test_a_hundred_thousand_random_cases_end_well(method: str) -> None:
    """No exception, no warning, nothing non-finite called solved; 99.9 % of those with condition < 1e10 solved."""
    easy = solved = 0
    for kind in KINDS:
        for side in ("outside", "inside"):
            for seed in range(100, 100 + BATCHES):
                with np.errstate(all="ignore"):
                    case = draw(BATCH, seed, kind, side)
                sol = quietly(case, stations=17, method=method)
                with np.errstate(all="ignore"):
                    assert not (sol.solved & ~finite(sol)).any(), (kind, side, seed)
                assert all(text.startswith("failed: ") for text in sol.outcome[~sol.solved])
                can = sol.condition < 1e10
                easy, solved = easy + int(can.sum()), solved + int((can & sol.solved).sum())
    print(f"\n{solved} of {easy} with condition below 1e10 solved: {solved / easy:.5%}")
    assert solved >= 0.999 * easy


@pytest.mark.slow
@BOTH
def test_no_random_case_called_solved_is_wrong_and_its_error_is_honest(method: str) -> None:
    """Against Taylor series to 25 digits. A tenth of the true error at least, but for the last bit of the angle."""
    ratio, wrong = [], 0
    for kind in KINDS:
        off, sol, index = checked(kind, CHECKED, 7, method)
        allowed = sol.tol * np.maximum(1, sol.condition[index])
        wrong += int((off > allowed).sum())
        ratio.append(sol.error[index] / np.maximum(off, 1e-15))
    share = np.concatenate(ratio)
    under, over = np.mean(share < 0.1), np.mean(share > 1000)
    print(
        f"\n{share.size} checked, {wrong} wrong; "
        f"error below a tenth of the truth {under:.3%}, above 1000 times {over:.3%}"
    )
    assert wrong == 0
    assert under <= 0.001
    assert over <= 0.05


@BOTH
def test_a_sample_of_random_cases_is_right_to_its_promise(method: str) -> None:
    for kind in KINDS:
        off, sol, index = checked(kind, 2, 3, method)
        assert (off <= sol.tol * np.maximum(1, sol.condition[index])).all(), kind
        assert (off <= 10 * np.maximum(sol.error[index], 1e-15)).all(), kind


def checked(kind: str, count: int, seed: int, method: str) -> tuple[Any, Solution, Any]:
    """True errors of so many solved cases of moderate length, their solution, and which of it they are."""
    with np.errstate(all="ignore"):
        sol = quietly(draw(6 * count, seed, kind), stations=5, method=method)
        p = sol.problem
        swung = p.span * (np.abs(p.dbeta0) + np.sqrt(np.abs(p.lam) + np.abs(p.mu) + np.abs(p.phi) + 1))
        index = np.flatnonzero(sol.solved & (swung < WORK))[:count]
        q = p.take(index)
        true = march(q.lam, q.mu, q.phi, q.beta0, q.dbeta0, sol.t[index], most=600)
    arrived = np.isfinite(true).all(axis=(0, 2))
    reach = np.maximum(1, q.span)[:, None]
    told = sol.trajectory
    parts = (told.beta[index] - true[0], (told.alpha[index] - true[1]) / reach, (told.z[index] - true[2]) / reach)
    off = np.max([np.abs(part).max(axis=1) for part in parts], axis=0)
    assert arrived.mean() > 0.95
    return off[arrived], sol, index[arrived]
