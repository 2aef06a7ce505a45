"""Scalar functions of a solution: what a study tabulates. Each returns one number a case, (*cases).

Means and extremes are read at points that resolve the orbit (`sampling`), not at the stations asked for, so a rod of a
million bends seen at 201 stations is measured as well as one of three. Where the method knows no orbit the stations
have to do.
"""

from collections.abc import Callable, Iterable
from functools import cached_property
from typing import Any

import numpy as np

from . import statics
from .action import energies
from .course import LIBRATION, ROTATION
from .errors import no_such
from .landscape import potential
from .methods.orbit import Orbit
from .overlap import overlaps
from .reduced import flat
from .sampling import Sampled, sampled
from .solution import Solution
from .stability import index_at_stations, jacobi_zeros


class Reading:
    """A solution and the points at which it is read, found once for all observables."""

    def __init__(self, sol: Solution) -> None:
        self.sol = sol

    @cached_property
    def sampled(self) -> Sampled:
        return sampled(self.sol)

    def each(self, values: Any) -> Any:
        """Values (B,) in the shape of the cases."""
        return self.sol._each(values)


def turns(read: Reading) -> Any:
    """Interior extrema of beta: the bends one counts. A helix that only trembles by rounding has none."""
    sol, orbit = read.sol, read.sol.trajectory.orbit
    if orbit is None:
        sign = np.sign(sol.dbeta)
        count = np.count_nonzero(sign[..., 1:] * sign[..., :-1] < 0, axis=-1)
        return np.where(_swings(read), count, 0)[()]
    return _whole(read, np.where(np.reshape(_swings(read), -1), orbit.turns - _just_turned(orbit), 0))


def _just_turned(orbit: Any) -> Any:
    """Whether the far end itself, which is not interior, is the last turning point, but for rounding, (B,)."""
    span, swing = orbit.problem.span, orbit.ahead + orbit.back
    where = orbit.locate(span[:, None])
    since = np.where(where.second[:, 0], orbit.back, orbit.ahead) - where.local[:, 0]
    return where.mirrored[:, 0] & (since <= np.minimum(1e-12 * span, 1e-6 * swing))


def _swings(read: Reading) -> Any:
    """Whether beta changes by more than rounding, and, where no orbit is known, than the error allowed, (*cases)."""
    sol, points = read.sol, read.sampled.solution
    rounding = 64 * 2.0**-52 * np.maximum(1, np.abs(points.beta).max(axis=-1))
    allowed = np.minimum(2 * np.asarray(sol.error), 1e-6)
    if sol.trajectory.orbit is None:
        allowed = np.fmax(allowed, sol.tol)
    return np.ptp(points.beta, axis=-1) > np.fmax(rounding, allowed)


def bend_number(read: Reading) -> Any:
    """L over half a period of beta: the number of bends without its steps; 0 where beta does not swing."""
    orbit = read.sol.trajectory.orbit
    if orbit is None:
        return read.each(np.full(read.sol.case.size, np.nan))
    with np.errstate(divide="ignore", invalid="ignore"):
        swings = (orbit.kind == LIBRATION) & np.reshape(_swings(read), -1)
        count = np.where(swings, orbit.problem.span / (orbit.ahead + orbit.back), 0.0)
    return read.each(count)


def loops(read: Reading) -> Any:
    """Full turns of beta between the two ends of the rod (a rod whose beta swings has none)."""
    orbit, sol = read.sol.trajectory.orbit, read.sol
    if orbit is None:
        return np.floor(np.ptp(sol.beta, axis=-1) / (2 * np.pi)).astype(int)
    with np.errstate(divide="ignore", invalid="ignore"):
        count = np.where(orbit.kind == ROTATION, np.floor(orbit.problem.span / orbit.ahead), 0)
    return _whole(read, count)


def amplitude(read: Reading) -> Any:
    """Largest less smallest beta along the rod [rad]."""
    swing = read.sampled.largest(lambda at: at.beta) + read.sampled.largest(lambda at: -at.beta)
    orbit = read.sol.trajectory.orbit
    if orbit is None:
        return swing
    rotates = read.each(orbit.kind == ROTATION)
    way = np.abs(orbit.at(orbit.problem.span[:, None])[0][:, 0] - orbit.problem.beta0)
    return np.where(rotates, read.each(way), swing)[()]


def kappa_mean(read: Reading) -> Any:
    """Mean curvature [1/length]."""
    return _mean(read, read.sampled.integral(lambda at: at.kappa))


def kappa_max(read: Reading) -> Any:
    """Largest curvature [1/length]."""
    return read.sampled.largest(lambda at: at.kappa)


def wraps(read: Reading) -> Any:
    """Turns about the axis, (alpha(L) - alpha(0))/2 pi."""
    return _gain(read)[0] / (2 * np.pi)


