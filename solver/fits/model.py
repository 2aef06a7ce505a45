"""The residuals of a fit and their exact derivatives, at the numbers x of its parameters.

Those of points without arc length are the distances from their feet: the places of the unrolled curve nearest to them.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import SQUARE_LOST, Array
from ..numerics.roots import ROUNDS
from ..observe.observables import observe
from ..problem.case import Case, Ends
from ..problem.case_fields import with_fields
from ..problem.errors import InputError
from ..solution import Solution
from ..solve import solve
from .data import Data, MeasuredPoints, target_parts
from .parameters import Parameter, rates_at, values_at, values_in_words
from .start_force import with_start_force

_COARSE, _FINEST = 201, 6401  # stations of the first search, and at most. x10: only time
_TURN = 0.2  # rad between neighbouring stations of it, at most. x10: the nearest chord is not the nearest place

AtStations = Callable[[Array | int], Solution]


class NoValueError(Exception):
    """The reason why there are no residuals, or no derivatives, at some values of the parameters."""


@dataclass(frozen=True, eq=False)
class _Feet:
    """The feet of P points. sol: at the feet, which rise. order: the place in `sol` of the foot of each point.

    distance: signed, in units of the sizes of the points, (P,). by_alpha, by_z: its derivatives with respect to alpha
    and z of the curve at a constant s/L.
    """

    sol: Solution
    order: Array
    distance: Array
    by_alpha: Array
    by_z: Array


@dataclass(frozen=True, eq=False)
class _Evaluation:
    """The residuals at x.

    sol: at the stations of the points. moved: the rod that slides in another way, by that way. computed, (N,): what
    the data measure. residuals, (N,): in units of their sizes.
    """

    x: Array
    sol: Solution
    computed: Array
    residuals: Array
    feet: _Feet | None
    moved: dict[str, Solution]

    @property
    def place(self) -> Array:
        """The station of each point, or of its foot, (P,)."""
        return np.arange(self.sol.s.size) if self.feet is None else self.feet.order


@dataclass(frozen=True, eq=False)
class FitMinimum:
    """Where a local search ended.

    free: (F,), False at a bound. stop: why it ended early, or "".
    """

    found: _Evaluation
    jacobian: Array
    free: Array
    stop: str = ""

    @property
    def x(self) -> Array:
        return self.found.x

    @property
    def cost(self) -> float:
        """Half the sum of squares."""
        return float(self.found.residuals @ self.found.residuals) / 2


class Model:
    """What a search calls. It counts the solutions, the derivatives, and where there was no value."""

    def __init__(
        self,
        case: Case,
        parameters: Sequence[Parameter],
        data: Data,
        choose: Any,
        tol: float,
        FZ0: float | None = None,
    ) -> None:
        self.case, self.parameters, self.data, self.FZ0 = case, list(parameters), data, FZ0
        self.solves = self.derivatives = 0
        self.starts = 0  # Sobol' points of the search
        self.refused: Counter[str] = Counter()
        self._choose, self._tol = choose, tol
        self._branch: Solution | None = None
        self._last: _Evaluation | None = None
        self.accepted: list[tuple[_Evaluation, Array]] = []  # places of a search, and the derivatives there

    def begin(self) -> None:
        """Begin a search: the equilibrium of an ends problem is selected anew."""
        self._branch = self._last = None
        self.accepted = []

    def residuals(self, x: Array) -> Array:
        """The residuals (N,), NaN where there are none: a search then takes a shorter step."""
        try:
            return self.evaluation(x).residuals
        except NoValueError as error:
            self.refused[str(error)] += 1
            return np.full(self.data.size, np.nan)

    def evaluation(self, x: Array) -> _Evaluation:
        """The residuals at x. Raises `NoValueError` where there are none."""
        if self._last is None or not np.array_equal(self._last.x, x):
            self._last = self._evaluate(x)
        return self._last

    def jacobian(self, x: Array) -> Array:
        """The derivatives of the residuals by x, (N, F). Raises `NoValueError` where one does not exist."""
        if self.accepted and np.array_equal(self.accepted[-1][0].x, x):
            return self.accepted[-1][1]
        evaluation = self.evaluation(x)
        if isinstance(self.case.given, Ends):
            self._branch = evaluation.sol  # x was accepted
        self.derivatives += 1
        known = {way: self._rates(sol, way, x) for way, sol in {"": evaluation.sol, **evaluation.moved}.items()}
        rows = [known[way].observables[name] for name, way in map(target_parts, self.data.targets)]
        if self.data.points is not None:
            rows += list(self._of_points(evaluation, known[""]))
        rates = np.vstack(rows)[:, : x.size] / self.data.scales[:, None] * rates_at(self.parameters, x)
        self.accepted.append((evaluation, rates))
        return rates

    def _rates(self, sol: Solution, sliding: str, x: Array) -> Any:
        """The derivatives of a solution and of its targets at x. Raises `NoValueError` where one does not exist."""
        names, targets = [parameter.name for parameter in self.parameters], self._target_names(sliding)
        held = self.FZ0 is not None
        known = sol.sensitivity([*names, *["FZ"] * held], [*targets, *["FZ0"] * held])
        place = f"at {values_in_words(self.parameters, x)}"
        if not known.solved:
            raise NoValueError(f"{place}: {known.outcome}")
        for name, remark in known.remarks.items():
            if remark:
                raise NoValueError(f"{place}: {name} has {remark}")
        return known.with_given("FZ0", "FZ") if held else known

    def _target_names(self, sliding: str) -> list[str]:
        """The observables that are targets where the rod slides in a way."""
        return [name for name, way in map(target_parts, self.data.targets) if way == sliding]

    def _of_points(self, evaluation: _Evaluation, known: Any) -> list[Array]:
        """The derivatives of what is computed at the points, a block (P, F) for each column."""
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
            blocks.append(rates.T)
        return blocks

    @np.errstate(over="ignore", invalid="ignore")  # such values are refused at the end
    def _evaluate(self, x: Array) -> _Evaluation:
        values = values_at(self.parameters, x)
        case = self._case(values)
        points, nearest = self.data.points, None
        if points is not None and points.s is None:
            nearest = feet(lambda stations: self._solve(case, stations), points)
            sol = nearest.sol
        else:
            s = None if points is None else points.s
            if s is not None and s[-1] > float(case.rod.L):
                raise NoValueError("the rod is shorter than the s of a point")
            sol = self._solve(case, 2 if s is None else s)
        ways = dict.fromkeys(way for _, way in map(target_parts, self.data.targets) if way)
        moved = {way: self._solve(self._case({**values, "sliding": way}), 2) for way in ways}
        computed, residuals = self._compare(sol, nearest, moved)
        if not np.isfinite(residuals @ residuals):
            raise NoValueError("the squares of the residuals are beyond the range of floats")
        return _Evaluation(x.copy(), sol, computed, residuals, nearest, moved)

    def _case(self, values: Mapping[str, Any]) -> Case:
        """The case with other values of some fields. Raises `NoValueError`."""
        try:
            case = with_fields(self.case, values)
            return case if self.FZ0 is None else with_start_force(case, self.FZ0)
        except InputError as error:
            raise NoValueError(str(error)) from None

    def _solve(self, case: Case, stations: Any) -> Solution:
        self.solves += 1
        if self.FZ0 is None and self._branch is not None and case.cylinder.sliding == self.case.cylinder.sliding:
            sol = solve(case, self._tol, stations=stations, seed=self._branch)
        elif isinstance(case.given, Ends):
            sol = solve(case, self._tol, stations=stations, choose=self._choose)
        else:
            sol = solve(case, self._tol, stations=stations)
        if not sol.solved:
            raise NoValueError(str(sol.outcome))
        return sol

    def _compare(self, sol: Solution, nearest: _Feet | None, moved: dict[str, Solution]) -> tuple[Array, Array]:
        """What the data measure, and the residuals. Raises `NoValueError` where an observable does not exist."""
        data, points = self.data, self.data.points
        seen = {way: observe(each, self._target_names(way)) for way, each in {"": sol, **moved}.items()}
        targets = np.array([float(seen[way][name]) for name, way in map(target_parts, data.targets)])
        for name, value in zip(data.targets, targets, strict=True):
            if not np.isfinite(value):
                raise NoValueError(f"{name} does not exist")
        columns = [targets]
        if points is not None:
            columns += [getattr(sol, name) for name in points.columns] if nearest is None else [nearest.distance]
        computed = np.concatenate(columns)
        off = computed - data.measured
        if points is not None and points.wrapped:
            angles = np.array(data.groups) == "alpha"
            off[angles] = np.remainder(off[angles] + np.pi, 2 * np.pi) - np.pi
        return computed, off / data.scales


def feet(curve: AtStations, points: MeasuredPoints) -> _Feet:
    """The feet of points on a curve; curve: its solution at given stations.

    At a foot within the rod the distance is normal to the curve, so moving along the curve does not change it; its
    derivative is the normal component of the motion of the curve.
    """
    sol, s, turns, low, high = _nearest(curve, points)
    alpha, z = points.columns["alpha"] + 2 * np.pi * turns, points.columns["z"]
    wide, tall = points.sizes["alpha"], points.sizes["z"]
    L = float(sol.case.rod.L)
    for _ in range(ROUNDS):
        place, at = _at(curve, s)
        across, up, da, dz, along = _local(at, place, alpha, z, wide, tall)
        speed, bent = across**2 + up**2, along[0] * da + along[1] * dz
        rate = np.where(speed + bent > 0.3 * speed, speed + bent, speed)
        new = np.clip(s - (across * da + up * dz) / rate, low, high)
        step, s = np.abs(new - s).max(), new
        if step <= SQUARE_LOST * L:  # a foot is found: the distance is known to the square of it
            break
    place, at = _at(curve, s)
    across, up, da, dz, _ = _local(at, place, alpha, z, wide, tall)
    normal = across * dz - up * da
    distance = np.where(normal < 0, -1.0, 1.0) * np.hypot(da, dz)
    inside = (s > 0) & (s < L)
    length = np.hypot(across, up)
    with np.errstate(invalid="ignore", divide="ignore"):  # at an end the nearest place is the end itself
        to_end = np.where(distance == 0, 0.0, da / distance), np.where(distance == 0, 0.0, dz / distance)
    by_alpha = np.where(inside, -up / length, to_end[0]) / wide
    by_z = np.where(inside, across / length, to_end[1]) / tall
    return _Feet(at, place, np.where(inside, normal / length, distance), by_alpha, by_z)


def _at(curve: AtStations, s: Array) -> tuple[Array, Solution]:
    """The place of each s among them, and the solution at all of them in their rising order."""
    order = np.argsort(s, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(s.size)
    return place, curve(s[order])


def _local(
    at: Solution, place: Array, alpha: Array, z: Array, wide: Array, tall: Array
) -> tuple[Array, Array, Array, Array, tuple[Array, Array]]:
    """The tangent, the way from the point to the curve, and the rate of the tangent, in units of the sizes."""
    rho, beta, rate = float(at.case.rho), at.beta[place], at.dbeta[place]
    across, up = np.sin(beta) / rho / wide, np.cos(beta) / tall
    turning = np.cos(beta) * rate / rho / wide, -np.sin(beta) * rate / tall
    return across, up, (at.alpha[place] - alpha) / wide, (at.z[place] - z) / tall, turning


def _nearest(curve: AtStations, points: MeasuredPoints) -> tuple[Solution, Array, Array, Array, Array]:
    """For each point the nearest s on the polyline, the whole turns to add to its azimuth, and a bracket of s."""
    count = _COARSE
    while True:
        sol = curve(count)
        if count >= _FINEST or np.abs(np.diff(sol.beta)).max() <= _TURN:
            break
        count = 2 * count - 1
    alpha, z, s = sol.alpha, sol.z, sol.s
    best = np.full(points.size, np.inf)
    where, turns = np.zeros(points.size), np.zeros(points.size)
    for k in _turns(alpha, points):
        a = (alpha[:, None] - points.columns["alpha"] - 2 * np.pi * k) / points.sizes["alpha"]
        h = (z[:, None] - points.columns["z"]) / points.sizes["z"]
        da, dh = np.diff(a, axis=0), np.diff(h, axis=0)
        share = np.clip(-(a[:-1] * da + h[:-1] * dh) / (da**2 + dh**2), 0, 1)
        square = (a[:-1] + share * da) ** 2 + (h[:-1] + share * dh) ** 2
        i = square.argmin(axis=0)
        column = np.arange(points.size)
        closer = square[i, column] < best
        best = np.where(closer, square[i, column], best)
        where, turns = np.where(closer, i + share[i, column], where), np.where(closer, k, turns)
    step = s[1]
    foot = where * step
    return sol, foot, turns, np.maximum(foot - step, 0), np.minimum(foot + step, float(sol.case.rod.L))


def _turns(alpha: Array, points: MeasuredPoints) -> range:
    """The whole turns that may be added to the measured azimuths."""
    if not points.wrapped:
        return range(1)
    given = points.columns["alpha"]
    low, high = (alpha.min() - given.max()) / (2 * np.pi), (alpha.max() - given.min()) / (2 * np.pi)
    return range(int(np.floor(low)), int(np.ceil(high)) + 1)
