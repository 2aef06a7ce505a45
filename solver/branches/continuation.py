"""Continuation of one equilibrium while its ends, its loads, its length or the cylinder change.

An equilibrium is one orbit: the direction in which it leaves, the number of turning points that it passes, and its
level. For a fixed path the level follows from one scalar equation, length(level) = span. The unknown is one of

* log|gap| above or below a saddle that the rod passes or turns before: a rod that stays near a saddle is as easy to
  follow as any other;
* log beta_t^2 at one of the two ends;
* beta_t at an end, with its sign, where it is small: there the orbit that leaves upward and the one that leaves
  downward meet, and the path changes by one turning point.

Steps lead from the given problem to the wanted one, by predictor and corrector. d length/d unknown must keep its sign
from step to step: it changes at a fold, and between two neighbouring equilibria of one path. So the steps stop at a
fold and before a neighbour; small steps make a jump over both unlikely, but do not exclude it. Where steps become small
and the branch does not end (an end of the rod crosses a saddle, in a range as narrow as exp(-r L)), a leap is made: all
equilibria of the neighbouring paths are computed a little farther on, and the branch continues with the only one of the
same Morse index whose shape is close to the last.
"""

from dataclasses import dataclass

import numpy as np

from ..core import levels as core
from ..levels.line_point import LinePoint, Path
from ..levels.morse_index import jacobi_zeros
from ..levels.path_orbits import orbit_of
from ..levels.transit_times import CUTTING, NODES
from ..orbit.critical_points import grid
from ..problem.reduced import EndsProblem
from .continuation_steps import FIELDS, LEAPS, NEAR, SHORTEST, Line, advanced, leapt, settle, shape_of

_MOST_STEPS = 4000


@dataclass(frozen=True)
class Ended:
    """Why a branch could not be followed, and the share of the line to the wanted problem that was covered."""

    share: float
    reason: str


def resume(first: EndsProblem, path: Path, last: EndsProblem) -> Path | Ended:
    """The equilibrium of the problem `last` on the branch of an equilibrium of `first`.

    All numbers of the two problems change together, in proportion.

    Parameters
    ----------
    first, last : EndsProblem
        One ends problem each.
    path : Path
        The equilibrium of `first`.

    Returns
    -------
    Path or Ended
        `Ended` where the branch ends between the two; no other equilibrium is returned in its place.
    """
    if not path.helix:
        begin, end = (np.concatenate([getattr(one, name) for name in FIELDS]) for one in (first, last))
        level, way = (path.pin, path.sign, path.y), (path.leaving, path.turns)
        found = core.resume(begin, end, level, way, grid(), NODES, CUTTING)
        if found is not None:
            return Path(*found)
    return _resume_by_leaps(first, path, last)


def _resume_by_leaps(first: EndsProblem, path: Path, last: EndsProblem) -> Path | Ended:
    """What the core leaves: a branch that needs a leap, passes a helix, or ends."""
    line = Line(first, last)
    place, target = line.at(0.0), line.at(1.0)
    if path.helix and target.helix is not None and first.beta0[0] == last.beta0[0]:
        return target.helix  # H is linear in the loads, so it is zero on the whole line
    if target.helix is None:
        return _follow(line, place, path)
    before = Line(first, line.at(1 - LEAPS[0]).problem)
    near = _follow(before, place, path)
    if isinstance(near, Ended):
        return near
    orbits = orbit_of(before.last, near), orbit_of(last, target.helix)
    shapes, index = [shape_of(orbit) for orbit in orbits], [jacobi_zeros(orbit)[0] for orbit in orbits]
    if np.abs(shapes[0] - shapes[1]).max() < NEAR and index[0] == index[1]:
        return target.helix
    return _follow(Line(before.last, last), LinePoint(before.last), near)


def _follow(line: Line, place: LinePoint, path: Path) -> Path | Ended:
    """The path followed along the line; not both ends of the line are helices."""
    share, step, here = 0.0, 1.0, path
    if path.helix:
        begun = leapt(line, place, path, share)
        if begun is None:
            return Ended(share, "no equilibrium next to the helix")
        place, here, share = begun
    else:
        settled = settle(place, path)
        if isinstance(settled, str):
            return Ended(share, settled)
        if line.is_point:
            return settled
        here = settled
    for _ in range(_MOST_STEPS):
        if share >= 1:
            return here
        advance = advanced(line, place, here, share, min(step, 1 - share))
        if isinstance(advance, str):
            step = min(step, 1 - share) / 4
            if step >= SHORTEST:
                continue
            leap = leapt(line, place, here, share)
            if leap is None:
                return Ended(share, advance)
            advance = leap
        place, here, taken = advance
        share = 1.0 if taken >= 1 - share else share + taken
        step = 2 * taken
    return Ended(share, f"the limit of {_MOST_STEPS} steps")
