"""Shards: the finished cases of a run, packed with a checksum, in a folder beside the output with a lock.

A shard that stands under its name is whole (`run.atomic`), so the folder is the whole state of a run, and a run that
was killed continues from it. The checksum covers the recipe of the run, whose digest stands behind it, and the range of
cases beside the columns: a shard under the name of another one counts as damaged, and a whole one of another run, which
may be the only copy, is refused.
"""

import hashlib
import json
import os
import re
import shutil
import socket
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from solver.problem.errors import InputError

from ..stored.boxes import Columns
from . import atomic
from .recipe import differences

MOST = 10**12 - 1  # cases that the name of a shard can count
FORMAT = 4  # of the folder and its shards
_CHECKSUM = 32  # bytes
_SHARD = re.compile(r"(\d{12})-(\d{12})\.shard")
_LOCK, _OWNER, _MANIFEST = "lock", "owner", "manifest.json"
PATIENCE = 1.0  # seconds in which a run that holds the lock is expected to say who it is
_FOREIGN = ".not-a-shard"  # suffix of a folder that stands where a shard belongs


class Damaged(Exception):
    """A shard is not what was written: its checksum is wrong, or it is gone."""


def encode(columns: Columns) -> bytes:
    """The columns as bytes: NumPy's archive, in which each different text stands once."""
    packed: Columns = {}
    for name, values in columns.items():
        if values.dtype.kind == "U":
            each = values.tolist()
            places = {text: place for place, text in enumerate(dict.fromkeys(each))}
            packed[f"{name}:texts"] = np.array([*places], values.dtype)
            packed[f"{name}:which"] = np.array([places[text] for text in each], dtype=int)
        else:
            packed[name] = values
    body = BytesIO()
    np.savez(body, allow_pickle=False, **packed)
    return body.getvalue()


def decode(content: bytes | memoryview) -> Columns:
    """The columns that `encode` packed. Nothing in it is executed."""
    with np.load(BytesIO(content), allow_pickle=False) as archive:
        packed = {name: archive[name] for name in archive.files}
    columns: Columns = {}
    for name, values in packed.items():
        plain, _, part = name.partition(":")
        if not part:
            columns[name] = values
        elif part == "texts":
            columns[plain] = values[packed[f"{plain}:which"]]
    return columns


def join(parts: Sequence[Columns]) -> Columns:
    """Columns concatenated."""
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def folder_of(output: Path) -> Path:
    """``results/NAME.h5.parts`` of ``results/NAME.h5``."""
    return output.with_name(f"{output.name}{atomic.PARTS}")


@contextmanager
def lock(folder: Path) -> Iterator[None]:
    """Hold the folder, made if need be, against a second run; the lock ends with this process at the latest.

    Raises `InputError` where another run holds it.
    """
    from filelock import FileLock, Timeout

    lock = FileLock(folder / _LOCK, timeout=0, fallback_to_soft=False)
    tried_until = time.monotonic() + PATIENCE
    while True:
        try:
            folder.mkdir(exist_ok=True)
            lock.acquire()
            break
        except FileExistsError:
            raise InputError(
                f"{folder} is no folder, and a run keeps its finished cases in one of that name: rename or remove it"
            ) from None
        except FileNotFoundError:  # another run has just ended and removed it
            if not folder.parent.is_dir():
                raise
        except Timeout:
            if (owner := _owner(folder)) or time.monotonic() > tried_until:
                name = folder.name.removesuffix(".parts")
                raise InputError(f"another run is at work on {name} ({owner or 'an unknown process'})") from None
            time.sleep(0.01)  # it has just begun, or just ended
    since = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M:%S")
    owner = f"process {os.getpid()} on {socket.gethostname()}, since {since}"
    try:  # a file of its own, as a second run that tries the lock empties that
        (folder / _OWNER).write_text(owner, encoding="utf-8")
        yield
    finally:
        if is_empty(folder):
            clear(folder)  # there is nothing that a later run could use
        if _owner(folder) == owner:  # not that of a run that has begun since `clear` removed the lock
            (folder / _OWNER).unlink(missing_ok=True)
        lock.release()


def _owner(folder: Path) -> str:
    """Who holds the lock, as it says itself; empty where it is not known."""
    try:
        return (folder / _OWNER).read_text(encoding="utf-8")[:200].strip()
    except (OSError, ValueError):
        return ""


def check_recipe(folder: Path, recipe: dict[str, Any]) -> bytes:
    """Store the recipe of the shards and return its digest, which they hold.

    Raises `InputError` where existing shards have another recipe.
    """
    path = folder / _MANIFEST
    if not path.exists():
        if _shards(folder):
            raise InputError(f"{folder} holds results of an unknown run; use --restart to discard them")
        _write(path, json.dumps({"format": FORMAT, "recipe": recipe}, indent=1).encode())
        return _digest(recipe)
    try:
        was = json.loads(path.read_text(encoding="utf-8"))
        version, before = int(was["format"]), dict(was["recipe"])
    except (ValueError, KeyError, TypeError):
        raise InputError(f"{path} is damaged; use --restart to discard what {folder.name} holds") from None
    if version != FORMAT:
        advice = "; use --restart to discard it" if version < FORMAT else ""
        raise InputError(f"{folder} is of format {version}, but this version reads format {FORMAT}{advice}")
    if changed := differences(before, recipe):
        raise InputError(f"{folder} holds part of another run: {'; '.join(changed)}; use --restart to discard it")
    return _digest(recipe)


def _digest(recipe: dict[str, Any]) -> bytes:
    return hashlib.blake2b(json.dumps(recipe, sort_keys=True).encode(), digest_size=_CHECKSUM).digest()


