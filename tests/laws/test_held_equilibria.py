"""Equilibria with held ends: the list against a brute-force sweep, known problems and symmetries; its index and energy;
what the list says of its search; and what is refused."""

from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, equilibria, solve
from solver.branches.deflation import is_known
from solver.branches.given_numbers import Given, Mirror, OrbitState
from solver.branches.orbit_rates import NUMBERS, orbit_rates
from solver.equilibria_result import HeldEquilibria
from solver.held.held_search import image_of, mirrors_of, search_equilibria
from solver.numerics.arrays import Array
from solver.observe.observables import observe
from solver.orbits.boundary import path_of
from solver.orbits.level_search import FoundPaths, search_levels
from solver.problem.dimensionless import EndsProblem, reduce_held
from tests.laws.test_held_ends import discrete_index

SHORT, DRUM = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(0.75)  # rho = 1


def clamped(**held: Any) -> Case:
    return Case(SHORT, DRUM, Ends(**{"beta0": 0.0, "betaL": 0.0, **held}))


def dead(numbers: dict[str, float]) -> EndsProblem:
    return EndsProblem(**{name: np.array([value]) for name, value in numbers.items()})


def state_of(problem: EndsProblem, i: int) -> OrbitState:
    """Equilibrium i of a dead-load problem."""
    every = search_levels(problem)
    assert every is not None
    path = path_of(every.orbit.paths, i)
    return OrbitState(problem, path, orbit_rates(problem, [path]))


@pytest.fixture(scope="module")
def listed() -> HeldEquilibria:
    """Those of a clamped rod at a held height whose force is of the size that buckles it into one or two half waves."""
    found = equilibria(clamped(height=4.0), within={"FZ": (-90.0, -30.0)}, values=4, tries=0)
    assert isinstance(found, HeldEquilibria)
    return found


@pytest.mark.slow
def test_mirror_images_are_listed_and_each_index_is_that_of_the_constrained_second_variation(
    listed: HeldEquilibria,
) -> None:
    found = listed
    assert [one.index for one in found] == [0, 0, 1, 1]
    for one, image in zip(found[::2], found[1::2], strict=True):
        assert image.dbeta0 == pytest.approx(-one.dbeta0, abs=1e-10)
        assert pytest.approx(one.solution.FZ, rel=1e-11) == image.solution.FZ
        assert image.solution.beta == pytest.approx(-one.solution.beta, abs=1e-10)
    for one in found:
        orbit = one.solution.trajectory.orbit
        assert one.solution.z[-1] == pytest.approx(4.0, abs=1e-11)
        names = ("beta0", "betaL", "z", "lam", "mu")
        assert one.index == discrete_index(one.solution.problem, orbit, names, 1.25)
        assert one.dead_index == discrete_index(one.solution.problem, orbit, ("beta0", "betaL"), 1.25)


def test_the_energy_changes_with_the_height_by_the_force(listed: HeldEquilibria) -> None:
    """Under a held height the force does no work, and dE/d height = FZ."""
    one, step = listed[0].solution, 1e-3
    below, above = (solve(clamped(height=4.0 + d), seed=one, stations=5) for d in (-step, step))
    first, middle, last = (observe(each, ["energy"])["energy"] + each.FZ * each.z[-1] for each in (below, one, above))
    assert listed[0].energy == pytest.approx(float(middle), rel=1e-10)
    assert (last - first) / (2 * step) == pytest.approx(one.FZ, rel=1e-5)


def test_how_far_beta_goes_beyond_its_end_angles_is_told() -> None:
    found = equilibria(clamped(beta0=0.3, betaL=0.2, height=4.0), within={"FZ": (-60.0, -30.0)}, values=2, tries=0)
    assert found
    for one in found:
        beta = one.solution.beta
        assert one.stray == pytest.approx(max(beta.max() - 0.3, 0.2 - beta.min()), abs=1e-12)


