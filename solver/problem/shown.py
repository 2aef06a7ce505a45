"""The table by which a notebook shows a value of the solver; the workbench makes it, where it is installed."""

from importlib import import_module
from typing import Any

TABLES = "workbench.notebook_tables"  # loaded by name: the solver works without the workbench


def table_of(kind: str, value: Any) -> str | None:
    """HTML of a "case", a "solution" or "equilibria"; None, which shows the `repr`, without the workbench."""
    try:
        tables = import_module(TABLES)
    except ImportError:
        return None
    return str(getattr(tables, f"of_{kind}")(value))
