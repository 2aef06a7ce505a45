"""The Morse index of a rod by its turning points, against negative pivots, closed forms and difference quotients."""

from typing import Any

import numpy as np
import pytest

from solver import Case, equilibria, solve
from solver.observe.observables import observe
from solver.orbits.boundary import Path, boundary_of
from solver.orbits.mesh_index import index_at_stations, morse_index
from solver.orbits.path_orbits import orbit_of, variations_of
from solver.orbits.periodic_orbit import LIBRATION, jacobi_zeros, response, solve_orbit
from solver.problem.dimensionless import EndsProblem, StartProblem, reduce
from tests.cases import TABLE_1, ends_in_units_of_rho, helix_moment, in_units_of_rho, table_1


def index_of(case: Case, **how) -> float:
    return float(observe(solve(case, **{"tol": 1e-7, **how}), ["index"])["index"])


def random_problems(count: int, seed: int) -> StartProblem:
    rng = np.random.default_rng(seed)
    lam, mu, phi = rng.uniform(-2, 2, (3, count))
    span, beta0, dbeta0 = rng.uniform(0.5, 25, count), rng.uniform(-3, 3, count), rng.uniform(-1.5, 1.5, count)
    dbeta0[: count // 20] = 0  # some start at a turning point
    return StartProblem(lam, mu, phi, span, beta0, dbeta0=dbeta0)


def test_turning_points_count_the_negative_pivots_of_any_rod() -> None:
    problem = random_problems(300, 0)
    orbit = solve_orbit(problem, 1e-10)
    beta = orbit.at(problem.span[:, None] * np.linspace(0, 1, 6001))[0]
    zeros = jacobi_zeros(orbit)
    np.testing.assert_array_equal(zeros, morse_index(problem, problem.span / 6000, beta))
    assert zeros.max() > 8  # and not for want of any
    assert (np.abs(zeros - orbit.turns) == 1).any()


def test_the_jacobi_field_at_the_far_end_is_what_a_change_of_the_start_slope_makes_there() -> None:
    problem = random_problems(100, 1)
    orbit, nudge = solve_orbit(problem, 1e-13), 1e-5
    ends = [
        solve_orbit(problem.with_start(problem.dbeta0 + way * nudge), 1e-13).at(problem.span[:, None])[0][:, 0]
        for way in (-1, 1)
    ]
    change = (ends[1] - ends[0]) / (2 * nudge)
    told = np.where(orbit.kind == LIBRATION, response(orbit)[1], np.nan)
    swings = np.isfinite(told) & (np.abs(change) < 1e3)  # beyond, the nudge is too wide
    assert swings.sum() > 60
    np.testing.assert_allclose(told[swings], change[swings], rtol=1e-3, atol=1e-3)  # nudge^2 times the third change


@pytest.mark.parametrize(("numbers", "pin", "y", "turns"), (
    ((-4.742, 0.809, 0.311, 71.597, -1.034, -0.881), 0, -69.7, 2),
    ((0.0, 0.0, -3.64e-4, 4494.0, 0.0, 0.0), 2, -134.31, 1),  # a pipe: where terms of H cancel
))  # fmt: skip
def test_the_response_beside_a_saddle_is_that_of_the_variations(numbers: Any, pin: int, y: float, turns: int) -> None:
    """At such gaps beta keeps no digit of H, but beta_t does."""
    problem = EndsProblem(*np.array(numbers)[:, None])
    place = boundary_of(problem)
    path = Path(float(place.angles[pin]), -1.0, y, 1, turns)
    found = orbit_of(problem, path).response
    assert found is not None
    varied = variations_of(problem, path)
    eta = varied.change(np.linspace(0, problem.span[0], 20001)[None], varied.directions).beta[0, :, 1]
    assert found[0] == pytest.approx(max(1.0, np.abs(eta).max() / abs(eta[-1])), rel=1e-4)  # between stations


@pytest.mark.parametrize("L", (20.0, 500.0, 2e4, 2e6))
@pytest.mark.parametrize("reading", TABLE_1)
def test_the_index_is_the_number_of_bends_or_one_less_however_long_the_rod(reading: str, L: float) -> None:
    sol = solve(table_1(*reading.split("/"), L=L), stations=2)
    got = observe(sol, ["index", "bends"])
    assert got["bends"] - 1 <= got["index"] <= got["bends"] or got["bends"] == got["index"] == 0


def test_a_rod_that_goes_round_is_stable() -> None:
    assert index_of(in_units_of_rho(0.3, 0.2, 0.1, 1e5, 0.5, 2.5)) == 0


def test_an_equilibrium_read_by_itself_has_the_index_that_the_search_gave_it() -> None:
    """Those that hug a saddle to 1e-30 among them, which no start slope can tell."""
    found = equilibria(ends_in_units_of_rho(-0.3655, 0.7464, -0.7506, 150.0, np.pi / 6, np.pi / 6), stations=2)
    assert len(found) > 200
    for one in found:
        assert observe(one.solution, ["index"])["index"] == one.index


@pytest.mark.parametrize("method", ("dop853", "verlet"))
def test_a_march_counts_by_its_stations_and_says_when_they_are_too_few(method: str) -> None:
    case = table_1("force-first", "tension", "paper")
    assert index_of(case, method=method, tol=1e-6, stations=401) == index_of(case) == 6
    assert np.isnan(index_of(case, method=method, tol=1e-6, stations=21))


def test_stations_alone_count_the_many_short_waves_of_a_rod_under_a_large_load() -> None:
    """Along the axis under a push of 400: half waves of length pi/20."""
    problem = reduce(in_units_of_rho(0.0, 0.0, -400.0, 20.0, 0.0, 0.0))
    t = np.linspace(0, 20, 1001)[None]
    assert index_at_stations(problem, t, 0 * t, 0 * t)[0] == np.ceil(20 * 20 / np.pi) - 1


def test_a_straight_rod_answers_to_its_far_angle_as_sin_over_sin() -> None:
    """Under a push of a quarter beta moves by sin(t/2)/sin(span/2) where beta(L) moves by one."""
    found = equilibria(ends_in_units_of_rho(0.0, 0.0, -0.25, 8.0, 0.0, 0.0))
    (straight,) = [one for one in found if not one.solution.beta.any()]
    assert float(straight.solution.condition) == pytest.approx(1 / abs(np.sin(4.0)), rel=1e-12)


def test_a_rod_that_is_not_solved_has_no_index() -> None:
    case = in_units_of_rho(helix_moment(0.4, -0.3, 0.1), -0.3, 0.1, 400.0, 0.4, 0.0)
    sol = solve(case)
    assert not sol.solved
    assert np.isnan(observe(sol, ["index"])["index"])
