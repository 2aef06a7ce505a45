"""The summary of a stored dataset that is no study: lists of equilibria, branches, fold maps, measurements."""

import os
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ..data import cautions, kinds, reading, writing

SENTENCES = ("stability", "begin", "end", "remark", "searched")  # attributes that are printed as they are


def contents(path: Path) -> dict[str, Any]:
    """What the file holds, as plain data. Raises `InputError`."""
    ds = writing.read(path, study=False)
    numbers = [str(name) for name, one in ds.variables.items() if one.dtype.kind in "iuf" and "u" not in one.dims]
    solved = ds["solved"].values.astype(bool) if "solved" in ds else np.ones(0, dtype=bool)
    named = ds["outcome"].values.astype(str) if "outcome" in ds else np.zeros(0, dtype=str)
    texts = Counter(map(str, np.ravel(ds["caution"].values))) if "caution" in ds else Counter()
    return {
        "file": str(path),
        "bytes": os.stat(path).st_size,
        "kind": kinds.kind_of(ds).what,
        "title": str(ds.attrs.get("title", "")),
        "sizes": {str(dim): int(size) for dim, size in ds.sizes.items()},
        "along": [str(name) for name, one in ds.data_vars.items() if "u" in one.dims],
        "numbers": [_spread(ds[name]) for name in numbers if ds[name].ndim],
        "fields": [_spread(ds[name]) for name in numbers if not ds[name].ndim],
        "outcomes": dict(Counter(named[named != ""].tolist())),
        "unsolved": int((~solved & (named != "")).sum()) if solved.shape == named.shape else 0,
        "caution": cautions.tell(texts),
        "said": {key: str(ds.attrs[key]) for key in SENTENCES if ds.attrs.get(key)},
        "versions": reading.versions(ds, path) if "versions" in ds.attrs else {},
    }


def _spread(variable: xr.DataArray) -> dict[str, Any]:
    """Smallest, median and largest value, None where there is none, and its dimensions."""
    finite = variable.values[np.isfinite(variable.values)]
    three = (float(f(finite)) if finite.size else None for f in (np.min, np.median, np.max))
    row = dict(zip(("min", "median", "max"), three, strict=True))
    over = " x ".join(map(str, variable.dims))
    return {"name": str(variable.name), "over": over, "units": str(variable.attrs.get("units", "")), **row}
