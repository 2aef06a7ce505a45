"""Tables of cases, CSV or Parquet: a column for each field, a row for each case."""

import csv
import stat
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from solver.problem.declared_fields import ALL_FIELDS
from solver.problem.errors import InputError, choices, near

from ..grammar.axes import MAX_COUNT, STRICT, Line, Values, number_of

NUMERIC = [name for name, row in ALL_FIELDS.items() if not row.choices]
SUFFIXES = (".csv", ".parquet")
MOST_BYTES = 4_000_000_000


def read(
    path: Path,
    columns: Sequence[str] | None = None,
    known: Sequence[str] = NUMERIC,
    of: str = "field of a case",
    row: str = "case",
) -> dict[str, Values]:
    """The columns of a table of cases, or of other numbers, (rows,) each, angles in rad.

    Parameters
    ----------
    path : Path
        A .csv file with a line of names, or a .parquet file (which needs the package pyarrow).
    columns : sequence of str, optional
        The columns that are read; default: all.
    known, of, row : sequence of str, str, str
        The names that a column may have, what they name, and what a row describes.

    Raises
    ------
    InputError
        For a file that cannot be read, a missing or repeated column, no rows, or a cell without a finite number.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(f"a table is a file that ends in {choices(SUFFIXES)}, got {path.name!r}")
    _check_file(path)
    if path.suffix.lower() == ".csv":
        return _csv(path, columns, known, of, row)
    return _parquet(path, columns, known, of)


def _check_file(path: Path) -> None:
    """Raise `InputError` unless it is a regular file of at most `MOST_BYTES`."""
    try:
        status = path.stat()
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read the table {path}: {getattr(error, 'strerror', None) or error}") from None
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"cannot read the table {path}: it is not a regular file")
    if status.st_size > MOST_BYTES:
        raise InputError(f"{path.name} has {status.st_size} bytes; the limit is {MOST_BYTES}")


def _csv(path: Path, chosen: Sequence[str] | None, known: Sequence[str], of: str, row: str) -> dict[str, Values]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = csv.reader(file, strict=True)
            header = [name.strip() for name in next(rows, [])]
            if not header:
                raise InputError(f"{path.name} is empty: give a line of names, and below it a line for each {row}")
            if len(header) == 1 and ";" in header[0]:
                raise InputError(f"{path.name}: columns are separated by commas, not semicolons, got {header[0]!r:.60}")
            names = _choose(path, header, chosen, known, of)
            return _numbers(path, names, [header.index(name) for name in names], len(header), rows, row)
    except UnicodeDecodeError:
        raise InputError(f"{path.name} is not a text file in UTF-8") from None
    except csv.Error as error:
        raise InputError(f"{path.name} is not a table in CSV: {error}") from None
    except OSError as error:
        raise InputError(f"cannot read the table {path}: {error.strerror}") from None


def _numbers(path: Path, names: list[str], places: list[int], width: int, rows: Any, row: str) -> dict[str, Values]:
    """The numbers of the columns at these places. Raises `InputError` with the line, the row and the column."""
    columns: dict[str, list[float]] = {name: [] for name in names}
    count = 0
    for count, cells in enumerate(filter(None, rows), 1):  # without blank lines
        try:
            if len(cells) != width:
                raise InputError(f"expected {width} cells, as the line of names has, got {len(cells)}")
            for place, (name, column) in zip(places, columns.items(), strict=True):
                column.append(_number(name, cells[place]))
        except InputError as error:
            raise InputError(f"{path.name}, line {rows.line_num} (row {count}): {error}") from None
        if count > MAX_COUNT:
            raise InputError(f"{path.name} has more rows than the limit of {MAX_COUNT}")
    if not count:
        raise InputError(f"{path.name} has no rows: give a line for each {row} below the line of names")
    return {name: np.array(column) for name, column in columns.items()}


def _number(name: str, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:  # an angle, maybe
        value = number_of(name.removeprefix("sigma_"), cell.strip())
    if isfinite(value):
        return value
    if not cell.strip():
        raise InputError(f"{name} is empty; give each row a number")
    raise InputError(f"{name} must be a finite number, got {cell.strip()[:60]!r}")


def _parquet(path: Path, chosen: Sequence[str] | None, known: Sequence[str], of: str) -> dict[str, Values]:
    try:
        from pyarrow import ArrowException, parquet
    except ImportError:
        raise InputError(
            f"reading {path.name} needs pyarrow: pip install 'rod-workbench[parquet]', or store the table as CSV"
        ) from None
    try:
        header = list(parquet.read_schema(path).names)
        names = _choose(path, header, chosen, known, of)
        table = parquet.read_table(path, columns=names)
        columns: Mapping[str, Any] = {name: table[name].to_numpy() for name in names}
    except (ArrowException, OSError) as error:
        raise InputError(f"{path.name} cannot be read as Parquet: {str(error).splitlines()[0]}") from None
    if not table.num_rows:
        raise InputError(f"{path.name} has no rows")
    if table.num_rows > MAX_COUNT:
        raise InputError(f"{path.name} has more rows than the limit of {MAX_COUNT}")
    return {name: _check(path, name, values) for name, values in columns.items()}


def _check(path: Path, name: str, values: Any) -> Values:
    """A column of a Parquet file as numbers. Raises `InputError` with the row."""
    if values.dtype.kind not in "iuf":
        raise InputError(f"{path.name}: the column {name} must hold numbers, got {values.dtype}")
    numbers = values.astype(float)
    bad = np.flatnonzero(~np.isfinite(numbers))
    if bad.size:
        raise InputError(f"{path.name}, row {bad[0] + 1}: {name} is empty or not finite; give each row a number")
    return numbers


def _choose(path: Path, header: list[str], chosen: Sequence[str] | None, known: Sequence[str], of: str) -> list[str]:
    """The names of the columns to read. Raises `InputError` for one that is missing, empty or repeated."""
    names = list(header if chosen is None else chosen)
    for name in names:
        if name not in header:
            raise InputError(f"{path.name} has no column {name!r}; its columns are {choices(header)}")
        if not name:
            raise InputError(f"{path.name} has a column without a name; its columns are {choices(header)}")
        if header.count(name) > 1 or names.count(name) > 1:
            raise InputError(f"{path.name} has the column {name!r} twice")
        if name not in known:
            also = ", or list the columns to be read in [table] columns" if known is NUMERIC else ""
            listed = f"choose from {choices(known)}{also}"
            raise InputError(f"{path.name}: the column {name!r} is no {of}{near(name, known)}; {listed}")
    if not names:
        raise InputError(f"no column of {path.name} is to be read; its columns are {choices(header)}")
    return names


class Table(BaseModel):
    """A table of cases. file: .csv or .parquet, in the folder of the study; columns: those read; default: all."""

    model_config = STRICT

    file: Line
    columns: list[str] | None = None
