"""A branch of equilibria followed over one parameter, through folds.

The branch is a curve in the plane of a coordinate of the level and the parameter (`equilibrium_curve`), followed by
pseudo-arclength steps (`numerics.arclength`). The coordinate is chosen anew at each step. Where the steps become too
small and the branch goes on (an end of the rod crosses a saddle, in a range as narrow as exp(-r L)), a leap is made, as
in `continuation`.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..core.branch_calls import AT_END, IS_CLOSED
from ..core.tuning import (
    BESIDE_HELD_HELIX,
    BESIDE_HELIX,
    BESIDE_SADDLE,
    EASY_BEND,
    FASTER,
    LONGEST,
    LOWEST,
    NARROW,
    SAME_SADDLE,
    SLOWER,
    STEEP,
    STEPS_KEPT,
    UNRESOLVED,
)
from ..numerics import arclength
from ..numerics.arclength import BRANCH_POINT, CLOSED, END, FOLD, PITCHFORK
from ..numerics.arrays import ALIKE, ASIDE, Array
from ..numerics.roots import locate
from ..orbits.boundary import Boundary, Path, boundary_of, height_scale, nearest_angle, wrap
from ..orbits.path_orbits import orbit_of
from ..orbits.potential import slope, slope_rate
from ..problem.dimensionless import EndsProblem
from .branch_events import Bounds, Place, Stop, arrive, both_ways, events_between
from .branch_states import BranchState, begin_at, in_other_charts, rechart, steps_in_core
from .family import Family
from .given_numbers import FREE
from .held_index import index_of
from .helices import off_helix
from .helix_branch import end_of_helix, helix_places
from .leaps import LEAPS, Guess, angles_on, leap
from .orbit_rates import orbit_rates
from .path_correction import AT_REST, LEFT, state_of

# of steps, in scales; from 2e-2 the first rarely needs halving. x10: it may land on another branch, and branches are
# given up where their steps are short
_LENGTHS = arclength.Lengths(first=0.02, longest=LONGEST, least=1e-7)
_CREEPS = 60  # points in a row that do not advance p. x10: a branch that only creeps ends ten times later
# of p's scale, the longest way past a helix, over which beta_t falls in proportion. x10: leaps to another branch
_FAR = 0.1
_BESIDE = 0.01  # rad between the ends of a held rod there. x10: a bent rod is taken for one that is nearly a helix
_FEW = 5  # steps, after which a rod that is carried may be next to a helix. x10: it creeps so much longer
# the share of the way to the next halt that a leap must pass. x10: short leaps that advance count as creeping
_LITTLE = 0.01
_SLIGHT = 0.1  # rad: the range of beta of a rod beside a helix. x10: rods that bend all along count as such


def trace_branch(family: Family, path: Path, p: float, rises: bool, bounds: Bounds) -> tuple[list[Place], Stop]:
    """The equilibria after the one at p, in order, and why there are no more."""
    places, stop = follow_branch(family, path, p, rises, bounds)
    if not places or not family.is_dead or stop.reason in (END, CLOSED):
        return places, stop
    orbit = orbit_of(places[-1].problem, places[-1].path)
    return places, replace(stop, helix=end_of_helix(family, stop.p, angles_on(orbit)[0]))


def branch_through(family: Family, path: Path, p: float, bounds: Bounds) -> tuple[list[Place], int, Stop, Stop] | str:
    """The equilibria of the branch of the one at p, the place of that one among them, and why there are no more at
    either end; or why it cannot be followed."""
    if path.helix:
        given = family.given(p)
        assert given is not None
        index = index_of(state_of(family.begun, path), given)
        middle = Place(p, path, family.begun, int(index) if np.isfinite(index) else None)
    else:
        begun = begin_at(family, path, p, True)
        if isinstance(begun, str):
            return begun
        middle = replace(begun.record(), p=p)
    return both_ways(middle, bounds, lambda rises: trace_branch(family, path, p, rises, bounds))


def follow_branch(family: Family, path: Path, p: float, rises: bool, bounds: Bounds) -> tuple[list[Place], Stop]:
    """The places of the branch from the path at p on, where p rises or falls, and why there are no more."""
    places, begun = list[Place](), family.begun
    if not path.helix:
        beyond = begin_at(family, path, p, rises)
        return ([], Stop(beyond, p)) if isinstance(beyond, str) else _follow(beyond, [], bounds)
    places, last = helix_places(family, begun, p, rises, bounds)
    if last is None:
        ended = bool(places) and bounds.is_end(places[-1].p, 1.0 if rises else -1.0)
        return places, Stop(END if ended else bounds.limit, places[-1].p)
    p = last
    if places:
        path, begun = places[-1].path, places[-1].problem
    beyond = leap_from(family, begun, path, p, rises, bounds)
    if isinstance(beyond, str):
        return places, Stop(beyond, p)
    first = beyond.record()
    places.append(replace(first, p=bounds.snap(first.p)))
    if bounds.is_end(places[-1].p, 1.0 if rises else -1.0):
        return places, Stop(END, places[-1].p)
    return _follow(beyond, places, bounds)


def _follow(state: BranchState, places: list[Place], bounds: Bounds) -> tuple[list[Place], Stop]:
    """The places before, and those after a state."""
    most = bounds.most - len(places)
    first = state.record()
    natural = state.curve.family.natural
    walk = _Walk(bounds, most, replace(first, p=np.nan) if natural else first, natural)
    met, reason = arclength.trace(state, walk.stride, walk.lengths, most)
    every = [*places, *met]
    return every, Stop(reason or bounds.limit, every[-1].p if every else state.p)


@dataclass(eq=False)
class _Walk:
    """The way along a branch.

    most: of the points. first: where it begins, without p where it cannot come back. natural: as of `Family`. kept: for
    how many steps the coordinate is kept. creeps: how many points in a row did not advance p. reach: the longest leap
    that is tried, in p's scale: after a leap twice as long as that one.
    """

    bounds: Bounds
    most: int
    first: Place
    natural: bool
    kept: int = 0
    creeps: int = 0
    reach: float = LEAPS[0]

    @property
    def lengths(self) -> arclength.Lengths:
        """Of the steps."""
        return arclength.RISING if self.natural else _LENGTHS

    def stride(self, state: BranchState, step: float, before: list[Place]) -> arclength.Stride[Place, BranchState]:
        """The ordinary steps after a state, and one on which something happens."""
        begin, left = state, self.most - len(before)
        left = min(left, _FEW) if self.natural else left
        places, state, step, self.kept, why = steps_in_core(state, step, self.kept, left, self.first, self.bounds)
        self.creeps = self.creeps + len(places) if creeps(begin, state, self.bounds, False) else 0
        if why in (AT_END, IS_CLOSED):
            return arclength.Stride(places, state, step, END if why == AT_END else CLOSED)
        stays = self.natural and self.creeps > 0
        leaps = stays or is_near_helix(state) or crosses_saddle(state)
        if len(places) >= left and not leaps:
            return arclength.Stride(places, state, step)
        state, self.kept = rechart(state, step, keep=self.kept > 0), self.kept - 1
        past = leap_on(state, self.bounds, self.reach) if leaps else None
        if past is not None:
            return self._arrive(places, state, past, [past.record()], step, True)
        ahead, passed = _pass(state, _step(state, step, self.bounds), self.bounds)
        if isinstance(ahead, str) and step < NARROW:
            for other in in_other_charts(state):
                again, passed = _pass(other, _step(other, step, self.bounds), self.bounds)
                if not isinstance(again, str):
                    state, ahead, self.kept = other, again, STEPS_KEPT
                    break
        if not isinstance(ahead, str):
            bend = max(ahead.node.bend, 1e-6)
            longer = step * float(np.clip(np.sqrt(EASY_BEND / bend), SLOWER, FASTER))
            return self._arrive(places, state, ahead, passed, longer, False)
        half = step / 2
        beyond = leap_on(state, self.bounds, self.reach) if step >= NARROW > half or half < self.lengths.least else None
        if beyond is not None:
            return self._arrive(places, state, beyond, [beyond.record()], self.lengths.first, True)
        if half >= self.lengths.least:
            return arclength.Stride(places, state, half)
        meets = self.natural and ahead == arclength.REVERSED  # within so short a step it is no neighbour
        return arclength.Stride(places, state, half, BRANCH_POINT if meets else f"the step became too small: {ahead}")

    def _arrive(
        self, places: list[Place], before: BranchState, after: BranchState, passed: list[Place], step: float, leap: bool
    ) -> arclength.Stride[Place, BranchState]:
        """The places of a stride from a state, at the last of which the branch may end; leap: whether it is a leap."""
        self.creeps = self.creeps + 1 if creeps(before, after, self.bounds, leap) else 0
        went = abs(after.p - before.p) / before.curve.family.scale
        self.reach = max(2 * went, LEAPS[0]) if leap else LEAPS[0]
        if self.creeps > (_FEW if self.natural else _CREEPS):
            why = "the steps became too small"
            if not self.natural:
                why = (
                    f"the rod is next to a helix, as beside a pitchfork, and the range ends so near that {why}; "
                    "choose a range that ends farther on"
                )
            return arclength.Stride(places, before, step, why)
        return arrive(places, passed, before, after, step, self.bounds, self._end)

    def _end(self, place: Place) -> str:
        """Why the branch ends at a place, if it does."""
        return FOLD if self.natural and place.kind == FOLD else CLOSED if _is_same(self.first, place) else ""


def _step(state: BranchState, step: float, bounds: Bounds) -> BranchState | str:
    """The state after a step, which is shortened where it would pass the next value at which to halt."""
    curve, node, across = state.curve, state.node, None
    halt = bounds.next(state.p, state.rises > 0) / curve.scales[1]
    ahead = float((halt - node.w[1]) / state.rises) if state.rises else np.inf
    if abs(state.rises) > STEEP and 0 < ahead <= step:
        step, across = ahead, np.eye(node.w.size)[1]
    return state.ahead(step, across)


def _pass(before: BranchState, after: BranchState | str, bounds: Bounds) -> tuple[BranchState | str, list[Place]]:
    """The state after a step, or why it is refused; the special points and wanted values on the way, and its end."""
    if isinstance(after, str):
        return after, []
    special = _special(before, after)
    if special is not None and before.curve.family.is_dead and not _may_follow(before, after, special):
        return "it leads to another branch", []
    places = None if special is None else events_between(before, after, special, bounds, partial(_place_at, before))
    return (after, places) if places is not None else ("what is met on the way could not be located", [])


def _may_follow(before: BranchState, after: BranchState, special: list[tuple[BranchState, str]]) -> bool:
    """Whether the Morse index is the same behind a step on which nothing happens, and behind a fold another one."""
    indices, kinds = (before.record().index, after.record().index), [kind for _, kind in special]
    return None in indices or (kinds not in ([], [FOLD])) or (indices[0] == indices[1]) == (not kinds)


def _place_at(state: BranchState, before: BranchState, after: BranchState, value: float) -> Place | None:
    """The equilibrium at a value of p, between two points of the step that leads from a state."""
    ends = {float(state.node.tangent @ (at.node.w - state.node.w)): at for at in (before, after)}
    state_at = locate(state.ahead, ends, lambda at: at.p - value)
    return None if state_at is None else state_at.record()


def _special(before: BranchState, after: BranchState) -> list[tuple[BranchState, str]] | None:
    """Where beta_t passes through 0 at both ends together, or where p has an extremum; None: not located."""
    chart, at, kind = before.curve.chart, None, FOLD
    reach = float(before.node.tangent @ (after.node.w - before.node.w))
    if not chart.logarithmic and before.x * after.x < 0:
        at = before.at
    if at is not None and at[0].is_tied:
        kind = BRANCH_POINT if at[0].start in at[0].angles and before.rises * after.rises > 0 else PITCHFORK
    elif before.rises * after.rises >= 0:
        return []
    point = locate(before.ahead, {0.0: before, reach: after}, lambda at: at.rises if kind == FOLD else at.x)
    return None if point is None else [(point, kind)]


def _is_same(first: Place, place: Place) -> bool:
    """Whether the branch is back where it began."""
    path, other = place.path, first.path
    same = (path.leaving, path.turns, path.sign) == (other.leaving, other.turns, other.sign)
    apart = place.p - first.p, path.pin - other.pin, path.y - other.y
    return same and all(abs(number) < ALIKE for number in apart)


def creeps(before: BranchState, after: BranchState, bounds: Bounds, leap: bool) -> bool:
    """Whether p changes by rounding; or, in a leap beside a helix, by little of the way to the next halt."""
    far, ahead = abs(after.p - before.p), abs(bounds.next(before.p, before.rises > 0) - before.p)
    # where p must rise from 0 to 1, a point that goes less far than ALIKE does not advance
    if far < (ALIKE if before.curve.family.natural else 100 * bounds.round_off):
        return True
    return leap and far < _LITTLE * ahead and bool(np.ptp(_angles(after)) < _SLIGHT)


def _angles(state: BranchState) -> Array:
    """beta along the rod."""
    return np.empty(0) if state.at is None else angles_on(orbit_of(state.at[0].problem, state.at[1]))[0]


def is_near_helix(state: BranchState) -> bool:
    """Whether the rod would be a helix at a parameter so near that its level leaves the range of floats there."""
    equilibrium, family = state.at, state.curve.family
    if equilibrium is None or abs(np.sin((equilibrium[0].start - equilibrium[0].end) / 2)) > (
        0 if family.is_dead else _BESIDE
    ):
        return False
    problem = equilibrium[0].problem
    near = BESIDE_HELIX if family.is_dead else BESIDE_HELD_HELIX
    pull = np.abs([slope(problem, end)[0] for end in (problem.beta0, problem.betaL)])
    if not 0 < pull.max() < near * height_scale(problem):
        return False
    return family.is_dead or bool(np.ptp(_angles(state)) < _SLIGHT)  # ends of a long rod rest next to saddles too


def crosses_saddle(state: BranchState) -> bool:
    """Whether an end crosses a saddle nearer than a leap goes, at which the rod rests so long that floats cannot
    resolve the range within which the end crosses it.

    There the level rises past that of the saddle, and the rod gains or loses a turning point.
    """
    family, equilibrium = state.curve.family, state.at
    if equilibrium is None or not family.is_dead:
        return False
    boundary, path = equilibrium
    for name in ("start", "end"):
        off, saddle = _off_saddle(boundary, name)
        if not abs(off) < SAME_SADDLE:
            continue
        gap = path.sign * float(np.exp(max(path.y, LOWEST))) + boundary.fall(boundary.own_pin(path.pin), saddle)
        bend = abs(float(slope_rate(boundary.problem, saddle)[0]))
        if not abs(gap) < UNRESOLVED * bend * max(abs(off), UNRESOLVED):
            continue
        beyond = family.boundary(state.p + state.curve.ahead * family.scale)
        moved = 0.0 if beyond is None else _off_saddle(beyond, name)[0] - off
        if abs(off) * state.curve.ahead < BESIDE_SADDLE * abs(moved):
            return True
    return False


def _off_saddle(boundary: Boundary, name: str) -> tuple[float, float]:
    """The "start" or the "end" less the saddle next to it, and that saddle."""
    angle = getattr(boundary, name)
    saddle, _ = nearest_angle(boundary.saddles, angle)
    return wrap(angle - saddle), saddle


def leap_on(state: BranchState, bounds: Bounds, reach: float = LEAPS[0]) -> BranchState | None:
    """The equilibrium a little farther on, at most so far in p's scale; under held ends none but past a helix."""
    if state.at is None:
        return None
    family, (boundary, path) = state.curve.family, state.at
    if not family.is_dead:
        return past_helix(state, bounds) if family.natural or is_near_helix(state) else None
    rises = family.natural or state.rises > 0  # next to a saddle rounding may turn it
    beyond = leap_from(family, boundary.problem, path, state.p, rises, bounds, reach)
    return None if isinstance(beyond, str) else beyond


