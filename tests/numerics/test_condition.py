"""The condition number and the error estimate: whether they say how much can be trusted."""

from functools import cache

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, solve
from solver.methods import METHODS, available
from solver.problem.dimensionless import StartProblem
from tests.cases import START, Named, helix_moment, in_units_of_rho
from tests.extreme_cases import KINDS
from tests.helix_cases import NEAR, problems
from tests.reach import core
from tests.references import references
from tests.slow import slow
from tests.variation import growth, weight

STARTS = core("start")
BOTH = pytest.mark.parametrize("method", [name for name in ("orbit", "swing") if name in available()])
SURE = 1e7  # growth up to which a march in doubles still knows the orbit when it comes back to its saddle


@pytest.mark.parametrize("name", START)
def test_the_condition_number_is_right_within_a_digit_and_a_half(name: str) -> None:
    """Against the variational equation in forty digits. Too small a number would excuse nothing, too large anything."""
    reference = references()[name].condition
    sol = solve(START[name].case, tol=1e-8, stations=201)
    assert reference / 5 <= sol.condition <= 30 * reference


def test_growth_is_exponential_at_a_saddle() -> None:
    """A straight rod in tension: exp(sqrt(phi) L)."""
    for span in (5.0, 10.0, 20.0):
        sol = solve(in_units_of_rho(0, 0, 1.0, span, 0.0, 0.0))
        assert sol.condition == pytest.approx(np.cosh(span), rel=1e-3)


def test_a_constant_h_proves_nothing() -> None:
    """A helix at a saddle, long enough: the march holds h and loses the rod. The condition number knew.

    Rounding decides to which side the march leaves the saddle: on one it turns by 4.9 rad, on the other by 0.24.
    """
    beta = 1.1
    last_digit = -1e-16
    case = in_units_of_rho(helix_moment(beta, 0.4, 0.2), 0.4, 0.2, 80.0, beta, last_digit)
    march = solve(case, tol=1e-8, method="dop853", rtol=1e-13)
    assert np.ptp(march.h) < 1e-11
    assert np.abs(march.beta - beta).max() > 0.1
    assert march.condition > 1e13


def test_what_condition_costs_is_said_in_the_outcome() -> None:
    case = in_units_of_rho(0, 0, 1.0, 25.0, 1e-9, 0.0)
    sol = solve(case, tol=1e-12)
    assert sol.solved
    assert sol.outcome != "solved"
    assert sol.outcome.startswith("solved; fewer digits than the tolerance 1.0e-12 asks for: error ")
    assert f"grows {sol.condition:.1e} times" in sol.outcome
    easy = solve(case, tol=1e-4)
    assert easy.outcome == "solved"


@pytest.mark.parametrize("extrapolate", (False, True))
def test_a_method_that_misses_its_tolerance_says_so(extrapolate: bool) -> None:
    """Twenty steps for two periods; the sentence holds the error, the tolerance and the condition number."""
    case = START["elliptic k=0.25 L=20"].case
    sol = solve(case, tol=1e-8, method="verlet", stations=21, steps=1, extrapolate=extrapolate)
    exact = START["elliptic k=0.25 L=20"].exact(sol.s)[0]
    assert np.abs(sol.beta - exact).max() > 1e-8 * sol.condition
    assert not sol.solved
    assert sol.outcome.startswith("failed")
    for number in (sol.error, 1e-8, sol.condition):
        assert f"{number:.1e}" in sol.outcome


def test_the_error_of_orbit_bounds_what_forty_digits_show() -> None:
    """Over all cases together, at three tolerances: never ten times below the truth, rounding aside."""
    for tol in (1e-3, 1e-6, 1e-9):
        for name, reference in references().items():
            named: Named = START[name]
            sol = solve(named.case, tol=tol, stations=9)
            off = np.abs(sol.beta[1:] - reference.beta).max()
            assert off <= 3 * sol.error + 2e-15 * reference.condition, (name, tol)


@pytest.mark.parametrize("method", STARTS)
@pytest.mark.parametrize("beta, L", ((1e-6, 1000.0), (1e-12, 200.0), (1e-16, 20.0)))
def test_at_rest_next_to_a_degenerate_saddle_a_change_of_slope_grows_like_the_length(
    beta: float, L: float, method: str
) -> None:
    """Without loads H = -2 cos(beta) sin^3(beta): the rod is straight all along, and H' too small to matter."""
    sol = solve(Case(Rod(1e4, 0.25, 0.25, L), Cylinder(0.75), Start(beta, 0.0, M3=0.0)), method=method)
    assert sol.condition == pytest.approx(L, rel=1e-2)
    assert sol.solved


