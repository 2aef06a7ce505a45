"""Which observables a figure shows: those that are asked for, else those that vary; what it says of the others."""

import re
from collections.abc import Sequence

from solver.problem.errors import InputError, choices

from ..words import labels
from .selection import known_cases
from .stored_study import StoredStudy

MOST_ASKED = 12  # observables of one figure


def choose_observables(
    stored: StoredStudy,
    show: Sequence[str],
    most: int,
    most_level: int | None = None,
    most_asked: int | None = MOST_ASKED,
) -> tuple[list[str], list[str]]:
    """The observables of a study that a figure shows, and those that have no room.

    Parameters
    ----------
    stored, show
        The study, and the observables that are asked for, which are all shown.
    most, most_level
        How many have room where none is asked for; how many of those are candidates if none varies, default: all.
    most_asked
        How many can be asked for; None: any number.

    Raises
    ------
    InputError
        For an observable that is not stored, and for more than can be asked for.
    """
    if show:
        names = stored.names_of(show)
        if most_asked is not None and len(names) > most_asked:
            raise InputError(f"a figure shows at most {most_asked} observables, got {len(names)}: {choices(names)}")
        return names, []
    known = stored.observables
    names = [name for name in known if not stored.is_level(name)] or known[:most_level]
    return names[:most], names[most:]


def level_notes(stored: StoredStudy, names: Sequence[str]) -> list[str]:
    """A sentence about each observable that is the same in all cases, or in all that have a number."""
    is_true_or_false = re.compile(r"[<>]|==|!=|\b(and|or|not)\b")  # an expression
    texts = []
    for array, ends in ((stored[name], stored.level(name)) for name in names if stored.is_level(name)):
        noun, holds, where = labels.long_name(array), bool(round(sum(ends) / 2)), known_cases(array)
        if flag := re.fullmatch("1 where (.*), else 0", noun):
            none = "no case" if where.startswith("all") else f"none of {where}"
            said = f"{flag[1]} in {where if holds else none}."
        elif is_true_or_false.search(str(array.attrs.get("expression", ""))):
            said = f"{noun}: {'true' if holds else 'false'} in {where}."
        else:
            said = f"{noun}: {labels.level(array, *ends)} in {where}."
        texts.append(said[0].upper() + said[1:])
    return texts
