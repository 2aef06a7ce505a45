"""Rods beside a wall in units of A and rho, and curves from which their shapes are continued."""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..nodes.loaded_rod import rods_of
from ..numerics.arrays import NEGLIGIBLE, Array
from ..problem.case import Case
from ..problem.declared_fields import TILTS
from ..problem.dimensionless import flat
from .discrete_rod import CONDITIONS, INSIDE, OUTSIDE, DiscreteRod
from .free_shape import FreeShape, between
from .minimum import minimise
from .program import Effort, Sizes
from .quaternions import directors, end_frame

# a step of the ends: rad, of the length. x10: ends go the whole way at once, to minima farther off
TURN, SHORTENED = 0.5, 0.1
SETTLED = 3  # searches at most until hinges on the wall lie along it or do not. x10: as good


@dataclass(frozen=True, eq=False)
class BeginningCurve:
    """The shape of a rod at n shares u of its length, in units of rho, as a guess.

    name: what it is, in words. x: (n, 3). q: frames without the uniform twist, at shares u_q. twist: that twist.
    angles: azimuth, beta, tilt and rotation of both ends, (8,), that of the far end without the twist. grows: whether
    it has no loads yet. lead: of the frames of both ends, over h^2, (2, 3), where it is known. forces: the multipliers
    of the conditions of a rod whose nodes are at u, (M,), where they are known.
    """

    name: str

    u: Array
    x: Array
    u_q: Array
    q: Array
    twist: float
    angles: Array
    grows: bool = False
    lead: Array | float = 0.0
    forces: Array | None = None

    def multipliers(self, edges: int) -> Array | None:
        """The multipliers of the conditions of a rod on so many edges, (M,), as a guess; None where none is known."""
        if self.forces is None:
            return None
        known, new = ((np.arange(n) + 0.5) / n for n in (self.u.size - 1, edges))
        of_edges, wall, far = np.split(self.forces, [CONDITIONS * known.size, -2])
        of_edges = between(new, known, of_edges.reshape(-1, CONDITIONS)) * [1, 1, 1, known.size / edges]
        pushed = np.interp(new, known, np.append(0.0, np.cumsum(wall)))  # up to the middle of each edge
        return np.concatenate([of_edges.ravel(), np.diff(pushed), far])

    def chords(self, edges: int) -> Array:
        """The chords of so many equal parts of this curve, over the lengths of these, (N,)."""
        turned = np.linalg.norm(np.diff(directors(self.q)[:, 2], axis=0), axis=1) / (edges * np.diff(self.u_q))
        places = (self.u_q[1:] + self.u_q[:-1]) / 2
        return np.sinc(np.interp((np.arange(edges) + 0.5) / edges, places, turned) / (2 * np.pi))

    @property
    def total_turn(self) -> float:
        """By how much the frames turn along the rod, in all [rad]."""
        return float(2 * np.arccos(np.clip(np.abs((self.q[1:] * self.q[:-1]).sum(axis=1)), 0, 1)).sum())

    def on(self, rod: DiscreteRod) -> Array:
        """The unknowns of a rod with this shape."""
        from scipy.interpolate import CubicHermiteSpline  # only a search loads SciPy

        y, edge = np.zeros(rod.size), np.arange(1, rod.edges + 1) / rod.edges
        q, x, angles = rod.parts(y)
        q[:] = between(edge - 0.5 / rod.edges, self.u_q, self.q)
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        tangents = directors(between(self.u, self.u_q, self.q))[:, 2]
        x[:] = CubicHermiteSpline(self.u * rod.span, self.x, tangents)(edge * rod.span)
        angles[:] = self.angles
        return y


