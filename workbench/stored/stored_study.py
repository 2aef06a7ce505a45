"""A stored study as an object: what a dataset holds, each thing asked once, and what follows from it.

    import workbench.accessor       # registers it as ds.rod
    ds = xr.open_dataset("modulus.h5", chunks={})
    ds.rod.sel(E=2e4).rod.position  # computed from what is stored where that suffices, else solved again
    ds.rod.at(E=2.1e4).position     # a case that is on no axis, solved

Figures, scenes, pages and exports take one.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.problem.errors import InputError, check_known, near
from solver.problem.quantities import current
from solver.problem.shown import Picture
from studies.grammar.axes import SAMPLE, quantity_of
from studies.laws.law_kinds import MONOTONE

from ..words import labels
from . import derived_arrays, file_kinds, quantity_variables, refined, stored_verdicts
from .chosen_cases import Value, indices
from .derived_arrays import ARRAYS, StoredArrays
from .refined import Refined
from .stored_cases import StoredCases
from .trend_lines import LawLine, TrendLine

if TYPE_CHECKING:
    import pandas as pd

    from solver import Case, Solution
    from studies import Study
    from studies.laws.judgement import Law
    from studies.laws.law_verdict import LawVerdicts

    from ..geometry.centreline import Centreline

WHICH = ("claim", "kind", "observable", "axis", "rule")  # by these a law is found: the numbers of two such are equal
NOTEBOOK = "workbench.notebook"  # loaded by name: it draws what this module reads


@dataclass(frozen=True, eq=False)
class StoredStudy(StoredCases):
    """What a dataset holds; the dataset may be a selection, and its arrays may be lazy.

    Attributes are arrays along the rod with units, of dimensions (axes, u) and a component where there is one: beta,
    dbeta, alpha, z, gamma, position, tangent, normal, material_frame, kappa, F1, F2, F3, FY, contact, push, M1, M2,
    M3_along, h. Each is read where it is stored, else computed from what is stored, else its cases are solved again.

    Raises
    ------
    InputError
        Where the dataset was not made from a study, or too many cases would have to be solved again.

    Examples
    --------
    >>> import workbench.accessor
    >>> from studies import load
    >>> from workbench.run import in_memory
    >>> (law,) = in_memory.run(load("fig7_1_modulus")).rod.verdicts
    >>> law.claim, law.verdict, law.measured
    ('(1)', 'true', '8 → 5')
    """

    # what it holds

    @cached_property
    def laws(self) -> "list[Law]":
        """The laws that its study states. Raises `InputError`."""
        return stored_verdicts.laws_of(self.ds)

    @cached_property
    def verdicts(self) -> "LawVerdicts":
        """The verdicts on its laws, in the study's order, each a `LawVerdict`; `verdicts["(1)"]` is that of a claim.

        A study that is refined along one axis is judged on all its cases, one in a plane on its coarse grid. A law
        along an axis that the reading of Table 1 drops is not decided. Raises `InputError`.
        """
        return stored_verdicts.verdicts(self.ds)

    @cached_property
    def numbers_of_laws(self) -> "list[dict[str, NDArray[np.float64]]]":
        """The numbers with which each of its laws compares its observable: key of the law -> of each case.

        None of a law on a direction. Raises `InputError`.
        """
        return [stored_verdicts.numbers_compared(self.ds, law) for law in self.laws]

    @cached_property
    def unsolved(self) -> int:
        """How many cases are not solved."""
        return int((~self.ds["solved"].values).sum())

    @property
    def is_refined(self) -> bool:
        """Whether it is a refined study."""
        return refined.REFINED in self.attrs

    @cached_property
    def refinement(self) -> Refined:
        """Its refinement; of a grid of one axis or two one without halvings. Raises `InputError`."""
        if self.is_refined:
            return refined.describe(self.ds)
        return refined.grid({axis: self.ds[axis].values.astype(float) for axis in self.axes})

    @property
    def refinement_in_words(self) -> str:
        """What ended its refinement, in a sentence; empty where it has none."""
        return str(self.attrs.get(refined.SAMPLING[-1], ""))

    @cached_property
    def samples(self) -> dict[str, NDArray[np.float64]]:
        """The samples, or the one that is selected: field -> values. Raises `InputError`."""
        from .solved_again import samples_of

        return samples_of(self.ds)

    @cached_property
    def study(self) -> "Study":
        """The study, under the reading that the dataset was run under. Raises `InputError`."""
        from .solved_again import study_of

        return study_of(self.ds)

    @cached_property
    def stand_alone(self) -> bool:
        """Whether each rod was let go by itself, so that neighbours may be at different minima of the energy."""
        return self.leaves and bool(self.attrs.get("study")) and self.study.let_go

    @cached_property
    def case(self) -> "Case":
        """The case of the dataset, of the shape of its remaining axes. Raises `InputError`."""
        from .solved_again import case_of

        return case_of(self.ds, self.study)

    @cached_property
    def common_values(self) -> str:
        """What all cases of a study have in common, as it is given: ``ν = 0.25, a = 0.25 cm, side = inside``.

        Empty for other files, and for one whose study is not stored or cannot be read.
        """
        from studies.language.case_input import field_values

        from .solved_again import case_of

        if self.kind is not file_kinds.STUDY or not self.attrs.get("study"):
            return ""
        try:
            fields = self.study.variation.fields
            axes = {name: self.ds[quantity_variables.dimension(name)].values.ravel() for name in fields}
            places = [{name: values[k] for name, values in axes.items()} for k in (0, -1)]
            first, last = (field_values(case_of(self.ds, self.study, place)) for place in places)
        except InputError:
            return ""
        varied, said = {name for name, values in axes.items() if values.size > 1}, list[str]()
        for field, value in first.items():
            if field in varied or last.get(field) != value:
                continue
            if isinstance(value, str):
                said.append(f"{field} = {value}")
                continue
            name = quantity_of(field).name
            number = xr.DataArray(value, attrs=quantity_variables.labels(name, self.units), name=name)
            said.append(labels.equation(number, value, 6))
        return ", ".join(said)

    @cached_property
    def centreline(self) -> "Centreline":
        """The curve of its one case.

        Where loads vary along the rod it needs the contact force in place of the loads, and the radius where the rod
        may leave the cylinder. Raises `InputError` where the dataset lacks what it needs, or the case is not solved.
        """
        from .centrelines import centreline_of

        return centreline_of(self)

    # which cases

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
        >>> from workbench.run import in_memory
        >>> ds = in_memory.run(load("fig7_1_modulus"))
        >>> one = ds.rod.sel(E="10905")
        >>> int(one["bends"]), dict(one.sizes)
        (6, {'u': 201})
        """
        places = {}
        for name, value in values.items():
            axis = self.axis(name)
            try:
                places[axis] = indices(self.ds[axis], value)
            except InputError as error:
                raise InputError(f"{error}; ds.rod.at({name}=...) solves a case at any value") from None
        return self.ds.isel(places)

    def coarse(self) -> "StoredStudy":
        """The coarse grid of a refined study as a study over its axes; any other study as it is."""
        if not refined.has_all_cases(self.ds):
            return self
        return StoredStudy(refined.grid_of(self.ds, *self.refinement.coarse()), self.kept)

    def line(self) -> "StoredStudy":
        """All cases of a study that is refined along one axis, in the order of that axis; else as `coarse`."""
        if not refined.has_all_cases(self.ds) or len(self.refinement.lattice.axes) > 1:
            return self.coarse()
        (name,) = self.refinement.lattice.axes
        order = np.argsort(self.refinement.places[:, 0])
        return StoredStudy(refined.grid_of(self.ds, order, {name: self.ds[name].values[order]}), self.kept)

    def raster(self, **between: NDArray[np.float64]) -> "StoredStudy":
        """The plane of a refined study as a fine grid, each point with the numbers of the case around which it lies.

        between: further variables, a real number of each case, (cases,), which varies evenly between cases.
        """
        return StoredStudy(refined.raster(self.ds, self.refinement, between))

    # its numbers

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
        if law := next((law for law in self.laws if law.claim == name), None):
            return stored_verdicts.boundary_of_law(self, self.refinement, law)
        return refined.boundary(self.ds, self.refinement, current(name), step, self.observables)

    def trend(self, observable: str, axis: str, at: Mapping[str, Value] | None = None) -> TrendLine:
        """An observable along an axis, on the line at these values of the others. Raises `InputError`, as `places`."""
        return TrendLine(**self._trend(observable, axis, self.places(axis, at)))

    def law_line(self, row: Mapping[str, Any]) -> LawLine:
        """A law, given as a row of its verdicts, on the line that decides it. Raises `InputError`."""
        places = self.places(row["axis"], row["at"])
        compared: Mapping[str, NDArray[np.float64]] = {}
        if row["kind"] != MONOTONE:
            laws = zip(self.laws, self.numbers_of_laws, strict=True)
            compared = next(numbers for law, numbers in laws if all(getattr(law, key) == row[key] for key in WHICH))
        on_line = tuple(np.array([place[name] for place in places]) for name in self.axes)
        return LawLine(
            **self._trend(row["observable"], row["axis"], places),
            row=row,
            compared={key: values[on_line] for key, values in compared.items()},
            formulas=self.expressions,
            others={also["observable"]: self.ds[also["observable"]] for also in row["also"]},
        )

    def _trend(self, observable: str, axis: str, places: list[dict[str, int]]) -> dict[str, Any]:
        """The fields of a `TrendLine` on the line of these places."""
        on = {axis: [place[axis] for place in places]}
        others = {name: i for name, i in places[0].items() if name != axis}
        unbent = self.unbent(observable)
        lines = self.of_solved(observable).where(~unbent).transpose(..., axis).isel(on)
        of_states = [name for name in ("branch", *self.expressions) if name in self.counts - {observable}]
        of_states = [name for name in of_states if set(self.ds[name].dims) == set(places[0])]
        steps = {name: np.diff(self.ds[name].isel(others | on).values) != 0 for name in of_states}
        broken = np.flatnonzero(np.any([*steps.values()], axis=0)) + 1
        is_followed = "fold" in self and axis == self.attrs.get("followed") and np.isfinite(self.ds["fold"])
        return {
            "axis": self.ds[axis],
            "observable": self.ds[observable],
            "along": self.ds[axis].values[on[axis]],
            "values": lines.isel(others).values.astype(float),
            "errors": self.errors_of(observable).transpose(..., axis).isel(on).isel(others).values,
            "unbent": unbent.isel(others | on).values,
            "solved": self.ds["solved"].transpose(..., axis).isel(on).isel(others).values,
            "lines": lines.values.reshape(-1, len(places))[: 0 if lines.ndim == 1 or self.stand_alone else None],
            "held": self.equations(others),
            "names": self._names_of_lines(lines, axis),
            "elsewhere": f"other {', '.join(labels.axis_symbol(name) for name in others if name in lines.dims)}",
            "broken": np.arange(1, len(places)) if self.stand_alone else broken,
            "states": () if self.stand_alone else tuple(name for name, step in steps.items() if step.any()),
            "fold": float(self.ds["fold"]) if is_followed else None,
            "alone": self.stand_alone,
            "is_count": observable in self.counts,
            "is_level": self.is_level(observable),
            "is_logarithmic": self.is_logarithmic(axis),
        }

    def _names_of_lines(self, lines: xr.DataArray, axis: str) -> list[str]:
        """The value of the other axis on each line, in words; none of samples, or of several such axes."""
        others = [str(dim) for dim in lines.dims if dim != axis]
        if len(others) != 1 or others == [SAMPLE]:
            return []
        return [labels.equation(self.ds[others[0]], value) for value in self.ds[others[0]].values]

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
        return derived_arrays.table(self.ds, [self.along(name).rename(name) for name in along])

    # its arrays along the rod, and cases that are solved

    @cached_property
    def arrays(self) -> StoredArrays:
        """Its arrays along the rod and the constants of its cases, as far as what is stored suffices."""
        return StoredArrays(self.ds)

    def array(self, name: str) -> xr.DataArray | None:
        """An array along the rod as stored or computed from stored ones; None where they do not suffice."""
        values: xr.DataArray | None = self.arrays.derive(name)
        return values

    def along(self, name: str) -> xr.DataArray:
        """The array along the rod of that name; the same as the attribute, ``ds.rod.contact``. Raises `InputError`."""
        check_known("array along the rod", name, ARRAYS)
        return derived_arrays.StoredRod(self.ds, self.study, lambda: self.case, lambda: self.solution).array(name)

    if not TYPE_CHECKING:  # a misspelt name is an error of types

        def __getattr__(self, name: str) -> xr.DataArray:
            if name not in ARRAYS:
                raise AttributeError(f"ds.rod has no {name!r}{near(name, dir(self))}; dir(ds.rod) lists its names")
            return self.along(name)

    @cached_property
    def solution(self) -> "Solution":
        """Its cases solved again at its stations, as its study solves them; rods off the wall once for all selections.

        Raises `InputError` for too many cases.
        """
        from .solved_again import solve_once

        return solve_once(self.ds, self.study, self.case, self.kept)

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
        >>> from workbench.run import in_memory
        >>> ds = in_memory.run(load("fig7_1_modulus"))
        >>> print(f"{ds.rod.at(E=12000.0).z[-1]:.3f}")
        6.965
        """
        from .solved_again import solve_at

        return solve_at(self.ds, self.study, values)

    def solve(self, stations: int, names: Iterable[str]) -> "StoredStudy":
        """Its cases solved again, as its study solves them, at so many stations or a little more.

        Parameters
        ----------
        stations : int
            The stored stations are among those of the result.
        names : iterable of str
            The arrays along the rod that the result has.

        Returns
        -------
        StoredStudy

        Raises
        ------
        InputError
            Where the dataset has no study, for too many cases or stations, and where the shapes are not the stored
            ones.
        """
        from .solved_again import at_stations, check_shapes, with_arrays

        if self.study.refine is not None:  # its cases stand in no grid of the study
            raise InputError("they are of the coarse grid of a refined study")
        bare = StoredStudy(at_stations(self.ds, stations), self.kept)
        denser = with_arrays(bare.ds, bare.study, bare.solution, names)
        check_shapes(self.ds, denser)
        return StoredStudy(denser, self.kept)

    # pictures

    def plot(self, **at: Any) -> Picture:
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
        >>> from workbench.run import in_memory
        >>> ds = in_memory.run(load("fig7_1_modulus"))
        >>> len(ds.rod.plot(E="10905").figure.axes)
        3
        """
        return import_module(NOTEBOOK).plot(self, at)

    def scene(self, **at: Any) -> Picture:
        """The rods on their cylinder, with a slider for each axis that is not given; a notebook shows them inline.

        Parameters
        ----------
        **at : float or str
            Values of axes, as of `sel`: ``scene(E=1e4)``.

        Returns
        -------
        workbench.notebook.NotebookScene
            With ``save("modulus.html")``, one offline file.

        Raises
        ------
        InputError
            For a value that is not stored, and where no case has a shape.
        """
        return import_module(NOTEBOOK).scene(self, at)

    def __dir__(self) -> list[str]:
        return sorted({*(name for name in super().__dir__() if not name.startswith("_")), *ARRAYS})

    def __repr__(self) -> str:
        return f"<ds.rod: {', '.join(dir(self))}>"
