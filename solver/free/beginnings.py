"""Where shapes beside a wall that only pushes are continued from: known rods, or a straight one."""

from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from ..nodes.loaded_rod import numbers_of, rate_of_change
from ..numerics.arrays import Array
from ..orbits.shape import ShapeArrays
from ..problem.case import OFF_WALL, REACHED, Case, Ends
from ..problem.reduced import flat
from .discrete_rod import DiscreteRod
from .free_problem import Curve
from .free_shape import FreeShape
from .quaternions import directors, end_frame

EACH, FEWEST, MOST = 16, 401, 20_001  # stations of a known rod: for each length on which its shape changes
ENDS = np.array([0.0, 1.0])
WIDEST = 2.405  # of a bow whose ends are at one height: just beyond the first zero of J0
BILATERAL = "the bilateral shape"


def bilateral_cases(case: Case) -> list[Case]:
    """The rods of a case on a cylinder that holds them on, their ends on its wall.

    A far end on the axis has no azimuth of its own: there the bilateral one may be free or held at that of the start.
    """
    given = {field.name: getattr(case.given, field.name) for field in fields(Ends) if field.name not in OFF_WALL}
    wall = replace(case.cylinder, contact="bilateral")
    ends = [given]
    if given["azimuth"] is None and not np.any(case.end_radii[1]):
        ends.append({**given, "MZ": None, "azimuth": 0.0})
    return [Case(case.rod, wall, Ends(**each)) for each in ends]


def held_case(sol: ShapeArrays, curves: Sequence[Curve | None]) -> Case:
    """The rods of a solution, with these curves, beside a cylinder that only pushes: both ends are held as they are.

    A rod without a curve stands for none: its ends are those of a straight rod. Rods that are straight keep their axial
    force in place of their height, which leaves a rod of that length no other shape and its force open.
    """
    case, ends = sol.case, np.zeros((len(curves), 8))
    ends[:, 0] = flat(sol.problem.span, (len(curves),))
    for row, curve, span in zip(ends, curves, sol.problem.span, strict=True):
        if curve is not None:
            first, last = curve.angles[:4], curve.angles[4:]
            turned = last[3] - first[3] + curve.twist * span
            row[:] = curve.x[-1, 2], first[1], last[1], last[0] - first[0], turned, first[2], last[2], 0.0
    height, beta0, betaL, azimuth, rotation, tilt0, tiltL = (
        column.reshape(case.shape)[()] for column in ends.T[:7]
    )  # fmt: skip
    rest: dict[str, Any] = {"height": height * case.rho}
    if np.all(rest["height"] >= (1 - REACHED) * case.rod.L):
        rest = {"FZ": sol.FZ}
    if case.leaves:
        rest |= dict(zip(OFF_WALL[:2], case.end_radii, strict=True)) | {"tilt0": tilt0, "tiltL": tiltL}
    held = Ends(
        beta0=beta0, betaL=betaL, azimuth=azimuth, rotation=rotation,
        alpha=case.given.alpha, gamma=case.given.gamma, **rest,
    )  # fmt: skip
    return Case(case.rod, replace(case.cylinder, contact="unilateral"), held)