class Beside(NamedTuple):
    """A rod beside its wall.

    rod: on one edge, with the twist of a given twisting moment. rotation: of the far end from the start, None where it
    is free. turns: whether nothing holds the azimuth of a far end on the axis. time: the shortest length on which its
    shape changes. changes: how many such lengths it has. effort: of the search for its shape.
    """

    rod: DiscreteRod
    rotation: float | None
    turns: bool
    time: float
    changes: float
    effort: Effort

    def sizes(self, curve: BeginningCurve) -> Sizes:
        """The sizes of a shape like that of a curve."""
        steep = np.hypot(*directors(curve.q)[:, 2, :2].T).max()
        turned = min(1.0, max(1 / self.time, steep))
        across = min(1.0, self.time)
        return Sizes(across, turned * across, turned, turned**2 / self.time)

    def rod_on(self, curve: BeginningCurve, share: float, edges: int) -> DiscreteRod:
        """The rod whose ends are this share of the way from those of a curve to its own."""
        rod, ends = self.rod, curve.angles
        twist = rod.twist
        if self.rotation is not None:
            twist = (1 - share) * curve.twist + share * (ends[3] + self.rotation - ends[7]) / rod.span
        goal = rod.angles.copy()
        goal[7] = ends[7]
        if self.turns and self.rotation is None:
            goal[4] = ends[4]
        flip = np.sign(end_frame(ends[4:])[0] @ curve.q[-1])
        radius, loads = np.hypot(*curve.x[[0, -1], :2].T), share if curve.grows else 1.0
        height = None if rod.height is None else (1 - share) * curve.x[-1, 2] + share * rod.height
        return replace(
            rod,
            edges=edges,
            twist=twist * (loads if self.rotation is None else 1.0),
            flip=float(flip),
            height=height,
            angles=np.where(rod.free, ends, (1 - share) * ends + share * goal),
            loads=loads * rod.loads,
            radius=(1 - share) * radius + share * rod.radius,
            tension=loads * rod.tension,
            weight=loads * rod.weight,
            lead=np.broadcast_to(curve.lead * (rod.span / edges) ** 2, (2, 3)),
            chords=curve.chords(edges),
        )

    def minimum(
        self, curve: BeginningCurve, share: float, edges: int, near: FreeShape | None = None
    ) -> FreeShape | None:
        """The minimum near a shape, or near a curve, of the rod whose ends are this share of the way from the curve.

        A hinge on the wall that its moment presses into the wall lies along it: the wall takes the rest of that.
        """
        rod = self.rod_on(curve, share, edges)
        y, multipliers = (curve.on(rod), curve.multipliers(edges)) if near is None else (near.y, near.multipliers)
        along = rod.may_tilt & (np.abs(np.sin(rod.parts(y)[2])) < NEGLIGIBLE)
        shape = None
        for _ in range(SETTLED):
            angles = np.where(along, np.pi * np.round(rod.parts(y)[2] / np.pi), rod.angles)
            held = replace(rod, free=rod.free & ~along, angles=angles)
            shape = minimise(held, y, self.sizes(curve), multipliers, self.effort)
            held_along, along = along, along & False
            if shape is not None:
                y, multipliers, along = shape.y, shape.multipliers, shape.tilts_into_wall(rod.may_tilt)
            if (along == held_along).all():
                break
        return shape

    def way(self, curve: BeginningCurve) -> float:
        """How far the ends of a curve are from where those of the rod are held: 1 is a step of moderate size."""

        def ends(share: float) -> Array:
            rod = self.rod_on(curve, share, 1)
            up = 0.0 if rod.height is None else rod.height / (SHORTENED * rod.span)
            return np.hstack([rod.angles / TURN, rod.radius, rod.twist * rod.span / TURN, up])

        return float(np.abs(ends(1.0) - ends(0.0)).max())


def problems_of(case: Case) -> list[Beside]:
    """The rods of a case, one by one."""
    given = case.given

    def column(value: Any) -> Array:
        return flat(0.0 if value is None else value, case.shape)

    radii = np.stack([column(radius / case.rho) for radius in case.end_radii], axis=1)
    stiff = case.rod.bending_stiffness
    gamma0, ratio, unit = (column(value) for value in (given.gamma, 1 / case.rod.stiffness_ratio, stiff / case.rho))
    pairs = ((getattr(given, tilt), getattr(given, M2)) for tilt, M2 in TILTS)
    leans = [(M2 is None, column(tilt), column(M2) / unit) for tilt, M2 in pairs]
    problems = []
    for i, loaded in enumerate(rods_of(case)):
        held, (near, alpha0), (far, turned, axial, twisted) = loaded.held, loaded.near, loaded.far
        around, rotated, upright = (name in held for name in ("azimuth", "rotation", "height"))
        ends = [  # whether it is held, its value then, and the load that does work with it otherwise
            (True, alpha0, 0.0),
            ("beta0" in held, near, -near),
            (leans[0][0], leans[0][1][i], leans[0][2][i]),
            (True, gamma0[i], 0.0),
            (around or radii[i, 1] == 0, alpha0 + around * turned, turned),
            ("betaL" in held, far, far),
            (leans[1][0], leans[1][1][i], -leans[1][2][i]),
            (rotated, 0.0, twisted),
        ]
        known, angles, loads = np.array(ends).T
        free = known == 0
        rod = DiscreteRod(
            1, loaded.span, float(ratio[i]), 0.0 if rotated else float(twisted / ratio[i]),
            OUTSIDE if case.outward > 0 else INSIDE, np.array([loaded.across, 0.0, -loaded.along]),
            angles, free, 1.0, radii[i], float(axial) if upright else None,
            np.where(free, loads, 0.0), 0.0 if upright else float(axial), np.zeros((2, 3)),
        )  # fmt: skip
        changes = float(loaded.changes()[1][-1])
        turns = not around and not free[4]
        problems.append(Beside(rod, float(twisted) if rotated else None, turns, loaded.time, changes, Effort()))
    return problems
