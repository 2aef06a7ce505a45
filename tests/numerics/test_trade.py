"""Accuracy against cost: what is measured, against what, and that nothing which failed is left out."""

import itertools
import json
from dataclasses import replace
from importlib.resources import files
from itertools import pairwise

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Solution, solve
from solver.methods import METHODS, available
from solver.methods.method import Ladder, tens
from solver.problem.dimensionless import reduce
from tests.cases import EXACT, elliptic, in_units_of_rho
from workbench.lab import benchmark
from workbench.lab.benchmark import BenchmarkRow, cheapest, drift, errors_against, measure
from workbench.lab.trade_runs import CASES, FILE, ladders_of, reference

DATA = json.loads((files("workbench.lab") / FILE).read_text(encoding="utf-8"))
MARCHES = {"euler": 1, "verlet": 4, "rk4": 4}
SHORT = {
    "euler": Ladder("euler", "steps", (1, 4)),
    "rk4": Ladder("rk4", "steps", (1, 2)),
    "verlet extrapolated": Ladder("verlet", "steps", (1, 2)),
    "dop853": Ladder("dop853", "rtol", tens(2, 8, 3)),
    "lsoda": Ladder("lsoda", "rtol", tens(2, 8, 3)),
    "orbit": Ladder("orbit", "tol", tens(1, 9, 4)),
    "difference": Ladder("difference", "nodes", (129, 257), {"extrapolate": False}),
    "collocation": Ladder("collocation", "rtol", tens(1, 7, 3)),
    "shooting": Ladder("shooting", "tol", (1e-6,)),
}


def asked(*names: str) -> dict:
    return {name: (CASES[name].case, reference(name), CASES[name].slope) for name in names}


@pytest.fixture(scope="module")
def rows() -> list[BenchmarkRow]:
    return measure(asked("force-first/tension", "gap 1e-06", "ends table 1"), SHORT)


# the references


@pytest.mark.parametrize("name", CASES)
def test_each_reference_belongs_to_its_case_as_it_is_now(name: str) -> None:
    problem = reduce(CASES[name].case)
    numbers = [float(v[0]) for v in (problem.lam, problem.mu, problem.phi, problem.span, problem.beta0)]
    # loads are sums that cancel: rounding is against the largest
    np.testing.assert_allclose(numbers, DATA["cases"][name]["numbers"], rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("name, named", [("elliptic", "elliptic k=0.25 L=20"), ("catenary", "catenary")])
def test_the_references_of_exact_cases_are_the_closed_forms(name: str, named: str) -> None:
    known, s = reference(name), reference(name).u * 20.0
    for found, exact in zip((known.beta, known.alpha, known.z), EXACT[named].exact(s), strict=True):
        # rounding of the start, grown
        np.testing.assert_allclose(found, exact, atol=1e-15 * (10 + known.condition))
    sine, eta = np.sin(known.beta), {"elliptic": -1 / 16, "catenary": 0.0}[name]
    # section 2 without loads: FY = -s^3, H = -2 c s^3, beta_t^2 = eta + s^4
    contact = -(sine**4) - 6 * sine**4 * (1 - sine**2) - 3 * (eta + sine**4) * (1 - 2 * sine**2)
    np.testing.assert_allclose(known.contact, contact, atol=1e-14)


# the methods of the ladder


def short_rod(method: str, **knobs: object) -> float:
    """The error of beta of a march along two radii of the elliptic rod, at eleven stations."""
    sol = solve(in_units_of_rho(0, 0, 0, 2.0, np.pi / 6, 0.0), tol=0.5, method=method, stations=11, **knobs)
    return float(np.abs(sol.beta - elliptic(sol.s)[0]).max())


@pytest.mark.parametrize("method, order", MARCHES.items())
def test_a_march_has_the_order_that_it_states(method: str, order: int) -> None:
    assert METHODS[method].order == order
    first = 40 if order == 1 else 2
    errors = [short_rod(method, steps=steps) for steps in (first, 2 * first, 4 * first)]
    np.testing.assert_allclose(np.log2(errors[:-1]) - np.log2(errors[1:]), order, atol=0.12)  # next power of h


def test_a_hard_case_costs_its_neighbours_in_a_batch_no_step() -> None:
    easy, hard = ((0.5, 0.1), (0.5, 8.0))
    grid = in_units_of_rho(0.1, 0.2, 0.3, 5.0, *np.transpose([easy, hard]))
    both = solve(grid, tol=1e-6, method="rk4", stations=11)
    alone = solve(in_units_of_rho(0.1, 0.2, 0.3, 5.0, *easy), tol=1e-6, method="rk4", stations=11)
    assert both.evaluations[0] == alone.evaluations < both.evaluations[1]


@pytest.mark.parametrize("method", ["dop853", "lsoda"])
def test_an_adaptive_method_states_an_error_however_loose_its_tolerance(method: str) -> None:
    """The yardstick is another run; at the loosest tolerance it must not be the same one."""
    for options in ({"tol": 0.9}, {"tol": 0.9, "rtol": 0.5}):
        case, known, _ = asked("catenary")["catenary"]
        sol = solve(case, method=method, **options)
        assert errors_against(sol, known)["error_beta"] <= 10 * sol.error


def test_collocation_follows_its_tolerance_and_says_when_nothing_is_there_to_solve() -> None:
    case, known, slope = asked("ends elliptic")["ends elliptic"]
    errors = []
    for tol in (1e-4, 1e-6, 1e-8):
        sol = solve(case, tol=tol, method="collocation", seed=slope)
        assert sol.solved
        errors.append(errors_against(sol, known)["error_beta"])
        assert errors[-1] <= tol * sol.condition
    assert errors[2] < 1e-2 * errors[0]


@pytest.mark.parametrize("tol", [1e-3, 1e-5, 1e-7])
def test_collocation_states_its_error_also_where_its_first_mesh_meets_the_tolerance(tol: float) -> None:
    """There two runs on that mesh agree to rounding, and say nothing of the error that they share."""
    ends = Ends(beta0=0.5, betaL=0.8, FZ=-8.66, M3=6.1, MZ=1.3)
    case = Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=10.0), Cylinder(R=0.75), ends)
    sol, exact = solve(case, tol=tol, method="collocation"), solve(case, tol=1e-12)
    off = max(np.abs(sol.beta - exact.beta).max(), np.abs(sol.alpha - exact.alpha).max() / 10)
    assert 1e-13 < off <= sol.error <= tol


