"""`ds.rod` on a study's dataset: its case, its values by name, and whatever was not stored.

    import workbench                # once, before or after xarray
    ds = xr.open_dataset("modulus.h5", chunks={})
    ds.rod.sel(E=2e4).rod.position  # from what is stored, where that is enough; solved again where not
    ds.rod.at(E=2.1e4).position     # a neighbour that is on no axis, solved

The solver is imported when it is first needed.
"""

from functools import cached_property
from typing import TYPE_CHECKING, Any

import xarray as xr

if TYPE_CHECKING:
    from solver import Case, Solution
    from studies import Study


@xr.register_dataset_accessor("rod")
class RodAccessor:
    """What `ds.rod` is; the dataset may be a selection, and its arrays may be lazy.

    Along the rod, as labelled arrays with units, (axes, u) and a component where there is one: beta, dbeta, alpha, z,
    gamma, position, tangent, normal, material_frame, kappa, F1, F2, F3, FY, contact, push, M1, M2, h. Each is read
    where it is stored, else computed from what is, else the cases are solved again as they were. `InputError` is
    raised where the dataset is no study's, or more cases would have to be solved than can be waited for.
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds

    @cached_property
    def study(self) -> "Study":
        """The study, under the reading that the dataset was run under. Raises `InputError`."""
        from .run.stored_case import study_of

        return study_of(self._ds)

    @cached_property
    def case(self) -> "Case":
        """The case of the dataset, of the shape of its axes; selected axes have gone. Raises `InputError`."""
        from .run.stored_case import case_of

        return case_of(self._ds, self.study)

    def sel(self, **values: Any) -> xr.Dataset:
        """The dataset at values of its axes: ``sel(E=1e4)``, ``sel(E=[1e4, 2e4])``, ``sel(E=slice(1e4, 2e4))``.

        A value is one of the axis's, to nine digits; angles in rad. Raises `InputError` with the axis's values.
        """
        from solver.problem.errors import InputError

        from .data.selection import axis_of, indices

        found = {}
        for name, value in values.items():
            axis = axis_of(self._ds, name)
            try:
                found[axis] = indices(self._ds, axis, value)
            except InputError as error:
                raise InputError(f"{error}; ds.rod.at({name}=...) solves a case at any value") from None
        return self._ds.isel(found)

    def at(self, **values: float) -> "Solution":
        """The case at these values of fields of the study, solved as the study was; axes left out stay.

        A value may lie on its axis or not; angles in rad. Raises `InputError`.
        """
        from .run.stored_case import solve_at

        return solve_at(self._ds, self.study, values)

    @cached_property
    def _solved(self) -> "Solution":
        from .run.stored_case import solve_at

        return solve_at(self._ds, self.study, {})

    def along(self, name: str) -> xr.DataArray:
        """An array along the rod by its name; also as an attribute, ``ds.rod.contact``."""
        from solver.problem.errors import no_such

        from .data.derived_arrays import ARRAYS, Stored

        if name not in ARRAYS:
            raise no_such("array along the rod", name, ARRAYS)
        return Stored(self._ds, self.study, lambda: self.case, lambda: self._solved).array(name)

    def __getattr__(self, name: str) -> xr.DataArray:
        from .data.derived_arrays import ARRAYS

        if name not in ARRAYS:
            raise AttributeError(f"ds.rod has no {name!r}; choose from {', '.join(dir(self))}")
        return self.along(name)

    def __dir__(self) -> list[str]:
        from .data.derived_arrays import ARRAYS

        return sorted({"study", "case", "sel", "at", "along", *ARRAYS})

    def __repr__(self) -> str:
        return f"<ds.rod: {', '.join(dir(self))}>"