def test_the_list_says_over_what_it_searched_and_that_it_is_not_proved_complete(listed: HeldEquilibria) -> None:
    assert not listed.complete
    assert listed.remark.startswith(
        "not proved complete: searched over FZ from -90 to -30; it began from the equilibria of 4 problems under dead "
        "loads that have at most 8 whole periods of beta (most_swings in Python)"
    )
    assert listed.search.within == {"FZ": (-90.0, -30.0)}
    assert listed.search.starts >= 2
    text = repr(listed).splitlines()
    assert text[0].startswith("4 equilibria, not proved complete")
    assert ", held energy " in text[1]
    assert text[1].endswith("beta'(0) = -0.669429, FZ = -36.1824; stable under dead loads")
    assert {one.found_by for one in listed} == {"continuation", "mirror image"}


def test_deflation_finds_what_a_sweep_of_two_loads_misses(listed: HeldEquilibria) -> None:
    def forces(tries: int) -> list[float]:
        found = equilibria(clamped(height=4.0), within={"FZ": (-120.0, -25.0)}, values=2, tries=tries)
        return [float(one.solution.FZ) for one in found]

    every = [float(one.solution.FZ) for one in listed]
    few = forces(0)
    assert len(few) == 2
    assert all(pytest.approx(one, rel=1e-9) in every for one in few)
    assert forces(6) == pytest.approx(every, rel=1e-9)


def test_an_equilibrium_found_outside_the_range_is_not_listed_but_its_load_is_told(listed: HeldEquilibria) -> None:
    few = equilibria(clamped(height=4.0), within={"FZ": (-60.0, -30.0)}, values=2, tries=4)
    inside = [float(one.solution.FZ) for one in few]
    assert all(-60 < load < -30 for load in inside)
    low, high = few.search.beyond["FZ"]
    assert few.search.outside == len(listed) - len(few) > 0
    assert [low, high] == pytest.approx([-79.4772, -79.4772], rel=1e-5)
    assert f"found outside these ranges and not listed (FZ = {low:.6g})" in few.remark


def test_with_two_displacements_held_the_search_over_both_loads_finds_the_known_ones() -> None:
    own = {"FZ": -20.0, "MZ": 3.0}
    known = solve(Case(SHORT, DRUM, Ends(0.3, -0.2, M3=5.0, **own)), choose="lowest")
    height, azimuth = float(known.z[-1]), float(known.alpha[-1] - known.alpha[0])
    case = Case(SHORT, DRUM, Ends(0.3, -0.2, M3=5.0, height=height, azimuth=azimuth))
    (one,) = equilibria(case, within={"FZ": (-40.0, 0.0), "MZ": (-10.0, 10.0)}, values=2, tries=0)
    assert {name: float(load) for name, load in one.solution.reactions.items()} == pytest.approx(own, abs=1e-6)
    np.testing.assert_allclose(np.interp(one.solution.s, known.s, known.beta), one.solution.beta, atol=1e-3)


def test_a_default_range_far_wider_than_the_list_comes_with_a_narrower_one_to_search() -> None:
    wide = equilibria(clamped(beta0=0.3, betaL=0.2, rotation=1.0), values=5, tries=0)
    ((low, high),) = wide.search.narrower.values()
    assert f"--within M3={low:g}:{high:g} (in Python within) searches it more finely" in wide.remark
    outer = wide.search.within["M3"]
    assert 2.5 * (high - low) < outer[1] - outer[0]
    again = equilibria(clamped(beta0=0.3, betaL=0.2, rotation=1.0), within=wide.search.narrower, values=5, tries=0)
    forces = [float(one.solution.reactions["M3"]) for one in wide]
    assert forces
    np.testing.assert_allclose([float(one.solution.reactions["M3"]) for one in again], forces, rtol=1e-9)
    assert "--within" not in again.remark  # the range was given


def test_a_straight_rod_whose_rotation_is_held_is_listed_with_both_indices() -> None:
    """Under FZ = -20 N and no MZ it is a helix, which no continuation reaches."""
    found = equilibria(clamped(rotation=0.0, FZ=-20.0), within={"M3": (-1.0, 1.0)}, values=2, tries=0)
    (straight,) = [one for one in found if one.found_by == "helix"]
    assert np.abs(straight.solution.beta).max() == 0
    assert straight.solution.outcome == "solved"
    orbit = straight.solution.trajectory.orbit
    names = ("beta0", "betaL", "phi", "lam", "turn")
    assert (straight.index, straight.dead_index) == (0, 1)
    assert straight.index == discrete_index(straight.solution.problem, orbit, names, 1.25)


