"""Problems of every kind have the answers that were stored on 23 November 2026; see tests/golden.py."""

from typing import Any

import pytest

from tests.golden import KINDS, differences, rows

SOME = {"shape": 12, "equilibria": 12, "follow": 24, "folds": 8, "loops": 8, "sensitivity": 10, "fit": 20}

FIRST = {"folds": 1}  # the others are three times as long


def sample(kind: str) -> list[Any]:
    """Every so many rows of a kind by default, the others with -m slow."""
    own = [i for i, row in enumerate(rows()) if row["kind"] == kind]
    quick = {i for k, i in enumerate(own) if k % SOME[kind] == FIRST.get(kind, 0)}
    return [pytest.param(i, id=rows()[i]["name"], marks=() if i in quick else pytest.mark.slow) for i in own]


@pytest.mark.parametrize("i", [param for kind in KINDS for param in sample(kind)])
def test_the_answer_is_the_stored_one(i: int) -> None:
    assert differences(rows()[i]) == []
