"""Stored studies that extend one another along an axis, merged into one file block by block."""

import contextlib
import json
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.errors import InputError, choices
from studies import Study
from studies.grammar.axes import SAMPLE, Dimension
from studies.language.loader import axis_table, dumps
from studies.language.printed import table_of
from studies.language.variation import SOURCES

from ..stored import quantity_variables, reading, schema, solved_again
from ..stored.chosen_cases import SAME
from ..words import caution_words
from . import atomic, dataset_assembly, writing
from .recipe import Places, axis_line, unite

# Attributes in which merged files may not differ, and their names in messages.
ALIKE = {
    "reading": "the reading",
    "side": "the side",
    "stiffness": "the stiffness",
    "tolerance": "the tolerance",
    "method": "the method",
    "length_unit": "the unit of length",
    "force_unit": "the unit of force",
}
MOST_NUMBERS = 1_000_000  # numbers of samples in the text of a merged study; the text of more would be too long to load
MOST_SOURCES = 5  # files of which a merged file says how their samples were drawn
# Fields of a study that are compared in the dataset, or that do not change a number.
APART = {"name", "title", "axes", *SOURCES, "base", "observables", "outputs", "stations", "tol", "method"}
OF_ONE_RUN = ("recipe", "statistics", "caution", "sampling_caution")  # attributes that are of one run alone


def merge(files: Sequence[Path], out: Path, force: bool = False) -> dict[str, Any]:
    """Merge the files into `out`; what it holds as plain data. Raises `InputError`, and then stores nothing."""
    if len(files) < 2:
        raise InputError(f"merge takes two files or more, got {len(files)}")
    if not force and any(out.exists() and out.samefile(path) for path in files if path.exists()):
        raise InputError(
            f"--out {out} is one of the files that are merged: give another name, or --force to replace it"
        )
    with contextlib.ExitStack() as stack:
        opened = [_with_results_as_data(stack.enter_context(reading.open_study(path, whole=True))) for path in files]
        studies = [solved_again.study_of(ds) for ds in opened]
        names = [str(path) for path in files]
        axis, axes = _axis(opened, studies, names), schema.axes_of(opened[0])
        union, places = unite([_dimension(ds, studies[0], axis) for ds in opened])
        attrs = _attributes(opened, studies[0], union, names, out)
        writing.check_free(out, attrs["study_name"], force)
        first = opened[0]
        lead = tuple(axes)  # a field that follows an axis has no such axis in a file with one value of it
        cases = [name for name in map(str, first.data_vars) if all(ds[name].dims[: len(lead)] == lead for ds in opened)]
        frame = _frame(opened, names, cases, axis, union, places).transpose(*axes, ..., missing_dims="ignore")
        shape = tuple(frame.sizes[dim] for dim in axes)
        sources = []
        for ds, name, place in zip(opened, names, places, strict=True):
            rows = [place if dim == axis else np.arange(n) for dim, n in zip(axes, shape, strict=True)]
            sources.append(dataset_assembly.FileSource(name, ds, cases, rows))
        variables = {name: (tuple(map(str, first[name].dims)), first[name].attrs) for name in cases}
        along = axes.index(axis)

        def name_of(case: int) -> str:
            return f"{axis} = {union.coordinate[np.unravel_index(case, shape)[along]]:.10g}"

        with atomic.refusing(out), atomic.replacement(out) as aside:
            statistics = dataset_assembly.combine(
                sources, frame.assign_attrs(attrs), variables, aside, _recipe(opened, union), name_of=name_of
            )
    unsolved, laws, caution = statistics["unsolved"], statistics["laws"], caution_words.tell(statistics["cautions"])
    counts = {"cases": prod(shape), "unsolved": unsolved, "laws": laws, "caution": caution}
    return {"file": str(out), "axis": axis, "values": union.size, **counts}


def _with_results_as_data(ds: xr.Dataset) -> xr.Dataset:
    """The dataset in which a result is no coordinate, as it may be in a file that another program has stored."""
    coordinates = {"s", *ds.dims, *map(quantity_variables.dimension, schema.fields_of_samples(ds))}
    return ds.reset_coords([name for name in ds.coords if name not in coordinates])


