"""docs/how-to/refine-a-boundary.md: its studies, its commands and its Python run as they stand."""

import re
import shlex
from pathlib import Path

import pytest

from studies.loader import load, loads
from tests.workbench import doc_pages
from tests.workbench.pictures import pixels
from workbench import cli

ROOT = Path(__file__).parents[2]
PAGE = doc_pages.read(ROOT / "docs" / "how-to" / "refine-a-boundary.md")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def run(lines: str) -> None:
    for line in lines.splitlines():
        with pytest.raises(SystemExit) as end:
            cli.main(shlex.split(line.removeprefix("workbench ")))
        assert not end.value.code, line


def test_the_first_study_of_the_page_is_the_shipped_one() -> None:
    assert loads(blocks("toml")[0], default_name="regimes_refined").model_dump() == load("regimes_refined").model_dump()


def test_the_study_along_one_axis_of_the_page_runs_as_it_stands(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    Path("critical.toml").write_text(blocks("toml")[1], encoding="utf-8")
    run(blocks("sh")[1])
    shown = capsys.readouterr().out
    assert "60 cases, 0 unsolved" in shown
    assert re.search(r"turns +E +3 ", shown)  # three critical values, of which each took some twenty cases
    assert Path("critical.png").stat().st_size > 5000


@pytest.mark.slow
def test_the_page_runs_as_it_stands_and_its_picture_is_the_one_made(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    run(blocks("sh")[0])
    assert "29947 cases, 6.7 % of the uniform grid of 769 x 577" in capsys.readouterr().out
    shown, made = pixels(ROOT / "docs" / "figures" / "regimes_refined.png"), pixels(Path("regimes_refined.png"))
    assert shown.shape[1] / shown.shape[0] == pytest.approx(made.shape[1] / made.shape[0], rel=0.01)
    (python,) = blocks("python")
    exec(compile(python, "refine-a-boundary.md", "exec"), {})
    assert capsys.readouterr().out.splitlines() == doc_pages.printed(python)
