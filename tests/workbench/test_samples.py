"""Studies of samples: stored along one dimension, run, resumed, grown and merged like a grid, and drawn as scatter."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import workbench.accessor  # noqa: F401  (ds.rod)
from studies import Study
from studies.language.loader import loads
from tests.workbench import runs, small, stored_figures
from tests.workbench.command import run
from workbench.commands import study_scene
from workbench.figures import scatter, study_figure
from workbench.run import file_merge, in_memory, writing
from workbench.run.run_and_resume import RunOptions, run_to_file
from workbench.scene import scene_kinds
from workbench.stored import reading, solved_again
from workbench.stored.file_summary import summary
from workbench.stored.stored_study import StoredStudy

HEAD = 'observables = ["bends", "turns_around", "kappa_max"]\noutputs = ["beta", "alpha", "z"]'
SAMPLE = """
[sample]
size = {}
seed = {}
[sample.E]
distribution = "log-uniform"
from = 5e3
to = 4e4
[sample.R]
from = 0.5
to = 1.5
[sample.beta]
distribution = "normal"
mean = "30deg"
std = 0.1
"""
AXIS = "[axes.F1]\nvalues = [3.0, 5.0, 8.0]\n"
LAW = small.law("kappa_max", "F1", "rises", at={"sample": 2})


def study(size: int = 40, seed: int = 3, more: str = "") -> Study:
    return small.study(SAMPLE.format(size, seed) + more, HEAD)


small_blocks = runs.small_blocks(16)


@pytest.fixture(scope="module")
def stored(small_blocks, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("stored") / "small.h5"
    run_to_file(study(), path, RunOptions(workers=1))
    return path


@pytest.fixture(scope="module")
def crossed(small_blocks) -> xr.Dataset:
    """Five samples at each of three forces."""
    return in_memory.run(study(5, more=AXIS + LAW))


def test_a_law_is_judged_on_the_line_of_every_sample(crossed: xr.Dataset) -> None:
    from workbench.stored import stored_verdicts

    (row,) = stored_verdicts.verdicts(crossed)
    assert (row["lines"], row["at"], row["verdict"]) == (5, {"sample": 2.0}, "true")


# merge


@pytest.mark.slow
def test_merged_samples_are_those_of_all_files_each_once(stored: Path, tmp_path) -> None:
    longer, other = tmp_path / "longer.h5", tmp_path / "other.h5"
    run_to_file(study(50), longer)
    run_to_file(study(8, 9), other)
    done = file_merge.merge([stored, longer, other], tmp_path / "all.h5")
    assert (done["axis"], done["values"], done["cases"]) == ("sample", 58, 58)
    with reading.open_study(tmp_path / "all.h5") as ds, xr.open_dataset(longer) as a, xr.open_dataset(other) as b:
        for name in ("E", "R", "beta0", "kappa_max", "beta", "outcome"):
            np.testing.assert_array_equal(ds[name], np.concatenate([a[name], b[name]]))
        assert ds["sample"].values.tolist() == list(range(58))
        assert ds.attrs["sampling"].startswith("58 samples of E, R, beta, merged from: 40 samples of E, R, beta: scr")
        assert solved_again.study_of(ds).variation.given.size == 58
        again = in_memory.run(loads(ds.attrs["study"]))
        np.testing.assert_array_equal(again["kappa_max"], ds["kappa_max"])


@pytest.mark.slow
def test_a_merged_study_of_too_many_samples_names_a_table_and_keeps_them_as_arrays(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(file_merge, "MOST_NUMBERS", 9)  # as with a million samples
    paths = [tmp_path / "a.h5", tmp_path / "b.h5"]
    for path, E in zip(paths, ([1e4, 2e4, 3e4], [3e4, 4e4]), strict=True):
        text = f"[zip]\nE = {E}\nR = {[e / 1e4 for e in E]}\n"
        writing.write(in_memory.run(small.study(text, HEAD)), path)
    file_merge.merge(paths, tmp_path / "c.h5")
    with xr.open_dataset(tmp_path / "c.h5") as ds:
        assert "[zip]" in ds.attrs["study"]
    writing.write(in_memory.run(small.study("[zip]\nE = [5e4]\nR = [0.5]\n", HEAD)), paths[0])
    told = file_merge.merge([tmp_path / "c.h5", paths[0]], tmp_path / "d.h5")
    assert told["cases"] == 5
    with xr.open_dataset(tmp_path / "d.h5") as ds:
        assert 'file = "d.csv"' in ds.attrs["study"]
        assert "[zip]" not in ds.attrs["study"]
        assert solved_again.study_of(ds).variation.dimensions.fields["E"].tolist() == [1e4, 2e4, 3e4, 4e4, 5e4]
        assert ds.rod.sel(sample=4).rod.study.variation.dimensions.fields["E"].tolist() == [5e4]
    writing.write(in_memory.run(small.study("[zip]\nE = [6e4]\nR = [0.5]\n", HEAD)), paths[0])
    assert file_merge.merge([tmp_path / "d.h5", paths[0]], tmp_path / "e.h5")["cases"] == 6


# what is said


def test_the_summary_names_the_fields_and_cautions_of_a_size_that_is_no_power_of_two(stored: Path, capsys) -> None:
    run(f"summary {stored}")
    said = capsys.readouterr().out
    drawn = "40 samples of E, R, beta: scrambled Sobol' sequence, seed 3"
    for part in ("\nsample       40 ", "  E   ", "  beta0", drawn):
        assert part in said
    assert "caution: 40 samples of a Sobol' sequence are not a power of two" in said
    found = summary(stored)
    assert [row["name"] for row in found["sampled"]] == ["E", "R", "beta0"]
    assert set(found["worst"][0]["at"]) == {"sample", "E", "R", "beta0"}
    with xr.open_dataset(stored) as ds:
        i = int(np.argmax(ds["error"].values))
        assert found["worst"][0]["at"]["E"] == float(ds["E"][i])


def test_a_power_of_two_and_other_methods_need_no_caution() -> None:
    assert "sampling_caution" not in in_memory.run(study(4)).attrs
    text = SAMPLE.format(5, 1).replace("size", 'method = "random"\nsize')
    assert "sampling_caution" not in in_memory.run(small.study(text, HEAD)).attrs


def test_a_stored_study_reads_no_table_again(tmp_path) -> None:
    (tmp_path / "cases.csv").write_text("E\n1e4\n2e4\n")
    (tmp_path / "s.toml").write_text(small.study("", HEAD).text + "[table]\nfile = 'cases.csv'\n")
    run(f"run {tmp_path / 's.toml'} --out {tmp_path / 's.h5'}")
    (tmp_path / "cases.csv").unlink()
    with xr.open_dataset(tmp_path / "s.h5") as ds:
        assert ds.rod.study.variation.dimensions.fields["E"].tolist() == [1e4, 2e4]
        assert ds.rod.kappa.shape == (2, 21)


# which case


def test_other_values_of_a_sampled_field_replace_those_of_the_samples(stored: Path) -> None:
    with xr.open_dataset(stored) as ds:
        sol = ds.isel(sample=slice(0, 4)).rod.at(E=2e4)
        assert sol.case.shape == (4,)
        np.testing.assert_array_equal(sol.case.cylinder.R, ds["R"][:4])
        assert float(sol.case.rod.E) == 2e4
        assert ds.rod.at(E=2e4, R=0.75, beta=0.5).case.shape == ()


def test_a_scene_of_one_sample_solves_that_sample_alone(tmp_path) -> None:
    path = tmp_path / "s.toml"
    path.write_text(study().text)
    whole, rods = study_scene.two_stations(path)
    solve = study_scene.solver_of(rods, scene_kinds.KINDS["plain"], {"sample": 17}, [])
    assert solve is not None
    part = solve(study_scene.FIRST)
    assert part["sample"].values.tolist() == [17]
    assert part["E"].values[0] == whole.variation.dimensions.fields["E"][17]
    row = study_scene.solver_of(rods, scene_kinds.KINDS["ghosts"], {}, ["sample"])
    assert row is not None
    assert row(study_scene.FIRST).sizes["sample"] == 40
    text = scene_kinds.case_values(rods, {"sample": 17})
    assert text.startswith("sample = 17, E = ")
    assert "R = " in text


# the figure


def test_samples_show_what_is_stored(stored: Path, crossed: xr.Dataset, monkeypatch) -> None:
    ds = reading.read(stored)
    ds["turns_around"][7] = np.nan

    pictures = {
        "one is missing": lambda: scatter.figure(StoredStudy(ds)),
        "at axes": lambda: scatter.figure(StoredStudy(crossed)),
        "the axes": lambda: study_figure.figure(StoredStudy(crossed)),
    }
    stored_figures.check("pictures_samples", pictures)
    monkeypatch.setattr(scatter, "MANY", 30)
    stored_figures.check("pictures_many_samples", {"as a density": pictures["one is missing"]})


def test_a_column_of_other_dimensions_is_no_row(stored: Path) -> None:
    ds = reading.read(stored)
    assert StoredStudy(ds.assign(bends=ds["bends"][0])).observables == ["turns_around", "kappa_max"]


def test_few_samples_or_one_value_have_no_rank_correlation() -> None:
    x = np.arange(9.0)
    assert scatter.rank_correlation(x, x**3) == pytest.approx(1.0)
    assert scatter.rank_correlation(x, 0 * x) is None
    assert scatter.rank_correlation(x[:5], x[:5]) is None
