"""The recipe of a run: all that its numbers depend on, by which a later run knows whether it continues this one.

Also the run that stored a file, and the values along a dimension that several parts of a study hold.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

import solver
import studies
from solver.methods import FREE, METHODS, VARYING, available
from solver.problem.errors import InputError
from studies import Study
from studies.grammar.axes import SAMPLE, Dimension, Dimensions

from ..stored import file_checks
from ..stored.boxes import Columns
from ..stored.provenance import version_of
from ..stored.quantity_variables import dimension
from ..stored.schema import FORMAT

Places = NDArray[np.int64]

_ROUNDING = 8 * 2.0**-52  # relative; values of an axis that differ by less are the same


def recipe_of(study: Study, dimensions: Dimensions, block: int) -> dict[str, Any]:
    """Everything the numbers depend on, as it comes back from JSON.

    Two runs of one recipe give the same bits on the same kind of machine.
    """
    required = [METHODS[study.method].requires] if study.method in METHODS and METHODS[study.method].requires else []
    given = [law.model_dump(exclude_defaults=True) for law in study.laws]
    laws = {str(i): ", ".join(f"{key} {value}" for key, value in law.items()) for i, law in enumerate(given, 1)}
    data = {
        "units": study.unit_system,
        "reading": study.reading or "",
        "base": study.base.given,
        **({"let_go": True} if study.let_go else {}),
        "equilibrium": study.equilibrium.model_dump(exclude_none=True) if study.equilibrium else {},
        "order": list(dimensions.names),
        "axes": {name: axis_line(values) for name, values in dimensions.fields.items()},
        **({} if study.refine is None else {"refine": _refine_lines(study)}),
        **_follow_line(study),
        "stations": study.stations,
        "outputs": sorted(study.outputs),
        "observables": sorted(study.wanted),
        "expressions": dict(study.expressions),
        "laws": laws,  # their verdicts are stored as well
        "tol": study.tol,
        "method": study.method,
        "block": block,
        "code": code_version(),
        **{package: version_of(package) for package in ("numpy", "scipy", *required, *["unopy"] * study.leaves)},
    }
    plain: dict[str, Any] = json.loads(json.dumps(data))
    return plain


def differences(was: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """The differences of two recipes in words: ``tol was 1e-08, now 1e-09``."""
    sentences = []
    for key in dict.fromkeys([*was, *now]):
        before, after = was.get(key), now.get(key)
        if isinstance(before, dict) and isinstance(after, dict):
            sentences += [f"{key}.{difference}" for difference in differences(before, after)]
        elif before != after:
            sentences.append(f"{key} was {_tell(before)}, now {_tell(after)}")
    return sentences


@cache
def code_version() -> str:
    """The version of the package and a digest of the sources that make the numbers."""
    mechanics, language = Path(solver.__file__).parent, Path(studies.__file__).parent
    sources = [*mechanics.rglob("*.py"), *mechanics.rglob("*.[ch]"), *language.rglob("*.py")]
    content = b"".join(path.name.encode() + path.read_bytes() for path in sorted(sources))
    return f"{version_of('rod-workbench')}+{_digest(content)}"


def check_worker(study: Study, code: str) -> None:
    """Raise `InputError` where this process would give other numbers: other code, or a method that is missing."""
    if code_version() != code:
        raise InputError(f"a worker has the code {code_version()}, but the run was started with {code}")
    if study.method not in (*available(), *VARYING.values(), FREE):
        raise InputError(f"a worker has no method {study.method!r}: install there what is installed here")


def versions_of_code() -> set[str]:
    """The keys of a recipe that are not the study: code, packages, block."""
    return {"code", "numpy", "scipy", "unopy", "block", *(method.requires for method in METHODS.values())}


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=6).hexdigest()


def axis_line(values: NDArray[np.float64]) -> str:
    """An axis in one line, with a digest of its values."""
    return f"{values.size} values {values[0]:g}..{values[-1]:g} ({_digest(values.tobytes())})"


def _follow_line(study: Study) -> dict[str, Any]:
    """The followed axis; of a start problem its limit and size, as the run finds its values."""
    name = study.variation.followed
    if name is None or not study.variation.from_base:
        return {} if name is None else {"follow": name}
    return {"follow": {"axis": name, "to": study.axes[name].limit, "count": study.axes[name].size}}


def _refine_lines(study: Study) -> dict[str, Any]:
    """The refinement: its keys, the coarse grid, and how often that is halved."""
    assert study.refine is not None
    grid = study.refine.lattice(study.axes)
    lines = {name: axis_line(values) for name, values in grid.axes.items()}
    return {
        **lines,
        "geometric": sorted(grid.geometric),
        "watch": study.refine.changes,
        "laws": study.refine.laws,
        "halvings": grid.depth,
        "budget": study.refine.budget,
    }


def _tell(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(str, value)) or "none"
    return "missing" if value is None else str(value)


@dataclass(frozen=True, eq=False)
class StoredRun:
    """A complete file: its path, its study's name, its recipe, its samples and axes, and its statistics."""

    path: Path
    name: str
    recipe: dict[str, Any]
    dimensions: Dimensions
    statistics: dict[str, Any]

    def read(self, names: Iterable[str]) -> Columns:
        """Variables of each case, (cases,)."""
        with file_checks.open_valid(self.path) as (file, _):
            return {name: file[name][...] for name in names}


