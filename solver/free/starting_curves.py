"""Where shapes beside a wall that only pushes are continued from: known rods, or a straight one."""

from collections.abc import Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..nodes.loaded_rod import numbers_of, rate_of_change
from ..numerics.arrays import NEGLIGIBLE, Array, whole_turns
from ..orbits.frames import outward, tangent
from ..orbits.shape_arrays import ShapeArrays
from ..problem.case import Case, Ends
from ..problem.declared_fields import OFF_WALL
from ..problem.dimensionless import flat
from .discrete_rod import OUTSIDE, DiscreteRod
from .free_problem import BeginningCurve, problems_of
from .free_shape import FreeShape, angles_at
from .quaternions import directors, end_frame, product

# stations of a known rod: for each length on which its shape changes; at least, at most. x10: only time; at least x10
# starts are other ones by their digits
EACH, FEWEST, MOST = 16, 401, 20_001
WIDEST = 2.405  # of a bow whose ends are at one height: just beyond the first zero of J0. x10: J0 has other zeros there
BILATERAL = "the bilateral shape"


def bilateral_cases(case: Case) -> list[Case]:
    """The rods of a case on a cylinder that holds them on, their ends on its wall, of the shape of the case.

    A far end on the axis has no azimuth of its own: there the bilateral one may be free or held at that of the start.
    """
    given = {field.name: getattr(case.given, field.name) for field in fields(Ends) if field.name not in OFF_WALL}
    wall = replace(case.cylinder, contact="bilateral")
    rod = replace(case.rod, L=np.broadcast_to(case.rod.L, case.shape)[()])  # also where ends off the wall alone differ
    ends = [given]
    if given["azimuth"] is None and not np.any(case.end_radii[1]):
        ends.append({**given, "MZ": None, "azimuth": 0.0})
    return [Case(rod, wall, Ends(**each)) for each in ends]


def let_go(sol: ShapeArrays, curves: Sequence[BeginningCurve | None]) -> tuple[Case, list[BeginningCurve | None]]:
    """The rods of a solution, with these curves, beside a cylinder that only pushes: both ends are held as they are.

    A rod without a curve stands for none: its ends are those of a straight rod. Rods that are all as long as a string
    between their ends keep their axial force in place of their height, which leaves such a rod no other shape and its
    force open; their curves say so.
    """
    case, ends = sol.case, np.zeros((len(curves), 7))
    ends[:, 0] = flat(sol.problem.span, (len(curves),))
    for row, curve, span in zip(ends, curves, sol.problem.span, strict=True):
        if curve is not None:
            first, last = curve.angles[:4], curve.angles[4:]
            turned = last[3] - first[3] + curve.twist * span
            row[:] = curve.x[-1, 2], first[1], last[1], last[0] - first[0], turned, first[2], last[2]
    height, beta0, betaL, azimuth, rotation, tilt0, tiltL = (column.reshape(case.shape)[()] for column in ends.T)
    rest: dict[str, Any] = {"alpha": case.given.alpha, "gamma": case.given.gamma}
    if case.leaves:
        rest |= dict(zip(OFF_WALL[:2], case.end_radii, strict=True)) | {"tilt0": tilt0, "tiltL": tiltL}
    held = partial(Ends, beta0=beta0, betaL=betaL, azimuth=azimuth, rotation=rotation, **rest)
    wall = replace(case.cylinder, contact="unilateral")
    free = Case(case.rod, wall, held(height=height * case.rho))
    if not all(is_taut(beside.rod) for beside in problems_of(free)):
        return free, list(curves)
    why = "whose axial force is kept: held ends, the rod's length apart along the wall, leave it open"
    kept = [curve and replace(curve, name=f"{curve.name}, {why}") for curve in curves]
    return Case(case.rod, wall, held(FZ=sol.FZ)), kept


