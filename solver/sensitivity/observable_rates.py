"""The derivatives of observables.

The formula of an observable (`observe.observables`) is computed with numbers that carry their derivatives, so it is
written once. What it is made of, the integrals and extremes that `observe.measurement` measures along the rod, is
differentiated by `measured_orbits` and `measured_helices`. The derivative of a whole number is 0 where it exists.
"""

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any

import numpy as np

from ..equilibrium.orbit_rates import ends_of
from ..numerics.arrays import Array
from ..observe.measurement import Reading
from ..observe.observables import OBSERVABLES, check_names, is_count
from ..orbit.pieces import ROTATION
from ..problem.errors import InputError, choices
from ..problem.field_rates import FieldRates
from ..problem.reduced import flat
from ..shape import Shape
from .dual import Dual
from .extremes import EXTREMES, LIFTS, MEASURED, PEAK
from .measured_helices import of_helices
from .measured_orbits import of_orbits
from .motions import MARKS, Motion, marks_of

SEVERAL = "no derivative: several places of the rod reach the extreme, and a change moves them apart"
NO_ORBIT = "no derivative: the method knows no orbit, so it has no period"
STRAIGHT = "no derivative: the rod is straight, or has no such period, where the value is not smooth"
NO_TURN = "no derivative: the rod does not turn about the axis in its middle third"
TOUCHES = "no derivative: the push touches zero without a change of sign, where a change makes lift-off jump"
PLACES = "no derivative: several places of the rod have the largest push, or the place may leave an end of the rod"
SIZE = f"{SEVERAL}; or there is no force along the tangent"


def check_observables(names: Any) -> tuple[str, ...]:
    """The names as a tuple. Raises `InputError` for an unknown name, and for an observable without a derivative."""
    wanted = check_names(names)
    able = [name for name, row in OBSERVABLES.items() if set(row.measured) <= set(MEASURED) or is_count(name)]
    for name in wanted:
        if name not in able:
            raise InputError(f"the derivative of {name!r} is not known; choose from {choices(able)}")
    return wanted


_OWN_SLOPES = ("alpha", "z", "middle turned", "middle risen", "dbeta0", "dbetaL")


class Moving(Reading):
    """What `Reading` reads of a solution, as numbers that carry their derivatives with respect to F fields."""

    def __init__(self, sol: Shape, rates: FieldRates, measured: Iterable[str]) -> None:
        super().__init__(sol)
        self.plain = Reading(sol)
        self._rates = rates
        self._wanted = set(measured)
        self.plain.measure(self._wanted)
        shape = sol.problem.size, len(rates.fields)
        self._slopes = {name: np.full(shape, np.nan) for name in (*self._wanted, *_OWN_SLOPES, "half_period")}

    def add(self, motion: Motion, unit: Array, rates: FieldRates) -> None:
        """Differentiate what is measured on the cases of a motion.

        unit: of `solution_derivatives.amounts`. rates: of these cases.
        """
        sign = flat(self.sol.case.outward, self.sol.case.shape)[motion.rows]
        given = motion, unit, rates.span, sign, self._wanted
        seen = {name: self.plain.value(name)[motion.rows] for name in self._wanted & {PEAK, LIFTS}}
        found = of_helices(*given, self.sol.t[motion.rows]) if motion.varied is None else of_orbits(*given, seen)
        turned, risen = _gains(motion, unit, rates.span)
        found |= {"alpha": turned[:, 2], "z": risen[:, 2]}
        found |= {"middle turned": turned[:, 1] - turned[:, 0], "middle risen": risen[:, 1] - risen[:, 0]}
        found |= _end_rates(motion, unit, rates.span)
        for name, value in found.items():
            self._slopes[name][motion.rows] = value

    def get(self, name: str) -> Any:
        return Dual(self.plain.value(name), self._slopes[name]), 0.0

    def scale(self, name: str, factor: Any) -> Any:
        return self.get(name)[0] * factor, 0.0

    def middle(self, name: str) -> Any:
        return Dual(self.plain.middle(name)[0], self._slopes[f"middle {name}"]), 0.0

    @cached_property
    def rho(self) -> Any:
        return Dual(self.plain.rho, self._rates.rho)

    @cached_property
    def A(self) -> Any:
        return Dual(self.plain.A, self._rates.A)

    @cached_property
    def E(self) -> Any:
        return Dual(self.plain.E, self._rates.by("E"))

    @cached_property
    def a(self) -> Any:
        return Dual(self.plain.a, self._rates.by("a"))

    @cached_property
    def ratio(self) -> Any:
        return Dual(self.plain.ratio, self._rates.ratio)

    @property
    def mu(self) -> Any:
        return Dual(self.plain.mu, self._rates.mu)

    @cached_property
    def length(self) -> Any:
        return Dual(self.plain.length, self._rates.span)

    @cached_property
    def gain(self) -> Any:
        return tuple(Dual(value, self._slopes[k]) for value, k in zip(self.plain.gain, ("alpha", "z"), strict=True))

    @cached_property
    def loads(self) -> Any:
        numbers = ((getattr(self.sol.problem, name), getattr(self._rates, name)) for name in ("phi", "lam", "mu"))
        phi, lam, mu = (Dual(value, slope) for value, slope in numbers)
        return phi * self.A / self.rho**2, lam * self.A / self.rho, mu * self.A / self.rho

    @cached_property
    def end_rates(self) -> Any:
        pairs = zip(self.plain.end_rates, ("dbeta0", "dbetaL"), strict=True)
        return tuple(Dual(value, self._slopes[name]) for value, name in pairs)

    @property
    def half_period(self) -> Dual:
        """Half a period of beta in t."""
        orbit = self.sol.trajectory.orbit
        return Dual(orbit.ahead + orbit.back, self._slopes["half_period"])


