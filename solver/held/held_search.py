"""The search for equilibria with held ends: from dead loads, by mirror images, across folds and by deflation; or by a
scan of the angle at a hinge where all loads are given.

No search proves that it found all of them: their number need not be finite, as a rod held at a height takes ever more
bends under ever larger loads. The search is over stated ranges of the unknown loads and angles.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from ..branches.continuation import Stopped, carry
from ..branches.deflation import across_fold, deflate, is_known, numbers_of
from ..branches.held_helices import helices_of
from ..equilibrium.given_numbers import FREE, Given, OrbitState
from ..equilibrium.orbit_rates import orbit_rates
from ..equilibrium.system import settle
from ..numerics.arrays import Array
from .held_mirrors import half_period_later, image_of, mirrors_of
from .held_ranges import Ranges, ranges_of, within_a_turn
from .held_sweep import Point, starts_of, swept
from .hinge_scan import hinged_states

_STEPS = 30  # of each continuation
_SEED = 14  # of the random choice of where deflation begins
CONTINUED, MIRRORED, FOLDED, DEFLATED, HELIX = "continuation", "mirror image", "across a fold", "deflation", "helix"
SCANNED = "scan"


@dataclass(eq=False)
class HeldFound:
    """Equilibria with held ends, and how they were searched for.

    states, how: each equilibrium and by what it was found. ranges: of the unknowns. problems, equilibria: those under
    dead loads that were solved. starts, failed: continuations, and those of them that led to no equilibrium. tries: of
    deflation, the last `fruitless` of them without a new equilibrium. outside: the unknowns of each equilibrium outside
    the ranges, which is not kept. any_load: whether a helix is an equilibrium under any load.
    """

    given: Given
    ranges: Ranges
    states: list[OrbitState] = field(default_factory=list)
    how: list[str] = field(default_factory=list)
    problems: int = 0
    equilibria: int = 0
    starts: int = 0
    failed: int = 0
    tries: int = 0
    outside: list[dict[str, float]] = field(default_factory=list)
    any_load: bool = False
    _known: list[Array] = field(default_factory=list)

    def add(self, state: OrbitState, how: str) -> bool:
        """Add an equilibrium and its mirror images; whether it was new. A state without numbers is none."""
        state = _settle(state, self.given)
        if not np.isfinite(numbers_of(state)).all() or is_known(state, self._known):
            return False
        self._known.append(numbers_of(state))
        values = {name: float(getattr(state.problem, name)[0]) for name in FREE}
        if self.ranges.holds(values):
            self.states.append(state)
            self.how.append(how)
        else:
            self.outside.append(values)
        images = [image_of(state, mirror, self.given) for mirror in mirrors_of(self.given)]
        later = half_period_later(state, self.given)
        for image in [*images, *([] if later is None else [later])]:
            whole = image if image.path.helix else settle(image.problem, image.path, self.given)
            if not isinstance(whole, str):
                self.add(whole, MIRRORED)
        return True

    @property
    def known(self) -> list[Array]:
        """The `numbers_of` all equilibria, those outside the ranges too."""
        return self._known


def held_search(
    given: Given, own: dict[str, tuple[float, float]], most_periods: int, tries: int, values: int | None = None
) -> HeldFound:
    """The equilibria with the given numbers.

    own: ranges of unknown numbers in place of the default ones; values: how many of each. tries: the deflations without
    a new equilibrium after which the search ends.
    """
    result = HeldFound(given, ranges_of(given, own, values))
    scanned = hinged_states(given)
    points = [] if scanned else swept(given, result.ranges, most_periods)
    result.problems, result.equilibria = len(points), sum(len(point.states) for point in points)
    helices, result.any_load = helices_of(given)
    for state in helices:
        result.add(state, HELIX)  # first: an orbit whose swings fall to rounding is the helix
    for start in scanned:
        if not isinstance(whole := settle(start.problem, start.path, given), str):
            result.add(whole, SCANNED)
    if scanned:
        return result
    for starts in starts_of(points, result.ranges):
        result.starts += 1
        result.failed += not _continue_from(result, starts)
    _across_folds(result, 0)
    _deflate(result, points, tries)
    return result


def _continue_from(result: HeldFound, starts: list[OrbitState]) -> bool:
    """Whether one of the starts led to an equilibrium with the given numbers."""
    for start in starts:
        state = carry(start, result.given, _STEPS)
        if not isinstance(state, Stopped):
            result.add(state, CONTINUED)
            return True
    return False


def _across_folds(result: HeldFound, first: int) -> None:
    """Add the partners across the nearest folds of the equilibria from the first on, and of these partners."""
    while first < len(result.states):
        for guess in across_fold(result.states[first], result.given)[:1]:
            state = deflate(guess, result.given, result.known)
            if state is not None:
                result.add(state, FOLDED)
        first += 1


def _deflate(result: HeldFound, points: list[Point], tries: int) -> None:
    seeds = [state for point in points for state in point.states]
    rng = np.random.default_rng(_SEED)
    fruitless = 0
    while seeds and fruitless < tries:
        result.tries += 1
        state = deflate(seeds[int(rng.integers(len(seeds)))], result.given, result.known)
        before = len(result.states)
        if state is None or not result.add(state, DEFLATED):
            fruitless += 1
            continue
        fruitless = 0 if len(result.states) > before else fruitless + 1
        _across_folds(result, before)


def _settle(state: OrbitState, given: Given) -> OrbitState:
    """The state with beta(0) in [-pi, pi) where no angle is given."""
    if "beta0" in given.names or "betaL" in given.names:
        return state
    add = within_a_turn(float(state.problem.beta0[0]))
    if not add:
        return state
    problem = replace(state.problem, beta0=state.problem.beta0 + add, betaL=state.problem.betaL + add)
    return replace(state, problem=problem, rates=orbit_rates(problem, [state.path]))
