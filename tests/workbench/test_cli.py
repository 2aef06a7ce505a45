"""The command line, run as its users run it."""

import json
import math
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from solver import InputError
from studies import names
from tests.test_layers import HEAVY
from tests.workbench import forked, small
from tests.workbench.command import exit_status
from workbench import cli
from workbench.commands import option_checks, scene
from workbench.scene import opengl
from workbench.store import in_memory, study_store, writing

ROOT = Path(__file__).parents[2]


def workbench(*args: object, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    return forked.run("-m", "workbench", *args, cwd=cwd)


def new_process(*args: object, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "workbench.cli", *map(str, args)]
    return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, timeout=600, check=False)


@pytest.fixture(scope="module")
def stored(tmp_path_factory) -> Path:
    """A small study, run and stored by the command line."""
    folder = tmp_path_factory.mktemp("stored")
    (folder / "small.toml").write_text(small.TEXT)
    run = workbench("run", "small.toml", cwd=folder)
    assert run.returncode == 0, run.stderr
    return folder / "small.h5"


@pytest.fixture
def here(capsys) -> Callable[..., Any]:
    """What a command that ends well prints, run in this process; with --json as data."""

    def run(*args: object) -> Any:
        status = exit_status(*args)
        out, err = capsys.readouterr()
        assert status == 0, err
        return json.loads(out) if "--json" in args else out

    return run


def test_help_lists_the_commands_and_each_has_help_of_its_own() -> None:
    shown = new_process("--help")
    assert shown.returncode == 0
    for command in ("reproduce", "list", "run", "check", "plot", "scene", "solve", "doctor"):
        assert f"\n  {command} " in shown.stdout
    assert workbench().stdout == shown.stdout


