"""A branch of equilibria followed over one parameter, through folds.

The branch is a curve in the plane of a coordinate of the level and the parameter (`equilibrium_curve`), followed by
pseudo-arclength steps (`numerics.arclength`). The coordinate is chosen anew at each step. Where the steps become too
small and the branch goes on (an end of the rod crosses a saddle, in a range as narrow as exp(-r L)), a leap is made, as
in `continuation`.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np
import scipy  # its parts are imported when used

from ..equilibrium.charts import CORNER
from ..equilibrium.held_index import index_of
from ..equilibrium.system import LEFT
from ..equilibrium.system import State as HeldState
from ..levels.line_point import Path
from ..levels.path_orbits import orbit_of
from ..levels.transit_times import height_scale
from ..mechanics.potential import slope
from ..numerics.arclength import advance
from ..numerics.arrays import Array
from .branch_states import Bounds, Place, State, begin_at, in_other_charts, rechart
from .branch_steps import AT_END, IS_CLOSED, ordinary_steps
from .continuation import Stopped, carry, state_of
from .family import Family
from .helix_branch import CROSSING, PITCHFORK, end_of_helix, helix_place, helix_places
from .leaps import Line, leap, shape_of

FOLD = "fold"
FIRST, LONGEST, SHORTEST = 0.02, 0.25, 1e-7  # lengths of steps, in scales
NARROW = 1e-3  # length of a step below which other coordinates and a leap are tried
_KEPT = 10  # steps for which another coordinate is kept
_EASY_BEND = 0.05  # distance from the predictor, as a share of the step, that the next step aims at
_LEAP = 1.0  # of the parameter's scale: the line whose shares `leaps.LEAPS` are leapt
_BESIDE_HELIX = 1e-6  # of the size of G: H at the ends of a rod that is nearly a helix
_BESIDE_HELD_HELIX, _HELD_LEAP = 1e-3, 0.05  # the same with held ends; of p's scale, the way past a helix
_BESIDE_HINGE, _SHORTER = 0.01, (5e-3, 5e-4)  # rad between the ends of a hinged rod there; shorter ways past it
_CREEPS, _LITTLE = 60, 0.01  # points in a row that do not advance p; the share of the way that a leap must pass
_SLIGHT = 0.1  # rad: the range of beta of a rod beside a helix
_STEEP = 0.2  # dp along the branch, in scales, above which a step may end at a given p
_CREEPING = (
    "the rod is next to a helix, as beside a pitchfork, and the range ends so near that the steps became too small; "
    "choose a range that ends farther on"
)
UNBENT = "the rod is a helix and nothing bends it: helices between two hinges are solved, not followed"
END, CLOSED = "the end of the range", "the branch is closed"
_BACK = 1e-6  # in scales: an equilibrium as near to the first is the first


@dataclass(frozen=True)
class Stop:
    """Why and at which parameter a branch stops. helix: the parameter and the beta at which the helix ceases to exist
    that the rod lies along; None where that is not why."""

    reason: str
    p: float
    helix: tuple[float, float] | None = None


def trace(family: Family, path: Path, p: float, rises: bool, bounds: Bounds) -> tuple[list[Place], Stop]:
    """The equilibria after the one at p, in order, and why there are no more."""
    places, stop = _places(family, path, p, rises, bounds)
    if not places or not family.is_dead or stop.reason in (END, CLOSED):
        return places, stop
    orbit = orbit_of(places[-1].problem, places[-1].path)
    return places, replace(stop, helix=end_of_helix(family, stop.p, shape_of(orbit)[0]))


def _places(family: Family, path: Path, p: float, rises: bool, bounds: Bounds) -> tuple[list[Place], Stop]:
    """The same without the reason that a helix ceases to exist."""
    if not family.is_dead and path.helix:
        return _from_held_helix(family, path, p, rises, bounds)
    if not path.helix or not family.is_dead:
        begun = begin_at(family, path, p, rises)
        return ([], Stop(begun, p)) if isinstance(begun, str) else _follow(begun, [], bounds)
    places, last = helix_places(family, p, rises, bounds)
    if last is None:
        ended = bool(places) and bounds.is_end(places[-1], 1.0 if rises else -1.0)
        return places, Stop(END if ended else _limit(bounds), places[-1].p)
    leap = _leap_from(family, places[-1].path if places else path, last, rises, bounds)
    if leap is None:
        return places, Stop("the rod is no helix beyond, and no equilibrium next to the helix was found", last)
    return _follow(leap, [*places, leap.record()], bounds)


def _from_held_helix(family: Family, path: Path, p: float, rises: bool, bounds: Bounds) -> tuple[list[Place], Stop]:
    """The same from a helix under held ends, which bend it."""
    given = family.given(p)
    if given is not None and all(given.number(name, np.nan) == 0 for name in ("dbeta0", "dbetaL")):
        return [], Stop(UNBENT, p)
    begun = _held_leap(state_of(family.begun, path), p, rises, family, bounds, _LEAP)
    if isinstance(begun, str):
        return [], Stop(begun, p)
    place = begun.record()
    first = replace(place, p=bounds.snap(place.p))
    if bounds.is_end(first, 1.0 if rises else -1.0):
        return [first], Stop(END, first.p)
    return _follow(begun, [first], bounds)


def own_place(family: Family, path: Path, p: float) -> Place | str:
    """The equilibrium at p itself, or why it cannot be followed."""
    place = family.place(p) if family.is_dead else None
    if path.helix and place is not None and place.helix is not None:
        return helix_place(place, p)
    if path.helix and not family.is_dead:
        given = family.given(p)
        assert given is not None
        index = index_of(state_of(family.begun, path), given)
        return Place(p, path, family.begun, int(index) if np.isfinite(index) else None)
    begun = begin_at(family, path, p, True)
    return begun if isinstance(begun, str) else replace(begun.record(), p=p)


def _limit(bounds: Bounds) -> str:
    return f"the limit of {bounds.most} points"


def _follow(state: State, places: list[Place], bounds: Bounds) -> tuple[list[Place], Stop]:
    """The places before, and those after a state."""
    first, step, kept, creeps = state.record(), FIRST, 0, 0
    ordinary = ordinary_steps(state.curve.family, bounds, first)
    while len(places) < bounds.most:
        if ordinary is not None and state.curve.chart.kind != CORNER:
            begin = state
            found, state, step, kept, why = ordinary.after(state, step, kept, bounds.most - len(places))
            places += found
            creeps = creeps + len(found) if _creeps(begin, state, bounds, False) else 0
            if why in (AT_END, IS_CLOSED):
                return places, Stop(END if why == AT_END else CLOSED, places[-1].p)
            if len(places) >= bounds.most:
                break
        state, kept = rechart(state, step, keep=kept > 0), kept - 1
        past = _leap(state, bounds) if _is_near_helix(state) else None
        if past is not None:
            creeps = creeps + 1 if _creeps(state, past, bounds, True) else 0
            if creeps > _CREEPS:
                return places, Stop(_CREEPING, state.p)
            state, place = past, past.record()
            places.append(replace(place, p=bounds.snap(place.p)))
            if bounds.is_end(places[-1], state.rises):
                return places, Stop(END, places[-1].p)
            continue
        there, passed = _pass(state, _step(state, step, bounds), bounds)
        if isinstance(there, str) and step < NARROW:
            for other in in_other_charts(state):
                again, passed = _pass(other, _step(other, step, bounds), bounds)
                if not isinstance(again, str):
                    state, there, kept = other, again, _KEPT
                    break
        if isinstance(there, str):
            step, tried = step / 2, step
            leap = _leap(state, bounds) if tried >= NARROW > step or step < SHORTEST else None
            if leap is None and step >= SHORTEST:
                continue
            if leap is None:
                return places, Stop(f"the step became too small: {there}", state.p)
            creeps = creeps + 1 if _creeps(state, leap, bounds, True) else 0
            there, passed, step = leap, [leap.record()], FIRST
        else:
            creeps = creeps + 1 if _creeps(state, there, bounds, False) else 0
            bend = max(there.node.bend, 1e-6)
            step = min(LONGEST, step * float(np.clip(np.sqrt(_EASY_BEND / bend), 0.3, 2.0)))
        if creeps > _CREEPS:
            return places, Stop(_CREEPING, state.p)
        for place in passed:
            places.append(replace(place, p=bounds.snap(place.p)))
            if _is_same(place, first):
                return places, Stop(CLOSED, place.p)
            if bounds.is_end(place, there.rises):
                return places, Stop(END, places[-1].p)
        state = there
    return places, Stop(_limit(bounds), state.p)


def _step(state: State, step: float, bounds: Bounds) -> State | str:
    """The state after a step, which is shortened where it would pass the next value at which to halt."""
    curve, node, across = state.curve, state.node, None
    halt = bounds.next(state.p, state.rises > 0) / curve.scales[1]
    ahead = float((halt - node.w[1]) / state.rises) if state.rises else np.inf
    if abs(state.rises) > _STEEP and 0 < ahead <= step:
        step, across = ahead, np.eye(node.w.size)[1]
    found = advance(curve, node, step, across)
    return found if isinstance(found, str) else State(curve, found)


def _pass(state: State, there: State | str, bounds: Bounds) -> tuple[State | str, list[Place]]:
    """The state after a step, or why it is refused; the special points and wanted values on the way, and its end."""
    if isinstance(there, str):
        return there, []
    reach = float(state.node.tangent @ (there.node.w - state.node.w))
    special = _special(state, there, reach)
    if special is None:
        return "a special point could not be located", []
    places = []
    for (low, one, _), (high, other, kind) in pairwise([(0.0, state, ""), *special, (reach, there, "")]):
        for value in bounds.inside(one.p, other.p):
            found = _locate(state, low, high, partial(_above, value))
            if found is None:
                return f"the equilibrium at {value:.10g} could not be located", []
            places.append(found[1].record())
        places.append(other.record(kind))
    return there, places


def _special(state: State, there: State, reach: float) -> list[tuple[float, State, str]] | None:
    """Where p has an extremum, and where beta_t passes through 0 at both ends together; None: not located."""
    found, chart = [], state.curve.chart
    if not chart.logarithmic and chart.kind != CORNER and state.x * there.x < 0:
        at = state.curve.at(state.node.w)
        if at is not None and at[0].is_tied:
            helix = at[0].start in at[0].angles and state.rises * there.rises > 0
            found.append((_locate(state, 0.0, reach, lambda at: at.x), CROSSING if helix else PITCHFORK))
    if state.rises * there.rises < 0 and not found:
        found.append((_locate(state, 0.0, reach, lambda at: at.rises), FOLD))
    some = [(*place, kind) for place, kind in found if place is not None]
    return some if len(some) == len(found) else None


def _above(value: float, at: State) -> float:
    return at.p - value


def _locate(state: State, low: float, high: float, zero: Callable[[State], float]) -> tuple[float, State] | None:
    """The distance along the tangent, between two, at which a function of the state is zero, and the state there."""

    def at(distance: float) -> State:
        if distance == 0:
            return state
        found = advance(state.curve, state.node, distance)
        if isinstance(found, str):
            raise ArithmeticError(found)
        return State(state.curve, found)

    try:
        if zero(at(low)) * zero(at(high)) > 0:
            return None
        distance = float(scipy.optimize.brentq(lambda one: zero(at(one)), low, high, xtol=1e-14, rtol=1e-14))
        return distance, at(distance)
    except ArithmeticError:
        return None


def _creeps(state: State, there: State, bounds: Bounds, leap: bool) -> bool:
    """Whether p changes by rounding; or, in a leap beside a helix, by little of the way to the next halt."""
    far, ahead = abs(there.p - state.p), abs(bounds.next(state.p, state.rises > 0) - state.p)
    if far < 100 * bounds.rounding:
        return True
    return leap and far < _LITTLE * ahead and bool(np.ptp(_shape(there)) < _SLIGHT)


def _shape(state: State) -> Array:
    """beta along the rod."""
    at = state.curve.at(state.node.w)
    return np.empty(0) if at is None else shape_of(orbit_of(at[0].problem, at[1]))[0]


def _is_near_helix(state: State) -> bool:
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


def _held_leap(
    here: HeldState, p: float, rises: bool, family: Family, bounds: Bounds, share: float = _HELD_LEAP
) -> State | str:
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


def _leap(state: State, bounds: Bounds) -> State | None:
    """The equilibrium a little farther on, with a close shape and the same Morse index."""
    if not state.curve.family.is_dead:
        at = state.curve.at(state.node.w) if _is_near_helix(state) else None
        if at is None:
            return None
        family = state.curve.family
        here = state_of(at[0].problem, at[1], family.hinged)
        for share in (_HELD_LEAP, *(_SHORTER if family.hinged else ())):
            found = _held_leap(here, state.p, state.rises > 0, family, bounds, share)
            if not isinstance(found, str):
                return found
        return None
    return _leap_from(state.curve.family, state.path(), state.p, state.rises > 0, bounds)


def _leap_from(family: Family, path: Path, p: float, rises: bool, bounds: Bounds) -> State | None:
    far = p + float(np.clip(bounds.next(p, rises) - p, -family.scale, family.scale))
    first, last = family.place(p), family.place(far)
    if first is None or last is None:
        return None
    found = leap(Line(first.problem, last.problem), first.problem, path, 0.0)
    if found is None:
        return None
    begun = begin_at(family, found[0].path, p + found[1] * (far - p), rises)
    return None if isinstance(begun, str) else begun


def _is_same(place: Place, first: Place) -> bool:
    """Whether the branch is back where it began."""
    one, other = place.path, first.path
    same = (one.leaving, one.turns, one.sign) == (other.leaving, other.turns, other.sign)
    return same and abs(place.p - first.p) < _BACK and abs(one.pin - other.pin) < _BACK and abs(one.y - other.y) < _BACK
