"""A grid of cases is solved as each of them alone, and one that fails leaves its neighbours alone."""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Start, solve
from solver.methods import DOP853
from solver.observe.observables import OBSERVABLES, observe
from solver.problem.dimensionless import reduce
from tests.cases import in_units_of_rho
from tests.raising import LENGTHS, RAISING, make_raise
from tests.reach import core

SOME = "<Solution by {}: 2 of 3 cases solved, shape (3,)"
WEIGHT = {"weight": 0.1}
LIES = {"inclination": "90deg"}
# of each column: the function that raises, the rod, the cylinder, what is given, and the method
COLUMNS: dict[str, tuple[str, dict[str, Any], dict[str, Any], Start | Ends, str]] = {
    "start": ("methods.half_period.march_orbit", {}, {}, Start(0.5, 0.5, F3=10.0, M3=0.0), "auto"),
    "start by steps": ("methods.marching.Verlet.run", {}, {}, Start(0.5, 0.5, F3=10.0, M3=0.0), "verlet"),
    "dead loads": ("methods.shooting.selection_of", {}, {}, Ends(0.5, 0.8, FZ=-8.66), "auto"),
    "dead loads on a mesh": ("methods.method.select_seed", {}, {}, Ends(0.5, 0.8, FZ=-8.66), "difference"),
    "held": ("held.held_equilibrium.by_rule", {}, {}, Ends(0.5, 0.8, height=4.0), "auto"),
    "start with weight": ("nodes.loaded_solutions.starts_of", WEIGHT, LIES, Start(0.5, 0.5, F3=1.0, M3=0.0), "auto"),
    "weight": ("nodes.loaded_solutions.find_shape", WEIGHT, LIES, Ends(0.0, 0.0, FZ=-1.0), "auto"),
    "friction": ("nodes.loaded_solutions.estimate", {}, {"friction": 0.2}, Ends(0.3, 0.5, FZ=-1.0), "auto"),
}

STARTS = core("start")
KNOBS: dict[str, dict[str, Any]] = {"verlet": {"steps": 4}}  # else the worst of a batch sets its steps
TOL = {"orbit": 1e-10, "dop853": 1e-7}


def run(case: Case, method: str, **more: Any) -> Any:
    return solve(case, tol=TOL.get(method, 1e-3), method=method, stations=101, **KNOBS.get(method, {}), **more)


def grid() -> Case:
    """E down, beta across: three by two cases of every kind of orbit."""
    E = np.array([[5e3], [1e4], [4e4]])
    beta = np.array([0.3, 2.5])
    return Case(Rod(E, 0.25, 0.25, 20.0), Cylinder(0.75), Start(beta, 0.5, F3=10.0, dgamma=0.5))


def alone(case: Case, i: int, j: int) -> Case:
    return Case(
        Rod(float(case.rod.E[i, 0]), 0.25, 0.25, 20.0),
        case.cylinder,
        Start(float(case.given.beta[j]), 0.5, F3=10.0, dgamma=0.5),
    )


@pytest.mark.parametrize("method", STARTS)
def test_a_grid_holds_what_its_cases_are_alone(method: str) -> None:
    case = grid()
    together = run(case, method)
    assert together.beta.shape == (3, 2, 101)
    assert together.position.shape == (3, 2, 101, 3)
    assert together.material_frame.shape == (3, 2, 101, 3, 3)
    assert together.error.shape == together.condition.shape == together.outcome.shape == together.FZ.shape == (3, 2)
    for i in range(3):
        for j in range(2):
            one = run(alone(case, i, j), method)
            assert together.outcome[i, j] == one.outcome
            # the same numbers in another order: rounding, grown
            atol = 1e-13 * float(one.condition)
            for field in ("s", "beta", "dbeta", "alpha", "z", "gamma", "F1", "F2", "F3", "contact", "kappa", "h"):
                whole, part = getattr(together, field)[i, j], getattr(one, field)
                np.testing.assert_allclose(whole, part, atol=atol * (1 + np.abs(part).max()), err_msg=field)


