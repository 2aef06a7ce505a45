"""Reads golden.json: problems with the answers of 23 November 2026 (benchmarks/make_golden.py), and compares with them.

A row holds its problem as plain numbers: `rod`, `cylinder`, and `start` or `ends`; `choose`, and `held`: ends to which
the equilibrium of `ends` is carried as a seed; then what is asked of it. An answer is made of the public API alone.
"""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from solver import (
    Case,
    Cylinder,
    Ends,
    InputError,
    Rod,
    Solution,
    Start,
    equilibria,
    fit,
    fold_curves,
    follow,
    loops,
    observe,
    solve,
)
from solver.observe.observables import observables_of

FILE = Path(__file__).parent / "golden.json"
Row = dict[str, Any]
RELATIVE = 1e-9  # of a well-conditioned answer: follow and held ends stop at a tolerance of about 1e-10
ROUNDING = 1e-13  # times the condition number: what another order of operations may change


@cache
def rows() -> list[Row]:
    return json.loads(FILE.read_text(encoding="utf-8"))


def case_of(row: Row, ends: str = "ends") -> Case:
    given = Start(**row["start"]) if "start" in row else Ends(**row[ends])
    return Case(Rod(**row["rod"]), Cylinder(**row["cylinder"]), given)


def solution_of(row: Row) -> Solution:
    more = {"choose": row["choose"]} if "choose" in row else {}
    solution = solve(case_of(row), tol=1e-10, stations=9, **more)
    return solve(case_of(row, "held"), tol=1e-10, stations=9, seed=solution) if "held" in row else solution


def sentence(text: Any) -> str:
    """A sentence without its numbers."""
    return re.sub(r"-?\d[\d.]*(e[-+]?\d+)?", "#", str(text))


def shape(row: Row) -> Row:
    solution = solution_of(row)
    answer: Row = {"outcome": sentence(solution.outcome), "condition": float(solution.condition)}
    if solution.selection is not None:
        answer["selection"] = [solution.selection.count, solution.selection.stable]
    if solution.solved:
        ends = ("beta", "alpha", "z", "gamma", "push")
        answer |= {"beta": solution.beta[::2].tolist(), "dbeta0": float(solution.dbeta[0])}
        answer |= {name: float(getattr(solution, name)[-1]) for name in ends}
        answer |= {name: float(value) for name, value in solution.reactions.items()}
        answer["held_index"] = float(solution.held_index)
    if row.get("observe"):
        values = observe(solution, observables_of(solution.case.rod), errors=True)
        answer["observables"] = {name: np.asarray(value).item() for name, value in values.items()}
    return answer


def every_equilibrium(row: Row) -> Row:
    members = equilibria(case_of(row), stations=2, **row.get("options", {}))
    each = [
        {"dbeta0": e.dbeta0, "energy": e.energy, "index": e.index, "bends": e.bends, "stray": e.stray} for e in members
    ]
    condition = max((float(e.solution.condition) for e in members), default=1.0)
    return {"complete": members.complete, "each": each, "condition": condition}


def branch(row: Row) -> Row:
    found = follow(solution_of(row), **row["over"])
    (values,) = row["over"].values()
    passed = [[float(point.solution.dbeta[0]) for point in found.points if point.value == value] for value in values]
    return {
        "ends": [[end.value, sentence(end.reason)] for end in (found.begin, found.end)], "passed": passed,
        "special": [[s.kind, s.value, s.before, s.after] for s in found.special],
    }  # fmt: skip


def curves(row: Row) -> Row:
    found = fold_curves(case_of(row), lattice=row["lattice"], **row["over"])
    points = np.random.default_rng(1).uniform(found.low, found.high, (12, 2))
    by_kind = sorted([c.kind, c.lower, sorted(c.ends)] for c in found.curves)
    cusps = np.concatenate([np.zeros((0, 2)), *(c.cusps for c in found.curves)])
    counts = [sorted(found.indices_at(point).elements()) for point in points]
    return {"curves": by_kind, "cusps": sorted(cusps.tolist()), "counts": counts, "remark": sentence(found.remark)}


