"""Expressions of a study: their names, their units, and the values that a solution gives them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from solver import Solution, observe, solve
from studies.language import expressions
from studies.language.loader import dumps, loads

HEAD = 'title = "one"\nreading = "force-first/compression/paper"\nstations = 11\n[units]\nlength = "cm"\nforce = "N"\n'
AXES = "[axes.F3]\nvalues = [5.0, 10.0]\n[axes.E]\nvalues = [1e4, 2e4]\n"
OWN = """title = "own"
[units]
length = "in"
force = "lbf"
[base]
E = 2e4
nu = 0.25
a = 0.25
L = 10.0
R = 0.75
dbeta = 0.5
M3 = 0.0
[axes.beta]
values = [20, 40]
unit = "deg"
"""
LAW = "[[laws]]\nclaim = 'a'\naxis = 'F3'\nsource = 's'\n"


def study(said: str, head: str = HEAD + AXES) -> Any:
    return loads(f"{head}[expressions]\n{said}\n")


def values_of(one: Any, sol: Solution, given: Mapping[str, Any]) -> tuple[Mapping[str, Any], list[Any]]:
    """The observables and expressions of a study, and why values are missing."""
    observed = {name: np.reshape(values, -1) for name, values in observe(sol, one.observed, errors=True).items()}
    values, missing = expressions.values_of(one, sol, observed, given)
    return {**observed, **values}, missing


def seen(said: str, head: str = HEAD + AXES) -> Mapping[str, Any]:
    """The values of the expressions of a study over its grid."""
    one = study(said, head)
    case = one.case()
    given = {name: np.broadcast_to(v, case.shape) for name, v in one.variation.dimensions.open().items()}
    found, missing = values_of(one, solve(case, stations=11), given)
    assert missing == []
    return {name: values.reshape(case.shape) for name, values in found.items()}


def test_an_expression_is_computed_from_fields_quantities_observables_and_expressions_above_it() -> None:
    found = seen('half = "kappa_max*rho/2"\nstiff = "bending_stiffness/(E*a**4) + half"\nforce = "F3*2"')
    plain = observe(solve(study("").case()), ["kappa_max"])["kappa_max"]
    np.testing.assert_allclose(found["half"], plain / 2, rtol=1e-12)  # rho = 1 cm
    np.testing.assert_allclose(found["stiff"], np.pi / 16 + plain / 2, rtol=1e-12)
    # a field is the number that the study gives: F30 as printed, whose sign the reading gives
    np.testing.assert_array_equal(found["force"], [[10.0, 10.0], [20.0, 20.0]])


def test_the_loads_are_those_of_the_case_and_start_fields_have_their_defaults() -> None:
    one = study('pulled = "FZ/lbf"\ntwo = "F2 + F3"\nbent = "tan(beta)*inch"', OWN)
    sol = solve(one.case(), stations=11)
    found, _ = values_of(one, sol, one.variation.dimensions.fields)
    np.testing.assert_array_equal(found["pulled"], sol.FZ)
    np.testing.assert_array_equal(found["two"], [0, 0])
    np.testing.assert_allclose(found["bent"], np.tan(np.deg2rad([20, 40])))
    assert {name: expressions.unit(one, name) for name in one.expressions} == {
        "pulled": "1",
        "two": "lbf",
        "bent": "in",
    }


@pytest.mark.parametrize(
    ("formula", "unit", "size"),  # the studies are in cm and N
    [
        ("bending_stress_max", "MPa", 100),
        ("bending_stress_max", "N/mm^2", 100),
        ("kappa_max", "deg/m", np.pi / 180 / 100),
        ("kappa_max", "deg/(30 m)", np.pi / 180 / 3000),
        ("height", "in", 2.54),
        ("energy", "kN m", 1e5),
        ("turns_around", "turn", 2 * np.pi),
    ],
)
def test_an_expression_with_a_unit_is_converted_and_others_count_in_it(formula: str, unit: str, size: float) -> None:
    said = f'own = {{ formula = "{formula}", unit = "{unit}" }}\ntwice = "2*own"\nplain = "{formula}*1"'
    found = seen(said)
    np.testing.assert_allclose(found["own"], found["plain"] / size, rtol=1e-12)
    np.testing.assert_allclose(found["own_error"], found["plain_error"] / size, rtol=1e-9)
    np.testing.assert_allclose(found["twice"], 2 * found["own"])
    one = study(said)
    assert (expressions.unit(one, "own"), expressions.unit(one, "twice")) == (unit, "1")
    assert loads(dumps(one), default_name=one.name).expressions == one.expressions


def test_the_error_of_an_expression_is_that_of_its_observables() -> None:
    found = seen('twice = "2*kappa_max/kappa_mean"\nmany = "bends > 5"')
    share = found["kappa_max_error"] / found["kappa_max"] if "kappa_max_error" in found else 0
    share = share + found["kappa_mean_error"] / found["kappa_mean"]
    np.testing.assert_allclose(found["twice_error"], found["twice"] * share, rtol=1e-2)
    assert "many_error" not in found
    assert study('many = "bends > 5"').columns[-1] == "many"


def test_an_expression_without_a_value_is_remarked_and_its_neighbours_have_theirs() -> None:
    one = study('share = "1/(E - 1e4*N/cm**2)"')
    sol = solve(one.case(), stations=11)
    found, ((why, where),) = values_of(one, sol, {"E": np.array([1e4, 2e4, 1e4, 2e4]), "F3": np.ones(4)})
    assert np.isnan(found["share"]).tolist() == [True, False, True, False]
    assert why == "share is not defined: it divides by 'E - 10000.0 * N / cm ** 2', which is 0"
    assert where.tolist() == [True, False, True, False]


def test_an_observable_of_the_study_and_of_a_law_may_be_an_expression() -> None:
    law = f"{LAW}observable = 'lift'\ndirection = 'falls'\n"
    one = study(
        'lift = "attached < 0.9"', HEAD.replace("stations", 'observables = ["bends", "lift"]\nstations') + AXES + law
    )
    assert one.wanted == ["bends", "lift"]


def test_a_law_stores_the_observables_that_its_formula_uses() -> None:
    law = f"{LAW}kind = 'bounded'\nobservable = 'kappa_max'\nmost = '2*kappa_mean + 0/L'\n"
    one = study('x = "bends"', HEAD.replace("stations", "observables = []\nstations") + AXES + law)
    assert set(one.wanted) == {"x", "kappa_max", "kappa_mean"}
