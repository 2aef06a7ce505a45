"""Which equilibrium between two ends is meant by default: the stable one that stays nearest to its end angles."""

from functools import cache

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, equilibria, solve
from solver.equilibria import Equilibrium, meant
from solver.held.equilibrium_choice import select
from tests.cases import ends_in_units_of_rho
from tests.numerics.test_equilibria import PROBLEMS, found

every = pytest.mark.parametrize("name", PROBLEMS)


def pipe(L: float, FZ: float) -> Case:
    """Steel drill pipe, 127 mm outside and 108.6 mm inside, in a hole of 216 mm; m and kN."""
    return Case(Rod(2.06e8, 0.3, 0.0635, L, inner_radius=0.0543), Cylinder(0.108, "inside"), Ends(0.0, 0.0, FZ=FZ))


def strays_densely(sol: object) -> float:
    """How far beta goes beyond its end angles, from the stations alone."""
    beta = sol.beta  # type: ignore[attr-defined]
    low, high = sorted(beta[[0, -1]])
    return max(beta.max() - high, low - beta.min(), 0.0)


@cache
def densely(name: str) -> list[Equilibrium]:
    return equilibria(ends_in_units_of_rho(*PROBLEMS[name]), stations=2001)


def hidden(name: str) -> float:
    """How much of an extreme may lie between 2001 stations: h^2 |beta''|/8, and |beta''| = |H|."""
    lam, mu, phi, span, *_ = PROBLEMS[name]
    return (span / 2000) ** 2 * (abs(lam) + abs(mu) + abs(phi) + 2) / 8


@pytest.mark.parametrize("FZ", (-50.0, -175.0, -300.0))
def test_a_compressed_pipe_lies_in_lubinskis_helix_and_is_not_turned_round(FZ: float) -> None:
    L = 100.0
    sol = solve(pipe(L, FZ))
    A, rho = sol.case.rod.bending_stiffness, sol.case.rho
    middle = np.abs(sol.beta[100])
    # -F rho^2/A = 2 sin^2 cos: the helix with no torque, towards which both ends relax like tanh(k s/sqrt 2)
    ends = 16 * np.exp(-np.sqrt(-FZ / A / 2) * L)
    assert -FZ * rho**2 / A == pytest.approx(2 * np.sin(middle) ** 2 * np.cos(middle), rel=ends + 1e-9)
    pitch = 2 * np.pi * rho / np.tan(middle)
    assert pytest.approx(8 * np.pi**2 * A / pitch**2, rel=ends + 1e-3) == -FZ  # Lubinski: 0.99954 at one degree
    assert np.abs(sol.contact[100]) == pytest.approx(FZ**2 * rho / (4 * A), rel=ends + 1e-3)  # Mitchell: 1.00030
    assert sol.z[-1] > 0.999 * L
    assert sol.dbeta[0] > 0  # of the two mirror images


def test_before_it_buckles_the_pipe_is_straight() -> None:
    """Shorter than half a wave, pi sqrt(A/F), it stays on the axis."""
    case = pipe(1.0, -300.0)
    half_wave = np.pi * np.sqrt(float(case.rod.bending_stiffness) / 300)
    straight, buckled = (solve(pipe(share * half_wave, -300.0)) for share in (0.98, 1.02))
    assert np.abs(straight.beta).max() == 0
    assert np.abs(buckled.beta).max() > 1e-4


@every
def test_the_rule_takes_the_stable_one_that_strays_least(name: str) -> None:
    solutions = found(*PROBLEMS[name])
    sol = solve(ends_in_units_of_rho(*PROBLEMS[name]), stations=2001)
    stable = [one for one in solutions if one.index == 0]
    least = min(strays_densely(one.solution) for one in densely(name) if one.index == 0)
    assert strays_densely(sol) == pytest.approx(least, abs=hidden(name))
    assert sol.selection.count == len(solutions)
    assert sol.selection.stable == len(stable)
    one = meant(solutions)
    assert one is not None
    assert one.dbeta0 == pytest.approx(sol.dbeta[0], abs=1e-8)


