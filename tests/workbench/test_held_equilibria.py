"""The command equilibria with held ends: its table, its file and picture, and what it refuses."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from workbench import cli

ROD = "--length-unit cm --force-unit N --E 1.07e4 --nu 0.25 --a 0.25 --L 5 --R 0.75 --beta0 0 --betaL 0 --height 4"
QUICK = "--within FZ=-90:-30 --values 3 --tries 0"
STUDY = (
    'title = "held"\n[units]\nlength = "cm"\nforce = "N"\n[base]\nE = 1.07e4\nnu = 0.25\na = 0.25\nL = 5.0\nR = 0.75\n'
    "beta0 = 0.0\nbetaL = 0.0\nheight = 4.0\n"
)


def run(line: str, status: int = 0) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(["equilibria", *line.split()])
    assert end.value.code == status, line


def test_the_table_names_the_held_ends_the_reactions_both_indices_and_the_search(capsys) -> None:
    run(f"{ROD} {QUICK}")
    said = capsys.readouterr().out
    assert said.split("\n")[0].split() == [
        "FZ", "(N)", "dbeta0", "(rad/cm)", "energy", "(N", "cm)", "turns", "index", "dead", "index", "stray", "(rad)",
        "attached",
    ]  # fmt: skip
    assert "1  -36.1824" in said
    assert "*" not in said  # solve begins from the nearest dead-load equilibrium, and selects from no list
    assert "4 equilibria, 2 stable under held ends: height" in said
    assert "not proved complete: searched over FZ from -90 to -30;" in said
    assert "3 dead-load problems" in said


def test_a_study_file_json_and_the_stored_file_hold_the_same(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    Path("held.toml").write_text(STUDY, encoding="utf-8")
    run(f"held.toml {QUICK} --json --out held.h5")
    told = json.loads(capsys.readouterr().out)
    assert told["search"]["within"] == {"FZ": [-90.0, -30.0]}
    assert not told["complete"]
    with xr.open_dataset("held.h5", engine="h5netcdf") as ds:
        np.testing.assert_array_equal(ds["FZ"], [one["reactions"]["FZ"] for one in told["equilibria"]])
        np.testing.assert_array_equal(ds["dead_index"], [one["dead_index"] for one in told["equilibria"]])
        np.testing.assert_allclose(ds["z"][:, -1], 4.0, atol=1e-10)
        assert float(ds["height"]) == 4.0
        assert ds.attrs["stability"] == "under held ends (height)"
        assert ds.attrs["remark"] == told["remark"]


@pytest.mark.parametrize(("line", "said"), (
    (f"{ROD} --axis FZ=-3:2:5", "begin from equilibria under dead loads and between two angles, got height"),
    (f"{ROD} --within MZ=0:1", "MZ"),
    (f"{ROD} --within FZ=0", "--within takes NAME=LOW:HIGH with numbers, such as FZ=-50:10, got 'FZ=0'"),
    (f"{ROD} --export cases", "--export writes cases under dead loads, got height; --out stores this list"),
    (f"{ROD} --values 1", "values must be a whole number of at least 2, got 1"),
    ("--within FZ=0:1", "--within belongs to the search of held ends, so it excludes dead loads and --axis"),
    ("--tries 0", "--tries belongs to the search of held ends"),
    (f"{ROD} --FZ 3", "Ends takes FZ or height, got both"),
))  # fmt: skip
def test_what_cannot_be_searched_is_refused_in_one_sentence(
    line: str, said: str, tmp_path, monkeypatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    run(line, 2)
    error = capsys.readouterr().err
    assert said in error
    assert "Traceback" not in error
    assert not list(tmp_path.iterdir())
