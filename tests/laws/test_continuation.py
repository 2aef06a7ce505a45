"""A seed names one equilibrium: it comes back, it continues while the case changes, and nothing takes its place."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Solution, equilibria, follow, solve
from solver.equilibria import Equilibrium
from tests.cases import GENERAL, TABLE_1, ends_in_units_of_rho, rod_of_unit_stiffness

NUMBERS = -0.3655, 0.7464, -0.7506  # physics.md, section 5


def from_start(case: Case) -> Case:
    """The ends problem that a start problem solves."""
    far = float(solve(case, tol=1e-12).beta[-1])
    return Case(case.rod, case.cylinder, Ends(case.given.beta, far, *case.loads))


def hugging() -> Case:
    """A rod of 60 rho that spends its length along a saddle: start slopes agree to 1e-12 and better."""
    return ends_in_units_of_rho(0.3, 0.1, 0.4, 60.0, 0.4, -0.7)


PROBLEMS = {
    "section 5": lambda: ends_in_units_of_rho(*NUMBERS, 20.0, np.pi / 6, np.pi / 6),
    "Table 1": lambda: from_start(TABLE_1["twist-first/compression/paper"].case),
    "Table 1, default reading": lambda: from_start(TABLE_1["force-first/tension/paper"].case),
    "hugging a saddle": hugging,
    "pulled": lambda: from_start(GENERAL["pulled, symmetric"].case),
    "through whole turns": lambda: from_start(GENERAL["going round"].case),
}
each = pytest.mark.parametrize("name", PROBLEMS)


@cache
def found(name: str) -> list[Equilibrium]:
    return list(equilibria(PROBLEMS[name]()))


def same(sol: Solution, other: Equilibrium) -> bool:
    """Whether beta agrees along the whole rod; huggers differ by radians where their swings lie."""
    return bool(sol.solved) and bool(np.abs(sol.beta - other.solution.beta).max() < 1e-6)


def place(sol: Solution, among: list[Equilibrium]) -> int:
    """Which of the equilibria this is."""
    (i,) = [i for i, one in enumerate(among) if same(sol, one)]
    return i


def changed(case: Case, share: float) -> Iterator[tuple[str, Case]]:
    """The case with each of its numbers changed by that share."""
    for part in ("rod", "cylinder", "given"):
        owner = getattr(case, part)
        for field in ("E", "a", "L", "R", "beta0", "betaL", "FZ", "MZ", "M3"):
            if hasattr(owner, field):
                value = getattr(owner, field)
                yield field, replace(case, **{part: replace(owner, **{field: value * (1 + share)})})


@each
def test_a_seed_returns_its_own_equilibrium(name: str) -> None:
    for i, one in enumerate(found(name)):
        sol = solve(PROBLEMS[name](), seed=one.solution)
        assert place(sol, found(name)) == i


@pytest.mark.parametrize(
    "name, fields",
    [
        ("section 5", ("FZ",)),
        ("hugging a saddle", ("L", "betaL")),
        *(pytest.param(name, None, marks=pytest.mark.slow) for name in PROBLEMS),
    ],
)
def test_after_a_small_change_of_any_number_it_continues_one_to_one(name: str, fields: tuple[str, ...] | None) -> None:
    case = PROBLEMS[name]()
    for field, near in changed(case, 1e-6):
        if fields is not None and field not in fields:
            continue
        others = list(equilibria(near))
        taken = [place(solve(near, seed=one.solution), others) for one in found(name)]
        assert sorted(taken) == list(range(len(others))), field
        for one, i in zip(found(name), taken, strict=True):
            assert others[i].index == one.index, field
            assert others[i].bends == one.bends or min(abs(one.dbeta0), abs(others[i].dbeta0)) < 1e-2, field


@pytest.mark.slow
def test_a_seed_keeps_its_branch_through_a_change_of_one_percent() -> None:
    """29 of Table 1's 31 go on. Two meet in a fold on the way; they say so, although another pair is born meanwhile."""
    case = PROBLEMS["Table 1"]()
    half, moved = (replace(case, given=replace(case.given, FZ=case.given.FZ * (1 + x))) for x in (0.005, 0.01))
    others = list(equilibria(moved))
    assert (len(found("Table 1")), len(equilibria(half)), len(others)) == (31, 29, 31)
    taken = []
    for one in found("Table 1"):
        sol = solve(moved, seed=one.solution)
        if sol.solved:
            taken.append(place(sol, others))
            assert others[taken[-1]].index == one.index
        else:
            assert sol.outcome.startswith("failed: the branch of the seed ends")
            assert np.isnan(sol.beta).all()
    assert len(set(taken)) == len(taken) == 29


