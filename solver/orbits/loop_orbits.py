"""Closed rods: their orbits, their Morse index, and where they intersect themselves.

The orbits are librations about pi/2 without axial force and twist. Lengths in units of rho.

With mu = phi = 0 the potential has the symmetry beta -> pi - beta, so over a period of a libration about pi/2 the
integrals of cos(beta) and of sin(beta) cos(beta) vanish: the rod closes along the axis, and its section comes back
without a turn. What is left to close is the azimuth. With s = sin(beta), and s1 that of the lowest angle b1,

    beta_t^2 = (s - s1) [(s + s1)(s^2 + s1^2) - 2 lam],    lam = 2 s1^3 - gap,    gap > 0.

At a fixed b1 the bracket falls as lam rises, so the period rises from 0 (gap infinite) to infinity (gap = 0): for each
b1 in (-pi/2, pi/2) one lam gives the wanted period. Along this curve the azimuth of a period falls from the period (b1
= pi/2, the ring) to minus the period (b1 = -pi/2). A loop is a point where it is the wanted azimuth; a point where it
is minus that is the mirror image (beta, lam -> -beta, -lam) of a loop about -pi/2.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..core.measures import crossings
from ..numerics.arrays import ALIKE, FAINT, NEGLIGIBLE, ROUGHLY, Array
from ..numerics.roots import root
from ..problem.dimensionless import StartProblem
from .frames import position
from .periodic_orbit import TIGHT, Orbit, solve_orbit
from .variations import Variations, variations_on

# of the curve of one period, at which the azimuth is compared with the wanted one. x10: the same loops in 4.2 times the
# time
AMPLITUDES = 32
_FINEST = -30.0  # of log(gap): lam holds no smaller gap, 1e-13. x10: the search ends below the rounding of lam
# at gap = (_SHORT/T)^2 the period is below T; it is below 2 pi (1 + log(1/(b1 + pi/2)))/sqrt(gap). x10: only time
_SHORT = 100.0
_FAR = 60.0  # bound of the log of a period, so that no infinity enters. x10: as good


@dataclass(frozen=True)
class ClosedOrbit:
    """An orbit about pi/2: its lowest angle [rad], lam, and the error of its period and azimuth over the period."""

    lowest: float
    lam: float
    error: float

    @property
    def is_closed(self) -> bool:
        """Whether the error shows to no reader."""
        return self.error < NEGLIGIBLE


def orbits_of_gain(period: float, azimuth: float) -> tuple[list[ClosedOrbit], list[ClosedOrbit]]:
    """The orbits about pi/2 of a period in which alpha gains `azimuth`, and those in which it gains its negative.

    0 < azimuth < period. The largest b1 first.
    """
    lowest = _angles(period, azimuth)
    y = _gaps(lowest, period, ROUGHLY)
    known = np.isfinite(y)
    lowest, y = lowest[known], y[known]
    mean = _mean(lowest, y)
    ahead, behind = (_crossings(lowest, y, mean, period, gain) for gain in (azimuth, -azimuth))
    return ahead, behind


def _crossings(lowest: Array, y: Array, mean: Array, period: float, azimuth: float) -> list[ClosedOrbit]:
    """The orbits in which alpha gains `azimuth`, from points of the curve of one period and their mean sin(beta)."""
    excess = mean - azimuth / period
    orbits = []
    for k in np.flatnonzero((excess[:-1] > 0) != (excess[1:] > 0)):
        cell = slice(k, k + 2)
        at, guess = (float(v[k] + (v[k + 1] - v[k]) * excess[k] / (excess[k] - excess[k + 1])) for v in (lowest, y))
        orbit = _polish(at, guess, period, azimuth)
        inside = lowest[k + 1] <= orbit.lowest <= lowest[k]
        orbits.append(orbit if orbit.is_closed and inside else _refine(lowest[cell], period, azimuth))
    return orbits


def _angles(period: float, azimuth: float) -> Array:
    """Lowest angles from pi/2 to -pi/2, dense about 0 on the scale of the angle of a long loop's legs."""
    scale = max(min(1.0, azimuth / period), 1e-3)
    far = np.arcsinh(np.pi / 2 / scale)
    inner = scale * np.sinh(np.linspace(far, -far, AMPLITUDES + 1))[1:-1]
    near = np.geomspace(1e-7, 0.05, 8)  # of the ring, and of its mirror image
    return np.sort(np.concatenate([inner, np.pi / 2 - near, near - np.pi / 2]))[::-1]


