"""Numbers that no caller should give the core's quadrature: it must neither crash nor touch what is not its own.

`.ci/run` runs this file again with a library that checks every access and every operation of C.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.core.library import Cutting, cut, fine, on_grid, points, run
from solver.orbits.boundary import CUTTING, NODES, Levels, boundary_of, length_roots, transit_times
from solver.orbits.periodic_orbit import action, judge, orbits_of, response
from solver.problem.dimensionless import EndsProblem, StartProblem

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
        problem = StartProblem(*rows.T.copy())
        orbit = orbits_of(problem, pin, NODES, Cutting(0.45, 10.0 ** rng.uniform(-15, -5), 4.0))
        told = rows if pin is None else np.column_stack([rows, pin])
        if orbit is None:
            assert not np.isfinite(told).all() or np.abs(told).max() >= 1e100
            continue
        assert np.isfinite(told).all()
        made += 1
        condition, _ = judge(orbit)
        assert not (condition < 1).any()
        assert not (response(orbit)[0] < 1).any()
        assert action(orbit).shape == condition.shape
        assert orbit.swirl(odd(rng, rows.shape[0], 5)).shape == (rows.shape[0], 5)
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
        found = transit_times(boundary, Levels(pin, sign, odd(rng, n)), bool(rng.random() < 0.5))
        counts = rng.integers(-2, 5, (n, 3))
        roots, _ = length_roots(boundary, Levels(pin, sign, odd(rng, n)), counts, odd(rng, n))
        assert found.time.shape == (3, n)
        assert roots.shape == (n,)
        if not ((pin >= 0) & (pin < pins)).all():
            assert np.isnan(found.time).all()
            assert np.isnan(roots).all()


@pytest.mark.parametrize("seed", range(4))
def test_odd_lines_give_a_path_or_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(60):
        first = odd(rng, 6)
        last = first + np.where(rng.random(6) < 0.1, odd(rng, 6), 1e-2 * rng.normal(size=6))
        level, way = odd(rng, 3), np.array([rng.choice([-1, 1]), rng.integers(-1, 5)])
        if fine(run("rod_continued", first, last, on_grid(), points(NODES), cut(CUTTING, True), level, way)):
            assert np.isfinite([*first, *last]).all()
            assert way[1] >= 0
