"""Equilibria under given loads with a given bending moment at an end, by a scan over the angle there.

The loads, the angle of the hinge and beta_t there make a start problem, whose far end has to meet the other given
number. It is marched from many angles of a whole turn, and each change of sign is a start. The angles lie close where
the orbit passes next to a saddle, because there the far end moves fast.
"""

from functools import partial

import numpy as np

from ..branches.given_numbers import LOADS, Given, OrbitState
from ..branches.orbit_rates import start_rates
from ..branches.path_correction import state_from_start
from ..numerics.arrays import FAINT, NEGLIGIBLE, Array
from ..numerics.roots import roots_between, sign_changes
from ..orbits.boundary import boundary_of
from ..orbits.periodic_orbit import solve_orbit
from ..orbits.potential import TAU, potential, slope
from ..problem.dimensionless import EndsProblem, StartProblem

_ANGLES = 1440  # of a turn, evenly. x10: only time
# distances [rad] from the angles whose orbits reach a saddle: eight a decade, from rounding on. x10: angles within
# 1e-12 of a saddle are not scanned
_CLOSER = np.logspace(-13, -2, 89)


def states_between_hinges(given: Given) -> list[OrbitState]:
    """The equilibria; none where a load is not given, or no end has a given beta_t."""
    if not {*LOADS} <= {*given.names} or not given.has_hinge:
        return []
    backward = "dbeta0" not in given.names  # the equation is the same from the far end, with -beta_t
    sign, near, far = (-1.0, "betaL", "beta0") if backward else (1.0, "beta0", "betaL")
    rate = sign * given.number(f"d{near}", 0.0)
    loads = {name: np.array([given.number(name, 0.0)]) for name in LOADS}

    def ends(angle: Array) -> tuple[Array, Array]:
        row = np.zeros(angle.size, dtype=int)
        same = {name: value[row] for name, value in loads.items()}
        span = np.full(angle.size, given.span)
        orbit = solve_orbit(StartProblem(beta0=angle, dbeta0=np.full(angle.size, rate), span=span, **same), FAINT)
        beta, speed, _, _ = orbit.at(span[:, None])
        return beta[:, 0], speed[:, 0]

    def off(angle: Array) -> Array:
        beta, speed = ends(angle)
        if f"d{far}" in given.names:
            return np.asarray(speed - sign * given.number(f"d{far}", 0.0))
        return np.sin((beta - given.number(far, 0.0)) / 2)  # 0 at each whole turn from the given angle

    problem = EndsProblem(beta0=np.zeros(1), betaL=np.zeros(1), span=np.array([given.span]), **loads)
    roots = roots_between(off, _angles(problem, rate))[0]  # straight rods and helices are known
    states = []
    for angle, beta, speed in zip(roots, *ends(roots), strict=True):
        # where beta_tt is 0 as well, the rod is a helix, and helices are found as such
        if rate == 0 and abs(float(slope(problem, np.array([angle]))[0])) < NEGLIGIBLE:
            continue
        beta0, dbeta0 = (beta, -speed) if backward else (angle, rate)
        turns = given.number(far, beta) - beta  # whole turns
        start = StartProblem(beta0=np.array([beta0 + turns]), dbeta0=np.array([dbeta0]), span=problem.span, **loads)
        rates = start_rates(start)
        if np.isfinite(rates.values).all():
            states.append(state_from_start(rates, float(dbeta0)))
    return states


def _angles(problem: EndsProblem, rate: float) -> Array:
    """A turn of angles, rising: evenly, and close to those from which the orbit reaches a saddle."""
    even = np.linspace(-np.pi, np.pi, _ANGLES + 1)
    special = [boundary_of(problem).saddles]
    for height in potential(problem, special[0]) - rate**2:
        above = partial(lambda height, angle: potential(problem, angle) - height, height)
        special.append(sign_changes(above, even, above(even)))
    near = np.concatenate(special)[:, None] + np.concatenate([-_CLOSER, _CLOSER])
    return np.unique(np.concatenate([even, (near.ravel() + np.pi) % TAU - np.pi]))
