"""A helix is an equilibrium that held ends may begin from: they bend it a little, and then more."""

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Solution, equilibria, follow, solve
from solver.branches.given_numbers import Given
from solver.branches.helices import helices_of
from solver.problem.case_fields import value_of, with_field
from solver.problem.dimensionless import reduce_held
from tests.cases import ends_in_units_of_rho, start_of

HELICES = {  # lam, mu, L, beta; phi follows from them
    "about a saddle": (0.1, -0.2, 9.0, 0.6),
    "long, about a saddle": (0.0, 0.1, 15.0, 0.5),
    "about a centre": (-0.5, 0.2, 7.0, 0.8),
}


def helix(name: str) -> Solution:
    lam, mu, L, b = HELICES[name]
    s, c = np.sin(b), np.cos(b)
    phi = (lam * c - mu * np.cos(2 * b) - 2 * c * s**3) / s  # H = 0
    (found,) = (one for one in equilibria(ends_in_units_of_rho(lam, mu, phi, L, b, b)) if one.path.helix[0])
    return found.solution


def held(sol: Solution, name: str) -> Case:
    """The same helix with its height or azimuth held."""
    given, load = sol.case.given, {"height": "FZ", "azimuth": "MZ"}[name]
    own = float(sol.z[-1] if name == "height" else sol.alpha[-1] - sol.alpha[0])
    loads = {one: float(getattr(given, one)) for one in ("FZ", "MZ", "M3") if one != load}
    return Case(sol.case.rod, sol.case.cylinder, Ends(given.beta0, given.betaL, **loads, **{name: own}))


@pytest.mark.parametrize("name", HELICES)
def test_a_helix_whose_displacement_is_held_stays_what_it_is(name: str) -> None:
    sol = helix(name)
    same = solve(held(sol, "height"), seed=sol)
    assert same.outcome == "solved"
    np.testing.assert_allclose(same.beta, sol.beta, atol=1e-12)
    assert float(same.reactions["FZ"]) == pytest.approx(float(sol.FZ), rel=1e-9)


@pytest.mark.parametrize("name", HELICES)
@pytest.mark.parametrize("field", ["height", "azimuth"])
def test_a_helix_bends_as_its_derivatives_say(name: str, field: str) -> None:
    sol = helix(name)
    case, load = held(sol, field), {"height": "FZ", "azimuth": "MZ"}[field]
    slope = float(solve(case, seed=sol).sensitivity([field], [load]).observables[load][0])
    own = value_of(case, field)
    for change in (1e-4, -1e-4):
        bent = solve(with_field(case, field, own + change), seed=sol)
        assert bent.outcome == "solved"
        assert float(bent.reactions[load] - getattr(sol, load)) == pytest.approx(slope * change, rel=0.02)
        assert 0 < np.ptp(bent.beta) < 0.05


@pytest.mark.parametrize("end", ["beta0", "betaL"])
@pytest.mark.parametrize("name", HELICES)
def test_a_branch_under_held_ends_passes_a_helix_whichever_end_turns(name: str, end: str) -> None:
    """With its height held a rod is the helix only where both end angles are that of the helix.

    Beyond it the rod is that which the helix itself bends to; beta_t at its two ends differs by up to a factor of ten.
    """
    sol = helix(name)
    case = held(sol, "height")
    own = value_of(case, end)
    before = solve(with_field(case, end, own - 0.1), seed=sol)
    beyond = solve(with_field(case, end, own + 0.1), seed=before)
    assert beyond.outcome == "solved"
    assert float(beyond.z[-1]) == pytest.approx(float(sol.z[-1]), abs=1e-9)
    np.testing.assert_allclose(beyond.beta, solve(with_field(case, end, own + 0.1), seed=sol).beta, atol=1e-9)


