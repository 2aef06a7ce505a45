"""What a report needs beside its panels: which claims hold under which reading of Table 1, and the rod's equilibria."""

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver import equilibria, observe, solve
from solver.problem.errors import InputError
from studies import READINGS, Study, load, names
from studies.laws.judgement import refusal
from studies.laws.line_verdicts import worst

from ..branches import equilibria_dataset
from ..branches.ends_study import ends_problem
from ..run import in_memory
from ..stored import provenance
from ..stored.stored_study import StoredStudy
from ..words import free_rod_words, labels, outcome_counts

NAMES = READINGS_TABLE, EQUILIBRIA, LET_GO = "readings", "equilibria", "let_go"
OWN, STABLE = "rank_of_study", "rank_of_stable"  # attributes: places by energy, from 1; 0: there is none


def panels() -> list[Study]:
    """The studies of Fig. 7, one a panel."""
    return [load(name) for name in names() if name.startswith("fig7_")]


def run_readings(
    studies: Sequence[Study] | None = None,
    readings: Sequence[str] = tuple(READINGS),
    step: Callable[[str], None] = lambda text: None,
) -> xr.Dataset:
    """Run the panels under the readings; `step` is called with a text as each run begins.

    Over (reading, law): `verdict`, `reason`, `tau`, `first` and `last` (the observable at the ends of its axis, the
    mean over the lines of a grid), `lines`, `lines_hold`, `exceptions`. Over (reading, claim):
    `claim_verdict`, the worst of its laws. Over (reading, panel): `unsolved` cases. Attribute `rows`: for
    each reading, each law's row of `stored_verdicts.verdicts`, as JSON.
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
                stored = StoredStudy(in_memory.run(study.under(reading)))
            except InputError as error:  # for example where the base rod already ends beyond a followed axis's limit
                of_reading += [refusal(law, str(error)) for law in study.laws]
                missing.append(study.variation.size)
                continue
            of_reading += stored.verdicts
            missing.append(stored.unsolved)
        rows.append(of_reading)
        unsolved.append(missing)
    return _rows_as_dataset(studies, readings, rows, unsolved)


def _rows_as_dataset(
    studies: Sequence[Study], readings: Sequence[str], rows: list[list[dict[str, Any]]], unsolved: list[list[int]]
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
        "reason": (dims, table("reason"), {"long_name": "why it is true in part, not decided or false"}),
        "tau": (dims, np.array(table("tau"), dtype=float), _number("Kendall's tau in the law's direction")),
        "lines": (dims, table("lines"), _number("lines of the grid along the law's axis")),
        "lines_hold": (dims, table("lines_hold"), _number("lines on which the law is true")),
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
        "study_name": READINGS_TABLE,
        "rows": json.dumps(dict(zip(readings, rows, strict=True)), ensure_ascii=False),
        "versions": json.dumps(provenance.versions()),
    }
    return xr.Dataset(data, coords, attrs)


def _number(long_name: str) -> dict[str, str]:
    return {"units": "1", "long_name": long_name}


def run_equilibria(study: Study) -> xr.Dataset:
    """Return all equilibria between the end angles of a study's one rod, under its loads.

    Attribute `rank_of_study` is the rank by energy of the study's own rod, and `rank_of_stable` that of the stable
    equilibrium that `solve` takes between these ends; 0 where there is none. Raises `InputError` as of `ends_problem`.
    """
    case = ends_problem(study)
    solution, every, default = solve(study.case(), stations=2), equilibria(case), solve(case, stations=2)
    slopes = np.array([equilibrium.dbeta0 for equilibrium in every])
    ranks = {OWN: _rank(slopes, float(solution.dbeta[0])), STABLE: 0}
    if any(equilibrium.index == 0 for equilibrium in every):
        ranks[STABLE] = _rank(slopes, float(default.dbeta[0]))
    return equilibria_dataset.as_dataset(study, case, every).assign_attrs(ranks)


def _rank(slopes: "np.ndarray[Any, Any]", slope: float) -> int:
    return int(np.abs(slopes - slope).argmin()) + 1 if slopes.size else 0


def pair(stored: StoredStudy) -> StoredStudy:
    """Return the stable equilibrium, if there is one, and the rod of the study."""
    return stored.select({"equilibrium": [stored.attrs[rank] - 1 for rank in (STABLE, OWN) if stored.attrs[rank]]})


def rows(stored: StoredStudy, pictures: Sequence[Mapping[str, Any]]) -> dict[str, Any] | None:
    """Return what the report says of them; None where the study's own rod is not among them."""
    if not stored.attrs[OWN]:
        return None
    case = stored.select({"equilibrium": stored.attrs[OWN] - 1})
    stable = stored.attrs[STABLE]
    return {
        "count": stored.sizes["equilibrium"],
        "rank": stored.attrs[OWN],
        "stability": outcome_counts.stability(int(case["index"])),
        "sister": stable if stable != stored.attrs[OWN] else 0,
        "attached": f"{float(stored['attached'][stable - 1]):.0%}" if stable else "",
        "ends": labels.typeset(str(stored.attrs["stability"])),
        "pictures": pictures,
    }


def release(study: Study, stored: StoredStudy) -> dict[str, Any]:
    """Return what the report says of the rods of a study along one axis that are let go.

    Its `head` is that of a table, and `rows` has the texts of each rod: its value, how far it is off the wall, the
    share of its length on it, both with their errors, and its elastic energy before and after; a dash where it was not
    solved. Its `on` says how many may keep a stretch on the wall.
    """
    (axis,) = stored.axes
    case = study.case_of({axis: stored[axis].values})
    held = observe(solve(case, stations=2), free_rod_words.ELASTIC)
    before, after = (np.sum([known[name] for name in free_rod_words.ELASTIC], axis=0) for known in (held, stored))
    unit = labels.unit(f"{stored.units['force']} {stored.units['length']}")
    length = labels.unit(stored.units["length"])
    of_share = np.array([stored["contact_share"].values, stored["contact_share_error"].values])
    gaps = (stored[name].values for name in ("gap_max", "gap_max_error"))
    columns = np.stack([stored[axis].values, *gaps, *100 * of_share, before, after], axis=-1).tolist()
    on, surely = (int(np.sum(shares > 0)) for shares in ([1, 1] @ of_share, [1, -2] @ of_share))  # errors: estimates
    return {
        "head": [labels.axis_label(stored[axis]), f"Off the wall, at most [{length}]", "On the wall",
                 f"Elastic energy held on [{unit}]", f"Let go [{unit}]"],
        "rows": [[labels.number(value), *(text if np.isfinite(number) else "–" for number, text in (
                                    (gap, free_rod_words.amount(gap, off, 3)),
                                    (share, f"{free_rod_words.amount(share, miss, 2)} %"),
                                    (held_on, f"{held_on:.0f}"), (free, f"{free:.1f}")))]
                 for value, gap, off, share, miss, held_on, free in columns],
        "count": int(stored["outcome"].size),
        "on": f"{'At most ' * (surely < on)}{on or 'None'} of them keep{'s' * (on < 2)}",
        "file": f"{LET_GO}.h5",
    }  # fmt: skip
