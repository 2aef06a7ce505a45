"""Each example of the gallery runs, and what it asserts holds. The site runs all of them too, when it is built."""

import ast
import runpy
from importlib import import_module
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
SCRIPTS = sorted(EXAMPLES.glob("*.py"))
QUICK = ("dna_on_a_histone", "drill_pipe", "every_equilibrium")  # the others draw large pictures
slow = pytest.mark.slow
each = pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)


def test_there_are_ten_examples() -> None:
    assert len(SCRIPTS) == 10


@pytest.mark.parametrize(
    "script", [pytest.param(one, id=one.stem, marks=() if one.stem in QUICK else (slow,)) for one in SCRIPTS]
)
def test_an_example_runs_and_writes_its_picture(script: Path, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    assert [path for path in tmp_path.glob(f"{script.stem}.*") if path.stat().st_size > 5000]


@each
def test_an_example_is_short_asserts_its_result_and_imports_names_that_exist(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    assert len(text.splitlines()) < 50
    assert "assert" in text
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom):
            assert node.module
            for alias in node.names:
                found = import_module(node.module)
                assert hasattr(found, alias.name) or import_module(f"{node.module}.{alias.name}")
