"""What many tests of the workbench begin with."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import xarray as xr

from solver.problem.errors import InputError
from studies import load
from tests.workbench import live, small
from tests.workbench.command import exit_status
from workbench.run import atomic
from workbench.stored import file_kinds, reading


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


@pytest.fixture(autouse=True)
def every_file_that_is_written_is_read(monkeypatch) -> Iterator[None]:
    """Whatever the writer writes the reader reads: each file of results and each study, as soon as it has its name."""
    refused: list[str] = []
    move = atomic.move

    def move_and_read(aside: Path, path: Path) -> None:
        move(aside, path)
        try:
            if path.suffix == ".h5":
                reading.read(path, study=reading.kind_of_file(path) is file_kinds.STUDY)
            elif path.suffix == ".toml":
                load(path)
        except InputError as error:
            refused.append(str(error))

    monkeypatch.setattr(atomic, "move", move_and_read)
    yield
    assert refused == []
