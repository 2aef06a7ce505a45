"""Verdicts on made-up numbers, where the right answer is seen at a glance."""

import numpy as np
import pytest
from scipy.stats import kendalltau

from studies.laws.line_verdicts import DIRECTIONS, Direction, Line, Verdict
from studies.laws.verdicts import (
    FAILS,
    HOLDS,
    QUALIFIED,
    TREND,
    UNDECIDED,
    VERDICTS,
    Law,
    by_line,
    decide,
    judge,
    refusal,
    worst,
)

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


def test_an_unsolved_case_leaves_the_law_undecided_and_says_so() -> None:
    verdict = judge([3.0, np.nan, 1.0], "falls")
    assert verdict.verdict == UNDECIDED
    assert verdict.reason == "1 of 3 cases unsolved"
    assert judge([np.nan, np.nan], "falls").verdict == UNDECIDED


def test_a_law_fails_for_all_its_unsolved_cases_where_the_solved_ones_rule_out_even_a_trend() -> None:
    verdict = judge([1.0, 2.0, 3.0, np.nan, 1.5], "falls")  # 2 pairs of 6 fall: tau is at most 0.2
    assert verdict.verdict == FAILS
    assert verdict.exceptions == [(0, 1), (1, 2)]
    assert verdict.reason == "1 of 5 cases unsolved; the other steps rule out even a trend"


@pytest.mark.parametrize(
    "direction",
    [
        "rises",
        pytest.param("falls", marks=pytest.mark.slow),
        pytest.param("not-falling", marks=pytest.mark.slow),
        pytest.param("not-rising", marks=pytest.mark.slow),
    ],
)
def test_what_is_missing_could_have_decided_either_way_where_a_law_is_undecided_and_never_where_it_fails(
    direction: str,
) -> None:
    """Brute force: every way to fill in the missing case."""
    random = np.random.default_rng(7)
    seen = set()
    for _ in range(300):
        row = random.integers(0, 5, 6).astype(float)
        row[random.integers(6)] = np.nan
        fill = np.arange(-1, 5.5, 0.5)
        possible = {judge(np.where(np.isnan(row), value, row), direction).verdict for value in fill}
        verdict = judge(row, direction).verdict
        seen.add(verdict)
        assert verdict in (UNDECIDED, FAILS)
        assert verdict == UNDECIDED or possible == {FAILS}
    assert seen == {UNDECIDED, FAILS}


def test_one_value_decides_nothing() -> None:
    for direction in ("rises", "not-falling"):
        assert judge([1.0], direction).verdict == UNDECIDED


def test_a_step_across_branches_is_never_evidence() -> None:
    values, cut = [1.0, 2.0, 0.5, 1.5], [False, True, False]
    assert judge(values, "rises").verdict == FAILS
    across = judge(values, "rises", crossing=cut)  # rises on each of the two branches
    assert (across.verdict, across.exceptions) == (UNDECIDED, [])
    assert across.reason == "1 of 3 steps crosses to another branch of equilibria"
    assert judge([1.0, 2.0, 3.0, 4.0], "rises", crossing=cut).verdict == UNDECIDED  # nor is it evidence for the law
    falling = judge([4.0, 3.0, 9.0, 8.0], "rises", crossing=cut)
    assert (falling.verdict, falling.exceptions) == (FAILS, [(0, 1), (2, 3)])
    assert falling.reason.startswith("1 of 3 steps crosses to another branch of equilibria; ")


def test_pairs_across_a_crossing_are_not_counted_in_tau() -> None:
    row = np.array([1.0, 3, 2, 4, 0, 1, 2, 3])
    cut = np.zeros(7, dtype=bool)
    cut[3] = True
    left, right = kendalltau(range(4), row[:4]), kendalltau(range(4), row[4:])  # six pairs each, none equal
    assert judge(row, "rises", crossing=cut).tau == pytest.approx((left.statistic + right.statistic) / 2)


