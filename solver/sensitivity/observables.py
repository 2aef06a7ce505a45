"""The derivatives of observables.

The formula of an observable (`observe.observables`) is computed with numbers that carry their derivatives, so it is
written once. What it is made of, the integrals and extremes that `observe.measurement` measures along the rod, is
differentiated by `integrals` and `extremes`. The derivative of a whole number is 0 where it exists.
"""

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any

import numpy as np

from ..mechanics.potential import Loads
from ..numerics.arrays import Array
from ..observe import densities
from ..observe.density_rates import RATES
from ..observe.measurement import Reading
from ..observe.observables import OBSERVABLES, is_count
from ..observe.rod_pieces import Angles
from ..orbit.pieces import ROTATION
from ..orbit.variation_nodes import slopes_by_loads
from ..problem.errors import InputError, choices, no_such
from ..problem.field_rates import FieldRates
from ..problem.reduced import flat
from ..solution import Solution
from .along import amounts
from .density_changes import DensityChange
from .dual import Dual
from .extremes import extreme
from .integrals import integral, parts
from .motions import Motion

SEVERAL = "no derivative: several places of the rod reach the extreme, and a change moves them apart"
NO_ORBIT = "no derivative: the method knows no orbit, so it has no period"
STRAIGHT = "no derivative: the rod is straight, or has no such period, where the value is not smooth"
_EXTREMES = {
    "low": (densities.angle, False),
    "high": (densities.angle, True),
    "tightest": (densities.curvature, True),
    "least": (densities.outward, False),
    "most": (densities.outward, True),
}
_INTEGRALS = {"curvature": densities.curvature, "bending": densities.bending, "potential": densities.potential}
_PUSHES = ("pushed", "pulled", "share")
MEASURED = (*_EXTREMES, *_INTEGRALS, *_PUSHES)
_STEADY = 1e-10  # relative: a change that is the same all along a helix


def checked_observables(names: Any) -> tuple[str, ...]:
    """The names as a tuple. Raises `InputError` for an unknown name, and for an observable without a derivative."""
    wanted = (names,) if isinstance(names, str) else tuple(names)
    able = [name for name, row in OBSERVABLES.items() if set(row.measured) <= set(MEASURED) or is_count(name)]
    for name in wanted:
        if name not in OBSERVABLES:
            raise no_such("observable", name, OBSERVABLES)
        if name not in able:
            raise InputError(f"the derivative of {name!r} is not known; choose from {choices(able)}")
    return wanted


class Moving(Reading):
    """What `Reading` reads of a solution, as numbers that carry their derivatives with respect to F fields."""

    def __init__(self, sol: Solution, rates: FieldRates, measured: Iterable[str]) -> None:
        super().__init__(sol)
        self.plain = Reading(sol)
        self._rates = rates
        self._wanted = set(measured)
        self.plain.measure(self._wanted)
        shape = sol.problem.size, len(rates.fields)
        self._slopes = {name: np.full(shape, np.nan) for name in (*self._wanted, "alpha", "z", "half_period")}

    def add(self, motion: Motion, rates: FieldRates) -> None:
        """Differentiate what is measured on the cases of a motion; rates: of these cases."""
        unit = amounts(self.sol, motion, rates)
        sign = flat(self.sol.case.outward, self.sol.case.shape)[motion.rows]
        found = _of_helices if motion.orbits is None else _of_orbits
        for name, value in found(motion, unit, rates.span, sign, self._wanted).items():
            self._slopes[name][motion.rows] = value
        beta, later = self._far_angle(motion), rates.span
        integrals = np.einsum("bfk,bfg->bgk", motion.far.integrals[:, 0], unit)
        self._slopes["alpha"][motion.rows] = integrals[..., 0] + np.sin(beta)[:, None] * later
        self._slopes["z"][motion.rows] = integrals[..., 2] + np.cos(beta)[:, None] * later

    @staticmethod
    def _far_angle(motion: Motion) -> Array:
        span = motion.problem.span[:, None]
        return motion.problem.beta0 if motion.orbits is None else motion.orbits.varied.beta(span)[:, 0]

    def get(self, name: str) -> Any:
        return Dual(self.plain.value(name), self._slopes[name]), 0.0

    def scaled(self, name: str, factor: Any) -> Any:
        return self.get(name)[0] * factor, 0.0

    @cached_property
    def rho(self) -> Any:
        return Dual(self.plain.rho, self._rates.rho)

    @cached_property
    def A(self) -> Any:
        return Dual(self.plain.A, self._rates.A)

    @cached_property
    def nu(self) -> Any:
        return Dual(self.plain.nu, self._rates.nu)

    @property
    def mu(self) -> Any:
        return Dual(self.plain.mu, self._rates.mu)

    @cached_property
    def length(self) -> Any:
        return Dual(self.plain.length, self._rates.span)

    @cached_property
    def gain(self) -> Any:
        return tuple(Dual(value, self._slopes[k]) for value, k in zip(self.plain.gain, ("alpha", "z"), strict=True))

    @property
    def half_period(self) -> Dual:
        """Half a period of beta in t."""
        orbit = self.sol.trajectory.orbit
        return Dual(orbit.ahead + orbit.back, self._slopes["half_period"])


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


