"""Saddles of one height, as mirror images are: the period beside them is as exact as its estimated error says."""

import mpmath as mp
import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, equilibria
from solver.orbits.boundary import boundary_of
from solver.orbits.periodic_orbit import judge, solve_orbit
from solver.problem.dimensionless import EndsProblem, StartProblem

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


# which load is not zero, and the angle whose image under the symmetry of G beta is, less a sign times beta
SYMMETRIES = {"phi": (0.0, -1), "lam": (np.pi, -1), "mu": (np.pi, 1)}


@pytest.mark.parametrize("load", SYMMETRIES)
def test_images_of_a_saddle_under_the_symmetry_of_the_loads_are_as_high_to_the_last_bit(load: str) -> None:
    shift, sign = SYMMETRIES[load]
    pairs = 0
    for value in np.random.default_rng(3).uniform(-0.76, 0.76, 100):
        numbers = {name: np.array([value if name == load else 0.0]) for name in ("lam", "mu", "phi")}
        place = boundary_of(EndsProblem(**numbers, span=np.ones(1), beta0=np.zeros(1), betaL=np.zeros(1)))
        for saddle in place.saddles:
            images = [other for other in place.saddles if abs(np.sin((shift + sign * saddle - other) / 2)) < 1e-7]
            assert len(images) == 1
            assert place.fall(float(saddle), float(images[0])) == 0
            pairs += saddle != images[0]
    assert pairs > 50


@pytest.mark.parametrize(("FZ", "y"), [(-150.0, -23.70421749451955), (-145.0, -24.92734185499459)])
def test_a_rod_that_rests_beside_two_saddles_of_one_height_has_the_level_of_quadrature_in_50_digits(FZ, y) -> None:
    """It was 1e-5 off, with an estimated error of 1e-14, where rounding set one saddle above its mirror image."""
    wire, tube = Rod(E=2.1e5, nu=0.3, a=0.25, L=120.0), Cylinder(2.0, side="inside")
    found = equilibria(Case(wire, tube, Ends(0.0, 0.0, FZ=FZ)))
    levels = [float(one.path.y[0]) for one in found if one.path.turns[0] == 2 and -1 < one.path.pin[0] < 1]
    near = [level for level in levels if abs(level - y) < 0.1]
    assert len(near) == 2  # mirror images
    np.testing.assert_allclose(near, y, rtol=1e-14)
