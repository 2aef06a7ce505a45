"""The rounds of a refined study: the cases of each follow from the numbers of the rounds before."""

from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

from solver.problem.errors import InputError
from studies import Study
from studies.grammar.dimensions import SAMPLE, Dimension, Dimensions
from studies.language import refine as tables
from studies.language.lattice import OUTCOME, Values

from .plan import Plan
from .schema import Columns
from .stored_run import StoredRun


class Rounds:
    """The rounds of one run.

    there: the file that the run extends, at `output`; None where it begins anew. refinement: the cases so far.
    """

    def __init__(self, study: Study, there: StoredRun | None = None, output: Path | None = None) -> None:
        self.study, self.refinement = study, tables.refinement(study)
        self._there = there
        self._held = np.empty((0, self.refinement.steps.size))
        if there is not None and output is not None:
            with h5py.File(output, "r") as file:
                self._held = numbers(study, {name: file[name][...] for name in (*study.wanted, "solved")})

    def __iter__(self) -> Iterator[tuple[Plan, int, int]]:
        """The plan of all cases up to each round, and the first and the last + 1 of the cases that it is to solve.

        They are counted among the cases that no existing file holds. Between two rounds `take` must be called.
        """
        state = self.refinement
        while state.wanted:
            first = len(state.numbers)
            held = self._held[first : first + state.wanted]
            work = self.plan()
            start, stop = max(first - len(self._held), 0), work.todo
            self._mine = held
            yield work, start, stop

    def take(self, columns: Columns | None) -> None:
        """Take the columns of the cases that were to be solved; None where there were none."""
        found = [self._mine] + ([] if columns is None else [numbers(self.study, columns)])
        self.refinement.take(np.concatenate(found))

    def plan(self) -> Plan:
        """The plan of all cases so far. Raises `InputError` where the existing file holds other cases."""
        state = self.refinement
        samples = Dimension(SAMPLE, state.lattice.values(state.places))
        dimensions, new = Dimensions((samples,)), None
        if self._there is not None:
            (before,) = self._there.dimensions.each
            size = min(before.size, samples.size)
            if any(not np.array_equal(row[:size], before.fields[name][:size]) for name, row in samples.fields.items()):
                raise InputError("the existing file was refined to other cases; use --restart to solve all of it again")
            new = np.arange(before.size, samples.size)
        return Plan(self.study.with_samples(samples), dimensions, new, state)


def numbers(study: Study, columns: Columns) -> Values:
    """The watched numbers of each case, (cases, watched), those of laws last; whether it is solved as 0 or 1."""
    assert study.refine is not None
    watched = ["solved" if name == OUTCOME else name for name in study.refine.watch]
    rows = [columns[name] for name in (*watched, *(law.observable for law in tables.laws_to_watch(study)))]
    return np.stack([np.asarray(row, dtype=float) for row in rows], axis=1)
