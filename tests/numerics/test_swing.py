"""`swing`, the compiled march over half a period, against `orbit`, which knows no march."""

import _ctypes
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solver import solve
from solver.core.build import digest
from solver.core.library import OTHER, library_path, numbers_of, threads
from solver.methods import OrbitQuadrature, SwingTaylor
from solver.observe.observables import OBSERVABLES, observe
from solver.orbits.marched_orbit import MarchedOrbit, march
from solver.orbits.periodic_orbit import ROTATION
from solver.problem.dimensionless import StartProblem
from tests.extreme_cases import draw
from tests.slow import slow_but
from workbench.lab.trade_runs import CASES

NEAR_SADDLE = (0.0, 0.0, -1.0, 60.0, np.pi, 1e-9)  # a pendulum that all but stands on its head


def random(n: int, seed: int, loads: float, spans: tuple[float, float]) -> StartProblem:
    """n start problems with loads of either sign and of sizes from 1e-2 or less up to 10^loads, log-uniform."""
    rng = np.random.default_rng(seed)

    def signed(low: float, high: float) -> np.ndarray:
        return 10 ** rng.uniform(low, high, n) * rng.choice([-1.0, 1.0], n)

    lam, mu, phi = (signed(min(-2, -loads), loads) for _ in range(3))
    span, beta = 10 ** rng.uniform(*spans, n), rng.uniform(-np.pi, np.pi, n)
    return StartProblem(lam, mu, phi, span, beta, signed(-8, max(0.5, loads / 2)))


def both(problem: StartProblem, tol: float, n: int = 61):
    t = problem.span[:, None] * np.linspace(0, 1, n)
    return SwingTaylor().run(problem, t, tol), OrbitQuadrature().run(problem, t, 1e-13)


def solved(told) -> np.ndarray:
    return np.array([text.startswith("solved") for text in told.outcome])


@pytest.mark.parametrize("tol", [1e-5, 1e-8, 1e-11])
@pytest.mark.parametrize("loads, spans", [(1, (0, 3)), (12, (-6, 9))])
def test_it_keeps_its_promise_and_does_not_understate_its_error(loads: float, spans: tuple, tol: float) -> None:
    problem = random(1500, 5, loads, spans)
    fast, exact = both(problem, tol)
    ok = solved(fast) & solved(exact)
    assert (exact.error[solved(exact) & ~solved(fast)] > 0.01).all()  # it gives up where orbit too has a digit or two
    assert ok.mean() > 0.95
    long = np.maximum(1, problem.span)[:, None]
    off = np.maximum(np.abs(fast.beta - exact.beta), np.abs(fast.alpha - exact.alpha) / long)
    off = np.maximum(off, np.abs(fast.z - exact.z) / long).max(axis=1)
    assert (off <= 10 * fast.error + exact.error)[ok].all()
    assert (off <= tol * np.maximum(1, exact.condition) + exact.error)[ok].all()
    own = ok & ~fast.orbit.lost & (off > 3 * exact.error)  # elsewhere the difference says nothing
    if tol > 1e-10:
        assert own.sum() > 100
        assert np.percentile(fast.error[own] / off[own], 95) < 1000


def test_its_condition_number_by_transfer_matrices_is_that_of_the_shear() -> None:
    fast, exact = both(random(1500, 6, 1, (0, 3)), 1e-11)
    own = ~fast.orbit.lost
    ratio = fast.condition[own] / exact.condition[own]
    assert own.mean() > 0.95
    assert ratio.min() > 0.5
    assert ratio.max() < 1.3  # two nodes a step against twenty-two a panel


def test_both_find_the_same_arcs_and_turning_points() -> None:
    fast, exact = both(random(1500, 7, 1, (0, 3)), 1e-12)
    own = ~fast.orbit.lost
    assert (fast.orbit.kind == exact.orbit.kind).all()
    for name in ("ahead", "back"):
        a, b = getattr(fast.orbit, name)[own], getattr(exact.orbit, name)[own]
        # a start next to rest knows its own turning point no better than its slope, 1e-8 here, allows
        np.testing.assert_allclose(a, b, rtol=1e-8, atol=1e-10)
    assert (fast.orbit.turns == exact.orbit.turns)[own].mean() > 0.999


