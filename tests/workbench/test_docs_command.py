"""The command docs opens the site that was built, or says in one sentence how to build it."""

import re
from pathlib import Path

from tests.workbench.command import exit_status
from workbench.commands import docs


def test_without_a_site_one_sentence_says_how_to_build_it(tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr(docs, "PLACES", (tmp_path,))
    assert exit_status("docs") == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert "python -m docs.build" in told.err
    assert len(told.err.splitlines()) == 1


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