def leap_from(
    family: Family, problem: EndsProblem, path: Path, p: float, rises: bool, bounds: Bounds, reach: float = LEAPS[0]
) -> BranchState | str:
    """The equilibrium a little beyond that at p, or why there is none: under dead loads the one with a close shape and
    the same Morse index, at most so far in p's scale; under held ends the bent rod that a helix becomes."""
    far = p + float(np.clip(bounds.next(p, rises) - p, -family.scale, family.scale))
    last = family.given(far)
    if last is None:
        return LEFT
    longest = 1.0 if abs(far - p) <= reach * family.scale else reach * family.scale / abs(far - p)

    def value(share: float) -> float:
        return p + share * (far - p)

    if family.is_dead:
        guesses = leap(lambda share: family.given(value(share)), problem, path, longest)
    else:
        guesses = off_helix(state_of(problem, path), last)
    places = ((guess, way, value(share)) for guess, way, share in guesses)
    if beyond := first_equilibrium(family, places, rises):
        return beyond
    if family.is_dead:
        return "the rod is no helix beyond, and no equilibrium next to the helix was found"
    return "the start is a helix, and the change does not bend its ends; give a bent seed"


def first_equilibrium(family: Family, guesses: Iterable[Guess], rises: bool) -> BranchState | None:
    """The first equilibrium that is reached from guesses at values of p; None where none is."""
    states = (begin_at(replace(family, begun=problem), path, p, rises) for problem, path, p in guesses)
    return next((state for state in states if not isinstance(state, str)), None)


