"""Studies that extend one another along an axis are one study, and what is not alike is named."""

import os
from functools import cache
from typing import Any

import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (ds.rod)
from solver import InputError
from tests.slow import slow, slow_but
from tests.workbench import small
from tests.workbench.small import axis, law
from workbench.run import file_merge, in_memory, run_and_resume, writing
from workbench.stored import reading, stored_verdicts
from workbench.stored.stored_study import StoredStudy

RADII = axis("R", [0.5, 0.75, 1.0])
LAW = law("bends", "E", "falls")
# The values of E of some files, and of their union.
SPLITS = {
    "one after the other": ([[1e4, 2e4], [3e4, 4e4]], [1e4, 2e4, 3e4, 4e4]),
    "interleaved, in no order": ([[4e4, 1e4], [3e4, 2e4]], [1e4, 2e4, 3e4, 4e4]),
    "one value each": ([[2e4], [1e4]], [1e4, 2e4]),
    "three files that overlap, in no order": ([[3e4, 1e4], [2e4, 3e4], [4e4, 3e4]], [1e4, 2e4, 3e4, 4e4]),
}
# An axis for every way in which a field of the case is stored.
AXES = {
    "E": ([[1e4, 2e4], [3e4]], [1e4, 2e4, 3e4]),
    "R": ([[0.5, 0.6], [0.75]], [0.5, 0.6, 0.75]),  # rho follows R in the first file, and is a number in the other
    "L": ([[10.0], [15.0, 20.0]], [10.0, 15.0, 20.0]),
    "beta": ([[0.4, 0.5], [0.3]], [0.3, 0.4, 0.5]),
    "a": ([[0.2], [0.25]], [0.2, 0.25]),
}


HEAD = 'observables = ["bends"]\noutputs = ["beta", "position"]'


def one_by_one(text: str) -> xr.Dataset:
    """A study's dataset by a method that marches: a case's last bits do not depend on those it is solved with."""
    return _by_marching(text).copy(deep=True)


@cache
def _by_marching(text: str) -> xr.Dataset:
    return in_memory.run(small.study(text, HEAD).with_values(tol=1e-3, method="verlet"))


def by_the_orbit(text: str) -> xr.Dataset:
    """A study's dataset by the method that knows the orbit: a march with so few stations cannot count the bends."""
    return in_memory.run(small.study(text, HEAD))


def stored(tmp_path, *datasets: xr.Dataset):
    return [writing.write(ds, tmp_path / f"{i}.h5", force=True) for i, ds in enumerate(datasets)]


def assert_same(merged: xr.Dataset, whole: xr.Dataset) -> None:
    """Bit for bit, with kinds, dimensions and labels; the attributes but for those that tell where it came from."""
    apart = {"study", "created", "merged", "checksums"}
    attrs = {key: value for key, value in merged.attrs.items() if key not in apart}
    assert attrs == {key: value for key, value in whole.attrs.items() if key not in apart}
    xr.testing.assert_identical(merged.drop_attrs(deep=False), whole.drop_attrs(deep=False))
    assert_same_kinds(merged, whole)


def assert_same_kinds(merged: xr.Dataset, whole: xr.Dataset) -> None:
    for name, variable in whole.variables.items():
        assert merged[name].dims == variable.dims, name
        assert merged[name].dtype.kind == variable.dtype.kind, name


@pytest.mark.parametrize("split", [name if "overlap" in name else slow(name) for name in SPLITS])
def test_what_is_joined_is_what_one_run_of_all_values_stores(split: str, tmp_path) -> None:
    parts, union = SPLITS[split]
    files = stored(tmp_path, *(one_by_one(axis("E", values) + RADII + LAW) for values in parts))
    done = file_merge.merge(files, tmp_path / "all.h5")
    assert (done["axis"], done["values"], done["cases"]) == ("E", len(union), 3 * len(union))
    with xr.open_dataset(tmp_path / "all.h5") as merged:
        assert_same(merged.load(), one_by_one(axis("E", union) + RADII + LAW))


def test_a_file_that_is_merged_is_not_replaced_unless_that_is_asked_for(tmp_path) -> None:
    files = stored(tmp_path, *(by_the_orbit(axis("E", row)) for row in ([1e4, 2e4], [3e4, 4e4])))
    before = files[0].read_bytes()
    with pytest.raises(InputError, match="is one of the files that are merged: give another name, or --force"):
        file_merge.merge(files, files[0])
    assert files[0].read_bytes() == before
    assert file_merge.merge(files, files[0], force=True)["values"] == 4


def test_a_file_of_another_kind_says_that_it_has_no_cases() -> None:
    with pytest.raises(InputError, match="the dataset is a fold map, which has no cases"):
        _ = StoredStudy(xr.Dataset({"region_at": ("x", [0])})).cases


