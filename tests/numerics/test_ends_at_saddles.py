"""Rods between two ends that lie on, or next to, a saddle of the dynamics, or along it for long; and what the list of
equilibria says of itself."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solver import Case, Cylinder, Ends, Rod, Start, equilibria, solve
from solver.branches.charts import same_equilibrium
from solver.branches.orbit_rates import orbit_rates
from solver.observe.observables import observe
from solver.orbits.boundary import Levels, boundary_of, critical_points, path_of, transit_times
from solver.orbits.level_grid import level_grid_of
from solver.orbits.level_search import search_levels
from solver.orbits.path_orbits import orbit_of
from solver.problem.dimensionless import EndsProblem, Reduced, reduce
from tests.cases import ends_in_units_of_rho, in_units_of_rho
from tests.equation import force, march, potential

A = 0.01
E = 1 / (np.pi / 4 * A**4)  # with a hole of radius 1 - A: bending stiffness and distance from the axis are 1


def case(L: float, beta0: float, betaL: float, **loads: float) -> Case:
    return Case(Rod(E, 0.25, A, L), Cylinder(1 - A), Ends(beta0, betaL, **loads))


@pytest.mark.parametrize("L", (100.0, 163.0, 400.0))
def test_the_rod_nears_the_saddle_in_its_middle_as_exactly_as_told(L: float) -> None:
    """Beyond the place where 1e-7 rad is left to the saddle, what is left falls as exp(-r s), to 1e-7 of itself."""
    rod = case(L, 1.35, 0.25, FZ=0.0765, MZ=0.0778)
    (found,) = equilibria(rod, stations=801)
    solution, problem = found.solution, reduce(rod)
    saddle = float(solution.beta[400])
    lam, mu, phi = (float(v) for v in (problem.lam[0], problem.mu[0], problem.phi[0]))
    assert abs(float(force(np.array(saddle), lam, mu, phi))) < 1e-15
    step = 1e-6
    rate = np.sqrt(np.diff(-force(saddle + step * np.array([-1.0, 1.0]), lam, mu, phi))[0] / (2 * step))
    left = solution.beta - saddle
    for far, s in ((left[:400], solution.s[:400]), (left[:400:-1], solution.s[-1] - solution.s[:400:-1])):
        one = int(np.argmax(np.abs(far) < 1e-7))
        expected = far[one] * np.exp(-rate * (s[one:] - s[one]))
        assert np.abs(far[one:] - expected).max() < float(solution.error) + 2e-14


def signed_count(found) -> int:
    return sum((-1) ** one.index for one in found)


NAMED = {
    "axis": (0.0, 0.1, {"FZ": 1.0}),
    "axis, the other way": (np.pi, np.pi + 0.1, {"FZ": -1.0}),
    "hoop": (np.pi / 2, np.pi / 2 + 0.1, {"MZ": 6.0}),
    "to the hoop": (0.0, np.pi / 2, {"FZ": 1.0}),
    "turned round": (0.0, np.pi, {"FZ": 1.0}),
}


@pytest.mark.parametrize("L", (20.0, 100.0, 1e4, 1e6))
@pytest.mark.parametrize("name", NAMED)
def test_a_rod_that_starts_on_a_saddle_leaves_it_along_the_separatrix(name: str, L: float) -> None:
    """One stable equilibrium for every length; near its far end it solves beta_t = sqrt(G(saddle) - G(beta))."""
    beta0, betaL, loads = NAMED[name]
    found = equilibria(case(L, beta0, betaL, **loads))
    assert found.complete
    assert [one.index for one in found] == [0]
    sol = solve(case(L, beta0, betaL, **loads), stations=L - np.linspace(9.0, 0, 31))
    assert sol.solved, sol.outcome
    numbers = loads.get("MZ", 0.0), 0.0, loads.get("FZ", 0.0)

    def back(_: float, b: np.ndarray) -> np.ndarray:
        x = np.sin((b - beta0) / 2)
        # G(saddle) - G(beta) without cancellation next to the saddle: by the sine of half the distance
        fall = potential(np.array(beta0), *numbers) - potential(b, *numbers)
        near = -force(np.array(beta0 + 1e-4), *numbers) / 1e-4 * 4 * x * x
        return -np.sqrt(np.where(np.abs(b - beta0) < 1e-3, near, np.maximum(fall, 0)))

    b = solve_ivp(back, (0, 9.0), [betaL], "DOP853", t_eval=np.linspace(0, 9, 31), rtol=1e-11, atol=1e-13).y[0]
    np.testing.assert_allclose(sol.beta, b[::-1], atol=2e-5 if L == 20 else 2e-7)  # exp(-20 + 9); the near law


def test_a_longer_rod_on_a_saddle_is_the_shorter_one_with_more_of_the_saddle() -> None:
    """Energy, azimuth and height grow by those of the saddle itself."""
    at = {L: equilibria(case(L, 0.0, 0.1, FZ=1.0))[0] for L in (200.0, 1e6)}
    more = 1e6 - 200
    assert at[1e6].energy - at[200.0].energy == pytest.approx(-more, abs=1e-8)  # -FZ a length
    height = {L: float(observe(one.solution, ["height"])["height"]) for L, one in at.items()}
    assert height[1e6] - height[200.0] == pytest.approx(more, abs=1e-8)
    for one in at.values():
        assert one.solution.beta[-1] == pytest.approx(0.1, abs=1e-9)
        assert one.stray == 0


@pytest.mark.parametrize("L, count", ((20.0, 1), (200.0, 9)))
def test_a_rod_that_starts_a_billionth_from_a_saddle_is_found(L: float, count: int) -> None:
    found = equilibria(case(L, 1e-9, 0.1, FZ=1.0))
    assert found.complete
    assert len(found) == count
    assert found[0].index == 0
    assert np.abs(found[0].solution.beta).max() == pytest.approx(0.1, abs=1e-12)


@pytest.mark.parametrize(
    "L, beta0, betaL, count", ((100.0, 1e-4, 0.1, 9), (100.0, 1e-5, 0.1, 7), (136.78, -0.0011812387, -0.7317418, 15))
)
def test_next_to_a_saddle_none_is_lost_and_none_found_twice(L: float, beta0: float, betaL: float, count: int) -> None:
    """The signed count of these was once 2, 0 and 0, and is 1 by degree."""
    found = equilibria(case(L, beta0, betaL, FZ=1.0))
    assert found.complete
    assert signed_count(found) == 1
    assert len(found) == count


def nylon() -> Case:
    return Case(Rod(2e9, 0.35, 2e-4, 1.0), Cylinder(0.005), Ends(0.1, 0.1, FZ=10.0))


@pytest.mark.parametrize("rate", (1e2, 1e3, 1e4, 1e6))
def test_the_one_of_lowest_energy_is_stable_however_long_the_rod(rate: float) -> None:
    """phi = 1, so that r L is the length; ends beside the saddle."""
    found = search_levels(reduce(ends_in_units_of_rho(0.0, 0.0, 1.0, rate, 0.1, 0.1)), most_turns=1)
    assert found is not None
    best = int(np.argmin(found.energy))
    assert found.index[best] == 0
    assert found.stray[best] == pytest.approx(0.1, abs=1e-12)  # down to the axis and back
    middle = found.orbit.take(np.array([best])).at(np.array([[rate / 2]]))[0][0, 0]
    assert abs(middle) < 1e-15


def pipe(L: float) -> Case:
    return Case(Rod(2.1e8, 0.3, 0.06, L), Cylinder(0.11, "inside"), Ends(0.0, 0.0, FZ=-200.0))


@pytest.mark.parametrize("L, lowest", ((30.0, None), (100.0, 19999.49)))
def test_energies_are_those_of_the_very_shapes_and_stand_in_order(L: float, lowest: float | None) -> None:
    """Bending energy less the work of the loads by Simpson's rule on 40,001 points."""
    made = pipe(L)
    found = equilibria(made, stations=40001 if L == 30 else 2)
    energy = np.array([one.energy for one in found])
    assert (np.diff(energy) > -1e-9 * np.abs(energy[:-1]).max()).all()
    assert found.complete
    assert found[0].index == 0
    if lowest is not None:
        assert energy[0] == pytest.approx(lowest, abs=0.005)
        return
    stiff = made.rod.bending_stiffness
    for one in found:
        sol = one.solution
        s, b = sol.s, sol.beta
        density = stiff / 2 * (sol.dbeta**2 + np.sin(b) ** 4 / made.rho**2) + 200.0 * np.cos(b)
        h = s[1] - s[0]
        simpson = h / 3 * (density[0] + density[-1] + 4 * density[1:-1:2].sum() + 2 * density[2:-1:2].sum())
        assert one.energy == pytest.approx(simpson, rel=1e-8)  # (0.03 r)^4 of the rule at 0.75 mm
        assert float(observe(sol, ["energy"])["energy"]) == pytest.approx(one.energy, rel=1e-12)


