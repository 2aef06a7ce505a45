"""Laws with numbers on made-up lines, where the right verdict is seen at a glance."""

import json
from typing import Any

import numpy as np
import pytest
from scipy.stats import linregress, t

from studies.language.loader import loads
from studies.laws.law import Law
from studies.laws.law_kinds import fit_power, passes
from studies.laws.verdicts import FAILS, HOLDS, UNDECIDED, decide, refusal

X = np.array([1.0, 2.0, 3.0, 4.0])
HEAD = 'title = "one"\nreading = "force-first/tension/paper"\n[units]\nlength = "cm"\nforce = "N"\n'
AXES = "[axes.E]\nvalues = [1e4, 2e4]\n[axes.beta]\nvalues = [0.3, 0.6]\n"


def law(kind: str, **rule: Any) -> Law:
    return Law(claim="(1)", kind=kind, observable="height", axis="E", source="a sentence", **rule)


def row(one: Law, values: Any, x: Any = X, crossing: Any = None, **known: Any) -> dict[str, Any]:
    found = decide(one, {"height": np.asarray(values, dtype=float)}, {"E": x}, crossing, (), known)
    json.dumps(found, allow_nan=False)  # as reports and files hold it
    return found


def verdict(one: Law, values: Any, **known: Any) -> str:
    return str(row(one, values, **known)["verdict"])


def test_equals_holds_where_every_case_is_within_the_tolerance_and_says_the_largest_difference() -> None:
    one = law("equals", formula="2*E", relative=0.01)
    found = row(one, [2.0, 4.02, 6.0, 8.0], E=X)
    assert (found["verdict"], found["found"]) == (HOLDS, "at most 0.5 % off, at E = 2")
    assert found["numbers"] == {"off": pytest.approx(0.005), "at": 2.0}
    found = row(one, [2.0, 4.1, 6.0, 8.5], E=X)
    assert (found["verdict"], found["found"]) == (FAILS, "at most 6.25 % off, at E = 4")
    assert [(e["from"], e["to"]) for e in found["exceptions"]] == [(2, 2), (4, 4)]
    assert (found["steps"], found["counted"]) == (4, "cases outside")


def test_an_absolute_tolerance_is_in_the_unit_of_the_observable() -> None:
    one = law("equals", formula=3.0, absolute=0.5)
    assert verdict(one, [3.5, 2.5, 3.0, 3.0]) == HOLDS
    found = row(one, [3.6, 2.5, 3.0, 3.0])
    assert (found["verdict"], found["found"]) == (FAILS, "at most 0.6 off, at E = 1")


def test_the_sign_of_a_formula_counts_and_a_formula_of_zero_allows_no_relative_difference() -> None:
    assert verdict(law("equals", formula="-E", relative=0.01), -X, E=X) == HOLDS
    assert verdict(law("equals", formula="-E", relative=0.01), X, E=X) == FAILS
    assert verdict(law("equals", formula=0.0, relative=0.5), [0.0, 0, 0, 0]) == HOLDS
    assert verdict(law("equals", formula=0.0, relative=0.5), [0.0, 0, 1e-9, 0]) == FAILS


@pytest.mark.parametrize(
    "kind, rule", [("equals", {"formula": "E", "relative": 0.01}), ("bounded", {"least": "E", "most": 9})]
)
def test_a_missing_value_decides_nothing_and_a_wrong_one_fails_whatever_is_missing(kind: str, rule: Any) -> None:
    one = law(kind, **rule)
    found = row(one, [1.0, np.nan, 3.0, 4.0], E=X)
    assert (found["verdict"], found["reason"]) == (UNDECIDED, "1 of 4 cases have no value")
    assert verdict(one, [0.5, np.nan, 3.0, 4.0], E=X) == FAILS
    assert verdict(one, [np.nan] * 4, E=X) == UNDECIDED


def test_a_formula_without_a_value_says_why() -> None:
    found = row(law("equals", formula="1/(E - 2)", relative=9.0), [1.0, 1, 1, 1], E=X)
    assert found["verdict"] == UNDECIDED
    assert found["reason"] == "the formula has no value in 1 of 4 cases (division by zero: 'E - 2' is 0)"


def test_bounds_hold_including_their_ends() -> None:
    assert verdict(law("bounded", least=1.0, most=4.0), X) == HOLDS
    assert row(law("bounded", least=1.5), X)["found"] == "1 to 4"
    assert verdict(law("bounded", least=1.5), X) == verdict(law("bounded", most="E/2"), X, E=X) == FAILS
    assert verdict(law("bounded", most="E"), X, E=X) == HOLDS


def test_a_power_law_has_the_exponent_and_interval_of_a_regression_of_logarithms() -> None:
    rng = np.random.default_rng(3)
    x = np.geomspace(1, 50, 12)
    y = 3 * x**-1.5 * np.exp(rng.normal(0, 0.02, 12))
    exponent, half, factor = fit_power(x, y)
    fit = linregress(np.log(x), np.log(y))
    assert exponent == pytest.approx(fit.slope, rel=1e-12)
    assert half == pytest.approx(t.ppf(0.975, 10) * fit.stderr, rel=1e-9)
    assert factor == pytest.approx(np.exp(fit.intercept), rel=1e-12)


def test_the_interval_of_an_exponent_holds_the_true_one_in_95_of_100_repetitions() -> None:
    rng = np.random.default_rng(4)
    x = np.geomspace(1, 10, 8)
    inside = 0
    for _ in range(2000):
        exponent, half, _factor = fit_power(x, 2 * x**0.7 * np.exp(rng.normal(0, 0.1, 8)))
        inside += abs(exponent - 0.7) <= half
    assert inside / 2000 == pytest.approx(0.95, abs=0.015)  # three standard deviations


