"""Refined studies as stored: what was refined, why it ended; the cases as a grid, as a line, or as a raster; and the
boundary of an observable: the pairs of neighbouring cases between which it changes."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.problem.errors import InputError, choices, near
from studies.grammar.axes import SAMPLE, Values
from studies.language import refine_table as tables
from studies.language.refinement import BUDGET, OUTCOME, Lattice, Places, Refinement, product_of, refinement_of
from studies.laws.case_rows import CaseRow
from studies.laws.line_verdicts import branch_changes

from .quantity_variables import OF_THE_CASE, dimension, is_count

if TYPE_CHECKING:
    import xarray as xr

    from studies import Study

SAMPLING = ("sampling", "sampling_caution", "refinement")  # sentences on the samples of a file
REFINED = "refined"  # the attribute of a refined study, JSON
MOST_DRAWN = 800  # cells of a raster along an axis, unless the coarse grid has more
SPACINGS = ("linear", "geometric")
MOST_HALVINGS = 31


@dataclass(frozen=True, eq=False)
class Refined:
    """The refinement of a stored study, or a grid of one axis or two as one without halvings.

    lattice: its axes as the dataset names them. places: of each case, (cases, axes). watch: name -> the change from
    which two cases differ. laws: the claims of watched laws.
    """

    lattice: Lattice
    places: Places
    watch: Mapping[str, float]
    laws: list[str]

    def coarse(self) -> "tuple[NDArray[np.int64], Mapping[str, Values]]":
        """The cases of the coarse grid: their indices, of its shape, and the values of its axes."""
        cases = np.flatnonzero((self.places % (1 << self.lattice.depth) == 0).all(axis=1))
        return self._in_order(cases, self.lattice.axes)

    def lines(self, axis: str) -> "tuple[NDArray[np.int64], Mapping[str, Values]]":
        """The cases of all lines along an axis that have a case at each of its coarse values, as of `coarse`."""
        names, coarse = list(self.lattice.axes), self.lattice.axes[axis]
        along, across = self.places[:, names.index(axis)], self.places[:, 1 - names.index(axis)]
        cases = np.flatnonzero(along % (1 << self.lattice.depth) == 0)
        at, counts = np.unique(across[cases], return_counts=True)
        complete = at[counts == coarse.size]
        values = {name: coarse if name == axis else self.lattice.along(name, complete) for name in names}
        return self._in_order(cases[np.isin(across[cases], complete)], values)

    def _in_order(
        self, cases: NDArray[np.int64], values: Mapping[str, Values]
    ) -> "tuple[NDArray[np.int64], Mapping[str, Values]]":
        order = cases[np.lexsort(self.places[cases].T[::-1])]
        return order.reshape([row.size for row in values.values()]), values

    def rows(self, axis: str, stored: Mapping[str, Values], branch: "NDArray[np.int64] | None") -> list[CaseRow]:
        """The lines of all cases along an axis, in the rising order of the other one.

        A line off the coarse grid has places of the coarse values, mostly without cases. Evenly lie the cases of the
        coarse grid and, where each of its intervals has one, their middles; the others were added where a number
        changes. stored: of each axis the values of the cases. branch: their branches, (cases,).
        """
        lattice, k = self.lattice, list(self.lattice.axes).index(axis)
        along, across = self.places[:, k], np.delete(self.places, k, axis=1)
        order = np.lexsort((along, *across.T))
        lines = np.split(order, np.flatnonzero((np.diff(across[order], axis=0) != 0).any(axis=1)) + 1)
        coarse = np.arange(lattice.shape[k]) << lattice.depth
        rows = []
        for cases in lines:
            lacking = np.setdiff1d(coarse, along[cases])
            places = np.concatenate([along[cases], lacking])
            rise = np.argsort(places)
            every = np.concatenate([cases, np.full(lacking.size, -1)])[rise]
            values = lattice.along(axis, places[rise])
            values[every >= 0] = stored[axis][cases]
            levels = Lattice({axis: lattice.axes[axis]}, frozenset(), lattice.depth).levels(places[rise][:, None])
            has_middles = int((levels <= 1).sum()) == 2 * coarse.size - 1
            at = {name: float(stored[name][cases[0]]) for name in lattice.axes if name != axis}
            branches = np.zeros(every.size) if branch is None else np.where(every >= 0, branch[every], -1)
            rows.append(CaseRow(at, every, values, branch_changes(branches), levels > has_middles))
        return rows


def attributes(study: "Study", refinement: Refinement) -> dict[str, str]:
    """The attributes of a refined study: for programs, and a sentence on what ended its refinement."""
    table, lattice = study.refine, refinement.lattice
    assert table is not None
    spacings = {dimension(name): SPACINGS[name in lattice.geometric] for name in lattice.axes}
    watch = {name: float(step) for name, step in table.changes.items()}
    data = {"axes": spacings, "halvings": lattice.depth, "watch": watch, "laws": table.laws}
    data |= {"ended": refinement.ended, "rounds": refinement.rounds}
    changes = [_change(name, step) for name, step in watch.items()]
    changes += [f"the verdict on law {claim} changes" for claim in table.laws]
    laws = "; laws are judged on all cases" if study.laws else ""
    return {REFINED: json.dumps(data), SAMPLING[-1]: f"{_sentence(' or '.join(changes), refinement)}{laws}"}


def _sentence(changes: str, refinement: Refinement) -> str:
    """What ended a refinement, and what it cannot have seen."""
    lattice, cases = refinement.lattice, len(refinement.places)
    within = f"{lattice.share(lattice.depth):.2g} of an axis"
    grid = " x ".join(map(str, lattice.sizes))
    share = f"{cases} cases, {100 * cases / prod(lattice.sizes):.2g} % of the uniform grid of {grid}"
    wide = f"up to {refinement.widest():.2g} of an axis"
    unseen = (
        f"a change and its reverse between neighbouring cases, {wide} apart, are not seen"
        if len(lattice.axes) == 1
        else f"a region inside one cell, {wide} wide, that holds none of its corners is not seen"
    )
    if refinement.ended == BUDGET:
        left = refinement.open_cells()
        many = f"{sum(left)} cell{'s' * (sum(left) != 1)}"
        if any(left):
            largest = lattice.share(next(level for level, count in enumerate(left) if count))
            many += f", the largest {largest:.2g} of an axis wide,"
        if refinement.lines:
            many += f" and {refinement.open_lines()} gaps between lines"
        return (
            f"refinement ended as the budget of {refinement.budget} cases is spent: {many} are not halved, so that "
            f"where {changes} is not known to {within} everywhere ({share}); {unseen}"
        )
    if not refinement.rounds:
        none = f"on the coarse grid there is no step wider than {within} at which {changes}"
        return f"refinement added no case: {none}; {unseen}"
    return f"refinement ended as the tolerance is reached: where {changes} is known to {within} ({share}); {unseen}"


def _change(name: str, step: float) -> str:
    if name == OUTCOME:
        return "the outcome changes"
    return f"{name} changes by more than {step:g}" if step else f"{name} changes"


def has_all_cases(ds: "xr.Dataset") -> bool:
    """Whether the dataset is of a refined study, and not one case of it."""
    return REFINED in ds.attrs and SAMPLE in ds["outcome"].dims


def axes_of(ds: "xr.Dataset") -> list[str]:
    """The refined axes of a dataset, if it has any. Raises `InputError` for an invalid attribute."""
    return list(_tell(ds)["axes"]) if REFINED in ds.attrs else []


def _tell(ds: "xr.Dataset") -> dict[str, Any]:
    """The attribute of a refined study. Raises `InputError` where it is invalid."""
    try:
        data: dict[str, Any] = json.loads(ds.attrs[REFINED])
        axes, halvings, watch = dict(data["axes"]), data["halvings"], dict(data["watch"])
        laws = list(map(str, data["laws"]))
        if (
            1 <= len(axes) <= 2
            and all(name in ds.variables and spacing in SPACINGS for name, spacing in axes.items())
            and isinstance(halvings, int)
            and 0 <= halvings <= MOST_HALVINGS
            and all(0 <= float(step) < np.inf for step in watch.values())
        ):
            return {"axes": axes, "halvings": halvings, "watch": watch, "laws": laws}
    except (KeyError, ValueError, TypeError, RecursionError):
        pass
    raise InputError(f"the attribute {REFINED} does not describe the refinement of the dataset")


def describe(ds: "xr.Dataset") -> Refined:
    """The refinement of a refined dataset. Raises `InputError` where cases of it are missing or have other values."""
    data = _tell(ds)
    names = list(data["axes"])
    fields = {name: np.atleast_1d(ds[name].values).astype(float) for name in names}
    level = np.atleast_1d(ds[tables.LEVEL].values) if tables.LEVEL in ds.variables else np.zeros(0)
    coarse = {name: np.unique(values[level == 0]) for name, values in fields.items() if values.size == level.size}
    size = prod(values.size for values in coarse.values())
    lost = "the dataset has not all cases of its refined study"
    if len(coarse) < len(names) or (level == 0).sum() != size or any(values.size < 2 for values in coarse.values()):
        raise InputError(lost)
    geometric = frozenset(name for name, spacing in data["axes"].items() if spacing == "geometric")
    lattice = Lattice(coarse, geometric, data["halvings"])
    if max(lattice.sizes) > tables.MOST_PLACES:
        raise InputError(f"the attribute {REFINED} does not describe the refinement of the dataset")
    places = lattice.places(fields)
    if (places < 0).any() or not np.array_equal(lattice.levels(places), level):
        raise InputError(lost)
    return Refined(lattice, places, data["watch"], data["laws"])


def grid(values: Mapping[str, Values]) -> Refined:
    """A grid of one axis or two, axis -> values, as a refinement without halvings. Raises `InputError`."""
    if not 1 <= len(values) <= 2 or SAMPLE in values:
        has = choices(values) or "none"
        raise InputError(f"a boundary needs a refined study, or a grid of one axis or two; the axes are {has}")
    if small := [axis for axis, row in values.items() if row.size < 2]:
        raise InputError(f"a boundary needs at least two values of each axis; {small[0]} has one")
    lattice = Lattice({axis: np.sort(row) for axis, row in values.items()}, frozenset(), 0)
    return Refined(lattice, product_of([np.argsort(np.argsort(row)) for row in values.values()]), {}, [])


def raster(ds: "xr.Dataset", study: Refined, between: Mapping[str, Values]) -> "xr.Dataset":
    """The plane of a refined study as a fine grid, each point with the numbers of the case around which it lies.

    Each cell of the refinement has four quarters, and a quarter has the numbers of the case at its corner. Arrays along
    the rod are left out; `case` is the index of the case, and `level` a variable. between: real numbers of the cases,
    (cases,) each, which are further variables and vary along both axes between the corners of a cell.
    """
    lattice = study.lattice
    depth = lattice.depth
    while depth and max((size - 1) << (depth + 1) for size in lattice.shape) > MOST_DRAWN:
        depth -= 1
    cells = refinement_of(lattice, study.places, np.empty((len(study.places), 0)), np.empty(0), depth)
    index = np.empty([(size - 1) << (depth + 1) for size in lattice.shape], dtype=np.int64)
    levels = np.empty(index.shape)  # on a scale of colours, as borders between levels would hide them
    varying = {name: np.empty(index.shape) for name in between}
    for level in range(depth + 1):
        if not len(cells.cells[level]):
            continue
        side = 1 << (depth - level)  # of a quarter, in points of the raster
        low = cells.cells[level] >> (lattice.depth - depth) << 1
        square = np.indices((side, side)).reshape(2, 1, -1)
        for corner, (i, j) in zip(cells.corners(level).T, np.ndindex(2, 2), strict=True):
            at = low.T[:, :, None] + square + np.array([i, j]).reshape(2, 1, 1) * side
            index[at[0], at[1]] = corner[:, None]
            levels[at[0], at[1]] = level
        high = (np.arange(2 * side) + 0.5) / (2 * side)  # the weight of the upper end of each axis of a cell
        weights = np.stack([np.outer(*pair).ravel() for pair in product((1 - high, high), repeat=2)])
        at = low.T[:, :, None] + np.indices((2 * side, 2 * side)).reshape(2, 1, -1)
        for name, numbers in between.items():
            varying[name][at[0], at[1]] = numbers[cells.corners(level)] @ weights
    scale = 2.0 ** (lattice.depth - depth - 1)
    values = {
        name: lattice.along(name, (np.arange(size) + 0.5) * scale)
        for name, size in zip(lattice.axes, index.shape, strict=True)
    }
    each = [str(name) for name in ds.data_vars if ds[name].dims == (SAMPLE,)]
    label = {"units": "1", "long_name": "level of the drawn cell", "symbol": tables.LEVEL}
    grid = grid_of(ds[each].assign(case=(SAMPLE, np.arange(ds.sizes[SAMPLE]))), index, values)
    for name, coarse in lattice.axes.items():
        grid[name].attrs["ends"] = coarse[[0, -1]]
    further = {name: (list(values), numbers) for name, numbers in varying.items()}
    return grid.assign({tables.LEVEL: (list(values), levels, label), **further}).set_coords(["case", *further])


def _own_axes(field: "xr.DataArray") -> "xr.DataArray":
    """A field of the case along the axes with which it varies alone, as in the dataset of a grid."""
    for dim in field.dims:
        first = field.isel({dim: 0}, drop=True)
        if bool((field == first).all()):
            field = first
    return field


def grid_of(ds: "xr.Dataset", index: NDArray[np.int64], values: Mapping[str, Values]) -> "xr.Dataset":
    """The cases of these indices as a grid over axes of these values."""
    import xarray as xr

    dropped = [name for name in (SAMPLE, tables.LEVEL, *values) if name in ds.variables]
    grid = ds.drop_vars(dropped).isel({SAMPLE: xr.DataArray(index, dims=list(values))})
    for name in (name for name in OF_THE_CASE if name in grid.data_vars):
        grid[name] = _own_axes(grid[name])
    spacings = _tell(ds)["axes"]
    coords = {
        name: xr.Variable((name,), row, {**ds[name].attrs, "spacing": spacings[name]}) for name, row in values.items()
    }
    attrs = {key: value for key, value in ds.attrs.items() if key not in (REFINED, "sampled", *SAMPLING)}
    cases = grid.assign_coords(coords)
    cases.attrs = attrs
    return cases


def boundary(
    ds: "xr.Dataset", study: Refined, name: str, step: float | None, observables: Sequence[str]
) -> "xr.Dataset":
    """The boundary of a number of each case, as `StoredStudy.boundary` gives it.

    The attribute `unknown` counts the pairs of which one case has no number: they are not compared. observables: of the
    dataset, for a message. Raises `InputError` for an unknown observable, and for a real one without a step.
    """
    numbers, step = _numbers(ds, name, study.watch, step, observables)
    cells = refinement_of(study.lattice, study.places, numbers.reshape(-1, 1), np.zeros(1), study.lattice.depth)
    edges, along = cells.edges()
    change = np.abs(np.diff(cells.numbers[edges, 0], axis=1)[:, 0])
    unknown = int((np.isnan(cells.numbers[edges, 0]).sum(axis=1) == 1).sum())
    edges, along = edges[change > step], along[change > step]
    places = {}
    for k, (axis, row) in enumerate(cells.lattice.values(cells.places).items()):
        low, high = row[edges].T
        places[axis] = low, np.where(along == k, high, low)
    label = {} if name == OUTCOME else dict(ds[name].attrs)
    sides = [("pair", cells.numbers[edges[:, side], 0], label) for side in (0, 1)]
    return pairs(ds, places, sides, "cases").assign_attrs(observable=name, step=step, unknown=unknown)


def pairs(ds: "xr.Dataset", places: "Mapping[str, tuple[Values, Values]]", sides: list[Any], of: str) -> "xr.Dataset":
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


def _numbers(
    ds: "xr.Dataset", name: str, watch: Mapping[str, float], step: float | None, observables: Sequence[str]
) -> "tuple[Values, float]":
    """The numbers of an observable, of the shape of the cases, and the change that counts."""
    if name == OUTCOME:
        return ds["solved"].values.astype(float), 0.0
    known = [*observables, OUTCOME]
    if name not in ds.data_vars or ds[name].dims != ds["outcome"].dims or ds[name].dtype.kind not in "iuf":
        raise InputError(f"no observable {name!r}{near(name, known)}; the dataset has {choices(known)}")
    if step is None and name not in watch and not is_count(ds[name]):
        raise InputError(f"{name} is a real number: give the change that counts, such as step=0.1")
    step = watch.get(name, 0.0) if step is None else step
    if not 0 <= step < np.inf:
        raise InputError(f"step must be a number that is not negative, got {step}")
    return ds[name].values.astype(float), float(step)
