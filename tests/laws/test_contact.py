"""Where the cylinder pushes, where the rod would lift off, and where it would pass through itself."""

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, solve
from solver.observe.observables import observe
from tests.cases import helix_moment, in_units_of_rho, table_1


def helix(beta: float, phi: float, a: float = 0.25, side: str = "outside", span: float = 20.0) -> Case:
    """A helix without twist at any angle, with the rod's radius free (rho stays 1)."""
    lam = helix_moment(beta, 0.0, phi)
    s, c = np.sin(beta), np.cos(beta)
    rod = Rod(E=4 / (np.pi * a**4), nu=0.25, a=a, L=span)
    FY = lam - s**3
    start = Start(beta, 0.0, F2=phi * s - FY * c, F3=phi * c + FY * s, dgamma=-s * c)
    return Case(rod, Cylinder(1 - a if side == "outside" else 1 + a, side), start)


def attached(case: Case) -> float:
    return float(observe(solve(case, tol=1e-8), ["attached"])["attached"])


def test_a_taut_helix_lies_on_the_outside_and_would_leave_the_inside() -> None:
    # f = sin FY/rho: outward under enough tension
    assert solve(helix(1.9, -2.0), tol=1e-8).contact.min() > 0
    assert attached(helix(1.9, -2.0)) == 1.0
    assert attached(helix(1.9, -2.0, side="inside")) == 0.0


def test_a_compressed_helix_would_leave_the_outside_and_is_held_inside() -> None:
    case = in_units_of_rho(0, 0, -2 * np.sin(1.2) ** 2 * np.cos(1.2), 20.0, 1.2, 0.0)
    assert solve(case, tol=1e-8).contact.max() < 0
    assert attached(case) == 0.0
    assert attached(helix(1.2, -2 * np.sin(1.2) ** 2 * np.cos(1.2), side="inside")) == 1.0


def test_lift_off_is_counted_by_its_share_of_the_length() -> None:
    """The unloaded elliptic rod: f = A (9 sin^4 - ... ) changes sign; counted on twenty thousand stations."""
    case = in_units_of_rho(0.3, 0.2, 0.1, 40.0, 0.5, 0.6)
    fine = solve(case, tol=1e-9, stations=20001)
    share = np.mean(fine.push >= 0)
    assert 0.1 < share < 0.9  # it does change sign
    assert attached(case) == pytest.approx(share, abs=1e-3)  # a station at each of some twenty changes


def test_the_same_shape_is_pushed_from_within_or_without() -> None:
    """Only rho counts for the shape: a rod inside R + 2a lies where a rod outside R does."""
    outside = solve(table_1("shear", "tension", "solid"), tol=1e-10)
    case = table_1("shear", "tension", "solid", "inside")
    inside = solve(Case(case.rod, Cylinder(1.25, "inside"), case.given), tol=1e-10)
    np.testing.assert_array_equal(inside.beta, outside.beta)
    np.testing.assert_array_equal(inside.contact, outside.contact)
    np.testing.assert_array_equal(inside.push, -outside.push)


def test_a_bend_tighter_than_the_rod_overlaps() -> None:
    """kappa above 1/a: the section would cut its neighbour, however short the rod."""
    for slope, expected in ((4.5, 1), (3.5, 0)):
        sol = solve(in_units_of_rho(0, 0, 0, 0.5, 0.1, slope), tol=1e-8)
        assert (sol.kappa.max() > 1 / sol.case.rod.a) == expected
        assert observe(sol, ["overlaps"])["overlaps"] == expected
