"""Each case of a grid apart: what a column of the solver raises becomes the outcome of the case that raises it.

This is the one place for all columns: start problems, dead loads, held ends, weight and friction. `InputError` passes,
as the question is invalid; so does what is a matter of the machine (`problem.errors.attempt`).
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from .numerics.arrays import Array
from .problem.case import Case
from .problem.case_fields import values_of, with_fields_unchecked
from .problem.dimensionless import EndsProblem, StartProblem, flat, span_of
from .problem.errors import attempt
from .problem.trajectory import Seed, Trajectory, blank

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


def answer_each(question: Question, case: Case, blank_answer: Callable[[Case, Array, Array], Answer]) -> Answer:
    """The answers of a column to a case of B rods.

    Where the column raises, each rod is answered alone: those that raise have outcomes that say so, and all others are
    answered again, with one of them in the place of each that fails. blank_answer: of cases, stations and outcomes, for
    where none is answered.
    """

    column, t, seed, _ = question

    def answers(rows: Any) -> Answer | str:
        seeds = seed.take(rows) if isinstance(seed, Seed) else seed and [seed[i] for i in rows]
        return attempt(lambda: column(rows_of(case, rows), t[rows], seeds))

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
    return blank_answer(case, t, why)


def rows_of(case: Case, rows: Any) -> Case:
    """The cases at flat places of a grid, in a row; rows: (k,) of whole numbers."""
    names = [name for _, name, value in case._numeric if np.ndim(value)]
    return with_fields_unchecked(case, {name: flat(values_of(case, name), case.shape)[rows] for name in names})
