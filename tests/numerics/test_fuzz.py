"""The public names under attack: start problems of any size from 1e-300 to 1e300, denormal, zero, alone and in batches.

Nothing but `InputError` may be raised, nothing warned of, nothing that is not finite called solved, and no rod may take
more than its budget. `pytest -m slow tests/numerics/test_fuzz.py` runs 2,000 batches.
"""

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from solver import Case, Cylinder, Ends, InputError, Rod, Solution, Start, equilibria, solve
from solver.core.tuning import MOST_PANELS
from solver.methods import available
from solver.problem.case import TWISTS
from solver.problem.limits import OUT_OF_RANGE
from solver.problem.notices import AngleWarning
from tests.cases import in_units_of_rho

ALONG = (
    *("s", "beta", "dbeta", "alpha", "z", "gamma", "position", "tangent", "normal", "material_frame", "kappa"),
    *("FY", "F1", "F2", "F3", "contact", "push", "M1", "M2", "h"),
)
EACH = ("FZ", "MZ", "M3", "error", "condition", "evaluations")

EDGES = (5e-324, 1e-310, 2.3e-308, 1e-300, 1e-150, 1e-75, 1.0, 1e75, 1e98, 1e99, 1e100, 1e101, 1e150, 1e300, 1.7e308)
ANGLES = (0.0, -0.0, np.pi, -np.pi, np.pi / 2, -np.pi / 2, np.nextafter(np.pi, 4), 2 * np.pi, 5e-324, 1e-150)


def powers(low: float, high: float) -> st.SearchStrategy[float]:
    """Log-uniform."""
    return st.floats(low, high).map(lambda x: float(10.0**x))


sizes = st.one_of(powers(-3, 3), powers(-3, 3), powers(-20, 20), powers(-300, 300), st.sampled_from(EDGES))
numbers = st.one_of(st.just(0.0), st.builds(lambda x, way: way * x, sizes, st.sampled_from([-1.0, 1.0])))
angles = st.one_of(st.floats(-4, 4), st.sampled_from(ANGLES), numbers)
ratios = st.sampled_from([0.25, 0.5, 0.0, -0.5, -0.999999, float(np.nextafter(-1, 0))])
stations = st.one_of(st.sampled_from([2, 3, 5, 33, 201]), st.just(5001), st.lists(st.floats(0, 1), max_size=4))


@dataclass(frozen=True)
class Batch:
    """What one call is given."""

    rod: dict[str, Any]
    cylinder: dict[str, Any]
    start: dict[str, Any]
    stations: Any
    method: str
    tol: float


@st.composite
def batches(draw: Any) -> Batch:
    """One call; its fields are numbers, or arrays of one shape, empty ones too."""
    shape = draw(st.sampled_from([(), (), (1,), (4,), (2, 3), (0,)]))

    def field(of: st.SearchStrategy[float]) -> Any:
        if not shape or draw(st.booleans()):
            return draw(of)
        return np.array([draw(of) for _ in range(int(np.prod(shape)))]).reshape(shape)

    rod = {"E": field(sizes), "nu": field(ratios), "a": field(sizes), "L": field(sizes)}
    side = draw(st.sampled_from(["outside", "inside"]))
    R = field(sizes)
    if side == "inside" and draw(st.booleans()):
        with np.errstate(all="ignore"):
            R = np.broadcast_to(rod["a"], shape) * (1 + draw(powers(-16, 3)))
    start = {"beta": field(angles), **{name: field(numbers) for name in ("dbeta", "F2", "F3", "alpha", "gamma")}}
    start[draw(st.sampled_from(TWISTS))] = field(numbers)
    rod["stiffness"] = draw(st.sampled_from(["solid", "paper"]))
    methods = [name for name in ("orbit", "swing", "auto") if name in (*available(), "auto")]
    some = draw(st.sampled_from(methods)), draw(st.sampled_from([1e-3, 1e-8, 1e-12]))
    return Batch(rod, {"R": R, "side": side}, start, draw(stations), *some)


