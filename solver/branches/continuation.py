"""Continuation of one equilibrium while the numbers that are given change: its ends, its loads, its length.

All numbers change together, in proportion, from those that an equilibrium has to the wanted ones. That line is a family
over its share, and the equilibrium is carried along its branch (`branch_following`) to the share 1, or to the fold
before it.
"""

from collections.abc import Sequence

import numpy as np

from ..core.library import TIMES, cut, fine, on_grid, points, run
from ..numerics.arclength import END, FOLD, POINTS
from ..numerics.arrays import ALIKE, FAINT
from ..orbits.boundary import CUTTING, NODES, Path, boundary_of
from ..orbits.path_orbits import orbit_of
from ..orbits.periodic_orbit import jacobi_zeros
from ..problem.dimensionless import EndsProblem
from .branch_events import Bounds, Stop
from .branch_following import follow_branch
from .family import Family, scale_of
from .given_numbers import Given, OrbitState, problem_of
from .leaps import LEAPS, NEAR, angles_on
from .path_correction import settle, state_of


def carry(state: OrbitState, wanted: Given, most: int = POINTS) -> OrbitState | Stop:
    """The equilibrium with the wanted numbers on the branch of a state; all numbers change in proportion.

    most: points on the way. A stop says which share of the line was covered.
    """
    first = wanted.at(state)
    if state.path.helix:
        begin, end = (np.append(given.values, given.span) for given in (first, wanted))
        # a smaller change of a number leaves a helix as it is
        if (np.abs(end - begin) <= FAINT * (1 + np.abs(end))).all():
            return state
    if not np.isfinite(first.values).all():  # an end of the rod rests, so that only its own neighbourhood is known
        settled = settle(state.problem, state.path, wanted)
        return Stop(settled, 0.0) if isinstance(settled, str) else settled
    line = line_between(state.problem, first, wanted, natural=True)
    places, stop = follow_branch(line, state.path, 0.0, True, Bounds(0.0, 1.0, (), most))
    share, last = (places[-1].p, places[-1]) if places else (0.0, None)
    ended = stop.reason == END
    if last is not None and last.path.helix and ended:
        return state_of(last.problem, last.path)
    # where the steps became too small within the last share ALIKE of the line, its end is tried from there
    if last is not None and (ended or (stop.reason != FOLD and 1 - share < ALIKE)):
        settled = settle(last.problem, last.path, wanted)
        if not isinstance(settled, str):
            return settled
        if ended:
            return Stop(settled, share)
    return Stop(stop.reason, share)


def line_between(begun: EndsProblem, first: Given, last: Given, natural: bool = False) -> Family:
    """The problems on the line from some given numbers, at 0, to others, at 1, and beyond; begun, natural: as of
    `Family`."""
    begin, end = (np.append(given.values, [given.span, given.ratio]) for given in (first, last))

    def numbers(share: float) -> Sequence[float] | None:
        at = end if share == 1 else (1 - share) * begin + share * end
        return at.tolist() if at[5] > 0 else None

    return Family(numbers, begun, scale_of(numbers, last.names, 0.0, 1.0), last.names, natural)


def resume(first: EndsProblem, path: Path, last: EndsProblem) -> Path | Stop:
    """The equilibrium of the problem `last` under dead loads on the branch of an equilibrium of `first`.

    All numbers of the two problems change together, in proportion.

    Parameters
    ----------
    first, last : EndsProblem
        One ends problem each.
    path : Path
        The equilibrium of `first`.

    Returns
    -------
    Path or Stop
        `Stop` where the branch ends between the two; no other equilibrium is returned in its place.
    """
    if not path.helix:
        begin, end = (np.concatenate(list(vars(problem).values())) for problem in (first, last))
        level, way = np.array([path.pin, path.sign, path.y], float), np.array([path.leaving, path.turns], np.int64)
        if fine(run("rod_continued", begin, end, on_grid(), points(NODES), cut(CUTTING, TIMES), level, way)):
            return Path(*level.tolist(), *way.tolist())
    return _resume_by_leaps(first, path, last)


def _resume_by_leaps(first: EndsProblem, path: Path, last: EndsProblem) -> Path | Stop:
    """What the core leaves: a branch that needs a leap, passes a helix, or ends."""
    target = boundary_of(last).helix
    if path.helix and target is not None and first.beta0[0] == last.beta0[0]:
        return target  # H is linear in the loads, so it is zero on the whole line
    if target is None:
        return _follow(first, path, last)
    before = problem_of(Given.dead(first).towards(Given.dead(last), 1 - LEAPS[0]), {})
    near = _follow(first, path, before)
    if isinstance(near, Stop):
        return near
    orbits = orbit_of(before, near), orbit_of(last, target)
    angles, index = [angles_on(orbit) for orbit in orbits], [jacobi_zeros(orbit)[0] for orbit in orbits]
    if np.abs(angles[0] - angles[1]).max() < NEAR and index[0] == index[1]:
        return target
    return _follow(before, near, last)


def _follow(first: EndsProblem, path: Path, last: EndsProblem) -> Path | Stop:
    """The path followed along the line."""
    carried = carry(state_of(first, path), Given.dead(last))
    return carried if isinstance(carried, Stop) else carried.path
