"""`equilibrium.orbit_rates`: the derivatives of equilibria against differences, at folds and on helices."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.branches.branch_events import Stop
from solver.branches.continuation import resume
from solver.branches.orbit_rates import NUMBERS, OrbitRates, orbit_rates
from solver.orbits.boundary import Path, boundary_of, path_of, repeat
from solver.orbits.level_search import search_levels
from solver.problem.dimensionless import EndsProblem

DEAD = ("beta0", "betaL", "lam", "mu", "phi")


def ends_problem(lam: float, mu: float, phi: float, span: float, beta0: float, betaL: float) -> EndsProblem:
    return EndsProblem(*(np.array([value]) for value in (lam, mu, phi, span, beta0, betaL)))


def every_equilibrium(problem: EndsProblem, most_turns: int | None = None) -> tuple[EndsProblem, list[Path]]:
    found = search_levels(problem, most_turns=most_turns)
    assert found is not None
    K = found.dbeta0.size
    return repeat(problem, K), [path_of(found.orbit.paths, i) for i in range(K)]


def numbers_at(problem: EndsProblem, path: Path, name: str, step: float) -> Any:
    """The numbers of the equilibrium that continues from `path` when one number of the problem changes."""
    there = replace(problem, **{name: getattr(problem, name) + step})
    found = resume(problem, path, there)
    assert not isinstance(found, Stop), found
    return orbit_rates(there, [found]).values[0]


def response(rates: OrbitRates, held: tuple[str, ...]) -> Any:
    """The derivatives of the numbers by each of five held ones, and by the length, (B, 11, 6)."""
    with np.errstate(invalid="ignore", over="ignore"):
        found = rates.rows @ rates.parts(held)
    found[:, :, 5] += rates.by_span
    return found


MANY = ends_problem(-0.3655, 0.7464, -0.7506, 20.0, np.pi / 6, 0.6)


def test_compliances_of_every_equilibrium_are_symmetric() -> None:
    for problem, most in ((MANY, None), (replace(MANY, span=np.array([200.0])), 1)):
        wide, paths = every_equilibrium(problem, most)
        rates = orbit_rates(wide, paths)
        assert rates.length == pytest.approx(problem.span[0], rel=1e-13)
        for ends in (("beta0", "betaL"), ("dbeta0", "betaL"), ("dbeta0", "dbetaL")):
            K = rates.compliance(np.full(len(paths), 1.25), ends)
            size = np.abs(K).max(axis=(1, 2), keepdims=True)
            assert np.abs((K - K.swapaxes(1, 2)) / size).max() < 1e-10


@pytest.mark.parametrize("span", (20.0, 200.0, 2000.0))  # levels at exp(-24), exp(-270) and exp(-2700) from a saddle
def test_the_response_agrees_with_differences(span: float) -> None:
    problem = replace(MANY, span=np.array([span]))
    wide, paths = every_equilibrium(problem, 1)
    found = response(orbit_rates(wide.take(slice(0, 2)), paths[:2]), DEAD)
    for i in range(2):
        for k, name in enumerate((*DEAD, "span")):
            up, down = (numbers_at(problem, paths[i], name, sign * 1e-4) for sign in (1, -1))
            scale = 1e-6 * (1 + np.abs(found[i, :, k]))
            assert (np.abs((up - down) / 2e-4 - found[i, :, k]) <= scale).all(), (i, name)


def test_the_level_of_a_rod_along_a_flat_saddle_answers_its_tension() -> None:
    """A pipe of 200 m in a borehole lies in a gap of exp(-120): d y/d phi as of mpmath."""
    pipe = ends_problem(0.0, 0.0, -0.00028311728717822894, 4494.38202247191, 0.0, 0.0)
    path = Path(float(boundary_of(pipe).saddles[2]), -1.0, -120.50624556638076, 1, 1)
    rate = response(orbit_rates(pipe, [path]), DEAD)[0, NUMBERS.index("y"), DEAD.index("phi")]
    assert rate == pytest.approx(181770.256957, rel=1e-9)


def test_held_displacements_stay_regular_where_dead_loads_have_a_fold() -> None:
    """At a fold d beta(L)/d beta_t(0) = 0: the response to loads is unbounded, that to displacements is not."""
    _, paths = every_equilibrium(MANY)
    path = next(one for one in paths if one.turns == 4 and one.leaving == 1 and one.sign == 1)
    low, high = replace(path, y=path.y + 0.4), replace(path, y=path.y + 0.5)
    assert _end_rate(low) * _end_rate(high) < 0
    for _ in range(50):
        middle = replace(low, y=(low.y + high.y) / 2)
        low, high = (middle, high) if _end_rate(middle) * _end_rate(low) > 0 else (low, middle)
    fold = orbit_rates(MANY, [low])
    assert np.abs(response(fold, DEAD)).max() > 1e9
    held = response(fold, ("beta0", "betaL", "z", "lam", "mu"))
    assert np.abs(held[0, :10]).max() < 1e3


def _end_rate(path: Path) -> float:
    """The reciprocal of d beta_t(0)/d beta(L)."""
    rates = orbit_rates(MANY, [path])
    return float(1 / response(rates, DEAD)[0, NUMBERS.index("dbeta0"), 1])


@pytest.mark.parametrize("numbers", (
    (0.0, 0.0, -0.7, 20.0, 0.0),  # a centre
    (0.0, 0.0, 0.7, 20.0, 0.0),  # a saddle
    (0.0, 0.0, 0.7, 2000.0, 0.0),
))  # fmt: skip
def test_a_helix_and_an_orbit_beside_it_answer_alike(numbers: tuple[float, ...]) -> None:
    lam, mu, phi, span, beta = numbers
    helix = orbit_rates(ends_problem(lam, mu, phi, span, beta, beta), [Path(beta, 1.0, -np.inf, 0, 0, True)])
    near = ends_problem(lam, mu, phi, span, beta + 1e-7, beta + 1e-7)
    orbit = orbit_rates(near, [_nearest_to_rest(near)])
    one, two = (response(rates, DEAD)[0, :10] for rates in (helix, orbit))
    assert one == pytest.approx(two, rel=1e-4, abs=1e-4 * np.abs(one).max())
    K = helix.compliance(np.ones(1))[0]
    assert np.abs(K - K.T).max() < 1e-12 * np.abs(K).max()


def _nearest_to_rest(problem: EndsProblem) -> Path:
    found = search_levels(problem, most_turns=8)
    assert found is not None
    i = int(np.argmin(found.highest - found.lowest))
    return path_of(found.orbit.paths, i)


def test_helices_and_orbits_of_one_batch_keep_their_places() -> None:
    helix = ends_problem(0.0, 0.0, -0.7, 20.0, 0.0, 0.0)
    other = every_equilibrium(MANY, 1)[1][0]
    batch = EndsProblem(
        *(np.concatenate([a, b]) for a, b in zip(vars(helix).values(), vars(MANY).values(), strict=True))
    )
    both = orbit_rates(batch, [Path(0.0, 1.0, -np.inf, 0, 0, True), other])
    alone = orbit_rates(MANY, [other])
    assert isinstance(both, OrbitRates)
    assert np.array_equal(both.values[1], alone.values[0])
    assert both.value("phi").tolist() == [-0.7, -0.7506]


def test_a_path_on_which_no_orbit_joins_the_ends_has_no_numbers() -> None:
    gone = Path(-0.9253346492170123, -1.0, 3.0, 1, 0)
    there = every_equilibrium(MANY, 1)[1][0]
    both = orbit_rates(repeat(MANY, 2), [gone, there])
    assert np.isnan(both.values[0]).all()
    assert np.isnan(response(both, DEAD)[0]).all()
    assert np.array_equal(response(both, DEAD)[1], response(orbit_rates(MANY, [there]), DEAD)[0])
