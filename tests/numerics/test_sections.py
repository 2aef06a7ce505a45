"""Sections of rods: solid, a tube, or two given stiffnesses."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, fit, observe, solve
from solver.observe.observables import OBSERVABLES, is_count, observables_of
from solver.problem.case_fields import fields_of
from tests.numerics.test_sensitivity import along, differences

SOLID: dict[str, Any] = {"E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 6.0}
TUBE: dict[str, Any] = {**SOLID, "inner_radius": 0.2}
DIRECT: dict[str, Any] = {"EI": 32.8, "GJ": 41.5, "a": 0.25, "L": 6.0}  # softer in bending, as DNA is
WALL = Cylinder(0.75)
STARTS = {
    "F1": Start(0.5, 0.5, F1=5.0, F2=3.0, F3=10.0),
    "dgamma": Start(0.5, 0.5, dgamma=0.5, F2=3.0, F3=10.0),
    "M3": Start(0.5, 0.5, M3=5.0, F2=3.0, F3=-10.0),
}
ALONG = ("beta", "dbeta", "alpha", "z", "gamma")


def test_solid_rods_keep_every_bit() -> None:
    rng = np.random.default_rng(14)
    E, a, nu = rng.uniform(1, 1e9, 50), rng.uniform(1e-3, 10, 50), rng.uniform(-0.9, 0.5, 50)
    for word, factor in (("solid", np.pi / 4), ("paper", np.pi / 16)):
        for rod, e, r, n in (
            (Rod(E, nu, a, 1.0, word), E, a, nu),
            (Rod(E[0], nu[0], a[0], 1.0, word), E[0], a[0], nu[0]),
        ):
            A = factor * e * np.power(r, 4.0)
            np.testing.assert_array_equal(rod.bending_stiffness, A)
            np.testing.assert_array_equal(rod.torsional_stiffness, A / (1 + n))
            np.testing.assert_array_equal(rod.stiffness_ratio, 1 + n)
    case = Case(Rod(**SOLID), WALL, STARTS["dgamma"])
    s, c = np.sin(0.5), np.cos(0.5)
    assert case.loads[2] == case.rod.bending_stiffness * ((0.5 + s * c / case.rho) / (1 + 0.25))


def test_a_tube_is_the_difference_of_two_solids() -> None:
    bore = np.array([0.0, 0.01, 0.1, 0.2, 0.24])
    tube = Rod(**{**SOLID, "inner_radius": bore})
    outer, inner = Rod(**SOLID), Rod(**{**SOLID, "a": bore[1:]})
    assert tube.bending_stiffness[0] == pytest.approx(outer.bending_stiffness, rel=4e-16)
    difference = outer.bending_stiffness - inner.bending_stiffness
    np.testing.assert_allclose(tube.bending_stiffness[1:], difference, rtol=2e-15)
    assert tube.torsional_stiffness == pytest.approx(tube.bending_stiffness / 1.25, rel=4e-16)


def test_a_thin_wall_keeps_its_digits() -> None:
    """The wall is 2^-40: a^4 - inner^4 by subtraction would keep 4 digits of the bending stiffness pi E a^3 t."""
    t = 2.0**-40
    tube = Rod(E=1.0, nu=0.3, a=1.0, L=1.0, inner_radius=1.0 - t)
    # (1 - (1 - t)^4)/t = 4 - 6 t + 4 t^2 - t^3
    assert tube.bending_stiffness == pytest.approx(np.pi / 4 * t * (4 - 6 * t), rel=4e-16)


@pytest.mark.parametrize("given", STARTS.values(), ids=STARTS)
def test_given_stiffnesses_solve_as_the_modulus_that_has_them(given: Start) -> None:
    tube = Rod(**TUBE)
    direct = Rod(EI=tube.bending_stiffness, GJ=tube.torsional_stiffness, a=tube.a, L=tube.L)
    names = [name for name in OBSERVABLES if name != "bending_stress_max"]
    one, two = (solve(Case(rod, WALL, given), tol=1e-11) for rod in (tube, direct))
    rounding = 1e-13 * float(one.condition)
    for name in (*ALONG, "F1", "F2", "F3", "contact", "M1", "M2"):
        np.testing.assert_allclose(getattr(two, name), getattr(one, name), rtol=1e-11, atol=100 * rounding)
    first, second = (np.array(list(observe(sol, names).values()), dtype=float) for sol in (one, two))
    np.testing.assert_allclose(second, first, rtol=1e-10, atol=100 * rounding)


def test_the_fields_are_arrays_as_all_others_are() -> None:
    case = Case(Rod(**{**DIRECT, "EI": [[20.0], [40.0]], "GJ": [10.0, 20.0, 30.0]}), WALL, STARTS["M3"])
    sol = solve(case)
    assert case.shape == (2, 3)
    assert sol.solved.all()
    single = solve(Case(Rod(**{**DIRECT, "EI": 40.0, "GJ": 20.0}), WALL, STARTS["M3"]))
    np.testing.assert_allclose(sol.gamma[1, 1], single.gamma, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("fields", (TUBE, DIRECT), ids=("tube", "given"))
@pytest.mark.parametrize("given", STARTS.values(), ids=STARTS)
def test_derivatives_agree_with_differences(fields: dict[str, Any], given: Start) -> None:
    case = Case(Rod(**fields), WALL, given)
    own = [name for name in ("E", "nu", "a", "inner_radius", "EI", "GJ") if name in fields]
    assert set(own) < set(fields_of(case))
    real = [name for name in observables_of(case.rod) if not is_count(name)]
    found = solve(case, stations=5).sensitivity(own, real)
    seen = ["height", "turns_around", "energy", "twist_energy", "push_mean"] + ["bending_stress_max"] * ("E" in own)
    for k, field in enumerate(own):
        step = 2e-3 * (1.0 if field == "E" else getattr(case.rod, field))  # of E it is relative
        exact = differences(case, field, along(ALONG), step, stations=5, method="orbit")
        for name, row in zip(ALONG, exact, strict=True):
            # differences of numbers of size 10 with 14 digits over steps of 1e-4 of the field
            assert getattr(found, name)[k] == pytest.approx(row, rel=1e-6, abs=1e-8 * (1 + np.abs(row).max())), field
        exact = differences(
            case, field, lambda sol: np.array(list(observe(sol, seen).values())), step, stations=5, method="orbit"
        )
        computed = np.array([found.observables[name][k] for name in seen])
        assert computed == pytest.approx(exact, rel=2e-6, abs=1e-8), field


@pytest.mark.parametrize("fields, name, low, high", (
    (TUBE, "inner_radius", 0.05, 0.24),
    (DIRECT, "EI", 10.0, 90.0),
    (DIRECT, "GJ", 10.0, 90.0),
))  # fmt: skip
def test_a_fit_finds_the_section(fields: dict[str, Any], name: str, low: float, high: float) -> None:
    true = Case(Rod(**fields), WALL, STARTS["dgamma"])
    seen = observe(solve(true, tol=1e-12), ["height", "turns_around"])  # several bores have this height
    first = replace(true, rod=replace(true.rod, **{name: 0.95 * fields[name]}))
    found = fit(first, vary={name: (low, high)}, targets={key: float(value) for key, value in seen.items()}, starts=0)
    assert getattr(found.case.rod, name) == pytest.approx(fields[name], rel=1e-6)


def test_a_rod_without_a_modulus_has_no_stress() -> None:
    sol = solve(Case(Rod(**DIRECT), WALL, STARTS["M3"]))
    assert "bending_stress_max" not in observables_of(sol.case.rod)
    assert observables_of(Rod(**TUBE)) == tuple(
        name for name, row in OBSERVABLES.items() if not (row.holds or row.free)
    )


def test_the_text_of_a_rod_names_what_is_given() -> None:
    assert repr(Rod(**SOLID)) == "Rod(E=10700.0, nu=0.25, a=0.25, L=6.0, stiffness='solid')"
    assert repr(Rod(**TUBE)) == "Rod(E=10700.0, nu=0.25, a=0.25, L=6.0, stiffness='solid', inner_radius=0.2)"
    assert repr(Rod(**DIRECT)) == "Rod(a=0.25, L=6.0, EI=32.8, GJ=41.5)"