# what the search rests on


@pytest.mark.parametrize("numbers", ((-0.3655, 0.7464, -0.7506, 20.0, 0.5, 0.5), (0.3, 0.5, 0.9, 8.0, 1.0, 2.5),
                                     (0.0, 0.0, 1.0, 20.0, 0.0, 0.1), (0.0, 0.0, 1.0, 20.0, 1e-4, -0.3)))  # fmt: skip
def test_times_next_to_a_saddle_go_on_by_the_law_of_the_log_gap(numbers) -> None:
    """Continued by the law from its rung on, and computed 200 further down."""
    boundary, chain = level_grid_of(boundary_of(reduce(ends_in_units_of_rho(*numbers))))
    first = int(np.argmax(~chain.at_saddle & (chain.levels.pin == chain.levels.pin.max())))
    pin, sign = chain.levels.pin[first], chain.levels.sign[first]
    y = boundary.deepest - np.array([1.0, 60.0, 200.0])
    levels = Levels(np.full(3, pin), np.full(3, sign), y)
    counts = boundary.ways(4).counts(boundary.rising)
    law = transit_times(boundary, levels).lengths(counts)
    direct = transit_times(replace(boundary, deepest=-570.0), levels).lengths(counts)
    np.testing.assert_allclose(law, direct, rtol=1e-12)
    assert np.isfinite(law).any()


