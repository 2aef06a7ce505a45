"""Quadrature over orbits by the compiled core: what NumPy computes by the same rule, for any batch and any thread."""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import numpy as np
import pytest

from solver.boundary.end_conditioning import reference_response
from solver.boundary.level_brackets import brackets_on_grid, reference_roots, roots_in
from solver.boundary.level_grid import boundary_of, level_grid_of
from solver.boundary.paths import paths
from solver.boundary.transit_times import fall, reference_fall, reference_transit_times, transit_times
from solver.core import orbits as core
from solver.core.build import OFF
from solver.core.panels import Cutting, available
from solver.orbit.conditioning import condition
from solver.orbit.critical_points import critical_points, grid, reference_critical_points
from solver.orbit.error_estimate import estimated_error
from solver.orbit.orbit_energy import reference_action
from solver.orbit.periodic_orbit import (
    Orbit,
    reference_orbit,
    reference_relative_orbit,
    relative_orbit,
    solve_orbit,
)
from solver.problem.reduced import EndsProblem, Reduced, StartProblem

pytestmark = pytest.mark.skipif(not available(), reason="the compiled core is missing or switched off")

KINDS = ("anywhere", "gap at a saddle", "rest at a saddle", "beside a centre", "about a saddle", "coinciding helices")
TOLERANCES = ((1e-13, 22, 0.45), (1e-5, 16, 0.6))  # nodes and length of panels: `solve_orbit`
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


def values_by_numpy(orbit: Orbit, t: Any) -> Any:
    """beta, beta_t, alpha and z as NumPy reads the panels."""
    phase = orbit.locate(t)
    return orbit._unfold(orbit.read(orbit.panels.series[:, :4], phase), phase)


def both(kind: str, tolerance: Any, size: int = 0) -> tuple[Orbit, Orbit]:
    """The orbits of NumPy and of the core; those next to a saddle take NumPy long."""
    tol, nodes, length = tolerance
    problem = problems(kind, size or (12 if "saddle" in kind else 100))
    return reference_orbit(problem, nodes, Cutting(length, 0.05 * tol, 1.0)), solve_orbit(problem, tol)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_orbits_agree_with_those_of_numpy(kind: str, tolerance: Any) -> None:
    agree(*both(kind, tolerance))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_many_orbits_agree_with_those_of_numpy(kind: str) -> None:
    agree(*both(kind, TOLERANCES[0], 500))


def agree(plain: Orbit, compiled: Orbit) -> None:
    """Values along the rods agree to 1e-13 over the condition number, and what both leave out by the tolerance."""
    assert (plain.kind == compiled.kind).all()
    np.testing.assert_allclose(compiled.duration, plain.duration, rtol=1e-10)
    np.testing.assert_allclose(compiled.gain, plain.gain, rtol=1e-10, atol=1e-12)
    growth = condition(plain)
    error = estimated_error(plain, growth)
    t = plain.problem.span[:, None] * np.linspace(0, 1, 21)
    long = np.maximum(1, plain.problem.span)[:, None]
    quick = np.maximum(1, np.abs(values_by_numpy(plain, t)[1]).max(axis=1))[:, None]
    units = (1.0, quick, long, long)
    off = [np.abs(a - b) / unit for a, b, unit in zip(values_by_numpy(plain, t), compiled.at(t), units, strict=True)]
    assert (np.max(off, axis=(0, 2)) <= 1e-13 * growth + 2 * error).all()


@pytest.mark.parametrize("kind", KINDS)
def test_judgement_of_an_orbit_agrees_with_that_of_numpy(kind: str) -> None:
    orbit, _ = both(kind, TOLERANCES[0])
    (growth, error), expected = core.judge(orbit), condition(orbit)
    np.testing.assert_allclose(growth, expected, rtol=1e-11)
    # the error holds the rounding of the series at the start, which the order of a sum changes
    assert (np.abs(np.log(error / estimated_error(orbit, expected))) < np.log(3)).all()
    response = reference_response(orbit)
    np.testing.assert_allclose(
        core.response(orbit), response, rtol=1e-12 * response.max(initial=1.0, where=response < 1e12)
    )
    largest = np.square(orbit.panels.series[:, 1]).max(initial=0.0)
    np.testing.assert_allclose(core.action(orbit), reference_action(orbit), rtol=1e-11, atol=1e-13 * largest)


