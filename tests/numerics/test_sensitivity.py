"""`Solution.sensitivity` against derivatives in fifty digits, against differences, and against symmetries."""

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Start, equilibria, observe, solve
from solver.observe.motions import of_equilibria, of_helices, start_sensitivities
from solver.observe.observables import OBSERVABLES, is_count
from solver.orbits.periodic_orbit import HELIX
from solver.problem.case_fields import fields_of
from solver.problem.dimensionless import NUMBERS, StartProblem, end_number_names
from tests.cases import NOWHERE, START, ends_in_units_of_rho, in_units_of_rho
from tests.slow import slow_but

FILE = json.loads((Path(__file__).parents[1] / "sensitivity_references.json").read_text(encoding="utf-8"))
ALONG = ("beta", "dbeta", "alpha", "z", "gamma")
REAL = [name for name, row in OBSERVABLES.items() if not (is_count(name) or row.free)]
TABLE = Case(Rod(1.07e4, 0.25, 0.25, 20.0), Cylinder(0.75), Start("30deg", 0.5, F1=5.0, F2=1.0, F3=10.0))
_AT_START = {"beta0": "beta", "dbeta0": "dbeta", "alpha0": "alpha", "gamma0": "gamma"}


def moved(case: Case, field: str, step: Any) -> Case:
    """The case with one field changed."""
    for name in ("rod", "cylinder", "given"):
        part = getattr(case, name)
        own = field if hasattr(part, field) else _AT_START.get(field, field)
        if getattr(part, own, None) is not None:
            return replace(case, **{name: replace(part, **{own: getattr(part, own) + step})})
    raise AssertionError(field)


def differences(case: Case, field: str, read: Any, step: float, **options: Any) -> Any:
    """The derivative of what `read` reads of a solution, by central differences extrapolated three times."""
    size = step * max(1.0, float(np.max(case.rod.E)) if field == "E" else 1.0)
    table = []
    for k in range(4):
        h = size / 2**k
        up, down = (read(solve(moved(case, field, sign * h), tol=1e-13, **options)) for sign in (1, -1))
        table.append((up - down) / (2 * h))
    for order in (1, 2, 3):
        table = [(4**order * b - a) / (4**order - 1) for a, b in pairwise(table)]
    return table[0]


def along(names: tuple[str, ...]) -> Any:
    """What reads these arrays of a solution, (len(names), n)."""
    return lambda sol: np.stack([getattr(sol, name) for name in names])


def jacobian(solution: Any) -> Any:
    """Derivatives of beta, beta_t, alpha, z, swirl (n, 5) in the five directions of the references, (n, 5, 5)."""
    if isinstance(solution.problem, StartProblem):
        by, none = np.zeros((len(NUMBERS), 1, 5)), np.zeros(1)
        by[[NUMBERS.index(name) for name in ("beta0", "end", "lam", "mu", "phi")], 0, range(5)] = 1
        known = {"t": solution.t, "by": by, "later": np.zeros((1, 5)), "ratio": none, "rho": none + 1}
        known |= {key: getattr(solution.trajectory, n) for key, n in (("beta", "beta"), ("rate", "dbeta"), ("z", "z"))}
        answer = start_sensitivities(solution.problem, known)
        if answer.kind[0] != HELIX:
            beta, rate, alpha, z, minus_swirl = answer.along[:, 0]
            return np.stack([beta, rate, alpha, z, -minus_swirl]).transpose(2, 0, 1)
        (motion,) = of_helices(solution, np.array([0]))
    else:
        (motion,) = of_equilibria(solution, np.array(["solved"], dtype=object))
    along = motion.varied.change(solution.t, motion.parts)
    alpha, minus_swirl, z = (along.integrals[0, ..., k] for k in range(3))
    found = np.stack([along.beta[0], along.rate[0], alpha, z, -minus_swirl], axis=1)
    if isinstance(solution.problem, StartProblem):
        return found
    return found[..., [end_number_names(solution.case).index(name) for name in ("beta0", "betaL", "lam", "mu", "phi")]]


def off(found: Any, exact: Any) -> float:
    """The largest error of each derivative over its own largest size along the rod."""
    return float((np.abs(found - exact).max(axis=0) / np.maximum(np.abs(exact).max(axis=0), 1e-300)).max())


@pytest.mark.parametrize("name", FILE["start"])
def test_derivatives_of_start_problems_agree_with_fifty_digits(name: str) -> None:
    case = START[name].case
    solution = solve(case, tol=1e-9, stations=np.array(FILE["shares"]) * case.rod.L)
    exact = np.array(FILE["start"][name]["jacobian"])
    rounding = 64 * 2.0**-52 * float(solution.condition)  # of the start, grown
    assert off(jacobian(solution), exact) < min(max(1e-11, rounding), 1e-9)


