"""Options as checked values: the file that a command is to write, stored values of --at, the sheet of a picture."""

from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from solver.problem.errors import InputError, choices

from ..store import selection, writing

if TYPE_CHECKING:
    from ..figures.sheet import Sheet


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


def axis_values(ds: xr.Dataset, at: list[str]) -> dict[str, float]:
    """The stored value that each text means, by the name of its axis. Raises `InputError` where there is none."""
    found: dict[str, float] = {}
    for text in at:
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"--at takes NAME=VALUE, got {text!r}")
        try:
            name = selection.axis_of(ds, name)
            stored = float(ds[name].values[selection.index(ds, name, value)])
        except InputError as error:
            raise InputError(f"--at {text}: {error}") from None
        if name in found:
            raise InputError(f"--at {text}: {name} is given twice")
        found[name] = stored
    return found


def page(picture: Path | None, style: str, width: float | None, no_title: bool) -> "Sheet | None":
    """The sheet of the options; None where none of them is given.

    Raises `InputError` for an invalid option, and where there is no picture.
    """
    from solver.problem.errors import InputError

    from ..figures.sheet import SCREEN, sheet

    given = {"--style": style != SCREEN.style, "--width": width is not None, "--no-title": no_title}
    named = [name for name, is_given in given.items() if is_given]
    if not named:
        return None
    if picture is None:
        raise InputError(f"{named[0]} is an option of the picture: give also --plot FILE")
    return sheet(style, width, not no_title)
