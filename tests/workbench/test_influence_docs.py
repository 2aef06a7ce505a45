"""docs/how-to/find-what-matters.md: its study, its commands and its Python run as they stand."""

import re
import shlex
from pathlib import Path

import pytest
from rich.console import Console

from tests.workbench import doc_pages
from tests.workbench.pictures import pixels
from workbench import cli
from workbench.commands import console

DOCS = Path(__file__).parents[2] / "docs"
PAGE = doc_pages.read(DOCS / "how-to" / "find-what-matters.md")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def run(line: str) -> None:
    with pytest.raises(SystemExit) as end:
        cli.main(shlex.split(line.removeprefix("workbench ")))
    assert not end.value.code, line


def same_shape(picture: str) -> None:
    shown, made = pixels(DOCS / "figures" / picture), pixels(Path(picture))
    assert shown.shape[1] / shown.shape[0] == pytest.approx(made.shape[1] / made.shape[0], rel=0.01)


def test_the_table_of_one_case_is_the_one_of_the_page(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(console, "out", lambda: Console(width=80))
    run(blocks("sh")[0].strip())
    printed = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    for line in blocks("text")[0].splitlines():
        assert line.rstrip() in printed
    same_shape("tornado.png")


@pytest.mark.slow
def test_the_study_and_the_python_of_the_page_run_as_they_stand(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    (study,) = blocks("toml")
    Path("matters.toml").write_text(study, encoding="utf-8")
    for line in blocks("sh")[1].splitlines():
        run(line)
    shown = capsys.readouterr().out
    for part in ("3072 cases, 0 unsolved", "height       R      0.021 ± 0.078   0.448 ± 0.052"):
        assert part in shown
    same_shape("sobol_indices.png")
    python = "".join(blocks("python"))
    exec(compile(python, "find-what-matters.md", "exec"), {})
    assert capsys.readouterr().out.splitlines() == doc_pages.printed(python)