def height(read: Reading) -> Any:
    """z(L) [length]."""
    return _gain(read)[1] * flat(read.sol.case.rho, read.sol.case.shape).reshape(read.sol.case.shape)[()]


def contact_mean(read: Reading) -> Any:
    """Mean of |f| [force/length]: pull counts like push."""
    return _mean(read, read.sampled.integral_of_size(lambda at: at.contact))


def contact_min(read: Reading) -> Any:
    """Smallest f [force/length], positive outward."""
    return -read.sampled.largest(lambda at: -at.contact)


def contact_max(read: Reading) -> Any:
    """Largest f [force/length], positive outward."""
    return read.sampled.largest(lambda at: at.contact)


def attached(read: Reading) -> Any:
    """Share of the length where the cylinder pushes; elsewhere the equations hold the rod on."""
    return read.sampled.share_not_negative(lambda at: at.push)


def energy(read: Reading) -> Any:
    """Bending energy less the work of the dead loads, the twist eliminated [force length]."""
    sol, orbit = read.sol, read.sol.trajectory.orbit
    if isinstance(orbit, Orbit):
        first = orbit.at(np.zeros((orbit.problem.size, 1)))
        level = first[1][:, 0] ** 2 + potential(orbit.problem, orbit.problem.beta0)
        unit = flat(sol.case.rod.bending_stiffness / sol.case.rho, sol.case.shape)
        return read.each(unit * energies(orbit, level))
    return read.sampled.integral(lambda at: statics.energy_density(at._loads[0], at.h, at.dbeta))


def index(read: Reading) -> Any:
    """Morse index of the shape between its own two end angles, the loads dead: 0 is stable.

    NaN where it cannot be told: the case is not solved; or the method knows no orbit, and the stations do not resolve
    the shape or its condition number leaves too few digits.
    """
    sol, problem, told = read.sol, read.sol.problem, read.sol.trajectory
    if told.orbit is not None:
        found = jacobi_zeros(told.orbit.exact)
    else:
        found = index_at_stations(problem, sol.t, told.beta, told.dbeta)
        found = np.where((told.error <= 1e-3) & (told.condition <= 1e8), found, np.nan)
    return _whole(read, np.where(np.reshape(sol.solved, -1), found, np.nan))


def _whole(read: Reading, values: Any) -> Any:
    """Whole numbers as such where all of them are known, in the shape of the cases."""
    return read.each(values.astype(np.int64) if (np.abs(values) < 2**62).all() else values)


def _mean(read: Reading, integral: Any) -> Any:
    return integral / read.sampled.integral(lambda at: np.ones(at.beta.shape))


def _gain(read: Reading) -> tuple[Any, Any]:
    """alpha(L) - alpha(0) [rad] and z(L)/rho, (*cases)."""
    sol, orbit = read.sol, read.sol.trajectory.orbit
    if orbit is None:
        return read.each(sol.trajectory.alpha[:, -1]), read.each(sol.trajectory.z[:, -1])
    _, _, alpha, z = orbit.at(orbit.problem.span[:, None])
    return read.each(alpha[:, 0]), read.each(z[:, 0])


def overlapping(read: Reading) -> Any:
    """1 where the rod would pass through itself, else 0; NaN where that cannot be told."""
    return overlaps(read.sol, kappa_max(read))


OBSERVABLES: dict[str, Callable[[Reading], Any]] = {
    "turns": turns,
    "bend_number": bend_number,
    "loops": loops,
    "amplitude": amplitude,
    "kappa_mean": kappa_mean,
    "kappa_max": kappa_max,
    "wraps": wraps,
    "height": height,
    "contact_mean": contact_mean,
    "contact_min": contact_min,
    "contact_max": contact_max,
    "attached": attached,
    "overlaps": overlapping,
    "energy": energy,
    "index": index,
}


def observe(sol: Solution, names: Iterable[str]) -> dict[str, Any]:
    """The named observables of a solution: name -> (*cases), a number for a single case; NaN where a case has no shape.

    names: of `OBSERVABLES`, whose units and long names are in `solver.quantities`: `observe(sol, ["turns", "energy"])`.
    Raises `InputError` for an unknown name.
    """
    names = list(names)
    for name in names:
        if name not in OBSERVABLES:
            raise no_such("observable", name, OBSERVABLES)
    read = Reading(sol)
    shapeless = np.asarray(read.each(~np.isfinite(sol.trajectory.beta).all(axis=1)))
    found = {name: OBSERVABLES[name](read) for name in names}
    if not shapeless.any():  # whole numbers stay whole
        return found
    return {name: np.where(shapeless, np.nan, values)[()] for name, values in found.items()}
