"""The tables of influence as plain data, for JSON, and as rows, for CSV."""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from ..store import atomic

_LOCAL = ("observable", "value", "unit", "field", "at", "field_unit", "derivative", "derivative_unit", "effect",
          "effect_unit", "amount", "remark")  # fmt: skip
_GLOBAL = ("observable", "field", "first", "first_conf", "total", "total_conf", "blocks", "lost", "remark")
_PAIRS = ("observable", "field", "other", "second", "second_conf")


def rows(ds: xr.Dataset) -> list[dict[str, Any]]:
    """A row for each observable and field, of a dataset of `local` or `sobol`."""
    return _rows(ds, _LOCAL if "derivative" in ds else _GLOBAL, ("observable", "field"))


def pairs(ds: xr.Dataset) -> list[dict[str, Any]]:
    """A row for each observable and pair of fields; none where the design does not tell pairs apart."""
    if "second" not in ds:
        return []
    every = _rows(ds[["second", "second_conf"]], _PAIRS, ("observable", "field", "other"))
    order = {name: i for i, name in enumerate(ds["field"].values.tolist())}
    return [row for row in every if order[row["field"]] < order[row["other"]]]


def plain(ds: xr.Dataset) -> dict[str, Any]:
    """Rows, pairs and attributes as plain data."""
    table: dict[str, Any] = {**ds.attrs, "rows": rows(ds)}
    return {**table, "pairs": pairs(ds)} if "second" in ds else table


def write(ds: xr.Dataset, path: Path) -> None:
    """Write the rows as CSV in full precision; those of pairs follow in the columns other, second, second_conf."""
    lines = [*rows(ds), *pairs(ds)]
    columns = list(dict.fromkeys(name for row in lines for name in row))

    def work(aside: Path) -> None:
        with aside.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, columns, restval="")
            writer.writeheader()
            writer.writerows(lines)

    atomic.write(path, work)


def _rows(ds: xr.Dataset, columns: Sequence[str], dims: Sequence[str]) -> list[dict[str, Any]]:
    """The columns, which are variables or dimensions, over the product of the dimensions."""
    table = ds[[name for name in columns if name not in dims]].to_dataframe(dim_order=dims)
    rows: list[dict[str, Any]] = table.reset_index()[[*columns]].to_dict("records")
    return rows
