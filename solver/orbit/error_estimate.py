"""The estimated error of a periodic orbit."""

import numpy as np

from ..mechanics.potential import slope_higher_rates, slope_rate, slope_size
from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from .panels import EPS
from .periodic_orbit import Orbit
from .pieces import LIBRATION


def estimated_error(orbit: Orbit, growth: Array) -> Array:
    """What the cut series, the repeated period and the rounding of the input leave, (B,).

    Only panels that the rod reaches count, each for the time spent on it.
    """
    problem, panels = orbit.problem, orbit.panels
    assert problem.dbeta0 is not None
    b, back = panels.arc // 2, panels.arc % 2 == 1
    stay = problem.span[b] - orbit.since - np.where(back, 2 * orbit.ahead[b], 0)
    met = stay > 0
    b, stay = b[met], np.minimum(stay, panels.duration)[met]
    most = np.zeros((problem.size, 3))
    np.maximum.at(most, b, np.stack([panels.slack, panels.fastest, panels.duration], axis=1)[met])
    slack, fastest, longest = most.T
    # no faster than the steepest fall from the start allows
    heights = np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 2
    fastest = np.minimum(fastest, np.abs(problem.dbeta0) + heights * problem.span)
    late: Array = np.bincount(b, weights=stay * (panels.drift + panels.noise)[met], minlength=problem.size)
    librates = orbit.arcs.kind == LIBRATION
    with np.errstate(divide="ignore", invalid="ignore"):  # a swing too short for a float
        rounds = np.maximum(1, problem.span / orbit.period)
    late = late * np.where(librates, 2, 1) * rounds + EPS * problem.span
    # however late, beta stays between its turning points; alpha and z are sums as long as a panel's time
    swing = np.bincount(b, weights=2 * np.abs(panels.series[met, 0, 1::2].sum(axis=1)), minlength=problem.size)
    shift = np.where(librates, np.minimum(fastest * late, swing), fastest * late)
    sums = EPS * longest / np.maximum(1, problem.span)
    blur = _blur(problem, np.minimum(problem.span, orbit.ahead + orbit.back))
    inputs = np.maximum(1, np.abs(problem.beta0)) + blur / EPS
    return 2 * slack + shift + sums + growth * (_mismatch(orbit) + 2 * EPS * inputs)


def _blur(problem: Reduced, time: Array) -> Array:
    """Which change of the start's angle does as much as the rounding of H does in a swing of this time, (B,).

    A constant addition d to H moves the rod by d t^2/2 if nothing holds it, and by no more than the change x of angle
    that changes H as much: d/|H'|, or where H' is nothing, next to a fold, the root of |H''| x^2/2 = d or of
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
    """How far the series at t = 0 are from the start they were made for, as a change of its angle, (B,)."""
    problem, panels = orbit.problem, orbit.panels
    assert problem.dbeta0 is not None
    off = np.zeros(problem.size)
    goes = np.flatnonzero(orbit.count[0::2] > 0)
    series = panels.series[orbit.first[0::2][goes], :2]
    beta, speed = (2 * series[:, :, 0::2].sum(axis=2) - series.sum(axis=2)).T
    v = np.abs(problem.dbeta0[goes])
    unit = np.maximum(np.maximum(1, v), np.sqrt(np.abs(slope_rate(problem, problem.beta0)))[goes])
    swift = np.sqrt(1 + np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi))[goes] + v
    slip = np.maximum(np.abs(speed - v) - 16 * EPS * swift, 0)  # beyond the rounding of a speed
    off[goes] = np.abs(beta - problem.beta0[goes]) + slip * np.minimum(problem.span[goes], 1 / unit)
    return off
