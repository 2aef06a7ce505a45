"""The folder beside an output in which a run keeps what it has: a lock, what it is a run of, and finished shards.

A shard that is there under its name is whole: it was written aside, put on the disk and renamed. So the folder is the
whole state of a run, and one that was killed goes on from it.
"""

import json
import os
import re
import shutil
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from solver.problem.errors import InputError

from .block_solver import Columns, Damaged, decode
from .plan import differences

FORMAT = 1  # of the folder and its shards
_SHARD = re.compile(r"(\d{12})-(\d{12})\.shard")
_LOCK, _MANIFEST = "lock", "manifest.json"


def folder_of(output: Path) -> Path:
    """``results/NAME.h5.parts`` of ``results/NAME.h5``."""
    return output.with_name(f"{output.name}.parts")


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the folder, made if need be, against a second run. The system lets go of it whatever ends this one.

    Raises `InputError` where another run holds it.
    """
    while True:
        try:
            folder.mkdir(exist_ok=True)
            file = (folder / _LOCK).open("a+", encoding="utf-8")
        except FileNotFoundError:
            if folder.parent.is_dir():
                continue  # another run has just ended and removed it
            raise
        with file:
            if not _take(file):
                file.seek(0)
                who = f" ({said})" if (said := file.read(200).strip()) else ""
                raise InputError(f"another run is at work on {folder.name.removesuffix('.parts')}{who}")
            if not _still_there(file, folder / _LOCK):
                continue
            file.truncate(0)
            file.write(f"process {os.getpid()} on {socket.gethostname()}")
            file.flush()
            yield
            return


def _take(file: IO[str]) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True


def _still_there(file: IO[str], path: Path) -> bool:
    """Whether the open file is the one of that name: a run that ends removes its lock."""
    with suppress(FileNotFoundError):
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    return False


def check_recipe(folder: Path, recipe: dict[str, Any]) -> None:
    """Write down what the shards are of, or raise `InputError` where those there are of something else."""
    path = folder / _MANIFEST
    if not path.exists():
        if _shards(folder):
            raise InputError(f"{folder} holds results of an unknown run; --restart drops them")
        put(path, json.dumps({"format": FORMAT, "recipe": recipe}, indent=1).encode())
        return
    try:
        was = json.loads(path.read_text(encoding="utf-8"))
        newer, before = int(was["format"]) > FORMAT, dict(was["recipe"])
    except (ValueError, KeyError, TypeError):
        raise InputError(f"{path} is damaged; --restart drops what {folder.name} holds") from None
    if newer:
        raise InputError(f"{folder} is of format {was['format']}, but this version reads up to format {FORMAT}")
    if told := differences(before, json.loads(json.dumps(recipe))):
        raise InputError(f"{folder} holds part of another run: {'; '.join(told)}; --restart drops it")


def is_left_over(folder: Path, recipe: dict[str, Any]) -> bool:
    """Whether the folder is of a run of that recipe, which was killed when it had ended and was tidying up."""
    try:
        was = json.loads((folder / _MANIFEST).read_text(encoding="utf-8"))["recipe"]
        return not differences({key: was[key] for key in was if key != "grows"}, json.loads(json.dumps(recipe)))
    except FileNotFoundError:
        return is_empty(folder)
    except (OSError, ValueError, KeyError, TypeError):
        return False


def put(path: Path, content: bytes) -> None:
    """A file written aside, put on the disk and renamed: whole or not there. Raises `OSError`."""
    aside = path.with_name(f".{path.name}")
    try:
        with aside.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(aside, path)
        flush(path.parent)
    except OSError:
        with suppress(OSError):
            aside.unlink(missing_ok=True)
        raise


def flush(path: Path) -> None:
    """Have the system put a file, or the names in a folder, on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def store_shard(folder: Path, start: int, stop: int, content: bytes) -> None:
    """Keep the packed results of cases `start` to `stop`. Raises `OSError`."""
    put(_name(folder, start, stop), content)


def read_shard(folder: Path, start: int, stop: int) -> Columns:
    """The results of cases `start` to `stop`; raises `Damaged`, and removes the shard, where it is not whole."""
    path = _name(folder, start, stop)
    try:
        found = decode(path.read_bytes())
        if found["outcome"].size != stop - start:
            raise Damaged
    except (Damaged, FileNotFoundError):
        path.unlink(missing_ok=True)
        raise Damaged from None
    return found


def stretches(folder: Path, cases: int) -> list[tuple[int, int]]:
    """The stretches of cases of which there are shards, in order; none overlaps the next."""
    found: list[tuple[int, int]] = []
    for start, stop in sorted(_shards(folder)):
        if (found[-1][1] if found else 0) <= start < stop <= cases:
            found.append((start, stop))
    return found


def is_empty(folder: Path) -> bool:
    """Whether there is no shard at all."""
    return not _shards(folder)


def missing(there: list[tuple[int, int]], cases: int) -> list[tuple[int, int]]:
    """The stretches of cases between those that are there."""
    ends = [0, *(stop for _, stop in there)]
    starts = [*(start for start, _ in there), cases]
    return [(a, b) for a, b in zip(ends, starts, strict=True) if a < b]


def clear(folder: Path, keep_lock: bool = False) -> None:
    """Remove what a run has kept; what is not a run's own stays, and the folder with it."""
    for path in [*(_name(folder, *ends) for ends in _shards(folder)), folder / _MANIFEST]:
        path.unlink(missing_ok=True)
    clear_asides(folder)
    if not keep_lock:
        (folder / _LOCK).unlink(missing_ok=True)
        with suppress(OSError):
            folder.rmdir()


def clear_asides(folder: Path) -> None:
    """Remove what a killed run was about to rename."""
    for path in [folder / f".{_MANIFEST}", *folder.glob(".*.shard")]:
        path.unlink(missing_ok=True)


def _shards(folder: Path) -> list[tuple[int, int]]:
    if not folder.is_dir():
        return []
    named = (_SHARD.fullmatch(path.name) for path in folder.iterdir())
    return [(int(name.group(1)), int(name.group(2))) for name in named if name]


def _name(folder: Path, start: int, stop: int) -> Path:
    return folder / f"{start:012d}-{stop:012d}.shard"


def reserve(path: Path, size: int) -> None:
    """Have the disk keep so much room for a file, so that HDF5 never meets a full one, which it does not survive.

    Raises `OSError` where there is none. Without `posix_fallocate` nothing is kept.
    """
    if hasattr(os, "posix_fallocate"):
        with path.open("ab") as file:
            os.posix_fallocate(file.fileno(), 0, size)


def free(folder: Path) -> int:
    """Bytes that may still be written there."""
    return shutil.disk_usage(folder).free