def test_a_case_has_the_same_bits_alone_and_among_others() -> None:
    problem = random(600, 8, 1, (0, 2))
    t = problem.span[:, None] * np.linspace(0, 1, 41)
    together = SwingTaylor().run(problem, t, 1e-9)
    for i in (0, 255, 256, 599):
        one = slice(i, i + 1)
        alone = SwingTaylor().run(problem.take(one), t[one], 1e-9)
        for name in ("beta", "dbeta", "alpha", "z", "error", "condition"):
            assert (getattr(alone, name)[0] == getattr(together, name)[i]).all()


def test_what_a_march_would_lose_goes_to_the_quadrature() -> None:
    rows = np.array([NEAR_SADDLE, (0.1, 0.2, -0.5, 30.0, 0.4, 0.3), (0.0, 0.0, -1.0, 5.0, 0.0, 0.0)])
    problem = StartProblem(*rows.T)
    fast, exact = both(problem, 1e-9)
    assert list(fast.orbit.lost) == [True, False, True]  # next to a saddle, a libration, a helix
    assert solved(fast).all()
    slow = OrbitQuadrature().run(problem, problem.span[:, None] * np.linspace(0, 1, 61), 1e-9)
    assert (fast.beta[[0, 2]] == slow.beta[[0, 2]]).all()
    np.testing.assert_allclose(fast.beta[1], exact.beta[1], atol=1e-9)
    t = problem.span[:, None] * np.array([[0.3, 0.77]])
    for one, other in zip(fast.orbit.at(t), exact.orbit.at(t), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-7)  # the first is next to its saddle: condition 1e7 and more
    np.testing.assert_allclose(fast.orbit.take(np.array([1])).at(t[1:2])[0], fast.orbit.at(t)[0][1:2], rtol=0, atol=0)
    assert fast.orbit.take(np.array([0])).kind[0] == ROTATION


def test_digits_that_only_a_march_would_lose_are_not_lost() -> None:
    """Strong tension, the start 1e-3 off: the condition number excuses 0.4 rad, the quadrature has 14 digits."""
    problem = StartProblem(*np.array([(0.0, 0.0, 1e4, 20.0, 1e-3, 0.0)]).T)
    fast, exact = both(problem, 1e-6)
    assert exact.condition[0] > 1e5
    assert fast.error[0] <= 1e-4
    np.testing.assert_allclose(fast.beta, exact.beta, atol=1e-9)


def test_steps_of_rods_that_go_to_the_quadrature_overwrite_no_others() -> None:
    """Some of these marches end, but too inaccurately: nobody reads their steps."""
    case = draw(150, 0)
    orbit = solve(case, tol=1e-6, stations=3).trajectory.orbit
    ended = march(numbers_of(orbit.problem), orbit.tol, np.empty((case.size, 0)))["count"][:, 0] > 0
    assert (orbit.lost & ended).any()
    assert not orbit.lost.all()
    first = orbit.found["first"][~orbit.lost]
    np.testing.assert_array_equal(orbit.steps.series[first, 0, 0], orbit.problem.beta0[~orbit.lost])
    np.testing.assert_array_equal(orbit.steps.since[first], 0)


