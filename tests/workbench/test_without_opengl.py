"""On a machine without OpenGL everything but the rendered pictures is done, and what is missing is said once."""

import shutil
import sys
from pathlib import Path

import pytest

from tests.workbench import forked, small
from tests.workbench.command import exit_status
from workbench.run import in_memory, writing
from workbench.scene import opengl

SAID = "libegl1 libgl1-mesa-dri"


STUDY = small.study("[axes.E]\nvalues = [2e4, 4e4]\n")


@pytest.fixture(scope="module")
def stored(tmp_path_factory) -> Path:
    ds = in_memory.run(STUDY.model_copy(update={"stations": 201}))
    return writing.write(ds, tmp_path_factory.mktemp("stored") / "mine.h5")


@pytest.fixture
def bare(stored, tmp_path, monkeypatch) -> Path:
    """A folder on such a machine, with a study stored in it; drawing would end the process there, and fails here."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(opengl, "COMMAND", (sys.executable, "-c", "import os; os.abort()"))
    monkeypatch.setattr(opengl, "in_wheel", list)
    for name in ("workbench.scene.layout", "workbench.scene.rendering"):
        monkeypatch.setitem(sys.modules, name, None)
    opengl.probe.cache_clear()
    Path("mine.toml").write_text(STUDY.text)
    shutil.copy(stored, "mine.h5")
    yield tmp_path
    opengl.probe.cache_clear()


@pytest.mark.parametrize(
    "words",
    ["scene mine.h5 --at E=4e4", "scene mine.toml --kind ghosts", "scene mine.h5 -o mine.gif"],
)
def test_what_cannot_be_drawn_is_said_once_with_what_to_install(words: str, bare, capsys) -> None:
    before = {path for path in bare.iterdir() if path.is_file()}
    capsys.readouterr()
    assert exit_status(*words.split()) == 1
    told = capsys.readouterr()
    assert (told.out + told.err).count(SAID) == 1
    assert (told.out + told.err).count(opengl.PIP) == 1
    assert {path for path in bare.rglob("*") if path.is_file()} == before


WITHOUT_VTK = """
import sys
for name in ("pyvista", "vtkmodules", "trimesh"):
    sys.modules[name] = None
from workbench import cli
for words in sys.argv[1:]:
    try:
        cli.main(words.split())
    except SystemExit as ended:
        print(f"{ended.code}: {words}", flush=True)
"""


def test_without_the_extra_scene_all_else_is_done_and_the_extra_is_named(tmp_path) -> None:
    (tmp_path / "mine.toml").write_text(STUDY.text)
    done = [
        "run mine.toml --out mine.h5 --stations 201",
        "plot mine.h5",
        "scene mine.h5 --out mine.html",
        "summary mine.h5",
        "export mine.h5 --at E=4e4 -o rod.stl",
    ]
    refused = ["export mine.h5 --at E=4e4 -o rod.glb", "export mine.h5 --at E=4e4 -o rod.obj"]
    (tmp_path / "main.py").write_text(WITHOUT_VTK)
    ran = forked.run("main.py", *done, "scene mine.h5", *refused, cwd=tmp_path)
    assert ran.returncode == 0
    statuses = [line for line in ran.stdout.splitlines() if line[:3] in ("0: ", "1: ", "2: ")]
    told = [*(f"0: {words}" for words in done), "1: scene mine.h5", *(f"2: {words}" for words in refused)]
    assert statuses == told
    assert ran.stderr.count("pip install 'rod-workbench[scene]'") == 1 + len(refused)
    assert "Traceback" not in ran.stderr
    assert {path.name for path in tmp_path.iterdir()} == {
        "main.py",
        "mine.toml",
        "mine.h5",
        "mine.png",
        "mine.html",
        "rod.stl",
    }


@pytest.mark.slow
def test_all_but_the_scenes_is_done(bare, capsys) -> None:
    kinds = ("stl", "glb", "vtp", "csv")
    exports = (f"export mine.h5 --at E=4e4 -o rod.{kind}" for kind in kinds)
    for words in (
        "run mine.toml --out again.h5",
        "check mine.h5",
        "summary mine.h5",
        "plot mine.h5",
        "plot mine.h5 --out mine.svg",
        *exports,
    ):
        assert exit_status(*words.split()) == 0, words
        assert SAID not in capsys.readouterr().err  # nothing was missing
    assert all((bare / name).stat().st_size > 500 for name in ("mine.png", "mine.svg", *(f"rod.{k}" for k in kinds)))
