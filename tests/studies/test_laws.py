"""Verdicts on made-up numbers, where the right answer is seen at a glance."""

import numpy as np
import pytest
from scipy.stats import kendalltau

from solver import InputError
from studies.laws import FAILS, HOLDS, TREND, Law, decide, judge, refused

LAW = Law(claim="(1)", observable="turns", axis="E", direction="falls", source="a sentence")


def test_a_monotone_row_holds_in_its_direction_and_fails_in_the_other() -> None:
    rising = [1.0, 2.0, 3.5, 4.0]
    assert judge(rising, "rises").verdict == HOLDS
    assert judge(rising, "falls").verdict == FAILS
    assert judge(rising[::-1], "falls").verdict == HOLDS


def test_a_count_may_pause_but_a_measure_may_not() -> None:
    pausing = [8, 8, 7, 7, 7, 6, 5]
    assert judge(pausing, "falls").verdict == HOLDS
    assert judge([float(v) for v in pausing], "falls").verdict != HOLDS
    assert judge([float(v) for v in pausing], "falls", count=True).verdict == HOLDS


def test_a_count_that_never_changes_does_not_rise_and_does_not_fall_but_is_not_falling() -> None:
    constant = [7, 7, 7]
    assert judge(constant, "rises").verdict == FAILS
    assert judge(constant, "falls").verdict == FAILS
    assert judge(constant, "rises").reason == "it does not change"
    assert judge(constant, "not-falling").reason == "it does not change"  # it holds, but says how
    assert judge([1, 1, 2], "not-falling").reason == ""
    assert judge(constant, "not-falling").verdict == HOLDS


def test_one_step_back_among_nine_is_a_trend_with_its_exception_shown() -> None:
    verdict = judge([1.0, 2, 3, 4, 6, 5, 7, 8, 9], "rises")
    assert verdict.verdict == TREND
    assert verdict.exceptions == [(4, 5)]
    assert verdict.tau == pytest.approx(34 / 36)  # one wrong pair of 36


def test_a_trend_needs_a_tau_of_four_fifths() -> None:
    good, poor = [1.0, 2, 3, 5, 4], [1.0, 2, 5, 3, 4]  # 1 and 2 wrong pairs of 10: tau 0.8 and 0.6
    assert judge(good, "rises").verdict == TREND
    assert judge(poor, "rises").verdict == FAILS


def test_tau_is_kendalls_tau_b() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        row = rng.integers(0, 5, 9)
        if np.ptp(row):
            assert judge(row, "rises").tau == pytest.approx(kendalltau(np.arange(9), row).statistic)
            assert judge(row, "falls").tau == pytest.approx(-kendalltau(np.arange(9), row).statistic)


def test_an_unsolved_case_makes_the_law_fail_and_says_so() -> None:
    verdict = judge([3.0, np.nan, 1.0], "falls")
    assert verdict.verdict == FAILS
    assert verdict.reason == "1 of 3 cases unsolved"


def test_rounding_is_no_change() -> None:
    assert judge([1.0, 1.0 + 1e-14, 1.0 + 2e-14], "rises").verdict == FAILS
    assert judge([1.0, 1.0 - 1e-14, 2.0], "not-falling").verdict == HOLDS


@pytest.mark.parametrize("values", [[], [[1.0, 2.0]], ["a", "b"], 3.0])
def test_what_is_not_a_row_of_numbers_is_refused(values: object) -> None:
    with pytest.raises(InputError, match="one row of numbers"):
        judge(values, "rises")  # type: ignore[arg-type]


def test_an_unknown_direction_is_refused_with_the_choices() -> None:
    with pytest.raises(InputError, match="'up'; choose from rises, falls, not-falling, not-rising"):
        judge([1, 2], "up")


def test_the_axis_is_judged_in_rising_order_however_it_is_stored() -> None:
    row = decide(LAW, {"turns": [5, 6, 8]}, {"E": [3.0, 2.0, 1.0]})
    assert row["verdict"] == HOLDS
    assert (row["first"], row["last"]) == ([8.0, 8.0], [5.0, 5.0])


