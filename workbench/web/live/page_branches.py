"""The branches of equilibria through those that the live page lists, over one load or end angle, as plain data."""

import time
from dataclasses import replace
from typing import Any

import numpy as np

from solver import Ends, InputError, observe
from solver.follow import solutions_of
from solver.problem.case_fields import value_of, with_field
from solver.problem.errors import no_such
from studies import Study

from ...branches.tracing import Piece, Traced, traced
from . import page_shape

FIELDS = ("FZ", "MZ", "M3", "beta0", "betaL")  # that a diagram may be over
SHOWN = ("height", "wraps", "energy", "turns", "push_max", "kappa_max", "amplitude")  # that it may show
PATIENCE = 8.0  # s, after which no further branch is followed
MOST = 90  # points of a piece of a branch; each is solved, in a millisecond
FEW = 3  # stations of a point; its observables do not need more


def follow_branches(study: Study, field: str, low: float, high: float) -> dict[str, Any]:
    """All branches that pass the state of a study or an end of the range of a field, between the ends of the range.

    Raises
    ------
    InputError
        For a start problem, a field that no diagram is over, and a rod with more equilibria than the page lists.
    """
    case = study.case()
    if not isinstance(case.given, Ends):
        raise InputError("a start problem has one solution only; hold both ends to follow its branches")
    if field not in FIELDS:
        raise no_such("field of a branch diagram", field, FIELDS)
    values = list(dict.fromkeys((float(value_of(case, field)), float(low), float(high))))  # those of the list first
    for value in values:
        page_shape.refuse_many(with_field(case, field, value))
    begun = time.monotonic()
    seen = traced(case, field, values, FEW, lambda value: None, begun + PATIENCE)
    rows = [_row(seen, piece) for piece in seen.pieces]
    missing = sum(branch < 0 for row in seen.branch for branch in row)
    return {"field": field, "low": min(values), "high": max(values), "pieces": rows, "missing": missing}


def _row(seen: Traced, piece: Piece) -> dict[str, Any]:
    """Of a piece of a branch its index, and at each of its points the field, beta'(0) and what may be shown."""
    branch = seen.curves[piece.curve]
    whole = np.arange(piece.first, piece.last + 1)
    at = whole[np.unique(np.linspace(0, whole.size - 1, MOST).round().astype(int))]
    part = replace(branch, points=tuple(branch.points[k] for k in at))
    sol = solutions_of(part, FEW)
    columns = observe(sol, SHOWN) | {"field": part.values, "dbeta0": sol.dbeta[:, 0]}
    numbers = {name: [float(f"{value:.8g}") for value in row] for name, row in columns.items()}
    return {"index": int(branch.index[whole[whole.size // 2]]), **numbers}
