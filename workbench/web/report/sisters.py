"""The equilibria among which the rod of Table 1 is one: which of them it is, and a stable one beside it."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver import equilibria, solve
from studies import Study

from ...branches.ends_study import ends_problem
from ...branches.equilibria_dataset import dataset_of
from ...words import labels

NAME = "equilibria"
OWN, STABLE = "rank_of_study", "rank_of_stable"  # attributes: places by energy, from 1; 0: there is none


def run(study: Study) -> xr.Dataset:
    """Return all equilibria between the end angles of a study's one rod, under its loads.

    Attribute `rank_of_study` is the rank by energy of the study's own rod, and `rank_of_stable` that of the stable
    equilibrium that `solve` takes between these ends; 0 where there is none. Raises `InputError` as of `ends_problem`.
    """
    case = ends_problem(study)
    solution, every, default = solve(study.case(), stations=2), equilibria(case), solve(case, stations=2)
    slopes = np.array([equilibrium.dbeta0 for equilibrium in every])
    ranks = {OWN: _rank(slopes, float(solution.dbeta[0])), STABLE: 0}
    if any(equilibrium.index == 0 for equilibrium in every):
        ranks[STABLE] = _rank(slopes, float(default.dbeta[0]))
    return dataset_of(study, case, every).assign_attrs(ranks)


def _rank(slopes: "np.ndarray[Any, Any]", slope: float) -> int:
    return int(np.abs(slopes - slope).argmin()) + 1 if slopes.size else 0


def pair(ds: xr.Dataset) -> xr.Dataset:
    """Return the stable equilibrium, if there is one, and the rod of the study."""
    return ds.isel(equilibrium=[ds.attrs[rank] - 1 for rank in (STABLE, OWN) if ds.attrs[rank]])


def rows(ds: xr.Dataset, pictures: Sequence[Mapping[str, Any]]) -> dict[str, Any] | None:
    """Return what the report says of them; None where the study's own rod is not among them."""
    if not ds.attrs[OWN]:
        return None
    case = ds.isel(equilibrium=ds.attrs[OWN] - 1)
    index, stable = int(case["index"]), ds.attrs[STABLE]
    return {
        "count": ds.sizes["equilibrium"],
        "rank": ds.attrs[OWN],
        "stability": "stable" if index == 0 else f"unstable in {index} {'way' if index == 1 else 'ways'}",
        "sister": stable if stable != ds.attrs[OWN] else 0,
        "attached": f"{float(ds['attached'][stable - 1]):.0%}" if stable else "",
        "ends": labels.typeset(str(ds.attrs["stability"])),
        "pictures": pictures,
    }
