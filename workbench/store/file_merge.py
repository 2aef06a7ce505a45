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
from studies import TABLE_1, Study
from studies.grammar.axes import SAMPLE, Dimension
from studies.language.loader import axis_table, dumps, loads
from studies.language.study_data import SOURCES

from ..words import cautions
from . import (
    assembly,
    atomic,
    attributes,
    axis_union,
    reading,
    schema,
    stored_case,
    writing,
)
from .axis_union import Union
from .plan import SPARE, TEXT_BYTES
from .recipe import axis_line
from .selection import SAME

# Attributes in which merged files may not differ, and their names in messages.
ALIKE = {
    "reading": "the reading", "side": "the side", "stiffness": "the stiffness", "tolerance": "the tolerance",
    "method": "the method", "length_unit": "the unit of length", "force_unit": "the unit of force",
}  # fmt: skip
MOST_LISTED = 1_000_000  # numbers of samples in the text of a merged study; the text of more would be too long to load
MOST_SOURCES = 5  # files of which a merged file says how their samples were drawn
# Fields of a study that are compared in the dataset, or that do not change a number.
APART = {"name", "title", "axes", *SOURCES, "base", "observables", "outputs", "stations", "tol", "method"}
OF_ONE_RUN = ("recipe", "statistics", "caution", "sampling_caution")  # attributes that are of one run alone


def merge(files: Sequence[Path], out: Path, force: bool = False) -> dict[str, Any]:
    """Merge the files into `out`; what it holds as plain data. Raises `InputError`, and then stores nothing."""
    if len(files) < 2:
        raise InputError(f"merge takes two files or more, got {len(files)}")
    with contextlib.ExitStack() as stack:
        opened = [stack.enter_context(reading.open_study(path, whole=True)) for path in files]
        studies = [stored_case.study_of(ds) for ds in opened]
        names = [str(path) for path in files]
        union = _union(opened, studies, names)
        attrs = _attributes(opened, studies[0], union, names, out)
        writing.check_parent(out)
        if not force:
            writing.check_free(out, attrs["study_name"])
        axes = schema.axes_of(opened[0])
        frame, cases = axis_union.layout(opened, names, union, axes)
        shape = tuple(frame.sizes[axis] for axis in axes)
        sources = [_source(k, opened, names, cases, union, shape) for k in range(len(opened))]
        variables = [_case_variable(name, opened) for name in cases]
        size = sum(_bytes_a_case(opened[0][name], len(axes)) for name in cases)
        most = int(1.02 * (frame.nbytes + prod(shape) * size)) + SPARE
        recipe = _recipe(opened, schema.field_of(studies[0], union.axis), union)
        windows = assembly.gather(sources, shape, size, (axes.index(union.axis), union.axis, union.values))
        with atomic.refusing(out), atomic.replacement(out) as aside:
            frame = frame.assign_attrs(attrs)
            statistics = assembly.store_cases(frame, aside, most, variables, shape, windows, recipe)
    unsolved, laws, caution = statistics["unsolved"], statistics["laws"], cautions.tell(statistics["cautions"])
    counts = {"cases": prod(shape), "unsolved": unsolved, "laws": laws, "caution": caution}
    return {"file": str(out), "axis": union.axis, "values": int(union.values.size), **counts}


def _source(
    k: int, files: Sequence[xr.Dataset], names: Sequence[str], cases: Sequence[str], union: Union,
    shape: tuple[int, ...],
) -> assembly.FileSource:  # fmt: skip
    """The cases of file `k` in the grid of the union."""
    axes = schema.axes_of(files[k])
    places = [union.places[k] if a == union.axis else np.arange(n) for a, n in zip(axes, shape, strict=True)]
    return assembly.FileSource(names[k], files[k], cases, places)


def _bytes_a_case(variable: xr.DataArray, axes: int) -> int:
    """Bytes of a case of a variable in the file, at most."""
    return prod(variable.shape[axes:]) * (8 if variable.dtype.kind in "biuf" else TEXT_BYTES)


def _case_variable(name: str, files: Sequence[xr.Dataset]) -> schema.CaseVariable:
    """A variable of each case, labelled as in the first file; whole numbers stay whole where all are."""
    first, kinds = files[0][name], [ds[name].dtype for ds in files]
    dtype = None if any(kind.kind not in "biuf" for kind in kinds) else np.result_type(*kinds)
    return schema.CaseVariable(name, tuple(map(str, first.dims)), first.attrs, dtype)


def _union(files: Sequence[xr.Dataset], studies: Sequence[Study], names: Sequence[str]) -> Union:
    """The union of the one axis in which the files differ. Raises `InputError` where anything else differs."""
    for ds, study, name in zip(files[1:], studies[1:], names[1:], strict=True):
        for what, (a, b) in _differences(files[0], studies[0], ds, study).items():
            if a != b:
                raise InputError(f"{names[0]} and {name} differ in {what}: {_said(a)} and {_said(b)}")
        for held, other, (this, that) in ((files[0], ds, (names[0], name)), (ds, files[0], (name, names[0]))):
            if more := [str(key) for key in held.variables if key not in other.variables]:
                raise InputError(
                    f"the files differ in what is stored: {this} has {choices(more)}, which {that} has not"
                )
    axes = schema.axes_of(files[0])
    if studies[0].follow is not None:
        raise InputError(f"{names[0]} follows an equilibrium up to its fold, which cannot be merged")
    if studies[0].refine is not None:
        raise InputError(f"{names[0]} is a refined study, whose cases belong together; run it with a finer tolerance")
    if studies[0].sweeps:
        why = "its branches are numbered over the whole grid: run all values as one study"
        raise InputError(f"{names[0]} is a sweep of ends problems, {why}")
    differing = [axis for axis in axes if any(_values(files[0], axis) != _values(ds, axis) for ds in files[1:])]
    if len(differing) > 1:
        raise InputError(f"the files differ along {' and '.join(differing)}; merge along one axis at a time")
    if not differing:
        what = f"the same values of {choices(axes)}" if axes else "one case each, and no axis"
        raise InputError(f"there is nothing to merge: {choices(names)} have {what}")
    if differing == [SAMPLE]:
        return axis_union.unite_samples([stored_case.samples_of(ds) for ds in files])
    union = axis_union.unite(differing[0], [ds[differing[0]].values for ds in files])
    close = np.flatnonzero(np.diff(union.values) <= SAME * np.abs(union.values[1:]))
    if close.size:
        a, b = union.values[close[0] : close[0] + 2]
        raise InputError(f"{union.axis} = {a} and {b} differ in their last digits only; make them the same value")
    return union


