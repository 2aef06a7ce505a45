"""A rod wound on a cylinder as a uniform helix: its loads follow from tension, lay and twist."""

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, solve
from solver.nodes.pipe_states import HELICAL, states
from solver.orbits.potential import Loads, slope

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


@pytest.mark.parametrize("sliding", ["forward", "backward"])
@pytest.mark.parametrize(
    ("lay", "twist", "tension"),
    [("80deg", None, 500.0), ("90deg", None, 500.0), (-1.1, 0.0, 800.0), (0.5, 2e-3, 200.0)],
)
def test_the_tension_of_a_wound_cable_that_slides_along_itself_grows_by_the_capstan_equation(
    lay: float | str, twist: float | None, tension: float, sliding: str
) -> None:
    """Friction along a helix leaves it one: T - T* grows by exp(f theta sin(beta)), with T* = F2 cot(beta) by bending.

    The wall presses with (T sin - F2 cos) sin/rho, which is the radial balance of a constant force across the helix.
    """
    drum = Cylinder(60.0, friction=0.2, sliding=sliding)
    ends = Ends.helix(ROPE, drum, tension, lay, twist)
    sol = solve(Case(ROPE, drum, ends))
    A, rho, b = ROPE.bending_stiffness, sol.case.rho, ends.beta0
    F2 = (ends.M3 - A * np.sin(b) * np.cos(b) / rho) * np.sin(b) ** 2 / rho
    level = F2 / np.tan(b)
    turned = np.sin(b) ** 2 * ROPE.L / rho  # theta sin(beta)
    at_start = level + (tension - level) * np.exp((-0.2 if sliding == "forward" else 0.2) * turned)
    assert sol.outcome == "solved"
    assert np.ptp(sol.beta) < 1e-12
    assert sol.F3[[0, -1]] == pytest.approx([at_start, tension], rel=1e-9)
    assert sol.push == pytest.approx((sol.F3 * np.sin(b) - F2 * np.cos(b)) * np.sin(b) / rho, rel=1e-9)


def test_a_wound_cable_is_pushed_and_pulled_along_itself_and_not_along_the_axis() -> None:
    """Friction takes a push on a cable that lies nearly round the drum, whatever its small axial force is."""
    drum = Cylinder(60.0, friction=0.2)
    ends = Ends.helix(ROPE, drum, 500.0, "80deg", 0.0)
    sol = solve(Case(ROPE, drum, ends))
    axial = sol.F2 * np.sin(sol.beta) + sol.F3 * np.cos(sol.beta)
    assert axial[0] < 0 < axial[-1]
    assert (sol.F3 > 0).all()
    assert sol.outcome == "solved"