def test_a_power_law_holds_fails_or_is_left_open_by_its_interval() -> None:
    assert verdict(law("scales", exponent=2.0, within=0.01), 5 * X**2) == HOLDS
    assert verdict(law("scales", exponent=2.0, within=0.01), -5 * X**2, x=-X) == HOLDS  # sizes count
    assert verdict(law("scales", exponent=2.0, within=0.01), X**2.1) == FAILS
    noisy = X**2 * np.array([1.1, 0.9, 1.1, 0.9])
    found = row(law("scales", exponent=2.0, within=0.2), noisy)
    assert found["verdict"] == UNDECIDED
    assert found["reason"] == "the interval of the exponent reaches beyond ± 0.2"
    assert verdict(law("scales", exponent=2.0, within=2.0), noisy) == HOLDS
    assert row(law("scales", exponent=2.0, within=2.0), [1.0, np.nan, 9.0, 16.0])["verdict"] == UNDECIDED
    assert row(law("scales", exponent=1.0, within=1.0), [-1.0, 1.0, 2.0, 3.0])["reason"] == (
        "the observable is 0 or changes its sign, so it is no power"
    )
    assert verdict(law("scales", exponent=1.0, within=1.0), [1.0, 2.0], x=[1.0, 2.0]) == UNDECIDED


def test_a_boundary_holds_where_both_neighbours_are_near_it() -> None:
    values = [0.1, 0.3, 0.6, 0.9]
    found = row(law("boundary", passes=0.5, x=2.5, within=0.5), values)
    assert (found["verdict"], found["found"]) == (HOLDS, "passes between 2 and 3")
    assert found["numbers"] == {"from": 2.0, "to": 3.0, "at": pytest.approx(2 + 2 / 3)}
    assert verdict(law("boundary", passes=0.5, x=2.5, within=0.5), values[::-1]) == HOLDS
    assert verdict(law("boundary", passes=0.5, x=4.0, within=0.9), values) == FAILS
    found = row(law("boundary", passes=0.5, x=2.5, within=0.4), values)
    assert found["verdict"] == UNDECIDED
    assert found["reason"] == "the step is wider than ± 0.4 about the value of x"
    assert verdict(law("boundary", passes="E/6", x="5*E/E", within=1.0), values, E=X) == FAILS
    assert row(law("boundary", passes=2.0, x=2.5, within=9.0), values)["found"] == "it does not pass"


def test_a_boundary_that_is_passed_twice_fails_and_one_that_may_hide_is_left_open() -> None:
    one = law("boundary", passes=0.5, x=2.5, within=2.0)
    found = row(one, [0.1, 0.9, 0.1, 0.1])
    assert (found["verdict"], found["reason"]) == (FAILS, "it passes 2 times")
    assert verdict(one, [0.1, np.nan, 0.9, 0.9]) == UNDECIDED
    assert verdict(one, [0.1, 0.2, np.nan, 0.4]) == UNDECIDED
    cut = np.array([False, True, False])
    assert row(one, [0.1, 0.2, 0.9, 0.9], crossing=cut)["verdict"] == UNDECIDED


def test_passing_pairs_are_those_of_neighbouring_known_values() -> None:
    level = np.array([-1.0, np.nan, 2.0, 0.0, -3.0])
    none = np.zeros(4, dtype=bool)
    assert passes(level, none) == [(0, 2), (3, 4)]  # 0 counts as positive
    assert passes(level, np.array([True, False, False, False])) == [(3, 4)]


def test_the_worst_line_of_a_grid_decides_or_the_one_at_a_value() -> None:
    one = law("equals", formula="E*R", relative=0.01)
    grid = X[:, None] * np.array([1.0, 2.0])
    grid[3, 1] *= 1.5
    axes = {"E": X, "R": [1.0, 2.0]}
    known = {"E": np.broadcast_to(X[:, None], (4, 2)), "R": np.broadcast_to([1.0, 2.0], (4, 2))}
    found = decide(one, {"height": grid}, axes, None, (), known)
    assert (found["verdict"], found["lines_hold"], found["found"]) == (FAILS, 1, "at most 50 % off, at E = 4")
    assert found["exceptions"] == [{"from": 4.0, "to": 4.0, "values": [12.0, 12.0], "at": {"R": 2.0}}]
    near = law("equals", formula="E*R", relative=0.01, at={"R": 1.1})
    assert decide(near, {"height": grid}, axes, None, (), known)["verdict"] == "qualified"


def test_the_values_of_a_formula_follow_the_order_of_the_axis() -> None:
    """The axis falls in the file; the line that is judged rises."""
    found = row(law("equals", formula="1 + E", relative=1e-9), (1 + X)[::-1], x=X[::-1], E=X[::-1])
    assert found["verdict"] == HOLDS


def test_a_law_that_could_not_be_tested_has_the_keys_of_one_that_was() -> None:
    one = law("equals", formula="E", relative=0.01)
    assert set(refusal(one, "why")) == set(row(one, X, E=X))


def test_the_number_0_fits_every_unit_as_a_bound() -> None:
    said = "kind = 'bounded'\nleast = '0'\nmost = '-(0)'\n"
    loads(f"{HEAD}{AXES}[[laws]]\nclaim = 'a'\nobservable = 'height'\naxis = 'E'\nsource = 's'\n{said}")


def test_the_place_of_a_boundary_on_an_axis_of_angles_may_be_text() -> None:
    said = "kind = 'boundary'\npasses = 1\nx = '30deg'\nwithin = 0.1\n"
    study = loads(f"{HEAD}{AXES}[[laws]]\nclaim = 'a'\nobservable = 'turns'\naxis = 'beta'\nsource = 's'\n{said}")
    assert study.laws[0].x == pytest.approx(np.pi / 6)
