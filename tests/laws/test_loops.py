"""Closed rods: they close, they begin at the ring, they are what a minimisation finds, and they unbind where pulled."""

from math import gcd, pi

import numpy as np
import pytest
import scipy

from solver import Cylinder, Loop, Rod, loops, solve


def closed(L: float, wraps: int, folds: int, side: str = "outside", a: float = 0.01) -> list[Loop]:
    """The loops of a rod with A = 1 and rho = 1."""
    R = 1 - a if side == "outside" else 1 + a
    return loops(Rod(EI=1.0, GJ=0.8, a=a, L=L), Cylinder(R=R, side=side), wraps, folds)


def about(found: list[Loop], sign: float) -> Loop:
    (one,) = [loop for loop in found if loop.about * sign > 0]
    return one


@pytest.mark.parametrize(("wraps", "folds"), [(1, 1), (1, 2), (1, 3), (2, 1), (3, 2)])
def test_the_wave_on_the_ring_begins_at_the_load_of_its_folds(wraps: int, folds: int) -> None:
    excess = 1e-7
    one = about(closed(2 * pi * wraps * (1 + excess), wraps, folds), 1)
    assert one.lam == pytest.approx(2 - (folds / wraps) ** 2, abs=20 * excess)  # its slope with the length is below 20
    assert one.energy == pytest.approx(pi * wraps, rel=20 * excess)
    amplitude = pi / 2 - one.solution.beta[0]
    assert amplitude**2 / 4 == pytest.approx(excess, rel=1e-3)  # the mean of sin(beta) is 2 pi wraps/L


@pytest.mark.parametrize(("L", "wraps", "folds"), [(8.0, 1, 1), (15.0, 1, 2), (30.0, 3, 2)])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_loop_closes_in_position_direction_and_rotation(L: float, wraps: int, folds: int, sign: int) -> None:
    one = about(closed(L, wraps, folds), sign)
    sol = one.solution
    assert one.closure < 1e-10
    assert abs(sol.FZ) < 1e-15
    assert sol.M3 == 0
    assert np.abs(sol.position[-1] - sol.position[0]).max() < 1e-10
    assert np.abs(sol.material_frame[-1] - sol.material_frame[0]).max() < 1e-9  # no turn of the section
    assert sol.alpha[-1] == pytest.approx(2 * pi * wraps, abs=1e-10)
    marched = solve(sol.case, method="dop853", tol=1e-11, stations=3)  # knows no orbit
    assert np.abs(marched.position[-1] - marched.position[0]).max() < 1e-7 * sol.condition


def discrete_energy(beta: np.ndarray, L: float) -> float:
    """Bending energy of a closed curve from beta on equal steps, the derivative by Fourier series."""
    wave = np.fft.rfftfreq(beta.size, L / beta.size) * 2 * pi
    rate = np.fft.irfft(1j * wave * np.fft.rfft(beta), beta.size)
    return L / beta.size * float(np.sum(rate**2 + np.sin(beta) ** 4)) / 2


def minimised(beta: np.ndarray, L: float, wraps: int, descents: int = 1000) -> np.ndarray:
    """The closed curve of least bending energy near a guess: no equation of equilibrium, only closing conditions.

    Each descent lowers a convex model of the energy, |(sin^4/2)''| <= 2, and meets the linearised conditions; Newton's
    method makes the last digits.
    """
    n, h = beta.size, L / beta.size
    wave = np.fft.fftfreq(n, h) * 2 * pi
    stiff = np.real(np.fft.ifft(np.fft.fft(np.eye(n), axis=0) * (wave**2)[:, None], axis=0))
    system, pull = np.zeros((n + 2, n + 2)), np.zeros(2)
    for k in range(descents + 10):
        s, c = np.sin(beta), np.cos(beta)
        last = k >= descents
        bend = 6 * s**2 * c**2 - 2 * s**4 - pull @ np.stack([s, c]) if last else np.full(n, 2.0)
        system[:n, :n] = stiff + np.diag(bend)
        system[n:, :n], system[:n, n:] = np.stack([c, -s]), np.stack([c, -s]).T
        missed = np.array([s.sum() - 2 * pi * wraps / h, c.sum()])
        right = -np.concatenate([stiff @ beta + 2 * s**3 * c, missed])
        # the shift of the start is free: the matrix is singular in the end
        found = np.linalg.lstsq(system, right, rcond=1e-9)[0] if last else np.linalg.solve(system, right)
        beta, pull = beta + found[:n], found[n:]
    assert np.abs(found[:n]).max() < 1e-7
    return beta


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("L", "wraps", "n"), [(8.0, 1, 32), pytest.param(15.0, 1, 48, marks=SLOW), pytest.param(16.0, 2, 48, marks=SLOW)]
)
def test_the_loop_of_one_fold_is_the_closed_curve_of_least_bending_energy(L: float, wraps: int, n: int) -> None:
    t = 2 * pi * np.arange(n) / n
    guess = pi / 2 + 0.9 * np.cos(t) + 0.1 * np.sin(3 * t)
    found = minimised(guess, L, wraps)
    one = about(closed(L, wraps, 1), 1)
    assert one.index == 0
    assert discrete_energy(found, L) == pytest.approx(one.energy, rel=1e-6)  # n points of a Fourier series
    assert np.sin(found).min() == pytest.approx(np.sin(one.solution.beta).min(), abs=0.03)  # at the points alone