def attack(batch: Batch) -> Solution | None:
    """The call, every property read; None where it was refused."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", AngleWarning)  # of an angle such as 4.0, which is in rad here
        try:
            case = Case(Rod(**batch.rod), Cylinder(**batch.cylinder), Start(**batch.start))
            sol = solve(case, method=batch.method, stations=batch.stations, tol=batch.tol)
        except InputError:
            return None
        repr(sol)
        sound(sol)
    return sol


def sound(sol: Solution) -> None:
    """Nothing that is not finite in a case called solved; a reason for every other."""
    size = sol.case.size
    solved = np.reshape(sol.solved, -1)
    for name in (*ALONG, *EACH):
        values = np.asarray(getattr(sol, name), dtype=float).reshape(size, -1)
        bad = solved & ~np.isfinite(values).all(axis=1)
        assert not bad.any(), (name, np.reshape(sol.outcome, -1)[bad][0])
    assert all(
        text.startswith("solved" if fine else "failed: ")
        for text, fine in zip(np.reshape(sol.outcome, -1), solved, strict=True)
    )
    assert (np.reshape(sol.evaluations, -1) <= 100 * MOST_PANELS).all()


ROD = {"E": 1e4, "nu": 0.25, "a": 0.25, "L": 20.0}
PLAIN = {"beta": 0.5, "dbeta": 0.0, "M3": 0.0}


def batch_of(rod: Any = None, R: Any = 0.75, start: Any = None, **more: Any) -> Batch:
    told = {"stations": 5, "method": "orbit", "tol": 1e-8, **more}
    return Batch(ROD | (rod or {}), {"R": R, "side": "outside"}, PLAIN | (start or {}), **told)


REFUSED: tuple[str, ...] | None = None
FINE, STIFFNESS, LOADS = ("solved",), ("failed: stiffness, radius",), ("failed: loads, slope or L/rho",)
SEEDS = (  # each with how the outcomes of its cases start
    (batch_of({"a": 1e-100}), STIFFNESS),  # stiffness 0
    (batch_of({"a": 1e-80, "L": 1e-79}, 1e-80), STIFFNESS),  # a denormal stiffness
    (batch_of({"a": 1e80}), STIFFNESS),  # stiffness inf
    (batch_of({"a": 1e300}, 1e300), STIFFNESS),
    (batch_of({"a": 1.7e308}, 1.7e308), STIFFNESS),  # rho inf
    (batch_of({"L": 1e300}, 1e-10), LOADS),
    (batch_of({"L": 1e-300}, start={"dbeta": 1e200}), LOADS),
    (batch_of(start={"dbeta": 1e98, "F2": 1e98}), ("failed: condition above",)),  # contact inf
    (batch_of({"E": 1e200}, start={"F2": 1e250}), STIFFNESS),
    (batch_of(start={"F3": 1e300, "F2": -1e300}), LOADS),
    (batch_of({"L": 1e-6}, start={"beta": -5e-324, "dbeta": -0.0648538285439833, "F2": 0.3}), FINE),
    (batch_of(start={"beta": np.pi, "dbeta": 3e-131, "F3": 4e-31}), FINE),
    (
        batch_of(start={"beta": np.array([0.3, 1e300, -0.0]), "F3": np.array([1e300, 0.0, 5e-324])}),
        LOADS + LOADS + FINE,
    ),
    (batch_of(start={"beta": np.empty(0)}), REFUSED),
    (batch_of({"L": 7e-297}, 1e-14, {"beta": np.pi, "dbeta": 4e1}), LOADS),  # stations that no float tells apart
    (batch_of(stations=[]), REFUSED),
)


@pytest.mark.parametrize(("batch", "starts"), SEEDS)
def test_what_once_brought_a_call_down(batch: Batch, starts: tuple[str, ...] | None) -> None:
    sol = attack(batch)
    assert (sol is None) == (starts is REFUSED)
    if sol is not None and starts is not None:
        outcomes = np.reshape(sol.outcome, -1)
        assert len(outcomes) == len(starts)
        assert all(map(str.startswith, outcomes, starts)), outcomes


# dimensionless numbers that once raised "repeats may not contain negative values", or took the series to NaN
BEYOND, FEWER = "failed: the computation left the finite numbers", "solved; fewer digits than the tolerance"
BROKEN = (
    ((6.420724715344667e85, -0.0, 0.0, 1.0085217508772867e18, np.pi / 2, -1.457673656063506e-126), BEYOND),
    ((0.0, 0.0, 4.083e-31, 1.056e-20, -np.pi, 3.2548512620237157e-131), BEYOND),
    ((-5.383e-12, 5.383e-12, 0.0, 154595.98, 0.0, -9.489095417690253e-154), FEWER),
    ((-2.057986952374532, 2.057986952374532, -0.0, 0.697, np.pi, -8.189421719696215e-146), BEYOND),
    ((6.614e-39, 6.614e-39, -3.658313097555424e-57, 9.69e48, -4.969618981419706e-107, -1.594033414356665e-66), BEYOND),
)


@pytest.mark.parametrize("method", ["orbit", "auto"])
@pytest.mark.parametrize(("numbers", "starts"), BROKEN)
def test_a_speed_whose_square_is_hardly_a_float_brings_no_method_down(
    numbers: tuple[float, ...], starts: str, method: str
) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sol = solve(in_units_of_rho(*numbers), method=method)
    assert str(sol.outcome).startswith(starts)
    sound(sol)


def test_every_scale_of_loads_and_speeds_is_solved_or_refused() -> None:
    """Whole grids of dimensionless numbers, where pairs of them make the orbits that no draw of single fields meets."""
    rng = np.random.default_rng(5)
    n = 60

    def signed(high: float) -> Any:
        return 10 ** rng.uniform(-high, high, n) * rng.choice([-1, 1], n) * (rng.random(n) > 0.2)

    for k, high in enumerate((1, 20, 99, 20, 99)):
        lam, phi, beta = signed(high), signed(high), rng.choice([0, np.pi, -np.pi, 0.3], n)
        mu = np.where(rng.random(n) < 0.5, lam * rng.choice([-1, 1], n), signed(high))
        beta = beta + 10 ** rng.uniform(-300, 0, n) * (rng.random(n) > 0.5)
        v = 10 ** rng.uniform(-299 if k % 2 else -high, high, n)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with np.errstate(all="ignore"):
                case = in_units_of_rho(lam, mu, phi, 10 ** rng.uniform(-high, high, n), beta, v)
            sound(solve(case, stations=9, method="orbit"))


@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(batches())
def test_a_batch_ends_with_outcomes_or_an_input_error(batch: Batch) -> None:
    attack(batch)


@pytest.mark.slow
@settings(max_examples=2000, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(batches())
def test_two_thousand_batches_end_with_outcomes_or_an_input_error(batch: Batch) -> None:
    attack(batch)


@pytest.mark.parametrize("given", (Start(0.5, 0.1, M3=0.0), Ends(0.5, 0.6)))
def test_a_rod_beyond_the_floats_is_refused_and_its_neighbour_is_not_touched(given: Any) -> None:
    """Every size of length, force and stiffness: solved as a rod of metres is, or refused for its units."""
    plain = float(solve(Case(Rod(1e4, 0.25, 0.25, 2.0), Cylinder(0.75), given), stations=5).beta[-1])
    for E in (1e4, 1e285, 1e300, 1e-300):
        both = solve(Case(Rod(np.array([1e4, E]), 0.25, 0.25, 2.0), Cylinder(0.75), given), stations=5)
        assert both.solved[0]
        assert both.beta[0, -1] == pytest.approx(plain, rel=1e-13)
        assert both.solved[1] or both.outcome[1] == f"{OUT_OF_RANGE}; the most extreme field is E = {E:g}"
        sound(both)
        assert both.solved[1] == (E in (1e4, 1e285))


@pytest.mark.parametrize("given", (Ends(0.5, 0.6, FZ=1e200), Ends(0.5, height=1.0, betaL=1e150)))
def test_a_problem_beyond_the_floats_is_refused_by_the_same_limit_whoever_asks(given: Ends) -> None:
    case = Case(Rod(1e4, 0.25, 0.25, 2.0), Cylinder(0.75), given)
    assert solve(case).outcome == f"failed: {equilibria(case).remark}"


def test_a_rod_is_refused_where_its_stiffness_is_no_float_and_has_one_shape_before() -> None:
    """All lengths shrink together; the stiffness falls with their fourth power."""
    shape = solve(Case(Rod(1e4, 0.25, 0.25, 2.0), Cylinder(0.75), Start(0.5, 0.1, M3=0.0))).beta
    for decade in range(0, 300, 10):
        k = 10.0**-decade
        sol = solve(Case(Rod(1e4, 0.25, 0.25 * k, 2 * k), Cylinder(0.75 * k), Start(0.5, 0.1 / k, M3=0.0)))
        assert bool(sol.solved) == (decade <= 70)
        if sol.solved:
            np.testing.assert_allclose(sol.beta, shape, rtol=1e-9)
        else:
            assert str(sol.outcome).startswith(OUT_OF_RANGE)
