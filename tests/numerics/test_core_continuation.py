"""Continuation by the compiled core reaches the path that the general continuation reaches."""

from typing import Any

import numpy as np
import pytest

from solver.branches.continuation import Stopped, _resume_by_leaps, resume
from solver.branches.leaps import shape_of
from solver.equilibrium.charts import charts, coordinate
from solver.levels.level_search import search_levels
from solver.levels.line_point import LinePoint, Path, path_of
from solver.levels.path_orbits import orbit_of
from solver.problem.reduced import EndsProblem
from tests.numerics.test_core_orbits import REFERENCE


def problem_of(row: Any) -> EndsProblem:
    return EndsProblem(*(np.array([float(v)]) for v in row))


def pairs(count: int) -> list[tuple[EndsProblem, EndsProblem]]:
    """Two neighbouring ends problems each: the reference problem first, then random ones."""
    rng = np.random.default_rng(4)
    rows = [
        REFERENCE,
        *((*rng.normal(size=3), 10 ** rng.uniform(0, 1.5), *rng.uniform(-3, 3, 2)) for _ in range(count)),
    ]
    steps = [10 ** rng.uniform(-4, -0.5) * rng.normal(size=6) for _ in rows]
    return [(problem_of(row), problem_of(row * (1 + step))) for row, step in zip(rows, steps, strict=True)]


def same_path(problem: EndsProblem, a: Path, b: Path) -> bool:
    """Whether two paths are one to rounding, from whichever angles their levels are measured."""
    if (a.leaving, a.turns) != (b.leaving, b.turns):
        return False
    one, other = (charts(LinePoint(problem), path)[0] for path in (a, b))
    return one.kind == other.kind and abs(coordinate(one) - coordinate(other)) < 1e-9 * one.scale


@pytest.mark.parametrize("count", [8, pytest.param(150, marks=pytest.mark.slow)])
def test_the_core_reaches_the_path_of_the_general_continuation(count: int) -> None:
    reached = ended = 0
    for first, last in pairs(count):
        found = search_levels(first)
        assert found is not None
        for path in [path_of(found.path, i) for i in range(min(found.slope.size, 6))]:
            plain, compiled = _resume_by_leaps(first, path, last), resume(first, path, last)
            if isinstance(plain, Stopped):
                assert isinstance(compiled, Stopped)
                assert compiled.reason == plain.reason
                ended += 1
            else:
                assert isinstance(compiled, Path)
                assert same_path(last, plain, compiled)
                reached += 1
    assert reached > 2 * count
    assert ended >= count // 20


def test_a_line_there_and_back_returns_to_the_equilibrium() -> None:
    first, last = problem_of(REFERENCE), problem_of((-0.36, 0.75, -0.74, 20.3, 0.53, 0.51))
    found = search_levels(first)
    assert found is not None
    returned = 0
    for path in [path_of(found.path, i) for i in range(found.slope.size)]:
        there = resume(first, path, last)
        if isinstance(there, Path):
            back = resume(last, there, first)
            assert isinstance(back, Path)
            assert back.turns == path.turns
            before, after = orbit_of(first, path), orbit_of(first, back)
            assert before.response is not None
            assert np.abs(shape_of(before) - shape_of(after)).max() < 1e-12 * (1 + before.response[0])
            returned += 1
    assert returned > 20
