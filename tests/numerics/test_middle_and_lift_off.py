"""Pitch, push in the middle, place of lift-off, largest force, moment and stress: on helices and by other means."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import leggauss
from scipy.optimize import brentq

from solver import Case, Cylinder, Rod, Start, solve
from solver.methods import available
from solver.observe.observables import observe
from tests.cases import EXACT, in_units_of_rho
from tests.slow import slow

METHODS = [name for name in ("orbit", "swing", "dop853") if name in available()]
NEW = ("pitch", "push_middle", "lift_off_at", "F3_size_max", "bending_moment_max", "bending_stress_max")
by_each = pytest.mark.parametrize("method", METHODS)


def seen(case: Case, method: str = "orbit", stations: int = 2001) -> dict:
    return observe(solve(case, tol=1e-9, method=method, stations=stations), NEW, errors=True)


@by_each
@pytest.mark.parametrize("degrees", [10, 70])
def test_a_buckled_helix_has_the_pitch_push_force_moment_and_stress_of_its_formulas(degrees: int, method: str) -> None:
    """-FZ rho^2/A = 2 sin^2 cos and push rho^3/A = sin^4, with A = rho = 1; F3 = FZ cos + FY sin, FY = -sin^3."""
    case = EXACT[f"buckled pipe {degrees} deg"].case
    s, c = np.sin(np.deg2rad(degrees)), np.cos(np.deg2rad(degrees))
    got = seen(case, method)
    E, a = float(case.rod.E), float(case.rod.a)
    exact = {
        "pitch": 2 * np.pi * c / s, "push_middle": s**4, "lift_off_at": float(case.rod.L),
        "F3_size_max": 2 * s**2 * c**2 + s**4, "bending_moment_max": s**2, "bending_stress_max": E * a * s**2,
    }  # fmt: skip
    for name, value in exact.items():
        assert got[name] == pytest.approx(value, rel=1e-8), name  # the tolerance of dop853
        assert abs(got[name] - value) <= got[f"{name}_error"] + 1e-12 * value, name


def test_a_rod_that_turns_less_than_once_has_the_pitch_that_it_would_have() -> None:
    case = EXACT["buckled pipe 10 deg"].case
    short = Case(Rod(case.rod.E, case.rod.nu, case.rod.a, 0.5), case.cylinder, case.given)
    assert observe(solve(short), ["turns_around"])["turns_around"] < 0.05
    assert seen(short)["pitch"] == pytest.approx(2 * np.pi / np.tan(np.deg2rad(10)), rel=1e-9)


def test_the_pitch_is_negative_where_the_rod_runs_down_and_has_the_sign_of_neither_hand() -> None:
    up, left, down = (seen(in_units_of_rho(0, 0, 0, 2.0, beta, 0.0))["pitch"] for beta in (0.5, -0.5, np.pi - 0.5))
    assert up == pytest.approx(left) == pytest.approx(-down)
    assert up > 0


@by_each
def test_a_rod_that_does_not_turn_about_the_axis_has_no_pitch(method: str) -> None:
    straight = seen(in_units_of_rho(0, 0, 0.5, 20.0, 0.0, 0.0), method)
    assert np.isnan(straight["pitch"])
    assert np.isnan(straight["pitch_error"])
    assert straight["push_middle"] == 0
    assert straight["lift_off_at"] == 20


def middle(case: Case) -> tuple[float, float]:
    """Pitch and mean push of the middle third, from the arrays of a solution at Gauss points of 4000 cells.

    In a cell where push changes its sign the cubic through its four points is integrated between its roots.
    """
    L = float(case.rod.L)
    x, w = leggauss(4)
    edges = np.linspace(L / 3, 2 * L / 3, 4001)
    half = np.diff(edges) / 2
    s = (edges[:-1, None] + half[:, None] * (1 + x)).ravel()
    sol = solve(case, tol=1e-11, stations=np.concatenate([[L / 3], s, [2 * L / 3]]))
    push = sol.push[1:-1].reshape(4000, 4)
    areas = half * (np.maximum(push, 0) @ w)
    for k in np.flatnonzero(np.abs(push).min(axis=1) <= np.ptp(push, axis=1)):
        cubic = Polynomial(np.linalg.solve(np.vander(x, increasing=True), push[k]))
        real = [root.real for root in cubic.roots() if abs(root.imag) < 1e-12 and abs(root) < 1]
        places = [-1.0, *sorted(real), 1.0]
        areas[k] = half[k] * sum(max(cubic.integ()(q) - cubic.integ()(p), 0) for p, q in pairwise(places))
    turned, risen = (v[-1] - v[0] for v in (sol.alpha, sol.z))
    return 2 * np.pi * risen / abs(turned), float(areas.sum() / (L / 3))


def first_pull(case: Case) -> float:
    """The first zero of push where it falls, among 40,001 stations, refined by root finding."""
    L = float(case.rod.L)
    fine = solve(case, tol=1e-11, stations=40001)
    falls = np.flatnonzero((fine.push[1:] < 0) & (fine.push[:-1] >= 0))
    if fine.push[0] < 0:
        return 0.0
    if not falls.size:
        return L
    at = lambda s: float(solve(case, tol=1e-11, stations=[0.0, s]).push[1])  # noqa: E731
    return float(brentq(at, fine.s[falls[0]], fine.s[falls[0] + 1], xtol=1e-13))


def random_cases(count: int, seed: int) -> list[Case]:
    """Rods inside and outside of a part of a bend to a few dozen, loads of several sizes."""
    rng = np.random.default_rng(seed)
    cases = []
    for k in range(count):
        lam, mu, phi = rng.normal(size=3) * 10.0 ** rng.uniform(-1, 0.7)
        swift = np.sqrt(abs(lam) + abs(mu) + abs(phi) + 1)
        span, beta, rate = rng.uniform(0.3, 25) / swift, rng.uniform(-3, 3), rng.normal() * swift
        one = in_units_of_rho(lam, mu, phi, span, beta, rate)
        a = float(one.rod.a)
        cases.append(one if k % 2 else Case(one.rod, Cylinder(1 + a, "inside"), one.given))
    return cases


@by_each
@pytest.mark.parametrize(("count", "seed", "inside"), [(8, 5, 3), slow(200, 6, 51)])
def test_random_rods_have_the_values_that_arrays_along_the_rod_give(count, seed, inside, method: str) -> None:
    places = []  # of lift-off, as shares of the length
    for case in random_cases(count, seed):
        got = seen(case, method, 4001)
        sol = solve(case, tol=1e-9, stations=8001)
        pitch, push = middle(case)
        size = float(np.abs(sol.push).max())
        exact = {"pitch": (pitch, abs(pitch)), "push_middle": (push, size), "lift_off_at": (first_pull(case), 1.0)}
        for name, (value, unit) in exact.items():
            assert abs(got[name] - value) <= got[f"{name}_error"] + 1e-8 * unit, (name, method, got[name], value)
            if name != "lift_off_at":
                assert abs(got[name] - value) <= 1e-6 * unit * max(1, float(sol.condition)), (name, got[name], value)
        assert got["F3_size_max"] == pytest.approx(np.abs(sol.F3).max(), rel=1e-4)  # the spacing of stations squared
        assert got["F3_size_max"] >= np.abs(sol.F3).max() * (1 - 1e-7)
        assert got["bending_moment_max"] == pytest.approx(np.hypot(sol.M1, sol.M2).max(), rel=1e-3)
        places.append(float(got["lift_off_at"] / case.rod.L))
    assert {0.0, 1.0} <= set(places) or count < 200
    assert sum(0 < place < 1 for place in places) >= inside


def test_a_rod_of_ten_thousand_bends_lifts_off_where_its_first_bend_does() -> None:
    for beta, rate, side in ((1.5, 0.6, "outside"), (1.5, -0.6, "outside"), (0.5, 0.6, "inside")):
        one, long = (in_units_of_rho(0.3, 0.2, 0.1, span, beta, rate, side) for span in (12.0, 1e5))
        short, far = seen(one), seen(long)
        assert 0 < short["lift_off_at"] < 12
        assert far["lift_off_at"] == pytest.approx(short["lift_off_at"], rel=1e-9)
        assert short["lift_off_at"] == pytest.approx(first_pull(one), abs=1e-8)
        assert far["push_middle"] == pytest.approx(observe(solve(long), ["push_mean"])["push_mean"], rel=1e-3)


@pytest.mark.parametrize("method", [name for name in METHODS if name != "dop853"])
@pytest.mark.parametrize("length", [30.0, 2e3, 1e6])
def test_a_rod_bent_once_in_its_middle_lifts_off_there(length: float, method: str) -> None:
    """No load and h = 0: push = sin^4 (12 cos^2 - 2) inside, which falls through 0 where cot(beta) = 1/sqrt(5)."""
    b, a = np.arctan(2 / length), 0.01
    s, c = np.sin(b), np.cos(b)
    rod = Rod(E=1 / (np.pi / 4 * a**4), nu=0.25, a=a, L=2 / np.tan(b))
    case = Case(rod, Cylinder(1 + a, "inside"), Start(b, s**2, M3=0.0, F3=-(s**4), F2=s**3 * c))
    got = observe(solve(case, tol=1e-8, method=method, stations=2), ["lift_off_at"], errors=True)
    exact = 1 / np.tan(b) - 1 / np.sqrt(5)
    assert abs(got["lift_off_at"] - exact) <= got["lift_off_at_error"] + 1e-13 * length
    assert got["lift_off_at"] == pytest.approx(exact, rel=1e-6)
