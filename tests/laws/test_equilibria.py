"""Every shape between two given ends: complete by degree theory, each an equilibrium, its stability counted anew."""

from functools import cache

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from solver import Case, Ends, equilibria, solve
from solver.equilibria import Equilibrium
from tests.cases import ends_in_units_of_rho, in_units_of_rho, table_1
from tests.equation import loads_of, march_with_variations
from tests.numerics.test_ends_at_saddles import signed_count

NUMBERS = -0.3655, 0.7464, -0.7506  # physics.md, section 5


def many() -> Case:
    """beta = 30 degrees at both ends of a rod of 20 rho."""
    return ends_in_units_of_rho(*NUMBERS, 20.0, np.pi / 6, np.pi / 6)


def of_table_1() -> Case:
    """Table 1 (twist-first, compression), by the two ends that its own shape has."""
    case = table_1("twist-first", "compression", "paper")
    betaL = float(solve(case, tol=1e-12).beta[-1])
    return Case(case.rod, case.cylinder, Ends(case.given.beta, betaL, *case.loads))


PROBLEMS = {"many": many, "table 1": of_table_1}


@cache
def found(name: str) -> list[Equilibrium]:
    return equilibria(PROBLEMS[name](), tol=1e-8)


both = pytest.mark.parametrize("name", PROBLEMS)


@both
def test_each_is_an_equilibrium_between_the_given_ends(name: str) -> None:
    case = PROBLEMS[name]()
    for one in found(name):
        sol = one.solution
        assert sol.solved, sol.outcome
        assert sol.beta[0] == pytest.approx(case.given.beta0, abs=1e-12)
        assert sol.beta[-1] == pytest.approx(case.given.betaL, abs=1e-8)  # tol
        assert sol.dbeta[0] == pytest.approx(one.dbeta0, abs=1e-12)
        assert np.ptp(sol.h) < 1e-10 * (1 + np.abs(sol.h).max())


@both
def test_none_is_counted_twice(name: str) -> None:
    shapes = np.array([one.solution.beta for one in found(name)])
    for i, shape in enumerate(shapes):
        others = np.delete(shapes, i, axis=0)
        assert np.abs(others - shape).max(axis=1).min() > 1e-3


@both
def test_they_come_with_the_lowest_energy_first(name: str) -> None:
    energies = np.array([one.energy for one in found(name)])
    assert (np.diff(energies) > -1e-8).all()  # mirror images have one energy but for rounding


@pytest.mark.parametrize("name", ["table 1", pytest.param("many", marks=pytest.mark.slow)])
def test_the_index_is_the_number_of_conjugate_points(name: str) -> None:
    """eta'' + H' eta = 0, eta(0) = 0: its zeros inside, by a march of its own, where a march is in reach."""
    case = PROBLEMS[name]()
    loads, rho, span = loads_of(case), case.rho, case.rod.L / case.rho
    counted = 0
    for one in found(name):
        y, by, _ = march_with_variations(loads, case.given.beta0, one.dbeta0 * rho, np.linspace(0, span, 4001), 1e-9)
        if abs(y[0, -1] - case.given.betaL) > 1e-6:
            continue  # it hugs a saddle: the march has left it
        counted += 1
        eta = by[0, 1]
        assert np.count_nonzero(eta[1:-1] * eta[2:] < 0) == one.index
    assert counted >= 6


@both
def test_none_is_missing_by_degree(name: str) -> None:
    """H is bounded, so the number of equilibria counted with (-1)^index is that of H = 0: one."""
    assert signed_count(found(name)) == 1


@both
def test_the_indices_keep_to_morse(name: str) -> None:
    """The space of shapes has no holes: c_k - c_{k-1} + ... >= (-1)^k for every k."""
    count = np.bincount([one.index for one in found(name)])
    partial = 0
    for k, c in enumerate(count):
        partial = int(c) - partial
        assert partial >= (-1) ** k


loads = st.floats(-1.5, 1.5)


