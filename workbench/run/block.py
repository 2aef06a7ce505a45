"""Solve a block of cases: arrays of axis values in, columns of results out. Workers import this and no xarray.

Cases are numbered along the axes, the last fastest, and solved in blocks whose size depends on the study alone: matrix
products round a case's last bits differently among other neighbours, so a case always has the same ones. A chunk is a
number of whole blocks; whichever process solves it, the bits are the same. It is solved in parts of some seconds' work,
each of whole blocks, and each part is stored when it is there.
"""

import ctypes
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import Case, Solution
from solver.observe.observables import OBSERVABLES, is_count, observe, why_unknown
from studies import Study
from studies.language import expressions

from ..stored import bounds
from ..stored.boxes import Columns
from ..stored.case_solving import knows_orbit, solve_one
from ..stored.quantity_variables import JUDGED, LOADS, curve_name, inner_shape
from ..stored.schema import TEXTS, shapes
from ..words import caution_words, pipe_words
from ..words.outcome_counts import NO_BRANCH
from .shards import encode, join

SECONDS = 3.0  # of work, after which a worker gives what it has: what an interruption costs


@dataclass(frozen=True, eq=False)
class Chunk:
    """Cases `start` to `stop` of those to be solved.

    values: of each axis, (cases,). deaths: how many workers died at it. in_order: of a sweep, solves the case of a
    number after those from which it continues (`Sweep.solve`); None of other studies.
    """

    start: int
    stop: int
    values: Mapping[str, NDArray[np.float64]]
    deaths: int
    in_order: Callable[[int], tuple[Solution, str, int]] | None

    @property
    def cases(self) -> int:
        return self.stop - self.start

    def blocks(self, size: int, deaths: int = 0) -> Iterator["Chunk"]:
        """The chunk in blocks of `size` cases."""
        for a in range(0, self.cases, size):
            b = min(a + size, self.cases)
            values = {name: numbers[a:b] for name, numbers in self.values.items()}
            yield Chunk(self.start + a, self.start + b, values, deaths, self.in_order)

    def cut(self, cases: int) -> "tuple[Chunk, Chunk]":
        """The first so many cases of the chunk, and the others."""
        first, others = (
            {name: row[at] for name, row in self.values.items()} for at in (slice(cases), slice(cases, None))
        )
        at = self.start + cases
        return replace(self, stop=at, values=first), replace(self, start=at, values=others)


def solve_chunk(study: Study, chunk: Chunk, block: int) -> tuple[int, bytes]:
    """Solve the first blocks of a chunk, for `SECONDS`: at least one, at most all.

    Returns how many cases these are, and their results as packed by `shards.encode`. Raises `InputError` for an invalid
    study.
    """
    parts, cases, ends = [], 0, time.monotonic() + SECONDS
    for part in chunk.blocks(block):
        parts.append(block_of(study, part))
        cases += part.cases
        if time.monotonic() >= ends:
            break
    return cases, encode(join(parts))


def block_of(study: Study, part: Chunk) -> Columns:
    """The columns of one block."""
    if part.in_order is not None:
        return join([_columns_of(study, *part.in_order(place)) for place in range(part.start, part.stop)])
    case, why = study.case_to_solve(part.values)
    known = knows_orbit(study.method, batched=True) and not study.let_go
    stations = study.stations if study.outputs or not known else 2  # numbers are measured on the orbit, not at them
    sol = solve_one(case, study.equilibrium, study.tol, study.method, stations, study.let_go)
    return columns(study, sol, part.values, why)


def _columns_of(study: Study, sol: Solution, remark: str, branch: int) -> Columns:
    """The columns of one case of a sweep. remark: an addition to its outcome."""
    row = columns(study, sol)
    if remark:
        row["outcome"] = np.array([bounds.fit_text(f"{row['outcome'][0]}; {remark}")])
    return {**row, "branch": np.array([branch])}


