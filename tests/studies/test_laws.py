"""Verdicts on made-up numbers, where the right answer is seen at a glance."""

import numpy as np
import pytest
from scipy.stats import kendalltau

from solver import InputError
from studies import load
from studies.laws.case_rows import Grid
from studies.laws.judgement import Law, by_line, decide
from studies.laws.law_verdict import LawVerdict
from studies.laws.law_words import sentence
from studies.laws.line_verdicts import (
    DIRECTIONS,
    FAILS,
    HOLDS,
    QUALIFIED,
    TREND,
    UNDECIDED,
    Direction,
    Line,
    Verdict,
    judge,
    judge_direction,
    line_of,
)

LAW = Law(claim="(1)", observable="bends", axis="E", direction="falls", source="a sentence")


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


def test_pairs_across_a_crossing_are_not_counted_in_tau() -> None:
    row = np.array([1.0, 3, 2, 4, 0, 1, 2, 3])
    cut = np.zeros(7, dtype=bool)
    cut[3] = True
    left, right = kendalltau(range(4), row[:4]), kendalltau(range(4), row[4:])  # six pairs each, none equal
    assert judge(row, "rises", crossing=cut).tau == pytest.approx((left.statistic + right.statistic) / 2)


def test_cases_that_a_refinement_added_may_refute_a_law_and_do_not_weigh_in_its_trend() -> None:
    """Two that are nearly equal do not stand still either."""
    x = np.arange(9.0)
    near = 4.0 + np.linspace(1e-12, 1e-11, 40)
    rising, dipping = x, np.where(x == 4, 2.5, x)
    for even, dip, verdict, wrong in ((rising, 0.0, HOLDS, 0), (rising, 1.0, TREND, 1), (dipping, 0.0, TREND, 1)):
        added = np.interp(near, x, even) - dip * (near == near[20])
        values, is_added = np.insert(even, 5, added), np.insert(np.zeros(9, dtype=bool), 5, np.ones(40, dtype=bool))
        judged = judge_direction(line_of(values, False, added=is_added), "rises")
        assert (judged.verdict, len(judged.exceptions)) == (verdict, wrong)
        assert judged.tau == judge(even, "rises").tau


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
    law = LAW.model_copy(update={"direction": "stays-level", "alternatives": ["turns_around"]})
    row = decide(
        law, {"bends": np.array([3, 3, 3]), "turns_around": np.array([1.0, 1.0, 2.0])}, Grid({"E": [1.0, 2.0, 3.0]})
    )
    assert row["verdict"] == QUALIFIED
    assert row["reason"] == "bends stays level, but turns_around changes at 1 of 2 steps"


def test_the_verdicts_of_the_lines_are_those_that_the_law_counts() -> None:
    rng = np.random.default_rng(5)
    axes = {"E": [3.0, 1.0, 2.0], "R": [1.0, 2.0, 3.0, 4.0], "F1": [1.0, 2.0]}
    grid = rng.integers(0, 3, (3, 4, 2)).astype(float)
    grid[1, 2, 0] = np.nan
    law = Law(claim="c", observable="bends", axis="E", direction="not-rising", source="s")
    found = by_line(law, grid, Grid(axes))
    assert found.shape == (4, 2)
    for r in range(4):
        for f in range(2):
            assert found[r, f] == judge(grid[[1, 2, 0], r, f], "not-rising", True).verdict  # in the rising order of E
    counts = decide(law, {"bends": grid}, Grid(axes))["line_verdicts"]
    assert {verdict: int((found == verdict).sum()) for verdict in counts} == counts
    assert len(counts) > 1


