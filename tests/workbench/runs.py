"""Runs of the command line that are killed, held up or starved, and what their files hold."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from tests.workbench import forked
from workbench.run.run_and_resume import Meter

ROOT = Path(__file__).parents[2]
HEAD = """
title = "many"
reading = "force-first/tension/paper"
observables = ["bends", "kappa_max"]
outputs = ["beta"]
stations = 11
method = "{method}"

[units]
length = "cm"
force = "N"
"""

# What a process of a run executes before the command: lines of a test's own, then the command.
MAIN = """
{before}
import sys
from workbench import cli
if __name__ == "__main__":
    cli.main(sys.argv[1:])
"""


def study(
    folder: Path, axes: dict[str, list[float]], method: str = "orbit", name: str = "many", more: str = ""
) -> Path:
    """A study over these values of these axes, written there."""
    rows = "".join(f"[axes.{axis}]\nvalues = {list(map(float, values))}\n" for axis, values in axes.items())
    path = folder / "many.toml"
    path.write_text(HEAD.format(method=method) + rows)
    return path


def grid(E: int, F1: int) -> dict[str, list[float]]:
    """So many moduli and normal forces."""
    return {"E": np.linspace(5e3, 4e4, E).tolist(), "F1": np.linspace(1, 9, F1).tolist()}


def start(folder: Path, *args: object, before: str = "", **more: bool) -> subprocess.Popen[str]:
    """`workbench run ...` in a new process, in that folder."""
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, str(_main(folder, before)), "run", *map(str, args)]
    return subprocess.Popen(command, cwd=folder, env=env, stdout=-1, stderr=-1, text=True, **more)


def run(folder: Path, *args: object, before: str = "", limit: float = 600) -> subprocess.CompletedProcess[str]:
    """The same in a forked process, to its end, or to so many seconds."""
    return command(folder, "run", *args, before=before, limit=limit)


def command(folder: Path, *args: object, before: str = "", limit: float = 600) -> subprocess.CompletedProcess[str]:
    """`workbench ...` in a forked process, in that folder."""
    return forked.run(_main(folder, before), *args, cwd=folder, timeout=limit)


def _main(folder: Path, before: str) -> Path:
    """The script that such a process runs; without lines of its own, that of the last one in the folder."""
    main = folder / "main.py"
    if before or not main.exists():
        main.write_text(MAIN.format(before=before))
    return main


def small_blocks(cases: int) -> Any:
    """A fixture: so many cases a block, fewer than by default; many blocks in no time."""

    @pytest.fixture(autouse=True, scope="module")
    def small_blocks() -> Iterator[None]:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("workbench.run.plan.BLOCK", cases)
            yield

    return small_blocks


def stop_after(cases: int) -> Any:
    """The progress of a run that is interrupted once so many cases are solved."""

    class Stopping(Meter):
        def add(self, more: int, unsolved: int) -> None:
            super().add(more, unsolved)
            if self.done >= cases:
                raise KeyboardInterrupt

    return contextmanager(lambda total, done: (yield Stopping(total, done)))


def contents(path: Path) -> dict[str, Any]:
    """Each variable's bytes, kind, dimensions and packing, and every attribute but the moment the file was made.

    Nor its checksums, of which one is that moment's.
    """
    held: dict[str, Any] = {}

    def look(name: str, item: Any) -> None:
        for key, value in item.attrs.items():
            if not isinstance(value, h5py.Reference) and np.asarray(value).dtype.kind not in "OV":
                held[f"{name}@{key}"] = value if isinstance(value, str) else np.asarray(value).tobytes()
        if isinstance(item, h5py.Dataset):
            text = h5py.check_string_dtype(item.dtype)
            held[name] = item.asstr()[...].tolist() if text else item[...].tobytes()
            held[f"{name}#"] = item.dtype, item.shape, item.chunks, item.compression, item.shuffle
            held[f"{name}'s dimensions"] = [scale.name for dim in item.dims for scale in dim.values()]

    with h5py.File(path) as file:
        look("", file)
        file.visititems(look)
    del held["@created"]
    held.pop("@checksums", None)
    return held
