"""Continuation of one equilibrium while the numbers that are given change: its ends, its loads, its length.

Steps lead from the given numbers to the wanted ones, by predictor and corrector in a coordinate of the path (`charts`).
The orientation of the equations must not change from step to step: it changes at a fold, and between two neighbouring
equilibria of one path. So the steps stop at a fold and before a neighbour; small steps make a jump over both unlikely,
but do not exclude it. Where steps become small and a branch under dead loads does not end (an end of the rod crosses a
saddle, in a range as narrow as exp(-r L)), a leap is made (`leaps`).
"""

from dataclasses import dataclass, replace

import numpy as np

from ..core import levels as core
from ..equilibrium.charts import charts, coordinate
from ..equilibrium.given_numbers import FREE, Given, OrbitState, orientation, predict, problem_after, problem_of
from ..equilibrium.system import LEFT, REACH, correct_equilibrium, state_of
from ..levels.line_point import LinePoint, Path
from ..levels.morse_index import jacobi_zeros
from ..levels.path_orbits import orbit_of
from ..levels.transit_times import CUTTING, NODES
from ..numerics.roots import DIVERGED
from ..problem.reduced import EndsProblem
from .helices import helix_ahead, off_helix
from .leaps import LEAPS, NEAR, leap, shape_of

_MOST_STEPS = 4000
_SHORTEST = 1e-6  # share of the line below which a step is abandoned
_ROUGH = 1e-7  # size of the last correction of a state before the last one
_EASY = 1e-2  # length of a step above which only the best coordinate is tried
_SMALL = 0.03  # size of a step
_GOOD = 0.05  # size of the corrections of a good prediction, over that of the step
_POOR, _CLOSE = 0.3, 1e-6  # the same of a poor one under dead loads; size of corrections that are never too large
_FAR = 0.1  # share of the line over which a helix is passed
_ROUNDING = 1e-15  # share of the line
_SAME = 1e-12  # largest change of a number that leaves a helix as it is
FOLD = "a fold"
STILL = "the start is a helix, and the change does not bend its ends; give a bent seed"


@dataclass(frozen=True)
class Stopped:
    """Why a branch could not be followed, the share of the line that was covered, and the last state."""

    share: float
    reason: str
    state: OrbitState


def carry(state: OrbitState, wanted: Given, most_steps: int = _MOST_STEPS) -> OrbitState | Stopped:
    """The equilibrium with the wanted numbers on the branch of a state; all numbers change in proportion."""
    first, is_dead, share, step = wanted.at(state), wanted.names == FREE, 0.0, 1.0
    reason, before = LEFT, (0.0, state)
    if state.path.helix:
        off = np.abs(np.append(first.values - wanted.values, first.span - wanted.span))
        if (off <= _SAME * (1 + np.abs(np.append(wanted.values, wanted.span)))).all():
            return state
        bent = off_helix(state, wanted)
        if bent is None:
            helix = helix_ahead(state, wanted)
            return Stopped(0.0, STILL, state) if helix is None else helix
        state, share = bent
        before = share, state
    for _ in range(most_steps):
        if share > 1 - _ROUNDING:  # next to rest at an end each step goes a share of what is left
            return state
        step = min(step, 1 - share)
        ahead = _advance(state, first, wanted, share, step)
        if isinstance(ahead, str) or (ahead[1] < _EASY and share > before[0]):
            beyond = _past_a_helix(before, (share, state), first, wanted)
            ahead = ahead if beyond is None else beyond
        if isinstance(ahead, str):
            reason, step = ahead, step / 3
            if step >= _SHORTEST:
                continue
            beyond = leap(first, wanted, share, state.problem, state.path) if is_dead else None
            if beyond is None:
                return Stopped(share, FOLD if reason == DIVERGED else reason, state)
            ahead = beyond
        before = share, state
        state, taken = ahead
        share = 1.0 if taken >= 1 - share else share + taken
        step = 3 * taken
    return Stopped(share, f"the limit of {most_steps} steps", state)


def _is_crossed(before: OrbitState, after: OrbitState, given: Given, size: float) -> bool:
    """Whether a step of some size may have led to another branch: it was predicted badly, or the equations change their
    orientation.

    A branching point that is passed along a branch changes it too; there the prediction of a small step is good.
    """
    if given.names == FREE and after.corrected > max(_POOR * size, _CLOSE):  # a pair of folds may have been passed
        return True
    turned = orientation(before.rates, given) * orientation(after.rates, given) < 0
    return turned and (size > _SMALL or after.corrected > _GOOD * size)


