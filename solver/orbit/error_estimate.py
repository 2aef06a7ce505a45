"""The estimated error of a periodic orbit."""

import numpy as np

from ..core import orbits as core
from ..core.panels import available
from ..mechanics.potential import load_size, slope_higher_rates, slope_rate, slope_size
from ..numerics.arrays import Array
from ..problem.reduced import StartProblem
from .conditioning import condition
from .panels import EPS
from .periodic_orbit import Orbit
from .pieces import LIBRATION


def judged(orbit: Orbit) -> tuple[Array, Array]:
    """The condition number and the estimated error of B orbits, (B,) each."""
    if available():
        return core.judge(orbit)
    growth = condition(orbit)
    return growth, estimated_error(orbit, growth)


def estimated_error(orbit: Orbit, growth: Array) -> Array:
    """The error by truncated series, by the repeated period and by the rounding of the input, (B,).

    growth: (B,), the condition number. Only panels that the rod reaches count, each for the time that the rod spends on
    it.
    """
    problem, panels = orbit.problem, orbit.panels
    b, backward = panels.arc // 2, panels.arc % 2 == 1
    stay = problem.span[b] - orbit.since - np.where(backward, 2 * orbit.ahead[b], 0)
    reached = stay > 0
    b, stay = b[reached], np.minimum(stay, panels.duration)[reached]
    most = np.zeros((problem.size, 3))
    np.maximum.at(most, b, np.stack([panels.error, panels.fastest, panels.duration], axis=1)[reached])
    error, fastest, longest = most.T
    # no faster than the steepest fall from the start allows
    heights = load_size(problem) + 2
    fastest = np.minimum(fastest, np.abs(problem.dbeta0) + heights * problem.span)
    late: Array = np.bincount(
        b, weights=stay * (panels.time_error + panels.time_rounding)[reached], minlength=problem.size
    )
    librates = orbit.arcs.kind == LIBRATION
    with np.errstate(divide="ignore", invalid="ignore"):  # the period may be too short for a float
        periods = np.maximum(1, problem.span / orbit.period)
    late = late * np.where(librates, 2, 1) * periods + EPS * problem.span
    # however late, beta stays between its turning points; alpha and z are sums as long as the duration of a panel
    range_ = np.bincount(b, weights=2 * np.abs(panels.series[reached, 0, 1::2].sum(axis=1)), minlength=problem.size)
    shift = np.where(librates, np.minimum(fastest * late, range_), fastest * late)
    sums = EPS * longest / np.maximum(1, problem.span)
    start = _start_rounding(problem, np.minimum(problem.span, orbit.ahead + orbit.back))
    inputs = np.maximum(1, np.abs(problem.beta0)) + start / EPS
    return 2 * error + shift + sums + growth * (_mismatch(orbit) + 2 * EPS * inputs)


def _start_rounding(problem: StartProblem, time: Array) -> Array:
    """The change of the start's angle that has the same effect as the rounding of H over this time, (B,).

    A constant addition d to H moves the rod by d t^2/2 if nothing holds it, and by no more than the change x of angle
    that changes H as much: d/|H'|, or where H' vanishes, next to a fold, the root of |H''| x^2/2 = d or of
    |third derivative| x^3/6 = d. Two of these may work against each other up to twice the smallest x.
    """
    beta = problem.beta0
    second, third = slope_higher_rates(problem, beta)
    added = EPS * slope_size(problem, beta)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        bounds = (
            added * time * time / 2,
            2 * added / np.abs(slope_rate(problem, beta)),
            2 * np.sqrt(2 * added / np.abs(second)),
            2 * np.cbrt(6 * added / np.abs(third)),
        )
        return np.asarray(np.fmin.reduce(bounds))


def _mismatch(orbit: Orbit) -> Array:
    """How far the series at t = 0 are from the given start, as a change of its angle, (B,)."""
    problem, panels = orbit.problem, orbit.panels
    off = np.zeros(problem.size)
    moves = np.flatnonzero(orbit.count[0::2] > 0)
    series = panels.series[orbit.first[0::2][moves], :2]
    beta, speed = (2 * series[:, :, 0::2].sum(axis=2) - series.sum(axis=2)).T
    v = np.abs(problem.dbeta0[moves])
    unit = np.maximum(np.maximum(1, v), np.sqrt(np.abs(slope_rate(problem, problem.beta0)))[moves])
    quickest = np.sqrt(1 + np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi))[moves] + v
    slip = np.maximum(np.abs(speed - v) - 16 * EPS * quickest, 0)  # beyond the rounding of a speed
    off[moves] = np.abs(beta - problem.beta0[moves]) + slip * np.minimum(problem.span[moves], 1 / unit)
    return off
