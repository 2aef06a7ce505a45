"""Held ends far from every ordinary rod: no exception, and an answer that is right or an outcome that says why not."""

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, solve


@pytest.mark.parametrize("turned", [1e9, -1e9])
def test_a_rod_twisted_by_many_turns_has_the_twisting_moment_of_its_twist(turned: float) -> None:
    rod = Rod(E=1e4, nu=0.25, a=0.25, L=5.0)
    sol = solve(Case(rod, Cylinder(R=0.75), Ends("20deg", "20deg", rotation=np.radians(turned))))
    assert sol.outcome.startswith("solved") or sol.outcome.startswith("failed: ")
    if sol.solved:
        assert (
            pytest.approx(rod.torsional_stiffness * np.radians(turned) / 5.0, rel=1e-6) == sol.M3
        )  # swirl is < 10 rad
