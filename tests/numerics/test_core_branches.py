"""Steps along branches by the compiled core: the branches of the steps in Python, and no crash on odd numbers."""

import ctypes
import gc
import re
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import Branch, Case, Cylinder, Ends, Rod, equilibria, follow, solve
from solver.branches.charts import Chart
from solver.branches.orbit_rates import HOW
from solver.core import branch_calls, tuning
from solver.core.branch_calls import RECORD, BranchSteps, Point, chart_of, orbit_rates
from solver.core.build import HERE
from solver.core.library import Tuning, library
from solver.orbits.boundary import CUTTING, NODES, Path
from solver.orbits.variations import POINTS
from tests.numerics.test_core_fuzz import ODD, odd

ROD, CYLINDER = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0), Cylinder(R=0.75)
DEAD = Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.8, FZ=-8.66, MZ=1.3, M3=6.1))


def test_what_the_problem_raises_passes_through_the_core() -> None:
    def numbers(value: float) -> Any:
        raise KeyError(value)

    steps = BranchSteps(numbers, 1.0, NODES, (CUTTING, CUTTING))
    with pytest.raises(KeyError):
        steps.excess(chart_of(Chart("start", Path(0.5, 1.0, 0.0, 1, 2), 1.0, 1e-5, False)), 0.0, np.array([1.0]))


def ways_to_follow() -> dict[str, Callable[[], Branch]]:
    """Branches under dead loads and with a held height, whose steps the core makes."""
    start = list(equilibria(DEAD))[2].solution
    ends = replace(DEAD.given, FZ=None, height=float(start.z[-1]))
    held = solve(replace(DEAD, given=ends), seed=start)
    assert held.solved
    return {"dead loads": lambda: follow(start, FZ=[-12.0, 0.0]), "held": lambda: follow(held, MZ=[1.0, 2.0])}


@pytest.mark.parametrize("way", ["dead loads", "held"])
def test_what_any_call_of_the_problem_raises_ends_the_branch_at_once(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The core went on with other points, and asked for more problems, until its steps ended."""
    go, calls, limit = ways_to_follow()[way], 0, 10**9

    def with_a_limit(numbers: Any) -> Any:
        def at(p: float) -> Any:
            nonlocal calls
            calls += 1
            if calls >= limit:
                raise KeyError(calls)
            return numbers(p)

        return at

    whole = BranchSteps.__init__
    monkeypatch.setattr(BranchSteps, "__init__", lambda self, numbers, *rest: whole(self, with_a_limit(numbers), *rest))
    go()
    count = calls
    assert count > 20
    for limit in range(1, count + 1):
        calls = 0
        with pytest.raises(KeyError, match=f"^{limit}$"):
            go()
        assert calls == limit


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="this system has no timers")
@pytest.mark.parametrize("way", ["dead loads", "held"])
def test_a_signal_while_the_core_works_reaches_the_caller(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where it was raised at the first instruction that the core calls, it was printed and forgotten."""
    if threading.current_thread() is not threading.main_thread():
        pytest.skip("signals come to the main thread alone")

    rng = np.random.default_rng(0)

    class Rung(Exception):
        pass

    def ring(_: int, frame: Any) -> None:
        if any(one.f_code.co_filename == branch_calls.__file__ for one, _ in traceback.walk_stack(frame)):
            rung.append(len(caught))
            raise Rung

    go, rung, caught, lost = ways_to_follow()[way], list[int](), list[int](), list[object]()
    monkeypatch.setattr(sys, "unraisablehook", lost.append)
    before = signal.signal(signal.SIGALRM, ring)
    go()
    begun = time.perf_counter()
    go()
    span = time.perf_counter() - begun
    gc.disable()  # what its callbacks raise is forgotten
    try:
        for _ in range(2000):
            if len(rung) == 20:
                break
            try:
                signal.setitimer(signal.ITIMER_REAL, span * rng.random())
                go()
                signal.setitimer(signal.ITIMER_REAL, 0)
            except Rung:
                caught.append(len(caught))
    finally:
        gc.enable()
        signal.signal(signal.SIGALRM, before)
    assert caught == rung != []
    assert not lost


def test_the_core_decides_by_the_numbers_of_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """A shorter longest step: more points. Fifteen such numbers stood in C as well, equal by hand."""
    go, usual = ways_to_follow()["dead loads"], Tuning(**tuning.values())
    few = len(go())
    monkeypatch.setattr(tuning, "LONGEST", tuning.LONGEST / 10)
    try:
        library().rod_tune(ctypes.byref(Tuning(**tuning.values())))
        many = len(go())
    finally:
        library().rod_tune(ctypes.byref(usual))
    assert many > 2 * few == 2 * len(go())


def test_no_number_that_c_and_python_share_stands_in_c() -> None:
    for path in [*HERE.glob("*.c"), *HERE.glob("*.h")]:
        defined = re.findall(r"^#define (\w+) [-\d.(]", path.read_text(encoding="utf-8"), re.MULTILINE)
        shared = {name.upper() for name in tuning.NAMES} & set(defined)
        assert not shared, path.name


@pytest.mark.parametrize("seed", range(3))
def test_odd_numbers_end_in_an_answer_or_in_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first = np.zeros(1, RECORD)
    for _ in range(60):
        numbers = np.where(rng.random(7) < 0.5, odd(rng, 7), rng.uniform(0.1, 2, 7))
        level = np.where(rng.random(3) < 0.3, rng.choice(ODD, 3), rng.uniform(-1, 1, 3))
        path = Path(float(level[0]), 1.0 if level[1] > 0 else -1.0, float(level[2]), 1, int(rng.integers(0, 5)))
        found = orbit_rates(numbers[:6].tolist(), path, POINTS, HOW)
        assert found[0].shape == (11,)
        chart = Chart(str(rng.choice(["saddle", "start", "end"])), path, 1.0, 1e-5, bool(rng.random() < 0.5))
        for held in (None, (0, 1, 6, 7, 8), (2, 1, 6, 4, 11)):
            count = 7 if held else 6
            steps = BranchSteps(lambda p, one=numbers[:count]: one + 1e-3 * p, 1.0, POINTS, HOW, held)
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
