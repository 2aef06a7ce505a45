"""The symmetries of section 7: mirror images, the arc reversed, other units."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import Case, Solution, Start, solve
from tests.cases import GENERAL, TABLE_1, Named, in_units_of_rho, start_of
from tests.reach import core

CASES: dict[str, Named] = {
    **{name: TABLE_1[name] for name in ("force-first/tension/paper", "shear/compression/solid")},
    **{name: GENERAL[name] for name in ("going round", "inside, twisted", "from a far angle")},
}
STARTS = core("start")
TOL = {"orbit": 1e-11, "verlet": 1e-4}  # verlet would need many steps for more


both = pytest.mark.parametrize("name", CASES)
every_method = pytest.mark.parametrize("method", STARTS)


def solved(case: Case, method: str) -> Solution:
    sol = solve(case, tol=TOL.get(method, 1e-7), method=method, stations=41)
    assert sol.solved, sol.outcome
    return sol


@cache
def base(name: str, method: str) -> Solution:
    return solved(CASES[name].case, method)


def slack(sol: Solution) -> float:
    """What two answers may differ by: both errors, and rounding grown by the condition number."""
    return 2 * sol.error + 1e-13 * sol.condition


def flip(value: float | None) -> float | None:
    return None if value is None else -value


def axis_mirror(g: Start) -> Start:
    """beta -> -beta flips (lam, mu)."""
    return replace(g, beta=-g.beta, dbeta=-g.dbeta, F2=-g.F2, dgamma=flip(g.dgamma), alpha=-g.alpha, gamma=-g.gamma)


def upside_down(g: Start) -> Start:
    """beta -> pi - beta flips (phi, mu)."""
    return replace(g, beta=np.pi - g.beta, dbeta=-g.dbeta, F2=-g.F2, dgamma=flip(g.dgamma), gamma=-g.gamma)


# of each image: the signs of MZ, M3 and FZ, beta less its sign times that of the rod, the signs of beta, alpha, z and
# gamma, and a force that keeps its sign
MIRRORS = {
    "a mirror through the axis": (axis_mirror, (-1, -1, 1), 0.0, (-1, -1, 1, -1), "F1"),
    "the cylinder upside down": (upside_down, (1, -1, -1), np.pi, (-1, 1, -1, -1), "F3"),
}


@both
@every_method
@pytest.mark.parametrize("mirror", MIRRORS)
def test_a_mirror_turns_the_signs_of_loads_and_shape(name: str, method: str, mirror: str) -> None:
    image, of_loads, turn, signs, force = MIRRORS[mirror]
    case = CASES[name].case
    a, b = base(name, method), solved(replace(case, given=image(case.given)), method)
    scale, atol = np.abs(a.contact).max(), slack(a)
    loads = np.multiply(of_loads, (a.MZ, a.M3, a.FZ))
    assert pytest.approx(loads, rel=1e-12, abs=1e-12 * scale) == [b.MZ, b.M3, b.FZ]
    np.testing.assert_allclose(b.beta, turn + signs[0] * a.beta, atol=atol)
    for field, sign in zip(("alpha", "z", "gamma"), signs[1:], strict=True):
        np.testing.assert_allclose(getattr(b, field), sign * getattr(a, field), atol=20 * atol, err_msg=field)
    for field in ("contact", force):
        np.testing.assert_allclose(getattr(b, field), getattr(a, field), atol=100 * atol * scale, err_msg=field)


@both
@every_method
def test_the_arc_reversed_leads_back_to_the_start(name: str, method: str) -> None:
    case = CASES[name].case
    rod, rho = case.rod, case.rho
    A = rod.bending_stiffness
    there = base(name, method)
    l, m, p = there.MZ / A, there.M3 / A, there.FZ / A
    end = start_of(rod, rho, l, m, p, there.beta[-1], -there.dbeta[-1])
    back = solved(Case(rod, case.cylinder, end), method)
    # the far end's own error grows on the way back
    atol = slack(there) * (1 + back.condition) + slack(back)
    np.testing.assert_allclose(back.beta[::-1], there.beta, atol=atol)
    np.testing.assert_allclose(back.alpha[-1], there.alpha[-1] - there.alpha[0], atol=20 * atol)
    np.testing.assert_allclose(back.z[-1], there.z[-1], atol=20 * atol)


def rotated(case: Case) -> Case:
    """The same rod run through from its other end as a rod: T, and with it F, change sign."""
    there = solve(case, tol=1e-12, stations=2)
    end = Start(
        there.beta[-1] + np.pi,
        -there.dbeta[-1],
        F2=there.F2[-1],
        F3=there.F3[-1],
        dgamma=there.M3 / case.rod.torsional_stiffness - np.sin(2 * there.beta[-1]) / (2 * case.rho),
        alpha=there.alpha[-1],
    )
    return Case(case.rod, case.cylinder, end)


@both
def test_the_rod_described_from_its_other_end_is_the_same_rod(name: str) -> None:
    case = CASES[name].case
    a, b = base(name, "orbit"), solved(rotated(case), "orbit")
    atol = 20 * slack(a) * (1 + b.condition)
    shift = [0, 0, 1] * (a.position[-1] - b.position[0])
    np.testing.assert_allclose(b.position[::-1] + shift, a.position, atol=atol)
    np.testing.assert_allclose(b.contact[::-1], a.contact, atol=10 * atol * np.abs(a.contact).max())


def scaled(case: Case, force: float, length: float) -> Case:
    """Other units: every force times `force`, every length times `length`."""
    rod, g = case.rod, case.given
    stress = force / length**2
    times = lambda value, factor: None if value is None else value * factor  # noqa: E731
    return Case(
        replace(rod, E=rod.E * stress, a=rod.a * length, L=rod.L * length),
        replace(case.cylinder, R=case.cylinder.R * length),
        replace(
            g, dbeta=g.dbeta / length, dgamma=times(g.dgamma, 1 / length), F1=times(g.F1, force), F2=g.F2 * force,
            F3=g.F3 * force,
        ),
    )  # fmt: skip


SHAPE = ("beta", "alpha")
PER_LENGTH = ("dbeta", "kappa")
LENGTHS = ("z", "s")
FORCES = ("F1", "F2", "F3", "FY")


@both
@every_method
@pytest.mark.parametrize(("force", "length"), ((2.0**-20, 1.0), (2.0**41, 1.0), (4.0, 2.0), (4.0, 2.0**-21)))
def test_scaling_stiffness_and_loads_or_lengths_leaves_every_bit_of_the_shape(
    name: str, method: str, force: float, length: float
) -> None:
    a = base(name, method)
    b = solved(scaled(CASES[name].case, force, length), method)
    units = {
        **dict.fromkeys(SHAPE, 1.0), **dict.fromkeys(LENGTHS, length), **dict.fromkeys(PER_LENGTH, 1 / length),
        **dict.fromkeys(FORCES, force), "contact": force / length, "M1": force * length, "M2": force * length,
    }  # fmt: skip
    for field, unit in units.items():
        np.testing.assert_array_equal(getattr(b, field), unit * getattr(a, field), err_msg=field)
    assert (b.condition, b.error, b.outcome) == (a.condition, a.error, a.outcome)


loads = st.floats(-2, 2)


@settings(max_examples=40)
@given(lam=loads, mu=loads, phi=loads, beta=st.floats(-3, 3), dbeta=st.floats(-2, 2), factor=st.floats(0.1, 10))
def test_any_rod_has_its_mirror_images(
    lam: float, mu: float, phi: float, beta: float, dbeta: float, factor: float
) -> None:
    """All three images in one batch, in units in which nothing is 1."""
    flips = np.array([[1, 1, 1], [-1, -1, 1], [1, -1, -1], [-1, 1, -1]])
    sign = np.array([1, -1, 1, -1])
    angle = np.array([beta, -beta, np.pi - beta, beta - np.pi])
    slope = dbeta * np.array([1, -1, -1, 1])
    case = in_units_of_rho(*(flips * [lam, mu, phi]).T, 12.0, angle, slope)
    sol = solve(scaled(case, factor, 1 / factor), tol=1e-9, stations=21)
    if sol.condition.max() > 1e6:
        return  # the images differ by the rounding of pi - beta, grown
    images = sol.beta * np.array([1, -1, -1, 1])[:, None] + np.array([0, 0, np.pi, np.pi])[:, None]
    atol = 2 * sol.error.max() + 1e-13 * sol.condition.max()
    np.testing.assert_allclose(images, np.broadcast_to(images[0], images.shape), atol=atol)
    wound = sol.alpha * sign[:, None]
    np.testing.assert_allclose(wound, np.broadcast_to(wound[0], wound.shape), atol=20 * atol)
