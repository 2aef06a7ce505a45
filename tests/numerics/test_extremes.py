"""Over the whole range of a float: no exception, no warning, nothing that is not finite in a case called solved.

Quick part: a few thousand seeded cases. `pytest -m slow tests/numerics/test_extremes.py` runs 100,000 of them and
checks 2,000 in thirty digits (some minutes).
"""

import warnings
from typing import Any

import numpy as np
import pytest

from solver import Solution, solve
from tests.cases import in_units_of_rho
from tests.extreme_cases import KINDS, draw

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


@pytest.mark.parametrize("side", ("outside", "inside"))
@pytest.mark.parametrize("kind", KINDS)
def test_orbit_solves_nearly_every_random_case_that_can_be(kind: str, side: str) -> None:
    with np.errstate(all="ignore"):
        case = draw(250, 1, kind, side)
    sol = quietly(case, stations=17)
    with np.errstate(all="ignore"):
        assert not (sol.solved & ~finite(sol)).any()
    easy = sol.condition < 1e10
    unsolved = np.count_nonzero(easy & ~sol.solved)
    assert unsolved <= 3, sol.outcome[easy & ~sol.solved]
    assert all(text.startswith("failed: ") for text in sol.outcome[~sol.solved])