@pytest.mark.parametrize("name", slow_but(AXES, "R"))
def test_an_axis_of_any_field_can_be_joined_first_or_last(name: str, tmp_path) -> None:
    parts, union = AXES[name]
    other = axis("F3", [5.0, 10.0])
    before, after = ("", other) if name in "ER" else (other, "")
    solved = [in_memory.run(small.study(before + axis(name, row) + after, HEAD)) for row in (*parts, union)]
    files = stored(tmp_path, *solved[:-1])
    for order in (files, files[::-1]):
        file_merge.merge(order, tmp_path / "all.h5", force=True)
        with xr.open_dataset(tmp_path / "all.h5") as merged:
            # the tolerance of 1e-8 times condition: a case is not solved with the same neighbours in all of them
            xr.testing.assert_allclose(merged.drop_vars("error"), solved[-1].drop_vars("error"), rtol=1e-6, atol=1e-6)
            assert_same_kinds(merged, solved[-1])


def status(done: dict[str, Any]) -> int:
    return stored_verdicts.status(done["unsolved"], done["laws"])


E1, E2 = axis("E", [1e4, 2e4]), axis("E", [3e4])


def test_the_same_case_with_other_numbers_is_refused_and_nothing_is_left_behind(tmp_path) -> None:
    a, b = one_by_one(axis("E", [1e4, 2e4])), one_by_one(axis("E", [2e4, 3e4]))
    b["position"][0, 20, 2] += 1e-12
    files = stored(tmp_path, a, b)
    with pytest.raises(
        InputError, match=f"{files[0]} and {files[1]} both hold E = 20000, but with other values of position"
    ):
        file_merge.merge(files, tmp_path / "all.h5")
    assert sorted(os.listdir(tmp_path)) == ["0.h5", "1.h5"]


def test_a_reading_that_one_file_has_not_is_named_as_nothing(tmp_path) -> None:
    a, b = one_by_one(E1), one_by_one(E2)
    b.attrs["reading"] = ""
    with pytest.raises(InputError, match="differ in the reading: force-first/tension/paper and nothing"):
        file_merge.merge(stored(tmp_path, a, b), tmp_path / "all.h5")


def test_stations_at_other_places_are_refused(tmp_path) -> None:
    a, b = one_by_one(E1), one_by_one(E2)
    files = stored(tmp_path, a, b.assign_coords(u=b["u"] ** 2, s=("u", b["s"].values * b["u"].values, b["s"].attrs)))
    with pytest.raises(InputError, match="differ in the places of the stations"):
        file_merge.merge(files, tmp_path / "all.h5")


def test_a_file_may_be_joined_into_itself(tmp_path) -> None:
    files = stored(tmp_path, one_by_one(E1), one_by_one(E2))
    file_merge.merge(files, files[0], force=True)
    assert reading.read(files[0])["E"].values.tolist() == [1e4, 2e4, 3e4]


@pytest.mark.parametrize("names", [("outcome",), ("outcome", "bends")])
def test_results_that_another_program_stored_as_coordinates_are_joined_as_results(names, tmp_path) -> None:
    a, b = one_by_one(E1), one_by_one(E2)
    a["outcome"].attrs["units"] = "days since 2000-01-01"  # which xarray would read as times
    for other in (b, b.set_coords(names)):
        file_merge.merge(stored(tmp_path, a.set_coords(names), other), tmp_path / "all.h5", force=True)
        with reading.open_study(tmp_path / "all.h5") as merged:
            assert set(names) <= set(merged.data_vars)


@pytest.mark.slow
def test_a_law_is_judged_again_on_all_values(tmp_path) -> None:
    falling, rising = by_the_orbit(axis("E", [1e4, 2e4]) + LAW), by_the_orbit(axis("E", [3e4, 4e4]) + LAW)
    assert file_merge.merge(stored(tmp_path, falling, rising), tmp_path / "all.h5")["laws"][0]["verdict"] == "true"
    rising["bends"][:] = 99
    done = file_merge.merge(stored(tmp_path, falling, rising), tmp_path / "all.h5")
    assert (done["laws"][0]["verdict"], status(done)) == ("false", 1)


@pytest.mark.slow
def test_a_run_goes_on_from_what_was_joined(tmp_path) -> None:
    files = [tmp_path / "a.h5", tmp_path / "b.h5"]
    for path, values in zip(files, ([1e4, 2e4], [3e4]), strict=True):
        run_and_resume.run_to_file(small.study(axis("E", values) + RADII, HEAD), path)
    joined = tmp_path / "small.h5"
    file_merge.merge(files, joined)
    again = run_and_resume.run_to_file(small.study(axis("E", [1e4, 2e4, 3e4]) + RADII, HEAD), joined)
    assert again.finished_before
    assert again.statistics["outcomes"] == {"solved": 9}
    whole = run_and_resume.run_to_file(small.study(axis("E", [1e4, 2e4, 3e4]) + RADII, HEAD), tmp_path / "whole.h5")
    assert again.statistics == whole.statistics
    grown = run_and_resume.run_to_file(small.study(axis("E", [1e4, 2e4, 3e4, 4e4]) + RADII, HEAD), joined)
    assert grown.solved == 3