def test_where_a_branch_ends_in_a_fold_the_outcome_says_so_and_no_other_is_given() -> None:
    case = PROBLEMS["Table 1"]()
    moved = replace(case, given=replace(case.given, FZ=case.given.FZ * 1.01))
    one = found("Table 1")[-1]
    assert one.index == 7
    sol = solve(moved, seed=one.solution)
    assert sol.outcome.startswith("failed: the branch of the seed ends")
    assert "after 39" in sol.outcome
    assert np.isnan(sol.beta).all()


def test_an_end_may_cross_a_saddle() -> None:
    """beta(L) passes the angle along which a stable rod lies: the range in which its path changes is exp(-r L) wide."""
    first, last = (ends_in_units_of_rho(0.3, 0.3, 1.0, L, 0.5, far) for L, far in ((40.0, -0.3), (41.0, 0.3)))
    assert equilibria(last)[0].index == 0
    stable = next(one for one in equilibria(first) if one.index == 0)
    sol = solve(last, seed=stable.solution)
    assert sol.solved, sol.outcome
    assert equilibria(last)[place(sol, list(equilibria(last)))].index == 0


def test_a_rod_at_rest_as_a_helix_is_a_seed_and_a_goal() -> None:
    rod = rod_of_unit_stiffness(10.0, 0.01)

    def pulled(beta0: float, betaL: float, FZ: float) -> Case:
        return Case(rod, Cylinder(1 - 0.01), Ends(beta0, betaL, FZ=FZ))

    (straight,) = equilibria(pulled(0.0, 0.0, 1.0))
    bent = solve(pulled(0.1, 0.2, 1.5), seed=straight.solution)
    assert bent.solved
    assert np.abs(bent.beta).max() == pytest.approx(0.2, abs=1e-9)
    back = solve(pulled(0.0, 0.0, 2.0), seed=bent)
    assert back.solved
    assert np.abs(back.beta).max() < 1e-12


def test_a_slope_means_the_equilibrium_whose_own_is_nearest() -> None:
    """Among 17 and among many of a slender wire; Newton's rule from the slope went elsewhere."""
    wire = Case(Rod(E=1e5, nu=0.3, a=0.25, L=60.0), Cylinder(1.0, "inside"), Ends(-0.17, -0.17, FZ=-9.0))
    cable = Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0), Cylinder(0.75), Ends(0.5, 0.8, FZ=-8.66, MZ=1.3, M3=6.1))
    for case in (cable, wire):
        slopes = np.array([one.dbeta0 for one in equilibria(case)])
        seeds = np.linspace(1.1 * slopes.min(), 1.1 * slopes.max(), 12)
        far = np.abs(slopes[:, None] - seeds)
        decided = np.diff(np.sort(far, axis=0)[:2], axis=0)[0] > 1e-9 * np.ptp(slopes)
        taken = np.array([solve(case, seed=seed, stations=2).dbeta[0] for seed in seeds])
        np.testing.assert_allclose(taken[decided], slopes[far.argmin(axis=0)][decided], atol=1e-9 * np.ptp(slopes))


def test_a_grid_takes_a_seed_for_each_case_or_one_for_all() -> None:
    case = PROBLEMS["section 5"]()
    one = found("section 5")[2]
    loads = case.given.FZ * np.array([1.0, 1.001, 1.002])
    grid = replace(case, given=replace(case.given, FZ=loads))
    together = solve(grid, seed=one.solution)
    assert together.solved.all()
    again = solve(grid, seed=together)
    np.testing.assert_allclose(again.beta, together.beta, atol=1e-9)
    for i, FZ in enumerate(loads):
        alone = solve(replace(case, given=replace(case.given, FZ=FZ)), seed=one.solution)
        np.testing.assert_array_equal(together.beta[i], alone.beta)


@pytest.mark.parametrize(
    ("weight", "contact", "given"),
    [
        (None, "bilateral", Ends(beta0=0.2, betaL=0.3, FZ=-5.0)),
        (None, "bilateral", Ends(beta0=0.2, betaL=0.3, height=5.0)),
        (0.1, "bilateral", Ends(beta0=0.2, betaL=0.3, FZ=-5.0)),
        (None, "unilateral", Ends(beta0=0.2, betaL=0.3, height=5.0, azimuth=0.1)),
    ],
    ids=["dead loads", "held", "weight", "unilateral"],
)
def test_a_seed_of_another_number_of_rods_is_refused_by_its_shape(weight, contact: str, given: Ends) -> None:
    two, three = (
        Case(
            Rod(E=1e4, nu=0.25, a=0.25, L=np.linspace(6.0, 6.1, n), weight=weight),
            Cylinder(0.75, contact=contact),
            given,
        )
        for n in (2, 3)
    )
    with pytest.raises(InputError, match=r"the cases of the seed have shape \(2,\), those to solve \(3,\)"):
        solve(three, seed=solve(two, stations=5))


