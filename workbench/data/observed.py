"""Which observables a dataset stores, and which of them a user means."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from solver.problem.errors import InputError, choices, near
from studies.laws import NOISE

from . import schema

NOT_OBSERVED = ("rho", "condition", "dbeta0", "level")  # numbers of each case, not observables
FOUND = ("FZ", "MZ", "M3", "beta0", "betaL")  # observables where they are found of held ends
_ROUNDING = 1e-9  # of the largest: a load that is 0 by symmetry differs by less
HELD_INDEX = "held_index"  # stored of held ends alone


def observables(ds: xr.Dataset) -> list[str]:
    """The observables that are stored for each case, in the order of the file; of a sweep, its branches too."""
    names = [str(name) for name in ds.data_vars if _is_number_of_each_case(ds, str(name))]
    return [name for name in names if not name.endswith("error") and name not in NOT_OBSERVED and _is_told(ds, name)]


def _is_told(ds: xr.Dataset, name: str) -> bool:
    """Whether a number tells something: not the only branch, nor a load or an end angle that was given."""
    if name == "branch":
        return bool((ds[name] != ds[name].values.flat[0]).any())
    if name not in FOUND:
        return True
    if HELD_INDEX not in ds.data_vars:
        return False
    largest = max(float(abs(ds[other]).max()) for other in FOUND if other in ds.data_vars)
    return float(ds[name].max() - ds[name].min()) > _ROUNDING * largest


def is_count(ds: xr.Dataset, name: str) -> bool:
    """Whether a stored variable is a whole number: a count, a comparison, or the number of a branch."""
    return name == HELD_INDEX or schema.is_count(ds[name]) or ds[name].dtype.kind in "iu"


def is_level(ds: xr.Dataset, name: str) -> bool:
    """Whether a number is the same in all cases, but for rounding."""
    values = ds[name].values[np.isfinite(ds[name].values)]
    return bool(values.size and np.ptp(values) <= NOISE * np.abs(values).max())


def names_of(ds: xr.Dataset, names: Sequence[str]) -> list[str]:
    """The names, each once. Raises `InputError` for one that is no number of each case, with the observables."""
    for name in names:
        if not _is_number_of_each_case(ds, name):
            known = observables(ds)
            raise InputError(f"no observable {name!r}{near(name, known)}; the file has {choices(known) or 'none'}")
    return list(dict.fromkeys(names))


def _is_number_of_each_case(ds: xr.Dataset, name: str) -> bool:
    """Also the estimated errors, the condition number and the loads are numbers of each case."""
    return name in ds.data_vars and ds[name].dtype.kind in "iuf" and set(ds[name].dims) == set(ds["outcome"].dims)