def second_variation(one: Loop, n: int) -> np.ndarray:
    """Eigenvalues of the second variation of a closed rod among the changes that keep it closed."""
    L, lam = one.solution.problem.span[0], one.lam
    beta = solve(one.solution.case, stations=n + 1).beta[:-1]
    wave = np.fft.fftfreq(n, L / n) * 2 * pi
    S = np.real(np.fft.ifft(np.fft.fft(np.eye(n), axis=0) * (wave**2)[:, None], axis=0))
    s, c = np.sin(beta), np.cos(beta)
    S = S - np.diag(-lam * s - 2 * s**2 * (3 * c**2 - s**2))
    kept = scipy.linalg.null_space(np.stack([s, c]))
    return np.linalg.eigvalsh(kept.T @ S @ kept)


@pytest.mark.parametrize(
    ("L", "wraps", "folds", "sign", "index"),
    [
        (8.0, 1, 1, 1, 0),
        (8.2, 1, 2, 1, 2),
        (12.6, 1, 2, -1, 3),
        (25.0, 1, 3, -1, 4),
        (20.0, 2, 1, 1, 0),
        (12.6, 1, 1, -1, 0),
    ],
)
def test_the_index_is_that_of_the_discrete_second_variation(
    L: float, wraps: int, folds: int, sign: int, index: int
) -> None:
    one = about(closed(L, wraps, folds), sign)
    values = second_variation(one, 200)
    assert one.index == index == int((values < -1e-6).sum())  # next to these only the shift of the start, at 0
    assert np.abs(values).min() < 1e-6


@pytest.mark.slow  # its sister is the index of two folds, above
def test_a_loop_of_two_folds_unfolds_into_one() -> None:
    """It is unstable at any length: a change of twice its period lowers the energy, down to the loop of one fold."""
    L, n = 16.0, 64
    two, one = (about(closed(L, 1, folds), 1) for folds in (2, 1))
    beta = solve(two.solution.case, stations=n + 1).beta[:-1]
    assert discrete_energy(beta, L) == pytest.approx(two.energy, rel=1e-4)
    found = minimised(beta + 0.02 * np.cos(2 * pi * np.arange(n) / n + 0.7), L, 1)
    assert discrete_energy(found, L) == pytest.approx(one.energy, rel=1e-5)


def test_the_push_inside_is_the_pull_outside() -> None:
    outside, inside = (about(closed(9.0, 1, 2, side), 1) for side in ("outside", "inside"))
    np.testing.assert_allclose(outside.solution.beta, inside.solution.beta, atol=1e-12)
    assert outside.push_max == pytest.approx(-inside.push_min, rel=1e-9)
    assert outside.push_min < 0 < inside.push_max
    assert outside.attached + inside.attached == pytest.approx(1, abs=1e-9)


def test_loops_that_turn_back_or_wrap_twice_intersect_themselves_and_a_wave_does_not() -> None:
    assert about(closed(12.0, 1, 1), 1).overlaps is False
    assert about(closed(12.0, 1, 1), -1).overlaps is True
    assert about(closed(20.0, 2, 1), 1).overlaps is True
    assert gcd(2, 2) == 2
    covered = about(closed(24.0, 2, 2), 1)  # the loop of one wrap and one fold, twice
    assert covered.overlaps is True
    assert covered.lam == pytest.approx(about(closed(12.0, 1, 1), 1).lam, abs=1e-12)


def test_loops_of_many_lengths_have_one_wave_and_the_wave_exists_above_the_ring() -> None:
    for factor in (1.001, 1.05, 1.5, 3.0, 10.0, 100.0):
        found = closed(2 * pi * factor, 1, 2)
        assert sum(one.about > 0 for one in found) == 1
        assert found == sorted(found, key=lambda one: one.energy)
        assert found.complete == (len(found) == 2)  # near the ring the other one is sharper than numbers hold


@pytest.mark.parametrize("factor", [1.262704072694293, 1.26, 1.5])
def test_a_loop_that_rounding_spoils_is_told(factor: float) -> None:
    """Of five wraps or more each leg is so near to a helix that the last bit of the loads shows."""
    for wraps in (5, 8):
        L = 2 * pi * wraps * factor
        found = loops(Rod(E=1e4, nu=0.25, a=0.02, L=L), Cylinder(R=0.98), wraps, 1)
        spoiled = [one for one in found if one.closure > 1e-9 * L]
        assert len(found) - len(spoiled) + len(found.remarks) == 2
        assert found.complete == (len(found) == 2 and not spoiled)
        assert all("closes only to" in one or "was not found" in one for one in found.remarks)