def columns(study: Study, sol: Solution, given: Mapping[str, Any] | None = None, refused: Any = "") -> Columns:
    """What is stored of each case, (cases, ...): outputs, observables, loads, outcome, errors and caution.

    The caution is judged for every case, whatever else is stored. Numbers of a case that is not solved are NaN, except
    its loads. given: the values of the fields that vary, (cases,) each, as the study gives them. refused: why a case is
    none that was asked, (cases,), "" where it is.
    """
    cases = sol.case.size
    mine = np.asarray(sol.solved).reshape(-1)
    row: Columns = {}
    for name in study.outputs:
        along = np.asarray(getattr(sol, name)).reshape(cases, sol.t.shape[-1], *inner_shape(name))
        row[curve_name(name)] = _where(mine, along)
    # in one call, as several observables share what they are measured from
    seen = observe(sol, list(dict.fromkeys((*study.observed, *caution_words.JUDGED))), errors=True)
    observed: Columns = {name: np.reshape(values, -1) for name, values in seen.items()}
    shown = [name for name in dict.fromkeys((*study.wanted, *caution_words.JUDGED)) if name in OBSERVABLES]
    missing = [reason for name in shown for reason in why_unknown(name, observed[name], study.leaves)]
    if study.expressions:
        values, reasons = expressions.values_of(study, sol, observed, given or {})
        observed, missing = observed | values, missing + reasons
    for name in study.columns:
        row[name] = _where(mine, np.asarray(observed[name]).reshape(-1))
    row["solved"] = mine
    outcomes = np.asarray(sol.outcome).astype(str).reshape(-1)
    for words, where in missing:
        if (mine & where).any():
            outcomes = _with_remarks(outcomes, np.where(mine & where, words, ""))
    row["outcome"] = _with_remarks(outcomes, np.where(mine, _incomplete(sol), ""))
    if study.varies and sol.begun is not None:
        begun = np.asarray(sol.begun).reshape(-1)
        ways = [pipe_words.way_of(str(text)) for text in begun]
        row["outcome"] = _with_remarks(row["outcome"], np.where(mine, ways, ""))
        if study.has_branches:
            row["branch"] = np.where(mine, [pipe_words.count_left(str(text)) for text in begun], NO_BRANCH)
    caution = caution_words.of_cases(sol, observed, study.unit_system)
    row["caution"] = np.asarray(caution).reshape(-1)
    for name in (*JUDGED, *(name for name in LOADS if name not in study.variation.fields)):
        row[name] = np.asarray(getattr(sol, name), dtype=float).reshape(-1)
    for name in study.reactions:
        row[name] = np.asarray(sol.held_index if name == "held_index" else sol.reactions[name], float).reshape(-1)
    return _as_a_file_holds(study, sol.case, row, refused)


def _as_a_file_holds(study: Study, case: Case, row: Columns, refused: Any) -> Columns:
    """The columns with texts that a file can hold; cases that are refused, and those whose numbers it cannot hold, are
    not solved. refused: as of `columns`."""

    def of_solved(value: Any) -> NDArray[np.float64]:
        return np.broadcast_to(np.asarray(value, dtype=float), case.shape).reshape(-1)[solved]

    bad = np.broadcast_to(np.asarray(refused, dtype=object).reshape(-1), case.size).copy()
    solved = np.flatnonzero(row["solved"])
    rod = {"L": of_solved(case.rod.L), "rho": of_solved(case.rho), "A": of_solved(case.rod.bending_stiffness)}
    counted = [name for name in row if is_count(name) or name in bounds.COUNTED]
    for name, why, where in bounds.unfit({name: values[solved] for name, values in row.items()}, counted, rod):
        bad[[k for k in solved[where] if not bad[k]]] = f"failed: solved, but no file can hold it: {name} {why}"
    if (fails := bad != "").any():
        none = blank_columns(study, case.size, "") | {"outcome": bad.astype(str)}
        row = {
            name: np.where(fails.reshape(-1, *(1,) * (values.ndim - 1)), none.get(name, values), values)
            for name, values in row.items()
        }
    fit = {text: bounds.fit_text(text) for name in TEXTS for text in {*row[name].tolist()}}
    return row | {name: np.array([fit[text] for text in row[name].tolist()]) for name in TEXTS}


def _incomplete(sol: Solution) -> NDArray[Any]:
    """A remark on each case whose equilibrium was selected from a list that may be incomplete, (cases,)."""
    lists = np.full(sol.case.size, None) if sol.selection is None else np.asarray(sol.selection).reshape(-1)
    return np.array(["" if how is None else how.remark for how in lists.tolist()])


def _with_remarks(outcomes: NDArray[Any], remarks: NDArray[Any]) -> NDArray[Any]:
    """The outcomes with the remarks on numbers that have no value."""
    if not (remarks != "").any():
        return outcomes
    return np.array([f"{a}; {b}" if b else a for a, b in zip(outcomes.tolist(), remarks.tolist(), strict=True)])


def blank_columns(study: Study, cases: int, outcome: str) -> Columns:
    """The columns of cases that were not solved, with that outcome."""
    known = {"solved": False, "outcome": outcome, "caution": "", "branch": NO_BRANCH, **dict.fromkeys(JUDGED, np.inf)}
    return {name: np.full((cases, *shape), known.get(name, np.nan)) for name, shape in shapes(study).items()}


def _where(mine: NDArray[np.bool_], values: NDArray[Any]) -> NDArray[Any]:
    """The values, NaN where the case is not solved; integers stay integers where all cases are solved."""
    if values.dtype.kind == "b":
        values = values.astype(np.int64)
    if mine.all():
        return values
    return np.where(mine.reshape(-1, *(1,) * (values.ndim - 1)), values.astype(float), np.nan)


# Of malloc.h. The sizes are the largest that glibc itself would choose after such arrays were freed.
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
_KEPT, _LARGEST = 64 * 2**20, 32 * 2**20


def keep_memory() -> None:
    """Keep up to 64 MB of freed memory in this process, where the C library (glibc) has that setting.

    Otherwise the system provides each temporary array of a block page by page, which costs a sixth of the time; Dask
    starts its workers with that setting off. The setting holds for the whole process, so it is for our own only.
    """
    if sys.platform != "linux":
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_MMAP_THRESHOLD, _LARGEST)
        mallopt(_TRIM_THRESHOLD, _KEPT)
