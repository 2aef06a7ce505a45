"""Foot points: the places of a developed curve that are nearest to measured points."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array
from ..solution import Solution
from .data import Points

_COARSE, _FINEST = 201, 6401  # stations of the first search
_TURN = 0.2  # rad between neighbouring stations of it, at most
_STEPS = 30
_NEAR = 1e-8  # of the length: a foot is found; the distance is then known to its square

AtStations = Callable[[Array | int], Solution]


@dataclass(frozen=True, eq=False)
class Feet:
    """The feet of P points. sol: at the feet, which rise. order: the place in `sol` of the foot of each point.

    distance: signed, in units of the sizes of the points, (P,). by_alpha, by_z: its derivatives with respect to alpha
    and z of the curve at a constant s/L.
    """

    sol: Solution
    order: Array
    distance: Array
    by_alpha: Array
    by_z: Array


def feet(curve: AtStations, points: Points) -> Feet:
    """The feet of points on a curve; curve: its solution at given stations.

    At a foot within the rod the distance is normal to the curve, so moving along the curve does not change it; its
    derivative is the normal component of the motion of the curve.
    """
    sol, s, turns, low, high = _nearest(curve, points)
    alpha, z = points.columns["alpha"] + 2 * np.pi * turns, points.columns["z"]
    wide, tall = points.sizes["alpha"], points.sizes["z"]
    L = float(sol.case.rod.L)
    for _ in range(_STEPS):
        place, at = _at(curve, s)
        across, up, da, dz, along = _local(at, place, alpha, z, wide, tall)
        speed, bent = across**2 + up**2, along[0] * da + along[1] * dz
        rate = np.where(speed + bent > 0.3 * speed, speed + bent, speed)
        new = np.clip(s - (across * da + up * dz) / rate, low, high)
        step, s = np.abs(new - s).max(), new
        if step <= _NEAR * L:
            break
    place, at = _at(curve, s)
    across, up, da, dz, _ = _local(at, place, alpha, z, wide, tall)
    normal = across * dz - up * da
    distance = np.where(normal < 0, -1.0, 1.0) * np.hypot(da, dz)
    inside = (s > 0) & (s < L)
    length = np.hypot(across, up)
    with np.errstate(invalid="ignore", divide="ignore"):  # at an end the nearest place is the end itself
        to_end = np.where(distance == 0, 0.0, da / distance), np.where(distance == 0, 0.0, dz / distance)
    by_alpha = np.where(inside, -up / length, to_end[0]) / wide
    by_z = np.where(inside, across / length, to_end[1]) / tall
    return Feet(at, place, np.where(inside, normal / length, distance), by_alpha, by_z)


def _at(curve: AtStations, s: Array) -> tuple[Array, Solution]:
    """The place of each s among them, and the solution at all of them in their rising order."""
    order = np.argsort(s, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(s.size)
    return place, curve(s[order])


def _local(
    at: Solution, place: Array, alpha: Array, z: Array, wide: Array, tall: Array
) -> tuple[Array, Array, Array, Array, tuple[Array, Array]]:
    """The tangent, the way from the point to the curve, and the rate of the tangent, in units of the sizes."""
    rho, beta, rate = float(at.case.rho), at.beta[place], at.dbeta[place]
    across, up = np.sin(beta) / rho / wide, np.cos(beta) / tall
    turning = np.cos(beta) * rate / rho / wide, -np.sin(beta) * rate / tall
    return across, up, (at.alpha[place] - alpha) / wide, (at.z[place] - z) / tall, turning


def _nearest(curve: AtStations, points: Points) -> tuple[Solution, Array, Array, Array, Array]:
    """For each point the nearest s on the polyline, the whole turns to add to its azimuth, and a bracket of s."""
    count = _COARSE
    while True:
        sol = curve(count)
        if count >= _FINEST or np.abs(np.diff(sol.beta)).max() <= _TURN:
            break
        count = 2 * count - 1
    alpha, z, s = sol.alpha, sol.z, sol.s
    best = np.full(points.size, np.inf)
    where, turns = np.zeros(points.size), np.zeros(points.size)
    for k in _turns(alpha, points):
        a = (alpha[:, None] - points.columns["alpha"] - 2 * np.pi * k) / points.sizes["alpha"]
        h = (z[:, None] - points.columns["z"]) / points.sizes["z"]
        da, dh = np.diff(a, axis=0), np.diff(h, axis=0)
        share = np.clip(-(a[:-1] * da + h[:-1] * dh) / (da**2 + dh**2), 0, 1)
        square = (a[:-1] + share * da) ** 2 + (h[:-1] + share * dh) ** 2
        i = square.argmin(axis=0)
        column = np.arange(points.size)
        closer = square[i, column] < best
        best = np.where(closer, square[i, column], best)
        where, turns = np.where(closer, i + share[i, column], where), np.where(closer, k, turns)
    step = s[1]
    foot = where * step
    return sol, foot, turns, np.maximum(foot - step, 0), np.minimum(foot + step, float(sol.case.rod.L))


def _turns(alpha: Array, points: Points) -> range:
    """The whole turns that may be added to the measured azimuths."""
    if not points.wrapped:
        return range(1)
    given = points.columns["alpha"]
    low, high = (alpha.min() - given.max()) / (2 * np.pi), (alpha.max() - given.min()) / (2 * np.pi)
    return range(int(np.floor(low)), int(np.ceil(high)) + 1)
