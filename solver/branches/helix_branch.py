"""A helix followed over one parameter.

Where its Morse index changes, other equilibria branch off. Under dead loads it ceases to exist where H = H' = 0; a long
rod that lies along it reaches a fold next to that parameter, nearer than its level can tell. Under held ends a rod is
one where the given numbers are those of a helix; elsewhere it bends.
"""

from functools import partial
from itertools import pairwise

import numpy as np
import scipy  # its parts are imported when used

from ..core.tuning import NUDGE
from ..numerics.arclength import BRANCH_POINT, PITCHFORK, difference_rates
from ..numerics.arrays import ALIKE, NEGLIGIBLE, ROUNDED, Array
from ..numerics.roots import REACH, halve, root, sign_changes
from ..orbits.periodic_orbit import helix_half_waves, helix_index
from ..orbits.potential import slope, slope_higher_rates, slope_rate
from ..problem.dimensionless import EndsProblem
from .branch_events import Bounds, Place
from .family import Family
from .given_numbers import OrbitState
from .held_index import index_of
from .helices import helices_of

_STEP = 0.25  # of the parameter's scale. x10: changes of the index that undo each other within a step are missed
# of the parameter's scale: how near a helix must cease for a branch to end there. x10: a stored branch would end so,
# wrongly
_CEASES = 1e-2
# rad about a helix, and the share of the rod that lies there. The angle x10: other helices lie within it; the share
# x10: no helix is found
_ALONG, _SHARE = 0.15, 0.2


def helix_places(
    family: Family, begun: EndsProblem, p: float, rises: bool, bounds: Bounds
) -> tuple[list[Place], float | None]:
    """The helices after that of the problem `begun` at p, in order, and the parameter of the last if the rod is none
    beyond; else None."""
    places, step, last = list[Place](), _STEP * family.scale, helix_place(family, p, begun)
    if last is None:
        return places, p
    while len(places) < bounds.most:
        halt = bounds.next(last.p, rises)
        target = bounds.snap(min(last.p + step, halt) if rises else max(last.p - step, halt))
        place = helix_place(family, target, last.problem)
        if place is None:
            return places, last.p
        places += [*_special_places(family, last, place), place]
        if bounds.is_end(place.p, 1.0 if rises else -1.0):
            break
        last = place
    return places, None


def helix_place(family: Family, p: float, near: EndsProblem) -> Place | None:
    """The helix at p, under held ends that near the helix of another problem; None where the rod is none."""
    if family.is_dead:
        boundary = family.boundary(p)
        if boundary is None or boundary.helix is None:
            return None
        return Place(p, boundary.helix, boundary.problem, int(helix_index(helix_half_waves(boundary.problem))[0]))
    given, helix = family.given(p), _helix_with(family, p, near)
    if given is None or helix is None:
        return None
    index = index_of(helix, given)
    return Place(p, helix.path, helix.problem, int(index) if np.isfinite(index) else None)


def _helix_with(family: Family, p: float, near: EndsProblem) -> OrbitState | None:
    """The helix with the given numbers at p, that with the nearest angle."""
    given, beta = family.given(p), float(near.beta0[0])
    helices = [] if given is None else helices_of(given)[0]
    apart = [abs(float(helix.problem.beta0[0]) - beta) for helix in helices]
    return helices[int(np.argmin(apart))] if apart and min(apart) < REACH else None


def _special_places(family: Family, before: Place, after: Place) -> list[Place]:
    """The special points between two helices, each two of them with a helix between."""
    special = _where_waves_fit(family, before, after) if family.is_dead else _where_index_changes(family, before, after)
    between = [helix_place(family, (a.p + b.p) / 2, a.problem) for a, b in pairwise(special)]
    every = [place for pair in zip(special, [*between, None], strict=True) for place in pair] if special else []
    return [place for place in every if place is not None]


