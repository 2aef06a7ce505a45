"""Integrals and extremes along each rod, in units of A and rho, with their errors, (B,) each.

They are computed on the panels of the orbit where the method knows it. Elsewhere they are computed on polynomials
between the stations, and the error is the change when every other station is left out; it is NaN where the stations
do not resolve every bend or do not cover the whole rod.
"""

from collections.abc import Iterable, Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from ..core.measures import measure
from ..nodes.loaded_rod import ALPHA, SHORT, SPEED
from ..numerics.arrays import EPS, NEGLIGIBLE, Array, Integers
from ..numerics.roots import EXACT
from ..orbits.marched_orbit import MarchedOrbit
from ..orbits.periodic_orbit import TIGHT, solve_orbit
from ..orbits.potential import steepest
from ..orbits.shape_arrays import ShapeArrays
from ..problem.dimensionless import flat
from ..problem.errors import InputError
from ..problem.trajectory import stood_in
from .solution_pieces import blocks, is_resolved, off_between, pieces_of

# times the error of a marched orbit, which is a standard deviation: a bound in every test. x10: stated errors ten times
# too large
SPREAD = 10
# of the tolerance, for the series of the densities, whose error is not stated apart. x10: still a hundredth
_SHARE = 1e-3

Pair = tuple[Any, Any]  # values and errors, (B,) each
MIDDLE = (1 / 3, 2 / 3)  # of the length: where its middle third begins and ends
_MIDDLE = "middle "  # before the names of what is measured there