@pytest.mark.parametrize("kind", KINDS)
def test_critical_points_agree_with_those_of_numpy(kind: str) -> None:
    problem = problems(kind, 300)
    plain, compiled = reference_critical_points(problem), critical_points(problem)
    np.testing.assert_array_equal(plain.count, compiled.count)
    np.testing.assert_array_equal(plain.centre, compiled.centre)
    # a root is as uncertain as the rounding of H over its slope, next to a fold its root
    apart = np.abs(plain.beta - compiled.beta)
    assert (np.nanmax(np.minimum(apart, 2 * np.pi - apart), axis=1) < 1e-7).all()
    assert np.nanmedian(apart) < 1e-15


def test_an_orbit_is_the_same_bits_alone_in_a_batch_and_in_any_thread() -> None:
    problem = problems("about a saddle", 64)
    t = problem.span[:, None] * np.linspace(0, 1, 33)
    together = solve_orbit(problem, 1e-13)
    whole = np.stack(together.at(t))
    growth, error = core.judge(together)

    def alone(b: int) -> None:
        one = solve_orbit(problem.take(slice(b, b + 1)), 1e-13)
        np.testing.assert_array_equal(np.stack(one.at(t[b : b + 1])), whole[:, b : b + 1])
        assert core.judge(one) == (growth[b], error[b])

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(alone, range(problem.size)))


def test_the_width_of_the_lanes_changes_no_bit() -> None:
    for kind in KINDS:
        numbers = core.numbers_of(problems(kind, 20))
        one, two = (core.orbits(numbers, None, grid(), 22, Cutting(0.45, 1e-14, 1.0, lanes)) for lanes in (2, 0))
        assert one is not None
        assert two is not None
        for first, second in zip(one, two, strict=True):
            np.testing.assert_array_equal(first, second)


@cache
def ends_problems() -> list[EndsProblem]:
    """The reference problem, two whole turns, a long rod under little load, and random ones."""
    rng = np.random.default_rng(7)
    rows: list[Any] = [REFERENCE, (0.4, -0.2, 0.3, 12.0, 0.3, 0.3 + 4 * np.pi), (0.0, 0.0, -0.05, 400.0, 0.1, -0.1)]
    rows += [(*rng.normal(size=3), 10 ** rng.uniform(0, 1.5), *rng.uniform(-3, 3, 2)) for _ in range(20)]
    return [EndsProblem(*(np.array([v]) for v in row)) for row in rows]


@pytest.mark.parametrize("number", range(23))
def test_transit_times_and_levels_agree_with_those_of_numpy(number: int) -> None:
    problem = ends_problems()[number]
    boundary, grid = level_grid_of(boundary_of(problem))
    plain, compiled = (f(boundary, grid.levels) for f in (reference_transit_times, transit_times))
    np.testing.assert_array_equal(plain.rotates, compiled.rotates)
    np.testing.assert_allclose(compiled.time, plain.time, rtol=2e-13, atol=1e-13)
    np.testing.assert_allclose(compiled.rate, plain.rate, rtol=1e-12)
    some = paths(boundary, 12)
    brackets, _ = brackets_on_grid(boundary, grid, compiled, some, 0)
    brackets = brackets.take(brackets.first != brackets.second)
    counts = some.counts(boundary.rising)[brackets.path]
    if counts.size:
        expected, found = reference_roots(boundary, brackets, counts)[0], roots_in(boundary, brackets, counts)[0]
        np.testing.assert_array_equal(np.isnan(expected), np.isnan(found))
        # a level is uncertain where the length hardly changes with it
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
        assert np.nanmedian(np.abs(found - expected)) < 1e-13


