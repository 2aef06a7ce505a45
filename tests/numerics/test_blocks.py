"""A long list of cases is solved a block at a time: little more room than the answer, and no other answer."""

import json
import os
import subprocess
import sys
import tracemalloc
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Solution, Start, observe, solve
from solver.methods import available
from solver.methods import method as method_module

MOST = 1.5  # of what is returned, while it is made: arrays have room to grow
MOST_RESIDENT = 1.25  # room that nothing fills takes no memory; a table that is copied to grow is held twice: 1.45


def many(cases: int) -> Case:
    """Table 1's rod, another stiffness and force each."""
    random = np.random.default_rng(16)
    rod = Rod(random.uniform(5e3, 4e4, cases), 0.25, 0.25, 20.0, stiffness="paper")
    return Case(rod, Cylinder(0.75), Start(np.pi / 6, 0.5, F1=5.0, F3=random.uniform(5, 20, cases)))


def mixed(cases: int) -> Case:
    """Librations, rotations, helices, rods next to a saddle, and one in seven that no float holds."""
    random = np.random.default_rng(3)
    beta, dbeta = random.uniform(-3, 3, cases), random.uniform(-3, 3, cases)
    FZ, MZ = random.uniform(-1, 1, (2, cases))
    beta[::5], dbeta[::5], MZ[::5] = np.pi + 1e-9, 0.0, 0.0  # rho = 1: about a saddle or a centre of the lone FZ
    beta[2::5], dbeta[2::5], MZ[2::5] = 0.0, 0.0, 0.0
    F2, F3 = FZ * np.sin(beta) - MZ * np.cos(beta), FZ * np.cos(beta) + MZ * np.sin(beta)
    F3[3::7] = 1e200
    a = 0.25
    return Case(Rod(4 / np.pi / a**4, 0.25, a, 20.0), Cylinder(1 - a), Start(beta, dbeta, F2=F2, F3=F3, M3=0.0))


def bytes_of(value: Any, seen: set[int]) -> int:
    """Of all arrays that a value holds, each once."""
    if id(value) in seen:
        return 0
    seen.add(id(value))
    if isinstance(value, np.ndarray):
        return value.nbytes if value.base is None else bytes_of(value.base, seen)
    inside = list(vars(value).values()) if hasattr(value, "__dataclass_fields__") else []
    inside += [cell.cell_contents for cell in getattr(value, "__closure__", None) or ()]
    inside += list(value) if isinstance(value, tuple) else []
    return sum(bytes_of(one, seen) for one in inside)


def in_blocks(monkeypatch: pytest.MonkeyPatch, size: int, case: Case, method: str, **more: Any) -> Solution:
    monkeypatch.setattr(method_module, "BLOCK", size)
    return solve(case, method=method, stations=17, **more)


ORBITS = [name for name in ("orbit", "swing") if name in available()]


@pytest.mark.parametrize("method", ORBITS)
def test_an_orbit_of_blocks_is_read_as_that_of_one_block(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    case = mixed(53)
    whole, parts = (in_blocks(monkeypatch, size, case, method) for size in (1000, 8))
    assert list(parts.outcome) == list(whole.outcome)
    assert 0 < parts.solved.sum() < 53
    held = parts.solved
    one, other = whole.trajectory.orbit, parts.trajectory.orbit
    t = whole.problem.span[:, None] * np.array([0.1, 0.77])
    grown = 1e-12 * whole.condition[held, None]  # a batch of another size rounds otherwise
    for ours, theirs in zip((*other.at(t), other.swirl(t)), (*one.at(t), one.swirl(t)), strict=True):
        assert (np.abs(ours - theirs)[held] <= grown).all()
    assert (np.abs(parts.gamma - whole.gamma)[held] <= 20 * grown).all()
    assert np.isnan(parts.gamma[~held]).all()
    assert (other.turns == one.turns)[held].all()
    np.testing.assert_allclose(other.period[held], one.period[held], rtol=1e-9)
    for i in np.flatnonzero(held)[::9]:
        alone = other.take(np.array([i])).at(t[i : i + 1])
        np.testing.assert_array_equal(alone, [v[i : i + 1] for v in other.at(t)])


@pytest.mark.parametrize("method", ORBITS)
def test_observables_do_not_depend_on_the_blocks(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    case, names = mixed(53), ("bends", "index", "overlaps", "kappa_max", "energy", "turns_around")
    whole, parts = (observe(in_blocks(monkeypatch, size, case, method), names) for size in (1000, 8))
    for name in names:
        np.testing.assert_allclose(parts[name], whole[name], rtol=1e-8, atol=1e-8, err_msg=name)


@pytest.mark.slow
@pytest.mark.parametrize("method", [m for m in ("swing", "verlet", "rk4", "dop853", "lsoda") if m in available()])
def test_blocks_change_no_bit_of_a_method_that_keeps_its_cases_apart(
    method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = many(7)
    whole, parts = (in_blocks(monkeypatch, size, case, method, tol=1e-4) for size in (1000, 3))
    for name in ("beta", "dbeta", "alpha", "z", "gamma", "error", "condition", "outcome", "evaluations"):
        np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name), err_msg=name)


@pytest.mark.parametrize(
    ("method", "knobs"), [("orbit", {}), pytest.param("verlet", {"steps": 1}, marks=pytest.mark.slow)]
)
def test_solving_takes_little_more_room_than_the_answer(
    method: str, knobs: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(method_module, "BLOCK", 21)  # of 1024 cases, as 2048 of 100,000
    case = many(1024)
    solve(many(2), method=method, stations=201, tol=1e-4, **knobs)
    tracemalloc.start()
    try:
        sol = solve(case, method=method, stations=201, tol=1e-4, **knobs)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most <= MOST * bytes_of(sol, set())


GROWN = """
import json, sys
from solver import solve
from tests.numerics.test_blocks import bytes_of, many

def highest():
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmHWM")) * 1024

solve(many(3000), method="orbit")  # code is loaded, and a block was solved once: what Python keeps of it is kept
before = highest()
sol = solve(many(40_000), method="orbit")
print(json.dumps([highest() - before, bytes_of(sol, set()), int(sol.solved.sum())]))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the highest resident size is read from /proc")
def test_a_process_that_solves_forty_thousand_cases_stays_small() -> None:
    threads = {**os.environ, "OMP_NUM_THREADS": "2"}  # each has a heap of its own
    run = subprocess.run([sys.executable, "-c", GROWN], env=threads, capture_output=True, text=True, check=True)
    most, returned, solved = json.loads(run.stdout)
    assert solved == 40_000
    assert most <= MOST_RESIDENT * returned


def test_the_parts_of_joined_orbits_are_numbered_as_the_orbits_of_the_batch() -> None:
    """Also where one of three rods, whose ends are farther apart than it is long, has no orbit."""
    ends = Ends(0.1, 0.2, height=5.0, azimuth=[0.1, 5.0, 0.3], M3=0.0)
    batch = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=6.0), Cylinder(R=0.9), ends))
    assert batch.solved.tolist() == [True, False, True]
    orbit = batch.trajectory.orbit
    arcs = np.flatnonzero(orbit.count)
    assert {0, 4} <= set(arcs.tolist())
    np.testing.assert_array_equal(orbit.panels.arc[orbit.first[arcs]], arcs)
    assert orbit.paths is None or orbit.paths.y.size == 3
