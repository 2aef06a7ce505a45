"""Commands in the process of the test, and Python in one of its own."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

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


def output_of(code: str, **env: str) -> list[str]:
    """The words that Python prints in a process that has imported nothing before."""
    command, folder = [sys.executable, "-c", f"import sys; {code}"], Path(__file__).parents[2]
    here = {**os.environ, **env}
    return subprocess.run(command, cwd=folder, env=here, capture_output=True, text=True, check=True).stdout.split()