def random_pairs(count: int, seed: int) -> Iterator[tuple[Case, Case]]:
    rng = np.random.default_rng(seed)
    for _ in range(count):
        numbers = [*rng.normal(0, 0.6, 3), rng.uniform(5, 40), *rng.uniform(-2, 2, 2)]
        moved = [*(numbers[:3] + rng.normal(0, 0.1, 3)), numbers[3] * np.exp(rng.normal(0, 0.1))]
        moved += list(numbers[4:] + rng.normal(0, 0.1, 2))
        yield ends_in_units_of_rho(*numbers), ends_in_units_of_rho(*moved)


@pytest.mark.parametrize(
    "count, seed", [(2, 0), pytest.param(40, 1, marks=pytest.mark.slow), pytest.param(40, 2, marks=pytest.mark.slow)]
)
def test_no_two_seeds_end_on_one_equilibrium_and_each_way_leads_back(count: int, seed: int) -> None:
    followed = 0
    for first, last in random_pairs(count, seed):
        starts, goals = list(equilibria(first)), list(equilibria(last))
        taken = []
        for one in starts:
            sol = solve(last, seed=one.solution)
            if not sol.solved:
                continue
            taken.append(place(sol, goals))
            assert goals[taken[-1]].index == one.index
            assert same(solve(first, seed=sol), one)
            followed += 1
        assert len(set(taken)) == len(taken)
    assert followed >= 4 * count


@pytest.mark.parametrize("MZ", [0.0664, 0.0648, 0.0632, 0.0600])
@pytest.mark.parametrize("FZ", [-0.0615, -0.02])
def test_a_seed_does_not_pass_two_folds_that_are_close_to_each_other(MZ: float, FZ: float) -> None:
    """The branch turns back at FZ = -0.009 and soon forward again: `follow` finds both folds, and what lies beyond them
    is another part of the branch, which small steps do not reach either."""
    rod = Rod(E=9134.311745258881, nu=0.06211705116560651, a=0.0669076780229075, L=11.789526625107417)
    cylinder, beta0, betaL = Cylinder(R=2.5792661701958184), 0.5817037179949309, -0.1725734779636321
    before, after = (Ends(beta0, betaL, FZ=f, MZ=MZ, M3=0.008224854724527102) for f in (0.06907893586993259, FZ))
    seed = solve(Case(rod, cylinder, before))
    folds = [point for point in follow(seed, FZ=FZ).special if point.kind == "fold"]
    assert len(folds) == 2
    assert "fold" in str(solve(Case(rod, cylinder, after), seed=seed).outcome)


@pytest.mark.parametrize("given", [{"FZ": -0.05}, {"height": 0.5}])
def test_rods_that_differ_by_a_million_whole_turns_at_both_ends_are_one(given: dict[str, float]) -> None:
    rod, turned = Rod(E=2e9, nu=0.3, a=0.001, L=1.0), 2e6 * np.pi
    near, far = (solve(Case(rod, Cylinder(R=0.1), Ends(angle, angle + 0.5, **given))) for angle in (0.0, turned))
    assert near.solved
    assert far.solved
    np.testing.assert_allclose(far.beta - turned, near.beta, atol=1e-7)


def test_the_outcome_of_a_rod_of_many_turns_or_bends_is_no_chance() -> None:
    """Its far angle has the error that rounding may make, whatever each rod happens to miss it by."""
    turned = [(Rod(E=2e9, nu=0.3, a=0.001, L=1.0), Cylinder(R=0.1), Ends(0.0, 7e6 + k, FZ=-0.05)) for k in range(40)]
    bent = [(Rod(1e4, 0.25, 0.25, 2e6 + k), Cylinder(R=1.0), Ends(0.3, -0.3, 3000.0)) for k in range(40)]
    for rods, rounding in ((turned, 6.2172e-8), (bent, 1.7566e-7)):
        solutions = [solve(Case(*rod)) for rod in rods]
        assert {str(sol.outcome).partition(": error")[0] for sol in solutions} == {
            "solved; fewer digits than the tolerance 1.0e-08 asks for"
        }
        assert [sol.error for sol in solutions] == pytest.approx([rounding] * 40, rel=1e-3)
        assert all(abs(sol.beta[-1] - sol.case.given.betaL) < sol.error / 2 for sol in solutions)


def test_a_rod_that_turns_a_million_times_is_followed() -> None:
    sol = solve(Case(Rod(E=2e9, nu=0.3, a=0.001, L=1.0), Cylinder(R=0.1), Ends(0.0, "7e6 rad", FZ=-0.05)))
    assert [point.value for point in follow(sol, FZ=-0.07).points][-1] == -0.07