def _gaps(lowest: Array, period: float, narrow: float) -> Array:
    """log(gap) at which the orbits from the lowest angles (n,) have the period; NaN where lam cannot hold it."""
    from scipy.optimize.elementwise import find_root

    ends = np.full(lowest.size, _FINEST), np.full(lowest.size, 2 * np.log(_SHORT / period))
    goal = {"fatol": narrow, "xatol": ALIKE, "frtol": 0.0, "xrtol": 0.0}
    root_of = find_root(lambda y, b1: _excess(b1, y, period), ends, args=(lowest,), tolerances=goal)
    return np.where(np.abs(root_of.f_x) < 2 * ROUGHLY, root_of.x, np.nan)


def _excess(lowest: Array, y: Array, period: float) -> Array:
    """log of the period over the wanted one, (n,), bounded; the bound too where lam cannot hold so small a gap."""
    return np.nan_to_num(np.clip(np.log(_measure(lowest, y)[0] / period), -_FAR, _FAR), nan=_FAR)


def _refine(lowest: Array, period: float, azimuth: float) -> ClosedOrbit:
    """The orbit between two lowest angles (2,)."""
    from scipy.optimize import brentq

    def off(at: float) -> float:
        b1 = np.array([at])
        return float((_mean(b1, _gaps(b1, period, ALIKE)) - azimuth / period)[0])

    try:
        at = brentq(off, *lowest, xtol=ALIKE, disp=False)
    except ValueError:  # lam cannot hold the gap of an orbit between them
        return ClosedOrbit(float(lowest[0]), np.nan, np.inf)
    return _polish(at, float(_gaps(np.array([at]), period, ALIKE)[0]), period, azimuth)


def _polish(b1: float, y: float, period: float, azimuth: float) -> ClosedOrbit:
    """Newton's method in b1 and log(gap), with the exact derivatives of the period and the azimuth."""
    goal = np.array([period, azimuth])
    point = root(lambda x: residual(float(x[0]), float(x[1]), goal), np.array([b1, y]), np.inf)
    if point is None:
        return ClosedOrbit(b1, _load(b1, y), np.inf)
    b1, y = point.tolist()
    return ClosedOrbit(b1, _load(b1, y), float(np.abs(residual(b1, y, goal)[0]).max() / period))


def residual(b1: float, y: float, goal: Array) -> tuple[Array, Array]:
    """Period and azimuth of a period less the wanted ones, (2,); their derivatives by b1 and y = log(gap), (2, 2)."""
    problem = start(np.array([b1]), np.array([_load(b1, y)]))
    varied = vary_from(problem)
    T = varied.orbit.period
    parts = varied.directions
    gained = varied.change(T[:, None], parts).integrals[0, 0, :, 0]
    later = -2 * varied.kept["gain"][0, :, :4].sum(axis=0) @ parts[0, 1:]
    plain = np.stack([later, gained + np.sin(b1) * later])[:, [0, 2]]  # by b1 and by lam
    by_lam = np.exp(y) * plain[:, 1]
    J = np.stack([plain[:, 0] + 6 * np.sin(b1) ** 2 * np.cos(b1) * plain[:, 1], -by_lam], axis=1)
    T_now, turn = _measure(np.array([b1]), np.array([y]))
    return np.array([T_now[0], turn[0]]) - goal, J


