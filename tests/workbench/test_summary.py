"""`workbench summary`: what the file holds, told from its numbers, however it is cut into blocks."""

import json
import re

import numpy as np
import pytest

from solver import solve
from solver.nodes.pipe_states import is_drawn, states
from studies.language.loader import loads
from tests.slow import slow_but
from tests.workbench import small
from tests.workbench.command import exit_status
from workbench.run import in_memory, writing
from workbench.stored import boxes, file_summary

AXES = small.axis("E", [1e4, 2e4]) + small.axis("R", [0.5, 0.75, 1.0])
LAW = small.law("kappa_max", "R", "falls", claim="(2)")


@pytest.fixture
def file(tmp_path):
    """A file of six cases, one of them unsolved and one with a large error."""
    ds = in_memory.run(small.study(AXES + LAW, 'observables = ["turns_around"]\noutputs = ["beta", "z"]'))
    ds = small.with_outcomes(ds, ["solved", "failed: on purpose", *["solved"] * 4])
    for name in ("turns_around", "kappa_max"):
        ds[name][0, 1] = np.nan
    ds["error"][1, 2] = 0.5
    ds["error"][0, 1] = 1e289  # of the unsolved case
    return writing.write(ds, tmp_path / "small.h5"), ds


@pytest.mark.parametrize("most", slow_but([1, 2, 4], 2))
def test_small_blocks_tell_the_same(file, most: int, monkeypatch) -> None:
    path, _ = file
    whole = file_summary.summary(path)
    monkeypatch.setattr(boxes, "AT_ONCE", most)
    assert file_summary.summary(path) == whole


def test_failures_that_differ_in_their_numbers_are_told_together(file, tmp_path) -> None:
    _, ds = file
    words = ["solved", "failed: 1", "failed: 2", "failed: 3", "failed: 1", "solved, barely"]
    ds = small.with_outcomes(ds, words)
    told = file_summary.summary(writing.write(ds, tmp_path / "many.h5"))
    assert told["unsolved"] == 4
    assert told["outcomes"] == {"failed: 1 to 3": 4, "solved": 1, "solved, barely": 1}


PIPE = {
    "EI": 1228.0, "GJ": 945.0, "a": 0.0635, "L": 300.0, "R": 0.10795, "side": "inside", "inclination": "90deg",
    "weight": 0.241, "beta0": 0.0, "betaL": 0.0, "azimuth": 0.0,
}  # fmt: skip


@pytest.mark.parametrize(("stations", "buckled"), [(401, "sinusoidal all along"), (21, file_summary.TOO_FEW)])
def test_the_states_of_pipes_are_a_table_unless_their_stations_are_too_few(stations, buckled, tmp_path, capsys) -> None:
    compressions = [-200.0, *map(float, range(-100, -100 + file_summary.AGAIN))]
    text = small.text(PIPE, small.axis("FZ", compressions), "m kN", outputs=["beta", "alpha", "z"], stations=stations)
    path = writing.write(in_memory.run(loads(text)), tmp_path / "pipe.h5")
    first, *others = file_summary.summary(path)["states"]
    assert first == {"FZ": -200.0, "state": buckled}
    assert {row["state"] for row in others} == {"straight all along"}
    assert exit_status("summary", path) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["FZ", "(kN)", *"state along the rod".split()] in lines  # noqa: SIM905
    assert ["-200", *buckled.split()] in lines


def test_of_many_pipes_the_states_are_counted(tmp_path) -> None:
    axes = small.axis("FZ", [-200.0, -100.0, -50.0]) + small.axis("L", (300.0, 316.0, 17))
    path = writing.write(in_memory.run(loads(small.text(PIPE, axes, "m kN", stations=401))), tmp_path / "p.h5")
    assert file_summary.summary(path)["states"] == [
        {"state": "straight all along", "cases": 34},
        {"state": "sinusoidal in a part or all along", "cases": 17},
    ]


