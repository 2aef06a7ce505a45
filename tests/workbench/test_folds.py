"""The command folds: what it prints, stores and draws; the page that shows it."""

import csv
import json
from functools import cache, partial
from pathlib import Path

import numpy as np
import xarray as xr

from solver import Case, Cylinder, Ends, Rod, region_map
from studies import load
from tests.workbench import stored_figures
from workbench.branches.region_dataset import as_dataset
from workbench.figures import figure_kinds
from workbench.figures import region_figure as region_figure
from workbench.figures.sheet import sheet
from workbench.lab import measured_runs
from workbench.run import writing
from workbench.stored import reading
from workbench.stored.stored_study import StoredStudy

RANGES = ["--axis", "FZ=-15:-5", "--axis", "L=1.5:3"]
SHORT = ["--table1", "--beta0", "0.5", "--betaL", "0.8", "--MZ", "0", "--M3", "0", *RANGES]


@cache
def made() -> xr.Dataset:
    case = Case(Rod(1.07e4, 0.25, 0.25, 3.0), Cylinder(0.75), Ends(0.5, 0.8, M3=5.0))
    return as_dataset(load("fig7_4_end_angle"), region_map(case, FZ=(-60, -20), L=(1.5, 3), lattice=3), (5, 0))


def test_it_prints_curves_and_regions_as_data_and_stores_them(call, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["--lattice", 3, "--json", "--check", 3, "--out", "map.h5", "--plot", "map.png", "--dpi", 60]
    status, text, _ = call("folds", *SHORT, *words)
    told = json.loads(text)
    assert status == 0
    assert told["fields"] == ["FZ", "L"]
    assert told["check"] == {"points": 3, "failed": []}
    stored = reading.read("map.h5", study=False)
    assert stored.sizes["region"] == len(told["regions"])
    assert stored.sizes["curve"] == len(told["curves"])
    assert stored["count"].values.tolist() == [one["equilibria"] for one in told["regions"]]
    assert stored["count_stable"].values.tolist() == [one["stable"] for one in told["regions"]]
    assert stored.attrs["checked_points"] == 3
    assert Path("map.png").stat().st_size > 10_000


def test_the_numbers_of_a_map_are_written_and_those_of_a_table_of_words_are_refused(
    call, tmp_path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)
    writing.write(made(), Path("map.h5"))
    status, caption, _ = call("plot", "map.h5", "--show", "dbeta0", "--data", "map.csv", "--no-title")
    assert status == 0
    assert "Colours beside the curves" in caption
    rows = list(csv.DictReader(Path("map.csv").read_text(encoding="utf-8").splitlines()))
    stored = made()["curve_dbeta0"].values
    shades = [float(row["value"]) for row in rows if row["value"]]
    assert shades
    assert np.nanmin(stored) <= min(shades) <= max(shades) <= np.nanmax(stored)
    extremes = measured_runs.SHIPPED / "extremes.h5"
    status, _, refusal = call("plot", extremes, "--out", "e.png", "--data", "e.csv")
    assert status == 2
    assert "has none" in refusal
    assert not Path("e.png").exists()


def test_a_region_shows_all_its_stable_shapes_or_none_and_no_letters_cover_a_cusp() -> None:
    shapes = {name: made()[name].copy(data=made()[name].values[[1, 1]]) for name in ("stable_alpha", "stable_z")}
    for stable in (2, 3):  # in the region with much room, of which two are stored
        stored = StoredStudy(made().assign(count_stable=("region", [stable, 1]), **shapes))
        ax = region_figure.figure(stored, sheet("paper", width=89, titled=False)).axes[0]
        assert len(ax.child_axes) == {2: 2, 3: 0}[stable]
        ax.figure.draw_without_rendering()
        (cusp,) = [line.get_xydata()[0] for line in ax.lines if line.get_label() == "cusp"]
        assert not any(text.get_window_extent().contains(*ax.transData.transform(cusp)) for text in ax.texts)


def test_where_as_many_equilibria_are_stable_everywhere_one_region_says_so_of_all() -> None:
    """It said "(2 stable)" of itself, beside regions with a bare number."""
    stored = StoredStudy(made().assign(count_stable=("region", [1, 1])))
    texts = [text.get_text() for text in region_figure.figure(stored, sheet("paper", titled=False)).axes[0].texts]
    assert sorted(texts) == ["1 equilibrium (1 stable, as everywhere)", "3"]


def test_a_map_of_folds_shows_what_is_stored() -> None:
    paper = sheet("paper", titled=False)
    pictures = {
        show: partial(figure_kinds.figure, StoredStudy(made()), sheet=paper, show=[show])
        for show in ("count", "count_stable", "dbeta0")
    }
    for given in ((-30.0, 2.0), (0.0, 3.0)):
        marked = made().assign_attrs(given=given, reading="a")
        pictures[f"the rod of Table 1 at {given}"] = partial(region_figure.figure, StoredStudy(marked), sheet())
    stored_figures.check("pictures_folds", pictures)
