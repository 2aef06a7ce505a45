"""Variations of equilibria: how beta between two ends answers a change of an end angle or of the loads.

The orbit that joins the ends changes by a0 along its flow and by g0 of its level (`orbit.variations`); the two end
angles give two linear equations. Their determinant is eta(L) = d beta(L)/d beta_t(0), which vanishes at a fold.
"""

from dataclasses import replace

import numpy as np

from ..numerics.arrays import Array
from ..numerics.chebyshev import basis
from ..orbit.panels import panelled
from ..orbit.periodic_orbit import assembled
from ..orbit.variations import GOAL, LENGTH, POINTS, Place, Variations, variations_on
from ..problem.reduced import EndsProblem
from .branch_coordinates import LinePoint, Path
from .path_orbits import orbit_of
from .saddle_panels import with_saddle_panels
from .transit_times import STRETCH


def held_directions(start: Place, far: Place) -> tuple[Array, Array]:
    """a0 (B, 5) and e (B, 5, 4) of a unit of beta(0), beta(L), lam, mu and phi, each with the others held.

    start, far: the places at the two ends, (B,).
    """
    B = start.v.size
    e, moved = np.zeros((B, 5, 4)), np.zeros((2, B, 5))
    moved[0, :, 0] = moved[1, :, 1] = 1
    for q in (1, 2, 3):
        e[:, q + 1, q] = 1
    M = (far.M - start.M)[:, 0]
    v, V = start.v[:, None], far.v[:, None]
    with np.errstate(all="ignore"):
        lever, LEVER = (place.c * place.H / place.D for place in (start, far))
        r = moved[0] - _sum(e, start.shift) - _sum(e, start.gamma) * lever[:, None]
        R = moved[1] - _sum(e, far.shift) - _sum(e, far.gamma) * LEVER[:, None] - _sum(e, M) * V
        along = M[:, :1] * V + LEVER[:, None]
        determinant = v * along - lever[:, None] * V
        e[..., 0] = (v * R - V * r) / determinant
        return (r * along - lever[:, None] * R) / determinant, e


def _sum(e: Array, place: Array) -> Array:
    """The sums over the loads of e times values (B, 4), (B, 5)."""
    return np.einsum("bfk,bk->bf", e[..., 1:], place[:, 1:])


def equilibrium_variations(problem: EndsProblem, path: Path) -> Variations:
    """The variations of one equilibrium that is no helix, from its path."""
    known = orbit_of(problem, path)
    arcs, blank = known.arcs, LinePoint(problem).blank
    deepest = blank.deepest
    plain = replace(arcs, pieces=replace(arcs.pieces, base=np.zeros_like(arcs.pieces.base)))
    panels = panelled(known.problem, plain, basis(POINTS), LENGTH, GOAL, stretch=STRETCH)
    orbit = assembled(known.problem, plain, panels)
    excess = np.array([max(deepest - path.y, 0.0)])
    if excess[0] > 0:
        gap = np.array([path.sign * np.exp(max(path.y, deepest))])
        orbit = with_saddle_panels(orbit, problem.span, gap, excess)
    return variations_on(orbit, arcs)