def test_a_fully_stretched_rod_is_told_to_bear_any_load() -> None:
    found = equilibria(clamped(height=5.0), values=2, tries=0)
    assert not found
    assert found.remark.endswith("a straight rod or a helix is an equilibrium under any load and is not listed")


def test_all_images_of_an_equilibrium_solve_the_problems_of_their_numbers() -> None:
    problem = dead({"beta0": 0.4, "betaL": -0.2, "lam": 0.3, "mu": -0.5, "phi": -0.8, "span": 6.0})
    for i in range(3):
        state = state_of(problem, i)
        values = dict(zip(NUMBERS, state.rates.values[0].tolist(), strict=True))
        values["turn"] = 1.25 * values["mu"] * 6.0 - values.pop("swirl")
        del values["y"]
        for mirror in (Mirror(a, b, c) for a in (False, True) for b in (False, True) for c in (False, True)):
            wanted = dict(mirror.number(name, value) for name, value in values.items())
            given = Given(("beta0", "betaL", "z"), np.array([wanted[n] for n in ("beta0", "betaL", "z")]), 6.0, 1.25)
            image = image_of(state, mirror, given).rates
            got = dict(zip(NUMBERS, image.values[0].tolist(), strict=True))
            got["turn"] = 1.25 * got["mu"] * 6.0 - got["swirl"]
            assert {name: got[name] for name in wanted} == pytest.approx(wanted, abs=1e-10)
            assert float(image.length[0]) == pytest.approx(6.0, abs=1e-11)


def test_only_images_with_the_given_numbers_are_taken() -> None:
    def images(**ends: Any) -> set[tuple[bool, bool, bool]]:
        given = Given.of(reduce_held(Case(SHORT, DRUM, Ends(**ends))))
        return {(one.negated, one.turned, one.backward) for one in mirrors_of(given)}

    assert images(beta0=0.3, betaL=0.3, height=4.0) == {(False, False, True)}
    assert images(beta0=0.3, betaL=-0.3, height=4.0) == {(True, False, True)}
    assert images(beta0=0.3, M1L=0.0, height=4.0) == set()
    assert images(M10=0.0, M1L=0.0, height=0.0) == {
        (a, b, c) for a in (False, True) for b in (False, True) for c in (False, True) if a or b or c
    }
    assert images(M10=0.0, M1L=0.0, height=1.0, MZ=1.0) == {(False, False, True)}


ROW = {"alpha": 2, "z": 3}  # of what an orbit returns


def equilibria_under(case: Case, number: str, load: float) -> tuple[FoundPaths, Array]:
    """All equilibria under a dead load in place of what is held, and what they have of it."""
    given = Given.of(reduce_held(case))
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    numbers = {name: known.get(name, load) for name in ("beta0", "betaL", "lam", "mu", "phi")}
    every = search_levels(dead({**numbers, "span": given.span}))
    assert every is not None
    return every, every.orbit.at(every.orbit.problem.span[:, None])[ROW[number]][:, 0]


