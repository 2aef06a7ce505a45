"""The search for every equilibrium: the index counted in two ways, rods that turn, folds and symmetries."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from solver import Case, Ends, equilibria, solve
from solver.equilibria import Equilibrium
from solver.follow import to_fold
from solver.orbits.boundary import repeat
from solver.orbits.level_search import search_levels
from solver.orbits.mesh_index import morse_index
from solver.orbits.periodic_orbit import jacobi_zeros
from solver.problem.dimensionless import reduce
from tests.cases import ends_in_units_of_rho, helix_moment, in_units_of_rho, table_1
from tests.equation import force_rate
from tests.numerics.test_ends_at_saddles import signed_count

MANY = -0.3655, 0.7464, -0.7506  # lam, mu, phi
PROBLEMS = {
    "many": (*MANY, 20.0, np.pi / 6, np.pi / 6),
    "no loads": (0.0, 0.0, 0.0, 20.0, np.pi / 6, np.pi / 6),
    "symmetric": (0.0, 0.0, -0.7, 12.0, 0.4, -0.4),
    "pulled": (0.3, 0.5, 0.9, 8.0, 1.0, 2.5),
    "all the way round": (0.3, 0.2, 0.1, 9.0, 0.5, 0.5 + 2 * np.pi),
    "strongly twisted": (2.0, 6.0, -3.0, 4.0, 0.8, 0.3),
}
every = pytest.mark.parametrize("name", PROBLEMS)


@cache
def found(*numbers: float) -> list[Equilibrium]:
    return equilibria(ends_in_units_of_rho(*numbers))


def slopes(solutions: list[Equilibrium]) -> np.ndarray:
    return np.sort([one.dbeta0 for one in solutions])


# the index in two ways


@every
def test_zeros_of_the_jacobi_field_are_the_negative_pivots(name: str) -> None:
    problem = reduce(ends_in_units_of_rho(*PROBLEMS[name]))
    all_of_them = search_levels(problem)
    assert all_of_them is not None
    wide = repeat(problem, all_of_them.dbeta0.size)
    span = PROBLEMS[name][3]
    beta = all_of_them.orbit.at(np.tile(np.linspace(0, span, 8001), (wide.size, 1)))[0]
    zeros = jacobi_zeros(all_of_them.orbit)
    assert (zeros == morse_index(wide, wide.span / 8000, beta)).all()
    assert zeros.max() > zeros.min() or zeros.size == 1


@pytest.mark.parametrize("span", (60.0, 150.0))
def test_the_index_keeps_to_morse_on_rods_too_long_for_any_march(span: float) -> None:
    """Fields that grow by exp(1.7 L) along the saddles; the indices still add up as the space of shapes demands."""
    solutions = equilibria(ends_in_units_of_rho(*MANY, span, np.pi / 6, np.pi / 6), stations=2)
    assert signed_count(solutions) == 1
    partial = 0
    for k, count in enumerate(np.bincount([one.index for one in solutions])):
        partial = int(count) - partial
        assert partial >= (-1) ** k
    assert sum(one.index == 0 for one in solutions) >= 2


CENTRES, SADDLES = ((1.1, 0.9, -0.4), (0.7, 0.5, -0.9)), ((1.1, 0.4, 0.2), (0.4, -0.3, 0.1))


@pytest.mark.parametrize("span", (0.5, 5.0, 50.0))
@pytest.mark.parametrize("beta, mu, phi", CENTRES + SADDLES)
def test_a_helix_gains_an_unstable_direction_each_half_wave_at_a_centre_alone(span, beta, mu, phi) -> None:
    numbers = helix_moment(beta, mu, phi), mu, phi
    rate = force_rate(beta, *numbers)
    assert (rate > 0) == ((beta, mu, phi) in CENTRES)
    straight = [one for one in found(*numbers, span, beta, beta) if np.ptp(one.solution.beta) < 1e-12]
    assert [one.index for one in straight] == [int(np.sqrt(max(rate, 0)) * span / np.pi)]


# rods that turn all the way


@pytest.mark.parametrize("rounds", (-3, -1, 1, 2, 5))
@pytest.mark.parametrize("beta0", (0.5, 0.0, -np.pi, 2.0))
def test_a_rod_that_turns_all_the_way_is_found(rounds: int, beta0: float) -> None:
    betaL = beta0 + 2 * np.pi * rounds
    solutions = found(0.3, 0.2, 0.1, 6.0, beta0, betaL)
    assert solutions
    assert signed_count(solutions) == 1
    for one in solutions:
        assert one.solution.beta[-1] == pytest.approx(betaL, abs=1e-8)  # tol
    assert any((np.sign(one.solution.dbeta) == np.sign(rounds)).all() for one in solutions)


@pytest.mark.parametrize(
    "numbers",
    (
        (0.0, 0.0, -0.5289463541744542, 0.7775296511739638, 0.0, 2.25917698187677),  # starts on a helix angle
        (0.9991052333730774, -0.4276177611325607, 1.334687730507262, 6.555842674256888, 3.06883997176247,
         -1.936676784705245),  # ends between the start and the helix angle behind it
        (2.692079329356268, 2.584381685339393, 4.360011565602786, 1.1617500751117587, -1.8561560112001212,
         -8.139341318379707),  # just less than a whole turn, by rounding
        (0.0, -1.0693813271761012, 0.0, 2.6651699081365625, 3.0937205752438244, -3.0937205752438244),
        (0.0, 0.0, -0.4, 1.0, 0.0, np.pi),  # from one helix angle to another
        (0.0, 0.0, -0.4, 1.0, np.pi, 0.0),
    ),
)  # fmt: skip
def test_between_two_ends_there_is_always_one(numbers) -> None:
    """By degree; these ends, more than a swing apart, were once found to have none."""
    solutions = found(*numbers)
    assert signed_count(solutions) == 1
    for one in solutions:
        assert one.solution.solved
        assert one.solution.beta[-1] == pytest.approx(numbers[-1], abs=1e-8)  # tol


@pytest.mark.parametrize("numbers", ((0, 0, 0, 20.0, np.pi / 6), (0.3, 0.2, -0.5, 12.0, 1.0), (0, 0, -0.7, 7.0, 0.3)))
@pytest.mark.parametrize("slope", (0.0, 1e-12, -1e-9, 1e-7, -3e-6, 1e-4))
def test_a_rod_that_starts_or_ends_at_rest_is_found_once(numbers, slope: float) -> None:
    """Where beta' = 0 at an end the paths of two kinds meet, and neither shows the rod by itself."""
    first = numbers[-1]
    sol = solve(in_units_of_rho(*numbers, slope), tol=1e-12)
    last = float(sol.beta[-1])
    there, back = found(*numbers[:-1], first, last), found(*numbers[:-1], last, first)
    for solutions, wanted in ((there, slope), (back, -float(sol.dbeta[-1]))):
        own = [one for one in solutions if abs(one.dbeta0 - wanted) < 1e-8]
        assert len(own) == 1
        assert signed_count(solutions) == 1
        assert own[0].solution.solved
        shape = own[0].solution.beta
        np.testing.assert_allclose(shape if solutions is there else shape[::-1], sol.beta, atol=1e-8)


