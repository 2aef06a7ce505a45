"""The boundary of an observable: the pairs of neighbouring cases between which it changes."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.problem.errors import InputError, choices, near, no_such
from studies.grammar.axes import SAMPLE
from studies.language.refinement import OUTCOME, Lattice, Refinement, refinement_of

from . import attributes, law_verdicts, refined, schema, selection

if TYPE_CHECKING:
    import xarray as xr

    from studies.grammar.axes import Values
    from studies.language.refinement import Places


def boundary(ds: "xr.Dataset", name: str, step: float | None = None) -> "xr.Dataset":
    """The pairs of neighbouring cases between which an observable changes.

    Parameters
    ----------
    ds : xr.Dataset
        A refined study, or a grid of one axis or two.
    name : str
        An observable, an expression, or "outcome" (whether a case is solved).
    step : float, optional
        The change that counts, in the unit of the observable; default: that of `[refine.steps]`, and 0 for a count.

    Returns
    -------
    xr.Dataset
        Of the dimension `pair`. Each axis: the middle between the two cases, in the unit of the axis, angles in rad.
        ``<axis>_half_width``: half their distance along it, so that the boundary lies within; 0 along the other axis.
        `before` and `after`: the number of the case of the lower and of the higher value of the axis. The attribute
        `unknown` counts the pairs of which one case has no number: they are not compared.

    Raises
    ------
    InputError
        For an unknown observable, a real one without a step, a dataset of more than two axes, or lost cases.
    """
    numbers, step = _numbers(ds, name, step)
    cells = _refinement(ds, numbers)
    pairs, along = cells.edges()
    change = np.abs(np.diff(cells.numbers[pairs, 0], axis=1)[:, 0])
    unknown = int((np.isnan(cells.numbers[pairs, 0]).sum(axis=1) == 1).sum())
    pairs, along = pairs[change > step], along[change > step]
    places = {}
    for k, (axis, row) in enumerate(cells.lattice.values(cells.places).items()):
        low, high = row[pairs].T
        places[axis] = low, np.where(along == k, high, low)
    label = {} if name == OUTCOME else dict(ds[name].attrs)
    sides = [("pair", cells.numbers[pairs[:, side], 0], label) for side in (0, 1)]
    return _pairs(ds, places, sides, "cases").assign_attrs(observable=name, step=step, unknown=unknown)


def _pairs(ds: "xr.Dataset", places: "Mapping[str, tuple[Values, Values]]", sides: list[Any], of: str) -> "xr.Dataset":
    """The dataset of a boundary. places: axis -> its values on the two sides of each pair. of: what makes a pair."""
    import xarray as xr

    result: dict[str, Any] = dict(zip(("before", "after"), sides, strict=True))
    for axis, (low, high) in places.items():
        label = dict(ds[axis].attrs)
        half = {**label, "long_name": f"half the distance of the two {of} along {axis}"}
        result |= {
            axis: ("pair", low + (high - low) / 2, label),
            f"{axis}_half_width": ("pair", (high - low) / 2, half),
        }
    return xr.Dataset(result).set_coords(list(places))


def boundary_of_law(ds: "xr.Dataset", claim: str) -> "xr.Dataset":
    """The pairs of neighbouring lines of a study that is refined in the plane, between which a law changes its verdict.

    Parameters
    ----------
    ds : xr.Dataset
    claim : str
        The claim of a law, such as "(1)".

    Returns
    -------
    xr.Dataset
        Of the dimension `pair`. The axis across the lines: the middle between the two lines; ``<axis>_half_width``:
        half their distance; `before` and `after`: their verdicts.

    Raises
    ------
    InputError
        For an unknown claim, or a dataset that is not refined in the plane.
    """
    law = next((stated for stated in attributes.laws(ds) if stated.claim == claim), None)
    if law is None:
        raise no_such("law", claim, [stated.claim for stated in attributes.laws(ds)])
    if not refined.is_refined(ds) or len(refined.axes_of(ds)) < 2:
        raise InputError("the boundary of a law needs a study that is refined in the plane of two axes")
    study = refined.describe(ds)
    names, coarse = list(study.lattice.axes), study.lattice.axes[law.axis]
    along = names.index(law.axis)
    cases = np.flatnonzero(study.places[:, along] % (1 << study.lattice.depth) == 0)
    at, counts = np.unique(study.places[cases, 1 - along], return_counts=True)
    cases = cases[np.isin(study.places[cases, 1 - along], at[counts == coarse.size])]  # of complete lines
    index = cases[np.lexsort(study.places[cases].T[::-1])]
    across = names[1 - along]
    values = {law.axis: coarse, across: study.lattice.along(across, at[counts == coarse.size])}
    values = {name: values[name] for name in names}
    grid = refined.grid_of(ds, index.reshape([row.size for row in values.values()]), values)
    verdicts = law_verdicts.verdicts_of_lines(grid, law).values
    change = np.flatnonzero(verdicts[1:] != verdicts[:-1])
    sides = [("pair", verdicts[change + side].astype(str)) for side in (0, 1)]
    places = {across: (values[across][change], values[across][change + 1])}
    return _pairs(ds, places, sides, "lines").assign_attrs(law=claim)


def _numbers(ds: "xr.Dataset", name: str, step: float | None) -> "tuple[Values, float]":
    """The numbers of an observable, of the shape of the cases, and the change that counts."""
    watch = refined.describe(ds).watch if refined.is_refined(ds) else {}
    if name == OUTCOME:
        return ds["solved"].values.astype(float), 0.0
    known = [*selection.observables(ds), OUTCOME]
    if name not in ds.data_vars or ds[name].dims != ds["outcome"].dims or ds[name].dtype.kind not in "iuf":
        raise InputError(f"no observable {name!r}{near(name, known)}; the dataset has {choices(known)}")
    if step is None and name not in watch and not schema.is_count(ds[name]):
        raise InputError(f"{name} is a real number: give the change that counts, such as step=0.1")
    step = watch.get(name, 0.0) if step is None else step
    if not 0 <= step < np.inf:
        raise InputError(f"step must be a number that is not negative, got {step}")
    return ds[name].values.astype(float), float(step)


def _refinement(ds: "xr.Dataset", numbers: "Values") -> Refinement:
    """The cells of a refined study, or of a grid, with these numbers. Raises `InputError`."""
    if refined.is_refined(ds):
        study = refined.describe(ds)
        lattice, places = study.lattice, study.places
    else:
        lattice, places = _grid(ds)
    return refinement_of(lattice, places, numbers.reshape(-1, 1), np.zeros(1), lattice.depth)


def _grid(ds: "xr.Dataset") -> "tuple[Lattice, Places]":
    """A grid of one axis or two as a lattice without halvings, and the places of its cases in their order."""
    axes = schema.axes_of(ds)
    if not 1 <= len(axes) <= 2 or SAMPLE in axes:
        has = choices(axes) or "none"
        raise InputError(f"a boundary needs a refined study, or a grid of one axis or two; the axes are {has}")
    if small := [axis for axis in axes if ds.sizes[axis] < 2]:
        raise InputError(f"a boundary needs at least two values of each axis; {small[0]} has one")
    values = {axis: ds[axis].values.astype(float) for axis in axes}
    lattice = Lattice({axis: np.sort(row) for axis, row in values.items()}, frozenset(), 0)
    ranks = np.meshgrid(*(np.argsort(np.argsort(row)) for row in values.values()), indexing="ij")
    return lattice, np.stack([row.ravel() for row in ranks], axis=1)