def past_helix(state: BranchState, bounds: Bounds) -> BranchState | None:
    """The equilibrium beyond a helix that a branch of held ends passes, or at the next halt.

    On a helix no path has a level: beta_t falls to zero along the whole rod and grows again with the other sign.
    """
    # the point and one ASIDE before it, in scales, tell how beta_t falls towards a helix
    family, behind = state.curve.family, state.curve.at(state.node.w - ASIDE * state.node.tangent)
    if state.at is None or behind is None or not state.rises:
        return None
    (boundary, path), (boundary_behind, path_behind) = state.at, behind
    speeds, speeds_behind = (
        orbit_rates(at.problem, [way]).values[0, 2:4] for at, way in ((boundary, path), (boundary_behind, path_behind))
    )
    rate = (speeds - speeds_behind) / ASIDE
    if not (rate * speeds < 0).all():
        return None
    zero = float((-speeds / rate).max())
    room = (bounds.next(state.p, state.rises > 0) - state.p) / (family.scale * state.rises)
    way = min(2 * zero, room)
    if not zero < room or way * abs(state.rises) > _FAR:
        return None
    numbers = {name: getattr(boundary.problem, name) for name in (*FREE, "span")}
    change = {name: (value - getattr(boundary_behind.problem, name)) / ASIDE for name, value in numbers.items()}
    problem = EndsProblem(**{name: value + way * change[name] for name, value in numbers.items()})
    p = bounds.snap(state.p + way * family.scale * state.rises)
    ends = boundary_of(problem)
    starts = sorted(zip(np.abs(speeds + way * rate), (ends.start, ends.end), strict=True), key=lambda pair: pair[0])
    logs = [(max(2 * float(np.log(max(speed, 1e-300))), AT_REST), angle) for speed, angle in starts]
    guesses = [(problem, Path(angle, 1.0, y, -path.leaving, path.turns), p) for y, angle in logs]
    return first_equilibrium(family, guesses, state.rises > 0)
