"""Orbits that turn before two saddles of one height: the period is as exact as its estimated error says."""

import mpmath as mp
import numpy as np
import pytest

from solver.orbits.periodic_orbit import judge, solve_orbit
from solver.problem.reduced import StartProblem

# lam and the lower turning point; two saddles are mirror images about pi/2, half way between the turning points
NEAR = [
    (-1.810420086734628, -1.3110603581891989),  # 3.5e-3 from a saddle
    (-1.8220457984642213, -1.318793465909134),  # 4.0e-3
    (-1.5315804878504558, -1.1543458453227584),  # 9.0e-4
]


def exact_period(lam: float, lowest: float) -> float:
    """By quadrature in 30 digits over the root of the distance from the turning point; G = (2 lam - sin^3) sin."""
    with mp.workdps(30):
        load, first = mp.mpf(lam), mp.mpf(lowest)
        s1 = mp.sin(first)

        def pace(root: mp.mpf) -> mp.mpf:
            x = root * root
            s = mp.sin(first + x)
            rise = 2 * mp.sin(x / 2) * mp.cos(first + x / 2)  # s - s1
            return 2 * root / mp.sqrt(rise * ((s + s1) * (s * s + s1 * s1) - 2 * load))

        far = mp.sqrt(mp.pi / 2 - first)
        marks = [far * mp.mpf(10) ** (-mp.mpf(k) / 2) for k in range(8, -1, -1)]
        return float(4 * mp.quad(pace, [0, *marks]))


@pytest.mark.parametrize(("lam", "lowest"), NEAR)
def test_the_period_before_two_saddles_of_one_height_is_as_exact_as_told(lam: float, lowest: float) -> None:
    none, exact = np.zeros(1), exact_period(lam, lowest)
    problem = StartProblem(np.array([lam]), none, none, np.array([exact]), np.array([lowest]), none)
    orbit = solve_orbit(problem, 1e-13)
    told = judge(orbit)[1][0]
    assert told < 1e-9
    assert abs(float(orbit.period[0]) - exact) < told