def _past_a_helix(
    before: tuple[float, OrbitState], here: tuple[float, OrbitState], first: Given, wanted: Given
) -> tuple[OrbitState, float] | None:
    """The state beyond a helix that a branch passes, and the step taken, from two states before it.

    On a helix no path has a level: beta_t falls to zero along the whole rod and grows again with the other sign.
    """
    (share_0, earlier), (share_1, two) = before, here
    v_0, v_1 = (state.rates.values[0, 2:4] for state in (earlier, two))
    if share_1 <= share_0 or two.path.helix or not (np.abs(v_1) < 0.9 * np.abs(v_0)).all() or (v_0 * v_1 < 0).any():
        return None
    zero = share_1 + (share_1 - share_0) * float(v_1[0] / (v_0[0] - v_1[0]))
    share = 2 * zero - share_1
    if not share_1 < share < 1 or share - share_1 > _FAR:
        return None
    along = (share - share_1) / (share_1 - share_0)
    guess = {name: getattr(two.problem, name) + along * (getattr(two.problem, name) - getattr(earlier.problem, name))
             for name in (*FREE, "span")}  # fmt: skip
    problem, speeds = EndsProblem(**guess), np.abs(v_1 + along * (v_1 - v_0))
    place, ahead = LinePoint(problem), first.towards(wanted, share)
    for speed, angle in sorted(zip(speeds, (place.start, place.end), strict=True)):
        path = Path(angle, 1.0, 2 * float(np.log(speed)), -two.path.leaving, two.path.turns)
        for chart in charts(place, path, wanted.hinged):
            corrected = correct_equilibrium(problem, ahead, chart, coordinate(chart), _ROUGH)
            if not isinstance(corrected, str):
                return corrected, share - share_1
    return None


def _advance(
    state: OrbitState, first: Given, wanted: Given, share: float, step: float
) -> tuple[OrbitState, float] | str:
    """The state after at most one step, and the step taken; else why the step failed in the best coordinate."""
    reason = ""
    for chart in charts(LinePoint(state.problem), state.path, wanted.hinged):
        given, ahead = first.towards(wanted, share), first.towards(wanted, share + step)
        change, dx, size = predict(state, chart, given, ahead)
        factor = 1.0
        if not np.isfinite(size):
            reason = reason or DIVERGED
        else:
            if size > REACH:
                factor = REACH / size
                ahead = first.towards(wanted, share + factor * step)
            guess = problem_after(state.problem, ahead, change, factor)
            goal = 0.0 if ahead is wanted else _ROUGH
            corrected = correct_equilibrium(guess, ahead, chart, coordinate(chart) + factor * dx, goal)
            if not isinstance(corrected, str) and not _is_crossed(state, corrected, wanted, factor * size):
                return corrected, factor * step
            reason = reason or (corrected if isinstance(corrected, str) else DIVERGED)
        if step > _EASY:
            break
    return reason


def resume(first: EndsProblem, path: Path, last: EndsProblem) -> Path | Stopped:
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
    Path or Stopped
        `Stopped` where the branch ends between the two; no other equilibrium is returned in its place.
    """
    if not path.helix:
        begin, end = (np.concatenate(list(vars(problem).values())) for problem in (first, last))
        level, way = (path.pin, path.sign, path.y), (path.leaving, path.turns)
        numbers = core.resume(begin, end, level, way, NODES, CUTTING)
        if numbers is not None:
            return Path(*numbers)
    return _resume_by_leaps(first, path, last)


def _resume_by_leaps(first: EndsProblem, path: Path, last: EndsProblem) -> Path | Stopped:
    """What the core leaves: a branch that needs a leap, passes a helix, or ends."""
    target = LinePoint(last).helix
    if path.helix and target is not None and first.beta0[0] == last.beta0[0]:
        return target  # H is linear in the loads, so it is zero on the whole line
    if target is None:
        return _follow(first, path, last)
    before = problem_of(Given.dead(first).towards(Given.dead(last), 1 - LEAPS[0]), {})
    near = _follow(first, path, before)
    if isinstance(near, Stopped):
        return near
    orbits = orbit_of(before, near), orbit_of(last, target)
    shapes, index = [shape_of(orbit) for orbit in orbits], [jacobi_zeros(orbit)[0] for orbit in orbits]
    if np.abs(shapes[0] - shapes[1]).max() < NEAR and index[0] == index[1]:
        return target
    return _follow(before, near, last)


def _follow(first: EndsProblem, path: Path, last: EndsProblem) -> Path | Stopped:
    """The path followed along the line; not both ends of the line are helices."""
    goal = Given.dead(last)
    if path.helix:
        begun = leap(Given.dead(first), goal, 0.0, first, path)
        if begun is None:
            return Stopped(0.0, "no equilibrium next to the helix", state_of(first, path))
        state, share = begun
        result = _follow(state.problem, state.path, last)
        return replace(result, share=share + (1 - share) * result.share) if isinstance(result, Stopped) else result
    carried = carry(state_of(first, path), goal)
    return carried if isinstance(carried, Stopped) else carried.path