def test_every_field_may_be_an_axis() -> None:
    plain = {"E": 1e4, "nu": 0.25, "a": 0.25, "L": 20.0}
    start = {"beta": 0.5, "dbeta": 0.5, "F2": 1.0, "F3": 10.0, "dgamma": 0.5, "alpha": 0.1, "gamma": 0.2}
    for field in (*plain, *start, "R"):
        rod = Rod(**{k: v * np.array([1.0, 1.1]) if k == field else v for k, v in plain.items()})
        given = Start(**{k: v * np.array([1.0, 1.1]) if k == field else v for k, v in start.items()})
        R = 0.75 * np.array([1.0, 1.1]) if field == "R" else 0.75
        sol = solve(Case(rod, Cylinder(R), given), tol=1e-6, stations=5)
        assert sol.beta.shape == (2, 5)
        assert sol.solved.all()
        assert np.isfinite(sol.contact).all()
        assert np.isfinite(sol.gamma).all()


LONG = pytest.param("dop853", 1e200, marks=pytest.mark.slow)  # it spends its whole budget of steps first


@pytest.mark.parametrize("method, bad", [("orbit", 1e200), ("verlet", 1e200), LONG, *((m, 1e308) for m in STARTS)])
def test_a_case_that_fails_says_so_and_leaves_its_neighbours_alone(method: str, bad: float) -> None:
    F3 = np.array([10.0, bad, -10.0])
    make = lambda F3: Case(Rod(1e4, 0.25, 0.25, 20.0), Cylinder(0.75), Start(0.5, 0.5, F3=F3, dgamma=0.5))  # noqa: E731
    with warnings.catch_warnings():
        # the default method is quiet; what scipy says of numbers beyond its reach is another matter
        warnings.simplefilter("error" if method == "orbit" else "ignore")
        sol = run(make(F3), method)
    assert list(sol.solved) == [True, False, True]
    assert sol.outcome[1].startswith("failed")
    for i in (0, 2):
        one = run(make(float(F3[i])), method)
        np.testing.assert_allclose(sol.beta[i], one.beta, atol=1e-13 * float(one.condition))


@pytest.mark.parametrize("method", [m for m in ("orbit", "swing") if m in STARTS])
@pytest.mark.parametrize("bad", [1e200, 1e308])
def test_what_is_read_of_a_rod_does_not_hang_on_a_neighbour_beyond_all_numbers(method: str, bad: float) -> None:
    slopes = np.array([0.5, bad, 0.6])
    make = lambda v: Case(Rod(1e4, 0.25, 0.25, 400.0), Cylinder(0.75), Start(0.5, v, F3=10.0, M3=2.0))  # noqa: E731
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        together = observe(solve(make(slopes), method=method, stations=5), OBSERVABLES)
        both = observe(solve(make(slopes[[0, 2]]), method=method, stations=5), OBSERVABLES)
        none = observe(solve(make(bad), method=method, stations=5), OBSERVABLES)
    for name, values in together.items():
        # a block's products round differently among other neighbours
        np.testing.assert_allclose(values[[0, 2]], both[name], rtol=1e-9, err_msg=name)
        assert np.isnan([values[1], none[name]]).all(), name


@pytest.mark.parametrize("method", ("dop853", "lsoda"))
def test_an_adaptive_march_says_that_its_budget_is_spent(method: str, monkeypatch) -> None:
    monkeypatch.setattr("solver.methods.adaptive._MOST_CALLS", 3000)
    assert "evaluations" in solve(in_units_of_rho(0, 0, -1e4, 20.0, 0.3, 0.2), method=method).outcome


def test_an_adaptive_march_says_that_the_numbers_ended_or_the_integrator_gave_up() -> None:
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # scipy speaks of what the outcome says
        problem = reduce(in_units_of_rho(0, 0, 0, 20.0, 0.3, 1e200))  # `solve` would refuse it
        (outcome,) = DOP853().run(problem, np.array([[0.0, 20.0]]), 1e-8).outcome
    assert "finite" in outcome or "gave up" in outcome
    assert "evaluations" not in outcome