def test_rounding_is_no_change() -> None:
    assert judge([1.0, 1.0 + 1e-14, 1.0 + 2e-14], "rises").verdict == FAILS
    assert judge([1.0, 1.0 - 1e-14, 2.0], "not-falling").verdict == HOLDS


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
    assert (good["verdict"], good["at"], good["exceptions"]) == (QUALIFIED, {"R": 1.0}, [])
    assert good["qualifications"] == ["on part of the grid"]
    assert good["reason"] == "2 of 3 rows agree (judged at R = 1)"
    assert (good["lines"], good["lines_hold"], good["first"]) == (3, 2, [9.0, 9.0])
    assert good["line_verdicts"] == {HOLDS: 2, FAILS: 1}
    bad = decide(LAW.model_copy(update={"at": {"R": 9.0}}), {"turns": grid}, axes)
    assert (bad["verdict"], bad["at"]) == (FAILS, {"R": 1.5})


def test_a_law_that_cannot_be_tested_is_not_decided_for_a_reason_in_a_row_like_the_others() -> None:
    law = LAW.model_copy(update={"also": ["wraps"]})
    row = refusal(law, "no such shape")
    other = decide(law, {"turns": [2, 1], "wraps": [2.0, 1.0]}, {"E": [1.0, 2.0]})
    assert (row["verdict"], row["reason"], row["also"][0]["verdict"]) == (UNDECIDED, "no such shape", UNDECIDED)
    assert (row.keys(), row["also"][0].keys()) == (other.keys(), other["also"][0].keys())


def test_a_law_decided_on_one_line_holds_only_where_every_line_is_as_good() -> None:
    axes = {"E": [1.0, 2, 3, 4, 5], "R": [0.5, 1.0]}
    here = LAW.model_copy(update={"observable": "wraps", "at": {"R": 1.0}})
    falls, trend = [5.0, 4, 3, 2, 1], [5.0, 4, 3, 1, 2]
    for other, own, verdict in ((falls, falls, HOLDS), (falls, trend, TREND), (trend, trend, TREND)):
        row = decide(here, {"wraps": np.array([other, own]).T}, axes)
        assert (row["verdict"], row["qualifications"]) == (verdict, [])
    row = decide(here, {"wraps": np.array([trend, falls]).T}, axes)
    assert (row["verdict"], row["line_verdicts"]) == (QUALIFIED, {HOLDS: 1, TREND: 1})
    row = decide(here, {"wraps": np.array([falls, falls[::-1]]).T}, axes)
    assert (row["verdict"], row["qualifications"]) == (FAILS, [])  # what fails where it is decided is not qualified
    row = decide(here, {"wraps": np.array([[5.0, np.nan, 3, 2, 1], falls]).T}, axes)
    assert row["reason"] == "1 of 2 rows agree, 1 not decided (judged at R = 1)"


def test_a_count_that_stands_still_where_the_sentence_says_it_rises_is_not_contradicted() -> None:
    law = Law(claim="(4)", observable="turns", axis="E", direction="not-falling", says="rises", source="s")
    axes = {"E": [1.0, 2.0, 3.0]}
    level = decide(law, {"turns": [6, 6, 6]}, axes)
    assert (level["verdict"], level["qualifications"]) == (QUALIFIED, ["not contradicted"])
    assert level["reason"] == "turns stays at 6, where the sentence says that it rises"
    assert decide(law, {"turns": [6, 6, 7]}, axes)["verdict"] == HOLDS  # a count may pause
    assert decide(law, {"turns": [6, 7, 6]}, axes)["verdict"] == FAILS
    assert decide(law.model_copy(update={"says": None}), {"turns": [6, 6, 6]}, axes)["verdict"] == HOLDS
    grid = decide(law, {"turns": np.array([[6, 6, 6], [6, 7, 8]]).T}, {**axes, "R": [1.0, 2.0]})
    assert grid["reason"].startswith("turns stays level on 1 of 2 lines, where the sentence")


