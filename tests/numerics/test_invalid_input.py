"""What is let in at the door, and what only an outcome tells; transcripts/solver.txt has what is refused."""

import warnings
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Start, equilibria, solve
from solver.problem.case import from_fields
from solver.problem.quantities import QUANTITIES, unit_of

ROD: dict[str, Any] = {"E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 20.0}
START: dict[str, Any] = {"beta": 0.5, "dbeta": 0.5, "F3": 10.0, "dgamma": 0.5}


def case(**start: Any) -> Case:
    return Case(Rod(**ROD), Cylinder(0.75), Start(**{**START, **start}))


@pytest.mark.parametrize("nu", (-0.999, 0.0, 0.5))
def test_poisson_ratio_may_reach_one_half(nu: float) -> None:
    assert Rod(**{**ROD, "nu": nu}).torsional_stiffness > 0


def test_from_fields_makes_what_the_class_makes() -> None:
    assert from_fields(Rod, ROD).bending_stiffness == Rod(**ROD).bending_stiffness


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


@pytest.mark.parametrize("a", [5e-324, 1e-90, 1e100, 1e308])
def test_a_rod_whose_stiffness_no_float_holds_is_told_by_its_outcome(a: float) -> None:
    for given in (Start(0.5, 0.1, F1=1.0, F3=1.0), Start(0.5, 0.1, dgamma=0.1), Start(0.5, 0.1, M3=0.1)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sol = solve(Case(Rod(E=1e4, nu=0.25, a=a, L=20.0), Cylinder(R=0.75), given))
        assert sol.solved or str(sol.outcome).startswith("failed: ")
        assert sol.solved <= np.isfinite(sol.beta).all()


def test_a_field_too_large_for_floats_is_named_with_its_value() -> None:
    forces = np.array([10.0, 1e300, -1e250])
    sol = solve(case(F3=forces))
    assert list(sol.solved) == [True, False, False]
    assert [str(text).split("; ")[-1] for text in sol.outcome] == [
        "solved", "the most extreme field is F3 = 1e+300", "the most extreme field is F3 = -1e+250",
    ]  # fmt: skip
    assert "field is E = 1e+300" in str(solve(Case(Rod(**{**ROD, "E": 1e300}), Cylinder(0.75), Start(**START))).outcome)
    for ends in (Ends(0.5, 0.7, FZ=1e300), Ends(0.5, 0.7, height=3.0, MZ=1e300)):
        name = "FZ" if ends.height is None else "MZ"
        one = Case(Rod(**ROD), Cylinder(0.75), ends)
        assert f"the most extreme field is {name} = 1e+300" in str(solve(one).outcome)
        found = equilibria(one)
        assert not found
        assert f"the most extreme field is {name} = 1e+300" in found.remark
        assert "by degree" not in found.remark
        assert "searched over" not in found.remark


def ends(**more: Any) -> Case:
    return Case(Rod(**ROD), Cylinder(0.75), Ends(**{"beta0": 0.5, "betaL": 0.6, **more}))


def test_a_rod_between_ends_has_a_greatest_length() -> None:
    for given in ({}, {"height": 0.0}):
        outcome = str(solve(Case(Rod(1.07e4, 0.25, 0.25, 1e17), Cylinder(0.75), ends(**given).given)).outcome)
        assert outcome.startswith("failed: L/rho of a problem between two ends must be below 1e16"), given
