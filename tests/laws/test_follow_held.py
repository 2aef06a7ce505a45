"""A branch under held ends: the loads follow, and a fold under dead loads is none."""

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Solution, follow, solve
from tests.laws.test_follow import END, table_1
from tests.laws.test_held_ends import displacements


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
