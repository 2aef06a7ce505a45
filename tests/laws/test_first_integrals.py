"""What stays constant along the rod, rebuilt from vectors where there are any, and what the start was given."""

from dataclasses import replace

import numpy as np
import pytest

from solver import Solution, observe, solve
from tests.cases import EXACT, GENERAL, TABLE_1, Named, table_1
from tests.laws.test_balance import force, largest, moment

CASES: dict[str, Named] = {**TABLE_1, **GENERAL, "catenary": EXACT["catenary"]}


@pytest.fixture(scope="module", params=CASES)
def sol(request: pytest.FixtureRequest) -> Solution:
    answer = solve(CASES[request.param].case, tol=1e-11)
    assert answer.solved, answer.outcome
    return answer


def test_axial_force_is_constant(sol: Solution) -> None:
    F = force(sol)
    assert largest(F[:, 2] - sol.FZ) <= 1e-14 * largest(F)  # rounding


def test_axial_moment_of_force_and_couple_is_constant(sol: Solution) -> None:
    F, M = force(sol), moment(sol)
    arm = np.cross(sol.position, F)
    assert largest((arm + M)[:, 2] - sol.MZ) <= 1e-14 * (largest(arm) + largest(M))  # rounding


def test_h_is_constant(sol: Solution) -> None:
    """eq. (32), from beta and beta' as they are and G as the paper writes it (with rho for R)."""
    A, rho, b = sol.case.rod.bending_stiffness, sol.case.rho, sol.beta
    l, m, p = sol.MZ / A, sol.M3 / A, sol.FZ / A
    G = (2 * (l - m * np.cos(b)) - np.sin(b) ** 3 / rho) * np.sin(b) / rho + 2 * p * np.cos(b)
    h = sol.dbeta**2 + G
    scale = largest(sol.dbeta**2) + largest(G)
    assert largest(h - h[0]) <= 1e-11 * scale  # the tolerance asked for
    assert largest(sol.h - h) <= 1e-13 * scale  # rounding


def test_tension_and_bending_energy_per_length_add_up(sol: Solution) -> None:
    """F3 + A kappa^2/2 = A h/2: the contact has no part along the rod; eq. (27)."""
    bending = sol.case.rod.bending_stiffness / 2 * sol.kappa**2
    level = sol.case.rod.bending_stiffness / 2 * sol.h[0]
    assert largest(sol.F3 + bending - level) <= 1e-11 * (largest(sol.F3) + largest(bending))  # the tolerance asked for


def test_the_section_force_at_the_start_is_the_one_given(sol: Solution) -> None:
    given = sol.case.given
    scale = np.abs(force(sol)[0]).max() + abs(sol.M3) / sol.case.rho
    for got, wanted in ((sol.F1[0], given.F1), (sol.F2[0], given.F2), (sol.F3[0], given.F3)):
        if wanted is not None:
            assert abs(got - wanted) <= 1e-13 * scale  # rounding


def test_the_twist_rate_at_the_start_is_the_one_given(sol: Solution) -> None:
    if sol.case.given.dgamma is None:
        pytest.skip("the twist is given by F1")
    slope = np.sin(sol.beta[0]) * np.cos(sol.beta[0]) / sol.case.rho
    rate = sol.M3 / sol.case.rod.torsional_stiffness - slope
    assert rate == pytest.approx(sol.case.given.dgamma, abs=1e-14 * (1 + abs(rate)))  # rounding


def test_a_start_by_its_twisting_moment_has_the_normal_force_and_the_twist_rate_that_go_with_it() -> None:
    case = table_1("force-first", "tension", "paper")
    by_force = solve(case, stations=3)
    start = replace(case.given, F1=None, M3=by_force.M3)
    by_moment = solve(replace(case, given=start), stations=3)
    many = np.linspace(0.1, 1.0, 50)
    np.testing.assert_array_equal(replace(case, given=replace(start, M3=many)).loads[2], many)  # as given, not rounded
    assert by_moment.F1[0] == pytest.approx(case.given.F1, rel=1e-13)  # rounding
    assert pytest.approx(by_force.MZ, rel=1e-14) == by_moment.MZ


def test_energy_is_the_integral_of_its_density() -> None:
    """Routh's: A/2 kappa^2 + M3 sin cos/rho - FZ cos - MZ sin/rho, against the trapezoidal rule on many stations;
    and what twist and the work of M3 on M3 L/C leave of each other."""
    case = TABLE_1["twist-first/compression/solid"].case
    sol = solve(case, tol=1e-11, stations=20001)
    s, c, rho = np.sin(sol.beta), np.cos(sol.beta), case.rho
    density = case.rod.bending_stiffness / 2 * sol.kappa**2 + sol.M3 * s * c / rho - sol.FZ * c - sol.MZ * s / rho
    expected = np.trapezoid(density, sol.s) - sol.M3**2 * case.rod.L / (2 * case.rod.torsional_stiffness)
    assert observe(sol, ["energy"])["energy"] == pytest.approx(expected, rel=1e-6)  # step^2 of the rule


# docs/explanation/physics.md, section 6: as many figures as it prints
@pytest.mark.parametrize("stiffness, F1, dgamma", [("paper", -2.268, 2.714), ("solid", -9.071, 1.572)])
def test_table_1_contradicts_itself(stiffness: str, F1: float, dgamma: float) -> None:
    """gamma0' = 0.5 gives F10 = -2.268 N, not the 5 N beside it; 5 N need gamma0' = 2.714; no stiffness helps."""
    by_twist = solve(table_1("twist-first", "tension", stiffness), tol=1e-6)
    assert by_twist.F1[0] == pytest.approx(F1, abs=5e-4)
    by_force = solve(table_1("force-first", "tension", stiffness), tol=1e-6)
    slope = np.sin(by_force.beta[0]) * np.cos(by_force.beta[0]) / by_force.case.rho
    rate = by_force.M3 / by_force.case.rod.torsional_stiffness - slope
    assert rate == pytest.approx(dgamma, abs=5e-4)