def test_heyoka_where_it_is_not_installed_is_refused_with_how_to_get_it(monkeypatch) -> None:
    monkeypatch.setattr(METHODS["heyoka"], "requires", "a_package_that_nobody_has")
    assert "heyoka" not in benchmark.available_ladders()
    with pytest.raises(InputError, match=r"not installed: pip install 'rod-workbench\[taylor\]'"):
        solve(EXACT["catenary"].case, method="heyoka")
    for other in ("rk5", "difference"):  # a refusal has the same choices anywhere
        with pytest.raises(InputError, match="heyoka"):
            solve(EXACT["catenary"].case, method=other)
    with pytest.raises(InputError, match="heyoka"):
        ladders_of(["rk5"])


@pytest.mark.skipif("heyoka" not in available(), reason="the extra taylor is not installed")
@pytest.mark.parametrize("name", ["force-first/tension", "catenary", "long"])
def test_heyoka_meets_its_tolerance(name: str) -> None:
    sol = solve(CASES[name].case, tol=1e-10, method="heyoka")
    assert errors_against(sol, reference(name))["error_beta"] <= 1e-10 * sol.condition


# measuring


def test_what_a_method_says_of_its_error_is_honest_on_every_rung_it_calls_solved(rows) -> None:
    for row in rows:
        if row.outcome.startswith("solved"):
            assert row.error <= 10 * row.estimate, row


def test_failures_are_kept_with_what_they_cost(rows) -> None:
    lost = [row for row in rows if row.case == "gap 1e-06" and row.ladder == "euler"]
    assert all(row.error > 0.1 and row.seconds > 0 and row.evaluations > 0 for row in lost)


def test_a_rung_that_would_take_too_many_evaluations_is_named_and_not_run() -> None:
    first, second = measure(asked("catenary"), {"rk4": Ladder("rk4", "steps", (1, 2), most=3000)})
    assert first.outcome.startswith("solved")
    assert second.outcome == "not run: it would take more than 3000 evaluations"
    assert np.isnan(second.seconds)


def test_a_ladder_ends_at_the_same_rung_however_slow_the_machine_is(monkeypatch) -> None:
    """A clock that ticks a minute with every look at it stands for a busy machine."""
    ticks = itertools.count(0.0, 60.0)
    monkeypatch.setattr(benchmark.time, "perf_counter", lambda: next(ticks))
    rungs = measure(asked("catenary"), {"euler": Ladder("euler", "steps", (1, 2, 4), most=2000)})
    assert [row.outcome.startswith("not run") for row in rungs] == [False, False, True]
    assert rungs[0].seconds == 60.0


