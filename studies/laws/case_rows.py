"""The lines of cases along an axis on which a law is judged: those of a grid, or as a refinement leaves them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from solver.problem.errors import check_known

from .line_verdicts import cuts


@dataclass(frozen=True, eq=False)
class CaseRow:
    """A line of cases along the axis of a law.

    at: the values of the other axes. cases: (n,), the indices of the cases in the rising order of the axis, -1 where
    none is stored. along: (n,), the values of the axis. cut: (n - 1,), the steps that cross to another branch. added:
    (n,), the cases that a refinement added where a number changes; None for none.
    """

    at: Mapping[str, float]
    cases: NDArray[np.int64]
    along: NDArray[np.float64]
    cut: NDArray[np.bool_]
    added: NDArray[np.bool_] | None = None

    @property
    def has_case(self) -> NDArray[np.bool_]:
        """Where a case is stored, (n,)."""
        return self.cases >= 0

    def take(self, values: NDArray[Any]) -> NDArray[Any]:
        """The values of this line, of those of all cases (cases,); NaN where no case is stored."""
        taken = values[self.cases]
        return taken if self.has_case.all() else np.where(self.has_case, taken, np.nan)


@dataclass(frozen=True, eq=False)
class Grid:
    """What a law is judged on besides its observables: the axes of a grid of cases, and numbers of each case.

    Parameters
    ----------
    axes : mapping of arrays
        The values of each axis; observables and numbers have a dimension for each, in this order.
    crossing : array of bool, optional
        Over the grid, but one fewer along the axis of the law: the steps, in the rising order of that axis, to an
        equilibrium of another branch. Such a step is not evidence.
    counts : collection of str
        The expressions among the observables that are whole numbers.
    known : mapping of arrays
        The numbers that the formulas of the law use, by name; each broadcasts to the grid. "solved": whether each case
        is solved; where one without a value is, the observable is not defined.
    rows : sequence of CaseRow, optional
        The lines of cases that are no grid, as a refinement leaves them; all numbers are then (cases,), and axes those
        of the study. A line on which cases of the coarse grid are not stored counts where its other cases go against
        the law.
    """

    axes: Mapping[str, ArrayLike]
    crossing: ArrayLike | None = None
    counts: Collection[str] = ()
    known: Mapping[str, ArrayLike] = field(default_factory=dict)
    rows: Sequence[CaseRow] | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(np.size(values) for values in self.axes.values())

    def rows_along(self, axis: str) -> Sequence[CaseRow]:
        """The lines of cases along an axis."""
        check_known("axis", axis, self.axes)
        if self.rows is not None:
            return self.rows
        k = list(self.axes).index(axis)
        order = np.argsort(np.asarray(self.axes[axis], dtype=float), kind="stable")
        along, cut = np.asarray(self.axes[axis], dtype=float)[order], cuts(self.crossing, self.shape, k)
        cases = np.moveaxis(np.arange(int(np.prod(self.shape))).reshape(self.shape), k, -1)[..., order]
        others = {dim: np.asarray(values, dtype=float) for dim, values in self.axes.items() if dim != axis}
        return [
            CaseRow(
                {dim: float(at[i]) for (dim, at), i in zip(others.items(), where, strict=True)},
                cases[where],
                along,
                cut[where],
            )
            for where in np.ndindex(cases.shape[:-1])
        ]