def test_ten_billion_radii_of_rod_lose_no_equilibrium_to_rounding() -> None:
    """The length itself is then known to 1e-6 radii only, and beta(L) with it: the estimated errors say so."""
    listed = [
        equilibria(ends_in_units_of_rho(*MANY, span, 0.5, 0.6), stations=3, most_swings=20) for span in (1e6, 1e10)
    ]
    assert len(listed[0]) == len(listed[1]) == 244
    for found, allowed in zip(listed, (1e-8, 1e-4), strict=True):
        for one in found:
            assert abs(one.solution.beta[-1] - 0.6) <= float(one.solution.error) < allowed


# folds


@cache
def fold():
    """The equilibrium of Table 1 as its far end turns, up to where it ceases to exist."""
    case = table_1("force-first", "tension", "paper")
    return to_fold(case, np.deg2rad(60))


def at_end(betaL: float) -> list[Equilibrium]:
    g = fold().ends.given
    return equilibria(Case(fold().ends.rod, fold().ends.cylinder, Ends(g.beta0, betaL, g.FZ, g.MZ, g.M3)))


def nearest(solutions: list[Equilibrium], slope: float, within: float) -> list[Equilibrium]:
    return [one for one in solutions if abs(one.dbeta0 - slope) < within]


def test_two_equilibria_meet_at_a_fold_and_none_is_left_beyond_it() -> None:
    """Their distance falls with the square root of the way to the fold."""
    at, slope = fold().fold, fold().fold_dbeta0
    apart = []
    for before in (1e-3, 1e-5, 1e-7):
        two = nearest(at_end(at - before), slope, 0.05)
        assert len(two) == 2, before
        apart.append(abs(two[0].dbeta0 - two[1].dbeta0))
    np.testing.assert_allclose(np.divide(apart[:-1], apart[1:]), 10, rtol=0.1)
    assert not nearest(at_end(at + 1e-7), slope, 0.05)