def test_falls_agree_with_those_of_numpy() -> None:
    for problem in ends_problems():
        found = boundary_of(problem).found
        for pin in found.beta[0, : found.count[0]]:
            for beta in (pin, pin + 1e-9, -2.0, 0.0, 0.7, 3.1):
                beta = float((beta + np.pi) % (2 * np.pi) - np.pi)
                for extremum in (True, False):
                    pair = [f(problem, float(pin), beta, extremum) for f in (fall, reference_fall)]
                    np.testing.assert_allclose(*pair, rtol=1e-13, atol=1e-15)


def test_numbers_that_are_not_finite_are_left_to_the_reference() -> None:
    grid = (np.linspace(-3, 3, 8), np.zeros((5, 16)))
    for row in ([np.nan, 0, 0, 1, 0, 0], [0, np.inf, 0, 1, 0, 0], [0, 0, 0, 1, 0, np.nan]):
        assert core.orbits(np.array([row], dtype=float), None, grid, 22, Cutting(0.45, 1e-14, 1.0)) is None
    assert core.critical_points(np.array([[np.nan, 0.0, 0.0]]), grid) is None
    empty = core.orbits(np.empty((0, 6)), None, grid, 22, Cutting(0.45, 1e-14, 1.0))
    assert empty is not None
    assert empty.arc.size == 0


PROGRAM = """
import json, sys
from solver import equilibria, Case, Cylinder, Ends, Rod
from tests.cases import ends_in_units_of_rho
from tests.numerics.test_core_orbits import REFERENCE
pipe = Case(Rod(2.06e8, 0.3, 0.0635, 300.0, inner_radius=0.0543), Cylinder(0.108, "inside"), Ends(0.0, 0.0, FZ=-300.0))
found = equilibria(pipe if sys.argv[1] == "pipe" else ends_in_units_of_rho(*REFERENCE))
columns = [[float(getattr(one, name)) for one in found] for name in ("dbeta0", "energy", "index", "turns", "attached")]
json.dump({"complete": found.complete, "columns": columns}, sys.stdout)
"""


def equilibria_of(name: str, **environment: str) -> Any:
    command = [sys.executable, "-c", PROGRAM, name]
    done = subprocess.run(command, env=os.environ | environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


@pytest.mark.parametrize("name, count", [("reference", 31), pytest.param("pipe", 851, marks=pytest.mark.slow)])
def test_the_equilibria_are_those_found_without_the_core(name: str, count: int) -> None:
    compiled, plain = equilibria_of(name), equilibria_of(name, **{OFF: "1"})
    assert compiled["complete"]
    assert plain["complete"]
    (slope, energy, *whole), (slope0, energy0, *whole0) = compiled["columns"], plain["columns"]
    assert len(slope) == count
    # those of one energy to rounding may change places
    order, order0 = (np.lexsort((np.round(s, 6), np.round(e, 6))) for s, e in ((slope, energy), (slope0, energy0)))
    np.testing.assert_allclose(np.array(slope)[order], np.array(slope0)[order0], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(np.array(energy)[order], np.array(energy0)[order0], rtol=1e-11)
    np.testing.assert_allclose(np.array(whole)[:, order], np.array(whole0)[:, order0], atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_orbits_about_their_pieces_agree_with_those_of_numpy(kind: str) -> None:
    problem, cutting = problems(kind, 6 if "saddle" in kind else 40), Cutting(0.45, 5e-15, 1.0)
    theirs, mine = reference_relative_orbit(problem, 22, cutting), relative_orbit(problem, 22, cutting)
    assert (mine.kind == theirs.kind).all()
    np.testing.assert_allclose(mine.arcs.pieces.base, theirs.arcs.pieces.base, rtol=0, atol=1e-12)
    np.testing.assert_allclose(mine.duration, theirs.duration, rtol=1e-11)
    same = np.array_equal(mine.panels.arc, theirs.panels.arc)
    assert same or kind != "anywhere"
    if same:
        first = mine.panels.series[:, 0].sum(axis=1), theirs.panels.series[:, 0].sum(axis=1)
        np.testing.assert_allclose(*first, rtol=1e-9, atol=1e-13)
