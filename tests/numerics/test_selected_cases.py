"""A solution of several cases is indexed like an array of their shape, and selected by values of fields."""

from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Solution, Start, observe, solve

E = np.array([5e3, 1e4, 2e4, 4e4])
TABLE = Rod(E=E, nu=0.25, a=0.25, L=20.0)
PIPE = Rod(EI=1228.0, GJ=945.0, a=0.0635, L=100.0, weight=np.array([0.2, 0.242, 0.27, 0.3]))
HOLE = Cylinder(R=0.108, side="inside", inclination="90deg")
START = Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)
HELD = Rod(E=E[:3], nu=0.25, a=0.25, L=6.0)
GRID = Case(TABLE, Cylinder(R=np.array([[0.5], [0.75], [1.0]])), START)
FAMILIES = {
    "marched": lambda: solve(GRID),
    "by quadrature": lambda: solve(GRID, method="orbit"),
    "without an orbit": lambda: solve(Case(TABLE, Cylinder(R=0.75), START), method="dop853"),
    "dead loads": lambda: solve(Case(TABLE, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, FZ=-8.66))),
    "held ends": lambda: solve(Case(HELD, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, height=3.0))),
    "weight": lambda: solve(Case(PIPE, HOLE, Ends(beta0=0.0, betaL=0.0, FZ=-150.0))),
    "weight, from a start": lambda: solve(Case(PIPE, HOLE, Start(beta=0.01, dbeta=0.0, F3=5.0, M3=0.0))),
}
ALONG = ("s", "z", "beta", "alpha", "gamma", "kappa", "push", "F1", "F3", "M2", "h", "position", "material_frame")
OF_CASE = (
    "FZ",
    "MZ",
    "M3",
    "solved",
    "outcome",
    "caution",
    "error",
    "condition",
    "selection",
    "dead_index",
    "bends_at",
)
NUMBERS = ("bends", "turns_around", "energy", "kappa_max", "push_min", "attached", "index", "overlaps", "bend_number")


def same(one: Any, other: Any) -> bool:
    one, other = np.asarray(one), np.asarray(other)
    return one.shape == other.shape and bool(((one == other) | ((one != one) & (other != other))).all())


@pytest.mark.parametrize("family", FAMILIES)
def test_a_selected_case_is_the_one_of_the_family_in_every_bit(family: str) -> None:
    rods: Solution = FAMILIES[family]()
    inner = (slice(1, 3), slice(0, 4, 2)) if len(rods.case.shape) == 2 else slice(1, 3)
    for index in (1, -1, inner):
        part = rods[index]
        for name in (*ALONG, *OF_CASE):
            assert same(np.asarray(getattr(rods, name))[index], getattr(part, name)), (index, name)
        whole, own = observe(rods, NUMBERS), observe(part, NUMBERS)
        for name in NUMBERS:  # sums over the cases of a batch differ in their last bits
            np.testing.assert_allclose(np.asarray(whole[name])[index], own[name], rtol=1e-12, atol=1e-300)


def test_values_of_fields_select_and_a_loop_goes_over_the_first_axis() -> None:
    rods = FAMILIES["marched"]()
    one = rods.sel(E=1e4, R=0.75)
    assert (one.case.rod.E, one.case.cylinder.R, one.case.shape) == (1e4, 0.75, ())
    assert one.z[-1] == rods.z[1, 1, -1]
    assert rods.sel(E=[1e4, 4e4]).case.shape == (3, 2)
    assert [part.case.cylinder.R[0] for part in rods] == [0.5, 0.75, 1.0]
    assert len(rods) == 3
    turned = solve(
        Case(Rod(E=1e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75), Start(beta=np.radians([20, 40]), dbeta=0.5, M3=0.0))
    )
    assert turned.sel(beta="40deg").beta[0] == turned.sel(beta0=np.radians(40)).beta[0] == turned.beta[1, 0]


def test_a_selection_that_is_none_is_refused() -> None:
    rods = FAMILIES["without an orbit"]()
    indices = {"no index 9": 9, "no index 'a'": "a", "in their order": [2, 0], "at least one": slice(4, 4)}
    indices |= {"step cannot be zero": slice(None, None, 0)}
    for words, index in indices.items():
        with pytest.raises(InputError, match=words):
            rods[index]
    for words, value in {"no case has E = 15000; there are 5000, ": {"E": 15e3}, "along no axis": {"R": 0.75}}.items():
        with pytest.raises(InputError, match=words):
            rods.sel(**value)
    for value in ("x", None, slice(1e4, 2e4), np.nan, [], ["5e3"]):
        with pytest.raises(InputError, match=r"selected\.E (must|is empty)"):
            rods.sel(E=value)
    with pytest.raises(InputError, match="one case"):
        rods[0][0]
    for of_many in (len, iter):
        with pytest.raises(TypeError, match="one case"):
            of_many(rods[0])
    assert rods[0]
