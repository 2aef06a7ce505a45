"""Which equilibrium between held ends is meant by default: the stable one of least held energy that is found."""

from collections.abc import Iterable

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, equilibria, follow, observe, solve
from solver.equilibria_result import energy_as_held
from tests.slow import slow

SHORT, DRUM = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75)  # rho = 1
FLAT = Rod(EI=1.0, GJ=1.0, a=0.001, L=1.0), Cylinder(R=100.0)
PIPE = Rod(2.06e8, 0.3, 0.0635, 300.0, inner_radius=0.0543), Cylinder(0.108, "inside")  # m and kN


def test_a_rod_whose_arch_is_symmetric_and_unstable_takes_one_of_its_stable_sides() -> None:
    sol = solve(Case(SHORT, DRUM, Ends("20deg", "-20deg", height=4.6)))
    assert (sol.held_index, float(sol.FZ)) == (0, pytest.approx(-25.898892401, rel=1e-9))
    assert sol.dbeta[0] > 0  # of the two mirror images
    assert str(sol.selection) == "2 equilibria compared, 2 stable; shown: the stable one of least held energy"


def test_a_rod_on_a_nearly_flat_wall_takes_the_natural_arch_and_not_a_higher_stable_wave() -> None:
    sol = solve(Case(*FLAT, Ends("20deg", "-20deg", height=0.95, azimuth=0.0)))
    assert (sol.held_index, float(sol.FZ)) == (0, pytest.approx(-18.341449515, rel=1e-9))


def test_a_straight_rod_that_is_stable_is_taken_before_one_that_its_push_turned_round() -> None:
    straight = solve(Case(Rod(EI=1.0, GJ=0.7, a=0.1, L=7.0), Cylinder(R=0.9), Ends(0.0, 0.0, azimuth=0.0, FZ=-0.3)))
    assert np.abs(straight.beta).max() == 0
    assert (straight.held_index, energy_as_held(straight)) == (0, pytest.approx(2.1, rel=1e-12))


@pytest.mark.parametrize("held", [{"azimuth": 0.0}, slow({"rotation": 0.0})])
def test_a_compressed_pipe_that_is_held_lies_in_lubinskis_helix_too(held: dict[str, float]) -> None:
    """The lowest energy is that of a rod which the push turned round, as under dead loads."""
    case = Case(*PIPE, Ends(0.0, 0.0, FZ=-300.0, **held))
    sol, lowest = solve(case), solve(case, choose="lowest")
    assert sol.held_index == 0
    assert sol.z[-1] > 0.999 * 300
    assert np.abs(sol.beta).max() < np.deg2rad(2)
    assert lowest.z[-1] < -0.9 * 300
    assert energy_as_held(lowest) < energy_as_held(sol)
    assert sol.selection.turned > 0
    assert "set aside" in str(sol.selection)


FAMILIES = {
    "one held": ("height",), "two held": ("height", "azimuth"), "three held": ("height", "azimuth", "rotation"),
    "a hinge": ("height",), "nearly flat": ("height", "azimuth"),
}  # fmt: skip
VALUES = {1: 31, 2: 7, 3: 4}  # of each reaction, from which the list is searched


def random_case(family: str, seed: int) -> Case:
    """Clamped at up to 69 degrees, or hinged at the far end; 2 to 8 rho long, or on a wall that is nearly flat."""
    rng = np.random.default_rng([seed, len(family)])
    L = 1.0 if family == "nearly flat" else float(np.exp(rng.uniform(np.log(2), np.log(8))))
    rod, wall = (Rod(EI=1.0, GJ=0.8, a=0.1, L=L), Cylinder(0.9)) if L > 1 else FLAT
    far, direction = L * rng.uniform(0.4, 0.95), 0.3 * rng.normal()
    height, around = far * np.cos(direction), far * np.sin(direction)
    every = {"height": height, "azimuth": around / (wall.R + rod.a), "rotation": rng.uniform(-3, 3)}
    first, last = rng.uniform(-1.2, 1.2, 2)
    end: dict[str, float] = {"M1L": 0.0} if family == "a hinge" else {"betaL": float(last)}
    return Case(rod, wall, Ends(float(first), **end, **{name: float(every[name]) for name in FAMILIES[family]}))


