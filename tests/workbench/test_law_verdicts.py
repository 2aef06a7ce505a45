"""Verdicts of stored datasets: steps between branches, the exit status, and the reason wherever a verdict is told."""

import numpy as np
import pytest
import xarray as xr

from studies.laws.line_verdicts import FAILS, HOLDS, QUALIFIED, TREND, UNDECIDED
from tests.workbench import small
from workbench.store import in_memory, law_verdicts

AXES = small.axis("E", [1e4, 2e4, 4e4]) + small.axis("R", [0.5, 0.75, 1.0, 1.25])
LAW = small.law("kappa_max", "R", "falls", claim="(2)", alternatives=["amplitude"])


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    return in_memory.run(small.study(AXES + LAW))


def with_branch(ds: xr.Dataset, branch: object) -> xr.Dataset:
    return ds.assign(branch=(("E", "R"), np.broadcast_to(branch, (3, 4))))


@pytest.mark.parametrize(
    ("branch", "crosses"),
    [
        ([0, 0, 0, 0], [False, False, False]),
        ([0, 0, 1, 1], [False, True, False]),
        ([0, -1, 0, 0], [False, False, False]),  # the unsolved case is on no branch
        ([0, -1, 1, 1], [False, True, False]),
        ([-1, 2, 2, -1], [False, False, False]),
        ([0, 1, 0, 1], [True, True, True]),
    ],
)
def test_steps_between_two_numbers_of_a_branch_cross(ds: xr.Dataset, branch: list[int], crosses: list[bool]) -> None:
    found = law_verdicts.crossings(with_branch(ds, branch), "R")
    assert found is not None
    assert found.tolist() == [crosses] * 3
    across = law_verdicts.crossings(with_branch(ds, branch), "E")
    assert across is not None
    assert across.shape == (2, 4)
    assert not across.any()
    assert law_verdicts.crossings(ds, "R") is None


def test_steps_are_those_of_the_rising_axis_however_it_is_stored(ds: xr.Dataset) -> None:
    turned = with_branch(ds, [0, 0, 0, 1]).isel(R=[3, 1, 0, 2])
    found = law_verdicts.crossings(turned, "R")
    assert found is not None
    assert found.tolist() == [[False, False, True]] * 3


def test_a_law_is_not_decided_where_its_steps_cross_branches_and_fails_where_the_others_say_so(ds: xr.Dataset) -> None:
    (row,) = law_verdicts.verdicts(ds)
    assert row["verdict"] == QUALIFIED
    (row,) = law_verdicts.verdicts(with_branch(ds, [0, 0, 1, 1]))
    assert (row["verdict"], row["exceptions"]) == (UNDECIDED, [])
    assert row["reason"] == "1 of 3 steps crosses to another branch of equilibria"
    mask = {"R": np.broadcast_to([False, True, False], (3, 3))}
    assert law_verdicts.verdicts(ds, mask) == law_verdicts.verdicts(with_branch(ds, [0, 0, 1, 1]))
    rising = with_branch(ds.assign(kappa_max=-ds["kappa_max"]), [0, 0, 1, 1])
    assert law_verdicts.verdicts(rising)[0]["verdict"] == FAILS


@pytest.mark.parametrize(
    ("verdict", "status", "refuted"),
    [(HOLDS, 0, False), (TREND, 0, False), (QUALIFIED, 1, False), (UNDECIDED, 1, True), (FAILS, 1, True)],
)
def test_the_exit_status_is_0_where_every_law_holds_in_full(verdict: str, status: int, refuted: bool) -> None:
    rows = [{"verdict": HOLDS}, {"verdict": verdict}]
    assert law_verdicts.status(0, rows) == status
    assert law_verdicts.is_refuted(0, rows) == refuted
    assert (law_verdicts.status(1, []), law_verdicts.is_refuted(1, [])) == (1, True)
