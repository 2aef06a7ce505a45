"""The sheet of a picture that a command draws beside its table, and the check of the options that describe it."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..figures.sheet import Sheet


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