def crossings(case: Case, number: str, wanted: float, loads: Array) -> list[float]:
    """The loads before which some equilibrium passes the wanted displacement, by a fine sweep under dead loads.

    Equilibria at neighbouring loads are joined on their paths by the order of their levels; no Newton's rule is used.
    """
    found, before = [], dict[tuple[int, int], list[tuple[float, float]]]()
    for load in loads.tolist():
        every, values = equilibria_under(case, number, load)
        now: dict[tuple[int, int], list[tuple[float, float]]] = {}
        for i, off in enumerate((values - wanted).tolist()):
            path = path_of(every.orbit.paths, i)
            now.setdefault((path.leaving, path.turns), []).append((float(every.dbeta0[i] ** 2), off))
        for kind, some in now.items():
            past = sorted(before.get(kind, []))
            if len(past) == len(some):
                found += [load for (_, a), (_, b) in zip(past, sorted(some), strict=True) if a * b < 0]
        before = now
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("held", "number", "load"), (
    ({"height": 4.0}, "z", "phi"),
    ({"height": 1.0, "MZ": 10.0}, "z", "phi"),
    ({"azimuth": 1.0, "FZ": -20.0}, "alpha", "lam"),
))  # fmt: skip
def test_the_list_has_all_that_a_sweep_of_1000_loads_shows(held: dict[str, float], number: str, load: str) -> None:
    case = Case(SHORT, DRUM, Ends(**{"beta0": 0.35, "betaL": 0.2, **held}))
    wanted = next(iter(held.values()))
    found = equilibria(case)
    assert isinstance(found, HeldEquilibria)
    A = case.rod.bending_stiffness
    loads = np.linspace(*next(iter(found.search.within.values())), 1000) / A
    mine = np.array([float(getattr(one.solution.problem, load)[0]) for one in found])
    for one in crossings(case, number, wanted, loads):
        assert ((mine <= one) & (mine >= one - np.diff(loads)[0])).any(), one
    for one in mine.tolist():
        assert np.abs(equilibria_under(case, number, one)[1] - wanted).min() < 1e-9


PAIRED = (("beta0", "dbeta0"), ("betaL", "dbetaL"), ("phi", "z"), ("lam", "alpha"), ("mu", "turn"))


def finds_a_known_one(seed: int, count: int) -> bool:
    """Whether the search finds a random dead-load equilibrium, `count` of whose numbers are held in place of loads."""
    rng = np.random.default_rng(1000 * count + seed)
    numbers = dict(zip(("beta0", "betaL"), rng.uniform(-1.5, 1.5, 2).tolist(), strict=True))
    numbers |= dict(zip(("lam", "mu", "phi"), rng.uniform(-1, 1, 3).tolist(), strict=True))
    numbers["span"] = float(rng.uniform(2, 12))
    problem = dead(numbers)
    every = search_levels(problem)
    assert every is not None
    state = state_of(problem, int(rng.integers(every.dbeta0.size)))
    values = dict(zip(NUMBERS, state.rates.values[0].tolist(), strict=True))
    values["turn"] = 1.25 * values["mu"] * numbers["span"] - values["swirl"]
    which = rng.permutation(5)[:count]
    names = tuple(pair[k in which] for k, pair in enumerate(PAIRED))
    given = Given(names, np.array([values[name] for name in names]), numbers["span"], 1.25)
    return is_known(state, search_equilibria(given, {}, 8, 10).known)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 60, 10))
def test_known_equilibria_with_one_held_quantity_are_found(first: int) -> None:
    assert all(finds_a_known_one(seed, 1) for seed in range(first, first + 10))


@pytest.mark.slow
def test_two_equilibria_between_a_value_of_the_sweep_and_a_fold_are_found() -> None:
    assert finds_a_known_one(4, 1)


def test_the_reactions_of_a_listed_equilibrium_hold_it(listed: HeldEquilibria) -> None:
    for one in listed:
        again = solve(clamped(FZ=float(one.solution.FZ)), seed=one.dbeta0)
        assert again.z[-1] == pytest.approx(4.0, abs=1e-9)
    assert np.diff([one.energy for one in listed]).min() > -1e-9


@pytest.mark.slow
def test_the_rod_that_solve_finds_in_a_long_hole_is_in_the_list() -> None:
    """It buckles at a thousandth of the loads that the cylinder's curvature adds."""
    rod = Rod(EI=1224.0, GJ=941.6, a=0.0635, L=30.0)
    case = Case(rod, Cylinder(R=0.108, side="inside"), Ends(beta0=0.0, betaL=0.0, height=29.995))
    found = equilibria(case)
    stable = [one for one in found if one.index == 0]
    assert len(stable) == 2
    for one in stable:
        assert pytest.approx(float(solve(case).FZ), rel=1e-6) == one.solution.FZ