def test_stable_ones_turn_once_at_most_so_they_are_found_without_the_others() -> None:
    problem = reduce(ends_in_units_of_rho(-0.3655, 0.7464, -0.7506, 20.0, np.pi / 6, np.pi / 6))
    every, few = search_levels(problem), search_levels(problem, most_turns=1)
    assert every is not None
    assert few is not None
    np.testing.assert_allclose(np.sort(every.dbeta0[every.index == 0]), np.sort(few.dbeta0[few.index == 0]), rtol=1e-12)
    assert few.total == every.total == every.dbeta0.size == 31


@pytest.mark.parametrize("L", (20.0, 60.0))
def test_how_an_equilibrium_answers_to_its_far_angle_is_what_moving_it_shows(L: float) -> None:
    """Largest |d beta/d beta(L)|, against the two shapes next to it, for every one of the same path."""
    numbers, step = (-0.3655, 0.7464, -0.7506, L, 0.5), 1e-7
    there, here, beyond = (equilibria(ends_in_units_of_rho(*numbers, 0.5 + d), stations=4001) for d in (-step, 0, step))

    def key(one):
        p = one.path
        return float(p.pin[0]), float(p.sign[0]), int(p.leaving[0]), int(p.turns[0])

    counted = 0
    for one in here:
        pair = [[o for o in other if key(o) == key(one)] for other in (there, beyond)]
        if any(len(p) != 1 for p in pair) or one.solution.condition > 1e3:
            continue  # the level is pinned otherwise, or a fold is near
        moved = np.abs(pair[1][0].solution.beta - pair[0][0].solution.beta).max() / (2 * step)
        assert max(1.0, moved) == pytest.approx(float(one.solution.condition), rel=2e-3)  # stations, step
        counted += 1
    assert counted > 20


def test_a_list_of_at_most_so_many_periods_says_so() -> None:
    found = equilibria(nylon(), most_swings=3)
    assert not found.complete
    assert "at most 3 whole periods" in found.remark


# random problems