def _where_waves_fit(family: Family, before: Place, after: Place) -> list[Place]:
    """Under dead loads: with H' = r^2 on the helix, its index is the number of n with n pi < r L, and equilibria of n
    half waves branch off where r L = n pi."""

    def waves(p: float) -> float:
        boundary = family.boundary(p)
        assert boundary is not None
        return float(helix_half_waves(boundary.problem)[0])

    ends = before.p, after.p
    low, high = sorted(map(waves, ends))
    numbers = range(int(np.floor(low)) + 1, int(np.ceil(high)))
    tol = {"xtol": ROUNDED * abs(ends[1] - ends[0]), "rtol": ROUNDED}
    every = [float(scipy.optimize.brentq(lambda p, n=n: waves(p) - n, *ends, **tol)) for n in numbers]
    return [_special(family, p, before) for p in (every if waves(before.p) < waves(after.p) else every[::-1])]


def _where_index_changes(family: Family, before: Place, after: Place) -> list[Place]:
    """Under held ends: the given numbers do not determine the helix where the determinant of their derivatives is 0."""
    if before.index is None or after.index is None or before.index == after.index:
        return []
    if abs(before.index - after.index) > 1 and abs(before.p - after.p) > ROUNDED * family.scale:
        middle = helix_place(family, (before.p + after.p) / 2, before.problem)
        if middle is not None and middle.index is not None:
            parts = (before, middle), (middle, after)
            return [place for part in parts for place in _where_index_changes(family, *part)]

    def determinant(p: float) -> float:
        given, helix = family.given(p), _helix_with(family, p, before.problem)
        assert given is not None
        assert helix is not None
        return float(np.linalg.det(helix.rates.rows_of(given.names, given.ratio)[0][0]))

    def is_after(p: float) -> bool:
        place = helix_place(family, p, before.problem)
        return place is None or place.index != before.index

    ends, width = (before.p, after.p), ROUNDED * abs(after.p - before.p)
    if determinant(before.p) * determinant(after.p) < 0:
        return [_special(family, float(scipy.optimize.brentq(determinant, *ends, xtol=width, rtol=ROUNDED)), before)]
    share = halve(lambda share: is_after(before.p + share * (after.p - before.p)), 0.0, 1.0, ALIKE)[1]
    return [_special(family, before.p + share * (after.p - before.p), before)]


def _special(family: Family, p: float, near: Place) -> Place:
    """The special point at p: what branches off lies to both sides of p alike where the rod bends in an even number of
    half waves, and where G is symmetric about the helix."""
    place = helix_place(family, p, near.problem)
    assert place is not None
    waves = float(helix_half_waves(place.problem)[0])
    # a number of half waves that differs less from an even number is even
    even = abs(waves - 2 * np.round(waves / 2)) < ALIKE
    # H'' is 0 at a helix about which G is symmetric
    even = even or abs(float(slope_higher_rates(place.problem, place.problem.beta0)[0][0])) < NEGLIGIBLE
    return Place(p, place.path, place.problem, place.index, PITCHFORK if even else BRANCH_POINT)


def end_of_helix(family: Family, p: float, beta: Array) -> tuple[float, float] | None:
    """The parameter at which the helix that a rod lies along ceases to exist, and its beta; None if none does near p.

    beta: along the rod at p, at equal steps (n,).
    """
    boundary = family.boundary(p)
    if boundary is None:
        return None

    def equations(x: Array) -> Array | None:
        """H and H' at an angle and a parameter over its scale."""
        at = family.boundary(x[1] * family.scale)
        return None if at is None else np.concatenate([slope(at.problem, x[:1]), slope_rate(at.problem, x[:1])])

    def double_root(x: Array) -> tuple[Array, Array] | None:
        off, rates = equations(x), difference_rates(equations, x, NUDGE)
        return None if off is None or rates is None else (off, rates)

    angles = np.linspace(beta.min() - _ALONG, beta.max() + _ALONG, 2001)
    rate = partial(slope_rate, boundary.problem)
    for near in sign_changes(rate, angles, rate(angles)).tolist():
        if np.mean(np.abs(beta - near) < _ALONG) < _SHARE:
            continue
        end = root(double_root, np.array([near, p / family.scale]), np.inf)
        if end is None:
            continue
        angle, at = float(end[0]), float(end[1]) * family.scale
        if abs(at - p) < _CEASES * family.scale and abs(angle - near) < _ALONG:
            return at, angle
    return None
