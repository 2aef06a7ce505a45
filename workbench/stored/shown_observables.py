"""Which observables a figure shows: those that are asked for, else those that vary, as many as have room."""

from collections.abc import Sequence

from solver.problem.errors import InputError, choices

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
