"""A helix is an equilibrium that held ends may begin from: they bend it a little, and then more."""

import numpy as np
import pytest

from solver import Case, Ends, Solution, equilibria, follow, solve
from solver.problem.case_fields import value_of, with_field
from tests.cases import ends_in_units_of_rho

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
