"""docs/how-to/analyse-stored-studies.md: its studies, commands and Python run as they stand."""

import re
import shlex
from pathlib import Path

import pytest

from tests.workbench import doc_pages
from workbench import cli

DOCS = doc_pages.read(Path(__file__).parents[2] / "docs" / "how-to" / "analyse-stored-studies.md")
STATUS = {"run stiff.toml": 1}  # as the page says


def blocks(language: str) -> list[str]:
    found = re.findall(rf"```{language}\n(.*?)```", DOCS, re.DOTALL)
    assert found, f"no {language} in the page"
    return found


def test_the_page_runs_as_it_stands(tmp_path, monkeypatch, capsys) -> None:
    pytest.importorskip("dask")
    monkeypatch.chdir(tmp_path)
    (soft,) = blocks("toml")
    Path("soft.toml").write_text(soft, encoding="utf-8")
    stiff = (
        soft.replace("Soft", "Stiff").replace("5e3", "2.1e4").replace("to = 2e4\ncount = 16", "to = 4e4\ncount = 20")
    )
    Path("stiff.toml").write_text(stiff, encoding="utf-8")
    for line in blocks("sh")[0].splitlines():
        command = line.removeprefix("workbench ")
        with pytest.raises(SystemExit) as end:
            cli.main(shlex.split(command))
        assert end.value.code == STATUS.get(command, 0), command
    shown = capsys.readouterr().out
    method, condition = "method swing, tolerance 1e-08; ", "largest condition: 22.2169 at E = 9000, R = 0.5"
    for row in (method, condition, "kappa_max     2.61389   3.59075   5.11853  1/cm", "48 cases, 0 unsolved"):
        assert row in DOCS
        assert row in shown
    names: dict[str, object] = {}
    exec(compile(blocks("python")[0], "analyse-stored-studies.md", "exec"), names)
    assert names["one"]["u"].size == 201  # type: ignore[index]