def _dimension(ds: xr.Dataset, study: Study, axis: str) -> Dimension:
    """An axis of a file by the study's field, or its samples."""
    if axis == SAMPLE:
        return Dimension(SAMPLE, solved_again.samples_of(ds))
    field = quantity_variables.field_of(study, axis)
    return Dimension(field, {field: ds[axis].values})


def _frame(
    files: Sequence[xr.Dataset],
    names: Sequence[str],
    cases: Sequence[str],
    axis: str,
    union: Dimension,
    places: Sequence[Places],
) -> xr.Dataset:
    """The dataset of all that is not stored of each case.

    A field of the case is stored without an axis of one value; it gets that axis if the files differ in it. Raises
    `InputError` where two files differ at the same values.
    """
    parts = [ds.drop_vars(cases) for ds in files]
    every = xr.concat(
        parts,
        axis,
        data_vars="different",
        coords="different",
        compat="equals",
        join="override",
        combine_attrs="override",
    )
    begins = np.cumsum([0, *(ds.sizes[axis] for ds in files[:-1])])
    rows = [np.where(place < 0, -1, place + begin) for place, begin in zip(places, begins, strict=True)]
    first = np.stack(rows)[np.argmax(np.stack(rows) >= 0, axis=0), np.arange(union.size)]
    frame = every.isel({axis: first})
    for name, row in zip(names, rows, strict=True):
        mine = np.flatnonzero(row >= 0)
        again, before = every.isel({axis: row[mine]}), frame.isel({axis: mine})
        for key in [key for key in frame.variables if key != axis]:
            if not again[key].variable.equals(before[key].variable):  # not the numbers of samples
                words = f"hold the same values of {axis}, but with other values of {key}"
                raise InputError(f"{names[0]} and {name} {words}")
    return frame.assign_coords({axis: (axis, union.coordinate, files[0][axis].attrs)})


def _axis(files: Sequence[xr.Dataset], studies: Sequence[Study], names: Sequence[str]) -> str:
    """The one axis in which the files differ. Raises `InputError` where anything else differs."""
    for ds, study, name in zip(files[1:], studies[1:], names[1:], strict=True):
        for what, (a, b) in _differences(files[0], studies[0], ds, study).items():
            if a != b:
                raise InputError(f"{names[0]} and {name} differ in {what}: {_said(a)} and {_said(b)}")
        for held, other, (this, that) in ((files[0], ds, (names[0], name)), (ds, files[0], (name, names[0]))):
            if more := [str(key) for key in held.variables if key not in other.variables]:
                raise InputError(
                    f"the files differ in what is stored: {this} has {choices(more)}, which {that} has not"
                )
    if studies[0].variation.from_base:
        raise InputError(f"{names[0]} follows an equilibrium up to its fold, which cannot be merged")
    if studies[0].refine is not None:
        raise InputError(f"{names[0]} is a refined study, whose cases belong together; run it with a finer tolerance")
    if studies[0].sweeps:
        way_out = "run all values as one study; --part 1/2 and 2/2 divide it between two machines"
        raise InputError(
            f"{names[0]} is a sweep of ends problems, whose branches are numbered over the whole grid: {way_out}"
        )
    axes = schema.axes_of(files[0])
    differing = [axis for axis in axes if any(_values(files[0], axis) != _values(ds, axis) for ds in files[1:])]
    if len(differing) > 1:
        raise InputError(f"the files differ along {' and '.join(differing)}; merge along one axis at a time")
    if not differing:
        what = f"the same values of {choices(axes)}" if axes else "one case each, and no axis"
        raise InputError(f"there is nothing to merge: {choices(names)} have {what}")
    if differing != [SAMPLE]:
        values = np.unique([value for ds in files for value in ds[differing[0]].values])
        close = np.flatnonzero(np.diff(values) <= SAME * np.abs(values[1:]))
        if close.size:
            a, b = values[close[0] : close[0] + 2]
            raise InputError(f"{differing[0]} = {a} and {b} differ in their last digits only; make them the same value")
    return differing[0]


def _values(ds: xr.Dataset, axis: str) -> list[bytes]:
    """The values of an axis, those of the samples by their fields, to the bit."""
    names = map(quantity_variables.dimension, schema.fields_of_samples(ds)) if axis == SAMPLE else [axis]
    return [ds[name].values.tobytes() for name in names]


