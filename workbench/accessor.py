"""The accessor `ds.rod` of a dataset: its stored study (`stored.stored_study.StoredStudy`).

The solver is imported when it is first needed.
"""

from typing import TYPE_CHECKING

import xarray as xr

if TYPE_CHECKING:
    from .stored.stored_study import StoredStudy


def rod(ds: xr.Dataset) -> "StoredStudy":
    """The stored study of a dataset."""
    from .stored.former_names import dataset_in_current_names
    from .stored.stored_study import StoredStudy

    return StoredStudy(dataset_in_current_names(ds))


xr.register_dataset_accessor("rod")(rod)
