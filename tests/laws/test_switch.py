"""At a pitchfork one goes over to the crossing branch: a straight pipe to its buckled shapes, and back."""

from functools import cache

import numpy as np
import pytest

from solver import Branch, Case, Cylinder, Ends, equilibria, follow, solve, switch
from tests.cases import rod_of_unit_stiffness
from tests.equation import far_angle

L = 10.0
EULER = -((np.pi / L) ** 2)


@cache
def straight() -> Branch:
    pipe = Case(rod_of_unit_stiffness(L, 0.01), Cylinder(1 - 0.01), Ends(0.0, 0.0, FZ=1.0))
    return follow(solve(pipe), FZ=-3.0)


def test_a_straight_pipe_goes_over_to_its_two_buckled_shapes() -> None:
    euler = straight().special[0]
    assert euler.value == pytest.approx(EULER, rel=1e-12)
    low, high = switch(straight(), euler)
    assert float(low.FZ) == float(high.FZ) < EULER
    np.testing.assert_allclose(low.beta, -high.beta, atol=1e-12)
    assert 0.01 < np.abs(high.beta).max() < 0.1
    assert far_angle(high.case, float(high.dbeta[0])) == pytest.approx(0, abs=1e-9)


def test_the_branch_that_is_taken_up_is_the_stable_one_of_all_equilibria() -> None:
    _, high = switch(straight(), straight().special[0])
    branch = follow(high, FZ=1.3 * EULER)
    last = branch.points[-1]
    rising = [one for one in equilibria(last.case) if one.index == 0 and one.dbeta0 > 0]
    stable = min((one.solution for one in rising), key=lambda one: float(np.abs(one.beta).max()))
    assert last.index == 0
    np.testing.assert_allclose(last.solution.beta, stable.beta, atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("n", [2, 3, 4, 5])
def test_a_higher_pitchfork_gives_shapes_of_as_many_half_waves(n: int) -> None:
    low, high = switch(straight(), straight().special[n - 1])
    for one in (low, high):
        assert np.count_nonzero(np.diff(np.sign(one.dbeta[np.abs(one.dbeta) > 1e-6]))) == n
    np.testing.assert_allclose(np.abs(low.beta), np.abs(high.beta), atol=1e-10)


def test_a_buckled_branch_goes_over_to_the_straight_pipe_on_both_sides() -> None:
    _, high = switch(straight(), straight().special[0])
    turned = follow(high, FZ=0.5 * EULER)
    (point,) = turned.special
    before, after = switch(turned, point)
    assert float(before.FZ) < EULER < float(after.FZ)
    for one in (before, after):
        np.testing.assert_allclose(one.beta, 0, atol=1e-12)