@pytest.mark.parametrize("place", FILE["ends"])
def test_derivatives_of_equilibria_agree_with_fifty_digits(place: str) -> None:
    case = ends_in_units_of_rho(*FILE["reference"])
    wanted = FILE["ends"][place]
    solution = equilibria(case, stations=3)[int(place)].solution
    assert float(solution.trajectory.dbeta[0, 0]) == pytest.approx(wanted["dbeta0"], abs=1e-13)
    again = solve(case, tol=1e-9, stations=np.array(FILE["shares"]) * case.rod.L, seed=solution)
    assert off(jacobian(again), np.array(wanted["jacobian"])) < 1e-11


@pytest.mark.parametrize("tol", slow_but((1e-4, 1e-6, 1e-9), 1e-4, 1e-6))
def test_the_stated_error_includes_that_of_the_solution(tol: float) -> None:
    start, ends = Start(0.5, 0.5, M3=5.0, F2=3.0, F3=-10.0), Ends(0.5, 0.8, FZ=-8.66)
    for given, method in ((start, "auto"), (start, "rk4"), (ends, "collocation")):
        case = replace(TABLE, given=given)
        exact = solve(case, tol=1e-12).sensitivity(["L", "R"])
        loose = solve(case, tol=tol, method=method).sensitivity(["L", "R"])
        if not loose.solved:  # the collocation of a loose tolerance has no orbit
            continue
        for name in ALONG:
            one, other = getattr(exact, name), getattr(loose, name)
            off = np.abs(other - one).max(axis=1) / np.abs(one).max(axis=1).clip(1e-300)
            assert off.max() <= float(loose.error), (name, method)


@pytest.mark.parametrize("given", (
    Start(0.5, 0.5, F1=5.0, F2=3.0, F3=10.0, alpha=0.3, gamma=0.2),
    Start(0.5, 0.5, dgamma=0.5, F2=3.0, F3=10.0),
    Start(0.5, 0.5, M3=5.0, F2=3.0, F3=-10.0),
))  # fmt: skip
@pytest.mark.parametrize("side", ("outside", "inside"))
def test_derivatives_by_every_field_agree_with_differences(given: Start, side: str) -> None:
    case = Case(Rod(1.07e4, 0.25, 0.25, 6.0), Cylinder(0.75, side), given)
    found = solve(case, stations=7).sensitivity(fields_of(case), REAL)
    for k, field in enumerate(found.fields):
        table = differences(case, field, along(ALONG), 1e-3, stations=7, method="orbit")
        for name, exact in zip(ALONG, table, strict=True):
            # differences of numbers of size 10 with 14 digits, steps of 1e-4
            assert getattr(found, name)[k] == pytest.approx(exact, rel=1e-6, abs=1e-8 * (1 + np.abs(exact).max())), (
                field
            )


@pytest.mark.parametrize("given", (TABLE.given, Start(0.7, -0.4, F2=2.0, F3=-20.0, dgamma=0.3)))
def test_derivatives_of_observables_agree_with_differences(given: Start) -> None:
    case = Case(TABLE.rod, TABLE.cylinder, given)
    names = ["kappa_mean", "kappa_max", "turns_around", "height", "push_mean", "pull_mean", "push_min", "push_max",
             "attached", "push_max_at", "energy", "bending_energy", "twist_energy", "amplitude", "bend_number",
             "contact_size_mean", "bending_moment_max", "pitch", "push_middle", "lift_off_at", "F3_size_max",
             "bending_stress_max", "FZ", "MZ", "M3", "M10", "M1L", "FZ0", "MZ0", "M30", "surface_torque"]  # fmt: skip
    found = solve(case).sensitivity(["E", "R", "beta0"], names)
    assert {*names, *NOWHERE} == set(REAL)  # the axial force is constant: it is nowhere 0
    assert not any(found.remarks.values())

    def read(sol: Any) -> Any:
        return np.array(list(observe(sol, names).values()))

    for k, field in enumerate(found.fields):
        exact = differences(case, field, read, 1e-4, stations=3, method="orbit")
        seen = np.array([found.observables[name][k] for name in names])
        assert seen == pytest.approx(exact, rel=2e-6, abs=1e-8), field