def look(path: Path) -> StoredRun | None:
    """The run that stored the file; None where there is no file of this format that was stored by a run.

    Raises `InputError` for a file of a newer format.
    """
    try:
        with file_checks.open_valid(path) as (file, held):
            version = np.asarray(file.attrs["format"]).item()
            stored = _read(file, path) if version == FORMAT else None
            file_checks.check_sums(held, path, arrays=False)
    except InputError:
        return None
    if version > FORMAT:
        raise InputError(f"{path} is of format {version}, but this version reads format {FORMAT}")
    return stored


def _read(file: h5py.File, path: Path) -> StoredRun | None:
    recipe, statistics = (json.loads(file.attrs[name]) for name in ("recipe", "statistics"))
    fields = {name: np.asarray(file[dimension(name)][...], dtype=float) for name in recipe["axes"]}
    if any(recipe["axes"][name] != axis_line(values) for name, values in fields.items()):
        return None  # changed since by another program
    axes = {name: fields.pop(name) for name in recipe["order"] if name != SAMPLE}
    samples = Dimension(SAMPLE, fields) if SAMPLE in recipe["order"] else None
    return StoredRun(path, str(file.attrs["study_name"]), recipe, Dimensions.of(axes, samples), statistics)


def unite(parts: Sequence[Dimension]) -> tuple[Dimension, list[Places]]:
    """The values that parts of a study have along a dimension, each once; and the index of each in each part, or -1.

    Those of an axis rise, samples keep their order. A value is known to the bit; a sample that a part has several times
    stays so.
    """
    import pandas as pd

    name, fields = parts[0].name, [*parts[0].fields]
    rows = [pd.DataFrame({field: part.fields[field] for field in fields}) for part in parts]
    rows = [row.assign(repetition=row.groupby(fields, sort=False).cumcount()) for row in rows]
    union = pd.concat(rows).drop_duplicates()
    union = union if name == SAMPLE else union.sort_values(fields)
    values = pd.MultiIndex.from_frame(union)
    places = [pd.MultiIndex.from_frame(row).get_indexer(values) for row in rows]
    return Dimension(name, {field: union[field].to_numpy() for field in fields}), places


def extend(old: Dimensions, new: Dimensions) -> tuple[Dimensions, list[Places]] | None:
    """The new dimensions, with the old values to the last digit, and the index of each value among the old, or -1.

    None where they do not extend the old ones: a value is not among the new, or samples do not begin with the old.
    """
    each, places = [], []
    for before, now in zip(old.each, new.each, strict=True):
        if before == now:  # as of most complete files; the union needs pandas
            each.append(before)
            places.append(np.arange(now.size))
            continue
        if tuple(before.fields) != tuple(now.fields):
            return None
        union, (held, order) = unite([before, now if now.name == SAMPLE else _with_digits_of(before, now)])
        if union.size > now.size or (now.name == SAMPLE and (np.diff(order) < 0).any()):
            return None
        back = np.argsort(order)
        each.append(union.only(back))
        places.append(held[back])
    return Dimensions(tuple(each)), places


def _with_digits_of(old: Dimension, new: Dimension) -> Dimension:
    """An axis with the old values in place of new ones that differ from them by rounding."""
    known, values = np.sort(old.fields[old.name]), new.fields[new.name]
    nearest = known[np.searchsorted((known[1:] + known[:-1]) / 2, values)]
    same = np.abs(nearest - values) <= _ROUNDING * np.abs(values)
    return Dimension(new.name, {new.name: np.where(same, nearest, values)})