def test_steps_of_some_orbits_are_those_of_a_march_of_these_alone() -> None:
    """Also of orbits that went to the quadrature, which have none."""

    def steps_of(part: MarchedOrbit) -> list[np.ndarray]:
        steps, found = part.steps, part.found
        places = [np.arange(n) + first for first, n in zip(found["first"], found["count"].sum(axis=1), strict=True)]
        index = np.concatenate([np.arange(0), *places])
        return [array[index] for array in (steps.since, steps.width, steps.series)]

    orbit = solve(draw(150, 0), tol=1e-6, stations=3).trajectory.orbit
    assert orbit.kept is not None
    for rows in (np.arange(40, 90), np.arange(3, 150, 7), np.flatnonzero(orbit.lost), np.array([5]), np.arange(0)):
        part = orbit.take(rows)
        alone = replace(part, kept=None, found=part.found.copy())
        for one, other in zip(steps_of(part), steps_of(alone), strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", ["force-first/tension", "catenary", "long"])
def test_observables_are_those_of_the_quadrature(name: str) -> None:
    ours, theirs = (solve(CASES[name].case, tol=1e-12, method=method) for method in ("swing", "orbit"))
    seen, known = observe(ours, OBSERVABLES), observe(theirs, OBSERVABLES)
    for key in OBSERVABLES:
        np.testing.assert_allclose(seen[key], known[key], rtol=1e-8, atol=1e-9, err_msg=key)


def test_results_are_equal_to_the_bit_for_every_width_of_lanes_and_number_of_threads(monkeypatch) -> None:
    problem = random(1100, 9, 1, (0, 2.5))
    numbers, t = numbers_of(problem), problem.span[:, None] * np.linspace(0, 1, 37)

    def run(lanes: int, threads: str) -> tuple[bytes, ...]:
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        out, swirl = np.zeros((4, *t.shape)), np.zeros(t.shape)
        orbits = march(numbers, 1e-9, t, out, swirl, lanes=lanes)
        return orbits.tobytes(), out.tobytes(), swirl.tobytes()

    expected = run(1, "1")
    for lanes in (2, 4, 8, 0):
        assert run(lanes, "1") == expected, lanes
    assert run(0, "8") == expected


def test_eight_threads_that_solve_at_once_get_the_bits_of_one() -> None:
    problems = [random(40, seed, 1, (0, 2.5)) for seed in range(24)]

    def beta(problem: StartProblem) -> bytes:
        return SwingTaylor().run(problem, problem.span[:, None] * np.linspace(0, 1, 21), 1e-9).beta.tobytes()

    expected = [beta(problem) for problem in problems]
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(beta, problems)) == expected


def test_the_number_of_threads_is_that_of_the_environment(monkeypatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert threads() == 3
    monkeypatch.setenv("OMP_NUM_THREADS", "many")
    assert threads() >= 1


def test_an_empty_batch_and_no_station_are_no_error() -> None:
    assert march(np.empty((0, 6)), 1e-9, np.empty((0, 5)), np.empty((4, 0, 5))).size == 0
    problem = random(3, 1, 1, (0, 1))
    assert np.isfinite(march(numbers_of(problem), 1e-9, np.empty((3, 0)))["error"]).all()


ANOTHER = Path(_ctypes.__file__).read_bytes()
UNUSABLE = {
    "missing": (None, "rod.so"), "half-written": (b"half a library", "rod.so"), "another": (ANOTHER, "rod_sources"),
}  # fmt: skip


@pytest.mark.parametrize("name", slow_but(UNUSABLE, "missing"))
def test_a_library_that_cannot_be_used_is_told_in_a_sentence(name: str, tmp_path) -> None:
    content, why = UNUSABLE[name]
    path = tmp_path / "rod.so"
    if content is not None:
        path.write_bytes(content)
    code = "from workbench.cli import main; main(['solve', '--table1'])"
    told = os.environ | {OTHER: str(path)}
    run = subprocess.run([sys.executable, "-c", code], env=told, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr.count("\n")) == (2, 1)
    assert run.stderr.startswith("workbench: the compiled core cannot be loaded")
    assert why in run.stderr
    assert "install rod-workbench again, or in a checkout run python -m solver.core" in run.stderr


def test_a_library_of_other_sources_is_refused_in_a_sentence_with_the_command(tmp_path) -> None:
    """As one that was not compiled anew after a change of a C file; the package can be imported without it."""
    known = library_path().read_bytes()
    assert known.count(digest().encode()) == 1
    path = tmp_path / "rod.so"
    path.write_bytes(known.replace(digest().encode(), b"rod-00000000"))
    code = "import solver.core.build, workbench.cli; workbench.cli.main(['solve', '--table1'])"
    run = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | {OTHER: str(path)}, capture_output=True, text=True, check=False
    )
    how = "install rod-workbench again, or in a checkout run python -m solver.core"
    assert (run.returncode, run.stderr) == (2, f"workbench: {path} was compiled from other sources; {how}\n")
