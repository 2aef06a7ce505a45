"""The command line, run as its users run it."""

import json
import os
import subprocess
import sys
from io import BytesIO, TextIOWrapper
from pathlib import Path
from types import SimpleNamespace

import pytest
from matplotlib.figure import Figure

from tests.slow import slow
from tests.test_layers import HEAVY
from tests.workbench import forked, small
from tests.workbench.command import exit_status
from workbench import cli
from workbench.commands import draw_scene
from workbench.run import run_and_resume, writing
from workbench.scene import opengl

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


def test_help_lists_the_commands_and_each_has_help_of_its_own() -> None:
    shown = new_process("--help")
    assert shown.returncode == 0
    for command in ("reproduce", "summary", "run", "check", "plot", "scene", "solve", "doctor"):
        assert f"\n  {command} " in shown.stdout
    assert workbench().stdout == shown.stdout


def test_the_help_of_no_command_loads_a_heavy_library() -> None:
    code = (
        "import sys\nfrom workbench import cli\n"
        "for name in cli.COMMANDS:\n"
        "    try:\n        cli.main([name, '--help'])\n    except SystemExit:\n        pass\n"
        f"print(*({HEAVY | {'rich', 'studies'}} & sys.modules.keys()), file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout.count("Usage: workbench ") == len(cli.COMMANDS)
    assert run.stderr.split() == []


def test_a_picture_of_one_case_is_named_for_it_and_stands_beside_the_others(stored, tmp_path, monkeypatch) -> None:
    drawn = []
    monkeypatch.setattr(opengl, "probe", lambda: (True, ""))
    picture = SimpleNamespace(error=0.0, fig=Figure())
    scenes = SimpleNamespace(render=lambda ds, path, *_: drawn.append(path) or picture)
    monkeypatch.setitem(sys.modules, "workbench.scene.layout", scenes)
    monkeypatch.setattr("workbench.scene.layout", scenes, raising=False)
    for at in ([], ["E=1e4"], ["E=2e4", "R=0.75"]):
        assert draw_scene.scene(stored, at=at) == 0
    assert [path.name for path in drawn] == [
        "small_scene.png", "small_scene_E=10000.png", "small_scene_E=20000_R=0.75.png",
    ]  # fmt: skip


@pytest.mark.parametrize("out", ["small.h5", "small.toml/x.h5", "not/here.h5", "rods.png"])
def test_what_cannot_be_stored_is_refused_before_any_work(out, stored, monkeypatch) -> None:
    monkeypatch.chdir(stored.parent)
    monkeypatch.setattr(run_and_resume, "_solve", lambda *_: pytest.fail("worked in vain"))
    assert exit_status("run", "fig6", "--out", out) == 2


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("solve --table1 --R 0.2 --side inside", "larger than Rod.a = 0.25 for a rod inside, got 0.2"),
        slow("frobnicate", "No such command 'frobnicate'; choose from solve, explore"),
        slow("check small.toml", "small.toml is a study, not a dataset; make the dataset with: wo"),
    ],
)
def test_a_refusal_is_the_same_in_a_process_of_its_own(words, sentence, stored) -> None:
    run = new_process(*words.split(), cwd=stored.parent)
    assert (run.returncode, run.stdout) == (2, "")
    assert sentence in run.stderr
    assert len(run.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "command",
    [
        ["plot"],
        slow(["plot", "--kind", "curves"]),
        slow(["scene", "-o", "E.mp4", "--axis", "E"]),
    ],
    ids=" ".join,
)
def test_a_study_without_a_solved_case_is_not_drawn_and_the_sentence_says_why(command, tmp_path, capsys) -> None:
    ds = small.six()
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
        *(slow(words.split()) for words in ("--help", "summary", "summary --json", "solve --table1", "run small.toml")),
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
        command = [sys.executable, "-m", "workbench.cli", "summary"]
        assert subprocess.run(command, stdout=full, stderr=full, cwd=tmp_path, env=env, check=False).returncode == 2


def test_a_closed_stdout_is_said_in_one_sentence() -> None:
    program = "from workbench.cli import main; main(['summary'])"
    ended = subprocess.run(
        ["sh", "-c", '"$0" -c "$1" >&-', sys.executable, program], stderr=subprocess.PIPE, text=True, check=False
    )
    assert (ended.returncode, ended.stderr.count("\n")) == (2, 1)
    assert ended.stderr.startswith("workbench: stdout is closed")


TITLE = "Länge −2° 漢字 \N{GRINNING FACE}"


@pytest.mark.parametrize("encoding", ["ascii", "cp1252:strict", "utf-8:strict"])
def test_any_text_is_printed_on_any_stdout(encoding: str, tmp_path, monkeypatch) -> None:
    """A sign that the stream lacks is spelt in letters, another letter by its number; JSON keeps the text."""
    (tmp_path / "small.toml").write_text(small.TEXT.replace("two moduli and three radii", TITLE), encoding="utf-8")
    lines = ("run small.toml", "summary small.h5", "check small.h5", "summary small.h5 --json")
    monkeypatch.chdir(tmp_path)
    said = []
    for line in lines:
        stream = TextIOWrapper(BytesIO(), *encoding.split(":"))
        monkeypatch.setattr(sys, "stdout", stream)
        assert exit_status(*line.split()) in (0, 1)
        stream.flush()
        said.append(stream.buffer.getvalue().decode(encoding.partition(":")[0]))
    printed = {
        "ascii": r"L\u00e4nge -2deg \u6f22\u5b57 \ud83d\ude00", "cp1252:strict": r"Länge -2° \u6f22\u5b57 \ud83d\ude00"
    }.get(encoding, TITLE)  # fmt: skip
    assert all(printed in text for text in said[:3])
    assert json.loads(said[3])["title"] == TITLE


def test_a_folder_in_place_of_a_file_names_one_of_its_files_and_the_command_that_takes_it(tmp_path, capsys) -> None:
    results = tmp_path / "results"
    results.mkdir()
    assert exit_status("check", results) == 2
    said = "results is a folder, not a dataset; plot alone takes the folder that reproduce wrote"
    assert said in " ".join(capsys.readouterr().err.split())
    (results / "fig6.h5").touch()
    assert exit_status("check", results) == 2
    assert "fig6.h5; plot alone takes" in " ".join(capsys.readouterr().err.split())
