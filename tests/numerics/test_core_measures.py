"""Integrals, extremes and self-contact by the compiled core, for any batch.

`.ci/run` runs this file again with a library that checks every access and operation, as that of `test_core_fuzz`.
"""

import ctypes
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy
from numpy.polynomial import Polynomial
from numpy.polynomial.chebyshev import chebval

from solver import solve
from solver.core import measures
from solver.core.library import run
from solver.observe.observables import observe
from solver.observe.self_contact import compare_strands
from solver.observe.solution_pieces import SolutionPieces, pieces_of
from solver.problem.dimensionless import StartProblem
from tests.cases import random_rods
from tests.extreme_cases import KINDS, draw
from tests.numerics.test_core_fuzz import odd
from tests.numerics.test_measurement import localised

ALL = slice(None)
GOAL = 1e-11
CASES = {
    "random": lambda: random_rods(60, 5, 60.0),
    "localised": lambda: localised(1e-3),
    **{kind: lambda kind=kind: draw(60, 11, kind, "inside") for kind in KINDS},
}


def given(size: int, seed: int = 0) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    return {"sign": rng.choice([-1.0, 1.0], size), "error": 10.0 ** rng.uniform(-15, -5, size)}


def bits(found: dict[str, Any], rows: Any = ALL) -> list[bytes]:
    return [np.ascontiguousarray(part[rows]).tobytes() for pair in found.values() for part in pair]


def test_neither_lanes_nor_neighbours_nor_threads_change_a_bit(monkeypatch) -> None:
    size, names = 700, measures.NUMBERS
    sol, numbers = solve(random_rods(size, 3), tol=1e-8, stations=2), given(size)
    pieces = pieces_of(sol, np.arange(size))
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    found = measures.measure(pieces, numbers, names, GOAL)
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    for lanes in (1, 2, 4, 8):
        if lanes <= measures.widest():
            assert bits(measures.measure(pieces, numbers, names, GOAL, lanes)) == bits(found)
    few = slice(60, 75)
    own = {name: value[few] for name, value in numbers.items()}
    assert bits(measures.measure(pieces_of(sol, np.arange(60, 75)), own, names, GOAL)) == bits(found, few)


def test_a_rod_alone_has_the_bits_that_it_has_among_others() -> None:
    size = 60
    sol, numbers = solve(random_rods(size, 3), tol=1e-8, stations=2), given(size)
    found = measures.measure(pieces_of(sol, np.arange(size)), numbers, measures.NUMBERS, GOAL)
    for i in range(size):
        one = slice(i, i + 1)
        own = {name: value[one] for name, value in numbers.items()}
        assert bits(measures.measure(pieces_of(sol, np.arange(size)[one]), own, measures.NUMBERS, GOAL)) == bits(
            found, one
        )


@pytest.mark.parametrize("steps", [0, 1, 5])
def test_series_of_steps_are_their_polynomials_with_the_same_bits_whatever_stands_beside_them(
    monkeypatch, steps: int
) -> None:
    rng = np.random.default_rng(steps)
    width, taylor = rng.uniform(0.1, 1, steps), rng.normal(size=(steps, 4, 21))
    series, x = measures.step_series(width, taylor), np.linspace(0, 1, 9)
    assert series.shape == (steps, 2, 21)
    for i in range(steps):
        beta = Polynomial(taylor[i, 0])
        expected = [beta(x * width[i]), beta.deriv()(x * width[i])]
        assert chebval(2 * x - 1, series[i].T) == pytest.approx(np.array(expected), abs=1e-10)
        assert measures.step_series(width[[i]], taylor[[i]]).tobytes() == series[i].tobytes()
    for lanes in (lanes for lanes in (1, 2, 4, 8) if lanes <= measures.widest()):
        with monkeypatch.context() as narrow:
            narrow.setattr(measures, "widest", lambda lanes=lanes: lanes)
            assert measures.step_series(width, taylor).tobytes() == series.tobytes()
    taylor[1:2] = np.nan
    lost = np.arange(steps) == 1
    beside = measures.step_series(width, taylor)
    assert np.isnan(beside[lost]).all()
    assert beside[~lost].tobytes() == series[~lost].tobytes()


def test_only_the_groups_that_are_asked_for_are_measured() -> None:
    pieces, numbers = pieces_of(solve(random_rods(9, 3), stations=2), np.arange(9)), given(9)
    whole = measures.measure(pieces, numbers, measures.NUMBERS, GOAL)
    for group in measures.GROUPS:
        alone = measures.measure(pieces, numbers, group[:1], GOAL)
        assert set(alone) == set(group)
        for name in group:
            assert bits({name: alone[name]}) == bits({name: whole[name]})


def odd_pieces(rng: np.random.Generator) -> SolutionPieces:
    """Rods of odd loads and series, cut anywhere; some have no piece."""
    size, count, n = int(rng.integers(0, 12)), int(rng.integers(0, 40)), int(rng.integers(1, 60))
    problem = StartProblem(*odd(rng, 6, size))
    decay = rng.uniform(0.1, 1) ** np.arange(n)
    series = odd(rng, count, 2, n) * decay
    case, row = rng.integers(0, max(size, 1), count), rng.permutation(count)
    ends = np.where(rng.random((2, count)) < 0.5, [[-1.0], [1.0]], np.sort(rng.uniform(-1, 1, (2, count)), axis=0))
    time, often, begin = np.abs(odd(rng, 3, count))
    keep = case < size
    pieces = SolutionPieces(problem, series, case, row, *ends, time, often, begin, monotone=bool(rng.integers(2)))
    return pieces.take(keep)


