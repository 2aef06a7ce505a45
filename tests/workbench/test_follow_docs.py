"""docs/how-to/find-equilibria.md: its Python, its study and its commands run as they stand."""

import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.workbench import doc_pages
from workbench import cli
from workbench.commands.equilibria import parse_axis

DOCS = doc_pages.read(Path(__file__).parents[2] / "docs" / "how-to" / "find-equilibria.md", "Follow a branch")


def blocks(kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", DOCS, re.DOTALL)


def commands(folder: Path) -> list[str]:
    """The commands of the page; its study is written into the folder."""
    (study,) = blocks("toml")
    (folder / "snap.toml").write_text(study, encoding="utf-8")
    return [line for block in blocks("sh") for line in block.splitlines()]


def run(line: str) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(shlex.split(line.removeprefix("workbench ")))
    assert end.value.code == 0, line


@pytest.mark.slow
def test_the_python_of_the_page_follows_the_branch_through_its_snap() -> None:
    names: dict[str, Any] = {}
    exec(blocks("python")[0], names)
    folds = [one.value for one in names["branch"].special if one.kind == "fold"]
    assert [round(value, 3) for value in folds] == [-0.279, -0.967] or [round(v, 3) for v in folds] == [-0.967, -0.279]
    assert names["branch"].end.reason == "the end of the range"
    assert names["ds"]["height"].dims == ("point",)
    exec(blocks("python")[1], names)
    assert names["euler"].value == pytest.approx(-((np.pi / 10) ** 2), rel=1e-9)
    assert float(names["left"].dbeta[0]) == pytest.approx(-float(names["right"].dbeta[0]), rel=1e-9)
    assert names["buckled"].end.reason == "the end of the range"


@pytest.mark.slow
def test_its_commands_draw_the_diagrams(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    lines = commands(tmp_path)
    assert len(lines) == 2
    for line in lines:
        run(line)
    said = capsys.readouterr().out
    assert "14 branches, 9 folds over 21 values of FZ" in said
    assert "1 branch, 0 folds over 21 values of height" in said
    assert (tmp_path / "dead.png").stat().st_size > 50_000
    assert (tmp_path / "held.png").stat().st_size > 30_000


@pytest.mark.parametrize(
    "options, said",
    [
        ("--show wraps", "--show wraps names what --axis shows; give --axis too"),
        ("--axis FZ=-1:1:2 --show colour", "no quantity to show 'colour'"),
    ],
)
def test_what_a_diagram_cannot_show_is_refused(tmp_path, monkeypatch, capsys, options: str, said: str) -> None:
    monkeypatch.chdir(tmp_path)
    commands(tmp_path)
    with pytest.raises(SystemExit) as end:
        cli.main(["equilibria", "snap.toml", *shlex.split(options)])
    assert end.value.code == 2
    text = capsys.readouterr()
    assert said in text.out + text.err


@pytest.mark.slow
def test_a_short_held_axis_is_followed(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    commands(tmp_path)
    run("workbench equilibria snap.toml --axis height=3.9:4.1:2 --json --plot held.png --out held.h5")
    assert '"branches"' in capsys.readouterr().out
    assert (tmp_path / "held.png").exists()
    assert (tmp_path / "held.h5").exists()


@pytest.mark.parametrize("name", ["height", "azimuth", "rotation", "M10", "M1L"])
def test_what_an_end_holds_may_be_an_axis(name: str) -> None:
    assert parse_axis(f"{name}=-1:1:3")[0] == name