def closed(row: Row) -> Row:
    found = loops(Rod(**row["rod"]), Cylinder(**row["cylinder"]), **row["options"])
    names = ("about", "lam", "energy", "index", "push_min", "push_max", "attached", "overlaps")
    return {"complete": found.complete, "each": [{name: getattr(one, name) for name in names} for one in found]}


def derivatives(row: Row) -> Row:
    solution = solution_of(row)
    found = solution.sensitivity(row["fields"], row["observables"])
    values = {name: np.asarray(value).tolist() for name, value in found.observables.items()}
    return {
        "outcome": sentence(found.outcome), "beta": found.beta[:, -1].tolist(), "alpha": found.alpha[:, -1].tolist(),
        "observables": values, "remarks": {k: sentence(v) for k, v in found.remarks.items()},
        "condition": float(solution.condition) ** 2,
    }  # fmt: skip


def fitted(row: Row) -> Row:
    vary = {name: tuple(bounds) for name, bounds in row["vary"].items()}
    found = fit(case_of(row), vary, row["targets"], **row.get("options", {}))
    return {"outcome": sentence(found.outcome), "values": found.values, "cost": found.cost}


KINDS = {
    "shape": shape, "equilibria": every_equilibrium, "follow": branch, "folds": curves, "loops": closed,
    "sensitivity": derivatives, "fit": fitted,
}  # fmt: skip


def answer(row: Row) -> Row:
    try:
        return KINDS[row["kind"]](row)
    except InputError as error:
        return {"refused": sentence(error)}


def differences(row: Row, now: Row | None = None) -> list[str]:
    """What differs from the stored answer, a line each."""
    then, now = row["answer"], answer(row) if now is None else now
    relative = max(RELATIVE, ROUNDING * min(then.get("condition") or 1.0, 1e13)) if row["kind"] != "fit" else 1e-5
    return list(_differences(then, json.loads(json.dumps(now)), relative, ""))


def _differences(then: Any, now: Any, relative: float, where: str) -> Any:
    if isinstance(then, dict) and isinstance(now, dict):
        if then.keys() != now.keys():
            yield f"{where}: without {sorted(then.keys() - now.keys())}, with {sorted(now.keys() - then.keys())}"
        for name in (name for name in then if name in now):
            if name == "push_max_at_error" and _is_even(then):
                continue  # whether such a rod is a helix to the last digit hangs on last digits
            if not _within(then.get(f"{name}_error"), then[name], now[name]):
                yield from _differences(then[name], now[name], relative, f"{where}.{name}")
    elif isinstance(then, list) and isinstance(now, list) and len(then) == len(now):
        scale = max((abs(x) for x in then if isinstance(x, float) and np.isfinite(x)), default=0.0)
        for i, (x, y) in enumerate(zip(then, now, strict=True)):
            more = relative * max(1.0, scale / abs(x)) if isinstance(x, float) and x else relative
            yield from _differences(x, y, more, f"{where}[{i}]")
    elif where.endswith((".condition", "_error", ".cost")):  # estimates: their size counts
        if not (then == now or (np.isnan(then) and np.isnan(now)) or max(then, now) < 20 * max(min(then, now), 1e-12)):
            yield f"{where}: {then} -> {now}"
    elif isinstance(then, float) and isinstance(now, float | int):
        if not np.isclose(now, then, rtol=relative, atol=relative, equal_nan=True):
            yield f"{where}: {then} -> {now}"
    elif then != now:
        yield f"{where}: {then} -> {now}"


def _is_even(observed: dict[str, Any]) -> bool:
    """Whether the push is the same all along a rod, within its errors."""
    names = ("push_max", "push_min", "push_max_error", "push_min_error")
    if not all(isinstance(observed.get(name), float) for name in names):
        return False
    largest, least, *errors = (observed[name] for name in names)
    return bool(largest - least <= sum(errors))


def _within(error: Any, then: Any, now: Any) -> bool:
    """Whether two numbers differ by no more than the error of one, stored to two digits, as on another processor."""
    return all(isinstance(x, float | int) for x in (error, then, now)) and abs(now - then) <= 1.05 * error