@pytest.mark.parametrize("method", STARTS)
def test_at_rest_on_a_stable_helix_nothing_grows(method: str) -> None:
    """A root of H but for rounding: the rod stays, and it was refused for a condition number of 1e28."""
    a = 0.01
    rod = Rod(E=1 / (np.pi / 4 * a**4), nu=0.25, a=a, L=4.003957255807741)
    loads = {"F2": 0.010259934572400042, "F3": -1.748793128640259, "M3": 0.46008023068061554}
    sol = solve(Case(rod, Cylinder(1 - a), Start(0.19681798769769898, 0.0, **loads)), method=method)
    assert sol.condition == pytest.approx(1, abs=1e-6)
    assert sol.solved


@BOTH
def test_no_length_of_a_small_libration_is_ill_conditioned(method: str) -> None:
    """A pendulum next to its rest: its period hardly depends on how far it swings, so that a million do not matter."""
    for swing in (1e-16, 1e-12, 1e-8, 1e-5):
        sol = solve(in_units_of_rho(0, 0, -1.0, 1e7, swing, swing / 3), method=method)
        assert sol.condition < 3, swing


@BOTH
def test_a_slope_of_rounding_changes_no_condition_number(method: str) -> None:
    """A rod all but at rest turns within a time of rounding: a panel so short that its speed alone gives no H."""
    slopes = np.concatenate(([0.0], *(sign * np.logspace(-19, -13, 13) for sign in (1, -1))))
    numbers = (np.full(slopes.size, x) for x in (3.5743903, 2.7017160, -4.3965625, 35.624957, -0.9684290))
    problems = StartProblem(*numbers, slopes)
    stations = problems.span[:, None] * np.linspace(0, 1, 9)
    condition = METHODS[method]().run(problems, stations, 1e-8).condition
    np.testing.assert_allclose(condition, condition[0], rtol=1e-6)


@cache
def marched(kind: str, n: int, seed: int, longer: float) -> tuple[StartProblem, np.ndarray]:
    """The problems, whose rods are so many times longer, and their condition numbers by a march."""
    p = problems(kind, n, seed)
    p.span[:] *= longer
    return p, growth(p.lam, p.mu, p.phi, p.span, p.beta0, p.dbeta0)


QUICK = ("gap", "helix", "plain", "fold", "centre")
# of a rod thirty times as long some hundred swings: what a period adds counts, and not what one swing does
ROWS = [(kind, 40, 5, 1.0) if kind in QUICK else slow(kind, 40, 5, 1.0) for kind in (*KINDS, *NEAR)]
LONG = [slow(kind, 60, 3, 30.0) for kind in ("plain", "centre", "gap")]


@BOTH
@pytest.mark.parametrize(("kind", "n", "seed", "longer"), ROWS + LONG)
def test_the_condition_number_is_that_of_the_variational_equation(kind, n, seed, longer, method: str) -> None:
    """Within a factor of three of a march of order 8, and no rod refused because of a false condition number."""
    p, true = marched(kind, n, seed, longer)
    told = METHODS[method]().run(p, p.span[:, None] * np.linspace(0, 1, 9), 1e-8)
    sure = true < SURE
    ratio = told.condition / true
    off = np.flatnonzero(sure & ~((ratio < 3) & (ratio > 1 / 3)))
    assert not off.size, [(*(v[i] for v in vars(p).values() if v is not None), true[i], ratio[i]) for i in off[:3]]
    assert (told.condition[~sure] > SURE / 3).all()
    refused = np.array(["leaves no digit" in text for text in told.outcome])
    assert not (refused & sure).any()


def test_the_weight_of_a_slope_is_the_same_for_every_method() -> None:
    """A straight pull: w = sqrt(phi), so that both changes grow as cosh, whoever solves."""
    case = in_units_of_rho(0, 0, 400.0, 0.4, 1e-9, 0.0)
    assert weight(0, 0, 400.0, 1e-9, 0.0) == pytest.approx(20, rel=1e-3)
    told = {name: float(solve(case, method=name, tol=1e-6, stations=201).condition) for name in STARTS}
    for name, value in told.items():
        assert value == pytest.approx(np.cosh(20 * 0.4), rel=0.05), name
