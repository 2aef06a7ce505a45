"""docs/how-to/write-a-law.md: its study and commands run as they stand, and print what the page says."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from rich.console import Console

from studies.law_kinds import KINDS
from studies.loader import loads
from tests.workbench import doc_pages
from workbench import cli
from workbench.commands import console

DOCS = Path(__file__).parents[2] / "docs"
PAGE = doc_pages.read(DOCS / "how-to" / "write-a-law.md")
REFERENCE = doc_pages.read(DOCS / "reference" / "study-file.md")


def test_the_page_runs_as_it_stands(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(console, "out", lambda: Console(width=80))
    (study,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    Path("pipe.toml").write_text(study, encoding="utf-8")
    (commands,) = re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)
    for line in commands.splitlines():
        with pytest.raises(SystemExit) as end:
            cli.main(shlex.split(line.removeprefix("workbench ")))
        assert end.value.code == 0, line
    shown = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    (printed,) = re.findall(r"```\n(verdict .*?)```", PAGE, re.DOTALL)
    for line in printed.splitlines():
        assert " ".join(line.split()) in shown
    picture, stored = imread("laws.png"), imread(DOCS / "figures" / "laws.png")
    assert picture.shape == stored.shape
    assert np.abs(picture[..., :3] - stored[..., :3]).mean() < 0.01  # fonts may differ by a pixel


def test_the_page_and_the_reference_name_every_kind_and_every_key_of_a_law() -> None:
    for kind, row in KINDS.items():
        assert f"| `{kind}`" in PAGE
        for key in row.all_keys:
            assert f"`{key}`" in REFERENCE
    assert {law.kind for law in loads(re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0]).laws} == set(KINDS) - {
        "monotone"
    }


def test_the_expressions_of_the_reference_are_valid() -> None:
    study = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)[0].split("[expressions]")[0]
    (example,) = re.findall(r"```toml\n(\[expressions\].*?)```", REFERENCE, re.DOTALL)
    assert loads(study + example).expressions.keys() == {"lift", "mitchell", "push_share"}
