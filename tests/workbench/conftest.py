"""What many tests of the workbench begin with."""

from collections.abc import Callable, Iterator

import pytest
import xarray as xr

from tests.workbench import live, small
from tests.workbench.command import exit_status


@pytest.fixture
def six() -> xr.Dataset:
    """The six cases of `small.grid`, solved once; what a test changes in them is changed for it alone."""
    return small.six()


@pytest.fixture
def call(capsys) -> Callable[..., tuple[int, str, str]]:
    """Runs a command: its exit status, and what it writes on stdout and on stderr."""
    return lambda *words: (exit_status(*words), *capsys.readouterr())


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """The port of a live page."""
    with live.served() as port:
        yield port
