"""Limits and criteria that others have derived: Lubinski's, Mitchell's, a string's, a separatrix's."""

import numpy as np
import pytest

from solver import solve
from tests.cases import EXACT, LUBINSKI, MITCHELL, MU_C, by_the_touching_separatrix, helix_moment, in_units_of_rho


@pytest.mark.parametrize("degrees", LUBINSKI)
def test_a_buckled_pipe_takes_the_force_of_lubinski_and_pushes_as_mitchell_says(degrees: int) -> None:
    """F = 8 pi^2 EI/p^2 with the helix's pitch p, and contact F^2 r/4EI, as the angle becomes small."""
    case = EXACT[f"buckled pipe {degrees} deg"].case
    sol = solve(case, tol=1e-10, stations=11)
    A, r = case.rod.bending_stiffness, case.rho
    compression = -sol.FZ
    pitch = 2 * np.pi * (sol.z[-1] - sol.z[0]) / (sol.alpha[-1] - sol.alpha[0])
    push = np.mean(sol.push)
    assert compression / (8 * np.pi**2 * A / pitch**2) == pytest.approx(LUBINSKI[degrees], abs=6e-6)  # its figures
    assert push == pytest.approx(A / r**3 * np.sin(np.deg2rad(degrees)) ** 4, rel=1e-9)
    assert push / (compression**2 * r / (4 * A)) == pytest.approx(MITCHELL[degrees], abs=6e-6)


def test_a_taut_helix_pushes_as_a_string_does() -> None:
    """Stiffness small against tension: f = F3 sin^2(beta)/rho, the capstan's law."""
    beta, phi = 1.0, 1e6
    # the tension that a string needs is along the tangent: FY = FZ tan(beta)
    case = in_units_of_rho(helix_moment(beta, 0.0, phi), 0.0, phi, 5.0, beta, 0.0)
    sol = solve(case, tol=1e-6, stations=[0.0, 1e-3])
    assert sol.F3[0] == pytest.approx(phi / np.cos(beta), rel=1e-5)  # stiffness adds 1/phi
    assert sol.contact[0] == pytest.approx(sol.F3[0] * np.sin(beta) ** 2, rel=1e-5)


@pytest.mark.parametrize("excess", (1e-3, 1e-6, 1e-9))
def test_below_the_critical_twist_the_rod_goes_round_and_above_it_turns_back(excess: float) -> None:
    above = solve(by_the_touching_separatrix(1 + excess), tol=1e-8)
    below = solve(by_the_touching_separatrix(1 - excess), tol=1e-8)
    assert above.beta.max() < np.deg2rad(135)
    assert below.beta.max() > np.deg2rad(135)
    # the bottleneck's width: (G - eta) is quadratic in beta - 135 deg and linear in mu
    assert np.deg2rad(135) - above.beta.max() == pytest.approx(turning_gap(excess), rel=0.2)


def turning_gap(excess: float) -> float:
    """How far before 135 degrees mu = (1 + excess) MU_C turns, to leading order."""
    b, step = 3 * np.pi / 4, 1e-4
    at = lambda x: 0.25 / np.sin(x) + (1 + np.cos(x)) * np.sin(x) / 2  # noqa: E731
    bend = (at(b + step) - 2 * at(b) + at(b - step)) / step**2
    return float(np.sqrt(2 * excess * MU_C / bend))
