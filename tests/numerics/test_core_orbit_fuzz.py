"""Numbers that no caller should give the core's quadrature: it must neither crash nor touch what is not its own.

`.ci/run` runs this file again with a library that checks every access and every operation of C.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.core import levels, orbits
from solver.core.library import Cutting
from solver.levels.level_grid import boundary_of
from solver.levels.transit_times import CUTTING, NODES
from solver.orbit.periodic_orbit import orbit_of
from solver.problem.reduced import EndsProblem, StartProblem

ODD = np.array([0, -0.0, np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-300, 5e-324, 1e100, np.pi, -np.pi, 1e16, -1e8])
PLAIN = EndsProblem(*(np.array([v]) for v in (0.3, -0.2, 0.5, 4.0, 0.4, -0.3)))


def odd(rng: np.random.Generator, *shape: int) -> Any:
    """A tenth of odd numbers, the others over four decades."""
    size = rng.normal(size=shape) * 10.0 ** rng.uniform(-2, 2, shape)
    return np.where(rng.random(shape) < 0.1, rng.choice(ODD, shape), size)


@pytest.mark.parametrize("seed", range(4))
def test_odd_numbers_give_orbits_or_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    made = 0
    for _ in range(60):
        rows = odd(rng, int(rng.integers(0, 3)), 6)
        rows[:, 3] = np.abs(rows[:, 3])
        pin = None if rng.random() < 0.5 else odd(rng, rows.shape[0], 3)
        found = orbits.orbits(rows, pin, NODES, Cutting(0.45, 10.0 ** rng.uniform(-15, -5), 4.0))
        told = rows if pin is None else np.column_stack([rows, pin])
        if found is None:
            assert not np.isfinite(told).all() or np.abs(told).max() >= 1e100
            continue
        assert np.isfinite(told).all()
        made += 1
        orbit = orbit_of(StartProblem(*rows.T.copy()), found)
        condition, _ = orbits.judge(orbit)
        assert not (condition < 1).any()
        assert not (orbits.response(orbit)[0] < 1).any()
        assert orbits.action(orbit).shape == condition.shape
        assert orbits.read(orbit, odd(rng, rows.shape[0], 5)).shape == (5, rows.shape[0], 5)
    assert made > 15


@pytest.mark.parametrize("seed", range(4))
def test_odd_levels_give_times_or_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(60):
        n, pins = int(rng.integers(0, 4)), int(rng.integers(1, 4))
        ends = EndsProblem(*odd(rng, 6, 1)) if rng.random() < 0.3 else PLAIN
        known = boundary_of(PLAIN)
        low, high, deepest = odd(rng, 3)
        boundary = replace(known, problem=ends, pins=odd(rng, pins), falls=odd(rng, pins, 2), low=float(low))
        boundary = replace(boundary, high=float(high), deepest=float(deepest), passed=int(rng.integers(-1, 9)))
        pin, sign = rng.integers(-1, 4, n), rng.choice([-1.0, 1.0], n)
        found = levels.transit_times(boundary, pin, sign, odd(rng, n), bool(rng.random() < 0.5), NODES, CUTTING)
        counts = rng.integers(-2, 5, (n, 3))
        roots = levels.level_roots(boundary, pin, sign, counts, odd(rng, n), odd(rng, n), NODES, CUTTING)
        if found is None:
            assert roots is None or not np.isfinite(roots[0]).all()
            continue
        assert found[0].shape == (3, n)
        assert ((pin >= 0) & (pin < pins)).all()


@pytest.mark.parametrize("seed", range(4))
def test_odd_lines_give_a_path_or_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(60):
        first = odd(rng, 6)
        last = first + np.where(rng.random(6) < 0.1, odd(rng, 6), 1e-2 * rng.normal(size=6))
        level, way = tuple(odd(rng, 3)), (int(rng.choice([-1, 1])), int(rng.integers(-1, 5)))
        found = levels.resume(first, last, level, way, NODES, CUTTING)
        if found is not None:
            assert np.isfinite([*first, *last]).all()
            assert found[4] >= 0