@settings(max_examples=20)
@example(0.0, 0.0, 0.13, 0.0, 2.9565, 0.8)  # joined by rods that turn all the way, without a turning point
@example(0.8867, 0.0, -1.2994, -1.92662, 2.906478, 11.0393)
@example(0.0, -0.190471, 0.0, -2.72992437, 2.72992437, 5.41219)
@given(lam=loads, mu=loads, phi=loads, beta0=st.floats(-3, 3), betaL=st.floats(-3, 3), span=st.floats(0.5, 8))
def test_between_any_two_ends_the_signed_count_is_one(
    lam: float, mu: float, phi: float, beta0: float, betaL: float, span: float
) -> None:
    solutions = equilibria(ends_in_units_of_rho(lam, mu, phi, span, beta0, betaL))
    if any(one.solution.condition > 1e3 for one in solutions):
        return  # at a fold, where two are about to vanish, the index hangs on the mesh
    assert signed_count(solutions) == 1


@both
def test_all_that_shooting_meets_are_among_them(name: str) -> None:
    """Four thousand start slopes; between two of which beta(L) crosses the given angle there must be one."""
    case = PROBLEMS[name]()
    A, rho = case.rod.bending_stiffness, case.rho
    FZ, MZ, M3 = (load / A for load in case.loads)
    slopes = np.linspace(-2.5, 2.5, 4001)
    shot = in_units_of_rho(MZ * rho, M3 * rho, FZ * rho**2, case.rod.L / rho, case.given.beta0, slopes)
    end = solve(shot, tol=1e-10, stations=[case.rod.L / rho]).beta[:, 0]
    known = np.array([one.dbeta0 * rho for one in found(name)])
    crossed = np.flatnonzero((end[:-1] - case.given.betaL) * (end[1:] - case.given.betaL) < 0)
    assert crossed.size > 10
    for k in crossed:
        # one rod may cross at once a whole turn: a jump of the far end is no crossing
        if abs(end[k + 1] - end[k]) < 1:
            near = (known > slopes[k] - 1e-6) & (known < slopes[k + 1] + 1e-6)  # one may lie on the grid
            assert near.any(), (slopes[k], slopes[k + 1])


def test_the_rods_that_shooting_never_meets_are_found() -> None:
    """Stable shapes hug a saddle (beta = -0.9253, 2.8438) and leave it too fast to be shot at."""
    stable = [one for one in found("many") if one.index == 0]
    slopes = [one.dbeta0 for one in stable]
    for slope, saddle in ((-1.53804, -0.9253), (2.00163, 2.8438)):
        near = [one for one in stable if abs(one.dbeta0 - slope) < 1e-4]  # "near", in the source
        assert len(near) == 1, slopes
        middle = near[0].solution.beta[near[0].solution.beta.size // 2]
        assert middle == pytest.approx(saddle, abs=1e-4)
    assert len(found("many")) == 31  # physics.md gives 17 at least, 15 of them of index 2 or more
    assert sum(one.index >= 2 for one in found("many")) >= 15
    assert len(stable) == 3


@both
def test_the_papers_scheme_finds_each_when_started_near_it(name: str) -> None:
    case = PROBLEMS[name]()
    for one in found(name)[:6]:
        sol = solve(case, tol=1e-5, method="difference", seed=one.solution)
        assert sol.solved, sol.outcome
        np.testing.assert_allclose(sol.beta, one.solution.beta, atol=1e-5 * max(1, sol.condition))  # tol


def test_the_lowest_energy_is_taken_where_it_is_asked_for() -> None:
    lowest = found("many")[0]
    for method in ("shooting", "difference"):
        sol = solve(many(), tol=1e-6, method=method, choose="lowest")
        np.testing.assert_allclose(sol.beta, lowest.solution.beta, atol=1e-5)


@pytest.mark.parametrize("method", ("shooting", "difference"))
def test_a_solution_is_followed_while_its_end_angle_moves(method: str) -> None:
    """Each is the seed of the next; slopes at the start change smoothly, and each is among the equilibria."""
    case = of_table_1()
    g = case.given
    sol = solve(case, tol=1e-6, method=method, seed=0.5)
    slopes = [float(sol.dbeta[0])]
    for betaL in g.betaL + np.arange(1, 5) * 2e-3:
        moved = Case(case.rod, case.cylinder, Ends(g.beta0, betaL, g.FZ, g.MZ, g.M3))
        sol = solve(moved, tol=1e-6, method=method, seed=sol)
        assert sol.solved, sol.outcome
        assert sol.beta[-1] == pytest.approx(betaL, abs=1e-9)
        slopes.append(float(sol.dbeta[0]))
    steps = np.diff(slopes)
    assert (steps > 0).all() or (steps < 0).all()
    last = [one.dbeta0 for one in equilibria(moved)]
    assert np.abs(np.array(last) - slopes[-1]).min() < 1e-5
