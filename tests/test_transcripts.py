"""Each stored session prints what it printed; `transcripts.py` says how one is stored anew."""

import difflib

import pytest

from tests import transcripts
from tests.workbench.node import needs_node

SESSIONS = sorted(transcripts.FOLDER.glob("*.txt"))
MARKS = {"kinds_slow": pytest.mark.slow, "page": needs_node}


@pytest.mark.parametrize(
    "path", [pytest.param(path, id=path.stem, marks=MARKS.get(path.stem, ())) for path in SESSIONS]
)
def test_a_session_prints_what_it_printed(path, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    stored = path.read_text(encoding="utf-8").splitlines()
    printed = transcripts.replayed("\n".join(stored) + "\n").splitlines()
    difference = "\n".join(difflib.unified_diff(stored, printed, "stored", "printed", lineterm="", n=0))
    assert not difference, f"{difference}\nif that is meant: python -m tests.transcripts {path.stem}"


@pytest.mark.parametrize(
    ("new", "same"),
    [("a  1.00001 3 2e-09", True), ("a 1.001 3 1e-09", False), ("a 1.0 4 1e-09", False), ("b 1.0 3 1e-09", False)],
)
def test_lines_are_the_same_but_for_last_digits(new, same) -> None:
    assert transcripts.is_same("a 1.0 3 1e-09", new) == same
