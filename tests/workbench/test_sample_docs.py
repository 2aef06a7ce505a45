"""docs/how-to/sample-a-study.md: its studies, its table, its commands and its Python run as they stand."""

import re
import shlex
from pathlib import Path

import pytest

from studies.loader import load, loads
from tests.workbench import doc_pages, small
from tests.workbench.pictures import pixels, share_of_ink
from workbench import cli

PAGE = doc_pages.read(Path(__file__).parents[2] / "docs" / "how-to" / "sample-a-study.md")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def test_the_first_study_of_the_page_is_the_shipped_one() -> None:
    assert loads(blocks("toml")[0], default_name="samples_pipe").model_dump() == load("samples_pipe").model_dump()


def test_the_lists_of_the_page_are_a_study() -> None:
    assert small.study(blocks("toml")[1]).size == 3


def test_the_commands_and_the_python_of_the_page_run_as_they_stand(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    (table,) = blocks("csv")
    Path("cases.csv").write_text(table, encoding="utf-8")
    Path("measured.toml").write_text(blocks("toml")[2], encoding="utf-8")
    for line in "".join(blocks("sh")).splitlines():
        with pytest.raises(SystemExit) as end:
            cli.main(shlex.split(line.removeprefix("workbench ")))
        assert not end.value.code, line
    shown = capsys.readouterr().out
    for part in ("256 cases, 0 unsolved", "256 samples of E, R, F1: scrambled Sobol' sequence", "3 samples of E,"):
        assert part in shown
    assert 0.02 < share_of_ink(pixels(Path("samples_pipe.png"))) < 0.6
    (python,) = blocks("python")
    exec(compile(python, "sample-a-study.md", "exec"), {})
    assert capsys.readouterr().out.splitlines() == doc_pages.printed(python)