def _stations(ds: xr.Dataset) -> list[float]:
    return list(ds["u"].values.tolist()) if "u" in ds.variables else []


def _differences(a: xr.Dataset, of_a: Study, b: xr.Dataset, of_b: Study) -> dict[str, tuple[Any, Any]]:
    """What must be equal in two files: its name in messages -> the two values."""
    pairs: dict[str, tuple[Any, Any]] = {"the axes": (schema.axes_of(a), schema.axes_of(b))}
    pairs |= {what: (a.attrs.get(key), b.attrs.get(key)) for key, what in ALIKE.items()}
    pairs["the sampled fields"] = (list(of_a.variation.sampled), list(of_b.variation.sampled))
    pairs["the stations"] = (a.sizes.get("u", 0), b.sizes.get("u", 0))
    pairs["the places of the stations"] = (_stations(a), _stations(b))
    base = [{**table_of(study.reading), **study.base.given} for study in (of_a, of_b)]
    for name in dict.fromkeys([*base[0], *base[1]]):
        if name not in of_a.variation.fields:
            pairs[f"base.{name}"] = (base[0].get(name), base[1].get(name))
    said = [study.model_dump(exclude=APART) for study in (of_a, of_b)]
    return pairs | {key: (said[0][key], said[1][key]) for key in said[0]}


def _said(value: Any) -> str:
    """A value as a message shows it, at most 60 characters."""
    if isinstance(value, list) and all(isinstance(word, str) for word in value):
        return choices(value) or "none"
    text = "nothing" if value is None or value == "" else str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _attributes(
    files: Sequence[xr.Dataset], study: Study, union: Dimension, names: Sequence[str], out: Path
) -> dict[str, Any]:
    """The attributes of the merged file: those of the first, with the text of the study over all values.

    More than `MOST_NUMBERS` numbers of samples are not listed: the text names a table, and the samples are those of the
    file.
    """
    attrs = {key: value for key, value in files[0].attrs.items() if key not in OF_ONE_RUN}
    axis = union.name
    if axis != SAMPLE:
        axis = quantity_variables.dimension(axis)
        text = dumps(study, axes={union.name: axis_table(union.fields[union.name])})
    else:
        attrs["sampling"] = _origin_of_samples(files, union)
        if union.size * len(union.fields) <= MOST_NUMBERS:
            text = dumps(study, zip={name: values.tolist() for name, values in union.fields.items()})
        else:
            text = dumps(study, table={"file": f"{out.stem}.csv", "columns": [*union.fields]})
    versions = [schema.versions_of(ds, name) for ds, name in zip(files, names, strict=True)]
    sources = [
        {"file": Path(name).name, "created": str(ds.attrs.get("created", "")), axis: ds.sizes[axis]}
        for ds, name in zip(files, names, strict=True)
    ]
    return {
        **attrs,
        "format": schema.FORMAT,
        "study": text,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": json.dumps(_together(versions)),
        "merged": json.dumps(sources),
    }


def _origin_of_samples(files: Sequence[xr.Dataset], union: Dimension) -> str:
    """Where the samples of the union come from, in one sentence."""
    each = list(dict.fromkeys(str(ds.attrs.get("sampling", "")) for ds in files))
    more = [f"and {len(each) - MOST_SOURCES} more"] if len(each) > MOST_SOURCES else []
    whence = "; ".join([*each[:MOST_SOURCES], *more])
    return f"{union.size} samples of {choices(union.fields)}, merged from: {whence}"


def _together(versions: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The versions of all files; where they differ, each of them."""
    packages = dict.fromkeys(package for row in versions for package in row)
    return {name: ", ".join(dict.fromkeys(row[name] for row in versions if name in row)) for name in packages}


def _recipe(files: Sequence[xr.Dataset], union: Dimension) -> dict[str, Any] | None:
    """The recipe of a run of all values, so that a later run can extend the merged file; None where it may not.

    It may where every file was stored by a run, with the same code and libraries.
    """
    try:
        recipes = [json.loads(ds.attrs["recipe"]) for ds in files]
        for recipe in recipes:
            recipe["axes"] |= {name: axis_line(row) for name, row in union.fields.items()}
    except (KeyError, TypeError, ValueError, RecursionError):
        return None
    return dict(recipes[0]) if all(recipe == recipes[0] for recipe in recipes) else None
