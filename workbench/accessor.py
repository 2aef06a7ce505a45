"""The accessor `ds.rod` of a study's dataset: its case, selection by value, and arrays that were not stored.

    import workbench.accessor       # registers it
    ds = xr.open_dataset("modulus.h5", chunks={})
    ds.rod.sel(E=2e4).rod.position  # computed from what is stored where that suffices, else solved again
    ds.rod.at(E=2.1e4).position     # a case that is on no axis, solved

The solver is imported when it is first needed.
"""

from functools import cached_property
from typing import TYPE_CHECKING, Any

import xarray as xr

if TYPE_CHECKING:
    import pandas as pd

    from solver import Case, Solution
    from studies import Study

    from .notebook import Plot, Scene


@xr.register_dataset_accessor("rod")
class RodAccessor:
    """The accessor `ds.rod`; the dataset may be a selection, and its arrays may be lazy.

    Attributes are arrays along the rod with units, of dimensions (axes, u) and a component where there is one: beta,
    dbeta, alpha, z, gamma, position, tangent, normal, material_frame, kappa, F1, F2, F3, FY, contact, push, M1, M2,
    M3_along, h. Each is read where it is stored, else computed from what is stored, else its cases are solved again.

    Raises
    ------
    InputError
        Where the dataset was not made from a study, or too many cases would have to be solved again.
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds

    @cached_property
    def study(self) -> "Study":
        """The study, under the reading that the dataset was run under. Raises `InputError`."""
        from .store.stored_case import study_of

        return study_of(self._ds)

    @cached_property
    def case(self) -> "Case":
        """The case of the dataset, of the shape of its remaining axes. Raises `InputError`."""
        from .store.stored_case import case_of

        return case_of(self._ds, self.study)

    def sel(self, **values: Any) -> xr.Dataset:
        """Select by values of axes: ``sel(E=1e4)``, ``sel(E=[1e4, 2e4])``, ``sel(E=slice(1e4, 2e4))``.

        Parameters
        ----------
        **values : float, str, list or slice
            For an axis (``beta0``, or the study's field ``beta``) a stored value to nine digits, an angle in rad; as
            text, ``"10910"`` or ``"30deg"``, the value that it abbreviates.

        Returns
        -------
        xr.Dataset
            The selection; an axis of which one value was selected is gone.

        Raises
        ------
        InputError
            For a value that is not stored, with the values that are.

        Examples
        --------
        >>> import workbench.accessor
        >>> from studies import load
        >>> from workbench.store import in_memory
        >>> ds = in_memory.run(load("fig7_1_modulus"))
        >>> one = ds.rod.sel(E="10905")
        >>> int(one["turns"]), dict(one.sizes)
        (6, {'u': 201})
        """
        from solver.problem.errors import InputError

        from .store.selection import axis_of, indices

        places = {}
        for name, value in values.items():
            axis = axis_of(self._ds, name)
            try:
                places[axis] = indices(self._ds, axis, value)
            except InputError as error:
                raise InputError(f"{error}; ds.rod.at({name}=...) solves a case at any value") from None
        return self._ds.isel(places)

    def at(self, **values: float) -> "Solution":
        """Solve the case at other values of fields of the study, with the study's tolerance and method.

        Parameters
        ----------
        **values : float
            Of any field of the study, on its axis or not; angles in rad. Other axes stay.

        Returns
        -------
        Solution
            Of the shape of the other axes.

        Raises
        ------
        InputError
            For an unknown field, a value that the solver refuses, or too many cases.

        Examples
        --------
        >>> import workbench.accessor
        >>> from studies import load
        >>> from workbench.store import in_memory
        >>> ds = in_memory.run(load("fig7_1_modulus"))
        >>> print(f"{ds.rod.at(E=12000.0).z[-1]:.3f}")
        6.965
        """
        from .store.stored_case import solve_at

        return solve_at(self._ds, self.study, values)

    def boundary(self, name: str, step: float | None = None) -> xr.Dataset:
        """The boundary of an observable: the pairs of neighbouring cases between which it changes.

        Parameters
        ----------
        name : str
            An observable, an expression, "outcome" (whether a case is solved), or the claim of a law, such as "(1)":
            where its verdict changes from line to line.
        step : float, optional
            The change that counts, in the unit of the observable; default: that of the study's refinement, and 0 for a
            count.

        Returns
        -------
        xr.Dataset
            Of the dimension `pair`: each axis (the middle between the two cases), ``<axis>_half_width``, `before` and
            `after` (the numbers of the two cases).

        Raises
        ------
        InputError
            For an unknown observable, a real one without a step, or a grid of more than two axes.
        """
        from .store.law_verdicts import boundary_of_law
        from .store.refined import boundary
        from .store.schema import laws_of

        if any(law.claim == name for law in laws_of(self._ds)):
            return boundary_of_law(self._ds, name)
        return boundary(self._ds, name, step)

    def to_pandas(self, *along: str) -> "pd.DataFrame":
        """A table: one row a case, or with names of arrays along the rod one row a station.

        Parameters
        ----------
        *along : str
            Arrays along the rod, ``to_pandas("beta", "push")``; stored, or computed as by `along`. Default: none.

        Returns
        -------
        pandas.DataFrame
            The axes are the index, and `u` for stations; angles in rad. Every stored quantity of a case is a column, of
            stations `s`, the arrays, and their components (``position_x``). ``attrs["units"]`` has the unit of each
            column and axis, ``attrs["long_names"]`` its name in words.

        Raises
        ------
        InputError
            For an unknown array, a dataset that is not a stored study, and a table of more than 5e8 numbers.
        """
        from .store import derived_arrays

        return (
            derived_arrays.stations_table(self._ds, [self.along(name).rename(name) for name in along])
            if along
            else derived_arrays.cases_table(self._ds)
        )

    def plot(self, **at: Any) -> "Plot":
        """The figure of the dataset, or of its case at these values of axes; a notebook shows it inline.

        Parameters
        ----------
        **at : float or str
            Values of axes, as of `sel`: ``plot(E=1e4)``.

        Returns
        -------
        workbench.notebook.Plot
            With ``save("modulus.pdf")`` and ``figure``.

        Raises
        ------
        InputError
            For a value that is not stored, and where there is nothing to draw.

        Examples
        --------
        >>> import workbench.accessor
        >>> from studies import load
        >>> from workbench.store import in_memory
        >>> ds = in_memory.run(load("fig7_1_modulus"))
        >>> len(ds.rod.plot(E="10905").figure.axes)
        3
        """
        from .notebook import plot

        return plot(self._ds, at)

    def scene(self, **at: Any) -> "Scene":
        """The rods on their cylinder, with a slider for each axis that is not given; a notebook shows them inline.

        Parameters
        ----------
        **at : float or str
            Values of axes, as of `sel`: ``scene(E=1e4)``.

        Returns
        -------
        workbench.notebook.Scene
            With ``save("modulus.html")``, one offline file.

        Raises
        ------
        InputError
            For a value that is not stored, and where no case has a shape.
        """
        from .notebook import scene

        return scene(self._ds, at)

    @cached_property
    def _solved(self) -> "Solution":
        from .store.stored_case import solve_at

        return solve_at(self._ds, self.study, {})

    def along(self, name: str) -> xr.DataArray:
        """The array along the rod of that name; the same as the attribute, ``ds.rod.contact``. Raises `InputError`."""
        from solver.problem.errors import no_such

        from .store.derived_arrays import ARRAYS, Stored

        if name not in ARRAYS:
            raise no_such("array along the rod", name, ARRAYS)
        return Stored(self._ds, self.study, lambda: self.case, lambda: self._solved).array(name)

    def __getattr__(self, name: str) -> xr.DataArray:
        from .store.derived_arrays import ARRAYS

        if name not in ARRAYS:
            raise AttributeError(f"ds.rod has no {name!r}; choose from {', '.join(dir(self))}")
        return self.along(name)

    def __dir__(self) -> list[str]:
        from .store.derived_arrays import ARRAYS

        return sorted({"study", "case", "sel", "at", "along", "boundary", "to_pandas", *ARRAYS})

    def __repr__(self) -> str:
        return f"<ds.rod: {', '.join(dir(self))}>"
