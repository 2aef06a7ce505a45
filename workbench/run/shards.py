"""Shards: the finished cases of a run, packed with a checksum, in a folder beside the output with a lock.

A shard that stands under its name is whole (`data.atomic`), so the folder is the whole state of a run, and a run that
was killed continues from it.
"""

import hashlib
import json
import os
import re
import shutil
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from solver.problem.errors import InputError

from ..data import atomic
from ..data.schema import Columns
from .recipe import differences

MOST = 10**12 - 1  # cases that the name of a shard can count
FORMAT = 1  # of the folder and its shards
_CHECKSUM = 32  # bytes
_SHARD = re.compile(r"(\d{12})-(\d{12})\.shard")
_LOCK, _MANIFEST = "lock", "manifest.json"


class Damaged(Exception):
    """A shard is not what was written: its checksum or its number of cases is wrong."""


def encode(found: Columns) -> bytes:
    """The columns as bytes: a checksum, then NumPy's archive, in which each different text stands once."""
    packed: Columns = {}
    for name, values in found.items():
        if values.dtype.kind == "U":
            packed[f"{name}:texts"], packed[f"{name}:which"] = np.unique(values, return_inverse=True)
        else:
            packed[name] = values
    body = BytesIO()
    np.savez(body, allow_pickle=False, **packed)
    content = body.getbuffer()
    return hashlib.blake2b(content, digest_size=_CHECKSUM).digest() + content


def decode(content: bytes) -> Columns:
    """The columns that `encode` packed; raises `Damaged` where a byte has changed. Nothing in it is executed."""
    body = memoryview(content)[_CHECKSUM:]
    if hashlib.blake2b(body, digest_size=_CHECKSUM).digest() != content[:_CHECKSUM]:
        raise Damaged
    with np.load(BytesIO(body), allow_pickle=False) as archive:
        packed = {name: archive[name] for name in archive.files}
    found: Columns = {}
    for name, values in packed.items():
        plain, _, part = name.partition(":")
        if not part:
            found[name] = values
        elif part == "texts":
            found[plain] = values[packed[f"{plain}:which"]]
    return found