def test_a_thousand_cases_of_every_kind_are_solved_at_once() -> None:
    rng = np.random.default_rng(1)
    lam, mu, phi = rng.uniform(-2, 2, (3, 1000))
    case = in_units_of_rho(lam, mu, phi, 15.0, rng.uniform(-3, 3, 1000), rng.uniform(-2, 2, 1000))
    sol = solve(case, tol=1e-8, stations=51)
    assert sol.solved.all(), sol.outcome[~sol.solved]
    h = sol.h - sol.h[:, :1]
    assert np.abs(h).max() < 1e-9 * np.abs(sol.h).max()


def patch_column(name: str, error: BaseException, monkeypatch: pytest.MonkeyPatch) -> Callable[[Any], Any]:
    """Make a column raise for one rod; returns how its rods of some lengths are solved."""
    target, rod, cylinder, given, method = COLUMNS[name]
    make_raise(f"solver.{target}", error, monkeypatch)

    def solved(L: Any) -> Any:
        case = Case(Rod(1.07e4, 0.25, 0.25, L, **rod), Cylinder(0.75, **cylinder), given)
        return solve(case, tol=1e-4, method=method, stations=11)

    return solved


@pytest.mark.parametrize("name", COLUMNS)
def test_what_a_column_raises_is_the_outcome_of_that_case_alone(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    solved = patch_column(name, ValueError("need at least\none array"), monkeypatch)
    together, alone = solved(LENGTHS), solved(RAISING)
    words = "failed: the solver raised ValueError (need at least one array) in "
    assert alone.outcome == together.outcome[1]
    assert alone.outcome.startswith(words)
    assert alone.outcome.endswith("this is a fault of the solver, not of the case: please report it")
    assert together.solved.tolist() == [True, False, True]
    assert not alone.solved
    seen, nothing = observe(together, OBSERVABLES), observe(alone, OBSERVABLES)
    for i in (0, 2):
        one = solved(float(LENGTHS[i]))
        assert one.outcome == together.outcome[i]
        np.testing.assert_allclose(together.beta[i], one.beta, atol=1e-12)
        np.testing.assert_allclose(together.contact[i], one.contact, atol=1e-9)
        for field, value in observe(one, OBSERVABLES).items():
            np.testing.assert_allclose(seen[field][i], value, rtol=1e-9, atol=1e-9, err_msg=field)
    for sol, i in ((together, 1), (alone, 0)):
        for value in (sol.beta, sol.gamma, sol.contact, sol.error, sol.condition, sol.held_index):
            assert not np.isfinite(np.reshape(value, (sol.case.size, -1))[i]).any()
        assert [np.ravel(stretches)[i] for stretches in (sol.states, sol.lift_offs)] == [None, None]
    assert (repr(together).split(";")[0], "raised" in repr(alone)) == (SOME.format(together.method), True)
    assert all(np.isnan([seen[field][1], nothing[field]]).all() for field in seen)


@pytest.mark.parametrize(
    "error", [InputError("no"), MemoryError(), KeyboardInterrupt(), OSError("no disk"), UserWarning()]
)
@pytest.mark.parametrize("name", ["start", "held", "weight"])
def test_what_is_no_matter_of_a_case_passes_through(
    name: str, error: BaseException, monkeypatch: pytest.MonkeyPatch
) -> None:
    solved = patch_column(name, error, monkeypatch)
    for L in (LENGTHS, RAISING):
        with pytest.raises(type(error)):
            solved(L)


def ends(betaL: Any) -> Case:
    return Case(Rod(1.07e4, 0.25, 0.25, 6.0, "paper"), Cylinder(0.75), Ends(np.pi / 6, betaL, -8.66, 1.3, 6.1))


@pytest.mark.parametrize("method", core("ends"))
def test_ends_problems_come_in_grids_too(method: str) -> None:
    betaL = np.array([0.6, 0.8])
    together = solve(ends(betaL), tol=1e-6, method=method)
    assert together.solved.all(), together.outcome
    np.testing.assert_allclose(together.beta[:, -1], betaL, atol=1e-9)
    for i in range(2):
        one = solve(ends(float(betaL[i])), tol=1e-6, method=method)
        np.testing.assert_allclose(together.beta[i], one.beta, atol=1e-5)