def test_a_branch_under_held_ends_begins_at_a_helix() -> None:
    sol = helix("about a saddle")
    own = float(sol.z[-1])
    branch = follow(sol, height=[own - 0.05, own + 0.02])
    assert {branch.begin.reason, branch.end.reason} == {"the end of the range"}
    assert branch.values[branch.start] == pytest.approx(own, abs=1e-9)
    np.testing.assert_allclose(branch.points[branch.start].solution.beta, sol.beta, atol=1e-9)
    for value in (own - 0.05, own + 0.02):
        (point,) = branch.at(value)
        assert float(point.solution.z[-1]) == pytest.approx(value, abs=1e-9)


def test_a_short_way_from_a_helix_ends_where_it_was_meant_to() -> None:
    sol = helix("about a saddle")
    branch = follow(sol, height=float(sol.z[-1]) + 1e-4)
    assert branch.end.reason == "the end of the range"
    assert branch.values[-1] == float(sol.z[-1]) + 1e-4


def test_a_straight_rod_of_held_height_says_why_it_is_no_start() -> None:
    straight = solve(ends_in_units_of_rho(0.0, 0.0, -0.05, 8.0, 0.0, 0.0), choose="lowest")
    flat = next(one.solution for one in equilibria(straight.case) if np.abs(one.solution.beta).max() == 0)
    case = held(flat, "height")
    bent = solve(with_field(case, "height", 7.9), seed=flat)
    assert bent.outcome.startswith(
        "failed: the branch of the start could not be followed to the held ends: the start is a"
    )


# both ends hinged: the numbers that are held, and how many helices have them
HINGED: dict[str, tuple[dict[str, float], int]] = {
    "height": ({"height": 3.0, "M3": 5.0, "MZ": 2.0}, 2),
    "azimuth": ({"azimuth": 3.0, "M3": 5.0, "FZ": -20.0}, 2),
    "rotation": ({"rotation": 1.0, "MZ": 3.0, "FZ": -20.0}, 4),
    "height and rotation": ({"height": 3.0, "rotation": 1.0}, 2),
    "a height and an azimuth of no helix": ({"height": 3.0, "azimuth": 3.0}, 0),
}


@pytest.mark.parametrize("name", HINGED)
def test_the_helices_between_two_hinges_have_the_displacements_that_are_held(name: str) -> None:
    """Each is solved again from its start, as a rod under its own loads."""
    held_, count = HINGED[name]
    rod, drum = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(0.75)  # rho = 1
    given = Given.of(reduce_held(Case(rod, drum, Ends(M10=0.0, M1L=0.0, **held_))))
    states, any_load = helices_of(given)
    assert len(states) == count
    assert not any_load
    for state in states:
        p = state.problem
        beta, lam, mu, phi = (float(value[0]) for value in (p.beta0, p.lam, p.mu, p.phi))
        alone = solve(Case(rod, drum, start_of(rod, 1.0, lam, mu, phi, beta, 0.0)), tol=1e-12)
        np.testing.assert_allclose(alone.beta, beta, atol=1e-10)
        found = {
            "height": alone.z[-1], "azimuth": alone.alpha[-1], "rotation": alone.gamma[-1] - alone.gamma[0],
            "FZ": alone.FZ, "MZ": alone.MZ, "M3": alone.loads[2],
        }  # fmt: skip
        assert {key: float(found[key]) for key in held_} == pytest.approx(held_, abs=1e-8)


def test_a_helix_whose_height_and_azimuth_are_held_bears_any_load() -> None:
    case = Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(0.75), Ends(M10=0.0, M1L=0.0, height=3.0, azimuth=4.0))
    assert helices_of(Given.of(reduce_held(case))) == ([], True)


@pytest.mark.parametrize("ends", [{"M10": 1.0, "M1L": 0.0}, {"beta0": 0.3, "betaL": 0.4}, {"beta0": 0.3, "betaL": 0.3}])
def test_with_a_moment_or_other_angles_no_helix_has_the_height(ends: dict[str, float]) -> None:
    case = Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(0.75), Ends(**ends, height=3.0))
    assert helices_of(Given.of(reduce_held(case))) == ([], False)
