"""Closed forms, to the figures given."""

import numpy as np
import pytest

from solver import solve
from tests.cases import (
    ELLIPTIC_PERIOD,
    EXACT,
    FIGURES,
    PENDULUM_PERIODS,
    catenary,
    in_units_of_rho,
    large_cylinder,
    pendulum_quarter,
    quarter_of_elliptic,
)
from tests.reach import core


@pytest.mark.parametrize("name, s, what, figures", FIGURES)
def test_the_closed_forms_give_the_figures(name: str, s: float, what: str, figures: float) -> None:
    """Tests the tests: the references are literal numbers of fifty-digit Taylor series."""
    shape = dict(zip(("beta", "alpha", "z"), EXACT[name].exact(s), strict=True))
    assert shape[what] == pytest.approx(figures, abs=1e-14)  # rounding of special functions


def test_catenary_with_no_load_at_all() -> None:
    """Between two degenerate saddles, where the pull dies out with the third power of the distance."""
    b = np.pi / 6
    case = in_units_of_rho(0, 0, 0, 200.0, b, np.sin(b) ** 2)
    sol = solve(case, tol=1e-10)
    beta, alpha, z = catenary(sol.s)
    # the rounding of the loads, 1e-17, grows with the cube of the length, as does the condition number
    atol = 1e-15 * sol.condition
    assert atol < 1e-9
    np.testing.assert_allclose(sol.beta, beta, atol=atol)
    np.testing.assert_allclose(sol.alpha, alpha, atol=200 * atol)
    np.testing.assert_allclose(sol.z, z, atol=200 * atol)


def test_period_of_the_elliptic_case() -> None:
    assert 4 * quarter_of_elliptic() / np.sqrt(0.5) == pytest.approx(ELLIPTIC_PERIOD, abs=1e-14)
    quarter = ELLIPTIC_PERIOD / 4
    case = EXACT["elliptic k=0.25 L=20"].case
    sol = solve(case, tol=1e-13, stations=[quarter, 2 * quarter, 3 * quarter, 4 * quarter, 8 * quarter])
    np.testing.assert_allclose(sol.beta[[0, 2]], np.pi / 2, atol=1e-12)
    np.testing.assert_allclose(sol.beta[1], 5 * np.pi / 6, atol=1e-12)
    np.testing.assert_allclose(sol.beta[3:], np.pi / 6, atol=1e-12)


@pytest.mark.parametrize("shift", (0.0, 0.3, 0.77))
def test_a_long_rod_is_as_exact_as_a_short_one(shift: float) -> None:
    """Twenty thousand periods on: phase errors grow with the length only as the rounding of its own period does."""
    periods = 20_000
    span = (periods + shift) * ELLIPTIC_PERIOD
    sol = solve(in_units_of_rho(0, 0, 0, span, np.pi / 6, 0.0), tol=1e-8, stations=[span])
    beta, alpha, z = EXACT["elliptic k=0.25 L=20"].exact(shift * ELLIPTIC_PERIOD)
    turn = EXACT["elliptic k=0.25 L=20"].exact(ELLIPTIC_PERIOD)[1]
    atol = 4e-16 * span * 10  # phase, times d beta/dt and its kin
    assert sol.solved, sol.outcome
    assert sol.beta[0] == pytest.approx(beta, abs=atol)
    assert sol.z[0] == pytest.approx(z, abs=atol)
    assert sol.alpha[0] == pytest.approx(periods * turn + alpha, abs=atol + 1e-15 * periods * turn)


@pytest.mark.parametrize("kp", PENDULUM_PERIODS)
def test_on_a_nearly_flat_surface_the_rod_is_a_planar_elastica(kp: float) -> None:
    """rho to infinity: the pendulum's period 4 K(k)/sqrt(p), to all figures, however near the separatrix."""
    quarter = pendulum_quarter(kp)
    assert 4 * quarter == pytest.approx(PENDULUM_PERIODS[kp], abs=1e-11)
    case = large_cylinder(kp)
    stations = quarter * np.array([1, 2, 3, 4, 4.5])
    sol = solve(case, tol=1e-13, stations=stations)
    assert sol.solved, sol.outcome
    # slope 2 across the loop: its place in s to 1e-12
    np.testing.assert_allclose(sol.beta[[0, 2]], np.pi, atol=2e-12)
    np.testing.assert_allclose(sol.beta[1], 2 * np.pi - case.given.beta, atol=1e-12)
    np.testing.assert_allclose(sol.beta[3], case.given.beta, atol=1e-12)


def test_a_pendulum_in_every_method_it_is_within_reach_of() -> None:
    case, quarter = large_cylinder(1e-2, rho=1e4), pendulum_quarter(1e-2)
    for name in core("start"):
        sol = solve(case, tol=1e-4, method=name, stations=quarter * np.linspace(0, 1, 21))
        assert sol.beta[-1] == pytest.approx(np.pi, abs=1e-4 * sol.condition), name  # as asked