class MeasuredNumbers:
    """A solution and the numbers measured on it; each density is computed once for all observables and cautions."""

    def __init__(self, sol: ShapeArrays) -> None:
        self.sol = sol
        self._known: dict[str, Pair] = vars(sol).setdefault("_measured", {})  # of the whole length, kept with it
        self._middle: dict[str, Pair] = {}
        self._in_middle: set[str] = set()  # what will be measured there, together

    def measure(self, wanted: Iterable[str]) -> None:
        """Compute every group of numbers that contains one of the names, on the same pieces.

        A name with "middle" before it is computed when it is first read.
        """
        names = set(wanted)
        middle = {name for name in names if name.startswith(_MIDDLE)}
        self._in_middle |= {name.removeprefix(_MIDDLE) for name in middle}
        if missing := names - middle - self._known.keys():
            self._known.update(self._measure(missing))

    def middle(self, name: str) -> Pair:
        """An integral in t over the middle third of the length, and its error, (B,) each."""
        if name not in self._middle:
            low, high = (self._measure(self._in_middle | {name}, until) for until in MIDDLE)
            for key in low:
                self._middle[key] = high[key][0] - low[key][0], high[key][1] + low[key][1]
        return self._middle[name]

    def over(self, name: str, until: float, cases: Integers) -> Array:
        """A number of some cases (k,) measured over the first share `until` of the length, (k,)."""
        return np.asarray(self._measure({name}, until, cases)[name][0])

    def _measure(self, wanted: set[str], until: float = 1.0, cases: Integers | None = None) -> dict[str, Pair]:
        """The numbers of the groups that contain these names, over the first share `until` of the length; of all cases,
        or of those with these numbers, rising."""
        sol, sign, error, goal = self.sol, self.sign, self.doubt, self.goal
        measures: list[dict[str, Pair]] = []
        for block in blocks(np.arange(sol.problem.size) if cases is None else cases):
            pieces, given = pieces_of(sol, block, until), {"sign": sign[block], "error": error[block]}
            measured = measure(pieces, given, wanted, goal)
            if sol.trajectory.orbit is None and sol.trajectory.shapes is None:
                if "peak" in wanted:  # at each bend the maximum is off by another amount
                    wide = given | {"error": error[block] + off_between(sol, block)}
                    measured |= measure(pieces, wide, ["peak"], goal)
                coarse = measure(pieces_of(sol, block, until, 2), given, wanted, goal)
                dense, shapeless = is_resolved(sol)[block], np.zeros(error[block].size, dtype=bool)
                shapeless[pieces.case[np.isnan(pieces.series[pieces.row]).any(axis=(1, 2))]] = True
                for name, (value, doubt) in measured.items():
                    with np.errstate(invalid="ignore"):  # of a case without a shape
                        doubt = np.where(dense, doubt + np.abs(value - coarse[name][0]), np.nan)
                        measured[name] = np.where(shapeless, np.nan, value), doubt
            if "lifts" in measured and sol.trajectory.shapes is not None:
                measured["lifts"] = _later_lift_offs(sol, block, *measured["lifts"])
            measures.append(measured)
        if len(measures) == 1:
            return measures[0]
        joined: dict[str, Pair] = {}
        for name in measures[0]:
            values, errors = zip(*(part[name] for part in measures), strict=True)
            joined[name] = np.concatenate(values), np.concatenate(errors)
        return joined

    def know(self, numbers: Mapping[str, Pair], middle: Mapping[str, Pair] = MappingProxyType({})) -> None:
        """Take numbers that are known already, and over the middle third, in place of what would be measured."""
        self._known = {**self._known, **numbers}  # the solution keeps what was measured
        self._middle.update(middle)

    @cached_property
    def sign(self) -> Array:
        """The sign of the push, (B,)."""
        return flat(self.sol.case.outward, self.sol.case.shape)

    @cached_property
    def doubt(self) -> Array:
        """What beta may be off for the errors of what is measured, (B,)."""
        error = np.where(np.isfinite(self.error), self.error, 1.0)
        return np.maximum(error, 4 * EPS) * (SPREAD if isinstance(self.sol.trajectory.orbit, MarchedOrbit) else 1)

    @property
    def goal(self) -> float:
        """The allowed error of the series of densities, relative."""
        return float(max(_SHARE * self.sol.tol, EXACT))

    def get(self, name: str) -> Pair:
        """A number measured along the rod and its error, (B,) each."""
        if name not in self._known:
            self.measure([name])
        return self._known[name]

    def value(self, name: str) -> Array:
        """A number measured along the rod, (B,)."""
        value: Array = self.get(name)[0]
        return value

    def error_of(self, name: str) -> Array:
        """Its error, (B,)."""
        error: Array = self.get(name)[1]
        return error

    def scale(self, name: str, factor: Array) -> Pair:
        """A number and its error in other units, (B,) each."""
        value, error = self.get(name)
        return value * factor, error * factor

    def each(self, values: Any) -> Any:
        """Values (B,) in the shape of the cases."""
        return self.sol._each(values)

    @cached_property
    def error(self) -> Array:
        """Estimated error of beta, and of alpha and z over max(1, L/rho), (B,)."""
        return np.asarray(self.sol.trajectory.error)

    def carry(self, value: Any, name: str) -> Any:
        """A number (B,) as formulas take it: itself; `sensitivity` adds its derivatives, which it knows by name."""
        return value

    @cached_property
    def rho(self) -> Any:
        return self.carry(flat(self.sol.case.rho, self.sol.case.shape), "rho")

    @cached_property
    def A(self) -> Any:
        return self.carry(flat(self.sol.case.rod.bending_stiffness, self.sol.case.shape), "A")

    @cached_property
    def E(self) -> Any:
        """Young's modulus, (B,). Raises `InputError` for a rod that has none."""
        if self.sol.case.rod.E is None:
            raise InputError("bending_stress_max is E a kappa_max, and a rod with EI and GJ has no E; omit it")
        return self.carry(flat(self.sol.case.rod.E, self.sol.case.shape), "E")

    @cached_property
    def a(self) -> Any:
        return self.carry(flat(self.sol.case.rod.a, self.sol.case.shape), "a")

    @cached_property
    def ratio(self) -> Any:
        """A/C, (B,)."""
        return self.carry(flat(self.sol.case.rod.stiffness_ratio, self.sol.case.shape), "ratio")

    @cached_property
    def unit_moment(self) -> Any:
        """A/rho [force length], (B,)."""
        return self.A / self.rho

    @cached_property
    def unit_force(self) -> Any:
        """A/rho^2 [force], (B,)."""
        return self.A / self.rho**2

    @cached_property
    def unit_push(self) -> Any:
        """A/rho^3 [force/length], (B,)."""
        return self.A / self.rho**3

    @cached_property
    def unit_mean_push(self) -> Any:
        """A/rho^3 over the length in t [force/length], (B,)."""
        return self.A / (self.rho**3 * self.length)

    @property
    def mu(self) -> Any:
        """M3 rho/A, (B,)."""
        return self.carry(self.sol.problem.mu, "mu")

    @cached_property
    def square_twist(self) -> Array:
        """The mean of the square of mu over the length, (B,)."""
        shapes: Any = self.sol.trajectory.shapes
        return np.asarray(self.mu**2 if shapes is None else shapes.numbers(lambda shape: shape.square_twist()))

    @cached_property
    def gain(self) -> tuple[Any, Any]:
        """alpha(L) - alpha(0) [rad] and z(L)/rho, (B,)."""
        turned, risen = self._gain()
        return self.carry(turned, "alpha"), self.carry(risen, "z")

    def _gain(self) -> tuple[Array, Array]:
        shape = self.sol.trajectory
        if shape.shapes is not None:
            first, last = shape.shapes.ends()
            return last[:, ALPHA] - first[:, ALPHA], self.sol.problem.span - last[:, SHORT]
        if shape.orbit is None or (self.sol.t[:, -1] == self.sol.problem.span).all():
            return shape.alpha[:, -1], shape.z[:, -1]
        _, _, alpha, z = shape.orbit.at(shape.orbit.problem.span[:, None])
        return alpha[:, 0], z[:, 0]

    @cached_property
    def loads(self) -> tuple[Any, Any, Any]:
        """FZ [force], MZ and M3 [force length], under which the rod is in equilibrium, (B,)."""
        FZ, MZ, M3 = (flat(load, self.sol.case.shape) for load in self.sol.loads)
        return FZ, MZ, M3

    @cached_property
    def end_rates(self) -> tuple[Any, Any]:
        """beta_t at the start and at the far end, (B,); NaN where the method knows no orbit and no station is there."""
        sol, orbit = self.sol, self.sol.trajectory.orbit
        if sol.trajectory.shapes is not None:
            first, last = sol.trajectory.shapes.ends()
            return first[:, SPEED], last[:, SPEED]
        rates = []
        for k, t, name in ((0, np.zeros_like(sol.problem.span), "dbeta0"), (-1, sol.problem.span, "dbetaL")):
            if (sol.t[:, k] == t).all():
                rate = sol.trajectory.dbeta[:, k]
            else:
                rate = np.full(t.size, np.nan) if orbit is None else orbit.at(t[:, None])[1][:, 0]
            rates.append(self.carry(rate, name))
        return rates[0], rates[1]

    @cached_property
    def end_angles(self) -> tuple[Any, Any]:
        """beta at the start and at the far end, (B,), where the method knows the orbit."""
        orbit = self.sol.trajectory.orbit
        return self.carry(orbit.problem.beta0, "beta0"), self.carry(orbit.far_angle, "betaL")

    @property
    def half_period(self) -> Any:
        """Half a period of beta in t, or a whole turn of it, (B,), where there is an `orbit`."""
        return self.carry(self.orbit.ahead + self.orbit.back, "half_period")

    @cached_property
    def orbit(self) -> Any:
        """The orbits, where the method knows them; of shapes on nodes under constant loads those of their starts."""
        sol, shapes = self.sol, self.sol.trajectory.shapes
        if sol.trajectory.orbit is not None or shapes is None or sol.case.varies:
            return sol.trajectory.orbit
        start = sol.problem.with_start(shapes.ends()[0][:, SPEED])
        return solve_orbit(stood_in(start, np.isfinite(start.dbeta0)), TIGHT)

    @property
    def plain(self) -> "MeasuredNumbers":
        """The numbers without derivatives: itself."""
        return self

    def at_jump(self, value: float) -> Any:
        """A value of cases in which a change of any field may make an observable jump: it has no derivative."""
        return value

    @property
    def steepness(self) -> Array:
        """The largest change of beta_t by a unit of beta, about, (B,)."""
        return np.sqrt(np.asarray(steepest(self.sol.problem)))

    @cached_property
    def length(self) -> Any:
        """Length of the rod in t, (B,); where no orbit is known, the length between the first and the last station."""
        t = self.sol.t
        known = self.sol.trajectory.orbit is not None or self.sol.trajectory.shapes is not None
        return self.carry(self.sol.problem.span if known or t.shape[1] < 2 else t[:, -1] - t[:, 0], "span")


def _later_lift_offs(sol: ShapeArrays, cases: Integers, first: Array, error: Array) -> Pair:
    """Where some cases (k,) lift off first, given where the push first is negative: a slight pull before is none."""
    first, shapes, span = first.copy(), sol.trajectory.shapes, sol.problem.span[cases]
    for k in np.flatnonzero(first < span).tolist():
        if (shape := shapes.of(int(cases[k]))) is None:  # of a rod that is not solved
            continue
        stretches = shape.lift_offs(1.0)
        begin = stretches[0][0] if stretches else span[k]
        if begin - first[k] > NEGLIGIBLE * span[k]:
            first[k] = begin
    return first, error