class _StartSheet(NamedTuple):
    """A sheet along the axis, in which a string lies: a plane, or two that the cylinder joins, on which it bends.

    alpha: at whose normal the first plane stands. off: how far that is from the axis. sense: of the string round the
    axis. before, around, length: across the axis, up to the cylinder, on it, and in all.
    """

    alpha: float
    off: float
    sense: float
    before: float
    around: float
    length: float

    def at(self, p: Array) -> tuple[Array, Array]:
        """Places (n, 3) at z = 0, and the azimuths of the normals there, at distances p (n,) from the start."""
        around = np.clip(p - self.before, 0, self.around)
        alpha = self.alpha + self.sense * around
        ahead = self.sense * (p - self.before - around)
        return self.off * outward(alpha) + ahead[:, None] * tangent(alpha, np.full(p.size, np.pi / 2)), alpha


def sheet_between(rod: DiscreteRod) -> _StartSheet:
    """The sheet between the ends of a rod; one whose azimuth is free is at that of the start."""
    alpha = rod.angles[[0, 4]]
    first, last = (rod.place(end, alpha[end]) for end in (0, 1))
    if rod.side == OUTSIDE:
        leaving = np.arccos(np.minimum(1 / rod.radius, 1))
        if (around := float(np.abs(np.diff(alpha)).sum() - leaving.sum())) > 0:
            legs, sense = np.sqrt(np.maximum(rod.radius**2 - 1, 0)), float(np.sign(alpha[1] - alpha[0]))
            return _StartSheet(alpha[0] + sense * leaving[0], 1.0, sense, legs[0], around, legs.sum() + around)
    x, y = last - first
    length = float(np.hypot(x, y))
    normal = np.arctan2(-x, y) if length > NEGLIGIBLE else alpha[0]
    c, s = np.cos(normal), np.sin(normal)
    return _StartSheet(normal, float(first @ [c, s]), 1.0, float(first @ [s, -c]), 0.0, length)


def taut_string(rod: DiscreteRod) -> tuple[_StartSheet, float, float]:
    """A string that is drawn from end to end: its sheet, its height, and its length over that of the rod."""
    sheet = sheet_between(rod)
    up = np.sqrt(max(rod.span**2 - sheet.length**2, 0.0)) if rod.height is None else rod.height
    return sheet, up, float(np.hypot(sheet.length, up) / rod.span)


def is_taut(rod: DiscreteRod) -> bool:
    """Whether a rod of held height is as long as a string between its ends, which leaves its tension open."""
    return rod.height is not None and abs(taut_string(rod)[2] - 1) <= NEGLIGIBLE


def curve_of_string(rod: DiscreteRod) -> BeginningCurve | str:
    """A rod along a string that is drawn from end to end, round the cylinder where that is in its way, without loads.

    A longer rod is bowed in the sheet that stands on the string along the axis: its angle to the axis swings by
    size sin(2 pi s/L), which shortens it by J0(size). A text says that the rod is too short.
    """
    from scipy.integrate import cumulative_simpson  # only a search loads SciPy
    from scipy.optimize import brentq
    from scipy.special import j0

    sheet, up, taut = taut_string(rod)
    if taut > 1 + NEGLIGIBLE:
        return f"a string from end to end is {taut:.6g} times as long as the rod"
    size = brentq(lambda bow: j0(bow) - taut, 0.0, WIDEST) if taut < 1 - NEGLIGIBLE else 0.0
    u = np.linspace(0, 1, FEWEST)
    lean = np.arctan2(sheet.length, up) + size * np.sin(2 * np.pi * u)
    p, z = (cumulative_simpson(part(lean), x=rod.span * u, initial=0.0) for part in (np.sin, np.cos))
    x, alpha = sheet.at(p)
    turned = np.stack([alpha, sheet.sense * lean, np.zeros(u.size), np.zeros(u.size)])
    turned[3, 1:] = -np.cumsum(np.diff(alpha) * np.cos((lean[1:] + lean[:-1]) / 2))  # no twist
    q, near, held = end_frame(turned)[0], turned[3, [0, -1]], ~rod.free[[1, 5]]
    ends = angles_at(rod.angles[[0, 4]], directors(q[[0, -1]]))
    ends[1, held] += whole_turns(rod.angles[[1, 5]] - ends[1])[held]
    ends[3] -= whole_turns(ends[3] - near)
    turned[3] += rod.angles[3] - ends[3, 0]
    ends[3] += rod.angles[3] - ends[3, 0]
    q = end_frame(turned)[0]
    q *= np.sign(end_frame(ends[:, 0])[0] @ q[0])
    name = "a bowed rod" if size else "the straight rod"
    name += " round the cylinder" * (sheet.around > 0)
    loaded = bool(np.any(rod.loads) or np.any(rod.weight) or rod.tension or rod.twist)
    return BeginningCurve(name, u, x + np.outer(z, [0, 0, 1.0]), u, q, 0.0, ends.T.ravel(), loaded)