def test_the_help_of_no_command_loads_a_heavy_library() -> None:
    code = (
        "import sys\nfrom workbench import cli\n"
        "for name in cli.COMMANDS:\n"
        "    try:\n        cli.main([name, '--help'])\n    except SystemExit:\n        pass\n"
        f"print(*({HEAVY | {'rich', 'solver', 'studies'}} & sys.modules.keys()), file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout.count("Usage: workbench ") == len(cli.COMMANDS)
    assert run.stderr.split() == []


def test_list_names_every_study_also_for_programs(here) -> None:
    rows = here("list", "--json")
    assert [row["study"] for row in rows] == names()
    modulus = next(row for row in rows if row["study"] == "fig7_1_modulus")
    axis = {"axis": "E", "from": 5e3, "to": 4e4, "count": 9, "unit": "N/cm^2", "follow": False}
    assert modulus["axes"] == [axis]  # data, not prose
    assert {"observable": "turns", "direction": "falls"}.items() <= modulus["laws"][0].items()
    told = here("list")
    assert "E 5000..40000 (9)" in told
    assert "(4): turns does not fall along betaL" in told


def test_run_stores_a_dataset_and_prints_its_laws(stored) -> None:
    with xr.open_dataset(stored) as ds:
        assert ds["turns"].dims == ("E", "R")
    shown = workbench("run", stored.with_suffix(".toml"), "--out", stored)
    assert shown.returncode == 0
    assert "kappa_max falls along R" in shown.stdout
    assert "6 cases, 0 unsolved" in shown.stdout
    assert shown.stderr == ""  # no progress bar where nobody watches


def test_run_takes_a_reading_a_tolerance_and_a_method(stored, tmp_path) -> None:
    options = ("--reading", "compression/solid", "--tol", "1e-6", "--method", "verlet", "--json")
    told = workbench("run", stored.with_suffix(".toml"), "--out", tmp_path / "x.h5", *options, "--stations", 33)
    assert json.loads(told.stdout)["reading"] == "force-first/compression/solid"
    ds = writing.read(tmp_path / "x.h5")
    assert (ds.attrs["method"], ds.attrs["tolerance"], ds.sizes["u"]) == ("verlet", 1e-6, 33)


def test_what_no_real_rod_could_do_is_said_when_a_study_is_run_and_when_it_is_checked(here, tmp_path) -> None:
    (tmp_path / "one.toml").write_text(small.HEAD)
    stored = tmp_path / "one.h5"
    ran = here("run", tmp_path / "one.toml", "--out", stored)
    assert "one.h5: 1 case, 0 unsolved" in ran
    said = writing.read(stored).attrs["caution"]
    assert said.startswith("The rod ")
    assert f"caution: {said}" in ran
    assert f"caution: {said}" in here("check", stored)
    assert here("check", stored, "--json")["caution"] == said


def test_check_tells_a_law_that_holds_from_one_that_fails_by_its_status(stored, tmp_path) -> None:
    good = workbench("check", stored, "--json")
    assert (good.returncode, json.loads(good.stdout)["laws"][0]["verdict"]) == (0, "holds")
    ds = writing.read(stored)
    turned = ds.assign(kappa_max=ds["kappa_max"].copy(data=1 / ds["kappa_max"].values))
    bad = workbench("check", writing.write(turned, tmp_path / "bad.h5"))
    assert bad.returncode == 1, bad.stderr
    assert re.search(r"^false +\(2\)", bad.stdout, re.M)


def test_solve_of_nothing_is_the_rod_of_table_1_and_says_so(here) -> None:
    told = here("solve", "--json")
    assert told["outcome"].startswith("solved")
    assert told["source"] == "Table 1, read force-first/tension/paper"
    assert (told["case"]["E"], told["case"]["F1"], told["case"]["stiffness"]) == (1.07e4, 5.0, "paper")
    assert len(told["along"]["beta"]) == 201
    assert "rod: Table 1, read force-first/tension/paper" in here("solve")


def test_solve_changes_table_1_only_where_that_is_asked_for(here) -> None:
    told = here("solve", "--table1", "--F3", "-10", "--json")
    assert told["case"]["F3"] == -10.0
    assert told["source"] == "Table 1, read force-first/tension/paper, except F3"
    assert told["observables"]["turns"] == 11  # the paper's stiffness, compression
    assert re.search(r"^turns +11 ", here("solve", "--reading", "compression"), re.M)
    for change in ("--dgamma=0.5", "--M3=0"):
        assert "F1" not in here("solve", "--table1", change, "--json")["case"]


OWN = ("--E", 2.1e8, "--nu", 0.3, "--a", 0.06, "--L", 30, "--R", 0.11, "--length-unit", "m", "--force-unit", "kN")


def test_solve_of_ones_own_rod_takes_nothing_from_table_1_and_tells_what_was_assumed(here) -> None:
    told = here("solve", *OWN, "--beta", "2deg", "--dbeta", 0, "--M3", 0, "--F3", 50, "--json")
    assert told["units"] == {"length": "m", "force": "kN"}
    assert told["case"]["beta"] == pytest.approx(math.radians(2), rel=1e-15)
    assert (told["case"]["stiffness"], told["case"]["gamma"], told["case"]["M3"]) == ("solid", 0.0, 0.0)
    assert told["assumed"] == {"stiffness": "solid", "side": "outside", "F2": 0.0, "alpha": 0.0, "gamma": 0.0}


def test_solve_takes_a_rod_by_its_ends_and_says_which_of_its_equilibria_it_is(here) -> None:
    shown = here("solve", *OWN, "--side", "inside", "--beta0", "pi/90", "--betaL", "2deg", "--FZ", -50)
    assert "shown: the stable shape that swings least" in shown
    assert "assumed: stiffness = solid, MZ = 0.0, M3 = 0.0, alpha = 0.0, gamma = 0.0" in shown
    assert "axial force" in shown


def test_solve_tells_how_many_equilibria_there_are_and_takes_the_one_that_is_asked_for(here) -> None:
    pipe = ("--E", 1e7, "--nu", 0.3, "--a", 0.0635, "--L", 30, "--R", 0.108, "--length-unit", "m")
    rod = (*pipe, "--force-unit", "kN", "--side", "inside", "--beta0", 0, "--betaL", 0, "--FZ", -300)
    told = here("solve", *rod, "--json")
    assert told["selection"]["choose"] == "nearest"
    assert 0 < told["selection"]["stable"] < told["selection"]["count"]
    low = here("solve", *rod, "--choose", "lowest", "--json")
    assert low["observables"]["height"] < 0 < told["observables"]["height"]  # the lowest energy is turned round
    second = here("solve", *rod, "--choose", 1, "--json")
    assert second["selection"]["choose"] == 1
    refused = workbench("solve", *rod, "--choose", "near")
    assert refused.returncode == 2
    assert "--choose must be nearest, lowest or a Morse index (0, 1, 2, ...), got 'near'" in refused.stderr
    refused = workbench("solve", "--table1", "--choose", "lowest")
    assert "a start problem has one solution" in refused.stderr


def test_solve_reads_a_case_from_a_file_and_options_change_it(here, tmp_path) -> None:
    base = {"E": 100.0, "nu": 0.25, "a": 2.5, "L": 200.0, "R": 7.5, "beta": 0.5, "dbeta": 0.05, "dgamma": 0.05}
    (tmp_path / "case.toml").write_text(small.text({**base, "F3": 10.0, "stiffness": "paper"}, units="mm N"))
    told = here("solve", tmp_path / "case.toml", "--L", "100", "--json")
    assert told["units"] == {"length": "mm", "force": "N"}
    assert (told["case"]["L"], told["case"]["a"]) == (100.0, 2.5)


def test_a_case_that_is_not_solved_gives_status_1() -> None:
    run = workbench("solve", "--method", "dop853", "--tol", "1e-15", "--json")
    assert run.returncode == 1, run.stderr
    told = json.loads(run.stdout)
    assert told["outcome"].startswith("failed")
    assert told["solved"] is False


def test_of_an_unsolved_case_what_is_known_is_printed_and_no_nan() -> None:
    ends = (
        "--E",
        "1e4",
        "--nu",
        "0.25",
        "--a",
        "0.25",
        "--L",
        "20",
        "--R",
        "0.75",
        "--beta0",
        "10deg",
        "--betaL",
        "20deg",
    )
    run = workbench("solve", *ends, "--MZ", "1", "--M3", "0", "--height", "19.99999999")
    assert run.returncode == 1
    assert not re.search(r"\b(nan|inf)\b", run.stdout)
    assert re.search(r"^height +19\.99999999 +cm ", run.stdout, re.MULTILINE)
    assert "kappa_max" not in run.stdout
    assert "failed: the branch of the start could not be followed" in run.stdout
    run = workbench("solve", "--table1", "--tol", "1e-30")  # solved, but not so accurately
    assert run.returncode == 1
    assert "kappa_max" in run.stdout
    assert not re.search(r"\bnan\b", run.stdout)


REFUSED = {
    "half a rod": (
        "solve --E 1e4 --L 20 --beta 0.5",
        "a start problem also needs nu, a, R, dbeta and one of F1, dgamma, M3; --table1 takes",
    ),
    "half a rod by its ends": (
        "solve --E 1e4 --nu 0.3 --a 1 --R 2 --beta0 0",
        "an ends problem also needs L and betaL (or M1L); --table1 takes the rod of Table 1",
    ),
    "a held height without the far angle": (
        "solve --E 1e4 --nu 0.3 --a 0.25 --L 5 --R 0.75 --beta0 20deg --height 4",
        "an ends problem also needs betaL (or M1L); --table1",
    ),
    "half of two sections": (
        "solve --EI 3 --E 1e4 --a 0.25 --L 5 --R 0.75 --beta0 0.1 --betaL 0.2",
        "Rod has one section: give E and nu (and inner_radius for a tube), or EI and GJ; got E=10000.0, EI=3.0",
    ),
    "one load without a rod": ("solve --F3 3", "also needs E, nu, a, L, R, beta, dbeta and one of"),
    "a start and an end": ("solve --beta 1 --betaL 1", "not both: beta is a field of the start, betaL of the ends"),
    "ends of Table 1": ("solve --table1 --betaL 1", "this case is a start problem, which has no betaL; choose from"),
    "units of Table 1": ("solve --table1 --length-unit m", "Table 1 is in cm and N: omit the units"),
    "units of a file": ("solve one.toml --force-unit kN", "one.toml states its own units: change them in the file"),
    "a file and Table 1": ("solve one.toml --table1", "one.toml and --table1 exclude each other"),
    "an unknown unit": (
        f"solve {' '.join(map(str, OWN))} --beta=0 --dbeta=0 --M3=0 --length-unit parsec",
        "no unit of length 'parsec'; choose from nm, um",
    ),
    "an angle that is none": ("solve --beta 30grad", "'30grad' is not an angle: give a number in rad, or a form"),
    "no room inside": ("solve --table1 --R 0.2 --side inside", "larger than Rod.a = 0.25 for a rod inside, got 0.2"),
    "E below zero": ("solve --table1 --E -1", "Rod.E must be positive and finite, got -1.0"),
    "nu too large": ("solve --table1 --nu 0.6", "Rod.nu must be in (-1, 0.5], got 0.6"),
    "no number": ("solve --table1 --E nan", "Rod.E must be finite, got nan"),
    "text for a number": ("solve --table1 --E abc", "'abc' is not a number"),
    "F1 and dgamma": ("solve --table1 --F1 5 --dgamma 1", "exactly one of F1, dgamma and M3, got F1=5.0, dgamma=1"),
    "F1 without slope": ("solve --table1 --dbeta 0", "F1 cannot determine the twist at dbeta = 0"),
    "no length": ("solve --table1 --L 0", "Rod.L must be positive and finite, got 0.0"),
    "an unknown field": (
        "solve --young 1",
        "No such option: --young, did you mean '--E'; choose from --table1, --reading",
    ),
    "a seed": ("solve --table1 --seed straight", "No such option: --seed; a shape to begin with is given in"),
    "an unknown stiffness": ("solve --table1 --stiffness soft", "no stiffness 'soft'; choose from solid, paper"),
    "an unknown method": ("solve --method rk5", "no method 'rk5', did you mean 'rk4'; choose from auto"),
    "a tolerance of nothing": ("solve --tol 0", "tol must be a number between 0 and 1, got 0.0"),
    "an unknown command": ("frobnicate", "No such command 'frobnicate'; choose from reproduce, list"),
    "an unknown study": ("run fig7_1", "did you mean 'fig7_1_modulus'; choose from capstan, fig6"),
    "an unknown reading": ("run fig6 --reading torsion", "no reading 'torsion'; choose one word"),
    "a missing file": ("check absent.h5", "file not found: absent.h5"),
    "a study for a dataset": ("check small.toml", "small.toml is a study, not a dataset; make the dataset with: wo"),
    "half a file": ("check half.h5", "half.h5 cannot be read as HDF5"),
    "half a file to draw": ("scene half.h5", "half.h5 cannot be read as HDF5"),
    "an axis that is not there": ("scene small.h5 --at Q=1", "no axis 'Q'; choose from E, R"),
    "a value off the axis": (
        "scene small.h5 --at E=1",
        "--at E=1: E = 1 is not on the axis; its values are 10000, 20000",
    ),
    "a value between two of the axis": (
        "scene small.h5 --at E=1.07e4",
        "--at E=1.07e4: E = 1.07e4 is not on the axis; its values are 10000, 20000",
    ),
    "the same axis twice": ("scene small.h5 --at E=1e4 --at E=2e4", "E=2e4: E is given twice"),
    "a picture that is there": ("plot small.h5 --out there.png", "there.png exists; give --force to"),
    "a scene that is there": ("scene small.h5 --out there.png", "there.png exists; give --force to"),
    "a picture of equilibria that is there": ("equilibria --plot there.png", "there.png exists; give --force"),
    "a picture in no folder": ("plot small.h5 --out no/x.png", "folder not found: no"),
    "a value that is none": ("scene small.h5 --at E=x", "E must be a finite number, got 'x'"),
    "a picture of no kind": ("plot small.h5 -o x.doc", "choose a name that ends in .png, .pdf, .svg"),
    "a map of no axis": ("plot small.h5 --x RE", "no axis 'RE', did you mean 'R' or 'E'; choose from E, R"),
    "a map of one axis twice": ("plot small.h5 --x R --y R", "x and y are both R; choose another axis"),
    "a map of no observable": (
        "plot small.h5 --show turn",
        "no observable 'turn', did you mean 'turns'; the file has turns, wraps, kappa_max",
    ),
    "an unknown kind of picture": (
        "plot small.h5 --kind maps",
        "no kind of picture 'maps', did you mean 'map'; choose from map, lines",
    ),
    "an option of maps for lines": (
        "plot small.h5 --kind lines --at E=1e4",
        "--at is no option of --kind lines; choose --kind from map, curves, ridge, portrait, states",
    ),
    "too many shapes": ("plot small.h5 --shapes 13x1", "two numbers from 1 to 12 such as 5x5, got '13x1'"),
    "no number of shapes": ("plot small.h5 --shapes 0x2", "from 1 to 12 such as 5x5, got '0x2'"),
    "more shapes than values": ("plot small.h5 --shapes 2x4", "4 shapes along R are more than its 3 values"),
    "a fixed value of an axis of the map": (
        "plot small.h5 --x E --at E=1e4",
        "E is an axis of the map and has no fixed value; leave out the value of E",
    ),
    "a map of one axis that is left": (
        "plot small.h5 --at E=1e4",
        "a map needs two axes, and E has a fixed value; leave one of E, R free",
    ),
    "a place that cannot be written": (
        "run fig6 --out small.toml/x.h5",
        "cannot write small.toml/x.h5: folder not found: small.toml",
    ),
    "a folder that is not there": ("run fig6 --out not/here.h5", "cannot write not/here.h5: folder not found: not"),
    "an empty method": ("run fig6 --out x.h5 --method ''", "no method ''; choose from auto, orbit"),
    "an empty method for one case": ("solve --method ''", "no method ''; choose from auto, orbit"),
    "too many stations": ("run fig6 --stations 100002", "stations must be from 2 to 100001, got 100002"),
    "another study's file": ("run fig6 --out small.h5", "holds the study 'small', not 'fig6'; give --force"),
    "a file of another kind": ("run fig6 --out small.toml", "small.toml exists and is not a study"),
    "a grid without end": ("run huge.toml", "the grid has 1000000000000 cases, more than the limit of 1000000000"),
    "a misspelt key": ("run typo.toml", "typo.toml, line 2: no key 'readin', did you mean 'reading'"),
    "several cases at once": ("solve small.toml", "small.toml has the axes E, R: use workbench run to solve it"),
    "a folder that is a file": ("reproduce --out small.toml", "cannot write into the folder small.toml"),
}


def test_a_value_is_taken_for_the_stored_one_that_it_is_when_rounded_as_it_is_written() -> None:
    values = {"E": [9962.0, 10700.4, 10905.0773], "beta0": [0.0, math.radians(27.1875), math.pi / 6]}
    ds = xr.Dataset(
        {"outcome": (("E", "beta0"), np.full((3, 3), "solved"))},
        {"E": ("E", values["E"], {"units": "N/cm^2"}), "beta0": ("beta0", values["beta0"], {"units": "rad"})},
    )
    for text, which in (
        ("1.07e4", 1),
        ("10905", 2),
        ("10910", 2),
        ("10905.0773", 2),
        ("9960", None),
        ("10920", None),
        ("1e4", None),
        ("10905.1", 2),
    ):
        if which is None:
            with pytest.raises(InputError, match=re.escape("its values are 9962, 10700.4, 10905.0773")):
                option_checks.axis_values(ds, [f"E={text}"])
        else:
            assert option_checks.axis_values(ds, [f"E={text}"]) == {"E": values["E"][which]}
    for text, which in (("0deg", 0), ("27.2deg", 1), ("pi/6", 2), ("30deg", 2), ("0.5236", 2), ("27deg", None)):
        if which is None:
            with pytest.raises(InputError, match=re.escape("its values are 0deg, 27.1875deg, 30deg")):
                option_checks.axis_values(ds, [f"beta={text}"])
        else:
            assert option_checks.axis_values(ds, [f"beta={text}"]) == {"beta0": values["beta0"][which]}


def test_a_picture_of_one_case_is_named_for_it_and_stands_beside_the_others(stored, tmp_path, monkeypatch) -> None:
    drawn = []
    monkeypatch.setattr(opengl, "probe", lambda: (True, ""))
    picture = SimpleNamespace(error=0.0)
    scenes = SimpleNamespace(render=lambda ds, path, *_: drawn.append(path) or picture)
    monkeypatch.setitem(sys.modules, "workbench.scene.layout", scenes)
    monkeypatch.setattr("workbench.scene.layout", scenes, raising=False)
    for at in ([], ["E=1e4"], ["E=2e4", "R=0.75"]):
        assert scene.scene_file(stored, at, None) == 0
    assert [path.name for path in drawn] == [
        "small_scene.png", "small_scene_E=10000.png", "small_scene_E=20000_R=0.75.png",
    ]  # fmt: skip


@pytest.fixture(scope="module")
def crowded(stored) -> Path:
    """A folder with a good file and some bad ones."""
    folder = stored.parent
    (folder / "half.h5").write_bytes(stored.read_bytes()[:3000])
    axis = "[axes.{}]\nfrom = 1.0\nto = 2.0\ncount = 1000000\n"
    huge = small.TEXT[: small.TEXT.index("[axes.E]")] + axis.format("E") + axis.format("R")
    (folder / "huge.toml").write_text(huge)
    (folder / "one.toml").write_text(small.HEAD)
    (folder / "there.png").write_bytes(b"mine")
    (folder / "typo.toml").write_text('title = "t"\nreadin = "shear"\n')
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize("args, sentence", REFUSED.values(), ids=REFUSED)
def test_one_sentence_and_status_2_for(args, sentence, crowded, monkeypatch, capsys) -> None:
    monkeypatch.chdir(crowded)
    before = contents(crowded)
    assert exit_status(*shlex.split(args)) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert sentence in err
    assert err.startswith("workbench: ")
    assert len(err.splitlines()) == 1
    assert contents(crowded) == before


@pytest.mark.parametrize(
    "case", ["another study's file", "a place that cannot be written", "a folder that is not there"]
)
def test_what_cannot_be_stored_is_refused_before_any_work(case, crowded, monkeypatch) -> None:
    monkeypatch.chdir(crowded)
    monkeypatch.setattr(study_store, "_solve", lambda *_: pytest.fail("worked in vain"))
    assert exit_status(*shlex.split(REFUSED[case][0])) == 2


@pytest.mark.parametrize(
    "case",
    [
        "no room inside",
        pytest.param("an unknown command", marks=pytest.mark.slow),
        pytest.param("half a file", marks=pytest.mark.slow),
    ],
)
def test_a_refusal_is_the_same_in_a_process_of_its_own(case, crowded) -> None:
    args, sentence = REFUSED[case]
    run = new_process(*shlex.split(args), cwd=crowded)
    assert (run.returncode, run.stdout) == (2, "")
    assert sentence in run.stderr
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "command",
    [
        ["plot"],
        pytest.param(["plot", "--kind", "curves"], marks=pytest.mark.slow),
        pytest.param(["animate", "--axis", "E"], marks=pytest.mark.slow),
    ],
    ids=" ".join,
)
def test_a_study_without_a_solved_case_is_not_drawn_and_the_sentence_says_why(command, tmp_path, capsys) -> None:
    ds = in_memory.run(small.grid())
    size = ds["outcome"].size
    words = [f"failed: the limit of 60 steps after {10 + i}% of the way" for i in range(size)]
    file = writing.write(small.with_outcomes(ds, words), tmp_path / "small.h5")
    assert exit_status(*command, file) == 2
    why = f"{size} x failed: the limit of 60 steps after 10 to {9 + size}% of the way"
    assert capsys.readouterr().err == f"workbench: nothing to draw: none of the {size} cases is solved: {why}\n"
    assert list(tmp_path.iterdir()) == [file]


