"""Where the numbers of the report come from: the files of the studies, and the versions with which they were made."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from ...data import labels, law_verdicts
from ...run.in_memory import StudyResult

WORKBENCH = "rod-workbench"


def row(result: StudyResult) -> dict[str, Any]:
    """The file of a study, its method and its errors."""
    ds = result.ds
    error, condition = (np.asarray(ds[name].values, dtype=float) for name in ("error", "condition"))
    return {
        "name": str(ds.attrs["study_name"]),
        "file": result.path.name if result.path else "",
        "cases": int(ds["outcome"].size),
        "unsolved": law_verdicts.unsolved(ds),
        "method": str(ds.attrs["method"]),
        "tolerance": labels.typeset(f"{float(ds.attrs['tolerance']):g}"),
        "error": labels.typeset(f"{np.nanmax(error):.1e}") if np.isfinite(error).any() else "–",
        "condition": labels.typeset(f"{np.nanmax(condition):.3g}") if np.isfinite(condition).any() else "–",
    }


def versions(datasets: Sequence[xr.Dataset]) -> list[tuple[str, str]]:
    """Every package that the datasets name, with its version; where they differ, with each version and its studies."""
    found: dict[str, dict[str, list[str]]] = {}
    for ds in datasets:
        for package, version in json.loads(ds.attrs["versions"]).items():
            found.setdefault(package, {}).setdefault(version, []).append(str(ds.attrs["study_name"]))
    return [(package, _each(of)) for package, of in found.items()]


def version(datasets: Sequence[xr.Dataset]) -> str:
    """The version of the workbench that made the datasets, or each of its versions and the studies made with it."""
    return dict(versions(datasets)).get(WORKBENCH, "")


def _each(of: dict[str, list[str]]) -> str:
    """``0.2.0``, or ``0.1.0 (fig6) and 0.2.0 (fig7_1_modulus, readings)``."""
    if len(of) == 1:
        return next(iter(of))
    return " and ".join(f"{one} ({', '.join(studies)})" for one, studies in of.items())
