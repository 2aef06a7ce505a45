"""Steps along branches by the compiled core: the branches of the steps in Python, and no crash on odd numbers."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, equilibria, follow, solve
from solver.branches.branch_events import Bounds, Place
from solver.branches.branch_following import trace_branch
from solver.branches.family import Family, dead_numbers
from solver.choose.selection import path_of_seed
from solver.core.branches import RECORD, Point, Steps, chart_of
from solver.core.varied_orbits import orbit_rates
from solver.equilibrium.charts import Chart
from solver.equilibrium.given_numbers import FREE, Given
from solver.equilibrium.orbit_rates import HOW
from solver.levels.line_point import Path
from solver.levels.transit_times import CUTTING, NODES
from solver.orbit.variations import POINTS
from solver.problem.case_fields import unchecked_with_field, value_of
from solver.problem.reduced import numbers_over, reduce, reduce_held
from solver.solve import between_ends, seed_of
from tests.numerics.test_core_fuzz import ODD, odd

ROD, CYLINDER = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0), Cylinder(R=0.75)
DEAD = Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.8, FZ=-8.66, MZ=1.3, M3=6.1))


@pytest.mark.parametrize("case", [
    DEAD,
    Case(Rod(EI=33.0, GJ=26.0, a=0.25, L=20.0), Cylinder(R=0.75, side="inside"), DEAD.given),
    Case(Rod(E=1.07e4, nu=0.25, a=0.25, inner_radius=0.2, L=20.0), CYLINDER, DEAD.given),
])  # fmt: skip
def test_numbers_over_a_field_are_those_of_the_reduced_problem_to_the_bit(case: Case) -> None:
    names = [name for name, value in (*case.rod.given(), ("R", 0.75)) if value is not None]
    for name in (*names, "beta0", "betaL", "FZ", "MZ", "M3", "alpha0"):
        for factor in (1.0, 1.0173):
            value = factor * value_of(case, name)
            problem = reduce(unchecked_with_field(case, name, value))
            assert list(dead_numbers(numbers_over(case, name), value)) == [
                float(v[0]) for v in vars(problem).values()
            ], name


def test_held_numbers_over_a_field_are_those_of_the_held_problem_to_the_bit() -> None:
    case = Case(ROD, CYLINDER, Ends(beta0=0.5, M1L=0.3, MZ=1.3, M3=6.1, height=9.0))
    for name in ("E", "a", "L", "R", "beta0", "M1L", "height", "MZ", "M3"):
        value = 1.0173 * value_of(case, name)
        held = reduce_held(unchecked_with_field(case, name, value))
        wanted = [*held.values[0].tolist(), float(held.span[0]), float(held.ratio[0])]
        assert list(numbers_over(case, name)(value)) == wanted, name


def same_branch(one: list[Place], other: list[Place], wanted: list[float]) -> None:
    """The same equilibria at the wanted values, with the same special points in the same order."""
    assert [place.kind for place in one if place.kind] == [place.kind for place in other if place.kind]
    for value in wanted:
        here, there = ([place for place in places if place.p == value] for places in (one, other))
        assert len(here) == len(there)
        for a, b in zip(here, there, strict=True):
            assert (a.path.leaving, a.path.turns, a.index) == (b.path.leaving, b.path.turns, b.index)
            for name in ("lam", "mu", "phi", "beta0", "betaL", "span"):
                assert getattr(a.problem, name) == pytest.approx(getattr(b.problem, name), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("which", [slice(3, 4), pytest.param(slice(None), marks=pytest.mark.slow)])
def test_branches_under_dead_loads_are_those_of_the_steps_in_python(which: slice) -> None:
    wanted = np.linspace(-8.66, 0.0, 9).tolist()
    bounds, many = Bounds(-8.66, 0.0, tuple(wanted), 400), 0
    fast = partial(dead_numbers, numbers_over(DEAD, "FZ"))

    def given(value: float) -> Given:
        return Given.dead(reduce(unchecked_with_field(DEAD, "FZ", value)))

    for one in list(equilibria(DEAD))[which]:
        begun = between_ends(one.solution)
        path = path_of_seed(seed_of(DEAD, begun, one.solution))
        plain, quick = (Family(given, begun, 1.0, FREE, numbers) for numbers in (None, fast))
        assert plain.steps is None
        assert quick.steps is not None
        (here, stop), (there, end) = (trace_branch(one, path, -8.66, True, bounds) for one in (quick, plain))
        assert stop.reason == end.reason
        same_branch(here, there, wanted)
        many += len(here)
    assert many >= 8


@pytest.mark.parametrize("held", [("height",), ("azimuth", "rotation"), ("height", "M1L")])
def test_branches_with_held_ends_are_those_of_the_steps_in_python(held: tuple[str, ...]) -> None:
    start = list(equilibria(DEAD))[4].solution
    own = {"height": float(start.z[-1]), "azimuth": float(start.alpha[-1]), "rotation": float(start.gamma[-1]),
           "M1L": ROD.bending_stiffness * float(start.dbeta[-1])}  # fmt: skip
    loads = {"height": "FZ", "azimuth": "MZ", "rotation": "M3", "M1L": "betaL"}
    given = {"beta0": 0.5, "betaL": 0.8, "FZ": -8.66, "MZ": 1.3, "M3": 6.1}
    given = {name: v for name, v in given.items() if name not in [loads[one] for one in held]}
    case = Case(ROD, CYLINDER, Ends(**given, **{one: own[one] for one in held}))
    solution = solve(case, seed=start)
    assert solution.solved
    begun, low, high = between_ends(solution), own[held[0]] - 0.4, own[held[0]]
    path = path_of_seed(seed_of(case, begun, solution))
    wanted = np.linspace(low, high, 4).tolist()

    def numbers(value: float) -> Given:
        return Given.of(reduce_held(unchecked_with_field(case, held[0], value)))

    names = numbers(high).names
    families = (
        Family(numbers, begun, 1.0, names, numbers_over(case, held[0])),
        Family(numbers, begun, 1.0, names),
    )
    bounds = Bounds(low, high, tuple(wanted), 60)
    (here, stop), (there, end) = (trace_branch(one, path, high, False, bounds) for one in families)
    assert stop.reason == end.reason == "the end of the range"
    same_branch(here, there, wanted)


def test_what_the_problem_raises_passes_through_the_core() -> None:
    def numbers(value: float) -> Any:
        raise KeyError(value)

    steps = Steps(numbers, 1.0, NODES, (CUTTING, CUTTING))
    with pytest.raises(KeyError):
        steps.excess(chart_of(Chart("start", Path(0.5, 1.0, 0.0, 1, 2), 1.0, False)), 0.0, np.array([1.0]))


@pytest.mark.parametrize("seed", range(3))
def test_odd_numbers_end_in_an_answer_or_in_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first = np.zeros(1, RECORD)
    for _ in range(60):
        numbers = np.where(rng.random(7) < 0.5, odd(rng, 7), rng.uniform(0.1, 2, 7))
        level = np.where(rng.random(3) < 0.3, rng.choice(ODD, 3), rng.uniform(-1, 1, 3))
        path = Path(float(level[0]), 1.0 if level[1] > 0 else -1.0, float(level[2]), 1, int(rng.integers(0, 5)))
        found = orbit_rates(numbers[:6].tolist(), path, POINTS, HOW)
        assert found is None or found[0].shape == (11,)
        chart = Chart(str(rng.choice(["saddle", "start", "end"])), path, 1.0, bool(rng.random() < 0.5))
        for held in (None, (0, 1, 6, 7, 8), (2, 1, 6, 4, 11)):
            count = 7 if held else 6
            steps = Steps(lambda p, one=numbers[:count]: one + 1e-3 * p, 1.0, POINTS, HOW, held)
            at = Point(sign=1.0, ahead=1e-6, chart=chart_of(chart))
            at.w[:], at.tangent[:] = rng.normal(size=7).tolist(), [0, 1, 0, 0, 0, 0, 0]
            at.jacobian[:] = rng.normal(size=42).tolist()
            found, *_ = steps.run(at, 0.02, 0, first, 5, np.array([-1.0, 1.0]), 1e-15, 1.0)
            assert found.size <= 5


def test_a_branch_of_many_points_takes_several_calls() -> None:
    start = list(equilibria(DEAD))[2].solution
    branch = follow(start, FZ=np.linspace(-8.66, 0.0, 600))
    assert len(branch) >= 600
    assert branch.end.reason == branch.begin.reason == "the end of the range"
    last = branch.points[-1].solution
    again = solve(replace(DEAD, given=replace(DEAD.given, FZ=branch.points[-1].value)), seed=last)
    np.testing.assert_allclose(again.beta, last.beta, atol=1e-9)