LONG = "x" * 5000
LONG_VALUES = {
    "a number": ["solve", "--table1", "--M3", LONG],
    "an angle of several words": ["solve", "--table1", "--beta", "x y " * 1250],
    "a command": [LONG],
    "an option": ["solve", f"--{LONG}"],
    "a study": ["run", LONG],
    "a file": ["summary", f"{LONG}.h5"],
    "a part of a value": ["equilibria", "--axis", f"{LONG}=1:2:3"],
    "a part of a path": ["equilibria", "--out", f"/nowhere/{LONG}/a.h5"],
}


@pytest.mark.parametrize("words", LONG_VALUES.values(), ids=LONG_VALUES)
def test_a_long_value_is_cut_in_a_message(words, capsys) -> None:
    assert exit_status(*words) == 2
    said = capsys.readouterr().err
    assert said.startswith("workbench: ")
    assert said.count("\n") == 1
    assert "..." in said
    assert "x" * 201 not in said
    assert "x y " * 51 not in said
    assert len(said) < 1000


def test_a_list_of_choices_is_not_cut(capsys) -> None:
    assert exit_status("solve", "--none") == 2
    said = capsys.readouterr().err
    assert "choose from --" in said
    assert said.count("--") > 30
    assert "..." not in said


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
@pytest.mark.parametrize("buffered", [True, False])
@pytest.mark.parametrize(
    "words",
    [
        ["--version"],
        *(
            pytest.param(words.split(), marks=pytest.mark.slow)
            for words in ("--help", "list", "list --json", "solve --table1", "run small.toml")
        ),
    ],
    ids=" ".join,
)
def test_a_full_disk_behind_stdout_is_one_sentence_and_status_2(words, buffered, tmp_path) -> None:
    (tmp_path / "small.toml").write_text(small.TEXT)
    env = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "" if buffered else "1"}
    command = [sys.executable, "-m", "workbench.cli", *words]
    with open("/dev/full", "w") as full:
        run = subprocess.run(
            command, stdout=full, stderr=subprocess.PIPE, cwd=tmp_path, env=env, text=True, check=False
        )
    assert (run.returncode, run.stderr) == (2, "workbench: cannot write the output: No space left on device\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_a_full_disk_behind_stdout_and_stderr_leaves_the_status(tmp_path) -> None:
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "workbench.cli", "list"]
        assert subprocess.run(command, stdout=full, stderr=full, cwd=tmp_path, env=env, check=False).returncode == 2


