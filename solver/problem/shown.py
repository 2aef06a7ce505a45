"""What the workbench makes of a value of the solver: datasets, pictures, and tables of a notebook."""

from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

NOTEBOOK = "workbench.notebook"  # loaded by name: the solver works without the workbench


class Picture(Protocol):
    """A diagram or a scene: a notebook shows it inline."""

    def save(self, path: str | Path) -> Path:
        """Write the picture; the suffix chooses the format. Raises `InputError` for another name."""
        ...


def table_of(kind: str, value: Any) -> str | None:
    """HTML of a "case", a "solution" or "equilibria"; None, which shows the `repr`, without the workbench."""
    try:
        tables = import_module(NOTEBOOK)
    except ImportError:
        return None
    return str(getattr(tables, f"table_of_{kind}")(value))


def make(module: str, function: str, *values: Any) -> Any:
    """What a function of the workbench makes of the values.

    Raises `ModuleNotFoundError` with the command that installs what is missing.
    """
    try:
        return getattr(import_module(module), function)(*values)
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        raise ModuleNotFoundError(
            f"datasets and pictures of a solution need the package {package}, which is not installed; an installation "
            "of the solver alone does not have it: pip install rod-workbench, without --no-deps",
            name=error.name,
        ) from None
