"""Which rows of a table of tests run by default."""

from collections.abc import Iterable
from typing import Any

import pytest


def slow(*row: Any) -> Any:
    """A row that runs with -m slow only."""
    return pytest.param(*row, marks=pytest.mark.slow)


def slow_but(rows: Iterable[Any], *quick: Any) -> list[Any]:
    """The rows as parameters of a test: all but the quick ones run with -m slow only."""
    known = list(rows)
    assert set(quick) <= set(known), f"no rows {set(quick) - set(known)}"
    return [row if row in quick else pytest.param(row, marks=pytest.mark.slow, id=str(row)) for row in known]
