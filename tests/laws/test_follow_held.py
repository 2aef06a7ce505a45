"""A branch under held ends: the loads follow, and a fold under dead loads is none."""

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Solution, follow, solve
from solver.problem.dimensionless import reduce_held
from tests.laws.test_follow import END, table_1
from tests.laws.test_held_ends import discrete_index, displacements


def held(solution: Solution, *names: str) -> Solution:
    """The same equilibrium with these displacements held instead of their loads."""
    case, given = solution.case, solution.case.given
    loads = dict(zip(("FZ", "MZ", "M3"), (float(load) for load in solution.loads), strict=True))
    partner = {"height": "FZ", "azimuth": "MZ", "rotation": "M3"}
    own = {name: displacements(solution)[name] for name in names}
    kept = {name: load for name, load in loads.items() if name not in {partner[one] for one in names}}
    beta0 = given.beta if hasattr(given, "beta") else given.beta0
    ends = Ends(float(beta0), float(solution.beta[-1]), **kept, **own)
    return solve(Case(case.rod, case.cylinder, ends), seed=solution)


@pytest.mark.slow
def test_a_held_height_passes_the_folds_under_dead_loads_and_turns_at_its_own() -> None:
    first = held(table_1(), "height")
    dead = follow(table_1(), FZ=[4.0, 12.0])
    branch = follow(first, height=[5.0, 8.0])
    (turn,) = branch.special
    height = np.array([float(point.solution.z[-1]) for point in dead.points])
    assert turn.kind == "fold"
    assert turn.value == pytest.approx(height.max(), abs=1e-3)  # between points of the other branch
    assert turn.value >= height.max() - 1e-9
    at = turn.position
    before = [float(point.solution.FZ) for point in branch.points[:at]]
    assert np.any(np.diff(before) > 0)  # a fold under dead loads was passed
    assert np.any(np.diff(before) < 0)


@pytest.mark.parametrize(
    "name, value, partner, own",
    [
        ("height", 4.0, "FZ", -8.66),
        ("azimuth", 1.9, "MZ", 0.0),
        ("rotation", -1.5, "M3", 0.0),
        ("M10", 0.0, "beta0", 0.5),
        ("M1L", 5.0, "betaL", 0.8),
    ],
)
def test_an_end_is_held_from_the_solution_on_and_its_load_found_again(
    name: str, value: float, partner: str, own: float
) -> None:
    """There with a displacement or a moment held in place of its partner, and back with the partner given again."""
    dead = solve(Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75), Ends(0.5, 0.8, FZ=-8.66)), tol=1e-11)
    there = follow(dead, **{name: value})
    assert (there.field, there.end.reason) == (name, END)
    assert there.points[-1].solution.held == (name,)
    assert there.values[0] == pytest.approx((displacements(dead) | moments(dead))[name], abs=1e-9)
    same = solve(there.points[-1].case, seed=dead)
    assert float(same.reactions[partner]) == pytest.approx(
        float(there.points[-1].solution.reactions[partner]), rel=1e-9
    )
    back = follow(there.points[-1].solution, **{partner: own})
    assert not back.points[-1].solution.held
    np.testing.assert_allclose(back.points[-1].solution.beta, dead.beta, atol=1e-10)


def moments(solution: Solution) -> dict[str, float]:
    return {"M10": float(solution.M1[0]), "M1L": float(solution.M1[-1])}


STRAIGHT = Rod(EI=1.0, GJ=0.7, a=0.1, L=7.0), Cylinder(R=0.9)  # rho = A = 1


def test_a_straight_rod_whose_azimuth_is_held_is_followed_through_its_exact_pitchforks() -> None:
    """Whole waves, -FZ = (2 n pi/L)^2, keep the azimuth; of those of half waves tan(k L/2) = k L/2 do."""
    straight = solve(Case(*STRAIGHT, Ends(0.0, 0.0, azimuth=0.0, FZ=-0.3)))
    branch = follow(straight, FZ=[-3.0, 1.0])
    known = {(2 * np.pi / 7) ** 2: "pitchfork", (2 * 4.493409457909064 / 7) ** 2: "pitchfork"}
    assert [(-point.value, point.kind) for point in branch.special[::-1]] == [
        (pytest.approx(value, rel=1e-13), kind) for value, kind in known.items()
    ]
    assert (branch.begin.reason, branch.end.reason) == (END, END)
    for point, index in ((branch.points[0], 2), (branch.points[-1], 0)):
        assert np.abs(point.solution.beta).max() == 0
        assert point.index == index
    again = solve(Case(*STRAIGHT, Ends(0.0, 0.0, azimuth=0.0, FZ=-2.0)), seed=straight)
    assert (float(again.held_index), float(np.abs(again.beta).max())) == (2, 0)


@pytest.mark.parametrize(
    ("ends", "over", "kinds"),
    [
        (Ends(0.0, 0.0, rotation=0.0, FZ=-0.1), {"FZ": -2.0}, ["pitchfork"] * 3),
        (Ends(0.0, 0.0, azimuth=0.0, FZ=-0.1, M3=0.4), {"FZ": -2.0}, ["pitchfork", "branch point"]),
        (Ends(0.5, 0.5, height=7 * np.cos(0.5)), {"MZ": -2.0}, ["pitchfork", "branch point", "pitchfork"]),
    ],
)
def test_the_index_of_a_held_helix_changes_where_its_second_variation_does(
    ends: Ends, over: dict[str, float], kinds: list[str]
) -> None:
    """Waves that are no mirror images of each other branch off to one side: G is not symmetric about the helix."""
    helix = solve(Case(*STRAIGHT, ends))
    assert np.ptp(helix.beta) < 1e-12
    branch = follow(helix, **over)
    assert [point.kind for point in branch.special] == kinds
    names = reduce_held(helix.case).numbers
    for special in branch.special:
        for point in (branch.points[special.position - 1], branch.points[special.position + 1]):
            sol = point.solution
            mesh = discrete_index(sol.problem, sol.trajectory.orbit, names, float(helix.case.rod.stiffness_ratio), 400)
            assert point.index == mesh


def test_a_rod_carried_to_a_pitchfork_under_held_ends_names_a_branch_point() -> None:
    """Two equilibria that are images of each other split off the symmetric wire at a height of about 77.64."""
    rod, cylinder = Rod(E=2.1e5, nu=0.3, a=0.25, L=120.0), Cylinder(2.0, "inside")
    first, last = (Case(rod, cylinder, Ends(0.0, 0.0, height=height, azimuth=0.0)) for height in (110.0, 76.0))
    said = str(solve(last, seed=solve(first)).outcome)
    assert "a branch point of the problem with held ends after 9" in said
