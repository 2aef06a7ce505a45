"""The option --at: which stored value of an axis a text such as ``E=10905`` or ``beta=30deg`` means."""

import xarray as xr

from solver.problem.errors import InputError

from ..data import selection


def values(ds: xr.Dataset, at: list[str]) -> dict[str, float]:
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
