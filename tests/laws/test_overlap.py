"""Whether the rod passes through itself: against brute force on dense points, and what holds whatever the length."""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial import cKDTree

from solver import Case, Cylinder, Rod, Start, solve
from solver.methods import available
from solver.observe.measurement import MeasuredNumbers
from solver.observe.observables import observe, self_intersection
from tests.cases import cylinder_of, helix_moment, in_units_of_rho, rod_of_unit_stiffness, start_of, table_1


def overlaps(case: Case, stations: int = 2, **how) -> float:
    return float(observe(solve(case, **{"tol": 1e-7, "stations": stations, **how}), ["overlaps"])["overlaps"])


def drawn(seed: int, span: float, a: float | None = None) -> Case:
    rng = np.random.default_rng(seed)
    thick = 10 ** rng.uniform(-1.7, -0.4)
    lam, mu, phi = rng.uniform(-1.5, 1.5, 3)
    rod = rod_of_unit_stiffness(span, thick if a is None else a)
    start = start_of(rod, 1.0, lam, mu, phi, rng.uniform(-3, 3), rng.uniform(-1.5, 1.5))
    return Case(rod, cylinder_of(1.0, rod.a, "outside"), start)


def closest(case: Case) -> float:
    """Smallest distance over 2 a of points, a/40 apart, that are more than pi a apart along the rod; 0 for a bend
    tighter than the rod."""
    a, L = float(case.rod.a), float(case.rod.L)
    sol = solve(case, stations=int(40 * L / a) + 2)
    if sol.kappa.max() * a >= 1:
        return 0.0
    pairs = cKDTree(sol.position).query_pairs(2.1 * a, output_type="ndarray")
    far = pairs[np.abs(np.diff(sol.s[pairs], axis=1)[:, 0]) > np.pi * a]
    away = np.linalg.norm(np.diff(sol.position[far], axis=1)[:, 0], axis=1)
    return float(away.min(initial=2.1 * a)) / (2 * a)


@pytest.mark.slow
def test_dense_points_agree() -> None:
    seen = []
    for seed in range(60):
        case = drawn(seed, 12.0)
        distance = closest(case)
        if (
            abs(distance - 1) > 2e-3
        ):  # dense points miss the smallest distance by the square of a/40, ours by a thousandth
            seen.append(overlaps(case))
            assert seen[-1] == (distance < 1), (seed, distance)
    assert 15 < sum(seen) < 45


@pytest.mark.slow
def test_a_longer_rod_of_the_same_start_never_stops_passing_through_itself() -> None:
    late = 0
    for seed in range(40):
        told = [overlaps(drawn(seed, span, 0.05)) for span in np.geomspace(1, 1e6, 13)]
        assert (np.diff(told) >= 0).all(), (seed, told)
        late += told[0] < told[-1]
    assert late > 10


def helix(a: float, span: float) -> Case:
    beta, mu, phi = 1.4, 0.9, -0.4
    lam = helix_moment(beta, mu, phi)
    rod = rod_of_unit_stiffness(span, a)
    return Case(rod, cylinder_of(1.0, a, "outside"), start_of(rod, 1.0, lam, mu, phi, beta, 0.0))


def test_a_helix_meets_itself_from_the_radius_on_at_which_its_turns_touch() -> None:
    """Neighbouring turns: 2 sin(sin(beta) t/2) round and cos(beta) t up, closest a little before a whole turn."""
    near = minimize_scalar(
        lambda t: np.hypot(2 * np.sin(np.sin(1.4) * t / 2), np.cos(1.4) * t), bounds=(5, 7), options={"xatol": 1e-10}
    )
    for span in (8.0, 1e3, 1e7):
        assert overlaps(helix(near.fun / 2 * 0.998, span)) == 0
        assert overlaps(helix(near.fun / 2 * 1.002, span)) == 1
    assert overlaps(helix(near.fun / 2 * 1.002, near.x - 1)) == 0  # too short for the turns to meet


def test_the_stations_do_not_matter() -> None:
    for L in (20.0, 500.0, 2e4):
        case = table_1("twist-first", "compression", "paper", L=L)
        assert {overlaps(case, stations) for stations in (2, 5, 201)} == {0.0}
        case = table_1("force-first", "tension", "paper", L=L)
        assert {overlaps(case, stations) for stations in (2, 5, 201)} == {1.0}


