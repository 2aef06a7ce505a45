"""docs/how-to/fit-parameters.md: its points, commands and Python run as they stand and make its picture."""

import re
import shlex
from pathlib import Path

import pytest

from tests.workbench import doc_pages
from tests.workbench.pictures import pixels
from workbench import cli

ROOT = Path(__file__).parents[2]
PAGE = doc_pages.read(ROOT / "docs" / "how-to" / "fit-parameters.md")
UNDETERMINED = "E,M3,F3"  # status 1, as the page says


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def unwrapped(text: str) -> str:
    return " ".join(text.split())


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """A folder with the points of the page."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "points.csv").write_text(blocks("csv")[0], encoding="utf-8")
    return tmp_path


def run(line: str) -> int:
    with pytest.raises(SystemExit) as end:
        cli.main(shlex.split(line.strip().removeprefix("workbench ")))
    return int(end.value.code or 0)


@pytest.mark.slow
def test_the_points_are_fitted_and_drawn_as_the_page_shows(folder, capsys) -> None:
    (line,) = [line for block in blocks("sh") for line in block.splitlines() if "--plot" in line]
    assert run(f"{line} --starts 0") == 0
    shown = [" ".join(row.split()) for row in capsys.readouterr().out.splitlines()]
    for row in blocks("text")[0].splitlines():
        assert " ".join(row.split()) in shown
    page, made = pixels(ROOT / "docs" / "figures" / "fit.png"), pixels(Path("fit.png"))
    assert page.shape == made.shape
    assert (abs(page - made) > 0.1).mean() < 0.02  # letters may be hinted otherwise on another machine


@pytest.mark.slow
def test_the_commands_of_the_page_run_as_they_stand(folder, capsys) -> None:
    lines = [line for block in blocks("sh") for line in block.splitlines() if line.strip()]
    assert len(lines) == 4
    for line in lines:
        assert run(line) == (1 if UNDETERMINED in line else 0), line
    said = capsys.readouterr().out
    for part in (
        "F1      2.74196",
        "3.08124",
        "reaches the target",
        "9 (bound)",
        "caution: 1 other value reaches the target: the values are not unique",
    ):
        assert part in said
    assert "the data cannot tell E and M3 and F3 apart: no datum changes when these change together" in said
    assert "condition number 6.3\n" in said
    assert "*Condition number 6.3*" in unwrapped(PAGE)
    assert "E, M3 and F3 by +1 % each" in said
    assert "E, M3 and F3 by +1 % each" in unwrapped(PAGE)
    assert run("fit fig7_1_modulus --at E=10905 --target height=12 --vary F1 --bounds F1=1:9") == 2
    nearest = re.findall(r"\*(the nearest reached.*?)\.\*", unwrapped(PAGE))
    assert nearest
    assert nearest[0] in capsys.readouterr().err


def test_the_python_of_the_page_prints_what_it_says(capsys) -> None:
    (python,) = blocks("python")
    exec(compile(python, "fit-parameters.md", "exec"), {})
    assert capsys.readouterr().out.splitlines() == doc_pages.printed(python)
