"""Derivatives of pitch, push_middle, lift_off_at, F3_size_max and bending_stress_max: fifty digits, helices, edges."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from benchmarks.make_observable_references import FIELDS, NAMES
from solver import Case, Cylinder, Ends, Rod, Start, observe, solve
from solver.observe.observables import OBSERVABLES
from solver.problem.case_fields import fields_of
from tests.cases import EXACT, NOWHERE, START, ends_in_units_of_rho, helix_moment, in_units_of_rho
from tests.numerics.test_sensitivity import ALONG, along, differences, moved
from tests.slow import slow

FILE = json.loads((Path(__file__).parents[1] / "observable_references.json").read_text(encoding="utf-8"))


def read(sol: Any) -> Any:
    return np.array(list(observe(sol, NAMES).values()))


def derivatives(case: Case, fields: Any) -> Any:
    """(names, fields)."""
    found = solve(case, tol=1e-12, stations=21).sensitivity(fields, NAMES)
    assert found.solved, found.outcome
    return np.array([found.observables[name] for name in NAMES])


@pytest.mark.parametrize("name", FILE["cases"])
def test_derivatives_agree_with_fifty_digits(name: str) -> None:
    side, E, nu, a, L, R, beta, dbeta, F1, F2, F3 = FILE["cases"][name]["case"]
    case = Case(Rod(E, nu, a, L), Cylinder(R, side), Start(beta, dbeta, F1=F1, F2=F2, F3=F3))
    exact = np.array([FILE["cases"][name]["derivatives"][field] for field in FIELDS]).T
    assert derivatives(case, FIELDS) == pytest.approx(exact, rel=1e-12, abs=1e-30)


@pytest.mark.parametrize("name", [
    "helix at a centre", "helix at a centre, inside", "buckled pipe 30 deg", "going round backwards", "inside, twisted",
])  # fmt: skip
def test_derivatives_agree_with_differences_also_on_helices_and_rotations(name: str) -> None:
    case = (START | EXACT)[name].case
    case = replace(case, rod=replace(case.rod, L=min(float(case.rod.L), 6.0)))  # differences lose digits along the rod
    fields = [field for field in fields_of(case) if field not in ("alpha0", "gamma0", "nu")]
    found = derivatives(case, fields)
    missing = np.isnan(found)
    assert not missing[[NAMES.index("pitch"), NAMES.index("push_middle"), NAMES.index("lift_off_at")]].any()
    for k, field in enumerate(fields):
        exact = differences(case, field, read, 1e-4, stations=3, method="orbit")
        known = ~missing[:, k]
        assert found[known, k] == pytest.approx(exact[known], rel=1e-6, abs=2e-7 * (1 + np.abs(exact).max())), field


def test_derivatives_of_an_equilibrium_agree_with_differences() -> None:
    case = ends_in_units_of_rho(-0.3655, 0.7464, -0.7506, 20.0, np.pi / 6, 0.6)
    solution = solve(case, tol=1e-11, stations=21)
    for field in ("betaL", "R", "M3", "E"):
        exact = differences(case, field, read, 1e-4, stations=21, seed=solution)
        found = solution.sensitivity([field], NAMES)
        seen = np.array([found.observables[name][0] for name in NAMES])
        assert seen == pytest.approx(exact, rel=1e-5, abs=1e-6 * np.abs(exact).max()), field


def test_a_longer_rod_lifts_off_later_only_where_it_nowhere_lifts_off() -> None:
    names, longer = [*FILE["cases"]], []
    for name in names:
        side, E, nu, a, L, R, beta, dbeta, F1, F2, F3 = FILE["cases"][name]["case"]
        case = Case(Rod(E, nu, a, L), Cylinder(R, side), Start(beta, dbeta, F1=F1, F2=F2, F3=F3))
        longer.append(float(solve(case).sensitivity("L", ["lift_off_at"]).observables["lift_off_at"][0]))
    assert dict(zip(names, longer, strict=True)) == {name: float(name == "pushes all along") for name in names}


def swinging(rate: float) -> Case:
    """A rod inside that swings about a helix, and pushes least between its turning points; less, the faster it is."""
    return in_units_of_rho(helix_moment(1.87, -1.23, -0.68), -1.23, -0.68, 12.0, 1.87, rate, "inside")


def touching_rate() -> float:
    """The rate of beta at the start of the one whose least push is zero."""

    def least(rate: float) -> float:
        return float(observe(solve(swinging(rate), tol=1e-13, stations=3), ["push_min"])["push_min"])

    return float(brentq(least, 1e-3, 0.8, xtol=1e-15, rtol=1e-15))


def test_where_the_push_only_touches_zero_the_place_of_lift_off_has_no_derivative() -> None:
    solution = solve(swinging(touching_rate()), tol=1e-13, stations=3)
    found = solution.sensitivity(["dbeta0", "alpha0"], ["lift_off_at", "pitch"])
    assert np.isnan(found.observables["lift_off_at"][0])
    assert found.observables["lift_off_at"][1] == 0
    assert "touches zero" in found.remarks["lift_off_at"]
    assert np.isfinite(found.observables["pitch"]).all()


@pytest.mark.parametrize("deeper", [1e-3, 1e-6])
def test_a_short_dip_of_the_push_has_its_place_and_its_derivative(deeper: float) -> None:
    """The dip of the second case is shorter than the distance of two nodes of a panel."""
    case = swinging(touching_rate() * (1 + deeper))
    solution = solve(case, tol=1e-13)
    place = float(observe(solution, ["lift_off_at"])["lift_off_at"])
    slope = float(solution.sensitivity("dbeta0", ["lift_off_at"]).observables["lift_off_at"][0])
    step = 1e-3 * deeper
    up, down = (float(read(solve(moved(case, "dbeta0", turn * step), tol=1e-13))[2]) for turn in (1, -1))
    assert 0 < place < 12
    assert slope == pytest.approx((up - down) / (2 * step), rel=1e-4)  # rounding over the step


def test_a_rod_that_begins_without_push_has_no_derivative_of_lift_off() -> None:
    twisted = in_units_of_rho(0.2, 0.2, 0.3, 5.0, 0.0, 0.0)  # straight: it pushes or pulls as soon as F2 bends it
    found = solve(twisted).sensitivity(["F2", "L"], ["lift_off_at", "push_middle", "push_mean", "pitch"])
    for name in ("lift_off_at", "push_middle", "push_mean"):
        assert np.isnan(found.observables[name][0]), name
        assert found.observables[name][1] == (name == "lift_off_at"), name
        assert found.remarks[name].startswith("no derivative")
    assert np.isnan(found.observables["pitch"]).all()
    assert "does not turn" in found.remarks["pitch"]


def test_an_extreme_of_the_force_that_two_places_reach_unequally_has_a_remark() -> None:
    """Without a moment the force is even in beta, so both turning points have its largest size; F2 adds a moment."""
    case = in_units_of_rho(0.0, 0.0, -0.7, 40.0, 0.75, 0.0)
    found = solve(case).sensitivity(["L", "F2"], ["F3_size_max"])
    assert found.observables["F3_size_max"][0] == 0
    assert np.isnan(found.observables["F3_size_max"][1])
    assert "several places" in found.remarks["F3_size_max"]
    unloaded = Case(case.rod, case.cylinder, Ends(0.0, 0.0))
    none = solve(unloaded).sensitivity(["FZ"], ["F3_size_max"])
    assert np.isnan(none.observables["F3_size_max"]).all()
    assert "no force" in none.remarks["F3_size_max"]


def test_every_observable_of_a_rod_on_the_wall_has_a_derivative() -> None:
    on_wall = {name for name, row in OBSERVABLES.items() if not row.free}
    found = solve(START["many equilibria"].case).sensitivity(["E", "R"], on_wall)
    assert set(found.observables) == on_wall
    assert not any(remark for name, remark in found.remarks.items() if name not in NOWHERE)  # a constant force


@pytest.mark.parametrize(("count", "seed", "least"), [(12, 3, 3), slow(150, 4, 21)])
def test_random_rods_agree_with_differences(count: int, seed: int, least: int) -> None:
    """Of which some lift off on the way: the observables, and the arrays along the rod."""
    rng, lifted = np.random.default_rng(seed), 0

    def read_all(sol: Any) -> Any:
        return np.concatenate([read(sol), along(ALONG)(sol).ravel()])

    for _ in range(count):
        given = Start(
            rng.uniform(-3, 3), rng.normal(), F2=10 * rng.normal(), F3=10 * rng.normal(), M3=10 * rng.normal()
        )
        case = Case(Rod(1.07e4, 0.25, 0.25, 8.0), Cylinder(0.75, str(rng.choice(["inside", "outside"]))), given)
        solution = solve(case, stations=5)
        if not solution.solved or solution.condition > 50:
            continue
        field = str(rng.choice([name for name in fields_of(case) if name not in ("alpha0", "gamma0", "nu")]))
        found = solution.sensitivity([field], NAMES)
        near = [read(solve(moved(case, field, sign * 1e-3), tol=1e-13, stations=3)) for sign in (1, -1)]
        table = differences(case, field, read_all, 1e-5, stations=5, method="orbit")
        for name, exact in zip(ALONG, table[len(NAMES) :].reshape(len(ALONG), 5), strict=True):
            assert getattr(found, name)[0] == pytest.approx(exact, rel=1e-4, abs=1e-5 * (1 + np.abs(exact).max()))
        for k, name in enumerate(NAMES):
            if abs(near[0][k] - near[1][k]) > 0.1 * (1 + abs(near[0][k])):
                continue  # it jumps, or nearly so
            assert found.observables[name][0] == pytest.approx(table[k], rel=1e-4, abs=1e-4 * (1 + abs(table[k]))), name
        where = float(observe(solution, ["lift_off_at"])["lift_off_at"])
        lifted += 0 < where < 8
    assert lifted >= least
