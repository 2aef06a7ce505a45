"""Which observables a figure shows: those that are asked for, else those that vary, as many as have room."""

from collections.abc import Sequence

import xarray as xr

from solver.problem.errors import InputError, choices

from ..store import selection

MOST_ASKED = 12  # observables of one figure


def choose_observables(
    ds: xr.Dataset, show: Sequence[str], most: int, most_level: int | None = None, most_asked: int | None = MOST_ASKED
) -> tuple[list[str], list[str]]:
    """The observables of a study that a figure shows, and those that have no room.

    Parameters
    ----------
    ds, show
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
        names = selection.names_of(ds, show)
        if most_asked is not None and len(names) > most_asked:
            raise InputError(f"a figure shows at most {most_asked} observables, got {len(names)}: {choices(names)}")
        return names, []
    stored = selection.observables(ds)
    names = [name for name in stored if not selection.is_level(ds, name)] or stored[:most_level]
    return names[:most], names[most:]