def vary_from(problem: StartProblem) -> Variations:
    """The variations of the orbits of start problems."""
    return variations_on(solve_orbit(problem, TIGHT))


def start(lowest: Array, lam: Array) -> StartProblem:
    """The start problems at a turning point, (n,)."""
    none = np.zeros(lowest.size)
    return StartProblem(lam, none, none, none + 1.0, lowest, none)


def _load(lowest: Any, y: Any) -> Any:
    return 2 * np.sin(lowest) ** 3 - np.exp(y)


def _mean(lowest: Array, y: Array) -> Array:
    """The mean of sin(beta), (n,): next to the ring it hardly depends on lam."""
    period, turn = _measure(lowest, y)
    return turn / period


def _measure(lowest: Array, y: Array) -> tuple[Array, Array]:
    """The periods of the orbits, and what alpha gains in one, (n,) each."""
    orbit = solve_orbit(start(lowest, _load(lowest, y)), FAINT)
    return orbit.period, 2 * orbit.gain[:, 0].reshape(-1, 2).sum(axis=1)


_DENSE = 4.0  # points for each radius of the rod: a point is at most an eighth of it off. x10: only time
MOST_PLACES = 200_000  # at which a rod is looked at for self-contact. x10: ten times the time and memory for one rod


def meets_itself(orbit: Orbit, a: float, tightest: float) -> bool | None:
    """Whether a closed rod comes closer to itself than two radii, or bends more tightly than its radius.

    Points pi a apart or less along the closed rod are neighbours, as in `observe.self_contact`. a: the radius, and
    tightest: the largest curvature, in units of rho. None for a rod with more points than can be compared.
    """
    if a * tightest >= 1:
        return True
    span = float(orbit.problem.span[0])
    count = int(np.ceil(_DENSE * span / a))
    if count > MOST_PLACES:
        return None
    t = np.arange(count) * (span / count)
    _, _, alpha, z = orbit.at(t[None])
    points = position(1.0, alpha[0], z[0])
    return len(crossings(t, points, 2 * a, np.pi * a, span)) > 0


_HELD = [1, 3]  # the rows of M of lam and phi, whose displacements are held


def index_of(lowest: float, lam: float, folds: int) -> int:
    """The Morse index of a loop from its orbit about pi/2; 0: stable.

    The second variation of the energy at the loads found is S = -d2/dt2 - H'(beta) for periodic changes of beta;
    closing holds the integrals of cos(beta) eta and of sin(beta) eta at 0. beta_t is the change that shifts the start
    and belongs to the eigenvalue 0. It has two zeros a period, so of the changes that come back after `folds` periods

    * those that do not come back after one (the Bloch phases other than 0) have 2 (folds - 1) negative eigenvalues, and
      no constraint touches them: a loop of two folds or more is unstable on the surface;
    * those that come back after one have one negative eigenvalue where the period rises with the level, and two where
      it falls; of these the held displacements take away as many as the compliance of a period has negative ones.

    The compliance K = d(azimuth, height)/d(lam, phi) at a fixed period is a Schur complement of the Hessian M of the
    action. The section is free to turn, so M3 stays 0; where the ends are glued, twist adds energy that is not
    negative, so a loop of index 0 is stable there too.
    """
    varied = vary_from(start(np.array([lowest]), np.array([lam])))
    M = np.empty((4, 4))
    rows, columns = np.triu_indices(4)
    M[rows, columns] = M[columns, rows] = varied.kept["gain"][0, :, :10].sum(axis=0)
    of_one_wave = 1 if M[0, 0] < 0 else 2  # the derivative of half the period by half the level is -M_00
    K = (M - np.outer(M[:, 0], M[0]) / M[0, 0])[np.ix_(_HELD, _HELD)]
    scale = 1 / np.sqrt(np.abs(np.diag(K)))
    return 2 * (folds - 1) + of_one_wave - int((np.linalg.eigvalsh(K * np.outer(scale, scale)) < 0).sum())
