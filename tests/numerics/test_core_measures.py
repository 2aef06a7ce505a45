"""Integrals, extremes and self-contact by the compiled core: what NumPy computes by the same rule, for any batch.

`.ci/run` runs this file again with a library that checks every access and operation, as that of `test_core_fuzz`.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import solve
from solver.core import measures
from solver.numerics.chebyshev import basis
from solver.observe import measurement, strand_pairs
from solver.observe.observables import observe
from solver.observe.rod_pieces import NODES, Pieces
from solver.observe.solution_pieces import pieces_of
from solver.problem.reduced import StartProblem
from tests.extreme_cases import KINDS, draw
from tests.numerics.test_core_fuzz import ODD, odd
from tests.numerics.test_measurement import localised, random_rods

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


def both(pieces: Pieces, numbers: dict[str, Any], goal: float = GOAL) -> tuple[dict[str, Any], dict[str, Any]]:
    """What NumPy and the core measure."""
    with np.errstate(all="ignore"):
        theirs = measurement.reference_groups(list(measurement.GROUPS), pieces, *numbers.values(), goal)
    return theirs, measures.measure(pieces, numbers, range(len(measurement.GROUPS)), goal)


def agree(theirs: dict[str, Any], mine: dict[str, Any], rows: Any = ALL) -> None:
    """Values agree by a tenth of their own errors, and errors by 2 %; either also by the last bits.

    The place of the largest push jumps where two places are equally good by rounding: it agrees by its error.
    """
    assert set(theirs) == set(mine) == set(measures.NUMBERS)
    (there, wide), (place, doubt) = ((part[rows] for part in pair["peak"]) for pair in (theirs, mine))
    with np.errstate(invalid="ignore"):
        assert ((np.abs(there - place) <= np.maximum(wide, doubt)) | (np.isnan(there) & np.isnan(place))).all()
    for name, (value, error) in theirs.items():
        if name == "peak":
            continue
        value, error = value[rows], error[rows]
        got, doubt = (part[rows] for part in mine[name])
        with np.errstate(invalid="ignore", over="ignore"):
            near = np.abs(got - value) <= 0.1 * error + 1e-14 * np.abs(value)  # sums in another order
            close = np.abs(doubt - error) <= 0.02 * error + 1e-14 * np.abs(value)
        for good, one, other in ((near, value, got), (close, error, doubt)):
            good = good | (one == other) | (np.isnan(one) & np.isnan(other))
            assert good.all(), (name, np.flatnonzero(~good), one[~good], other[~good])


@pytest.mark.parametrize("method", ["swing", "orbit"])
@pytest.mark.parametrize("kind", CASES)
def test_numbers_along_rods_agree_with_those_of_numpy(kind: str, method: str) -> None:
    sol = solve(CASES[kind](), tol=1e-8, method=method, stations=2)
    size = sol.problem.size
    agree(*both(pieces_of(sol, slice(0, size)), given(size)), rows=np.reshape(sol.solved, -1))


@pytest.mark.parametrize("stations", [2, 9, 200])
def test_numbers_between_stations_agree_with_those_of_numpy(stations: int) -> None:
    sol = solve(random_rods(8, 7, 20.0), tol=1e-8, method="dop853", stations=stations)
    agree(*both(pieces_of(sol, slice(0, 8)), given(8)))


def test_a_part_of_a_rod_agrees_with_numpy() -> None:
    sol = solve(random_rods(40, 9, 60.0), tol=1e-8, stations=2)
    agree(*both(pieces_of(sol, slice(0, 40), 0.37), given(40)))


def bits(found: dict[str, Any], rows: Any = ALL) -> list[bytes]:
    return [np.ascontiguousarray(part[rows]).tobytes() for pair in found.values() for part in pair]


def test_neither_lanes_nor_neighbours_nor_threads_change_a_bit(monkeypatch) -> None:
    size, groups = 700, range(len(measurement.GROUPS))
    sol, numbers = solve(random_rods(size, 3), tol=1e-8, stations=2), given(size)
    pieces = pieces_of(sol, slice(0, size))
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    found = measures.measure(pieces, numbers, groups, GOAL)
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    for lanes in (1, 2, 4, 8):
        if lanes <= measures.widest():
            assert bits(measures.measure(pieces, numbers, groups, GOAL, lanes)) == bits(found)
    few = slice(60, 75)
    own = {name: value[few] for name, value in numbers.items()}
    assert bits(measures.measure(pieces_of(sol, few), own, groups, GOAL)) == bits(found, few)


def test_only_the_groups_that_are_asked_for_are_measured() -> None:
    pieces, numbers = pieces_of(solve(random_rods(9, 3), stations=2), slice(0, 9)), given(9)
    whole = measures.measure(pieces, numbers, range(len(measurement.GROUPS)), GOAL)
    for place, group in enumerate(measurement.GROUPS):
        alone = measures.measure(pieces, numbers, [place], GOAL)
        for name in group.names:
            assert bits({name: alone[name]}) == bits({name: whole[name]})


def odd_pieces(rng: np.random.Generator) -> Pieces:
    """Rods of odd loads and series, cut anywhere; some have no piece."""
    size, count, n = int(rng.integers(0, 12)), int(rng.integers(0, 40)), int(rng.integers(1, 60))
    problem = StartProblem(*odd(rng, 6, size))
    decay = rng.uniform(0.1, 1) ** np.arange(n)
    series = odd(rng, count, 2, n) * decay
    case, row = rng.integers(0, max(size, 1), count), rng.permutation(count)
    ends = np.where(rng.random((2, count)) < 0.5, [[-1.0], [1.0]], np.sort(rng.uniform(-1, 1, (2, count)), axis=0))
    time, often, begin = np.abs(odd(rng, 3, count))
    keep = case < size
    pieces = Pieces(problem, series, case, row, *ends, time, often, begin, monotone=bool(rng.integers(2)))
    return pieces.take(keep)


@pytest.mark.parametrize("seed", range(4))
def test_odd_numbers_along_rods_end_in_numbers_or_nan(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(40):
        pieces = odd_pieces(rng)
        size = pieces.problem.size
        numbers = {"sign": rng.choice([-1.0, 1.0], size), "error": np.abs(odd(rng, size))}
        found = measures.measure(pieces, numbers, range(len(measurement.GROUPS)), float(10 ** rng.uniform(-18, 0)))
        assert all(part.shape == (size,) for pair in found.values() for part in pair)


@pytest.mark.parametrize("value", ODD)
def test_rods_of_one_angle_agree_with_numpy_whatever_the_angle(value: float) -> None:
    beta = np.array([value, 0.3, np.pi / 2])
    problem = StartProblem(*np.full((3, 3), 0.7), np.full(3, 5.0), beta, np.zeros(3))
    series = np.stack([beta, np.zeros(3)], axis=1)[:, :, None]
    row, one = np.arange(3), np.ones(3)
    agree(*both(Pieces(problem, series, row, row, -one, one, 5 * one, one, 0 * one, monotone=True), given(3)))


def test_series_too_long_for_the_core_are_measured_by_numpy() -> None:
    sol = solve(random_rods(3, 1), stations=2)
    pieces = pieces_of(sol, slice(0, 3))
    longer = np.pad(pieces.series, ((0, 0), (0, 0), (0, measures.LONGEST)))
    assert longer.shape[2] > measures.LONGEST
    numbers, groups = given(3), list(measurement.GROUPS)
    found = measurement._of_groups(groups, replace(pieces, series=longer), *numbers.values(), GOAL)
    agree(found, measures.measure(pieces, numbers, range(len(groups)), GOAL))


def test_the_core_and_numpy_have_the_same_nodes_and_numbers() -> None:
    assert measures.NODES == NODES == basis(NODES).nodes.size
    assert [name for group in measurement.GROUPS for name in group.names] == list(measures.NUMBERS)


def searched_by_both(sol: Any, limits: dict[str, int]) -> tuple[Any, Any]:
    """Whether rods meet themselves, by NumPy and by the core."""
    orbit, rods = sol.trajectory.orbit, np.flatnonzero(np.reshape(sol.solved, -1) & ~sol.trajectory.orbit.lost)
    rho = np.broadcast_to(sol.case.rho, sol.case.shape).reshape(-1)[rods]
    a = np.broadcast_to(sol.case.rod.a, sol.case.shape).reshape(-1)[rods] / rho
    tightest = np.reshape(observe(sol, ["kappa_max"])["kappa_max"], -1)[rods] * rho
    some = orbit.pick(rods), sol.problem.span[rods], a, tightest
    return strand_pairs.meets_of(strand_pairs.strands(*some), **limits), strand_pairs.meets(*some, **limits)


LIMITS = ({"most_pairs": 3000}, {"most_pairs": 300}, {"most_pairs": 3000, "together": 3})


@pytest.mark.parametrize("kind", ["random", "loads", "forces", "helix", "tension"])
def test_self_contact_is_that_of_numpy_and_is_given_up_at_the_same_pairs(kind: str) -> None:
    sol = solve(CASES[kind](), tol=1e-8, method="swing", stations=2)
    for limits in LIMITS:
        theirs, mine = searched_by_both(sol, limits)
        np.testing.assert_array_equal(mine, theirs)
    assert kind != "random" or 5 < theirs.sum() < 55


def test_self_contact_of_a_thousand_random_rods_is_that_of_numpy() -> None:
    sol = solve(random_rods(1000, 0, 200.0), tol=1e-8, method="swing", stations=2)
    for limits in LIMITS:
        np.testing.assert_array_equal(*searched_by_both(sol, limits))
