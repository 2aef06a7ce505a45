"""What is let in at the door, and what only an outcome tells; transcripts/solver.txt has what is refused."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from solver import (
    Case,
    Cylinder,
    Ends,
    InputError,
    Rod,
    Start,
    equilibria,
    fit,
    fold_curves,
    follow,
    loops,
    observe,
    region_map,
    solve,
    switch,
    trace_fold,
    weight_in_fluid,
)
from solver.problem.quantities import QUANTITIES, unit_of
from solver.region_map import RegionMap

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


def test_a_default_that_is_given_is_as_one_that_is_omitted_whatever_object_it_is() -> None:
    stiffness = str(np.array("solid"))  # as of a file: equal to the word of the declaration, and another object
    assert stiffness is not Rod(**ROD).stiffness
    assert repr(Case(Rod(**EI, L=6.0, stiffness=stiffness), ROUND, CASE.given)) == repr(CASE)


def test_a_unit_system_names_both_units() -> None:
    assert unit_of("E", {"length": "cm", "force": "N"}) == "N/cm^2"
    assert unit_of("M1", {"length": "m", "force": "kN"}) == "kN m"
    assert unit_of("kappa", {"length": "m", "force": "kN"}) == "1/m"
    assert unit_of("dbeta", {"length": "m", "force": "kN"}) == "rad/m"
    assert all(unit_of(name, {"length": "cm", "force": "N"}) is not None for name in QUANTITIES)


EI: dict[str, Any] = {"EI": 1.0, "GJ": 0.8, "a": 0.1}
ROUND = Cylinder(R=0.9)
CASE = Case(Rod(**EI, L=6.0), ROUND, Ends(0.2, 0.3, FZ=-0.5))
BEGUN = Case(Rod(**EI, L=2.0), ROUND, Start(0.2, 0.3, F3=-0.5, M3=0.1))
HEAVY = Case(Rod(**EI, L=2.0, weight=0.5), Cylinder(R=0.9, inclination=1.0), Ends(0.2, 0.3, FZ=-0.5))
PLANE = {"FZ": (-2.0, -1.0), "M3": (0.0, 0.5), "lattice": 2}
WRONG: list[Any] = [
    "x", b"x", np.nan, 1.5, -1, 10**400, (), {"x": 1}, object(), np.array([1.0, 2.0]), np.array("x"), [None], 1j,
]  # fmt: skip


def calls() -> Iterator[tuple[Any, dict[str, Any]]]:
    """Functions of the solver and methods of its results, each with values that it takes."""
    solution = solve(CASE)
    branch, folds = follow(solution, FZ=-1.0), fold_curves(CASE, **PLANE)
    yield solve, {"case": CASE, "tol": 1e-8, "method": "auto", "stations": 5, "seed": None, "choose": "nearest"}
    yield solve, {"case": BEGUN, "tol": 1e-8, "method": "auto", "stations": 5}
    yield solve, {"case": HEAVY, "tol": 1e-8, "method": "auto", "stations": 5, "seed": None, "choose": "nearest"}
    yield equilibria, {"case": CASE, "tol": 1e-8, "stations": 5, "most_swings": 1}
    yield follow, {"solution": solution, "FZ": -0.6, "points": 1000}
    yield branch.at, {"value": -1.0}
    yield branch.to_dataset, {"stations": 5, "length": "m", "force": "N"}
    yield switch, {"branch": branch, "special": branch.special[0]}
    yield trace_fold, {"branch": branch, "number": 0, "M3": (0.0, 0.1)}
    yield fold_curves, {"case": CASE, **PLANE}
    yield folds.case_at, {"values": (-1.5, 0.1)}
    yield folds.indices_at, {"values": (-1.5, 0.1)}
    yield region_map, {"case": CASE, **PLANE, "stations": 5}
    yield RegionMap(folds, [], np.zeros(0, int), np.zeros(0), "").check, {"points": 1, "seed": 0}
    yield fit, {"case": BEGUN, "vary": "F3", "targets": {"height": 1.5}, "starts": 0, "seed": 0}
    yield (
        fit,
        {"case": BEGUN, "vary": "F3", "points": {"s": [0.1, 1.0], "z": [0.1, 0.9]}, "wrapped": False, "starts": 0},
    )
    yield loops, {"rod": Rod(**EI, L=20.0), "cylinder": ROUND, "turns_around": 1, "folds": 2, "stations": 41}
    yield observe, {"sol": solution, "names": ["height"], "errors": True}
    yield solution.sensitivity, {"fields": ["EI"], "observables": ["height"]}
    yield solution.descent, {"count": 3, "tol": 1e-3}
    yield solution.to_dataset, {"length": "furlong", "force": "N"}
    yield weight_in_fluid, {"a": 0.1, "inner_radius": 0.05, "density": 1.0, "fluid": 0.0, "gravity": 9.8}


def test_a_value_of_a_wrong_type_is_refused_in_words() -> None:
    raised = []
    for function, values in calls():
        for name in values:
            for wrong in WRONG:
                try:
                    function(**{**values, name: wrong})
                except InputError:
                    pass
                except Exception as error:  # a value that is taken raises nothing
                    raised.append(f"{function.__name__}({name}={wrong!r:.40}): {error!r:.80}")
    assert not raised
