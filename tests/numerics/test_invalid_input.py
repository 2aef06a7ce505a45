"""What is let in at the door, and what only an outcome tells; transcripts/solver.txt has what is refused."""

from typing import Any

import numpy as np
import pytest

from solver import Rod
from solver.problem.quantities import QUANTITIES, unit_of

ROD: dict[str, Any] = {"E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 20.0}


@pytest.mark.parametrize("nu", (-0.999, 0.0, 0.5))
def test_poisson_ratio_may_reach_one_half(nu: float) -> None:
    assert Rod(**{**ROD, "nu": nu}).torsional_stiffness > 0


def test_a_case_keeps_its_values() -> None:
    E = np.array([1.0, 2.0])
    rod = Rod(**{**ROD, "E": E})
    E[0] = -1.0
    assert rod.E[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        rod.E[0] = -1.0
    with pytest.raises(AttributeError):
        rod.E = 3.0


def test_a_unit_system_names_both_units() -> None:
    assert unit_of("E", {"length": "cm", "force": "N"}) == "N/cm^2"
    assert unit_of("M1", {"length": "m", "force": "kN"}) == "kN m"
    assert unit_of("kappa", {"length": "m", "force": "kN"}) == "1/m"
    assert unit_of("dbeta", {"length": "m", "force": "kN"}) == "rad/m"
    assert all(unit_of(name, {"length": "cm", "force": "N"}) is not None for name in QUANTITIES)
