"""The orbits of levels and paths, the path of an orbit, and the shapes of equilibria as trajectories.

Orbits that stay at a saddle for longer than a gap in floating point can express have panels at rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from ..core.tuning import LOWEST
from ..numerics.arrays import ALIKE, EPS, Array, Columns
from ..problem.dimensionless import EndsProblem, StartProblem
from ..problem.outcomes import verdicts
from ..problem.trajectory import PLAIN, Trajectory, blank
from .boundary import (
    DOWN,
    STRETCH,
    UP,
    Boundary,
    Levels,
    Path,
    Paths,
    Ways,
    boundary_of,
    repeat,
    transit_times,
)
from .joined_orbits import alike, join_answers
from .periodic_orbit import HELIX, TIGHT, Orbit, action, response, solve_orbit
from .potential import potential, slope
from .variations import HelixVariations, Variations, variations_on

NO_EQUILIBRIUM = "failed: the search found no equilibrium, though at least one exists"
# Relative: the largest estimate (2 * miss) of 7,000 random orbits that sweep 1 to 1e9 rad was 18 eps. x10: errors are
# said to be larger than they are
ROUNDING = 20 * EPS
# in log gap: the root of the gap, the error of a rod at rest on a saddle, is then below rounding. x10: the gap
# underflows
_DEEPER = 40.0


@dataclass(frozen=True, eq=False)
class _Starts(Columns):
    """The start problems of K levels, without the time that a gap in floating point cannot express at a saddle.

    problem: the start problems. measured: the pins. gap: the gaps. excess: the log by which these are too large. falls:
    (K, 2), of the two ends from the pins. The others: (K,).
    """

    problem: StartProblem
    measured: Array
    gap: Array
    excess: Array
    falls: Array

    @property
    def orbit(self) -> Orbit:
        """The orbits, each with the problem that it starts from."""
        return solve_orbit(self.problem, TIGHT, (self.measured, self.gap, self.excess), STRETCH)

    @property
    def level(self) -> Array:
        """The levels eta, (K,)."""
        return potential(self.problem, self.measured) + self.gap


def solve_orbits(problem: EndsProblem, boundary: Boundary, paths: Paths, lengthens: Array) -> tuple[Orbit, Array]:
    """The orbits of K equilibria of one problem, and their levels eta, (K,)."""
    starts = _starts(problem, boundary, paths)
    return _orbits_between(repeat(problem, paths.y.size), starts, paths, lengthens), starts.level


def _orbits_between(problem: EndsProblem, starts: _Starts, paths: Paths, lengthens: Array) -> Orbit:
    """The orbits of K ends problems, with what is known of equilibria."""
    orbit = replace(starts, excess=0 * starts.gap).orbit
    # between two ends on saddles of this height eta(L) stays while eta between them grows as the gap's root falls
    growth = response(orbit)[0] * np.exp(np.minimum((starts.falls == 0).all(axis=1) * starts.excess / 2, 600))
    if starts.excess.any():
        orbit = starts.orbit
    base = orbit.panels.base + np.repeat(problem.beta0 - starts.problem.beta0, 2)[orbit.panels.arc]  # whole turns
    start = replace(starts.problem, beta0=problem.beta0, span=problem.span)
    known = {"lengthens": lengthens, "response": growth, "paths": paths}
    return replace(orbit, problem=start, panels=replace(orbit.panels, base=base), **known)


def _starts(problem: EndsProblem, boundary: Boundary, paths: Paths) -> _Starts:
    """The starts of K equilibria of one problem."""
    boundary = replace(boundary, deepest=max(LOWEST, boundary.deepest - _DEEPER))
    K, moves = paths.y.size, ~paths.helix
    pin = np.array([int(np.argmin(np.abs(boundary.pins - p))) for p in paths.pin[moves]], dtype=int)
    gap, dbeta0, excess = np.zeros(K), np.zeros(K), np.zeros(K)
    gap[moves] = paths.sign[moves] * np.exp(np.maximum(paths.y[moves], boundary.deepest))
    dbeta0[moves] = paths.leaving[moves] * np.sqrt(np.maximum(boundary.start_speed2(pin, gap[moves]), 0))
    excess[moves] = np.maximum(boundary.deepest - paths.y[moves], 0)
    measured, falls = paths.pin.copy(), np.ones((K, 2))
    measured[moves], falls[moves] = boundary.pins[pin], boundary.falls[pin]
    start = replace(repeat(problem, K).with_start(dbeta0), beta0=np.full(K, boundary.start))
    deep = excess > 0
    if deep.any():
        moving = Ways(paths.leaving[moves], paths.turns[moves])
        seen = transit_times(boundary, Levels(pin, paths.sign[moves], paths.y[moves]), deep=False)
        span = start.span.copy()
        span[moves] = np.where(deep[moves], seen.lengths_along(moving.counts(boundary.rising)), span[moves])
        start = replace(start, span=span)
    return _Starts(start, measured, gap, excess, falls)


def variations_of(problem: EndsProblem, path: Path) -> Variations | HelixVariations:
    """The variations of one equilibrium."""
    if path.helix:
        return HelixVariations(problem, held=True)
    starts = _starts(problem, boundary_of(problem).with_pin(path.pin), path.alone)
    return variations_on(replace(starts.orbit, problem=replace(starts.problem, span=problem.span)))


def orbits_of_paths(problem: EndsProblem, paths: Sequence[Path]) -> Orbit:
    """The orbits of one equilibrium of each of B problems, with what their indices and condition numbers need."""
    problems = [problem.take(slice(i, i + 1)) for i in range(len(paths))]
    boundaries = [boundary_of(row).with_pin(path.pin) for row, path in zip(problems, paths, strict=True)]
    lengthens = np.array([boundary.lengthens(path) for boundary, path in zip(boundaries, paths, strict=True)])
    alone = [path.alone for path in paths]
    starts = _Starts.join([_starts(*row) for row in zip(problems, boundaries, alone, strict=True)])
    return _orbits_between(problem, starts, Paths.join(alone), lengthens)


def orbit_of(problem: EndsProblem, path: Path) -> Orbit:
    """The orbit of one equilibrium, with the fields that its Morse index and its condition number need."""
    return orbits_of_paths(problem, [path])


def energies(orbit: Orbit, level: Array) -> Array:
    """Bending energy minus the work of the dead loads, the twist eliminated, in units of A/rho, (B,).

    beta_t^2/2 - G/2 integrated over the rod is the integral of beta_t^2 less level span/2, level = eta (B,). Both terms
    are exact to a few roundings, so the error of the energy is a few roundings of the larger one.
    """
    return action(orbit) - level * orbit.problem.span / 2


def path_from_start(problem: EndsProblem, dbeta0: float) -> Path | None:
    """The equilibrium of one ends problem that starts with beta_t(0) = dbeta0.

    None where that orbit does not end at beta(L).
    """
    orbit = solve_orbit(problem.with_start(np.array([dbeta0])), TIGHT)
    # an orbit that ends farther from beta(L) [rad] is not that of an equilibrium
    if abs(float(orbit.far_angle[0] - problem.betaL[0])) > ALIKE:
        return None
    boundary = boundary_of(problem)
    if orbit.kind[0] == HELIX:
        return boundary.helix
    y = 2 * float(np.log(max(abs(dbeta0), 1e-150)))
    pull = dbeta0 or -float(slope(problem, problem.beta0)[0])  # of a start at rest, from which beta_tt leads
    return Path(boundary.start, 1.0, y, UP if pull > 0 else DOWN, int(orbit.turns[0]))


def equilibrium_trajectory(problem: EndsProblem, orbit: Orbit, t: Array, tol: float) -> Trajectory:
    """The orbits of K ends problems at stations t (K, n); their error is that of beta(L)."""
    condition = response(orbit)[0] if orbit.response is None else orbit.response
    return trajectory_on(orbit, t, np.abs(orbit.far_angle - problem.betaL), condition, tol)


def trajectory_on(orbit: Orbit, t: Array, miss: Array, condition: Array, tol: float) -> Trajectory:
    """The orbits of K ends problems at stations t (K, n); miss: (K,), by how much each misses what its ends are given.

    Where the rounding of a case alone may exceed the tolerance, the miss is chance: the error is then what it may be.
    """
    beta, dbeta, alpha, z = orbit.at(t)
    error, rounding = (2 * miss + 1e-14) * condition, ROUNDING * _swept(orbit) * condition
    error = np.where(rounding > tol, np.maximum(error, rounding), error)
    rest = *verdicts(beta, error, condition, tol, 2 * rounding), error, condition, orbit.evaluations, orbit
    return Trajectory(beta, dbeta, alpha, z, partial(orbit.swirl, t), *rest)


def _swept(orbit: Orbit) -> Array:
    """By how much beta changes where the length and the far angle double [rad], (K,)."""
    return np.asarray(np.abs(orbit.far_angle) + orbit.fastest * orbit.problem.span)


def together(answers: Sequence[Trajectory | str], t: Array) -> Trajectory:
    """The answers to B problems at t (B, n) as one; a problem without an answer is given by its outcome."""
    if len(answers) == 1 and not isinstance(answers[0], str):
        return answers[0]
    each = [_blank_trajectory(t[i : i + 1], a) if isinstance(a, str) else a for i, a in enumerate(answers)]
    orbits = alike([a.orbit for a in each])
    known = [name for name in _UNKNOWN if any(getattr(answer, name) is not None for answer in each)]
    return join_answers((_row(answer, orbit, known) for answer, orbit in zip(each, orbits, strict=True)), t, len(each))


def _row(answer: Trajectory, orbit: Orbit, known: Sequence[str]) -> Trajectory:
    """The answer to one of several problems, with arrays also for what is known of others and not of it."""
    unknown: dict[str, Any] = {name: _UNKNOWN[name] for name in known if getattr(answer, name) is None}
    return replace(answer, orbit=orbit, alternatives=None, **unknown)


_UNKNOWN = {name: np.array([None]) for name in ("selection", "begun")}
_UNKNOWN |= {name: np.array([np.nan]) for name in ("held_index", "dead_index")}


def _blank_trajectory(t: Array, why: str) -> Trajectory:
    """An answer that stands for none: a plain rod, blank."""
    plain = {name: np.array([value]) for name, value in PLAIN.items()}
    dbeta0, betaL = plain.pop("dbeta0"), plain.pop("betaL")
    orbit = solve_orbit(StartProblem(**plain, dbeta0=dbeta0), TIGHT)  # the tolerance of the others: the same series
    answer = equilibrium_trajectory(EndsProblem(**plain, betaL=betaL), orbit, t, 1.0)
    return blank(answer, np.array([False]), np.array([why], dtype=object))
