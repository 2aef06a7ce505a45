"""The command equilibria with held ends: its table, its file and picture, and what it refuses."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from solver import Case, Cylinder, Ends, Rod, solve
from tests.workbench import small

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


def test_the_start_of_a_held_solution_is_told_in_the_units_of_the_case() -> None:
    """The same rod in mm: the same force, ten times the moments."""
    solutions = [
        solve(Case(Rod(E=1.07e4 / k**2, nu=0.25, a=0.25 * k, L=5.0 * k), Cylinder(R=0.75 * k),
                   Ends(0.2, 0.3, azimuth=-1.0, FZ=-20.0)))
        for k in (1, 10)
    ]  # fmt: skip
    begun = [dict(re.findall(r"(\w+) = (\S+?),? ", f"{sol.begun} ")) for sol in solutions]
    assert "under dead loads" in solutions[0].begun
    cm, mm = ({name: float(value) for name, value in one.items()} for one in begun)
    assert (cm["FZ"], cm["beta0"], cm["betaL"]) == pytest.approx((mm["FZ"], mm["beta0"], mm["betaL"]), rel=1e-5)
    assert mm["MZ"] == pytest.approx(10 * cm["MZ"], rel=1e-4)
    assert cm["FZ"] == pytest.approx(-20.0, rel=1e-5)  # it is given, and is so from the start
