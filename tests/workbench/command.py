"""Commands in the process of the test."""

import shlex

import pytest

from workbench import cli


def exit_status(*words: object) -> int:
    """The exit status of a command."""
    with pytest.raises(SystemExit) as end:
        cli.main([str(word) for word in words])
    return int(end.value.code or 0)


def run(line: str, status: int = 0) -> None:
    """A command as one types it, and the status with which it must end."""
    assert exit_status(*shlex.split(line.removeprefix("workbench "))) == status, line
