"""Files that are whole or absent: written beside their place, put on the disk, and renamed."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from solver.problem.errors import InputError, choices

PARTS = ".parts"  # ends the name of the folder in which a run keeps finished cases
STORED = (".h5", ".hdf5", ".nc")  # what the names of stored studies end in


class Undone(InputError):
    """What is asked for validly, and cannot be made of this rod or on this machine: a command has exit status 1."""


_COMPLETED: ContextVar[list[Path] | None] = ContextVar("completed", default=None)


@contextmanager
def record_files() -> Iterator[list[Path]]:
    """Yield a list, to which each file is added that the body completes, but the parts of a run."""
    files: list[Path] = []
    token = _COMPLETED.set(files)
    try:
        yield files
    finally:
        _COMPLETED.reset(token)


@contextmanager
def replacement(path: Path) -> Iterator[Path]:
    """Yield a path beside `path`, of the same suffix; what was written there takes the place of `path` at the end.

    Where the body raises, `path` stays as it was and the other file is removed. Raises `OSError`, and `InputError` for
    what `check_name` refuses.
    """
    check_name(path)
    aside = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        yield aside
        move(aside, path)
    finally:
        with suppress(OSError):
            aside.unlink(missing_ok=True)


def check_name(path: str | Path, suffixes: tuple[str, ...] = ()) -> Path:
    """The path of an output; raises `InputError` unless its name ends in one of the suffixes, if there are any.

    Also for what would be replaced unseen: a folder, a link to a file that is missing or to itself, a device or a pipe.
    """
    path, ends = Path(path), f" that ends in {choices(suffixes)}" if suffixes else ""
    if path.is_symlink() and not path.exists():
        raise InputError(f"cannot write {path}: it is a link to {os.readlink(path)}, which leads to no file")
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file{ends}")
    if path.exists() and not path.is_file():
        raise InputError(f"cannot write {path}: it is not a regular file; give the name of a file{ends}")
    if suffixes and path.suffix.lower() not in suffixes:
        raise InputError(f"cannot write {path.name!r}: choose a name{ends}")
    return path


@contextmanager
def refusing(path: Path, more: Callable[[], str] = str) -> Iterator[None]:
    """An `OSError` of the body becomes an `InputError` of one sentence that names the path; more: what it adds then."""
    try:
        yield
    except OSError as error:
        why, added = error.strerror or str(error).partition(",")[0], more()
        raise InputError(f"cannot write {path}: {why}{added and f'; {added}'}") from None


def move(aside: Path, path: Path) -> None:
    """Give a complete file its final name, once its content is on the disk. Raises `OSError`."""
    flush(aside)
    os.replace(aside, path)
    files = _COMPLETED.get()
    if files is not None and path.parent.suffix != PARTS:
        files.append(path)
    flush(path.parent)


def flush(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk. Raises `OSError`.

    Windows opens no folder, and flushes no file that is open for reading only.
    """
    if path.is_dir() and sys.platform == "win32":
        return
    handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def reserve(path: Path, size: int) -> None:
    """Reserve disk space for a file, as HDF5 does not survive a full disk.

    Raises `OSError` where there is too little. Without `posix_fallocate` nothing is reserved.
    """
    if hasattr(os, "posix_fallocate"):
        with path.open("ab") as file:
            os.posix_fallocate(file.fileno(), 0, size)


def write(path: Path, work: Callable[[Path], object]) -> Path:
    """Have `work` write the file and return its path; raises `InputError` where the disk refuses."""
    with refusing(path), replacement(path) as aside:
        work(aside)
    return path


def write_text(path: Path, text: str, newline: str | None = None) -> Path:
    """Write a file of this text and return its path, as `write`; newline: as of `Path.write_text`."""
    return write(path, lambda aside: aside.write_text(text, encoding="utf-8", newline=newline))
