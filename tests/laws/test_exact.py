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

STEEP = {"helix at a saddle", "helix at a steep saddle", "buckled pipe 30 deg"}


@pytest.mark.parametrize("name, s, what, figures", FIGURES)
def test_the_closed_forms_give_the_figures(name: str, s: float, what: str, figures: float) -> None:
    """Tests the tests: the references are literal numbers of fifty-digit Taylor series."""
    shape = dict(zip(("beta", "alpha", "z"), EXACT[name].exact(s), strict=True))
    assert shape[what] == pytest.approx(figures, abs=1e-14)  # rounding of special functions


@pytest.mark.parametrize("name, s, what, figures", FIGURES)
@pytest.mark.parametrize("method, tol", [("orbit", 1e-12), ("dop853", 1e-13)])
def test_exact_figures_to_eleven_digits(
    method: str, tol: float, name: str, s: float, what: str, figures: float
) -> None:
    sol = solve(EXACT[name].case, tol=tol, method=method, stations=[s / 2, s])
    # as promised; dop853's tightest steps leave 1e-13, and the catenary's condition number is 300
    atol = 1e-10 if (method, name) == ("dop853", "catenary") else 1e-11
    assert getattr(sol, what)[-1] == pytest.approx(figures, abs=atol)


@pytest.mark.parametrize("name", EXACT)
@pytest.mark.parametrize("tol", (1e-6, 1e-12))
def test_orbit_follows_every_closed_form(name: str, tol: float) -> None:
    named = EXACT[name]
    sol = solve(named.case, tol=tol, method="orbit", stations=301)
    assert sol.solved, sol.outcome
    # tol, or at a saddle the rounding of the loads grown along the rod
    atol = max(tol if tol > 1e-11 else 1e-11, 1e-15 * sol.condition)
    for got, exact, unit in zip((sol.beta, sol.alpha, sol.z), named.exact(sol.s), (1, named.L, named.L), strict=True):
        np.testing.assert_allclose(got, exact, rtol=0, atol=atol * max(1, unit if tol > 1e-11 else 1))


@pytest.mark.parametrize("name", [name for name in EXACT if name not in STEEP and EXACT[name].L <= 60])
def test_dop853_follows_every_closed_form(name: str) -> None:
    named = EXACT[name]
    sol = solve(named.case, tol=1e-13, method="dop853", stations=101)
    assert sol.error < 1e-10 * max(1.0, sol.condition)  # what is left at its tightest tolerance, grown
    for got, exact, unit in zip((sol.beta, sol.alpha, sol.z), named.exact(sol.s), (1, named.L, named.L), strict=True):
        np.testing.assert_allclose(got, exact, rtol=0, atol=sol.error * max(1, unit))


@pytest.mark.parametrize("name", ("elliptic k=0.25 L=20", pytest.param("elliptic k=0.9 L=60", marks=pytest.mark.slow)))
def test_verlet_follows_the_closed_forms_to_its_tolerance(name: str) -> None:
    named = EXACT[name]
    sol = solve(named.case, tol=1e-7, method="verlet", stations=201)
    assert sol.solved, sol.outcome
    atol = 1e-7 * max(1, sol.condition)
    for got, exact in zip((sol.beta, sol.alpha, sol.z), named.exact(sol.s), strict=True):
        np.testing.assert_allclose(got, exact, rtol=0, atol=atol)


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