def _gains(motion: Motion, unit: Array, later: Array) -> tuple[Array, Array]:
    """The derivatives of alpha and of z/rho, without their values at the start, at the marks, (b, 3, F) each."""
    problem, t = motion.problem, marks_of(motion.problem)
    beta = problem.beta0[:, None] if motion.varied is None else motion.varied.beta(t)
    found = motion.change(t, unit).integrals
    longer = later[:, None, :] * MARKS[:, None]
    return found[..., 0] + np.sin(beta)[..., None] * longer, found[..., 2] + np.cos(beta)[..., None] * longer


def _end_rates(motion: Motion, unit: Array, later: Array) -> dict[str, Array]:
    """The derivatives of beta_t at the two ends, (b, F) each."""
    rate = motion.change(ends_of(motion.problem), unit).rate
    bend = 0.0 if motion.varied is None else motion.end.H[:, None]  # -beta_tt at the far end
    return {"dbeta0": rate[:, 0], "dbetaL": rate[:, 1] - bend * later}


def _amplitude(read: Moving) -> Any:
    return read.value("high") - read.value("low")


def _bend_number(read: Moving) -> Any:
    orbit = read.sol.trajectory.orbit
    if orbit is None:
        return np.full((read.sol.problem.size, len(read._rates.fields)), np.nan)
    found = read.length / read.half_period
    count = OBSERVABLES["bend_number"].compute(read.plain)[0]
    bends = np.where((count > 0)[:, None], found.slope, np.nan)  # where beta does not change it is 0, with a jump
    return Dual(count, np.where((orbit.kind == ROTATION)[:, None], 0.0, bends))


def _pitch(read: Moving) -> Any:
    (turned, _), (risen, _) = read.middle("turned"), read.middle("risen")
    value = OBSERVABLES["pitch"].compute(read.plain)[0]
    found = 2 * np.pi * read.rho * risen / (turned * np.sign(turned.value))
    return Dual(value, np.where(np.isfinite(value)[:, None], found.slope, np.nan))


# Observables whose formula distinguishes cases.
_OWN: dict[str, Callable[[Moving], Any]] = {"amplitude": _amplitude, "bend_number": _bend_number, "pitch": _pitch}
_WHY = {"pitch": NO_TURN, "lift_off_at": TOUCHES, "push_max_at": PLACES, "F3_size_max": SIZE}


def derivative_of(name: str, read: Moving) -> Array:
    """The derivatives of an observable, (B, F)."""
    if is_count(name):
        return np.zeros((read.sol.problem.size, len(read._rates.fields)))
    found = _OWN[name](read) if name in _OWN else OBSERVABLES[name].compute(read)[0]
    return np.asarray(found.slope if isinstance(found, Dual) else found)


def measure_of(name: str) -> tuple[str, ...]:
    """What is measured along the rod for the derivative of an observable."""
    return () if is_count(name) else OBSERVABLES[name].measured


def why_missing(name: str, sol: Shape) -> str:
    """Why a derivative of an observable of a solved case does not exist."""
    if name == "bend_number":
        return NO_ORBIT if sol.trajectory.orbit is None else STRAIGHT
    if sol.case.varies and OBSERVABLES[name].undefined:
        return f"no derivative where {OBSERVABLES[name].undefined}"
    if name in _WHY:
        return _WHY[name]
    return SEVERAL if set(measure_of(name)) & set(EXTREMES) else STRAIGHT