def random_on_the_axis(rng: np.random.Generator) -> tuple[float, ...]:
    """Ends exactly on a saddle of a random problem, or a little beside it, of length up to r L of a million."""
    lam, mu, phi = rng.uniform(-2, 2, 3) * rng.choice([0, 1, 1, 10], 3)
    b = critical_points(Reduced(*(np.array([v]) for v in (lam, mu, phi, 1.0, 0.0))))
    saddles = b.beta[0, : b.count[0]][~b.centre[0, : b.count[0]]]
    first = rng.choice(saddles) + rng.choice([0, 0, 1e-3, -1e-6, 1e-9])
    last = rng.choice(saddles) if rng.random() < 0.3 else rng.uniform(-4, 4)
    ends = (first, last) if rng.random() < 0.5 else (last, first)
    return lam, mu, phi, 10 ** rng.uniform(1, 6), *ends


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_random_ends_on_saddles_have_a_stable_equilibrium_and_a_signed_count_of_one(seed: int) -> None:
    numbers = random_on_the_axis(np.random.default_rng(seed))
    found = search_levels(EndsProblem(*(np.array([v]) for v in numbers[:6])), 20, 1)
    assert found is not None
    assert not found.remark or found.remark.startswith("only")
    assert found.index[np.argmin(found.energy)] == 0


def ends_by_march(numbers: tuple[float, ...], slopes: np.ndarray) -> np.ndarray:
    """beta(L) of rods that start with these slopes."""
    *loads, span, beta0 = numbers[:5]
    return march(loads, beta0, slopes, span, 1e-8, t_eval=[span]).y[: slopes.size, -1]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(60))
def test_a_scan_of_start_slopes_by_a_march_finds_none_that_is_not_listed(seed: int) -> None:
    """And each listed one that a march can reach is met by it: so the counts agree where both methods apply."""
    rng = np.random.default_rng(seed)
    lam, mu, phi = rng.uniform(-2, 2, 3) * rng.choice([0, 1, 1], 3)
    numbers = lam, mu, phi, rng.uniform(0.5, 9), *rng.uniform(-3.5, 3.5, 2)
    found = equilibria(ends_in_units_of_rho(*numbers), stations=3)
    assert found.complete
    known = np.sort([one.dbeta0 for one in found])
    most = np.abs(known).max() + 1.0
    slopes = np.linspace(-most, most, 3001) + 1e-5
    for _ in range(2):  # finer where the far end moves fast
        end = ends_by_march(numbers, slopes)
        wide = np.abs(np.diff(end)) > 0.3
        slopes = np.sort(np.concatenate([slopes, ((slopes[1:] + slopes[:-1]) / 2)[wide]]))
    end = ends_by_march(numbers, slopes)
    off = end - numbers[5]
    for k in np.flatnonzero((off[:-1] * off[1:] < 0) & (np.abs(np.diff(end)) < 1)):
        assert ((known > slopes[k] - 1e-6) & (known < slopes[k + 1] + 1e-6)).any(), slopes[k]
    again = ends_by_march(numbers, known)
    reached = in_units_of_rho(*numbers[:5], known)
    assert isinstance(reached.given, Start)
    reach = solve(reached, stations=2).condition
    easy = reach < 1e5  # the march loses eps times this
    np.testing.assert_allclose(again[easy], numbers[5], atol=1e-2)


def any_number(rng: np.random.Generator) -> float:
    """Zero, whole, plain, or of any size that a float has."""
    sizes = (0.0, float(rng.integers(1, 4)), *10 ** rng.uniform((-2, -2, -12, -300), (2, 2, 12, 100)))
    return float(rng.choice(sizes) * rng.choice([-1, 1]))


def any_angle(rng: np.random.Generator) -> float:
    special = rng.choice([0.0, np.pi, -np.pi, np.pi / 2, 2 * np.pi, 1e-9, 1e-300, -1e-17])
    return float(rng.choice([special, any_number(rng), rng.uniform(-4, 4), rng.uniform(-4, 4)]))


