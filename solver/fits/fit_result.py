"""The result of a fit."""

from dataclasses import dataclass, field

import numpy as np

from ..numerics.arrays import Array
from ..problem.case import Case
from ..problem.outcomes import SOLVED
from ..solution import Solution

NO_INTERVALS = "no intervals: no sigma is given, and there are no more data than fitted values"


@dataclass(frozen=True)
class OtherMinimum:
    """Another minimum of the sum of squares.

    Attributes
    ----------
    values : dict
        Field -> its value.
    cost : float
        Half the sum of squares of the residuals.
    as_good : bool
        Whether the data do not exclude it, at 95 %, against the best one; of a fit that is `exact`, whether it reaches
        them.
    at_bound : tuple of str
        The fields that are at a bound there.
    """

    values: dict[str, float]
    cost: float
    as_good: bool
    at_bound: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Fit:
    """Values of F fields that fit N data; `solver.fit` makes it.

    Attributes
    ----------
    outcome : str
        "solved"; "undetermined: " and what the data cannot tell apart; "misfit: " where sigma is given and the
        residuals are larger by a chance below 1e-6; or "failed: " and the reason.
    reached : bool
        Whether the targets are met, where there are no more of them than fields; elsewhere True.
    values : dict
        Field -> its value at the minimum, in its unit.
    intervals : dict
        Field -> the ends of its 95 % interval; infinite (or 0 and infinite) where the data do not determine it, NaN
        where nothing is known of the errors of the data, or the field ends at a bound.
    rule : str
        How the intervals were found, in words.
    covariance, correlation : array, (F, F)
        Of the values, to first order.
    condition : float
        Condition number of the derivatives, each column normalised; infinite where the data do not determine all.
    directions : list of dict
        Combinations that change no datum: field -> its share of a change, relative for E, a, L and R, else in its unit.
    shares : dict
        Field -> (N,), the share of each datum in what is known of it; the sum is 1.
    groups : tuple of str
        The group of each datum: its observable, or "alpha", "z", "beta" or "distance" of the points.
    measured, computed, residuals : array, (N,)
        The data (0 for a distance), what the fitted rod gives, and the difference in units of sigma, or in relative
        units without sigma. Points are in the order in which they were given.
    feet : tuple of array, or None
        s, alpha and z of the fitted rod at each point, or at its foot, (P,) each; None without points.
    cost : float
        Half the sum of squares of the residuals.
    freedom : int
        Degrees of freedom: number of data less that of fitted combinations.
    probability : float
        With sigma, the probability of a larger sum of squares; else NaN.
    minima : tuple of OtherMinimum
        Other minima, lowest first; of equal ones that nearest to the values of the case.
    remarks : tuple of str
        Sentences on what limits the result.
    case, solution : Case, Solution
        The fitted case, and its solution at the points or their feet.
    solves, derivatives : int
        Number of solutions and of evaluations of the derivatives.
    """

    outcome: str
    reached: bool
    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    rule: str
    covariance: Array = field(repr=False)
    correlation: Array = field(repr=False)
    condition: float
    directions: list[dict[str, float]]
    shares: dict[str, Array] = field(repr=False)
    groups: tuple[str, ...] = field(repr=False)
    measured: Array = field(repr=False)
    computed: Array = field(repr=False)
    residuals: Array = field(repr=False)
    feet: tuple[Array, Array, Array] | None = field(repr=False)
    cost: float
    freedom: int
    probability: float
    minima: tuple[OtherMinimum, ...]
    remarks: tuple[str, ...]
    case: Case = field(repr=False)
    solution: Solution | None = field(repr=False)
    solves: int
    derivatives: int

    @property
    def solved(self) -> bool:
        """Whether the values are a minimum that the data determine, and every exact target is reached."""
        return self.outcome == SOLVED

    @property
    def exact(self) -> bool:
        """Whether there is neither sigma nor more data than fitted values: data are reached or not, none excludes."""
        return self.rule == NO_INTERVALS

    def share_of(self, group: str) -> dict[str, float]:
        """Field -> the share of a group of data in what is known of it."""
        mine = np.array([name == group for name in self.groups])
        return {name: float(row[mine].sum()) for name, row in self.shares.items()}
