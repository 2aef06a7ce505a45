"""Self-intersection: where the centreline comes closer to itself than two radii.

Points pi a apart or less along the rod are close because they are neighbours: an arc no tighter than the rod itself
(radius a) keeps its ends two radii apart from there on. By Schur's theorem points less than
2/kappa (pi - asin(kappa a)) apart along the rod, kappa being the largest curvature, cannot meet, so only points farther
apart are compared. Bounds on beta decide many rods; for the others stretches of the curve are halved where they might
meet (core/strand_pairs.c). All lengths are in units of rho.
"""

from typing import Any

import numpy as np
import scipy

from ..core.library import fine, run, share_out, structure, widest
from ..core.measures import crossings
from ..numerics.arrays import Array
from ..orbits.loop_orbits import MOST_PLACES
from ..orbits.marched_orbit import MarchedOrbit
from ..orbits.periodic_orbit import as_core_orbits
from ..orbits.shape_arrays import ShapeArrays
from ..problem.dimensionless import flat
from .solution_pieces import CASES

# largest number of pairs of stretches compared for a rod; periods compared together, which changes no result. x10: ten
# times the time before it is not checked
PAIRS, TOGETHER = 300_000, 8
_PERIODS = 10_000_000  # largest number of periods compared with the first. x10: ten times the time of such rods
# of the radius: distance of stations, and of points between them. x10: chords of five radii pass each other
_COARSE, _DENSE = 0.5, 0.125
_ComparedRods = structure("rods", "strand_pairs.c")


def overlaps(sol: ShapeArrays, kappa_max: Any, low: Any, high: Any, **limits: int) -> Any:
    """Whether each rod would intersect itself.

    It does where two points farther apart along the rod than pi a come closer in space than 2 a, or where kappa a is 1
    or more. Rods that keep their direction along the axis, or about it for less than a turn, are decided by the bounds
    of curvature and angle. For the others points of the orbit are compared, as dense as the rod is thick; where the
    method knows no orbit, those of the stations.

    Parameters
    ----------
    sol : Shape
        The rods.
    kappa_max : array (*cases)
        Largest curvature [1/length].
    low, high : array (*cases)
        Smallest and largest beta [rad].
    **limits
        most_pairs, together: in place of `PAIRS` and `TOGETHER`; the second does not change the result.

    Returns
    -------
    array (*cases)
        1 where it would, else 0; NaN where a case is not solved or not decided: its stations are farther apart than
        a/2, or more pairs of stretches would have to be compared than allowed.
    """
    case, orbit = sol.case, sol.trajectory.orbit
    rho = flat(case.rho, case.shape)
    a = flat(case.rod.a, case.shape) / rho
    tightest = flat(kappa_max, case.shape) * rho
    verdict = np.full(case.size, np.nan)
    known = np.reshape(sol.solved, -1) & np.isfinite(tightest)
    thick = a * tightest >= 1
    apart = _apart(a, tightest)
    with np.errstate(invalid="ignore", divide="ignore"):
        range_ = flat(low, case.shape), flat(high, case.shape)
        free = (sol.problem.span <= apart) | _climbs(*range_, a, apart)
        free |= _goes_round_once(*range_, a, apart, sol.problem.span)
    verdict[known & thick], verdict[known & ~thick & free] = 1, 0
    left = np.flatnonzero(known & ~thick & ~free)
    for rows in (left[k : k + CASES] for k in range(0, left.size, CASES)):
        if orbit is None:
            verdict[rows] = [_at_stations(sol, int(i), a[i]) for i in rows]
        else:
            verdict[rows] = compare_strands(orbit.take(rows), sol.problem.span[rows], a[rows], tightest[rows], **limits)
    whole = verdict if np.isnan(verdict).any() else verdict.astype(np.int64)
    return whole.reshape(case.shape)[()]


