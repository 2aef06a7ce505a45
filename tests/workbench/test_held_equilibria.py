"""The command equilibria with held ends: its table, its file and picture, and what it refuses."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.legend import Legend

from studies.language.loader import loads
from tests.workbench import small
from workbench.figures import bifurcation
from workbench.run import in_memory
from workbench.stored import reading
from workbench.stored.stored_study import StoredStudy

ROD = "--length-unit cm --force-unit N --E 1.07e4 --nu 0.25 --a 0.25 --L 5 --R 0.75 --beta0 0 --betaL 0 --height 4"
QUICK = "--within FZ=-90:-30 --values 3 --tries 0"
STUDY = small.text({**small.SHORT, "beta0": 0.0, "betaL": 0.0, "height": 4.0})


def test_a_study_file_json_and_the_stored_file_hold_the_same(tmp_path, monkeypatch, call) -> None:
    monkeypatch.chdir(tmp_path)
    Path("held.toml").write_text(STUDY, encoding="utf-8")
    status, said, _ = call("equilibria", "held.toml", *QUICK.split(), "--json", "--out", "held.h5")
    told = json.loads(said)
    assert status == 0
    assert told["search"]["within"] == {"FZ": [-90.0, -30.0]}
    assert not told["complete"]
    with xr.open_dataset("held.h5", engine="h5netcdf") as ds:
        np.testing.assert_array_equal(ds["FZ"], [one["reactions"]["FZ"] for one in told["equilibria"]])
        np.testing.assert_array_equal(ds["dead_index"], [one["dead_index"] for one in told["equilibria"]])
        np.testing.assert_allclose(ds["z"][:, -1], 4.0, atol=1e-10)
        assert float(ds["height"]) == 4.0
        np.testing.assert_array_equal(ds["energy"], [one["held_energy"] for one in told["equilibria"]])
        assert "minus the work of the given loads alone" in ds["energy"].attrs["long_name"]
        assert ds.attrs["stability"] == "under held ends (height)"
        assert ds.attrs["remark"] == told["remark"]


def test_solve_prints_the_energy_of_the_list_beside_the_observable(call) -> None:
    """14.56 and 124.95 N cm: they differ by the work of the reaction, FZ (z(L) - z(0))."""
    told = json.loads(
        call("solve", *ROD.replace("beta0 0 --betaL 0", "beta0 20deg --betaL 20deg").split(), "--json")[1]
    )
    energy, held = (told["observables"][name] for name in ("energy", "held_energy"))
    assert held == pytest.approx(told["observables"]["bending_energy"], rel=1e-9)  # M3 = MZ = 0 do no work
    assert energy == pytest.approx(held - told["reactions"]["FZ"] * 4.0, rel=1e-9)


def test_the_first_case_of_a_followed_study_is_that_of_the_rule() -> None:
    """So that a study which follows does not carry an unstable arch through."""
    text = small.text(
        {**small.SHORT, "beta0": "20deg", "betaL": "-20deg"}, small.axis("height", [4.6, 4.5], follow=True)
    )
    ds = in_memory.run(loads(text))
    assert ds["held_index"].values.tolist() == [0, 0]
    assert float(ds["FZ"][0]) == pytest.approx(-25.898892401, rel=1e-9)
    assert "2 equilibria compared, 2 stable; shown: the stable one of least held energy" in ds.attrs["equilibria"]


ARCH = ROD.replace("--beta0 0 --betaL 0 --height 4", "--beta0 20deg --betaL {} --height {}")


def test_a_rule_for_held_ends_is_taken_stored_and_taken_again(tmp_path, call) -> None:
    """The study that is written names the rule, and gives the same unstable rod."""
    file = tmp_path / "x.toml"
    told = json.loads(
        call("solve", *ARCH.format("-20deg", 4.6).split(), "--choose", "1", "--out", str(file), "--json")[1]
    )
    again = json.loads(call("solve", str(file), "--json")[1])
    assert "index = 1" in file.read_text(encoding="utf-8")
    assert told["indices"]["held ends"] == 1
    assert told["which"].startswith("unstable under held ends, index 1; ")
    assert again["which"] == told["which"]
    assert again["reactions"]["FZ"] == pytest.approx(told["reactions"]["FZ"], rel=1e-9)


def test_solve_and_the_list_say_the_same_index_under_dead_loads(call) -> None:
    rod = ARCH.format("20deg", 2.9).split()
    said = call("solve", *rod)[1]
    listed = json.loads(call("equilibria", *rod, "--values", "21", "--tries", "0", "--json")[1])["equilibria"][0]
    assert "held: height; index 0 under held ends, 1 under dead loads" in said
    assert (listed["index"], listed["dead_index"], listed["taken"]) == (0, 1, True)


@pytest.mark.parametrize(("axis", "look"), [("FZ=2:1:3", "stable"), ("height=4.95:4.9:3", "stable as held")])
def test_branches_of_a_rod_with_weight_are_stored_and_drawn(axis, look, tmp_path, call) -> None:
    """Whether they would be stable without it is not known, and nothing says so."""
    path = tmp_path / "heavy.h5"
    rod = "--length-unit cm --force-unit N --E 326 --nu 0.25 --a 0.25 --R 0.75 --L 5 --beta0 0.5 --betaL 0.5"
    status, said, wrong = call("equilibria", *rod.split(), "--weight", "0.1", "--axis", axis, "--out", path)
    assert (status, "1 branch, 0 folds" in said) == (0, True), wrong
    stored = StoredStudy(reading.read(path, study=False))
    assert np.isnan(stored["curve_dead_index"]).all()
    assert [row["bends"] for row in stored.data("branches")] == ["1"]
    assert {text.get_text() for text in bifurcation.figure(stored).findobj(Legend)[0].get_texts()} == {look}