def ends_of_any_size(seed: int) -> tuple[float, ...]:
    rng = np.random.default_rng(seed)
    first, last = any_angle(rng), any_angle(rng)
    last = first if rng.random() < 0.15 else last
    return abs(any_number(rng)) or 1.0, first, last, *(any_number(rng) for _ in range(3))


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("block", range(10))
def test_ends_problems_of_any_size_are_solved_or_say_why_not(block: int) -> None:
    """No exception and no warning; what is called solved is finite and ends where it should, within its error."""
    for seed in range(40 * block, 40 * block + 40):
        L, first, last, FZ, MZ, M3 = ends_of_any_size(seed)
        sol = solve(case(L, first, last, FZ=FZ, MZ=MZ, M3=M3), stations=5)
        assert sol.solved or str(sol.outcome).startswith("failed: "), seed
        if sol.solved:
            assert np.isfinite([sol.beta, sol.contact]).all(), seed
            assert abs(sol.beta[-1] - last) <= max(sol.error, 1e-8 * max(1.0, sol.condition, abs(last))), seed


def test_a_search_beyond_its_budget_solves_the_paths_of_fewest_bends_and_says_so(monkeypatch) -> None:
    """The budget counts evaluations, so the answer does not depend on the machine."""
    monkeypatch.setattr("solver.orbits.level_search.BUDGET", 1e5)
    found = equilibria(nylon())
    assert not found.complete
    assert "bends" in found.remark
    assert min(one.index for one in found) == 0


@pytest.mark.parametrize("FZ", (-19.652, -19.6536))
def test_a_narrow_peak_of_the_length_at_a_shelf_of_the_potential_hides_no_pair(FZ: float) -> None:
    rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    found = equilibria(Case(rod, Cylinder(R=0.75), Ends("30deg", "30deg", M3=8.0, FZ=FZ, MZ=3.9992)))
    assert (
        len(found) == 31
    )  # a grid of levels eight times as fine has as many; without levels at the shelf there are 29
    hidden = [one.index for one in found if one.bends == 1 and 0.14 < one.dbeta0 < 0.16]
    assert sorted(hidden) == [0, 1]


@pytest.mark.parametrize("E", 10.0 ** np.arange(8, 14))
@pytest.mark.parametrize("FZ", (-200.0, -0.2, 0.2))
def test_a_stiff_rod_under_a_small_axial_force_has_a_whole_list(E: float, FZ: float) -> None:
    """Two saddles of nearly one height: such loads come of a slip in units."""
    hole = Cylinder(R=0.108, side="inside")
    found = equilibria(Case(Rod(2.06 * E, 0.3, 0.0635, 60.0), hole, Ends(0.0, 0.0, FZ=FZ)))
    assert found.complete
    assert signed_count(found) == 1
    slopes = np.sort([one.dbeta0 for one in found])
    assert 0.0 in slopes
    np.testing.assert_allclose(slopes, -slopes[::-1], rtol=1e-6, atol=1e-12 * np.abs(slopes).max())


@pytest.mark.parametrize("L", (80.0, 150.0))
def test_an_equilibrium_next_to_a_saddle_is_the_same_whatever_the_last_digits_of_that_saddle(L: float) -> None:
    """Loads that are computed in two ways differ in a last digit, and so do the saddles that are found with them."""
    rod = case(L, 1.35, 0.25, FZ=0.6, MZ=0.3)
    problem, place = reduce(rod), boundary_of(reduce(rod))
    found = [one for one in equilibria(rod) if one.index == 0]
    assert found
    for one in found:
        path, (true,) = path_of(one.path, 0), [orbit_rates(problem, [path_of(one.path, 0)]).values]
        shape = one.solution.beta
        for digits in (-3, -1, 1, 3):
            moved = replace(path, pin=path.pin + digits * np.spacing(path.pin))
            rates = orbit_rates(problem, [moved])
            np.testing.assert_allclose(rates.length, L, rtol=1e-12)
            np.testing.assert_allclose(rates.values, true, rtol=1e-10, atol=1e-12)
            np.testing.assert_allclose(orbit_of(problem, moved).at(one.solution.t)[0][0], shape, atol=1e-9)
            assert same_equilibrium(problem, path, moved)
            assert place.joins_at(moved) == place.joins_at(path)
