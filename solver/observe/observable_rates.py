"""The derivatives of observables.

The formula of an observable (`observe.observables`) is computed with numbers that carry their derivatives, so it is
written once. What it is made of, the integrals and extremes that `observe.measurement` measures along the rod, is
differentiated by the core, and along helices, of constant angle, here. The derivative of a whole number is 0 where it
exists.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..core.measures import DENSITIES, RATED, densities
from ..core.tuning import BARELY
from ..numerics.arrays import ROUNDED, Array, Booleans, Integers
from ..numerics.complex_step import slopes_of, with_slopes
from ..orbits.periodic_orbit import HELIX
from ..orbits.potential import slopes_by_loads
from ..orbits.shape_arrays import ShapeArrays
from ..problem.dimensionless import FieldRates, StartProblem
from ..problem.errors import InputError, choices
from .measurement import MeasuredNumbers, Pair
from .motions import LOST, MARKS, PARTLY, Motion, RatedNumbers, StartRates, marks_of, shape_rates
from .observables import OBSERVABLES, SEVERAL, STRAIGHT, check_names, is_count

EXTREMES = {  # the density, and whether the size counts
    "low": ("angle", False),
    "high": ("angle", False),
    "tightest": ("curvature", False),
    "least": ("outward", False),
    "most": ("outward", False),
    "tension": ("tension", True),
}

# relative: a change that is the same all along a helix, but for rounding. x10: small changes along it count as none
_STEADY = 1e-10


def check_observables(names: Any) -> tuple[str, ...]:
    """The names as a tuple. Raises `InputError` for an unknown name, and for an observable without a derivative."""
    checked = check_names(names)
    for name in checked:
        if not _has_derivative(name):
            able = filter(_has_derivative, OBSERVABLES)
            raise InputError(f"the derivative of {name!r} is not known; choose from {choices(able)}")
    return checked


def _has_derivative(name: str) -> bool:
    """Whether it may change along with a rod on the wall; its derivative is known, or 0 of a whole number."""
    row = OBSERVABLES[name]
    return not row.free and (set(row.measured) <= {*RATED, "middle turned", "middle risen"} or is_count(name))


_OWN_SLOPES = ("alpha", "z", "middle turned", "middle risen", "beta0", "betaL", "dbeta0", "dbetaL")


class Moving(MeasuredNumbers):
    """What `MeasuredNumbers` reads of a solution, as numbers that carry their derivatives with respect to F fields."""

    def __init__(self, sol: ShapeArrays, rates: FieldRates, measured: Iterable[str]) -> None:
        super().__init__(sol)
        self._plain = MeasuredNumbers(sol)
        self._rates = rates
        self._wanted = set(measured)
        shape = sol.problem.size, len(rates.fields)
        self._slopes = {name: np.full(shape, np.nan) for name in (*self._wanted, *_OWN_SLOPES, "half_period")}

    def measurement(self, rows: Any, given: bool = False) -> RatedNumbers:
        """What is to be measured of some cases for their derivatives.

        given: whether the values of what is measured are known; else, where the method knows orbits, they are measured
        together with the derivatives.
        """
        plain, names = self.plain, self._wanted & {*RATED}
        observed = names & {"peak", "lifts"} if given or self.sol.trajectory.orbit is None else ()
        plain.measure(self._wanted if given else observed)
        values = () if given else {*names, "push"} - {"middle push"} if "middle push" in names else names
        middle = [name for name in PARTLY if f"middle {name}" in self._wanted and not given]
        seen = {name: plain.value(name)[rows] for name in observed}
        return RatedNumbers(plain.sign[rows], plain.doubt[rows], names, values, middle, plain.goal, seen)

    def take(self, rows: Any, at_start: StartRates) -> None:
        """Take the derivatives of some cases; where the method knows the orbits, what was measured on them too."""
        slopes = {**at_start.rates, "half_period": at_start.half_period, **_at_marks(at_start.marks)}
        for name, value in slopes.items():
            self._slopes[name][rows] = value
        if self.sol.trajectory.orbit is None:
            return
        moves = (at_start.kind != LOST) & (at_start.kind != HELIX)
        cases = np.arange(self.sol.problem.size)[rows][moves]
        if cases.size == self.sol.problem.size:
            self.plain.know(at_start.values, at_start.middle)
            return
        self.plain.measure(at_start.values)
        others = (
            ({name: self.plain.get(name) for name in at_start.values}, at_start.values),
            ({name: self.plain.middle(name) for name in at_start.middle}, at_start.middle),
        )
        self.plain.know(*({name: _merge(old[name], cases, new[name], moves) for name in new} for old, new in others))

    def add_helices(self, motion: Motion, unit: Array, rates: FieldRates) -> None:
        """Differentiate what is measured on helices.

        unit: of `solution_derivatives.amounts`. rates: of these cases.
        """
        sign, later = self.plain.sign[motion.rows], rates.of("span")
        measured = of_helices(motion, unit, later, sign, self._wanted, self.sol.t[motion.rows])
        for name, value in (measured | _at_marks(_marks_of(motion, unit, later))).items():
            self._slopes[name][motion.rows] = value

    @property
    def plain(self) -> MeasuredNumbers:
        return self._plain

    def at_jump(self, value: float) -> Any:
        unknown = np.full((self.sol.problem.size, len(self._rates.fields)), np.nan)
        return with_slopes(np.full(self.sol.problem.size, value), unknown)

    def carry(self, value: Any, name: str) -> Any:
        if name in self._slopes:
            return with_slopes(value, self._slopes[name])
        return with_slopes(value, self._rates.by(name) if name in ("E", "a") else self._rates.of(name))

    def get(self, name: str) -> Any:
        return self.carry(self.plain.value(name), name), 0.0

    def middle(self, name: str) -> Any:
        value, error = self.plain.middle(name)
        return self.carry(value, f"middle {name}"), error

    @cached_property
    def loads(self) -> Any:
        phi, lam, mu = (self.carry(getattr(self.sol.problem, name), name) for name in ("phi", "lam", "mu"))
        return phi * self.A / self.rho**2, lam * self.A / self.rho, mu * self.A / self.rho


def _merge(old: Pair, rows: Integers, new: Pair, moves: Booleans) -> Pair:
    """Numbers and errors (B,), in some rows those of others."""
    values, errors = (np.array(array) for array in old)
    values[rows], errors[rows] = (array[moves] for array in new)
    return values, errors


def _marks_of(motion: Motion, unit: Array, later: Array) -> Array:
    """The derivatives of helices at the marks in units of rho, (b, 5, F, 4), as of `motions.StartRates`."""
    problem, t = motion.problem, marks_of(motion.problem)
    out = motion.varied.change(t, unit).rows
    loads = np.stack([problem.lam, problem.mu, problem.phi], axis=1)
    beta, none = np.broadcast_to(problem.beta0[:, None], t.shape), np.zeros(t.shape)
    known = {"t": t, "beta": beta, "rate": none, "z": none, "loads": loads, "span": problem.span}
    shape_rates(out, {**known, "later": later})
    return out.swapaxes(0, 1)


def _at_marks(marks: Array) -> dict[str, Array]:
    """The derivatives of `_OWN_SLOPES`, (b, F) each: of beta and beta_t at the ends, of what alpha and z/rho gain."""
    beta, rate, turned, risen = marks.transpose(1, 3, 0, 2)[:4]
    return {
        "alpha": turned[3],
        "z": risen[3],
        "beta0": beta[0],
        "betaL": beta[3],
        "dbeta0": rate[0],
        "dbetaL": rate[3],
        "middle turned": turned[2] - turned[1],
        "middle risen": risen[2] - risen[1],
    }


def derivatives_of(names: Sequence[str], read: Moving) -> Array:
    """The derivatives of observables, (K, B, F); NaN of one that depends on nothing that has derivatives."""
    unknown = complex(0.0, np.nan)
    numbers = np.zeros((len(names), len(read._rates.fields), read.sol.problem.size), dtype=complex)
    for k, name in enumerate(names):
        if not is_count(name):
            value = OBSERVABLES[name].compute(read)[0]
            numbers[k] = value if np.iscomplexobj(value) else unknown
    return slopes_of(numbers)


def measure_of(name: str) -> tuple[str, ...]:
    """What is measured along the rod for the derivative of an observable."""
    return () if is_count(name) else OBSERVABLES[name].measured


def why_missing(name: str, sol: ShapeArrays) -> str:
    """Why a derivative of an observable of a solved case does not exist."""
    row = OBSERVABLES[name]
    if sol.trajectory.shapes is not None and row.undefined:
        return f"no derivative where {row.undefined}"
    if name == "bend_number" and sol.trajectory.orbit is None:
        return "no derivative: the method knows no orbit, so it has no period"
    several = SEVERAL if set(measure_of(name)) & set(EXTREMES) else STRAIGHT
    return f"no derivative: {row.not_smooth or several}"


def of_helices(motion: Motion, unit: Array, later: Array, sign: Array, wanted: set[str], t: Array) -> dict[str, Array]:
    """How what is measured along helices answers F changes, and half a period, (b, F) each, by name.

    An extreme has a derivative where every place of the rod changes equally. unit: (b, 5, F), of
    `solution_derivatives.amounts`. later: (b, F), the change of the length in t. sign: (b,), of `Case.outward`. t:
    (b, n), the stations.
    """
    rods = _Helices(motion, unit, later, sign, t)
    measures: dict[str, Array] = {"half_period": np.full_like(later, np.nan)}
    for name in wanted:
        if name in EXTREMES:
            measures[name] = rods.extreme(*EXTREMES[name])
        elif name in DENSITIES:  # its integral has the same name
            measures[name] = rods.integral(name)[:, 3]
    if "peak" in wanted:  # it stays at the start of a rod that remains a helix
        measures["peak"] = 0 * rods.extreme("outward")
    if wanted & {"pushed", "pulled", "share", "middle push", "lifts"}:
        measures |= {name: value for name, value in rods.pushes().items() if name in wanted}
    return measures


@dataclass(frozen=True, eq=False)
class _Rates:
    """A density on b helices: values and the sizes of their terms (b,), its derivatives by beta (b, 1) and by the
    fields at a constant beta, (b, F)."""

    values: Array
    size: Array
    by_beta: Array
    own: Array


@dataclass(frozen=True, eq=False)
class _Helices:
    motion: Motion
    unit: Array
    later: Array
    sign: Array
    stations: Array

    @property
    def problem(self) -> StartProblem:
        return self.motion.problem

    @cached_property
    def angle_integrals(self) -> Array:
        """The integrals of d beta up to the marks, (b, 4, F)."""
        H_q = slopes_by_loads(self.problem.beta0[:, None])[..., 0]
        moved = self.motion.varied.change(marks_of(self.problem), self.unit).integrals
        return np.asarray(np.einsum("bmgk,bk->bmg", moved, H_q) / (H_q**2).sum(axis=1)[:, None, None])

    @cached_property
    def along(self) -> Array:
        """d beta at the stations and the marks, (b, F, n)."""
        t = np.concatenate([self.stations, marks_of(self.problem)], axis=1)
        return np.asarray(self.motion.varied.change(t, self.unit).beta.swapaxes(1, 2))

    def rates(self, density: str) -> _Rates:
        problem, beta = self.problem, self.problem.beta0[:, None]
        loads = np.stack([problem.lam, problem.mu, problem.phi, self.sign], axis=1)
        values, size, _, by_beta, _, *by_load = densities(density, loads, beta, 0 * beta)
        by_loads = np.einsum("kb,bkg->bg", np.stack(by_load)[..., 0], self.unit[:, 2:])
        return _Rates(values[:, 0], size[:, 0], by_beta, by_loads)

    def changes(self, rates: _Rates) -> tuple[Array, Array]:
        """The changes of a density along the rods, (b, F, n), and the sizes of their terms, (b, F)."""
        moved = rates.by_beta[..., None] * self.along
        return moved + rates.own[..., None], np.abs(moved).max(axis=2) + np.abs(rates.own)

    def least(self, rates: _Rates, size: Array) -> Array:
        """What counts as no difference between changes of a density, (b, F); size: of their terms.

        Also what rounding makes of changes that cancel: those of the fields by which `unit` moves the helix.
        """
        return _STEADY * size + ROUNDED * rates.size[:, None] * np.abs(self.unit).sum(axis=1)

    def extreme(self, density: str, size_counts: bool = False) -> Array:
        rates = self.rates(density)
        change, size = self.changes(rates)
        steady = np.ptp(change, axis=2) <= self.least(rates, size)
        if not size_counts:
            return np.where(steady, change[..., 0], np.nan)
        none = np.abs(rates.values) <= BARELY * rates.size
        sized = np.where(none, 0.0, np.sign(rates.values))[:, None] * change[..., 0]
        return np.where(steady & ~(none[:, None] & (size > 0)), sized, np.nan)

    def integral(self, density: str) -> Array:
        """Up to the marks, (b, 4, F)."""
        rates = self.rates(density)
        shares = MARKS[:, None]
        rate = rates.own * self.problem.span[:, None] + rates.values[:, None] * self.later
        return np.asarray(rates.by_beta[:, None] * self.angle_integrals + shares * rate[:, None])

    def pushes(self) -> dict[str, Array]:
        """Of what is measured of the push; none where it is zero, and a change would make it push or pull."""
        rates = self.rates("outward")
        none = np.abs(rates.values) <= BARELY * rates.size
        pushes, pulls = ((turn * rates.values > 0)[:, None] & ~none[:, None] for turn in (1, -1))
        change, size = self.changes(rates)
        unsure = none[:, None] & (np.abs(change).max(axis=2) > self.least(rates, size))
        whole = self.integral("outward")
        by_name = {
            "pushed": np.where(pushes, whole[:, 3], 0.0),
            "pulled": np.where(pulls, -whole[:, 3], 0.0),
            "share": np.where(pushes, self.later, 0.0),
            "middle push": np.where(pushes, whole[:, 2] - whole[:, 1], 0.0),
            "lifts": np.where(pulls, 0.0, self.later),
        }
        return {name: np.where(unsure, np.nan, value) for name, value in by_name.items()}
