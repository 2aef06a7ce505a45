"""Each case of a grid apart: what a column of the solver raises becomes the outcome of the case that raises it.

This is the one place for all columns: start problems, dead loads, held ends, weight and friction. `InputError` passes,
as the question is invalid; so does what is a matter of the machine (`problem.errors.attempt`).
"""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from .free.free_rods import FreeRods
from .nodes.varying_shapes import VaryingShapes
from .numerics.arrays import Array
from .problem.case import Case
from .problem.case_fields import values_of, with_fields_unchecked
from .problem.errors import attempt
from .problem.reduced import EndsProblem, StartProblem, flat, span_of
from .problem.trajectory import PLAIN, Seed, Trajectory, blank

Answer = tuple[StartProblem | EndsProblem, Trajectory]


class Question(NamedTuple):
    """What is asked of a column of the solver, after its checks.

    column: a function of a case of B rods, their stations and their seeds that returns their problems and answers.
    t: (B, n), stations in units of rho. seed: None, or one of each rod, in a list or a `Seed`. name: of the method.
    """

    column: Callable[[Case, Array, Any], Answer]
    t: Array
    seed: Any
    name: str


def answer_each(question: Question, case: Case) -> Answer:
    """The answers of a column to a case of B rods.

    Where the column raises, each rod is answered alone: those that raise have outcomes that say so, and all others are
    answered again, with one of them in the place of each that fails.
    """

    column, t, seed, _ = question

    def answers(rows: Any) -> Answer | str:
        seeds = seed.take(rows) if isinstance(seed, Seed) else seed and [seed[i] for i in rows]
        return attempt(lambda: column(_rows_of(case, rows), t[rows], seeds))

    whole = attempt(lambda: column(case, t, seed))
    if not isinstance(whole, str):
        return whole
    alone = [whole] if case.size == 1 else [answers(np.array([i])) for i in range(case.size)]
    why = np.array([said if isinstance(said, str) else "" for said in alone], dtype=object)
    fit = why == ""
    if fit.any():
        rows = np.where(fit, np.arange(case.size), np.argmax(fit))
        whole = answers(rows)
        if not isinstance(whole, str):
            return replace(whole[0], span=span_of(case)), blank(whole[1], fit, why)
        why[fit] = whole
    return _blank_answer(case, t, why)


def _rows_of(case: Case, rows: Any) -> Case:
    """The cases at flat places of a grid, in a row; rows: (k,) of whole numbers."""
    names = [name for _, name, value in case._numeric if np.ndim(value)]
    return with_fields_unchecked(case, {name: flat(values_of(case, name), case.shape)[rows] for name in names})


def _blank_answer(case: Case, t: Array, why: Array) -> Answer:
    """Plain problems, and answers of NaN at stations t (B, n), with the outcomes `why` (B,)."""
    B, kind = case.size, StartProblem if case.kind == "start" else EndsProblem
    numbers = {field.name: np.full(B, PLAIN[field.name]) for field in fields(kind)}
    problem = kind(**numbers | {"span": span_of(case)})
    nothing, each = np.full(t.shape, np.nan), np.full(B, np.nan)
    answer = Trajectory(
        nothing,
        nothing,
        nothing,
        nothing,
        partial(np.asarray, nothing),
        np.zeros(B, dtype=bool),
        why,
        each + np.inf,
        each + np.inf,
        np.zeros(B, dtype=np.int64),
    )
    if case.kind == "ends":
        answer = replace(answer, begun=np.full(B, "", dtype=object))
    if case.leaves:
        return problem, replace(answer, free=FreeRods.blank(*t.shape))
    if case.on_nodes:
        answer = replace(answer, shapes=VaryingShapes([None] * B, each, each))
    if case.varies:
        answer = replace(answer, loads=np.full((3, *t.shape), np.nan))
    return problem, answer
