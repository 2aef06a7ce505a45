"""A scene of a study: solved at the stations that the picture needs, and nothing else."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from solver.problem.errors import InputError
from studies.language.loader import loads
from studies.language.study import MAX_STATIONS
from tests.slow import slow
from tests.workbench import small
from tests.workbench.command import exit_status
from tests.workbench.pictures import draws
from workbench.commands import draw_scene, study_scene
from workbench.export.stored_rod import export
from workbench.run import in_memory, writing
from workbench.scene import opengl, scene_kinds
from workbench.stored import case_of_file
from workbench.stored.enough_stations import at_needed_stations
from workbench.stored.stored_study import StoredStudy
from workbench.web.turntable import turntable_page

if opengl.probe()[0]:
    from workbench.scene import composition, layout

AXES = "[axes.E]\nvalues = [1e4, 2e4, 3e4]\n[axes.F1]\nvalues = [4.0, 5.0]\n"


@pytest.fixture
def file(tmp_path) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(small.study(AXES, 'observables = ["turns_around", "height"]').text)
    return path


@pytest.fixture
def solved(monkeypatch) -> list:
    """The studies that are solved."""
    found: list = []
    run = in_memory.run
    monkeypatch.setattr(in_memory, "run", lambda study, *more: (found.append(study), run(study, *more))[1])
    return found


def test_only_the_cases_that_are_shown_and_what_their_kind_reads_are_solved(file) -> None:
    _, rods = study_scene.two_stations(file)

    def solve_for(kind: str, at: dict[str, float], shown: list[str]) -> StoredStudy:
        solve = study_scene.solver_of(rods, scene_kinds.KINDS[kind], at, shown)
        assert solve is not None
        return solve(study_scene.FIRST)

    one = solve_for("curvature", {"E": 2e4}, [])
    assert (one["outcome"].size, one["E"].values.tolist()) == (1, [2e4])
    assert {name for name in one.variables if "u" in one[name].dims} == {"beta", "dbeta", "alpha", "z"}
    twist = solve_for("twist", {}, [])
    assert {name for name in twist.variables if "u" in twist[name].dims} == {"beta", "dbeta", "alpha", "z", "gamma"}
    row = solve_for("ghosts", {"F1": 4.0}, ["E"])
    assert (row["E"].values.tolist(), row["F1"].values.tolist()) == ([1e4, 2e4, 3e4], [4.0])


def test_the_stations_are_as_many_as_the_picture_asks_for(file, solved) -> None:
    pytest.importorskip("vtkmodules")
    from workbench.geometry.centreline import TooFewStations

    study, _ = study_scene.two_stations(file)

    def solve(stations):
        return in_memory.run(study.at_stations(stations))

    solved.clear()

    def draw(ds, exactly):
        n = ds.sizes["u"]
        if exactly and n < 100:
            raise TooFewStations("too few", 3 * n)
        return SimpleNamespace(error=0.5)

    _, stations = at_needed_stations(solve(study_scene.FIRST), solve, draw)
    assert [s.stations for s in solved] == [study_scene.FIRST, 3 * study_scene.FIRST, 9 * study_scene.FIRST]
    assert stations == 9 * study_scene.FIRST


WIRE = {"EI": 1.0, "GJ": 0.8, "a": 0.1, "L": 2000.0, "R": 1.0, "side": "inside"}
ENDS = {"beta0": 0.0, "betaL": 0.0, "FZ": -0.7, "MZ": 0.0, "M3": 0.0}
WOUND = small.text({**WIRE, **ENDS}, stations=201, outputs=["beta", "alpha", "z"])


@draws
@pytest.mark.parametrize("suffix", [".png", slow(".html")])
def test_a_file_with_too_few_stations_is_solved_again_and_without_a_study_refused(suffix, tmp_path, capsys) -> None:
    ds = in_memory.run(loads(WOUND, default_name="wound"))
    stored, out = tmp_path / "wound.h5", tmp_path / f"wound{suffix}"
    writing.write(ds, stored)
    assert draw_scene.scene(stored, out=out, dpi=60) == 0
    assert suffix == ".html" or "solved at" in capsys.readouterr().out
    few = ds.assign_attrs(study="")
    with pytest.raises(InputError, match="201 stations are too few"):
        (layout.compose if suffix == ".png" else turntable_page.html)(StoredStudy(few))
    with pytest.raises(InputError, match=r"201 stations are too far apart to tell the rate of beta: store about \d+"):
        export(StoredStudy(ds), tmp_path / "wound.csv")


@pytest.mark.parametrize("name", ["alpha", "z"])
def test_a_file_whose_case_is_solved_to_another_shape_is_refused(name, tmp_path) -> None:
    ds = in_memory.run(loads(small.study("").text, default_name="rod"))
    solve = study_scene.solver_of(StoredStudy(ds), scene_kinds.KINDS["contact"], {}, [])
    assert solve(1000).sizes["u"] == 1001
    other = study_scene.solver_of(StoredStudy(ds.assign({name: ds[name] * 1.01})), scene_kinds.KINDS["contact"], {}, [])
    with pytest.raises(InputError, match=f"other shapes than the file: {name} differs"):
        other(1000)


def test_a_file_goes_before_a_study_of_its_name(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert case_of_file.is_study(Path("fig6"))
    Path("fig6").write_text("")
    assert not case_of_file.is_study(Path("fig6"))
    assert not case_of_file.is_study(Path("mine.h5"))


@draws
def test_a_rod_that_the_most_stations_do_not_fix_is_drawn_once_and_refused() -> None:
    """Before, each of twelve rounds solved it again at the same stations and drew it."""
    drawn = []

    def draw(ds: object, strict: bool) -> None:
        drawn.append(strict)
        raise composition.TooFewStations("too few", 10 * MAX_STATIONS)

    solved = SimpleNamespace(sizes={"u": MAX_STATIONS})
    with pytest.raises(InputError, match="too few"):
        at_needed_stations(SimpleNamespace(sizes={"u": 2}), lambda stations: solved, draw)
    assert drawn == [True, False]


@draws
def test_a_number_in_the_name_draws_each_case_of_the_axis_before_one_camera(tmp_path, capsys) -> None:
    text = small.text(small.SHORT | {"beta": 0.5, "dbeta": 0.5, "M3": 0.0}, small.axis("F3", [1.0, 2.0]))
    (tmp_path / "two.toml").write_text(text)
    out = tmp_path / "f_{:02d}.png"
    asked = ["scene", tmp_path / "two.toml", "--kind", "plain", "--dpi", "50", "-o"]
    assert exit_status(*asked, out) == 0
    assert sorted(file.name for file in tmp_path.glob("*.png")) == ["f_00.png", "f_01.png"]
    assert exit_status(*asked, tmp_path / "one.png", "--at", "F3=2", "--along", "F3") == 0
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "f_01.png").read_bytes()
    assert exit_status(*asked, out) == 2
    assert "f_00.png" in capsys.readouterr().err
    for wrong in (["--kind", "grid"], ["--at", "F3=1"]):
        assert exit_status("scene", tmp_path / "two.toml", "-o", tmp_path / "g_{:d}.png", *wrong) == 2