@pytest.mark.skipif(os.name == "nt", reason="signals are sent otherwise there")
@pytest.mark.slow
def test_an_interrupted_run_says_so_and_leaves_no_half_file(crowded, tmp_path) -> None:
    study = small.TEXT[: small.TEXT.index("[axes.E]")].replace("stations = 21", "stations = 2001")
    (tmp_path / "long.toml").write_text(study + "[axes.E]\nfrom = 1e4\nto = 2e4\ncount = 2000\n")
    command = [sys.executable, "-c", INTERRUPTIBLE, "run", "long.toml", "--method", "dop853"]
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, cwd=tmp_path, env=env, stdout=-1, stderr=-1, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("2000 cases")
        assert process.stdout.readline() == "solving\n"
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=600)
    assert process.returncode == 130
    assert said.startswith("workbench: interrupted; ")
    assert len(said.splitlines()) == 1
    assert not (tmp_path / "long.h5").exists()


# Says on stdout when the solving begins, so that the test need not guess how long importing takes.
INTERRUPTIBLE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
from workbench import cli
from workbench.store import in_memory, study_store
solve = study_store._solve
def told(*args, **kwargs):
    print("solving", flush=True)
    return solve(*args, **kwargs)
study_store._solve = told
if __name__ == "__main__":
    cli.main()
"""


def test_a_closed_stdout_is_said_in_one_sentence() -> None:
    program = "from workbench.cli import main; main(['list'])"
    ended = subprocess.run(
        ["sh", "-c", '"$0" -c "$1" >&-', sys.executable, program], stderr=subprocess.PIPE, text=True, check=False
    )
    assert (ended.returncode, ended.stderr.count("\n")) == (2, 1)
    assert ended.stderr.startswith("workbench: stdout is closed")