def test_the_angle_of_a_start_is_a_field_by_its_name_there_and_by_that_of_its_quantity() -> None:
    sol = solve(Case(Rod(1.07e4, 0.25, 0.25, 6.0), Cylinder(0.75), Start(0.5, 0.5, M3=5.0)), stations=5)
    by_quantity, by_field = (sol.sensitivity([name], ["height"]) for name in ("beta0", "beta"))
    assert by_field.fields == by_quantity.fields == ("beta0",)
    assert by_field.observables["height"] == by_quantity.observables["height"]
    with pytest.raises(InputError, match="must be one or several different names, got beta0, beta0"):
        sol.sensitivity(["beta", "beta0"])


def test_the_mean_curvature_of_a_rod_that_is_nearly_straight_at_places_has_all_digits() -> None:
    """There the curvature has a sharp bend: 2e-4 within a hundredth of the length, where it is 2.8 at most."""
    case = Case(TABLE.rod, Cylinder(0.75, "inside"), Start(0.00994, -2.37e-8, F2=-13.1, F3=-9.72, M3=-1.14))
    found = solve(case, stations=3).sensitivity(["beta0"], ["kappa_mean"]).observables["kappa_mean"][0]
    exact = differences(case, "beta0", lambda sol: observe(sol, ["kappa_mean"])["kappa_mean"], 1e-3, stations=3)
    assert found == pytest.approx(exact, rel=1e-9)


def test_derivatives_of_an_equilibrium_between_long_ends_agree_with_differences() -> None:
    case = ends_in_units_of_rho(-0.3655, 0.7464, -0.7506, 200.0, np.pi / 6, 0.6)  # its level is exp(-270) from a saddle
    solution = solve(case, tol=1e-11, stations=21)
    found = solution.sensitivity(["betaL", "R"], ["height"])
    assert found.solved
    for k, field in enumerate(found.fields):
        table = differences(case, field, along(("beta", "z")), 1e-3, stations=21, seed=solution)
        for name, exact in zip(("beta", "z"), table, strict=True):
            assert getattr(found, name)[k] == pytest.approx(exact, rel=1e-6, abs=1e-7 * np.abs(exact).max())
    assert found.beta[0][[0, -1]] == pytest.approx([0, 1], abs=1e-12)
    assert found.observables["height"] == pytest.approx(found.z[:, -1], rel=1e-9)


def test_stiffness_and_loads_together_leave_the_shape() -> None:
    found = solve(TABLE).sensitivity(["E", "F1", "F2", "F3"], ["height", "turns_around", "kappa_max"])
    values = np.array([TABLE.rod.E, TABLE.given.F1, TABLE.given.F2, TABLE.given.F3])
    for name in ALONG:
        parts = getattr(found, name) * values[:, None]
        assert np.abs(parts.sum(axis=0)).max() < 1e-11 * np.abs(parts).max()
    for value in found.observables.values():
        assert abs((value * values).sum()) < 1e-10 * np.abs(value * values).max()


def test_the_response_of_the_displacements_to_the_dead_loads_is_symmetric() -> None:
    case = ends_in_units_of_rho(*FILE["reference"])
    for one in equilibria(case, stations=3)[::7]:
        found = one.solution.sensitivity(["FZ", "MZ", "M3"])
        K = np.stack([found.z[:, -1], found.alpha[:, -1], found.gamma[:, -1]])
        assert np.abs(K - K.T).max() < 1e-10 * np.abs(K).max()


def test_a_rod_of_ten_thousand_radii_loses_no_digit_to_its_length() -> None:
    long = Case(replace(TABLE.rod, L=1e4), TABLE.cylinder, TABLE.given)
    near = Case(replace(TABLE.rod, L=1e4 + 1e-3), TABLE.cylinder, TABLE.given)
    solution = solve(long, stations=3)
    found = solution.sensitivity(["E", "F1", "F2", "F3", "L"], ["height"])
    values = np.array([TABLE.rod.E, TABLE.given.F1, TABLE.given.F2, TABLE.given.F3])
    parts = found.beta[:4] * values[:, None]
    assert np.abs(parts.sum(axis=0)).max() < 1e-9 * np.abs(parts).max()
    longer = observe(solve(near, stations=3), ["height"])["height"] - observe(solution, ["height"])["height"]
    assert found.observables["height"][4] == pytest.approx(longer / 1e-3, abs=2e-3)  # the second derivative


