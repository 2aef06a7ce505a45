"""A helix followed over one parameter: where its Morse index changes, other equilibria branch off; where it ceases.

A helix ceases to exist where H = H' = 0. A long rod that lies along it reaches a fold next to that parameter, nearer
than its level can tell.
"""

import numpy as np
import scipy  # its parts are imported when used

from ..levels.line_point import LinePoint
from ..levels.morse_index import helix_half_waves, helix_index
from ..mechanics.potential import slope, slope_higher_rates, slope_rate
from ..numerics.arclength import BRANCH_POINT, PITCHFORK
from ..numerics.arrays import Array
from ..numerics.roots import root
from .branch_events import Bounds, Place
from .family import Family

_STEP = 0.25  # of the parameter's scale
_SAME = 1e-9
_BESIDE = 1e-2  # of the parameter's scale: how near a helix ceases that ends a branch
_ALONG, _SHARE = 0.15, 0.2  # rad about a helix, and the share of the rod that lies there
_ROUNDS, _NUDGE = 20, 1e-6  # of Newton's rule; of the parameter's scale, for differences


def helix_places(family: Family, p: float, rises: bool, bounds: Bounds) -> tuple[list[Place], float | None]:
    """The helices after the one at p, in order, and the parameter of the last if the rod is none beyond; else None.

    With H' = r^2 on the helix, its index is the number of n with n pi < r L; equilibria of n half waves branch off
    where r L = n pi. For even n, and where G is symmetric about the helix, they do so to both sides of p alike.
    """
    places, step = list[Place](), _STEP * family.scale
    here = p
    while len(places) < bounds.most:
        halt = bounds.next(here, rises)
        there = bounds.snap(min(here + step, halt) if rises else max(here - step, halt))
        place = family.place(there)
        if place is None or place.helix is None:
            return places, here
        places += [*_branch_points(family, here, there), helix_place(place, there)]
        if bounds.is_end(places[-1].p, 1.0 if rises else -1.0):
            break
        here = there
    return places, None


def helix_place(place: LinePoint, p: float, kind: str = "") -> Place:
    helix = place.helix
    assert helix is not None
    return Place(p, helix, place.problem, int(helix_index(helix_half_waves(place.problem))[0]), kind)


def _branch_points(family: Family, p: float, q: float) -> list[Place]:
    """The special points between two parameters, from p to q."""

    def waves(at: float) -> float:
        place = family.place(at)
        assert place is not None
        return float(helix_half_waves(place.problem)[0])

    begin, end = waves(p), waves(q)
    low, high = sorted((begin, end))
    found = list[Place]()
    for n in range(int(np.floor(low)) + 1, int(np.ceil(high))):
        at = float(scipy.optimize.brentq(lambda one, n=n: waves(one) - n, p, q, xtol=1e-15 * abs(p - q), rtol=1e-15))
        between = (found[-1].p + at) / 2 if found else at
        place, middle = family.place(at), family.place(between)
        assert place is not None
        assert middle is not None
        found += [helix_place(middle, between)] if found else []
        even = abs(slope_higher_rates(place.problem, place.problem.beta0)[0][0]) < _SAME
        found.append(helix_place(place, at, PITCHFORK if n % 2 == 0 or even else BRANCH_POINT))
    return found if begin < end else found[::-1]


def end_of_helix(family: Family, p: float, beta: Array) -> tuple[float, float] | None:
    """The parameter at which the helix that a rod lies along ceases to exist, and its beta; None if none does near p.

    beta: along the rod at p, at equal steps (n,).
    """
    place = family.place(p)
    if place is None:
        return None
    angles = np.linspace(beta.min() - _ALONG, beta.max() + _ALONG, 2001)
    rates = slope_rate(place.problem, angles)
    for i in np.flatnonzero(rates[1:] * rates[:-1] < 0):
        if np.mean(np.abs(beta - angles[i]) < _ALONG) < _SHARE:
            continue
        end = _double_root(family, float(angles[i]), p)
        if end is not None and abs(end[0] - p) < _BESIDE * family.scale and abs(end[1] - angles[i]) < _ALONG:
            return end
    return None


def _double_root(family: Family, angle: float, p: float) -> tuple[float, float] | None:
    """The parameter and the angle near a guess where H = H' = 0."""

    def at(x: Array) -> tuple[Array, Array] | None:
        here, *sides = (family.place((x[1] + nudge) * family.scale) for nudge in (0, -_NUDGE, _NUDGE))
        if here is None or sides[0] is None or sides[1] is None:
            return None
        off, low, high = (
            np.concatenate([slope(one.problem, x[:1]), slope_rate(one.problem, x[:1])])
            for one in (here, *sides)
            if one is not None
        )
        bend = float(slope_higher_rates(here.problem, x[:1])[0][0])
        return off, np.column_stack([[off[1], bend], (high - low) / (2 * _NUDGE)])

    found = root(at, np.array([angle, p / family.scale]), np.inf, _ROUNDS)
    return None if found is None else (float(found[1]) * family.scale, float(found[0]))
