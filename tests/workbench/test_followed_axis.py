"""A followed axis over an ends problem: one branch, up to its fold; the same bits whoever solves it."""

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (ds.rod)
from solver import follow, solve
from studies import Study
from studies.language.loader import loads
from tests.slow import slow
from tests.workbench import small
from workbench.run import in_memory

SNAP = {"E": 325.95, "nu": 0.25, "a": 0.25, "R": 0.75, "L": 5.0, "beta0": 0.5, "betaL": 0.5}
FALLING = small.axis("FZ", (2.0, -3.0, 11), follow=True)
FOLD = -0.967071594676  # of `follow`; both signs of height meet there


def study(axes: str = FALLING, base: dict[str, Any] = SNAP) -> Study:
    """A rod that snaps through."""
    text = small.text(base, axes, observables=["height", "index"], outputs=["beta"], stations=21)
    return loads(text, "text", "snap")


@cache
def falling() -> xr.Dataset:
    return in_memory.run(study())


def test_the_cases_before_the_fold_are_one_branch_and_those_beyond_say_where_it_is() -> None:
    ds = falling()
    before = ds["FZ"].values > FOLD
    np.testing.assert_array_equal(ds["solved"], before)
    np.testing.assert_array_equal(ds["branch"], np.where(before, 0, -1))
    assert set(ds["outcome"].values[before]) == {"solved"}
    (said,) = set(ds["outcome"].values[~before])
    assert said.startswith("failed: the followed branch ends in a fold at FZ = ")
    assert float(said.rpartition(" = ")[2]) == pytest.approx(FOLD, abs=1e-9)
    assert ds.attrs["followed"] == "FZ"
    assert np.isnan(ds["height"].values[~before]).all()


def test_without_following_the_same_cases_go_on_on_another_branch() -> None:
    ds = in_memory.run(study(FALLING.replace("follow = true\n", "")))
    assert ds["solved"].all()
    assert (ds["branch"] != 0).any()
    assert "followed" not in ds.attrs


def test_each_case_is_a_point_of_the_branch_of_the_first() -> None:
    ds = falling()
    values = ds["FZ"].values[ds["solved"].values]
    branch = follow(solve(study().case_of({"FZ": 2.0}), stations=21), FZ=[*values[1:], -3.0])
    points = [branch.at(value)[0].solution.beta for value in values]
    np.testing.assert_allclose(ds["beta"].values[: values.size], points, atol=1e-10)


def test_a_rising_axis_begins_at_its_low_end_on_another_branch() -> None:
    ds = in_memory.run(study(small.axis("FZ", (-3.0, 2.0, 11), follow=True)))
    height = falling()["height"]
    assert ds["FZ"].values[0] == -3.0
    assert float(ds["height"][0]) < 0 < float(height[0])


@pytest.mark.parametrize(
    "axis, values, more",
    [
        ("E", (300.0, 280.0), {"FZ": -0.3}),
        ("L", (5.0, 5.2), {"FZ": -0.3}),
        ("R", (0.75, 0.7), {"FZ": -0.3}),
        ("alpha", (0.0, 1.0), {"FZ": -0.3}),
        ("height", (4.2, 4.0), {}),
        slow("M1L", (0.1, 0.2), {"betaL": None, "height": 4.2}),
    ],
)
def test_any_numeric_axis_is_followed(axis: str, values: tuple[float, float], more: dict[str, Any]) -> None:
    first, last = values
    one = study(small.axis(axis, [first, last], follow=True), SNAP | {"betaL": 0.8} | more)
    ds = in_memory.run(one)
    assert ds["outcome"].values.tolist() == ["solved", "solved"]
    from_first = solve(one.case_of({axis: last}), seed=solve(one.case_of({axis: first})), stations=21)
    np.testing.assert_allclose(ds["beta"][1], from_first.beta, atol=1e-9)


def test_a_followed_axis_comes_last_and_each_line_ends_at_its_own_fold() -> None:
    axes = FALLING.replace("11", "6") + "[axes.E]\nvalues = [325.95, 651.9]\n"
    ds = in_memory.run(study(axes))
    assert ds["outcome"].dims == ("E", "FZ")
    for E in (325.95, 651.9):
        line = ds.sel(E=E)
        np.testing.assert_array_equal(line["solved"], line["FZ"].values > FOLD * E / 325.95)  # loads scale with E


def test_a_first_case_without_an_equilibrium_leaves_the_axis_without_any() -> None:
    ds = in_memory.run(study(FALLING.replace("11", "3") + "[equilibrium]\nindex = 9\n"))
    said = ds["outcome"].values.tolist()
    assert said[0].startswith("failed: none of the 1 equilibria found has index 9")
    assert said[1:] == [f"failed: no equilibrium at FZ = {FZ}, from which the axis is followed" for FZ in ("2", "-0.5")]


def test_a_buckled_pipe_ends_in_the_pitchfork_where_it_straightens() -> None:
    pipe = {"EI": 1.0, "GJ": 0.8, "a": 0.01, "R": 0.99, "L": 10.0, "beta0": 0.0, "betaL": 0.0}
    ds = in_memory.run(study(small.axis("FZ", [-0.12, -0.11, -0.09], follow=True), pipe))
    said = ds["outcome"].values.tolist()
    assert said[:2] == ["solved", "solved"]
    where = "failed: the followed branch ends where the rod becomes straight, in a pitchfork at FZ = "
    assert said[2].startswith(where)
    assert float(said[2].rpartition(" = ")[2]) == pytest.approx(-((np.pi / 10) ** 2), rel=1e-9)


START = {"E": 325.95, "nu": 0.25, "a": 0.25, "L": 8.0, "R": 0.75, "beta": 0.5, "dbeta": 0.3, "F3": 4.0, "M3": 2.0}


@pytest.mark.parametrize(
    "axis, last",
    [
        ("FZ", -6.0),
        ("R", 0.9),
        *(pytest.param(*one, marks=pytest.mark.slow) for one in (("FZ", 6.0), ("E", 300.0), ("M3", 3.0))),
    ],
)
def test_the_equilibrium_of_a_start_problem_is_followed_to_the_last_value_or_its_fold(axis: str, last: float) -> None:
    one = study(f"[axes]\n{axis} = {{ follow = true, to = {last}, count = 5 }}\n", START)
    ds = in_memory.run(one)
    assert set(ds["outcome"].values) == {"solved"}
    own = solve(one.case(), stations=21)
    np.testing.assert_allclose(ds["beta"][0], own.beta, atol=1e-8)  # both tolerances are 1e-8
    branch = follow(own, **{axis: last})
    folds = [point.value for point in branch.special if point.kind == "fold"]
    assert float(ds[axis][-1]) == pytest.approx(folds[0] if folds else last, rel=1e-9)
    assert np.isnan(ds["fold"]) == (not folds)
    assert ds["fold"].attrs["units"] == ds[axis].attrs["units"]
    assert ds.attrs["followed"] == axis
    assert ("has no fold before it" in ds.attrs["fold_note"]) == (not folds)
    middle = float(ds[axis][:2].mean())
    again = ds.rod.at(**{axis: middle})
    assert again.solved
    same = follow(own, **{axis: [middle, last]}).at(middle)[0].solution
    np.testing.assert_allclose(again.beta, same.beta, atol=1e-7)