@pytest.mark.parametrize("seed", range(4))
def test_odd_numbers_along_rods_end_in_numbers_or_nan(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(40):
        pieces = odd_pieces(rng)
        size = pieces.problem.size
        numbers = {"sign": rng.choice([-1.0, 1.0], size), "error": np.abs(odd(rng, size))}
        found = measures.measure(pieces, numbers, measures.NUMBERS, float(10 ** rng.uniform(-18, 0)))
        assert all(part.shape == (size,) for pair in found.values() for part in pair)


def test_loads_that_do_not_vary_along_rods_give_the_bits_of_rods_whose_loads_may() -> None:
    size = 60
    pieces, numbers = pieces_of(solve(random_rods(size, 5), tol=1e-8, stations=2), np.arange(size), 0.37), given(size)
    loads = np.zeros((len(pieces.series), 5, pieces.series.shape[2]))
    of = np.zeros(len(loads), dtype=int)
    of[pieces.row] = pieces.case
    for k, values in enumerate((pieces.problem.lam, pieces.problem.mu, pieces.problem.phi, None, np.ones(size))):
        loads[:, k, 0] = 0 if values is None else values[of]
    varying = replace(pieces, series=np.concatenate([pieces.series, loads], axis=1))
    found = [measures.measure(rods, numbers, measures.NUMBERS, GOAL) for rods in (pieces, varying)]
    assert bits(found[0]) == bits(found[1])


def test_a_series_too_long_for_the_core_is_refused() -> None:
    pieces = pieces_of(solve(random_rods(3, 1), stations=2), np.arange(3))
    longer = replace(pieces, series=np.pad(pieces.series, ((0, 0), (0, 0), (0, 64))))
    with pytest.raises(ValueError, match="coefficients is too long"):
        measures.measure(longer, given(3), measures.NUMBERS, GOAL)


LIMITS = ({"most_pairs": 3000}, {"most_pairs": 300}, {"most_pairs": 3000, "together": 3})


@pytest.mark.parametrize("kind", ["random", "loads", "forces", "helix", "tension"])
def test_self_contact_of_marched_orbits_is_that_of_panels_and_is_given_up_at_the_same_pairs(kind: str) -> None:
    sol = solve(CASES[kind](), tol=1e-8, method="swing", stations=2)
    orbit, rods = sol.trajectory.orbit, np.flatnonzero(np.reshape(sol.solved, -1) & ~sol.trajectory.orbit.lost)
    rho = np.broadcast_to(sol.case.rho, sol.case.shape).reshape(-1)[rods]
    a = np.broadcast_to(sol.case.rod.a, sol.case.shape).reshape(-1)[rods] / rho
    tightest = np.reshape(observe(sol, ["kappa_max"])["kappa_max"], -1)[rods] * rho
    marched, given = orbit.take(rods), (sol.problem.span[rods], a, tightest)
    for limits in LIMITS:
        met = compare_strands(marched, *given, **limits)
        np.testing.assert_array_equal(compare_strands(marched.exact, *given, **limits), met)
    assert kind != "random" or 5 < met.sum() < 55


def test_the_core_and_python_read_one_table() -> None:
    """Python reads it in the header, and pages ask the core."""
    densities, *rows = run("rod_measured", result=ctypes.c_char_p).decode().split("|")
    assert tuple(densities.split()) == measures.DENSITIES
    table = [row.split() for row in rows]
    assert tuple(name for _, name, _ in table) == measures.NUMBERS
    assert [name for _, name, rated in table if rated == "1"] == [*measures.RATED][:-1]
    assert [group for group, *_ in table] == [
        table[measures.NUMBERS.index(names[0])][0] for names in measures.GROUPS for _ in names
    ]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("closed", [False, True])
def test_a_curve_meets_itself_where_all_pairs_of_its_points_say(seed: int, closed: bool) -> None:
    rng = np.random.default_rng(seed)
    s, near, apart = np.linspace(0, 1, 1000), rng.choice([0.04, 0.15]), 0.07
    turns = 2 * np.pi * rng.integers(1, 9, (3, 3)) * (1 if closed else 0.9)
    points = np.sin(np.einsum("n,ij->nij", s, turns) + rng.uniform(0, 6, (3, 3))).mean(axis=1)
    points[:, 2] *= 0.1
    away = np.linalg.norm(points[:, None] - points, axis=-1)
    along = np.abs(s[:, None] - s)
    along = np.minimum(along, 1 - along) if closed else along
    rows = np.argwhere((away < near) & (along > apart) & (s[:, None] > s))
    beside = scipy.spatial.cKDTree(rows).query_pairs(2, p=np.inf, output_type="ndarray")
    graph = scipy.sparse.coo_array((np.ones(len(beside)), beside.T), shape=(len(rows), len(rows)))
    count, place = scipy.sparse.csgraph.connected_components(graph, directed=False)
    wanted = [min(rows[place == k], key=lambda pair: away[tuple(pair)]) for k in range(count)]
    found = measures.crossings(s, points, near, apart, 1.0 if closed else np.inf)
    assert count > 3
    assert sorted(map(tuple, found)) == sorted(map(tuple, wanted))


def test_a_coil_that_touches_all_along_is_one_place_and_a_straight_line_none() -> None:
    s = np.linspace(0, 60, 4000)
    coil = np.stack([np.cos(s), np.sin(s), 0.01 * s], axis=-1)
    assert len(measures.crossings(s, coil, 0.1, 1.0)) == 1
    line = np.stack([s, 0 * s, 0 * s], axis=-1)
    assert measures.crossings(s, line, 0.1, 1.0).shape == (0, 2)