def test_the_index_changes_by_one_through_a_fold_and_nowhere_before_it() -> None:
    """Up the branch to the fold, and back down the other one that it turns into."""
    branch = fold()
    for betaL, slope in zip(branch.values[:-1], branch.dbeta0[:-1], strict=True):
        assert [one.index for one in nearest(at_end(betaL), slope, 1e-6)] == [6]
    for betaL in (branch.values[-2], branch.fold - 1e-3, branch.fold - 1e-6):
        two = sorted(nearest(at_end(betaL), branch.fold_dbeta0, 0.2), key=lambda one: one.dbeta0)
        assert [one.index for one in two] == [6, 5]


# symmetries


def test_turning_the_sign_of_beta_turns_the_signs_of_the_slopes() -> None:
    """beta -> -beta flips lam and mu."""
    lam, mu, phi, span, first, last = PROBLEMS["pulled"]
    mirrored = found(-lam, -mu, phi, span, -first, -last)
    np.testing.assert_allclose(slopes(mirrored), -slopes(found(*PROBLEMS["pulled"]))[::-1], atol=1e-10)


def test_turning_the_axis_round_gives_the_same_slopes_reversed() -> None:
    """beta -> pi - beta flips phi and mu."""
    lam, mu, phi, span, first, last = PROBLEMS["pulled"]
    turned = found(lam, -mu, -phi, span, np.pi - first, np.pi - last)
    np.testing.assert_allclose(slopes(turned), -slopes(found(*PROBLEMS["pulled"]))[::-1], atol=1e-10)


def test_run_from_its_other_end_each_rod_is_found_again() -> None:
    """beta(L - s) solves the same equation between the ends changed over, with the same energy and index."""
    lam, mu, phi, span, first, last = PROBLEMS["many"]
    for one, other in (((first, 1.2), (1.2, first)), ((first, last), (last, first))):
        there, back = found(lam, mu, phi, span, *one), found(lam, mu, phi, span, *other)
        np.testing.assert_allclose([e.energy for e in there], [e.energy for e in back], atol=1e-9)
        assert sorted(e.index for e in there) == sorted(e.index for e in back)
        ends = np.sort([-e.solution.dbeta[-1] for e in there])
        np.testing.assert_allclose(ends, slopes(back), atol=1e-8)


def test_mirror_images_of_one_energy_come_in_one_order_always() -> None:
    """Equal but for rounding, they are told apart by their start: the lower slope first."""
    solutions = found(*PROBLEMS["no loads"])
    pairs = [
        (a, b) for a, b in pairwise(solutions) if abs(a.energy - b.energy) < 1e-9 and abs(a.dbeta0 + b.dbeta0) < 1e-9
    ]
    assert pairs
    assert all(a.dbeta0 < b.dbeta0 for a, b in pairs)
