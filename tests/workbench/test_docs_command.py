"""The command docs opens the site that was built, or says in one sentence how to build it."""

import re
import subprocess
from pathlib import Path

import pytest

from tests.workbench.command import exit_status
from workbench.commands import docs


@pytest.mark.parametrize("has_sphinx", [True, False])
def test_without_a_site_one_line_is_the_command_that_builds_it(tmp_path: Path, monkeypatch, capsys, has_sphinx) -> None:
    """The line is run here with a pip and a builder of its own, from another folder."""
    root, python = tmp_path / "a checkout", tmp_path / "a python"
    (root / "docs").mkdir(parents=True)
    (root / "docs" / "build.py").touch()
    python.write_text(f"#!/bin/sh\necho $PWD $* >> '{tmp_path}/log'\n", encoding="utf-8")
    python.chmod(0o755)
    monkeypatch.setattr(docs, "PLACES", (tmp_path,))
    monkeypatch.setattr(docs, "ROOT", root)
    monkeypatch.setattr("sys.executable", str(python))
    monkeypatch.setattr(docs, "find_spec", lambda name: (name == "sphinx" and has_sphinx) or None)
    assert exit_status("docs") == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert len(told.err.splitlines()) == 1
    subprocess.run(["sh", "-c", told.err.partition("; run: ")[2]], check=True, cwd=tmp_path)
    install = f"{root} -m pip install -q -c constraints.txt -c docs/constraints.txt -e .[docs]\n"
    assert (tmp_path / "log").read_text(encoding="utf-8") == f"{install * (not has_sphinx)}{root} -m docs.build\n"
    for name in ("constraints.txt", "docs/constraints.txt", "docs/build.py"):
        assert (Path(docs.__file__).parents[2] / name).is_file()


def test_an_installation_without_a_site_names_no_command_that_it_cannot_run(
    tmp_path: Path, monkeypatch, capsys
) -> None:
    monkeypatch.setattr(docs, "PLACES", (tmp_path,))
    monkeypatch.setattr(docs, "ROOT", tmp_path)
    assert exit_status("docs") == 2
    assert "docs.build" not in capsys.readouterr().err


def test_the_first_site_that_is_there_is_opened_or_its_address_printed(tmp_path: Path, monkeypatch, capsys) -> None:
    page = tmp_path / "html" / "index.html"
    page.parent.mkdir()
    page.write_text("<html></html>", encoding="utf-8")
    monkeypatch.setattr(docs, "PLACES", (tmp_path / "missing", page.parent))
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    assert exit_status("docs", "--print") == 0
    assert capsys.readouterr().out == f"{page.as_uri()}\n"
    assert opened == []
    assert exit_status("docs") == 0
    assert opened == [page.as_uri()]
    assert capsys.readouterr().out == ""


def test_the_wheels_of_a_release_are_made_after_the_site_and_tried_with_it() -> None:
    """The hosted workflow puts the site where hatch_build.py looks for it, and the wheel that lacks it fails."""
    flow = (docs.ROOT / ".github" / "workflows" / "wheels.yml").read_text(encoding="utf-8")
    wheel = flow[flow.index("\n  wheel:") : flow.index("\n  sdist:")]
    assert "python -m docs.build" in flow[: flow.index("\n  wheel:")]
    assert "needs: site" in wheel
    assert wheel.index("path: build/docs/html") < wheel.index("cibuildwheel")
    assert "workbench docs --print" in wheel


def test_bibtex_is_on_one_command_and_agrees_with_the_file_of_citations(capsys) -> None:
    assert exit_status("docs", "--bibtex") == 0
    printed, cited = capsys.readouterr().out, (Path(__file__).parents[2] / "CITATION.cff").read_text(encoding="utf-8")
    entries = dict(re.findall(r"^  (\w+) += \{+(.*?)\}+,?$", printed, re.MULTILINE))  # of each key the last
    assert printed.count("@") == 2
    assert all(entries[key] in cited for key in ("title", "journal", "year", "volume", "doi"))
    assert all(re.search(rf"^{key}: .*{value}", cited, re.MULTILINE) for key, value in
               (("version", entries["version"]), ("date-released", docs.YEAR)))  # fmt: skip