def test_more_of_a_knob_is_more_accurate_and_costs_more_evaluations(rows) -> None:
    for label in ("rk4", "verlet extrapolated", "dop853", "difference"):
        case = "ends table 1" if label == "difference" else "force-first/tension"
        some = [row for row in rows if row.case == case and row.ladder == label]
        assert all(a.error > b.error for a, b in pairwise(some)), label
        assert some[0].evaluations < some[-1].evaluations


def test_loads_worked_out_from_the_forces_hold_with_any_method_but_h_only_with_a_good_one(rows) -> None:
    """FZ and MZ follow from beta by statics, so they hold to rounding however wrong beta is: they prove nothing."""
    for row in rows:
        assert row.drift_FZ < 1e-13
        assert row.drift_MZ < 1e-13
    worst = {label: max(r.drift_h for r in rows if r.ladder == label) for label in ("euler", "orbit")}
    assert worst["euler"] > 1e-2
    assert worst["orbit"] < 1e-7


def shaken(sol: Solution, **columns: np.ndarray) -> Solution:
    """The solution with something added to columns of its trajectory."""
    kept = {name: getattr(sol.trajectory, name) + added for name, added in columns.items()}
    return replace(sol, trajectory=replace(sol.trajectory, **kept))


def test_an_error_put_in_is_the_error_found() -> None:
    case, known, _ = asked("force-first/tension")["force-first/tension"]
    sol = solve(case, tol=1e-12)
    bump = 1e-3 * np.linspace(0, 1, 201)  # grows from the start, where the azimuth is counted from
    assert errors_against(shaken(sol, beta=bump), known)["error_beta"] == pytest.approx(1e-3)
    assert errors_against(shaken(sol, z=bump), known)["error_position"] == pytest.approx(1e-3 / 20)  # L = 20 rho
    assert errors_against(shaken(sol, alpha=bump), known)["error_position"] == pytest.approx(1e-3 / 20)
    assert errors_against(shaken(sol, dbeta=bump), known)["error_contact"] > 1e-6
    assert drift(shaken(sol, dbeta=bump))["drift_h"] > 1e-5


def test_what_is_not_finite_is_infinitely_wrong() -> None:
    case, known, _ = asked("catenary")["catenary"]
    broken = shaken(solve(case), beta=np.where(np.arange(201) == 200, np.nan, 0.0))
    assert errors_against(broken, known)["error_beta"] == np.inf
    assert drift(broken)["drift_h"] == np.inf


def test_the_cheapest_is_solved_meets_the_level_and_takes_least(rows) -> None:
    def row(ladder: str, seconds: float, error: float, solved: bool = True) -> BenchmarkRow:
        return replace(rows[0], ladder=ladder, seconds=seconds, error_beta=error, error_position=0.0, solved=solved)

    some = [row("slow", 3.0, 1e-9), row("coarse", 0.1, 1e-2), row("lucky", 0.2, 1e-9, False), row("a", 2, 1e-4)]
    assert cheapest(some, 1e-3)[rows[0].case].ladder == "a"
    assert cheapest(some, 1e-6)[rows[0].case].ladder == "slow"
    assert cheapest(some, 1e-12) == {rows[0].case: None}


def test_errors_and_drifts_do_not_depend_on_the_units() -> None:
    """Lengths four times and forces twice as large: powers of two, so the numbers are the same but for rounding."""
    case, known, _ = asked("force-first/tension")["force-first/tension"]
    rod, given = case.rod, case.given
    larger = replace(rod, E=rod.E / 8, a=4 * rod.a, L=4 * rod.L)
    loads = replace(given, dbeta=given.dbeta / 4, F1=2 * given.F1, F2=2 * given.F2, F3=2 * given.F3)
    other = Case(larger, replace(case.cylinder, R=4 * case.cylinder.R), loads)
    mine, theirs = (solve(one, method="rk4", steps=1, stations=201) for one in (case, other))
    assert min(drift(mine).values()) > 0
    assert drift(theirs) == pytest.approx(drift(mine), rel=1e-6, abs=1e-13)
    assert errors_against(theirs, known) == pytest.approx(errors_against(mine, known), rel=1e-6, abs=0)
