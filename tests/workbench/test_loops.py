"""The command loops: its table, its files and its refusals."""

import json
from math import pi
from pathlib import Path

import numpy as np
import pytest

from solver import Cylinder, InputError, Rod, loops
from tests.workbench.command import run
from workbench.geometry import self_contact, stored_line
from workbench.store import reading


def test_the_command_prints_lists_and_stores_the_loops(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    line = "loops --a 0.05 --R 0.95 --L 9 --folds 1,2 --out loops.h5"
    run(line)
    told = capsys.readouterr().out
    assert "2 loops, 1 stable as closed rods on the surface, the section free to turn" in told
    assert "number 1, 2: the push is negative somewhere" in told
    ds = reading.read(Path("loops.h5"), study=False)
    assert ds["folds"].values.tolist() == [1, 2]
    assert ds["index"].values.tolist() == [0, 2]
    np.testing.assert_allclose(ds["z"][:, -1], 0, atol=1e-10)
    np.testing.assert_allclose(ds["alpha"][:, -1], 2 * pi, atol=1e-10)
    assert "overlaps" not in str(ds["caution"].values)  # the ends of a closed rod are neighbours
    run(f"{line} --json")
    found = json.loads(capsys.readouterr().out)
    assert [one["self_intersection"] for one in found["loops"]] == ["no", "no"]
    assert found["loops"][0]["lam"] == pytest.approx(float(ds["lam"][0]))
    assert found["complete"]


def test_a_dataset_of_loops_has_the_units_given_and_of_none_there_is_none() -> None:
    found = loops(Rod(E=1e4, nu=0.3, a=0.05, L=9.0), Cylinder(R=0.95), folds=1)
    ds = found.to_dataset(length="nm", force="pN")
    assert ds["energy"].attrs["units"] == "pN nm"
    del found[:]
    with pytest.raises(InputError, match="no loop was found"):
        found.to_dataset()


def test_the_ends_of_a_closed_rod_are_no_place_where_it_passes_through_itself() -> None:
    found = loops(Rod(E=1.07e4, nu=0.25, a=0.05, L=12.0), Cylinder(R=1.05, side="inside"), folds=2)
    ds = found.to_dataset(length="cm", force="N")
    for k in range(ds.sizes["equilibrium"]):
        line = stored_line.read(ds, {"equilibrium": k})
        end = line.frame(line.s[:1])[0]
        assert all(np.linalg.norm(place - end) > line.a for place in self_contact.middles(line, (0.0, line.L)))