def test_on_a_grid_the_worst_line_decides_and_the_lines_that_hold_are_counted() -> None:
    grid = np.array([[9, 9, 1], [8, 8, 2], [7, 7, 3]])  # along E; the third line rises
    row = decide(LAW, {"turns": grid}, {"E": [1.0, 2, 3], "R": [0.5, 1.0, 1.5]})
    assert row["verdict"] == FAILS
    assert (row["lines"], row["lines_hold"]) == (3, 2)
    assert [(e["from"], e["to"], e["values"], e["at"]) for e in row["exceptions"]] == [
        (1.0, 2.0, [1, 2], {"R": 1.5}),
        (2.0, 3.0, [2, 3], {"R": 1.5}),
    ]


def test_on_a_grid_the_law_goes_along_its_own_axis() -> None:
    grid = np.array([[3.0, 1.0], [4.0, 2.0]])  # rises along E, falls along R
    axes = {"E": [1.0, 2.0], "R": [1.0, 2.0]}
    rises = LAW.model_copy(update={"observable": "kappa_max", "direction": "rises"})
    assert decide(rises, {"kappa_max": grid}, axes)["verdict"] == HOLDS
    assert decide(rises.model_copy(update={"axis": "R"}), {"kappa_max": grid}, axes)["verdict"] == FAILS


def test_a_law_decided_at_a_value_of_the_other_axis_counts_the_other_lines_too() -> None:
    grid = np.array([[9, 9, 1], [8, 8, 2], [7, 7, 3]])  # along E; the third line rises
    axes = {"E": [1.0, 2, 3], "R": [0.5, 1.0, 1.5]}
    good = decide(LAW.model_copy(update={"at": {"R": 0.9}}), {"turns": grid}, axes)
    assert (good["verdict"], good["at"], good["exceptions"]) == (HOLDS, {"R": 1.0}, [])
    assert (good["lines"], good["lines_hold"], good["first"]) == (3, 2, [9.0, 9.0])
    bad = decide(LAW.model_copy(update={"at": {"R": 9.0}}), {"turns": grid}, axes)
    assert (bad["verdict"], bad["at"]) == (FAILS, {"R": 1.5})


def test_a_law_that_cannot_be_tested_fails_for_a_reason_in_a_row_like_the_others() -> None:
    law = LAW.model_copy(update={"also": ["wraps"]})
    row = refused(law, "no such shape")
    other = decide(law, {"turns": [2, 1], "wraps": [2.0, 1.0]}, {"E": [1.0, 2.0]})
    assert (row["verdict"], row["reason"], row["also"][0]["verdict"]) == (FAILS, "no such shape", FAILS)
    assert (row.keys(), row["also"][0].keys()) == (other.keys(), other["also"][0].keys())


def test_other_observables_that_the_sentence_admits_get_verdicts_of_their_own() -> None:
    law = LAW.model_copy(update={"also": ["wraps"]})
    row = decide(law, {"turns": [3, 2, 1], "wraps": [1.0, 2.0, 3.0]}, {"E": [1.0, 2.0, 3.0]})
    assert row["verdict"] == HOLDS
    assert [(also["observable"], also["verdict"]) for also in row["also"]] == [("wraps", FAILS)]


def test_a_law_on_what_is_not_there_is_refused() -> None:
    with pytest.raises(InputError, match="needs 'turns'; there are wraps"):
        decide(LAW, {"wraps": [1.0]}, {"E": [1.0]})
    with pytest.raises(InputError, match="no axis 'E'; choose from R"):
        decide(LAW, {"turns": [1]}, {"R": [1.0]})


@pytest.mark.parametrize("size", [257, 1000, 2500])
def test_the_trend_of_a_long_row_is_kendalls_tau(size: int) -> None:
    random = np.random.default_rng(size)
    measured = np.arange(size) + random.normal(0, size / 4, size)
    counted = np.round(measured / 50)  # many ties
    for row in (measured, counted):
        ours = judge(row, "rises").tau
        theirs = kendalltau(np.arange(size), row).statistic  # tau-b as well
        assert ours == pytest.approx(theirs, rel=1e-12)  # rounding of one division


def test_a_row_too_long_for_all_its_pairs_is_judged() -> None:
    row = np.arange(2e5)
    row[[10, 20]] = row[[20, 10]]
    verdict = judge(row, "rises")
    assert (verdict.verdict, len(verdict.exceptions)) == (TREND, 2)
    assert verdict.tau == pytest.approx(1, abs=1e-8)  # 19 wrong pairs of 2e10