def test_a_case_that_was_not_solved_has_no_derivatives_and_says_why() -> None:
    """A march too inaccurate on the longer rod, whose derivatives are known all the same."""
    case = in_units_of_rho(0.1, 0.2, 0.3, np.array([5.0, 400.0]), 0.5, 0.1)
    found = solve(case, stations=3, tol=1e-7, method="rk4", steps=2000).sensitivity(["E"], ["height"])
    assert found.solved.tolist() == [True, False]
    assert np.isnan(found.beta[1]).all()
    assert np.isnan(found.observables["height"]).tolist() == [[False], [True]]
    assert found.outcome[1].startswith("failed: error")


def test_at_a_fold_the_outcome_says_so() -> None:
    # a straight rod that is about to buckle
    case = ends_in_units_of_rho(0.0, 0.0, -0.2, np.pi / np.sqrt(0.2) * (1 - 1e-8), 0.0, 0.0)
    solution = next(one.solution for one in equilibria(case, stations=3) if one.stray < 1e-9)
    assert solution.solved
    found = solution.sensitivity(["FZ"])
    assert not found.solved
    assert "fold" in found.outcome
    assert np.isnan(found.beta).all()


def test_an_extreme_that_two_places_reach_has_a_remark() -> None:
    found = solve(START["compressed, symmetric"].case).sensitivity(["E"], ["push_max"])
    assert np.isnan(found.observables["push_max"]).all()
    assert "several places" in found.remarks["push_max"]


def test_the_derivatives_of_a_rod_do_not_depend_on_the_other_rods_of_the_call() -> None:
    """Among them a helix and a rod that is not solved."""
    E, beta, dbeta, F3 = [1e4, 2e4, 1e4, 1e4], [0.5, 0.5, 0.0, 0.5], [0.5, 0.5, 0.0, 1e200], [10.0, 10.0, 5.0, 10.0]
    cases = [
        Case(Rod(E=stiff, nu=0.25, a=0.25, L=20.0), Cylinder(0.75), Start(angle, rate, F3=force, M3=0.0))
        for stiff, angle, rate, force in zip(E, beta, dbeta, F3, strict=True)
    ]
    together = Case(Rod(E=E, nu=0.25, a=0.25, L=20.0), Cylinder(0.75), Start(beta, dbeta, F3=F3, M3=0.0))
    names = [name for name, row in OBSERVABLES.items() if not (row.free or name in NOWHERE)]
    found = solve(together, stations=7).sensitivity(("R", "beta0", "F3"), names)
    assert found.solved.tolist() == [True, True, True, False]
    for i, case in enumerate(cases):
        own = solve(case, stations=7).sensitivity(("R", "beta0", "F3"), names)
        for array in ALONG:
            np.testing.assert_array_equal(getattr(found, array)[i], getattr(own, array))
        for name in names:
            np.testing.assert_allclose(found.observables[name][i], own.observables[name], rtol=1e-12, atol=1e-14)


def test_extremes_of_a_ring_answer_what_leaves_it_a_ring() -> None:
    """A change of beta acts to second order on kappa = sin(beta)^2/rho and on the push F3/rho."""
    case = Case(Rod(E=1e4, nu=0.25, a=0.25, L=20.0), Cylinder(0.75), Start(np.pi / 2, 0.0, F3=1.0, M3=0.0))
    fields = ["E", "R", "F3", "L", "beta0", "M3"]
    rates = solve(case).sensitivity(fields, ["kappa_max", "push_max"])
    np.testing.assert_allclose(rates.observables["kappa_max"], [0, -1, 0, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(rates.observables["push_max"], [0, -1, 1, 0, 0, 0], atol=1e-12)


def test_a_batch_has_the_derivatives_of_each_of_its_rods() -> None:
    """The first rod stays near a saddle: beta'(0) alone does not say where its orbit ends."""
    cylinder, rod = Cylinder(R=0.8), {"EI": 0.58, "GJ": 0.45, "a": 0.05}
    ends = [(-0.66, -1.02, 0.68, 0.29, 0.18), (0.2, 0.5, 0.1, 0.0, 0.0)]
    names = ("beta0", "betaL", "FZ", "MZ", "M3")
    given = Ends(**dict(zip(names, np.transpose(ends), strict=True)))
    batch = solve(Case(Rod(**rod, L=21.0), cylinder, given)).sensitivity(["L", "M3"])
    for i, numbers in enumerate(ends):
        alone = solve(Case(Rod(**rod, L=21.0), cylinder, Ends(**dict(zip(names, numbers, strict=True)))))
        found = alone.sensitivity(["L", "M3"])
        assert found.solved
        np.testing.assert_array_equal(batch.beta[i], found.beta)
        np.testing.assert_array_equal(batch.z[i], found.z)