def test_few_pipes_are_solved_again_where_their_stations_are_too_few(tmp_path) -> None:
    axis = small.axis("FZ", [-200.0, -195.0])
    text = small.text(PIPE, axis, "m kN", outputs=["beta", "alpha", "z"], stations=21)
    path = writing.write(in_memory.run(loads(text)), tmp_path / "pipe.h5")
    assert {row["state"] for row in file_summary.summary(path)["states"]} == {"sinusoidal all along"}


def test_a_summary_states_a_stress_in_the_unit_of_solve(tmp_path, capsys) -> None:
    rod = "--length-unit ft --force-unit klbf --E 4320000 --nu 0.3 --a 0.2 --L 10 --R 0.5 --beta0 0.1 --betaL 0.2"
    assert exit_status("solve", *rod.split(), "--json", "--out", tmp_path / "rod.h5") == 0
    in_file = json.loads(capsys.readouterr().out)["observables"]["bending_stress_max"]
    assert exit_status("summary", tmp_path / "rod.h5") == 0
    (row,) = [line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("bending_stress_max")]
    assert row[-1] == "ksi"
    assert float(row[1]) == pytest.approx(in_file / 144, rel=1e-4)


@pytest.mark.parametrize(("FZ", "inclination"), [(-270.0, 120), (-230.0, 120), (-22.0, 180), (-40.0, 179)])
def test_the_states_of_a_stored_pipe_are_those_of_the_solved_one(FZ, inclination, tmp_path) -> None:
    """Where the far end of one that nearly hangs goes round freely, a bend there is no turn to where the pipe lies."""
    length = 304.8 if inclination == 179 else 600.0
    inclined = PIPE | {"L": length, "inclination": f"{inclination}deg"}
    if inclination > 120:
        del inclined["azimuth"]
    study = loads(small.text(inclined, small.axis("FZ", [FZ]), "m kN", outputs=["beta", "alpha"], stations=201))
    (row,) = file_summary.summary(writing.write(in_memory.run(study), tmp_path / "pipe.h5"))["states"]
    solved = [state.word for state in solve(study.case_of({"FZ": FZ})).states]
    assert re.findall("straight|sinusoidal|helical", row["state"]) == solved


@pytest.mark.parametrize("outputs", [["beta", "alpha", "contact"], ["beta", "alpha"]])
def test_a_stored_pipe_is_helical_where_the_solved_one_is_also_above_its_neutral_point(outputs, tmp_path) -> None:
    hanging = PIPE | {"L": 600.0, "inclination": "180deg"}
    study = loads(small.text(hanging, small.axis("FZ", [-80.0]), "m kN", outputs=outputs, stations=1201))
    path = writing.write(in_memory.run(study), tmp_path / "pipe.h5")
    (row,) = file_summary.summary(path)["states"]
    solved = solve(study.case_of({"FZ": -80.0}), stations=1201)
    words, places = (re.findall(pattern, row["state"]) for pattern in ("straight|helical", r"[\d.]+(?= m|,|$)"))
    assert words == [state.word for state in solved.states]
    dense = solve(study.case_of({"FZ": -80.0}), stations=19201)
    drawn = is_drawn(-80 + PIPE["weight"] * (600 - dense.s), dense.push)
    ends = [state.end for state in states(dense.s, dense.beta, dense.alpha, drawn)]
    assert [float(place) for place in places] == pytest.approx(ends, abs=0.1)
    assert [state.end for state in solved.states] == pytest.approx(ends, abs=1.5)  # those of its nodes
    assert 600 - 80 / 0.241 - 30 < solved.states[0].end < 600 - 80 / 0.241


def test_sensitivity_states_moduli_and_stresses_in_the_units_of_solve(capsys) -> None:
    assert exit_status("sensitivity", "pipe_lubinski", "--fields", "E,a", "--show", "bending_stress_max") == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["E", "206000", "MPa"] in lines
    (row,) = [line for line in lines if line[:1] == ["bending_stress_max"]]
    assert row[2:4] == ["MPa", "%"]