def _apart(a: Array, tightest: Array) -> Any:
    """The smallest distance along the rod of two points that meet, (B,)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(tightest > 0, 2 / tightest * (np.pi - np.arcsin(np.minimum(a * tightest, 1))), np.inf)


def compare_strands(
    orbit: Any, length: Array, a: Array, tightest: Array, most_pairs: int = PAIRS, together: int = TOGETHER
) -> Array:
    """Whether each rod meets itself, (B,): 1 or 0, NaN where more than `most_pairs` pairs would have to be compared.

    Never 0 for a rod of which a shorter one gives 1: the points compared do not depend on the length.

    length, a, tightest: (B,), of the rod, its radius and its largest curvature, in units of rho.
    """
    if isinstance(orbit, MarchedOrbit) and orbit.lost.any():
        verdict = np.empty(length.size)
        for part, of in ((~orbit.lost, orbit.take(np.flatnonzero(~orbit.lost))), (orbit.lost, orbit.rest)):
            verdict[part] = compare_strands(of, length[part], a[part], tightest[part], most_pairs, together)
        return verdict
    with np.errstate(divide="ignore"):  # a helix repeats after any length
        period = np.where(np.isfinite(orbit.period), orbit.period, 1 / tightest)
    arrays: dict[str, Any] = {"period": period, "length": length, "a": a, "apart": _apart(a, tightest)}
    if isinstance(orbit, MarchedOrbit):
        arrays |= {"steps": orbit.steps.as_room(), "orbits": orbit.found}
    else:
        arrays["panels"] = as_core_orbits(orbit)
    periods = np.minimum(length // period, _PERIODS).astype(np.int64)
    limits = {"rounds": _PERIODS, "most_pairs": most_pairs, "together": together, "lanes": widest()}
    rods, answers = _ComparedRods(**arrays, **limits, periods=periods), np.empty(periods.size)
    share_out(lambda a, b: fine(run("rod_meets", rods, answers, a, b)), periods.size)
    return answers


def _climbs(low: Array, high: Array, a: Array, apart: Array) -> Any:
    """Whether the rod keeps its direction along the axis, and gains two radii there on each stretch that could meet."""
    axis = np.round((low + high) / (2 * np.pi))
    ahead = np.maximum(np.abs(low - np.pi * axis), np.abs(high - np.pi * axis))
    return (ahead < np.pi / 2) & (np.cos(ahead) * apart > 2 * a)


def _goes_round_once(low: Array, high: Array, a: Array, apart: Array, span: Array) -> Any:
    """Whether the rod keeps its direction about the axis, for less than a turn, and gains two radii likewise."""
    aside = np.floor((low + high) / (2 * np.pi)) + 0.5
    off = np.maximum(np.abs(low - np.pi * aside), np.abs(high - np.pi * aside))
    thick = 2 * np.arcsin(np.minimum(a, 1))
    return (off < np.pi / 2) & (np.cos(off) * apart > thick) & (span < 2 * np.pi - thick) & (a < 1)


def _at_stations(sol: ShapeArrays, i: int, a: float) -> float:
    """The least distance of case i from itself, from its stations alone."""
    t, shape = sol.t[i], sol.trajectory
    alpha, z, beta = shape.alpha[i], shape.z[i], shape.beta[i]
    points = np.stack([np.cos(alpha), np.sin(alpha), z], axis=-1)
    dense = np.diff(t).max() <= _COARSE * a
    if dense:
        s, c = np.sin(beta), np.cos(beta)
        tangent = np.stack([-s * np.sin(alpha), s * np.cos(alpha), c], axis=-1)
        kept = np.append(True, np.diff(t) > 0)
        count = int(min((t[-1] - t[0]) / (_DENSE * a), MOST_PLACES)) + 2
        even = np.linspace(t[0], t[-1], count)
        t, points = even, scipy.interpolate.CubicHermiteSpline(t[kept], points[kept], tangent[kept])(even)
    if t.size > MOST_PLACES:
        return np.nan
    met = len(crossings(t, points, 2 * a, np.pi * a)) > 0
    whole = t[0] == 0 and t[-1] >= sol.problem.span[i] * (1 - 1e-12)
    return 1.0 if met else 0.0 if dense and whole else np.nan
