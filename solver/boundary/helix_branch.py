"""A helix followed over one parameter: where its Morse index changes, other equilibria branch off."""

import numpy as np
import scipy  # its parts are imported when used

from ..mechanics.potential import slope_higher_rates, slope_rate
from .branch_coordinates import LinePoint
from .branch_states import Bounds, Place
from .equilibrium_curve import Family

PITCHFORK, CROSSING = "pitchfork", "branch point"
_STEP = 0.25  # of the parameter's scale
_SAME = 1e-9


def helix_places(family: Family, p: float, rises: bool, bounds: Bounds) -> tuple[list[Place], float | None]:
    """The helices after the one at p, in order, and the parameter of the last if the rod is none beyond; else None.

    With H' = r^2 on the helix, its index is the number of n with n pi < r L; equilibria of n half waves branch off
    where r L = n pi. For even n, and where G is symmetric about the helix, they do so to both sides of p alike.
    """
    places, step = list[Place](), _STEP * family.scale
    here = p
    while len(places) < bounds.most:
        halt = bounds.next(here, rises)
        there = bounds.snapped(min(here + step, halt) if rises else max(here - step, halt))
        place = family.place(there)
        if place is None or place.helix is None:
            return places, here
        places += [*_branching(family, here, there), helix_place(place, there)]
        if bounds.is_end(places[-1], 1.0 if rises else -1.0):
            break
        here = there
    return places, None


def helix_place(place: LinePoint, p: float, kind: str = "") -> Place:
    helix = place.helix
    assert helix is not None
    return Place(p, helix, place.problem, _index(_half_waves(place)), kind)


def _half_waves(place: LinePoint) -> float:
    """r L/pi; 0 about a saddle."""
    rate = float(slope_rate(place.problem, place.problem.beta0)[0])
    return float(np.sqrt(max(rate, 0.0)) * place.problem.span[0] / np.pi)


def _index(half_waves: float) -> int:
    return max(int(np.ceil(half_waves * (1 - 1e-12))) - 1, 0)


def _branching(family: Family, p: float, q: float) -> list[Place]:
    """The special points between two parameters, from p to q."""

    def waves(at: float) -> float:
        place = family.place(at)
        assert place is not None
        return _half_waves(place)

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
        found.append(helix_place(place, at, PITCHFORK if n % 2 == 0 or even else CROSSING))
    return found if begin < end else found[::-1]
