"""The algebra of G: every helix and every turning point, against the eigenvalues of companion matrices."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.orbits.boundary import critical_points
from solver.orbits.potential import dimensional_slope, potential, slope, slope_rate
from solver.problem.dimensionless import Reduced, StartProblem

loads = st.floats(-3, 3).map(lambda x: round(x, 6))


def problem(lam: float, mu: float, phi: float) -> StartProblem:
    one = np.ones(1)
    return StartProblem(lam * one, mu * one, phi * one, one, 0 * one, dbeta0=0 * one)


def fourier(lam: float, mu: float, phi: float) -> np.ndarray:
    """H as a polynomial in w = exp(i beta), times w^4: coefficients of rising powers, (9,), by FFT of its samples."""
    angles = 2 * np.pi * np.arange(16) / 16
    s, c = np.sin(angles), np.cos(angles)
    H = lam * c - mu * np.cos(2 * angles) - (phi + 2 * c * s * s) * s  # eq. (35), written anew
    coefficients = np.fft.fft(H) / 16
    return np.array([coefficients[k] for k in range(-4, 5)])


def helices(lam: float, mu: float, phi: float) -> np.ndarray:
    """Angles at which H = 0, rising in [-pi, pi)."""
    roots = np.roots(fourier(lam, mu, phi)[::-1])
    on_circle = roots[np.abs(np.abs(roots) - 1) < 1e-7]
    return np.sort(np.angle(on_circle))


@settings(max_examples=150)
@given(lam=loads, mu=loads, phi=loads)
def test_no_helix_is_missed(lam: float, mu: float, phi: float) -> None:
    found = critical_points(problem(lam, mu, phi))
    angles = found.beta[0, : found.count[0]]
    expected = helices(lam, mu, phi)
    flat = np.abs(slope_rate(problem(lam, mu, phi), np.append(expected, angles))).min(initial=1.0)
    if flat < 1e-4:
        return  # two helices merge: whether they are two or none hangs on a last digit
    assert angles.size == expected.size
    for angle in angles:
        gap = np.abs(np.exp(1j * angle) - np.exp(1j * expected)).min()
        assert gap < 1e-9  # what the eigenvalues leave of a root next to another


@settings(max_examples=60)
@given(lam=loads, mu=loads, phi=loads)
def test_hills_and_valleys_alternate_and_valleys_are_centres(lam: float, mu: float, phi: float) -> None:
    one = problem(lam, mu, phi)
    found = critical_points(one)
    n = int(found.count[0])
    centre = found.centre[0, :n]
    assert n >= 2
    assert n % 2 == 0
    assert (centre != np.roll(centre, 1)).all()
    level = potential(one, found.beta[0, :n])
    neighbours = np.minimum(np.roll(level, 1), np.roll(level, -1))
    assert (level[centre] <= neighbours[centre] + 1e-12).all()


@settings(max_examples=60)
@given(lam=loads, mu=loads, phi=loads, beta=st.floats(-10, 10))
def test_the_slope_is_half_the_derivative_of_the_potential(lam: float, mu: float, phi: float, beta: float) -> None:
    one, step = problem(lam, mu, phi), 1e-3
    around = beta + step * np.array([-2, -1, 1, 2])
    rule = np.array([1, -8, 8, -1]) / (12 * step)  # error step^4
    assert abs(potential(one, around) @ rule / 2 - slope(one, beta)[0]) < 1e-9 * 30
    assert abs(slope(one, around) @ rule - slope_rate(one, beta)[0]) < 1e-9 * 60


FORMS = np.array([(0.3, -0.7, 0.9), (1e3, 1e3, -2e3), (-0.4, -0.4, 0.0), (0.0, 0.0, 0.0)])  # lam, mu, phi
ANGLES = np.array([-3.1, -1.2, -1e-3, 0.0, 1e-6, 0.7, np.pi / 2, 2.9, np.pi])


def reference(lam: float, mu: float, phi: float) -> np.ndarray:
    one = np.ones(ANGLES.size)
    return slope(Reduced(lam * one, mu * one, phi * one, one, ANGLES), ANGLES)


@pytest.mark.parametrize("numbers", FORMS)
def test_the_form_in_units_of_the_case_is_the_dimensionless_one(numbers: np.ndarray) -> None:
    (lam, mu, phi), rho = numbers, 0.37
    H = dimensional_slope(lam / rho, mu / rho, phi / rho**2, rho, ANGLES) * rho**2
    np.testing.assert_allclose(H, reference(*numbers), rtol=0, atol=1e-14 * (1 + np.abs(numbers).sum()))
