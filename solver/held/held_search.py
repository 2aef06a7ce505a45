"""The search for equilibria with held ends: from dead loads, by mirror images, across folds and by deflation; or by a
scan of the start where all loads and the bending moment at an end are given.

No search proves that it found all of them: their number need not be finite, as a rod held at a height takes ever more
bends under ever larger loads. The search is over stated ranges of the unknown loads and angles.

beta -> -beta changes the signs of lam and mu, beta -> pi - beta those of phi and mu, and the rod may be run through
from its far end. Each of the seven images of an equilibrium solves a problem with other given numbers; where these are
the same numbers, it is another equilibrium of the same problem.
"""

from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np

from ..branches.branch_events import Stop
from ..branches.deflation import end_vector, is_known
from ..branches.given_numbers import FREE, Given, Mirror, OrbitState
from ..branches.helices import helices_of
from ..branches.orbit_rates import orbit_rates
from ..nodes.hinges import HingedState, half_period_later, mirror_image, rod_of, state_of
from ..nodes.shape_search import scan_one_unknown
from ..nodes.vertical_scan import has_one_unknown
from ..numerics.arclength import FEW_POINTS
from ..numerics.arrays import ALIKE, FAINT, Array
from ..orbits.boundary import Boundary, Path, boundary_of, nearest_angle
from ..orbits.potential import TAU
from ..problem.dimensionless import EndsProblem
from .held_moves import across_fold, angles_along, carry, deflate, settle, within_a_turn
from .held_sweep import Ranges, SweepPoint, ranges_of, starts_of, swept

MOST_PERIODS, TRIES = 8, 10  # of the rods from which the search begins; deflations without a new equilibrium. x10: time