def folder_of(output: Path) -> Path:
    """``results/NAME.h5.parts`` of ``results/NAME.h5``."""
    return output.with_name(f"{output.name}.parts")


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the folder, made if need be, against a second run; the lock ends with this process at the latest.

    Raises `InputError` where another run holds it.
    """
    from filelock import FileLock, Timeout

    path = folder / _LOCK
    lock = FileLock(path, timeout=0, fallback_to_soft=False)
    while True:
        try:
            folder.mkdir(exist_ok=True)
            lock.acquire()
            break
        except FileNotFoundError:  # another run has just ended and removed it
            if not folder.parent.is_dir():
                raise
        except Timeout:
            if (owner := _owner(path)) is not None:
                raise InputError(
                    f"another run is at work on {folder.name.removesuffix('.parts')} ({owner or 'unknown'})"
                ) from None
    try:
        with suppress(PermissionError):  # on Windows, where the content is locked too
            path.write_text(f"process {os.getpid()} on {socket.gethostname()}", encoding="utf-8")
        yield
    finally:
        lock.release()


def _owner(lock: Path) -> str | None:
    """Who holds the lock, as it says itself; None where the lock is gone."""
    try:
        return lock.read_text(encoding="utf-8")[:200].strip()
    except FileNotFoundError:
        return None
    except (OSError, ValueError):
        return ""


def check_recipe(folder: Path, recipe: dict[str, Any]) -> None:
    """Store the recipe of the shards, or raise `InputError` where existing shards have another recipe."""
    path = folder / _MANIFEST
    if not path.exists():
        if _shards(folder):
            raise InputError(f"{folder} holds results of an unknown run; use --restart to discard them")
        _put(path, json.dumps({"format": FORMAT, "recipe": recipe}, indent=1).encode())
        return
    try:
        was = json.loads(path.read_text(encoding="utf-8"))
        newer, before = int(was["format"]) > FORMAT, dict(was["recipe"])
    except (ValueError, KeyError, TypeError):
        raise InputError(f"{path} is damaged; use --restart to discard what {folder.name} holds") from None
    if newer:
        raise InputError(f"{folder} is of format {was['format']}, but this version reads up to format {FORMAT}")
    if told := differences(before, json.loads(json.dumps(recipe))):
        raise InputError(f"{folder} holds part of another run: {'; '.join(told)}; use --restart to discard it")


def is_left_over(folder: Path, recipe: dict[str, Any]) -> bool:
    """Whether the folder is left from a run of that recipe that was killed after its output was complete."""
    try:
        was = json.loads((folder / _MANIFEST).read_text(encoding="utf-8"))["recipe"]
        return not differences({key: was[key] for key in was if key != "grows"}, json.loads(json.dumps(recipe)))
    except FileNotFoundError:
        return is_empty(folder)
    except (OSError, ValueError, KeyError, TypeError):
        return False


def store_shard(folder: Path, start: int, stop: int, content: bytes) -> None:
    """Store the packed results of cases `start` to `stop`. Raises `OSError`."""
    _put(_name(folder, start, stop), content)


def read_shard(folder: Path, start: int, stop: int) -> Columns:
    """The results of cases `start` to `stop`; a damaged shard is removed and raises `Damaged`."""
    path = _name(folder, start, stop)
    try:
        found = decode(path.read_bytes())
        if found["outcome"].size != stop - start:
            raise Damaged
    except (Damaged, FileNotFoundError):
        path.unlink(missing_ok=True)
        raise Damaged from None
    return found


def read_cases(folder: Path, start: int, stop: int) -> Columns:
    """The results of the cases `start` to `stop`, all of which have shards. Raises `Damaged`."""
    pieces = []
    for a, b in stored_ranges(folder, MOST):
        if a < stop and b > start:
            found = read_shard(folder, a, b)
            pieces.append({name: values[max(start - a, 0) : stop - a] for name, values in found.items()})
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}


def stored_ranges(folder: Path, cases: int) -> list[tuple[int, int]]:
    """The ranges of cases that have shards, in order, without overlaps."""
    found: list[tuple[int, int]] = []
    for start, stop in sorted(_shards(folder)):
        if (found[-1][1] if found else 0) <= start < stop <= cases:
            found.append((start, stop))
    return found


def is_empty(folder: Path) -> bool:
    """Whether the folder has no shard."""
    return not _shards(folder)


def missing_ranges(stored: list[tuple[int, int]], cases: int) -> list[tuple[int, int]]:
    """The ranges of cases between those that have shards."""
    ends = [0, *(stop for _, stop in stored)]
    starts = [*(start for start, _ in stored), cases]
    return [(a, b) for a, b in zip(ends, starts, strict=True) if a < b]


def clear(folder: Path, keep_lock: bool = False) -> None:
    """Remove what a run has stored; other files stay, and the folder with them."""
    for path in [*(_name(folder, *ends) for ends in _shards(folder)), folder / _MANIFEST]:
        path.unlink(missing_ok=True)
    clear_asides(folder)
    if not keep_lock:
        (folder / _LOCK).unlink(missing_ok=True)
        with suppress(OSError):
            folder.rmdir()


def clear_asides(folder: Path) -> None:
    """Remove unfinished files of a killed run."""
    for path in [*folder.glob(".*.part.shard"), *folder.glob(".*.part.json")]:
        path.unlink(missing_ok=True)


def _shards(folder: Path) -> list[tuple[int, int]]:
    if not folder.is_dir():
        return []
    named = (_SHARD.fullmatch(path.name) for path in folder.iterdir())
    return [(int(name.group(1)), int(name.group(2))) for name in named if name]


def _put(path: Path, content: bytes) -> None:
    with atomic.replacing(path) as aside:
        aside.write_bytes(content)


def _name(folder: Path, start: int, stop: int) -> Path:
    return folder / f"{start:012d}-{stop:012d}.shard"


def reserve(path: Path, size: int) -> None:
    """Reserve disk space for a file, as HDF5 does not survive a full disk.

    Raises `OSError` where there is too little. Without `posix_fallocate` nothing is reserved.
    """
    if hasattr(os, "posix_fallocate"):
        with path.open("ab") as file:
            os.posix_fallocate(file.fileno(), 0, size)


def free(folder: Path) -> int:
    """Free bytes on the disk of the folder."""
    return shutil.disk_usage(folder).free
