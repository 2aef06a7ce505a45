"""A rod wound on a cylinder as a uniform helix: its loads follow from tension, lay and twist."""

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, solve
from solver.mechanics.potential import Loads, slope
from solver.shooting.state import HELICAL, states

ROPE = Rod(E=2e5, nu=0.3, a=1.0, L=1500.0)  # N and mm


@pytest.mark.parametrize("twist", [None, 0.0, -2e-3])
@pytest.mark.parametrize("side", ["outside", "inside"])
@pytest.mark.parametrize("lay", ["80deg", -1.2, 0.3])
def test_the_loads_of_a_wound_rod_make_it_a_helix_under_its_tension(lay: float, side: str, twist: float | None) -> None:
    """H(beta) = 0, F3 = T and M3/C = twist; the tension is far above A/rho^2, so that the helix is stable."""
    T, cylinder = 1e4, Cylinder(60.0, side)
    ends = Ends.helix(ROPE, cylinder, T, lay, twist)
    sol = solve(Case(ROPE, cylinder, ends))
    assert np.ptp(sol.beta) < 1e-12
    assert sol.beta[0] == ends.beta0 == ends.betaL
    assert pytest.approx(np.full(201, T), rel=1e-12) == sol.F3
    assert np.abs(slope(Loads.columns(sol.problem), sol.beta)).max() < 1e-12 * T  # terms of the size T rho^2/A = 229
    assert pytest.approx(np.full(201, sol.F2[0]), abs=1e-9) == sol.F2
    twisted = sol.M3 / ROPE.torsional_stiffness
    if twist is None:
        assert sol.F2[0] == pytest.approx(0, abs=1e-9 * T)
        assert pytest.approx(T * np.cos(ends.beta0), rel=1e-12) == ends.FZ
        assert twisted == pytest.approx(1.3 * np.sin(ends.beta0) * np.cos(ends.beta0) / sol.case.rho, rel=1e-12)
    else:
        assert twisted == pytest.approx(twist, rel=1e-12)
    thin = T * np.sin(ends.beta0) ** 2 / sol.case.rho  # the push of a string
    assert abs(sol.contact[0]) == pytest.approx(thin, rel=0.01)


def test_a_wound_rod_may_be_a_family() -> None:
    ends = Ends.helix(ROPE, Cylinder([60.0, 80.0]), 500.0, "80deg")
    assert ends.MZ.shape == (2,)


def test_a_rod_that_ends_wound_is_helical_to_its_ends() -> None:
    sol = solve(Case(ROPE, Cylinder(60.0), Ends.helix(ROPE, Cylinder(60.0), 500.0, "80deg")))
    (state,) = states(sol.s, sol.beta, sol.alpha)
    assert (state.word, state.begin, state.end) == (HELICAL, 0.0, 1500.0)