@pytest.mark.parametrize("seed", range(8))
def test_dense_stations_of_a_march_tell_the_same(seed: int) -> None:
    case = drawn(seed, 12.0)
    assert overlaps(case, 1501, method="dop853") == overlaps(case)


def test_a_march_with_coarse_stations_says_that_it_cannot_be_told() -> None:
    apart, met = in_units_of_rho(0.3, 0.2, -0.5, 20.0, 0.5, 0.3), table_1("force-first", "tension", "paper")
    assert overlaps(apart) == 0
    assert np.isnan(overlaps(apart, 21, method="dop853"))
    assert overlaps(met, 161, method="dop853") == 1  # two stations closer than 2 a are so however coarse the others


def test_a_rod_that_is_not_solved_cannot_be_told_and_leaves_its_neighbours_alone() -> None:
    lam = helix_moment(0.4, -0.3, 0.1)
    got = observe(solve(in_units_of_rho(lam, -0.3, 0.1, np.array([2.0, 400.0]), 0.4, 0.0)), ["overlaps"])["overlaps"]
    assert got[0] == 0
    assert np.isnan(got[1])


def many(cases: int, seed: int = 7) -> Case:
    """Rods of all thicknesses and of 1 to 1e6 rho."""
    rng = np.random.default_rng(seed)
    a, span = 10 ** rng.uniform(-1.7, -0.4, cases), 10 ** rng.uniform(0, 6, cases)
    lam, mu, phi = rng.uniform(-1.5, 1.5, (3, cases))
    rod = rod_of_unit_stiffness(span, a)
    beta, dbeta = rng.uniform(-3, 3, cases), rng.uniform(-1.5, 1.5, cases)
    return Case(rod, cylinder_of(1.0, a, "outside"), start_of(rod, 1.0, lam, mu, phi, beta, dbeta))


def picked(case: Case, rows: Any) -> Case:
    """Some of the cases of `many`."""
    rod = Rod(case.rod.E[rows], case.rod.nu, case.rod.a[rows], case.rod.L[rows])
    given = {name: getattr(case.given, name)[rows] for name in ("beta", "dbeta", "F2", "F3", "dgamma")}
    return Case(rod, Cylinder(case.cylinder.R[rows], "outside"), Start(**given))


@pytest.mark.parametrize("method", [name for name in ("orbit", "swing") if name in available()])
def test_a_rod_is_judged_as_if_it_were_alone(method: str) -> None:
    """Hundreds of rods are looked at together; none is told from a neighbour, whoever else gives up or is long."""
    case = many(300)
    together = observe(solve(case, tol=1e-7, method=method, stations=2), ["overlaps"])["overlaps"]
    assert 50 < together.sum() < 250
    rows = np.arange(0, 300, 15)
    alone = [overlaps(picked(case, i), method=method) for i in rows]
    assert together[rows].tolist() == alone
    backwards = np.arange(299, -1, -1)
    again = observe(solve(picked(case, backwards), tol=1e-7, method=method, stations=2), ["overlaps"])["overlaps"]
    assert (again[::-1] == together).all()


def test_a_rod_that_lies_along_itself_is_given_up_and_its_neighbours_are_not() -> None:
    """The turns of a helix almost touch, so all its pairs are near: with fewer allowed it alone is not decided."""
    near = minimize_scalar(
        lambda t: np.hypot(2 * np.sin(np.sin(1.4) * t / 2), np.cos(1.4) * t), bounds=(5, 7), options={"xatol": 1e-10}
    )
    a = near.fun / 2 * np.array([0.3, 1 - 1e-5, 0.5, 1.05])
    lam = helix_moment(1.4, 0.9, -0.4)
    rod = rod_of_unit_stiffness(100.0, a)
    case = Case(rod, cylinder_of(1.0, a, "outside"), start_of(rod, 1.0, lam, 0.9, -0.4, 1.4, 0.0))
    sol = solve(case, tol=1e-7, stations=2)
    assert observe(sol, ["overlaps"])["overlaps"].tolist() == [0, 0, 0, 1]
    np.testing.assert_array_equal(self_intersection(MeasuredNumbers(sol), most_pairs=1500), [0, np.nan, 0, 1])


def test_how_many_periods_are_compared_together_does_not_matter() -> None:
    sol = solve(many(200, seed=2), tol=1e-7, stations=2)
    found = observe(sol, ["overlaps"])["overlaps"]
    np.testing.assert_array_equal(self_intersection(MeasuredNumbers(sol), together=1), found)
