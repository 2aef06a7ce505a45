"""Leaps along a branch: beside a helix, and where steps become too small and the branch goes on."""

from dataclasses import replace

import numpy as np

from ..equilibrium.given_numbers import OrbitState
from ..equilibrium.system import LEFT, state_of
from ..levels.line_point import Path
from ..levels.path_orbits import orbit_of
from ..levels.transit_times import height_scale
from ..mechanics.potential import slope
from ..numerics.arrays import Array
from .branch_events import Bounds
from .branch_states import BranchState, begin_at
from .continuation import Stopped, carry
from .family import Family
from .leaps import Line, leap, shape_of

_BESIDE_HELIX = 1e-6  # of the size of G: H at the ends of a rod that is nearly a helix
_BESIDE_HELD_HELIX, _HELD_LEAP = 1e-3, 0.05  # the same with held ends; of p's scale, the way past a helix
_BESIDE_HINGE, _SHORTER = 0.01, (5e-3, 5e-4)  # rad between the ends of a hinged rod there; shorter ways past it
_LITTLE = 0.01  # the share of the way to the next halt that a leap must pass
_SLIGHT = 0.1  # rad: the range of beta of a rod beside a helix


def creeps(state: BranchState, there: BranchState, bounds: Bounds, leap: bool) -> bool:
    """Whether p changes by rounding; or, in a leap beside a helix, by little of the way to the next halt."""
    far, ahead = abs(there.p - state.p), abs(bounds.next(state.p, state.rises > 0) - state.p)
    if far < 100 * bounds.rounding:
        return True
    return leap and far < _LITTLE * ahead and bool(np.ptp(_shape(there)) < _SLIGHT)


def _shape(state: BranchState) -> Array:
    """beta along the rod."""
    at = state.curve.at(state.node.w)
    return np.empty(0) if at is None else shape_of(orbit_of(at[0].problem, at[1]))[0]


def is_near_helix(state: BranchState) -> bool:
    """Whether the rod would be a helix at a parameter so near that its level leaves the range of floats there."""
    found, family = state.curve.at(state.node.w), state.curve.family
    if found is None or abs(np.sin((found[0].start - found[0].end) / 2)) > (_BESIDE_HINGE if family.hinged else 0):
        return False
    problem = found[0].problem
    near = _BESIDE_HELIX if family.is_dead else _BESIDE_HELD_HELIX
    pull = np.abs([slope(problem, end)[0] for end in (problem.beta0, problem.betaL)])
    if not 0 < pull.max() < near * height_scale(problem):
        return False
    return not family.hinged or bool(np.ptp(_shape(state)) < _SLIGHT)  # ends of a long rod rest next to saddles too


def held_leap(
    here: OrbitState, p: float, rises: bool, family: Family, bounds: Bounds, share: float = _HELD_LEAP
) -> BranchState | str:
    """The equilibrium beyond a helix, or from it on, by the continuation of `continuation`.

    share: of p's scale, the longest way.
    """
    far = p + float(np.clip(bounds.next(p, rises) - p, -share * family.scale, share * family.scale))
    given = family.given(far)
    if given is None:
        return LEFT
    found = carry(here, given)
    if isinstance(found, Stopped):
        return found.reason
    return begin_at(replace(family, begun=found.problem), found.path, far, rises)


def leap_on(state: BranchState, bounds: Bounds) -> BranchState | None:
    """The equilibrium a little farther on, with a close shape and the same Morse index."""
    if not state.curve.family.is_dead:
        at = state.curve.at(state.node.w) if is_near_helix(state) else None
        if at is None:
            return None
        family = state.curve.family
        here = state_of(at[0].problem, at[1], family.hinged)
        for share in (_HELD_LEAP, *(_SHORTER if family.hinged else ())):
            found = held_leap(here, state.p, state.rises > 0, family, bounds, share)
            if not isinstance(found, str):
                return found
        return None
    return leap_from(state.curve.family, state.path(), state.p, state.rises > 0, bounds)


def leap_from(family: Family, path: Path, p: float, rises: bool, bounds: Bounds) -> BranchState | None:
    far = p + float(np.clip(bounds.next(p, rises) - p, -family.scale, family.scale))
    first, last = family.place(p), family.place(far)
    if first is None or last is None:
        return None
    found = leap(Line(first.problem, last.problem), first.problem, path, 0.0)
    if found is None:
        return None
    begun = begin_at(family, found[0].path, p + found[1] * (far - p), rises)
    return None if isinstance(begun, str) else begun
