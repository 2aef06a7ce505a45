"""Every panel of Fig. 7 under every reading of Table 1: which of the five claims hold in which."""

import json
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver.problem.errors import InputError
from studies import READINGS, Study, load, names
from studies.laws.line_verdicts import worst
from studies.laws.verdicts import refusal

from ...store import dataset, in_memory, law_verdicts

NAME = "readings"


def panels() -> list[Study]:
    """The studies of Fig. 7, one a panel."""
    return [load(name) for name in names() if name.startswith("fig7_")]


def run(
    studies: Sequence[Study] | None = None,
    readings: Sequence[str] = tuple(READINGS),
    step: Callable[[str], None] = lambda text: None,
) -> xr.Dataset:
    """Run the panels under the readings; `step` is called with a text as each run begins.

    Over (reading, law): `verdict`, `reason`, `tau`, `first` and `last` (the observable at the ends of its axis, the
    mean over the lines of a grid), `lines`, `lines_hold`, `exceptions`. Over (reading, claim):
    `claim_verdict`, the worst of its laws. Over (reading, panel): `unsolved` cases. Attribute `rows`: for
    each reading, each law's row of `law_verdicts.verdicts`, as JSON.
    """
    studies = panels() if studies is None else list(studies)
    rows: list[list[dict[str, Any]]] = []
    unsolved = []
    for reading in readings:
        of_reading: list[dict[str, Any]] = []
        missing = []
        for study in studies:
            step(f"{study.name} {reading}")
            try:
                ds = in_memory.run(study.under(reading))
            except InputError as error:  # for example where the base rod already ends beyond a followed axis's limit
                of_reading += [refusal(law, str(error)) for law in study.laws]
                missing.append(study.size)
                continue
            of_reading += law_verdicts.verdicts(ds)
            missing.append(law_verdicts.unsolved(ds))
        rows.append(of_reading)
        unsolved.append(missing)
    return _dataset_of_rows(studies, readings, rows, unsolved)


def _dataset_of_rows(
    studies: Sequence[Study],
    readings: Sequence[str],
    rows: list[list[dict[str, Any]]],
    unsolved: list[list[int]],
) -> xr.Dataset:
    dims = ("reading", "law")
    laws = [
        f"{row['claim']} {row['observable']} {row['direction'] or row['does']} along {row['axis']}" for row in rows[0]
    ]
    claims = list(dict.fromkeys(row["claim"] for row in rows[0]))

    def table(key: str, of: Callable[[Any], Any] = lambda value: value) -> Any:
        return [[of(row[key]) for row in line] for line in rows]

    def middle(ends: list[float] | None) -> float:
        return float(np.mean(ends)) if ends else np.nan

    data = {
        "verdict": (dims, table("verdict"), {"long_name": "verdict of the law"}),
        "reason": (dims, table("reason"), {"long_name": "why it is qualified, not decided or fails"}),
        "tau": (dims, np.array(table("tau"), dtype=float), _number("Kendall's tau in the law's direction")),
        "lines": (dims, table("lines"), _number("lines of the grid along the law's axis")),
        "lines_hold": (dims, table("lines_hold"), _number("lines on which the law holds")),
        "exceptions": (dims, table("exceptions", len), _number("steps the wrong way")),
        "first": (dims, table("first", middle), {"long_name": "observable at the axis's start"}),
        "last": (dims, table("last", middle), {"long_name": "observable at the axis's end"}),
        "claim_verdict": (
            ("reading", "claim"),
            [[worst([r["verdict"] for r in line if r["claim"] == c]) for c in claims] for line in rows],
            {"long_name": "verdict of the claim, the worst of its laws"},
        ),
        "unsolved": (("reading", "panel"), unsolved, _number("cases that were not solved")),
    }
    coords = {
        "reading": ("reading", list(readings), {"long_name": "reading of Table 1"}),
        "law": ("law", laws, {"long_name": "claim, observable, direction, axis"}),
        "claim": ("claim", claims, {"long_name": "claim of the text on Fig. 7"}),
        "panel": ("panel", [study.name for study in studies], {"long_name": "study"}),
    }
    attrs = {
        "title": "Which claims of Fig. 7 hold under which reading of Table 1",
        "study_name": NAME,
        "rows": json.dumps(dict(zip(readings, rows, strict=True)), ensure_ascii=False),
        "versions": json.dumps(dataset.versions()),
    }
    return xr.Dataset(data, coords, attrs)


def _number(long_name: str) -> dict[str, str]:
    return {"units": "1", "long_name": long_name}
