"""The place of the largest push: by a march in 25 digits, on helices, where places are equal, and its derivative."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, observe, solve
from solver.methods import available
from tests.cases import EXACT, START, in_units_of_rho, random_rods
from tests.numerics.test_measurement import REFERENCES
from tests.numerics.test_sensitivity import differences
from tests.slow import slow

METHODS = [name for name in ("orbit", "swing", "dop853") if name in available()]
NAMES = ["push_max_at", "push_max"]


def seen(case: Case, **more: Any) -> dict[str, Any]:
    found: dict[str, Any] = observe(solve(case, **more), NAMES, errors=True)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_the_place_is_that_of_a_march_in_25_digits(method: str) -> None:
    case = random_rods(30, 17, 6.0)
    got = seen(case, tol=1e-10, method=method, stations=2001)
    rho = np.broadcast_to(case.rho, case.shape)
    for i, (place, push) in enumerate(REFERENCES["push few"]):
        off, error = abs(got["push_max_at"][i] / rho[i] - place), got["push_max_at_error"][i] / rho[i]
        assert off <= error + 1e-7, i  # the search of the reference ends where the push changes by rounding
        A = np.broadcast_to(case.rod.bending_stiffness, case.shape)[i]
        assert got["push_max"][i] == pytest.approx(push * A / rho[i] ** 3, rel=1e-7, abs=1e-7 * A / rho[i] ** 3)


@pytest.mark.parametrize("side", ["inside", "outside"])
def test_no_station_has_a_larger_push_and_the_one_at_the_place_has_it(side: str) -> None:
    given = Start(0.6, 0.3, F1=2.0, F2=1.0, F3=np.linspace(-20, 10, 7))
    case = Case(Rod(1.07e4, 0.25, 0.25, 9.0), Cylinder(1.25, side), given)
    got = seen(case, tol=1e-12)
    for i, force in enumerate(given.F3):
        place = float(got["push_max_at"][i])
        one = solve(
            replace(case, given=replace(given, F3=force)), tol=1e-12, stations=np.sort([*np.linspace(0, 9, 999), place])
        )
        assert one.push.max() == pytest.approx(got["push_max"][i], rel=1e-11)
        assert np.interp(place, one.s, one.push) == pytest.approx(got["push_max"][i], rel=1e-11)


@pytest.mark.parametrize("method", METHODS)
def test_a_constant_push_has_its_place_at_the_start(method: str) -> None:
    got = seen(EXACT["buckled pipe 30 deg"].case, method=method)
    assert got["push_max_at"] == 0


def test_of_equal_places_the_first_counts_and_the_error_says_how_far_the_others_are() -> None:
    """Without MZ and M3 the push is the same at beta and at -beta: at both turning points."""
    case = in_units_of_rho(0.0, 0.0, -0.5, 60.0, 0.0, 0.6)
    sol = solve(case, tol=1e-11, stations=6001)
    highest = (np.diff(sol.push)[:-1] > 0) & (np.diff(sol.push)[1:] <= 0) & (sol.push[1:-1] > sol.push.max() - 1e-4)
    places = sol.s[1:-1][highest]
    assert len(places) > 10
    for method in METHODS:
        got = seen(case, method=method, stations=2001)
        assert got["push_max_at"] == pytest.approx(places[0], abs=0.02), method
    assert seen(case, method="dop853", stations=2001)["push_max_at_error"] > places[1] - places[0] - 0.05


def test_a_failed_case_alone_has_no_place() -> None:
    case = Case(
        Rod(1.07e4, 0.25, 0.25, 8.0), Cylinder(0.75), Start(0.5, 0.5, F1=5.0, F2=0.0, F3=np.array([10.0, 1e300]))
    )
    sol = solve(case)
    assert list(np.isnan(observe(sol, ["push_max_at"])["push_max_at"])) == list(~sol.solved) == [False, True]


@pytest.mark.parametrize(
    ("count", "fields", "least"),
    [(6, ("R", "L", "dbeta0"), (1, 1)), slow(60, ("E", "R", "L", "beta0", "dbeta0", "F3", "M3"), (16, 6))],
)
def test_derivatives_agree_with_differences(count: int, fields: tuple[str, ...], least: tuple[int, int]) -> None:
    """Of places inside random rods and at their far ends."""
    rng, inner, far = np.random.default_rng(8), 0, 0

    def read(sol: Any) -> Any:
        return np.array([observe(sol, NAMES[:1])[NAMES[0]]])

    while inner + far < count:
        given = Start(rng.uniform(-3, 3), rng.normal(), F2=9 * rng.normal(), F3=9 * rng.normal(), M3=9 * rng.normal())
        case = Case(Rod(1.07e4, 0.25, 0.25, 4.0), Cylinder(0.75, str(rng.choice(["inside", "outside"]))), given)
        got = seen(case, tol=1e-12)
        if got["push_max_at_error"] > 1e-4 or got["push_max_at"] == 0:
            continue  # another place has nearly the same push
        found = solve(case).sensitivity(fields, NAMES[:1])
        for k, field in enumerate(fields):
            exact = differences(case, field, read, 1e-4, stations=3, method="orbit")[0]
            assert found.observables["push_max_at"][k] == pytest.approx(exact, rel=1e-5, abs=1e-6), field
        inner, far = inner + (got["push_max_at"] < 4), far + (got["push_max_at"] == 4)
    assert inner >= least[0]
    assert far >= least[1]


def test_no_derivative_where_the_place_may_leave_an_end_or_places_part() -> None:
    turned = Case(Rod(1.07e4, 0.25, 0.25, 1.0), Cylinder(0.75, "inside"), Start(1.4, 0.0, F2=1.0, F3=5.0, M3=1.0))
    at = float(seen(turned)["push_max_at"])
    found = solve(turned).sensitivity(["E", "dbeta0", "beta0"], ["push_max_at"])
    assert at == pytest.approx(0, abs=1e-9)
    assert found.observables["push_max_at"][[0, 2]] == pytest.approx([0, 0], abs=1e-9)
    assert np.isnan(found.observables["push_max_at"][1])
    helix = solve(START["helix at a centre"].case).sensitivity(["L", "beta0"], ["push_max_at"])
    assert helix.observables["push_max_at"][0] == 0
    assert np.isnan(helix.observables["push_max_at"][1])
    assert "several places" in helix.remarks["push_max_at"]
