"""The condition number and the error estimate: whether they say how much can be trusted."""

import numpy as np
import pytest

from solver import Case, Start, solve
from tests.cases import START, Named, helix_moment, in_units_of_rho, start_of
from tests.reach import core
from tests.references import references

STARTS = core("start")


@pytest.mark.parametrize("name", START)
def test_the_condition_number_is_right_within_a_digit_and_a_half(name: str) -> None:
    """Against the variational equation in forty digits. Too small a number would excuse nothing, too large anything."""
    reference = references()[name].condition
    sol = solve(START[name].case, tol=1e-8, stations=201)
    assert reference / 5 <= sol.condition <= 30 * reference


@pytest.mark.parametrize("method", STARTS)
@pytest.mark.parametrize("name", ("twist-first/tension/paper", "going round", "passing a saddle at 0.01", "long"))
def test_a_change_of_the_start_grows_as_the_condition_number_says(name: str, method: str) -> None:
    case, change = START[name].case, 1e-7
    given = case.given
    # a march knows the growth between its stations only roughly: so they are close
    sol = solve(case, tol=1e-10 if method == "orbit" else 1e-5, method=method, stations=1601)
    grown = []
    exact = solve(case, tol=1e-12, stations=401)
    for beta, dbeta in ((change, 0.0), (0.0, change / case.rho)):
        moved = start_with(case, given.beta + beta, given.dbeta + dbeta)
        grown.append(np.abs(solve(moved, tol=1e-12, stations=401).beta - exact.beta).max() / change)
    # rough: the condition number is meant to be right within a digit or two
    assert max(grown) / 5 <= sol.condition <= 30 * max(grown)


def start_with(case: Case, beta: float, dbeta: float) -> Case:
    """Another start under the same FZ, MZ and M3."""
    A = case.rod.bending_stiffness
    FZ, MZ, M3 = case.loads
    start = start_of(case.rod, case.rho, MZ / A, M3 / A, FZ / A, beta, dbeta)
    assert isinstance(start, Start)
    return Case(case.rod, case.cylinder, start)


def test_growth_is_linear_along_a_rod_that_librates() -> None:
    """L = 400 cm under Table 1 (twist-first, compression): about 2e2, and twice as much at twice the length."""
    numbers = 0.2, 0.1, -0.5
    short, long = (float(solve(in_units_of_rho(*numbers, span, 0.7, 0.3)).condition) for span in (400.0, 800.0))
    assert long / short == pytest.approx(2, rel=0.05)


def test_growth_is_exponential_at_a_saddle() -> None:
    """A straight rod in tension: exp(sqrt(phi) L)."""
    for span in (5.0, 10.0, 20.0):
        sol = solve(in_units_of_rho(0, 0, 1.0, span, 0.0, 0.0))
        assert sol.condition == pytest.approx(np.cosh(span), rel=1e-3)


def test_a_constant_h_proves_nothing() -> None:
    """A helix at a saddle, long enough: the march holds h and loses the rod. The condition number knew."""
    beta = 1.1
    last_digit = -1e-16
    case = in_units_of_rho(helix_moment(beta, 0.4, 0.2), 0.4, 0.2, 80.0, beta, last_digit)
    march = solve(case, tol=1e-8, method="dop853", rtol=1e-13)
    assert np.ptp(march.h) < 1e-11
    assert np.abs(march.beta - beta).max() > 1
    assert march.condition * 2e-16 > 1


def test_no_length_of_a_stable_helix_is_ill_conditioned() -> None:
    sol = solve(in_units_of_rho(0, 0, -1.0, 1e5, 0.0, 0.0))
    assert sol.condition == pytest.approx(1, abs=1e-9)


def test_what_condition_costs_is_said_in_the_outcome() -> None:
    case = in_units_of_rho(0, 0, 1.0, 25.0, 1e-9, 0.0)
    sol = solve(case, tol=1e-12)
    assert sol.solved
    assert sol.outcome != "solved"
    assert "condition" in sol.outcome
    easy = solve(case, tol=1e-4)
    assert easy.outcome == "solved"


@pytest.mark.parametrize("extrapolate", (False, True))
def test_a_method_that_misses_its_tolerance_says_so(extrapolate: bool) -> None:
    """Twenty steps for two periods; the sentence holds the error, the tolerance and the condition number."""
    case = START["elliptic k=0.25 L=20"].case
    sol = solve(case, tol=1e-8, method="verlet", stations=21, steps=1, extrapolate=extrapolate)
    exact = START["elliptic k=0.25 L=20"].exact(sol.s)[0]
    assert np.abs(sol.beta - exact).max() > 1e-8 * sol.condition
    assert not sol.solved
    assert sol.outcome.startswith("failed")
    for number in (sol.error, 1e-8, sol.condition):
        assert f"{number:.1e}" in sol.outcome


def test_the_error_of_orbit_bounds_what_forty_digits_show() -> None:
    """Over all cases together, at three tolerances: never ten times below the truth, rounding aside."""
    for tol in (1e-3, 1e-6, 1e-9):
        for name, reference in references().items():
            named: Named = START[name]
            sol = solve(named.case, tol=tol, stations=9)
            off = np.abs(sol.beta[1:] - reference.beta).max()
            assert off <= 3 * sol.error + 2e-15 * reference.condition, (name, tol)
