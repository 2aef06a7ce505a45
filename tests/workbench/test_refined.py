"""Refined studies: cases are added where a watched number changes, stored, resumed, drawn, and compared with a grid."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (ds.rod)
from solver import observe, solve
from studies import Study
from studies.language.loader import loads
from studies.laws.case_rows import Grid
from studies.laws.judgement import Law, decide
from studies.laws.line_verdicts import TREND, as_good
from tests.workbench import runs, small, stored_figures
from tests.workbench.command import run
from workbench.figures import figure_kinds, map_figure, study_figure
from workbench.run import block, in_memory, plan, recipe, writing
from workbench.run.run_and_resume import RunOptions, run_to_file
from workbench.stored import reading, refined, stored_verdicts
from workbench.stored.file_summary import summary
from workbench.stored.stored_study import StoredStudy

LINE = small.axis("E", (5e3, 4e4, 4), spacing="geometric")
PLANE = "[base]\nL = 6.0\n" + LINE.replace("count = 4", "count = 5") + small.axis("R", (0.5, 1.5, 4))
REFINE = '[refine]\nwatch = ["bends"]\npoints = 15\n'
LAW = small.law("bends", "E", "falls", at={"R": 0.75})
HEAD = 'observables = ["bends", "turns_around"]\noutputs = []'


def study(axes: str = PLANE, refine: str = REFINE, head: str = HEAD) -> Study:
    return small.study(axes + refine, head)


small_blocks = runs.small_blocks(16)


@pytest.fixture(scope="module")
def stored(small_blocks, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("stored") / "small.h5"
    run_to_file(study(PLANE + LAW), path, RunOptions(workers=1))
    return path


@pytest.fixture(scope="module")
def line(small_blocks) -> xr.Dataset:
    return in_memory.run(study(LINE, '[refine]\nwatch = ["bends"]\ntolerance = 1e-6\n', HEAD.replace("[]", '["beta"]')))


# against the uniform grid


def uniform(ds: xr.Dataset, work: Study) -> tuple[np.ndarray, np.ndarray]:
    """The number of bends over the whole lattice, solved at once, and the places of the refined cases on it."""
    found = refined.describe(ds)
    sizes = found.lattice.sizes
    places = np.indices(sizes).reshape(len(sizes), -1).T
    case = work.case_of(found.lattice.values(places))
    turns = np.asarray(observe(solve(case, stations=2), ["bends"])["bends"]).reshape(sizes)
    return turns, found.places


def test_every_boundary_cell_of_the_uniform_grid_is_found_with_fewer_cases(stored: Path) -> None:
    with xr.open_dataset(stored) as ds:
        turns, places = uniform(ds, study())
        np.testing.assert_array_equal(turns[tuple(places.T)], ds["bends"])
        known = np.zeros(turns.shape, dtype=bool)
        known[tuple(places.T)] = True
        corners = np.stack([turns[:-1, :-1], turns[1:, :-1], turns[:-1, 1:], turns[1:, 1:]])
        all_known = known[:-1, :-1] & known[1:, :-1] & known[:-1, 1:] & known[1:, 1:]
        assert all_known[np.ptp(corners, axis=0) > 0].all()
        assert ds.sizes["sample"] < 0.3 * turns.size


def test_the_boundary_is_the_pairs_of_neighbours_that_differ_on_the_uniform_grid(stored: Path) -> None:
    with xr.open_dataset(stored) as ds:
        turns, _ = uniform(ds, study())
        found, lattice = ds.rod.boundary("bends"), refined.describe(ds).lattice
        assert found.sizes["pair"] == sum(int((np.diff(turns, axis=k) != 0).sum()) for k in (0, 1))
        for k, axis in enumerate(("E", "R")):
            along = found.isel(pair=np.flatnonzero(found[f"{axis}_half_width"] > 0))
            values = lattice.along(axis, np.arange(turns.shape[k]))
            lower = np.searchsorted(values, along[axis].values) - 1
            np.testing.assert_allclose(along[axis], (values[lower] + values[lower + 1]) / 2)
            np.testing.assert_allclose(along[f"{axis}_half_width"], (values[lower + 1] - values[lower]) / 2)
            other = ("R", "E")[k]
            across = np.abs(lattice.along(other, np.arange(turns.shape[1 - k])) - along[other].values[:, None]).argmin(
                1
            )
            at = (lower, across) if k == 0 else (across, lower)
            up = (lower + 1, across) if k == 0 else (across, lower + 1)
            np.testing.assert_array_equal(along["before"], turns[at])
            np.testing.assert_array_equal(along["after"], turns[up])


def test_the_map_shows_at_every_place_the_number_of_the_uniform_grid(stored: Path) -> None:
    """The lattice is as fine as the raster here: what is not solved is what its neighbours show."""
    with xr.open_dataset(stored) as ds:
        turns, _ = uniform(ds, study())
        shown = StoredStudy(ds).raster()["bends"].values
        assert shown.shape == tuple(2 * (size - 1) for size in turns.shape)
        for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):  # the quarters of each cell
            corner = turns[i : turns.shape[0] - 1 + i, j : turns.shape[1] - 1 + j]
            np.testing.assert_array_equal(shown[i::2, j::2], corner)


def test_along_one_axis_each_jump_is_enclosed_to_the_tolerance(line: xr.Dataset) -> None:
    found = StoredStudy(line).boundary("bends")
    assert found.sizes["pair"] == int(line["bends"].max() - line["bends"].min()) > 1
    assert ((found["E_half_width"] / found["E"]) < 1e-6 * np.log(8) / 2 * 1.01).all()
    for k in range(found.sizes["pair"]):
        pair = found.isel(pair=k)
        for side, number in ((-1, pair["before"]), (1, pair["after"])):
            case = study(LINE).case_of({"E": float(pair["E"] + side * pair["E_half_width"])})
            assert float(observe(solve(case), ["bends"])["bends"]) == float(number)
    assert line.sizes["sample"] < 130
    assert sorted(StoredStudy(line).line()["E"].values) == StoredStudy(line).line()["E"].values.tolist()


FIVE = """[base]
nu = 0.25
a = 0.25
L = 14.0
R = 1.0
side = "inside"
beta = "10deg"
dbeta = 0.1
M3 = 3.0
F3 = -10.0
"""
CHANGES = {5104.1: (2, 1), 5110.5: (1, 0), 5113.9: (0, 1), 7036.7: (1, 2), 17811.4: (2, 1)}  # by a scan of 20,000 rods


@pytest.fixture(scope="module")
def five() -> xr.Dataset:
    axis = LINE.replace("count = 4", "count = 6") + small.law("bends", "E", "falls")
    whole = '[refine]\nwatch = ["bends"]\ntolerance = 1e-6\n'
    head = 'title = "small"\nobservables = ["bends"]\noutputs = []\nunits = {length = "cm", force = "N"}\n'
    return in_memory.run(loads(head + FIVE + axis + whole))


def test_a_number_that_changes_and_changes_back_between_two_values_is_located(five: xr.Dataset) -> None:
    """Between the first two values of the axis it goes from 2 to 0 and back to 2; the ends of the interval agree."""
    found = StoredStudy(five).boundary("bends")
    assert five["bends"].values[:2].tolist() == [2, 2]
    pairs = zip(found["before"].values, found["after"].values, strict=True)
    assert dict(zip(found["E"].values.round(1), pairs, strict=True)) == CHANGES


def test_a_law_along_one_refined_axis_is_judged_on_every_case(five: xr.Dataset) -> None:
    """The six values of the axis alone agree with it."""
    (row,) = stored_verdicts.verdicts(five)
    (coarse,) = StoredStudy(five).coarse().verdicts
    assert (row["verdict"], coarse["verdict"]) == ("false", "true")
    steps = [(step["from"], step["to"]) for step in row["exceptions"]]
    jumps = [at for at, (before, after) in CHANGES.items() if after > before]
    assert [low < at + 0.1 and at - 0.1 < high for (low, high), at in zip(steps, jumps, strict=True)] == [True, True]
    assert row["steps"] == five.sizes["sample"] - 1


def test_a_refinement_says_what_it_cannot_have_seen(five: xr.Dataset, stored: Path) -> None:
    line = np.sort(np.log(five["E"].values))
    apart = np.diff(line).max() / np.ptp(line)
    assert f"a change and its reverse between neighbouring cases, up to {apart:.2g} of an axis" in five.refinement
    with xr.open_dataset(stored) as ds:
        assert "a region inside one cell, up to 0.33 of an axis wide, that holds none of its corners" in ds.refinement


# the file


# what is watched


def test_a_real_number_is_refined_where_it_changes_by_more_than_its_step() -> None:
    ds = in_memory.run(
        study(LINE, '[refine]\nwatch = ["turns_around"]\nsteps = { turns_around = 0.02 }\npoints = 2000\n')
    )
    wraps = StoredStudy(ds).line()["turns_around"].values
    assert np.abs(np.diff(wraps)).max() <= 0.02
    assert StoredStudy(ds).boundary("turns_around").sizes["pair"] == 0
    assert StoredStudy(ds).boundary("turns_around", step=0.01).sizes["pair"] == (np.abs(np.diff(wraps)) > 0.01).sum()


FAILING = {"nu": 0.25, "a": 0.25, "L": 20.0, "R": 0.75, "dbeta": 0.5, "F1": 5.0, "beta": "30deg", "F3": 10.0}


def study_of(base: dict[str, Any], values: Any, refine: str) -> Study:
    return loads(
        small.text(base, f"{small.axis('E', values)}[refine]\n{refine}", observables=["amplitude"], outputs=[])
    )


def test_where_cases_begin_to_fail_is_located_and_failed_cells_are_told(monkeypatch, tmp_path) -> None:
    work, whole = study_of(FAILING, (9e3, 2e4, 5), 'watch = ["outcome"]\ntolerance = 1e-3\n'), block.block_of

    def failing(study_, part):
        found = whole(study_, part)
        bad = part.values["E"] > 13_333.0
        found["solved"] = found["solved"] & ~bad
        found["outcome"] = np.where(bad, "failed: made up", found["outcome"])
        found["amplitude"] = np.where(bad, np.nan, found["amplitude"])
        return found

    monkeypatch.setattr(block, "block_of", failing)
    path = tmp_path / "ends.h5"
    run_to_file(work, path, RunOptions(workers=1))
    with xr.open_dataset(path) as ds:
        (pair,) = np.unique(StoredStudy(ds).boundary("outcome")["E"])
        assert abs(pair - 13_333) < 1e-3 * 11_000
        assert StoredStudy(ds).boundary("amplitude", step=1e9).attrs["unknown"] == 1
    told = summary(path)["boundaries"]
    assert (told[0]["name"], told[0]["pairs"]) == ("outcome", 1)


# laws, pictures, commands


def test_in_a_plane_the_lines_of_the_coarse_grid_are_judged_with_all_their_cases(stored: Path) -> None:
    with xr.open_dataset(stored) as ds:
        (row,), on_line = stored_verdicts.verdicts(ds), int((ds["R"] == 0.5 + 1 / 3).sum())
    (coarse,) = stored_verdicts.verdicts(in_memory.run(study(PLANE + LAW).coarse()))
    assert row["at"] == coarse["at"] == {"R": 0.5 + 1 / 3}
    assert row["steps"] == on_line - 1 > coarse["steps"]


@pytest.mark.parametrize(
    ("rule", "sign"), [({"kind": "bounded", "most": 99.0}, 1), ({"direction": "not-falling"}, 1),
                       ({"direction": "not-rising"}, -1)]
)  # fmt: skip
def test_a_case_between_the_lines_of_the_coarse_grid_can_refute_a_law(stored: Path, rule: dict, sign: int) -> None:
    """Where it agrees, such a line does not count: most of its cases are not stored."""
    with xr.open_dataset(stored) as ds:
        ds = ds.load()
    found, law = refined.describe(ds), Law(claim="(2)", observable="bends", axis="E", source="s", **rule)
    rows = found.rows("E", {name: ds[name].values for name in ("E", "R")}, None)
    for row in rows:
        np.testing.assert_array_equal(row.along[row.has_case], ds["E"].values[row.cases[row.has_case]])
        assert (np.diff(row.along) > 0).all()
    between = next(row for row in rows if not row.has_case.all() and row.has_case[:2].any() and row.has_case.sum() > 2)
    odd = int(between.cases[between.has_case][1])
    numbers = np.ones(ds.sizes["sample"])
    for wrong in (False, True):
        numbers[odd] = 1 + 100 * sign * wrong
        said = decide(law, {"bends": numbers}, Grid(dict(found.lattice.axes), rows=rows))
        assert said["lines"] == 4 + wrong
        assert as_good(said["verdict"], TREND) != wrong
    assert {step["at"]["R"] for step in said["exceptions"]} == {between.at["R"]}
    assert "between the lines of the coarse grid" in said["reason"]


def test_a_law_changes_its_verdict_between_the_two_lines_that_its_boundary_names() -> None:
    """The two lines alone, solved as a study of their own, have the two verdicts."""
    ds = in_memory.run(study(PLANE + LAW, '[refine]\nlaws = ["(1)"]\ntolerance = 0.1\n'))
    (found,) = (pair for _, pair in StoredStudy(ds).boundary("(1)").groupby("pair"))
    lines = [float((found["R"] + sign * found["R_half_width"]).item()) for sign in (-1, 1)]
    alone = in_memory.run(study(PLANE.partition("[axes.R]")[0] + f"[axes.R]\nvalues = {lines}\n" + LAW, ""))
    (law,) = stored_verdicts.laws_of(alone)
    verdicts = list(stored_verdicts.verdicts_of_lines(StoredStudy(alone), law).values)
    assert verdicts == [found["before"].item(), found["after"].item()] == ["true", "false"]


def test_the_coarse_grid_of_a_refined_study_is_the_study_without_refinement(stored: Path) -> None:
    with xr.open_dataset(stored) as ds:
        found, plain = StoredStudy(ds.load()).coarse().ds, in_memory.run(study(PLANE + LAW).coarse())
        for name in plain.variables:
            if plain[name].dtype.kind == "f":
                np.testing.assert_allclose(found[name], plain[name], rtol=1e-9)  # other neighbours in a block
            assert found[name].dims == plain[name].dims


def test_refined_studies_show_what_is_stored(stored: Path, line) -> None:
    ds = reading.read(stored)
    assert (figure_kinds.kind_of(StoredStudy(ds)), figure_kinds.kind_of(StoredStudy(line))) == ("map", "lines")
    pictures = {
        "the plane": lambda: map_figure.figure(StoredStudy(ds), show=["bends", "level"]),
        "an axis": lambda: study_figure.figure(StoredStudy(line)),
        "lines of the plane": lambda: study_figure.figure(StoredStudy(ds)),
    }
    stored_figures.check("pictures_refined", pictures)


def test_a_grid_has_a_boundary_too() -> None:
    ds = in_memory.run(small.study(PLANE, HEAD))
    found = StoredStudy(ds).boundary("bends")
    assert found.sizes["pair"] == sum(int((np.diff(ds["bends"].values, axis=k) != 0).sum()) for k in (0, 1))
    turned = StoredStudy(ds.isel(E=slice(None, None, -1))).boundary("bends")
    assert sorted(found["E"].values) == sorted(turned["E"].values)


def test_a_refinement_grows_by_halvings_and_by_its_budget_alone() -> None:
    before = {"watch": ["bends"], "halvings": 3, "budget": 90}
    for change, grows in (({}, True), ({"budget": 91, "halvings": 4}, True), ({"budget": 89}, False),
                          ({"halvings": 2, "budget": 91}, False), ({"watch": ["turns_around"]}, False)):  # fmt: skip
        assert plan._is_larger(before, before | change) == grows, change


def test_a_complete_file_of_other_code_is_replaced_as_that_of_a_grid(stored: Path, tmp_path, monkeypatch) -> None:
    path, said = tmp_path / "small.h5", list[str]()
    path.write_bytes(stored.read_bytes())
    monkeypatch.setattr(recipe, "code_version", lambda: "0.2.0+new")
    done = run_to_file(study(PLANE + LAW), path, RunOptions(workers=1), said.append)
    assert done.solved == reading.open_study(stored).sizes["sample"]
    assert re.match(r"replaces the results in .*small\.h5, which differ: code was [^;]*, now 0\.2\.0\+new$", said[0])


@pytest.mark.slow
def test_where_a_law_changes_its_verdict_is_the_place_on_the_uniform_lines(tmp_path, capsys) -> None:
    plane = PLANE.replace("count = 4", "count = 13")
    work = study(plane + LAW, '[refine]\nlaws = ["(1)"]\ntolerance = 0.01\n')
    path = tmp_path / "small.h5"
    run_to_file(work, path, RunOptions(workers=1))
    with xr.open_dataset(path) as ds:
        found = ds.rod.boundary("(1)")
        lattice = refined.describe(ds).lattice
        lines = ", ".join(repr(float(R)) for R in lattice.along("R", np.arange(lattice.sizes[1])))
        fine = study(plane.partition("[axes.R]")[0] + f"[axes.R]\nvalues = [{lines}]\n" + LAW, "")
        grid = in_memory.run(fine)
        (law,) = stored_verdicts.laws_of(grid)
        verdicts = stored_verdicts.verdicts_of_lines(StoredStudy(grid), law).values
        change = np.flatnonzero(verdicts[1:] != verdicts[:-1])
        assert change.size == found.sizes["pair"] == 3
        np.testing.assert_allclose(found["R"], (grid["R"].values[change] + grid["R"].values[change + 1]) / 2)
        np.testing.assert_array_equal(found["before"], verdicts[change])
        np.testing.assert_array_equal(found["after"], verdicts[change + 1])
        assert ds.sizes["sample"] == 5 * 13 + 3 * 5 * lattice.depth
    run(f"summary {path}")
    assert "law (1)" in capsys.readouterr().out


def test_the_summary_lists_each_place_along_one_axis(line: xr.Dataset, tmp_path, capsys) -> None:
    writing.write(line, tmp_path / "line.h5")
    run(f"summary {tmp_path / 'line.h5'}")
    said = capsys.readouterr().out
    found = StoredStudy(line).boundary("bends")
    for pair in (found.isel(pair=k) for k in range(found.sizes["pair"])):
        (place,) = re.findall(
            rf"bends: {int(pair['before'])} to {int(pair['after'])} at E = ([\d.]+) \+- ([\d.]+) ", said
        )
        assert float(place[0]) == pytest.approx(float(pair["E"]), abs=float(pair["E_half_width"]))
        assert float(place[1]) == pytest.approx(float(pair["E_half_width"]), rel=0.05)
