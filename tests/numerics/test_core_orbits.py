"""Quadrature over orbits by the compiled core: equal bits in any batch and thread, and no critical point lost."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, equilibria
from solver.core.library import Cutting
from solver.orbits.boundary import critical_points
from solver.orbits.periodic_orbit import judge, orbits_of, solve_orbit
from solver.orbits.potential import Loads, slope
from solver.problem.dimensionless import Reduced, StartProblem
from tests.cases import ends_in_units_of_rho

KINDS = ("anywhere", "gap at a saddle", "rest at a saddle", "beside a centre", "about a saddle", "coinciding helices")
REFERENCE = (-0.3655, 0.7464, -0.7506, 20.0, np.pi / 6, np.pi / 6)  # 31 equilibria


def problems(kind: str, size: int) -> StartProblem:
    """Random start problems: loads of 1e-3 to 30, lengths of 0.01 to 1000, gaps from 1e-4 down to 1e-300."""
    rng = np.random.default_rng(KINDS.index(kind))
    decades = lambda low, high: 10.0 ** rng.uniform(low, high, size)  # noqa: E731
    lam, mu, phi = rng.normal(size=(3, size)) * decades(-3, 1.5)
    if kind == "coinciding helices":  # lam = mu: two roots of H meet at beta = 0
        lam, phi = np.where(rng.random(size) < 0.8, mu, lam), np.where(rng.random(size) < 0.7, phi, 0.0)
    span, beta0, rate = decades(-2, 3), rng.uniform(-4, 4, size), rng.normal(size=size) * decades(-3, 1)
    if kind in ("gap at a saddle", "rest at a saddle", "beside a centre", "about a saddle"):
        found = critical_points(Reduced(lam, mu, phi, span, beta0))
        wanted = found.centre if kind == "beside a centre" else ~found.centre
        rank = [rng.choice(np.flatnonzero(wanted[b, : found.count[b]])) for b in range(size)]
        beta0, sign = found.beta[np.arange(size), rank], rng.choice([-1.0, 1.0], size)
        if kind == "gap at a saddle":
            rate = decades(-150, -2) * sign
        elif kind == "rest at a saddle":
            beta0, rate = beta0 + decades(-14, -2) * sign, np.zeros(size)
        elif kind == "beside a centre":
            rate = decades(-12, 1) * sign
        else:
            beta0, rate = beta0 + decades(-8, -2) * sign, decades(-8, -2) * rng.choice([-1.0, 1.0], size)
    return StartProblem(lam, mu, phi, span, beta0, rate)


@pytest.mark.parametrize("kind", KINDS)
def test_critical_points_are_all_roots_of_h(kind: str) -> None:
    problem = problems(kind, 300)
    found = critical_points(problem)
    size = 1 + np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi)
    off = np.abs(slope(Loads.columns(problem), found.beta)) / size[:, None]
    assert np.nanmax(off) < 1e-14
    assert (found.count % 2 == 0).all()
    assert (found.centre.sum(axis=1) == found.count // 2).all()
    if kind != "coinciding helices":  # two of these roots are no change of sign
        signs = slope(Loads.columns(problem), np.linspace(-np.pi, np.pi, 4002)[None, :-1]) > 0
        assert (np.count_nonzero(signs != np.roll(signs, 1, axis=1), axis=1) <= found.count).all()


def test_an_orbit_is_the_same_bits_alone_in_a_batch_and_in_any_thread() -> None:
    problem = problems("about a saddle", 64)
    t = problem.span[:, None] * np.linspace(0, 1, 33)
    together = solve_orbit(problem, 1e-13)
    whole = np.stack(together.at(t))
    growth, error = judge(together)

    def alone(b: int) -> None:
        one = solve_orbit(problem.take(slice(b, b + 1)), 1e-13)
        np.testing.assert_array_equal(np.stack(one.at(t[b : b + 1])), whole[:, b : b + 1])
        assert judge(one) == (growth[b], error[b])

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(alone, range(problem.size)))


def test_the_width_of_the_lanes_changes_no_bit() -> None:
    for kind in KINDS:
        many = problems(kind, 20)
        one, two = (orbits_of(many, None, 22, Cutting(0.45, 1e-14, 1.0, lanes)) for lanes in (2, 0))
        assert one is not None
        assert two is not None
        for name in ("kind", "direction", "since", "first", "count", "duration", "gain"):
            np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
        for name, values in vars(one.panels).items():
            np.testing.assert_array_equal(values, getattr(two.panels, name))


def test_the_core_refuses_numbers_that_are_not_finite() -> None:
    for row in ([np.nan, 0, 0, 1, 0, 0], [0, np.inf, 0, 1, 0, 0], [0, 0, 0, 1, 0, np.nan]):
        assert orbits_of(StartProblem(*np.array([row], dtype=float).T), None, 22, Cutting(0.45, 1e-14, 1.0)) is None
    empty = orbits_of(StartProblem(*np.empty((6, 0))), None, 22, Cutting(0.45, 1e-14, 1.0))
    assert empty is not None
    assert empty.panels.arc.size == 0


@pytest.mark.parametrize("name", ["lam", "span", "beta0", "dbeta0"])
def test_a_problem_that_is_not_finite_has_no_orbit_and_leaves_its_neighbours_alone(name: str) -> None:
    problem = problems("anywhere", 5)
    alone, lost = solve_orbit(problem, 1e-13), np.arange(5) == 2
    broken = replace(problem, **{name: np.where(lost, np.nan, getattr(problem, name))})
    t = problem.span[:, None] * np.linspace(0, 1, 7)
    for pin in (None, (problem.beta0, problem.dbeta0**2, np.zeros(problem.size))):
        for theirs, mine in zip(alone.at(t), solve_orbit(broken, 1e-13, pin).at(t), strict=True):
            np.testing.assert_allclose(mine[~lost], theirs[~lost], rtol=1e-9, atol=1e-9)
            assert np.isnan(mine[lost]).all()
    if name == "lam":
        assert critical_points(broken).count[lost] == 0
        np.testing.assert_array_equal(critical_points(broken).beta[~lost], critical_points(problem).beta[~lost])


PIPE = Case(Rod(2.06e8, 0.3, 0.0635, 300.0, inner_radius=0.0543), Cylinder(0.108, "inside"), Ends(0.0, 0.0, FZ=-300.0))


@pytest.mark.parametrize("name, count", [("reference", 31), pytest.param("pipe", 851, marks=pytest.mark.slow)])
def test_no_equilibrium_is_lost(name: str, count: int) -> None:
    found = equilibria(PIPE if name == "pipe" else ends_in_units_of_rho(*REFERENCE), stations=2)
    assert found.complete
    assert len(found) == count