def curve_of(shape: FreeShape, name: str = "the seed") -> BeginningCurve:
    """The curve of a rod beside its wall; whole turns of its frames about the tangent become uniform twist."""
    N, rod = shape.rod.edges, shape.rod
    middles = shape.middles / rod.span
    turned = float(whole_turns(2 * rod.joints(shape.y).v[:, 2].sum()))
    back, angles = np.zeros((N + 2, 4)), shape.angles.copy()
    back[:, 0], back[:, 3] = np.cos(turned * middles / 2), -np.sin(turned * middles / 2)
    angles[7] -= turned
    q, twist = product(rod.chain(shape.y), back), rod.twist + turned / rod.span
    u, known = np.arange(N + 1) / N, shape.multipliers
    return BeginningCurve(name, u, shape.x, middles, q, twist, angles, lead=shape.lead, forces=known)


def curves_of(sol: ShapeArrays, name: str) -> list[BeginningCurve | None]:
    """The curve of each rod of a solution, whatever the others are; None where it is not solved."""
    if sol.case.shape:  # a rod has as many places as it needs, not as the hardest of them does
        return [curve for index in np.ndindex(sol.case.shape) for curve in curves_of(sol[index], name)]
    solved = sol.trajectory.solved.tolist()
    if sol.trajectory.free is not None:
        answers = zip(sol.trajectory.free.answers, solved, strict=True)
        return [curve_of(answer.shapes[-1], name) if known else None for answer, known in answers]
    problem, trajectory, shape = sol.problem, sol.trajectory, sol.case.shape
    twist = flat(sol.loads[2] / sol.case.rod.torsional_stiffness * sol.case.rho, shape)
    alpha0, gamma0 = (flat(value, shape) for value in (sol.case.given.alpha, sol.case.given.gamma))
    with np.errstate(all="ignore"):
        numbers, span = numbers_of(sol.case).T, problem.span
        phi, lam = np.abs(problem.phi) + np.abs(numbers[1]) * span, problem.lam - problem.mu
        changes = np.where(solved, rate_of_change(phi, numbers[1], numbers[2], problem.mu, lam, span) * span, 0.0)
    t = span[:, None] * np.linspace(0, 1, int(np.clip(EACH * np.nanmax(changes), FEWEST, MOST)))
    if trajectory.orbit is not None:
        (beta, _, alpha, z), swirl = trajectory.orbit.at(t), trajectory.orbit.swirl(t)
    elif trajectory.shapes is not None:
        read = trajectory.shapes.read(t, alpha0)
        beta, alpha, z, swirl = read["beta"], read["alpha"], read["z"], read["swirl"]()
    else:
        t, beta, alpha, z, swirl = sol.t, trajectory.beta, trajectory.alpha, trajectory.z, trajectory.swirl()
    curves: list[BeginningCurve | None] = [None] * len(solved)
    for i in np.flatnonzero(solved):
        turned = np.stack([alpha0[i] + alpha[i], beta[i], 0 * beta[i], gamma0[i] - swirl[i]])
        x, u = np.column_stack([np.cos(turned[0]), np.sin(turned[0]), z[i]]), t[i] / span[i]
        angles = turned[:, [0, -1]].T.ravel()
        curves[i] = BeginningCurve(name, u, x, u, end_frame(turned)[0], float(twist[i]), angles)
    return curves