ARCHES = {"one held": 5, "two held": 2, "three held": 8, "a hinge": 11, "nearly flat": 5}  # below other stable ones


@pytest.mark.parametrize(
    ("family", "seeds"),
    [*((name, [seed]) for name, seed in ARCHES.items()), *(slow(name, range(20)) for name in FAMILIES)],
)
def test_no_stable_equilibrium_of_the_list_has_less_held_energy(family: str, seeds: Iterable[int]) -> None:
    for seed in seeds:
        case = random_case(family, seed)
        sol = solve(case)
        assert (sol.outcome, sol.held_index) == ("solved", 0)
        unknown = len(sol.reactions)
        stable = [one.energy for one in equilibria(case, tries=0, values=VALUES[unknown]) if one.index == 0]
        assert energy_as_held(sol) <= min(stable, default=np.inf) + 1e-8 * (1 + abs(energy_as_held(sol))), seed


def test_lowest_and_an_index_select_under_held_ends_and_an_unstable_one_says_so_first() -> None:
    case = Case(SHORT, DRUM, Ends("20deg", "-20deg", height=4.6))
    usual = solve(case)
    for choose in ("lowest", 0):
        np.testing.assert_allclose(solve(case, choose=choose).beta, usual.beta, atol=1e-12)
    unstable = solve(case, choose=1)
    assert (unstable.held_index, float(unstable.FZ)) == (1, pytest.approx(-42.763077912, rel=1e-9))
    assert str(unstable.selection).startswith("unstable under held ends, index 1; ")
    assert "of those of index 1 that of least held energy" in str(unstable.selection)
    none = solve(case, choose=9)
    assert none.outcome.startswith("failed: none of the ")
    assert "found has index 9; their indices: 0, 1, 2, 3" in none.outcome
    with pytest.raises(InputError, match="a seed and choose = 'lowest' exclude each other"):
        solve(case, seed=usual, choose="lowest")


def test_the_index_under_dead_loads_is_one_number_wherever_it_is_read() -> None:
    """Of this rod the held height excludes the one direction that is unstable under dead loads."""
    case = Case(SHORT, DRUM, Ends("20deg", "20deg", height=2.9))
    sol, listed = solve(case), equilibria(case, values=21, tries=0)[0]
    assert float(sol.FZ) == pytest.approx(listed.solution.FZ, rel=1e-9)
    assert (sol.held_index, sol.dead_index) == (0, 1) == (listed.index, listed.dead_index)
    dead = equilibria(Case(SHORT, DRUM, Ends("20deg", "20deg", FZ=float(sol.FZ))))
    assert min(dead, key=lambda one: np.abs(one.solution.beta - sol.beta).max()).index == 1


def test_mirror_images_are_taken_by_their_start_whatever_a_rod_is_measured_in() -> None:
    cm, mm = (
        solve(Case(Rod(E=1.07e4 / k**2, nu=0.25, a=0.25 * k, L=5.0 * k), Cylinder(R=0.75 * k),
                   Ends(0.2, 0.2, azimuth=0.0, FZ=-20.0)))
        for k in (1, 10)
    )  # fmt: skip
    np.testing.assert_allclose(mm.beta, cm.beta, atol=1e-10)
    assert mm.reactions["MZ"] == pytest.approx(10 * cm.reactions["MZ"], rel=1e-8)
    assert str(mm.selection) == str(cm.selection)


def test_the_observable_index_of_a_point_of_a_held_branch_is_that_of_the_branch() -> None:
    """Under dead loads this rod is unstable in one way."""
    branch = follow(solve(Case(SHORT, DRUM, Ends("20deg", "20deg", height=2.9))), height=2.85)
    (last,) = branch.points[-1:]
    assert last.index == int(observe(last.solution, ["index"])["index"]) == 0