@every
def test_the_lowest_energy_and_an_index_can_be_asked_for(name: str) -> None:
    case, solutions = ends_in_units_of_rho(*PROBLEMS[name]), found(*PROBLEMS[name])
    low = solve(case, choose="lowest")
    energies = [one.energy for one in solutions]
    taken = min(solutions, key=lambda one: float(np.abs(one.solution.beta - low.beta).max()))
    assert taken.energy == pytest.approx(min(energies), rel=1e-9)
    for index in {one.index for one in solutions}:
        sol = solve(case, choose=index)
        same = min(solutions, key=lambda one: float(np.abs(one.solution.beta - sol.beta).max()))
        assert same.index == index
        assert same.stray == pytest.approx(min(one.stray for one in solutions if one.index == index), abs=1e-9)


@every
def test_how_far_beta_strays_is_exact(name: str) -> None:
    for one in densely(name):
        dense = strays_densely(one.solution)
        assert dense - 1e-12 <= one.stray <= dense + hidden(name)


def test_an_index_that_no_equilibrium_has_is_said_in_the_outcome() -> None:
    sol = solve(ends_in_units_of_rho(*PROBLEMS["no loads"]), choose=99)
    assert not sol.solved
    assert "none of the 9 equilibria found has index 99; their indices: 0, 1" in sol.outcome
    assert np.isnan(sol.beta).all()


def test_ties_go_to_the_lower_energy_and_then_to_the_positive_slope() -> None:
    index, stray = np.array([0, 0, 0, 1]), np.array([0.5, 0.5 + 1e-13, 0.7, 0.0])
    assert select("nearest", index, np.array([2.0, 1.0, -9.0, -9.0]), stray, np.array([1.0, -1.0, 1.0, 1.0])) == 1
    assert select("nearest", index, np.array([1.0, 1.0, -9.0, -9.0]), stray, np.array([-1.0, 1.0, 1.0, 1.0])) == 1
    assert select("nearest", index + 1, np.array([1.0, 1.0, 0.0, 0.0]), stray, np.array([-1.0, 1.0, 1.0, 1.0])) == 3
    assert select("lowest", index, np.array([2.0, 1.0, -9.0, -9.5]), stray, np.array([1.0, -1.0, 1.0, 1.0])) == 3
    assert select(0, index, np.array([2.0, 2.0, -9.0, 0.0]), stray, np.array([1.0, -1.0, 1.0, 1.0])) == 0
    assert select(5, index, np.zeros(4), stray, np.zeros(4)) is None


def test_every_method_between_two_ends_takes_the_same() -> None:
    case = ends_in_units_of_rho(*PROBLEMS["symmetric"])
    usual = solve(case)
    for method in ("difference", "collocation"):
        other = solve(case, method=method)
        np.testing.assert_allclose(other.beta, usual.beta, atol=1e-6)
        assert other.selection == usual.selection


def test_a_case_without_an_equilibrium_of_the_index_leaves_its_neighbours_alone() -> None:
    case = Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0), Cylinder(0.75), Ends(beta0=0.5, betaL=0.8, FZ=[-4.0, -8.0]))
    sol = solve(case, choose=4)
    assert sol.solved.tolist() == [True, False]
    assert "none of the 15 equilibria found has index 4" in sol.outcome[1]
    single = solve(Case(case.rod, case.cylinder, Ends(beta0=0.5, betaL=0.8, FZ=-4.0)), choose=4)
    np.testing.assert_array_equal(sol.beta[0], single.beta)


def test_nothing_is_selected_where_a_load_is_too_large_for_floats() -> None:
    sol = solve(pipe(20.0, np.array([-1.0, -1e300])))  # type: ignore[arg-type]
    assert sol.solved.tolist() == [True, False]
    assert [one is None for one in sol.selection] == [False, True]
    assert solve(pipe(20.0, -1e300)).selection is None