@dataclass(eq=False)
class FoundStates:
    """Equilibria with held ends, and how they were searched for.

    states, how: each equilibrium and by what it was found. ranges: of the unknowns. problems, equilibria: those under
    dead loads that were solved. starts, failed: continuations, and those of them that led to no equilibrium. tries: of
    deflation, the last `fruitless` of them without a new equilibrium. outside: the unknowns of each equilibrium outside
    the ranges, which is not kept. any_load: whether a helix is an equilibrium under any load. known: the
    `end_vector` of each equilibrium, also of those outside the ranges.
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
    known: list[Array] = field(default_factory=list)

    def add(self, state: OrbitState | None, how: str) -> bool:
        """Add an equilibrium and its mirror images; whether it was new. A state without numbers is none."""
        if state is not None and not {"beta0", "betaL"} & {*self.given.names}:
            state = within_a_turn(state)
        if state is None or not np.isfinite(end_vector(state)).all() or is_known(state, self.known):
            return False
        # a rod whose beta varies less [rad] is a straight rod or a helix, but for rounding
        if self.any_load and not state.path.helix and np.ptp(angles_along(state)) < ALIKE:
            return False
        self.known.append(end_vector(state))
        values = {name: float(getattr(state.problem, name)[0]) for name in FREE}
        if self.ranges.holds(values):
            self.states.append(state)
            self.how.append(how)
        else:
            self.outside.append(values)
        images = [image_of(state, mirror, self.given) for mirror in mirrors_of(self.given)]
        later = image_half_period_later(state, self.given)
        for image in [*images, *([] if later is None else [later])]:
            self.add(image if image.path.helix else self.equilibrium_near(image), "mirror image")
        return True

    def equilibrium_near(self, guess: OrbitState) -> OrbitState | None:
        """The equilibrium next to a guess."""
        state = settle(guess, self.given)
        return None if isinstance(state, str) else state

    def carry_one(self, starts: list[OrbitState]) -> None:
        """Add what the first of the starts that leads to the given numbers leads to."""
        self.starts += 1
        for start in starts:
            state = carry(start, self.given, FEW_POINTS)
            if not isinstance(state, Stop):
                self.add(state, "continuation")
                return
        self.failed += 1

    def cross_folds(self, first: int) -> None:
        """Add the partners across the nearest folds of the equilibria from the first on, and of these partners."""
        while first < len(self.states):
            for guess in across_fold(self.states[first], self.given)[:1]:
                self.add(deflate(guess, self.given, self.known), "across a fold")
            first += 1

    def deflate(self, points: list[SweepPoint], most: int) -> None:
        """Add what deflation leads to, until so many tries in a row find none within the ranges."""
        seeds, rng, fruitless = [state for point in points for state in point.states], np.random.default_rng(14), 0
        while seeds and fruitless < most:
            self.tries += 1
            before = len(self.states)
            self.add(deflate(seeds[int(rng.integers(len(seeds)))], self.given, self.known), "deflation")
            fruitless = 0 if len(self.states) > before else fruitless + 1
            self.cross_folds(before)


def search_equilibria(
    given: Given,
    within: dict[str, tuple[float, float]] | None = None,
    most_periods: int = MOST_PERIODS,
    tries: int = TRIES,
    values: int | None = None,
) -> FoundStates:
    """The equilibria with the given numbers.

    within: ranges of unknown numbers in place of the default ones; values: how many of each. tries: the deflations
    without a new equilibrium after which the search ends.
    """
    result = FoundStates(given, ranges_of(given, within or {}, values))
    rod = rod_of(given) if given.has_hinge else None
    scanned = scan_one_unknown(rod)[0].shapes if rod is not None and has_one_unknown(rod) else []
    points = [] if scanned else swept(given, result.ranges, most_periods)
    result.problems, result.equilibria = len(points), sum(len(point.states) for point in points)
    helices, result.any_load = helices_of(given)
    for state in helices:
        result.add(state, "helix")  # first: an orbit whose swings fall to rounding is the helix
    for shape in scanned:
        result.add(state_of(shape), "scan")
    if scanned:
        return result
    for starts in starts_of(points, result.ranges):
        result.carry_one(starts)
    result.cross_folds(0)
    result.deflate(points, tries)
    return result


def mirrors_of(given: Given) -> list[Mirror]:
    """The images that have the given numbers of a problem."""
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    mirrors = []
    for kind in list(product((False, True), repeat=3))[1:]:
        plain = Mirror(*kind)
        image = dict(plain.number(name, value) for name, value in known.items())
        if image.keys() != known.keys():
            continue
        turns = [round((known[name] - image[name]) / TAU) for name in FREE[:2] if name in known]
        mirror = replace(plain, whole_turns=turns[0]) if turns else plain
        image = dict(mirror.number(name, value) for name, value in known.items())
        if all(abs(image[name] - value) <= FAINT * (1 + abs(value)) for name, value in known.items()):
            mirrors.append(mirror)
    return mirrors


def image_half_period_later(state: OrbitState, given: Given) -> OrbitState | None:
    """A guess of the rod that begins at the other turning point of the same orbit; None unless both ends rest there.

    Over whole periods all that is held is the same.
    """
    if not isinstance(state, HingedState) or any(given.number(name, np.nan) != 0 for name in ("dbeta0", "dbetaL")):
        return None
    later = half_period_later(state.shape)
    return None if later is None else replace(state, shape=later)


def image_of(state: OrbitState, mirror: Mirror, given: Given) -> OrbitState:
    """The image of a state, or a guess of it; what is given is exactly as given."""
    if isinstance(state, HingedState):
        return replace(state, shape=mirror_image(state.shape, mirror))
    old = state.problem
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    numbers = dict(mirror.number(name, float(getattr(old, name)[0])) for name in FREE)
    numbers |= {name: known[name] for name in numbers if name in known}
    problem = EndsProblem(**{name: np.array([value]) for name, value in numbers.items()}, span=old.span)
    path = _path(state.path, boundary_of(old), boundary_of(problem), mirror)
    return OrbitState(problem, path, orbit_rates(problem, [path]))


def _path(path: Path, old: Boundary, new: Boundary, mirror: Mirror) -> Path:
    """The image of a path, its level measured from the image of the same angle."""
    if path.helix:
        return new.helix or path
    ends = (new.end, new.start) if mirror.backward else (new.start, new.end)
    if path.pin in (old.start, old.end) and path.pin not in old.saddles:
        pin = ends[0] if path.pin == old.start else ends[1]
    else:
        pin, _ = nearest_angle(new.saddles, mirror.angle(path.pin))
    leaving = mirror.direction * (-path.direction_at_end if mirror.backward else path.leaving)
    return replace(path, pin=pin, leaving=leaving)