# Observables whose formula distinguishes cases.
_OWN: dict[str, Callable[[Moving], Any]] = {"amplitude": _amplitude, "bend_number": _bend_number}


def derivative_of(name: str, read: Moving) -> Array:
    """The derivatives of an observable, (B, F)."""
    if is_count(name):
        return np.zeros((read.sol.problem.size, len(read._rates.fields)))
    found = _OWN[name](read) if name in _OWN else OBSERVABLES[name].compute(read)[0]
    return np.asarray(found.slope if isinstance(found, Dual) else found)


def measured_of(name: str) -> tuple[str, ...]:
    """What is measured along the rod for the derivative of an observable."""
    return () if is_count(name) else OBSERVABLES[name].measured


def why_missing(name: str, sol: Solution) -> str:
    """Why a derivative of an observable of a solved case does not exist."""
    if name == "bend_number":
        return NO_ORBIT if sol.trajectory.orbit is None else STRAIGHT
    return SEVERAL if set(measured_of(name)) & set(_EXTREMES) else STRAIGHT


def _of_orbits(motion: Motion, unit: Array, later: Array, sign: Array, wanted: set[str]) -> dict[str, Array]:
    """The derivatives of what is measured, (b, F) each, and of half a period."""
    orbits = motion.orbits
    assert orbits is not None
    a0, e = np.einsum("bf,bfg->bg", orbits.a0, unit), np.einsum("bfk,bfg->bgk", orbits.e, unit)
    varied, places = orbits.varied, (orbits.start, orbits.end)
    found = {"half_period": -np.einsum("bk,bgk->bg", varied.gain[:, :, :4].sum(axis=1), e)}
    one = np.ones(motion.problem.size)

    def measure(density: Any, turn: Array) -> DensityChange:
        return DensityChange(motion.problem, varied, places, density, turn, a0, e, later)

    for name in wanted:
        if name in _EXTREMES:
            density, largest = _EXTREMES[name]
            found[name] = extreme(measure(density, sign if density is densities.outward else one), largest)
        elif name in _INTEGRALS:
            found[name] = integral(measure(_INTEGRALS[name], one))
    if wanted & set(_PUSHES):
        found |= dict(zip(_PUSHES, parts(measure(densities.outward, sign)), strict=True))
    return {name: value for name, value in found.items() if name in wanted or name == "half_period"}


def _of_helices(motion: Motion, unit: Array, later: Array, sign: Array, wanted: set[str]) -> dict[str, Array]:
    """Of rods of constant angle; an extreme has a derivative where every place of the rod changes equally."""
    problem, beta = motion.problem, motion.problem.beta0[:, None]
    angles, loads = Angles(beta, 0 * beta, np.sin(beta), np.cos(beta)), Loads.columns(problem)
    case, H_q = np.arange(beta.size), slopes_by_loads(beta)[..., 0]
    turned = np.einsum("bfk,bk->bf", motion.far.integrals[:, 0], H_q) / (H_q**2).sum(axis=1)[:, None]
    whole = np.einsum("bf,bfg->bg", turned, unit)  # the integral of d beta
    along = np.einsum("bnf,bfg->bgn", motion.along.beta, unit)
    loads_moved = unit[:, 2:]
    found: dict[str, Array] = {"half_period": np.full_like(whole, np.nan)}

    def rates(density: Any, turn: Array) -> tuple[Array, Array, Array]:
        made = RATES[density](angles, loads)
        by_load = (np.broadcast_to(rate, beta.shape)[:, 0] for rate in (made.lam, made.mu, made.phi))
        own = np.einsum("kb,bkg->bg", np.stack(list(by_load)), loads_moved)
        pieces: Any = _Point(problem, angles, case)
        value = density(pieces).values
        return turn[:, None] * value, turn[:, None] * made.beta, turn[:, None] * own

    def integral(density: Any, turn: Array) -> Array:
        value, by_beta, own = rates(density, turn)
        return np.asarray(by_beta * whole + own * problem.span[:, None] + value * later)

    one = np.ones(problem.size)
    for name in wanted:
        if name in _EXTREMES:
            density = _EXTREMES[name][0]
            _, by_beta, own = rates(density, sign if density is densities.outward else one)
            moved = by_beta[..., None] * along
            spread, size = np.ptp(moved, axis=2), np.abs(moved).max(axis=2) + np.abs(own)
            found[name] = np.where(spread <= _STEADY * size, moved[..., 0] + own, np.nan)
        elif name in _INTEGRALS:
            found[name] = integral(_INTEGRALS[name], one)
    if wanted & set(_PUSHES):
        value, change = rates(densities.outward, sign)[0], integral(densities.outward, sign)
        pushes, pulls = value > 0, value < 0
        parts = np.where(pushes, change, 0.0), np.where(pulls, -change, 0.0), np.where(pushes, later, 0.0)
        found |= {name: part for name, part in zip(_PUSHES, parts, strict=True) if name in wanted}
    return found


class _Point:
    """What a density needs of rod pieces."""

    def __init__(self, problem: Any, angles: Angles, case: Array) -> None:
        self.problem, self.angles, self.case = problem, angles, case
