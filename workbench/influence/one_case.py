"""The solution of one case of a study, stored or not."""

from collections.abc import Mapping
from functools import partial

import numpy as np
import xarray as xr

from solver import Solution
from studies import Study

from ..store import in_memory, schema, selection, stored_case
from ..store.case_solutions import between, solve_one
from ..store.plan import plan


def of_dataset(ds: xr.Dataset, at: Mapping[str, selection.Value] | None = None) -> Solution:
    """A case of a study's dataset, solved again as it was run; at: as of `selection.case`. Raises `InputError`."""
    one = ds.isel(selection.case(ds, at))
    return stored_case.solve_at(one, stored_case.study_of(one), {})


def outline(study: Study) -> xr.Dataset:
    """A dataset of the study's dimensions without any result, in which a case is chosen as in a stored one."""
    over = study.dimensions()
    coords = {schema.dimension(one.name): one.coordinate.astype(float) for one in over.each}
    dims = tuple(coords)
    ds = xr.Dataset({"outcome": (dims, np.broadcast_to(np.array("", dtype=object), over.shape))}, coords)
    return ds.assign_attrs(laws=schema.laws_text(study), reading=study.reading or "", sampled=" ".join(study.sampled))


def of_study(study: Study, at: Mapping[str, selection.Value] | None = None) -> Solution:
    """A case of a study that is not stored. Raises `InputError`.

    Only this case is solved; along a followed axis also those from which it continues.
    """
    if study.follow is not None:
        return of_dataset(in_memory.run(study), at)
    where = selection.case(outline(study), at)
    over = study.dimensions().each
    values = {field: float(v[where[schema.dimension(one.name)]]) for one in over for field, v in one.fields.items()}
    case = study.case_of(values)
    if not study.sweeps:
        return solve_one(case, study.equilibrium, study.tol, study.method, study.stations)
    work = plan(study)
    return between(work.study, case, partial(work.spine.nearest, values), study.stations)
