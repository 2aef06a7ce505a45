"""The code of docs/how-to/work-in-a-notebook.md."""

import json
import re
from pathlib import Path

import pytest

from docs import notebook
from studies import load
from workbench.data import writing
from workbench.run import in_memory

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "work-in-a-notebook.md"


@pytest.mark.slow
def test_the_code_of_the_page_runs(tmp_path: Path, monkeypatch) -> None:
    writing.write(in_memory.run(load("fig7_1_modulus")), tmp_path / "modulus.h5")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL):
        exec(block, names)
    assert Path("rod.pdf").stat().st_size > 5000
    assert "default-src" in Path("rod.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_cells_of_the_tutorial_run(tmp_path: Path, monkeypatch) -> None:
    page = (PAGE.parents[1] / "tutorial" / "a-notebook.md").read_text(encoding="utf-8")
    cells = re.findall(r"```\{code-cell\} python\n(.*?)```", page, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for cell in cells:
        exec(cell, names)
    assert len(cells) == 8
    assert names["result"].verdicts == [("turns falls along E", "holds")]  # type: ignore[attr-defined]


def test_the_notebook_of_the_examples_is_the_tutorial() -> None:
    text = notebook.NOTEBOOK.read_text(encoding="utf-8")
    assert text == notebook.notebook(notebook.PAGE.read_text(encoding="utf-8"))  # else: python -m docs.notebook
    lines = [line for cell in json.loads(text)["cells"] for line in cell["source"]]
    links = re.findall(r"\]\(([^)#]+)\)", "".join(lines))
    assert links
    assert all((notebook.NOTEBOOK.parent / link).exists() for link in links)