WRONG = {
    "equals": ({"formula": 3.0, "relative": 0.05}, "3 of 3 cases miss the 5 %"),
    "bounded": ({"most": 2.0}, "2 of 3 cases outside"),
    "scales": ({"exponent": 1.0, "within": 0.1}, "exponent 2"),
    "boundary": ({"passes": 2.0, "x": 3.5, "within": 0.1}, "passes between 1 and 2"),
    "monotone": ({"direction": "falls"}, "2 of 2 steps the wrong way; tau -1.00"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_a_false_law_of_every_kind_says_why_and_where(kind: str) -> None:
    rule, why = WRONG[kind]
    law = Law(claim="c", kind=kind, observable="kappa_max", axis="E", source="s", **rule)
    row = decide(law, {"kappa_max": np.array([1.0, 4.0, 9.0])}, Grid({"E": [1.0, 2.0, 3.0]}))
    assert row.verdict == FAILS
    assert why in row.reason
    assert row.where.startswith("false")
    assert sentence(row).count(why) == (why not in row.measured)  # which is said once, behind the sentence


def test_of_a_constant_a_law_says_only_that_it_does_not_change() -> None:
    law = Law(claim="c", observable="kappa_max", axis="E", direction="falls", source="s")
    row = decide(law, {"kappa_max": np.full(9, 3.0)}, Grid({"E": np.arange(9.0)}))
    assert sentence(row) == "false: it does not change"


def test_a_verdict_knows_the_types_of_all_its_attributes() -> None:
    row = decide(LAW, {"bends": np.arange(3.0)}, Grid({"E": np.arange(3.0)}))
    assert {*row} == {*LawVerdict.__annotations__}


def test_a_verdict_has_names_and_is_selected_by_words() -> None:
    run = load("fig7_3_start_angle").run()
    first = run.verdicts["bends"]
    assert (first.claim, first.law, first.verdict) == ("(3)", "bends rises along beta0", "true")
    assert (first.measured, first.where, first.reason) == ("4 → 7", "everywhere", "")
    assert first is run.verdicts[0] is run.verdicts["(3) bends"] is run.verdicts["BENDS rises"]
    assert (first["verdict"], first["measured"]) == (first.verdict, first.measured)
    with pytest.raises(InputError, match=r"2 laws are '\(3\)'; choose one: \(3\) bends rises along beta0; \(3\) kappa"):
        run.verdicts["(3)"]
    with pytest.raises(InputError, match=r"no law is 'push'; there are: \(3\) bends"):
        run.verdicts["push"]
    with pytest.raises(AttributeError, match="no 'measure', did you mean 'measured'"):
        first.measure  # noqa: B018


def test_where_a_law_is_false_is_said() -> None:
    law = Law(claim="(1)", observable="bends", axis="E", direction="falls", source="s", at={"R": 1.0})
    wrong = np.array([[5, 6, 4], [5, 4, 3]]).T
    row = decide(law, {"bends": wrong}, Grid({"E": [1.0, 2.0, 3.0], "R": [1.0, 2.0]}))
    assert (row.verdict, row.where) == ("false", "at R = 1; true for 1 of 2 values of R; false from E = 1 to 2")
    whole = decide(law.model_copy(update={"at": {}}), {"bends": wrong}, Grid({"E": [1.0, 2.0, 3.0], "R": [1.0, 2.0]}))
    assert whole.where == "true for 1 of 2 values of R; false from E = 1 to 2, R = 1"


def test_the_reasons_of_several_lines_are_one_sentence_and_name_the_other_axes() -> None:
    law = Law(claim="(1)", observable="height", axis="E", direction="falls", source="s")
    axes = {"E": [1.0, 2.0, 3.0], "R": [1.0, 2.0, 3.0]}
    values = np.array([[3.0, np.nan, 3.0], [2.0, 2.0, np.nan], [1.0, 1.0, np.nan]])
    crossing = np.array([[False, True, True], [False, True, True]])
    row = decide(law, {"height": values}, Grid(axes, crossing))
    said = "on 2 of 3 lines 3 of 6 cases have no value and 4 of 4 steps cross to another branch of equilibria"
    assert (row.verdict, row.reason) == (UNDECIDED, said)
    assert sentence(row).startswith(f"not decided: {said}; true for 1 of 3 values of R, 2 not decided")
    single = decide(law, {"height": values[:, 1]}, Grid({"E": axes["E"]}, crossing[:, 1]))
    assert single.reason == "1 of 3 cases has no value; 2 of 2 steps cross to another branch of equilibria"


def test_a_reason_that_some_lines_have_says_on_how_many_and_what_the_others_do() -> None:
    law = Law(claim="(1)", observable="bends", axis="E", direction="falls", source="s")
    values = np.array([[0, 2, 0], [1, 2, 1], [2, 2, 1]])
    row = decide(law, {"bends": values}, Grid({"E": [1.0, 2.0, 3.0], "R": [1.0, 2.0, 3.0]}))
    assert row.reason == "it rises instead on 2 of 3 lines; it does not change on 1 of 3 lines"


def test_a_law_that_is_decided_at_one_axis_counts_its_lines_over_all_others() -> None:
    law = Law(claim="(1)", observable="height", axis="E", direction="falls", source="s", at={"R": 1.0})
    values = np.ones((3, 2, 2)) * np.array([3.0, 2.0, 1.0])[:, None, None]
    values[:, 1, 1] = 1.0, 2.0, 3.0
    row = decide(law, {"height": values}, Grid({"E": [1.0, 2.0, 3.0], "R": [1.0, 2.0], "F1": [1.0, 2.0]}))
    assert row.reason == "true for 3 of 4 pairs of R and F1 (judged at R = 1)"


@pytest.mark.parametrize(("said", "meant"), [("rising", "rises"), ("increasing", "rises"), ("falling", "falls")])
def test_a_direction_in_another_form_of_the_verb_is_understood(said: str, meant: str) -> None:
    with pytest.raises(ValueError, match=f"no direction '{said}', did you mean '{meant}'"):
        Law(claim="(1)", observable="bends", axis="E", direction=said, source="s")