def straight_curve(rod: DiscreteRod) -> Curve:
    """A straight rod along the axis from where the start is, without loads.

    Where its ends only have to come nearer to each other along it, which no small change of a straight rod allows, a
    rod that is bowed round the axis, beta = size sin(2 pi s/L), to that height: the mean of cos(beta) is J0(size).
    """
    from scipy.integrate import cumulative_simpson  # only a search loads SciPy
    from scipy.optimize import brentq
    from scipy.special import j0

    angles = np.tile([rod.angles[0], 0.0, 0.0, rod.angles[3]], 2)
    bound = np.where(rod.free, angles, rod.angles)
    short = rod.height is not None and rod.height < rod.span * (1 - REACHED)
    if not (short and np.array_equal(bound, angles) and rod.radius[0] == rod.radius[1]):
        place = rod.place(0, angles[0])
        x = np.array([[*place, 0.0], [*place, rod.span]])
        return Curve("the straight rod", ENDS, x, ENDS, end_frame(angles.reshape(2, 4).T)[0], 0.0, angles, True)
    size = brentq(lambda bow: j0(bow) - max(float(rod.height or 0.0) / rod.span, 0.0), 0.0, WIDEST)
    u = np.linspace(0, 1, FEWEST)
    turned = np.tile(angles[:4, None], u.size)
    turned[1] = size * np.sin(2 * np.pi * u)
    q = end_frame(turned)[0]
    along = cumulative_simpson(directors(q)[:, 2], x=rod.span * u, axis=0, initial=0.0)
    return Curve("a bowed rod", u, along + np.append(rod.place(0, angles[0]), 0.0), u, q, 0.0, angles, True)


def curve_of(shape: FreeShape, name: str = "the seed") -> Curve:
    """The curve of a rod beside its wall."""
    N, rod = shape.rod.edges, shape.rod
    middles = np.concatenate([[0.0], (np.arange(N) + 0.5) / N, [1.0]])
    return Curve(name, np.arange(N + 1) / N, shape.x, middles, rod.chain(shape.y), rod.twist, shape.angles)


def curves_of(sol: ShapeArrays, name: str) -> list[Curve | None]:
    """The curve of each rod of a solution; None where it is not solved."""
    solved = sol.trajectory.solved.tolist()
    if sol.trajectory.free is not None:
        answers = zip(sol.trajectory.free.answers, solved, strict=True)
        return [curve_of(answer.shapes[-1], name) if known else None for answer, known in answers]
    twist = flat(sol.loads[2] / sol.case.rod.torsional_stiffness * sol.case.rho, sol.case.shape)
    alpha0, gamma0 = (flat(value, sol.case.shape) for value in (sol.case.given.alpha, sol.case.given.gamma))
    curves: list[Curve | None] = []
    for i, (known, (beta, alpha, z, swirl, u)) in enumerate(zip(solved, _along(sol), strict=True)):
        turned = np.stack([alpha0[i] + alpha, beta, np.zeros(u.size), gamma0[i] - swirl])
        x = np.column_stack([np.cos(turned[0]), np.sin(turned[0]), z])
        angles = turned[:, [0, -1]].T.ravel()
        curves.append(Curve(name, u, x, u, end_frame(turned)[0], float(twist[i]), angles) if known else None)
    return curves


def _along(sol: ShapeArrays) -> Iterable[tuple[Array, ...]]:
    """beta, alpha and z/rho from the start, the swirl, and s/L, along each rod of a solution on the wall.

    At stations that are dense enough for its loads, where the shape is known there; else at those of the solution.
    """
    known, problem, numbers = sol.trajectory, sol.problem, numbers_of(sol.case)
    if known.orbit is None and known.shapes is None:
        return zip(known.beta, known.alpha, known.z, known.swirl(), sol.t / problem.span[:, None], strict=True)
    with np.errstate(all="ignore"):
        phi = np.abs(problem.phi) + np.abs(numbers[:, 1]) * problem.span
        rate = rate_of_change(phi, numbers[:, 1], numbers[:, 2], problem.mu, problem.lam - problem.mu, problem.span)
        changes = np.nanmax(np.where(known.solved, rate * problem.span, 0.0))
    u = np.linspace(0, 1, int(np.clip(EACH * changes, FEWEST, MOST)))
    t = problem.span[:, None] * u
    if known.orbit is None:
        read = known.shapes.read(t, flat(sol.case.given.alpha, sol.case.shape))
        beta, alpha, z, swirl = read["beta"], read["alpha"], read["z"], read["swirl"]()
    else:
        (beta, _, alpha, z), swirl = known.orbit.at(t), known.orbit.swirl(t)
    return zip(beta, alpha, z, swirl, [u] * t.shape[0], strict=True)
