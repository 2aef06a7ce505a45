"""The check of a file that a command is to write."""

from pathlib import Path

from solver.problem.errors import InputError, choices

from ..data import writing


def check(path: Path, suffixes: tuple[str, ...], force: bool) -> Path:
    """The path; raises `InputError` for another suffix, a folder, or without `force` an existing file."""
    if path.suffix.lower() not in suffixes:
        raise InputError(f"cannot write {path.name!r}: choose a name that ends in {choices(suffixes)}")
    if path.is_dir():
        raise InputError(f"{path} is a folder; give the name of a file")
    writing.check_parent(path)
    if path.exists() and not force:
        raise InputError(f"{path} exists; give --force to replace it")
    return path
