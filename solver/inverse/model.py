"""The residuals of a fit and their exact derivatives, at the numbers x of its parameters."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..observe.observables import observe
from ..problem.case import Case, Ends
from ..problem.errors import InputError
from ..solution import Solution
from ..solve import solve
from .data import Data
from .feet import Feet, feet
from .parameters import Parameter, rates_at, replace_values, values_at, values_in_words


class NoValueError(Exception):
    """The reason why there are no residuals, or no derivatives, at some values of the parameters."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """The residuals at x.

    sol: at the stations of the points. computed, (N,): what the data measure. residuals, (N,): in units of their sizes.
    """

    x: Array
    sol: Solution
    computed: Array
    residuals: Array
    feet: Feet | None


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where a local search ended.

    cost: half the sum of squares. free: (F,), False at a bound. stop: why it ended early, or "".
    """

    found: Evaluation
    jacobian: Array
    cost: float
    free: Array
    stop: str = ""

    @property
    def x(self) -> Array:
        return self.found.x


class Model:
    """What a search calls. It counts the solutions, the derivatives, and where there was no value."""

    def __init__(self, case: Case, parameters: Sequence[Parameter], data: Data, choose: Any, tol: float) -> None:
        self.case, self.parameters, self.data = case, list(parameters), data
        self.solves = self.derivatives = 0
        self.starts = 0  # Sobol' points of the search
        self.refused: Counter[str] = Counter()
        self._choose, self._tol = choose, tol
        self._branch: Solution | None = None
        self._last: Evaluation | None = None

    def begin(self) -> None:
        """Begin a search: the equilibrium of an ends problem is selected anew."""
        self._branch = self._last = None

    def residuals(self, x: Array) -> Array:
        """The residuals (N,), NaN where there are none: a search then takes a shorter step."""
        try:
            return self.evaluation(x).residuals
        except NoValueError as error:
            self.refused[str(error)] += 1
            return np.full(self.data.size, np.nan)

    def evaluation(self, x: Array) -> Evaluation:
        """The residuals at x. Raises `NoValueError` where there are none."""
        if self._last is None or not np.array_equal(self._last.x, x):
            self._last = self._evaluate(x)
        return self._last

    def jacobian(self, x: Array) -> Array:
        """The derivatives of the residuals by x, (N, F). Raises `NoValueError` where one does not exist."""
        evaluation = self.evaluation(x)
        if isinstance(self.case.given, Ends):
            self._branch = evaluation.sol  # x was accepted
        self.derivatives += 1
        fields, targets = [parameter.name for parameter in self.parameters], list(self.data.targets)
        known = evaluation.sol.sensitivity(fields, targets)
        if not known.solved:
            raise NoValueError(f"at {values_in_words(self.parameters, x)}: {known.outcome}")
        for name in targets:
            if known.remarks[name]:
                raise NoValueError(f"at {values_in_words(self.parameters, x)}: {name} has {known.remarks[name]}")
        rows = [known.observables[name] / self.data.sizes[name] for name in targets]
        if self.data.points is not None:
            rows += list(self._of_points(evaluation, known))
        return np.vstack(rows) * rates_at(self.parameters, x)

    def _of_points(self, evaluation: Evaluation, known: Any) -> list[Array]:
        """The derivatives of the residuals of the points, a block (P, F) for each column."""
        points, sol = self.data.points, evaluation.sol
        assert points is not None
        if evaluation.feet is not None:
            at, feet_ = evaluation.feet.order, evaluation.feet
            moved = feet_.by_alpha * known.alpha[:, at] + feet_.by_z * known.z[:, at]
            return [moved.T]
        rho, s, L = float(sol.case.rho), sol.s, float(sol.case.rod.L)
        pace = {"alpha": np.sin(sol.beta) / rho, "z": np.cos(sol.beta), "beta": sol.dbeta}
        blocks = []
        for name in points.columns:
            rates = np.array(getattr(known, name))
            for k, field in enumerate(known.fields):
                if field == "L":  # the points keep their s, and not their s/L
                    rates[k] -= s / L * pace[name]
            blocks.append((rates / points.sizes[name]).T)
        return blocks

    @np.errstate(over="ignore", invalid="ignore")  # such values are refused at the end
    def _evaluate(self, x: Array) -> Evaluation:
        try:
            case = replace_values(self.case, values_at(self.parameters, x))
        except InputError as error:
            raise NoValueError(str(error)) from None
        points, nearest = self.data.points, None
        if points is not None and points.s is None:
            nearest = feet(lambda stations: self._solve(case, stations), points)
            sol = nearest.sol
        else:
            s = None if points is None else points.s
            if s is not None and s[-1] > float(case.rod.L):
                raise NoValueError("the rod is shorter than the s of a point")
            sol = self._solve(case, 2 if s is None else s)
        computed, residuals = self._compare(sol, nearest)
        if not np.isfinite(residuals @ residuals):
            raise NoValueError("the squares of the residuals are beyond the range of floats")
        return Evaluation(x.copy(), sol, computed, residuals, nearest)

    def _solve(self, case: Case, stations: Any) -> Solution:
        self.solves += 1
        if self._branch is not None:
            sol = solve(case, self._tol, stations=stations, seed=self._branch)
        elif isinstance(case.given, Ends):
            sol = solve(case, self._tol, stations=stations, choose=self._choose)
        else:
            sol = solve(case, self._tol, stations=stations)
        if not sol.solved:
            raise NoValueError(str(sol.outcome))
        return sol

    def _compare(self, sol: Solution, nearest: Feet | None) -> tuple[Array, Array]:
        """What the data measure, and the residuals. Raises `NoValueError` where an observable does not exist."""
        data, points = self.data, self.data.points
        seen = observe(sol, data.targets)
        for name, value in seen.items():
            if not np.isfinite(value):
                raise NoValueError(f"{name} does not exist")
        computed = [np.array([float(seen[name]) for name in data.targets])]
        residuals = [np.array([(seen[name] - value) / data.sizes[name] for name, value in data.targets.items()])]
        if nearest is not None:
            computed.append(nearest.distance)
            residuals.append(nearest.distance)
        elif points is not None:
            for name, measured in points.columns.items():
                values = getattr(sol, name)
                off = values - measured
                if points.wrapped and name == "alpha":
                    off = np.remainder(off + np.pi, 2 * np.pi) - np.pi
                computed.append(values)
                residuals.append(off / points.sizes[name])
        return np.concatenate(computed), np.concatenate(residuals)