def test_a_law_depends_on_the_observable_where_an_alternative_fails_and_its_own_does_not() -> None:
    axes = {"R": [1.0, 2.0, 3.0]}
    law = Law(claim="(2)", observable="kappa_max", axis="R", direction="falls", source="s", alternatives=["amplitude"])
    up, down = [1.0, 2.0, 3.0], [3.0, 2.0, 1.0]
    row = decide(law, {"kappa_max": down, "amplitude": up}, axes)
    assert (row["verdict"], row["qualifications"]) == (QUALIFIED, ["depends on the observable"])
    assert row["reason"] == "kappa_max falls, but amplitude rises instead at 2 of 2 steps"
    assert [(also["observable"], also["alternative"], also["verdict"]) for also in row["also"]] == [
        ("amplitude", True, FAILS)
    ]
    assert decide(law, {"kappa_max": down, "amplitude": down}, axes)["verdict"] == HOLDS
    # an observable chosen afterwards does not rescue a law
    assert decide(law, {"kappa_max": up, "amplitude": down}, axes)["verdict"] == FAILS
    # nor does what was not decided speak against it
    assert decide(law, {"kappa_max": down, "amplitude": [3.0, np.nan, 1.0]}, axes)["verdict"] == HOLDS


def test_verdicts_are_ordered_from_best_to_worst() -> None:
    assert VERDICTS == (HOLDS, TREND, QUALIFIED, UNDECIDED, FAILS)
    assert worst([HOLDS, QUALIFIED, TREND]) == QUALIFIED
    assert worst([FAILS, UNDECIDED]) == FAILS


def test_steps_across_branches_are_left_out_along_the_laws_own_axis() -> None:
    axes = {"E": [1.0, 2.0], "R": [1.0, 2.0, 3.0]}
    grid = np.array([[1.0, 2.0, 0.5], [1.0, 2.0, 3.0]])  # along R; on the first line the last step crosses
    law = Law(claim="c", observable="wraps", axis="R", direction="rises", source="s")
    assert decide(law, {"wraps": grid}, axes)["verdict"] == FAILS
    cut = np.array([[False, True], [False, False]])
    row = decide(law, {"wraps": grid}, axes, cut)
    assert (row["verdict"], row["line_verdicts"]) == (UNDECIDED, {HOLDS: 1, UNDECIDED: 1})


def test_other_observables_that_the_sentence_admits_get_verdicts_of_their_own() -> None:
    law = LAW.model_copy(update={"also": ["wraps"]})
    row = decide(law, {"turns": [3, 2, 1], "wraps": [1.0, 2.0, 3.0]}, {"E": [1.0, 2.0, 3.0]})
    assert row["verdict"] == HOLDS
    assert [(also["observable"], also["verdict"]) for also in row["also"]] == [("wraps", FAILS)]


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


def test_a_kind_of_law_words_what_its_observable_and_its_alternatives_do(monkeypatch) -> None:
    def level(line: Line) -> Verdict:
        wrong = np.flatnonzero(np.abs(np.diff(line.values)) > line.noise)
        return Verdict(FAILS if wrong.size else HOLDS, None, [(int(i), int(i) + 1) for i in wrong])

    monkeypatch.setitem(DIRECTIONS, "stays-level", Direction(level, "stays level", "changes"))
    law = LAW.model_copy(update={"direction": "stays-level", "alternatives": ["wraps"]})
    row = decide(law, {"turns": np.array([3, 3, 3]), "wraps": np.array([1.0, 1.0, 2.0])}, {"E": [1.0, 2.0, 3.0]})
    assert row["verdict"] == QUALIFIED
    assert row["reason"] == "turns stays level, but wraps changes at 1 of 2 steps"


def test_the_verdicts_of_the_lines_are_those_that_the_law_counts() -> None:
    rng = np.random.default_rng(5)
    axes = {"E": [3.0, 1.0, 2.0], "R": [1.0, 2.0, 3.0, 4.0], "F1": [1.0, 2.0]}
    grid = rng.integers(0, 3, (3, 4, 2)).astype(float)
    grid[1, 2, 0] = np.nan
    law = Law(claim="c", observable="turns", axis="E", direction="not-rising", source="s")
    found = by_line(law, grid, axes)
    assert found.shape == (4, 2)
    for r in range(4):
        for f in range(2):
            assert found[r, f] == judge(grid[[1, 2, 0], r, f], "not-rising", True).verdict  # in the rising order of E
    counts = decide(law, {"turns": grid}, axes)["line_verdicts"]
    assert {verdict: int((found == verdict).sum()) for verdict in counts} == counts
    assert len(counts) > 1