def is_left_over(folder: Path, recipe: dict[str, Any]) -> bool:
    """Whether the folder is left from a run of that recipe that was killed after its output was complete."""
    try:
        was = json.loads((folder / _MANIFEST).read_text(encoding="utf-8"))["recipe"]
        Shards(folder, _digest(was)).check()
        return not differences({key: was[key] for key in was if key != "grows"}, recipe)
    except FileNotFoundError:
        return is_empty(folder)
    except (OSError, ValueError, KeyError, TypeError):
        return False


def begin(folder: Path, recipe: dict[str, Any], restart: bool) -> "Shards":
    """The shards of a run of that recipe, those that an earlier run has kept among them; restart: without these.

    Raises `InputError` where those kept are of another run.
    """
    if restart:
        clear(folder, keep_lock=True)
    clear_asides(folder)
    parts = Shards(folder, check_recipe(folder, recipe))
    parts.check()
    return parts


@dataclass(eq=False)
class Shards:
    """The shards of one run, of which one is held at a time. recipe: its digest (`check_recipe`)."""

    folder: Path
    recipe: bytes
    _held: tuple[tuple[int, int], Columns] = ((0, 0), {})

    def store(self, start: int, stop: int, content: bytes) -> None:
        """Store the packed results of cases `start` to `stop`. Raises `OSError`."""
        content = self.recipe + content
        _write(_name(self.folder, start, stop), _checksum(start, stop, content) + content)

    def check(self) -> None:
        """Raise `InputError` for a shard that is whole, but of another run."""
        for start, stop in sorted(_shards(self.folder)):
            recipe, _ = _whole(path := _name(self.folder, start, stop), start, stop)
            if recipe not in (self.recipe, b""):
                raise InputError(
                    f"{path} is of another run than {_MANIFEST} beside it: move it elsewhere, or use --restart to "
                    f"discard all that {self.folder.name} holds"
                )

    def read(self, start: int, stop: int) -> Columns:
        """The results of cases `start` to `stop`; a damaged shard is removed and raises `Damaged`."""
        path = _name(self.folder, start, stop)
        recipe, content = _whole(path, start, stop)
        if recipe == self.recipe:
            return decode(content)
        if path.is_dir() and not path.is_symlink():
            path.rename(path.with_name(f"{path.name}{_FOREIGN}"))  # not ours, so it stays
        path.unlink(missing_ok=True)
        raise Damaged

    def read_cases(self, start: int, stop: int) -> Columns:
        """The results of the cases `start` to `stop`, from several shards. Raises `Damaged`, also where one is gone."""
        pieces, cases = [], 0
        for ends in shard_ranges(self.folder, MOST):
            first, last = max(start, ends[0]), min(stop, ends[1])
            if first < last:
                if ends != self._held[0]:
                    self._held = ends, self.read(*ends)
                mine = slice(first - ends[0], last - ends[0])
                pieces.append({name: values[mine] for name, values in self._held[1].items()})
                cases += last - first
        if cases < stop - start:
            raise Damaged
        return join(pieces)


def _whole(path: Path, start: int, stop: int) -> tuple[bytes, bytes | memoryview]:
    """The digest of the recipe of a shard, and its packed columns; both empty where it is damaged, or is none."""
    try:
        whole = memoryview(path.read_bytes())
    except (FileNotFoundError, IsADirectoryError):
        return b"", b""
    checksum, content = whole[:_CHECKSUM], whole[_CHECKSUM:]
    sound = checksum == _checksum(start, stop, content)
    return (bytes(content[:_CHECKSUM]), content[_CHECKSUM:]) if sound else (b"", b"")


def _checksum(start: int, stop: int, content: bytes | memoryview) -> bytes:
    """Of the recipe with the columns, and of the range of cases: a shard of another place has another one."""
    summed = hashlib.blake2b(f"{start} {stop} ".encode(), digest_size=_CHECKSUM)
    summed.update(content)
    return summed.digest()


def shard_ranges(folder: Path, cases: int) -> list[tuple[int, int]]:
    """The ranges of cases that have shards, in order, without overlaps."""
    ranges: list[tuple[int, int]] = []
    for start, stop in sorted(_shards(folder)):
        if (ranges[-1][1] if ranges else 0) <= start < stop <= cases:
            ranges.append((start, stop))
    return ranges


def is_empty(folder: Path) -> bool:
    """Whether the folder has no shard."""
    return not _shards(folder)


def gaps_between(stored: list[tuple[int, int]], start: int, stop: int) -> list[tuple[int, int]]:
    """The ranges of the cases `start` to `stop` between those that have shards."""
    ends = [start, *(max(start, after) for _, after in stored)]
    starts = [*(min(first, stop) for first, _ in stored), stop]
    return [(a, b) for a, b in zip(ends, starts, strict=True) if a < b]


def clear(folder: Path, keep_lock: bool = False) -> None:
    """Remove what a run has stored; other files stay, and the folder with them."""
    for path in [*(_name(folder, *ends) for ends in _shards(folder)), folder / _MANIFEST]:
        path.unlink(missing_ok=True)
    clear_asides(folder)
    if not keep_lock:
        (folder / _OWNER).unlink(missing_ok=True)
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


def _write(path: Path, content: bytes) -> None:
    with atomic.replacement(path) as aside:
        aside.write_bytes(content)


def _name(folder: Path, start: int, stop: int) -> Path:
    return folder / f"{start:012d}-{stop:012d}.shard"


def free(folder: Path) -> int:
    """Free bytes on the disk of the folder."""
    return shutil.disk_usage(folder).free