def _values(ds: xr.Dataset, axis: str) -> list[bytes]:
    """The values of an axis, those of the samples by their fields, to the bit."""
    names = map(schema.dimension, schema.fields_of_samples(ds)) if axis == SAMPLE else [axis]
    return [ds[name].values.tobytes() for name in names]


def _differences(a: xr.Dataset, of_a: Study, b: xr.Dataset, of_b: Study) -> dict[str, tuple[Any, Any]]:
    """What must be equal in two files: its name in messages -> the two values."""
    pairs: dict[str, tuple[Any, Any]] = {"the axes": (schema.axes_of(a), schema.axes_of(b))}
    pairs |= {what: (a.attrs.get(key), b.attrs.get(key)) for key, what in ALIKE.items()}
    pairs["the sampled fields"] = (list(of_a.sampled), list(of_b.sampled))
    pairs["the stations"] = (a.sizes.get("u", 0), b.sizes.get("u", 0))
    base = [{**(TABLE_1 if study.reading else {}), **study.base.given} for study in (of_a, of_b)]
    for name in dict.fromkeys([*base[0], *base[1]]):
        if name not in of_a.varied:
            pairs[f"base.{name}"] = (base[0].get(name), base[1].get(name))
    said = [study.model_dump(exclude=APART) for study in (of_a, of_b)]
    return pairs | {key: (said[0][key], said[1][key]) for key in said[0]}


def _said(value: Any) -> str:
    """A value as a message shows it, at most 60 characters."""
    if isinstance(value, list) and all(isinstance(word, str) for word in value):
        return choices(value) or "none"
    text = "nothing" if value is None else str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _attributes(
    files: Sequence[xr.Dataset], study: Study, union: Union, names: Sequence[str], out: Path
) -> dict[str, Any]:
    """The attributes of the merged file: those of the first, with the study over all values, which is read again."""
    context = None
    attrs = {key: value for key, value in files[0].attrs.items() if key not in OF_ONE_RUN}
    if union.fields:
        text, context = _text_with_samples(study, union, out)
        fields = union.fields
        attrs["sampling"] = _origin_of_samples(files, union)
    else:
        field = schema.field_of(study, union.axis)
        text = dumps(study, axes={field: axis_table(union.values)})
        fields = {field: union.values}
    again = loads(text, "the merged study", study.name, context).coordinates()
    assert all(np.array_equal(values, again[name] if union.fields else np.sort(again[name]))
               for name, values in fields.items())  # fmt: skip
    versions = [attributes.versions(ds, name) for ds, name in zip(files, names, strict=True)]
    sources = [
        {"file": Path(name).name, "created": str(ds.attrs.get("created", "")), union.axis: ds.sizes[union.axis]}
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


def _text_with_samples(study: Study, union: Union, out: Path) -> tuple[str, dict[str, Any] | None]:
    """The text of the study with the samples of the union, and the context in which it loads.

    More than `MOST_LISTED` numbers are not listed: the text names a table, and the samples are those of the file.
    """
    if union.values.size * len(union.fields) <= MOST_LISTED:
        return dumps(study, zip={name: values.tolist() for name, values in union.fields.items()}), None
    text = dumps(study, table={"file": f"{out.stem}.csv", "columns": [*union.fields]})
    return text, {"samples": Dimension(SAMPLE, union.fields)}


def _origin_of_samples(files: Sequence[xr.Dataset], union: Union) -> str:
    """Where the samples of the union come from, in one sentence."""
    each = list(dict.fromkeys(str(ds.attrs.get("sampling", "")) for ds in files))
    more = [f"and {len(each) - MOST_SOURCES} more"] if len(each) > MOST_SOURCES else []
    whence = "; ".join([*each[:MOST_SOURCES], *more])
    return f"{union.values.size} samples of {choices(union.fields)}, merged from: {whence}"


def _together(versions: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The versions of all files; where they differ, each of them."""
    packages = dict.fromkeys(package for row in versions for package in row)
    return {name: ", ".join(dict.fromkeys(row[name] for row in versions if name in row)) for name in packages}


def _recipe(files: Sequence[xr.Dataset], field: str, union: Union) -> dict[str, Any] | None:
    """The recipe of a run of all values, so that a later run can extend the merged file; None where it may not.

    It may where every file was stored by a run, with the same code and libraries.
    """
    try:
        recipes = [json.loads(ds.attrs["recipe"]) for ds in files]
        for recipe in recipes:
            recipe["axes"] |= {name: axis_line(row) for name, row in (union.fields or {field: union.values}).items()}
    except (KeyError, TypeError, ValueError, RecursionError):
        return None
    return dict(recipes[0]) if all(recipe == recipes[0] for recipe in recipes) else None
