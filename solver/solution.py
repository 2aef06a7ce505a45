"""The answer: beta and the developed curve at the stations; everything else when it is first read."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from .mechanics import frames, statics
from .mechanics.contact import contact_force, push_from
from .mechanics.potential import Loads, dimensional_slope, potential
from .numerics.arrays import Array
from .problem.case import Case
from .problem.reduced import Reduced, flat
from .problem.trajectory import Trajectory

_quiet = np.errstate(all="ignore")  # cases that were refused carry numbers that no float holds


@dataclass(frozen=True, eq=False)
class Solution:
    """The shapes of a case (or a grid of cases) at n stations, in the case's own units.

    Arrays along the rod are (*cases, n), those of a case (*cases). Only s, beta, dbeta, alpha and z are stored; the
    rest is computed when first read and kept.
    """

    case: Case
    problem: Reduced = field(repr=False)
    trajectory: Trajectory = field(repr=False)
    t: Array = field(repr=False)
    method: str = "orbit"
    tol: float = 1e-8

    def _along(self, values: Array) -> Array:
        return values.reshape(*self.case.shape, values.shape[-1])

    def _each(self, values: Any) -> Any:
        shaped = np.asarray(values).reshape(self.case.shape)
        return shaped if self.case.shape else shaped[()]

    def _column(self, value: Any) -> Array:
        """A field of the case against the stations, (*cases, 1)."""
        return flat(value, self.case.shape).reshape(*self.case.shape, 1)

    @cached_property
    @_quiet
    def _loads(self) -> tuple[Array, Array, Array, Array]:
        """A, l, m, p as columns."""
        A = self._column(self.case.rod.bending_stiffness)
        FZ, MZ, M3 = (self._column(load) for load in self.case.loads)
        return A, MZ / A, M3 / A, FZ / A

    @cached_property
    @_quiet
    def _rho(self) -> Array:
        return self._column(self.case.rho)

    # along the rod

    @cached_property
    @_quiet
    def s(self) -> Array:
        """Arc length, (*cases, n) [length]."""
        return self._along(self.t) * self._rho

    @cached_property
    @_quiet
    def beta(self) -> Array:
        """Angle from the axis to the tangent, (*cases, n) [rad]."""
        return self._along(self.trajectory.beta)

    @cached_property
    @_quiet
    def dbeta(self) -> Array:
        """d beta/ds, (*cases, n) [rad/length]."""
        return self._along(self.trajectory.dbeta) / self._rho

    @cached_property
    @_quiet
    def alpha(self) -> Array:
        """Azimuth, (*cases, n) [rad]; eq. (37)."""
        return self._column(self.case.given.alpha) + self._along(self.trajectory.alpha)

    @cached_property
    @_quiet
    def z(self) -> Array:
        """Height along the axis from the start, (*cases, n) [length]; eq. (37)."""
        return self._along(self.trajectory.z) * self._rho

    @cached_property
    @_quiet
    def gamma(self) -> Array:
        """Rotation of the section against N, B, T, (*cases, n) [rad]; eq. (24), row 6."""
        twist = self._column(self.case.loads[2] / self.case.rod.torsional_stiffness)
        return self._column(self.case.given.gamma) + twist * self.s - self._along(self.trajectory.swirl())

    @cached_property
    @_quiet
    def position(self) -> Array:
        """Centreline, (*cases, n, 3) [length]; the axis of the cylinder is z."""
        return frames.position(self._rho, self.alpha, self.z)

    @cached_property
    @_quiet
    def tangent(self) -> Array:
        """Unit tangent, (*cases, n, 3); eq. (3)."""
        return frames.tangent(self.alpha, self.beta)

    @cached_property
    @_quiet
    def normal(self) -> Array:
        """Unit inward normal of the cylinder, (*cases, n, 3); the paper's N."""
        return -frames.outward(self.alpha)

    @cached_property
    @_quiet
    def material_frame(self) -> Array:
        """The section's frame d1, d2, d3 as rows, (*cases, n, 3, 3); eq. (13)."""
        return frames.material(self.alpha, self.beta, self.gamma)

    @cached_property
    @_quiet
    def kappa(self) -> Array:
        """Curvature, (*cases, n) [1/length]."""
        return statics.curvature(self._rho, self.beta, self.dbeta)

    @cached_property
    @_quiet
    def FY(self) -> Array:
        """Circumferential force, (*cases, n) [force]; eq. (30)."""
        A, l, m, _ = self._loads
        return statics.circumferential_force(A, l, m, self._rho, self.beta)

    @cached_property
    @_quiet
    def F1(self) -> Array:
        """Internal force along the inward normal, (*cases, n) [force]; eq. (33), corrected."""
        A, _, m, _ = self._loads
        return statics.normal_force(A, m, self._rho, self.beta, self.dbeta)

    @cached_property
    @_quiet
    def _surface_forces(self) -> tuple[Array, Array]:
        return statics.surface_forces(self.FY, self._column(self.FZ), self.beta)

    @property
    @_quiet
    def F2(self) -> Array:
        """Internal force in the surface, across the rod, (*cases, n) [force]; eq. (31)."""
        return self._surface_forces[0]

    @property
    @_quiet
    def F3(self) -> Array:
        """Internal force along the tangent, tension positive, (*cases, n) [force]; eq. (31)."""
        return self._surface_forces[1]

    @cached_property
    @_quiet
    def contact(self) -> Array:
        """The cylinder's push per length, (*cases, n) [force/length], positive outward; eq. (34), corrected."""
        A, l, m, p = self._loads
        H = dimensional_slope(l, m, p, self._rho, self.beta)
        return contact_force(A, m, self._rho, self.FY, H, self.beta, self.dbeta)

    @property
    @_quiet
    def push(self) -> Array:
        """Contact counted positive where the cylinder pushes, negative where it lifts off, (*cases, n)."""
        return push_from(self.contact, self.case.cylinder.side)

    @property
    @_quiet
    def M1(self) -> Array:
        """Bending moment about the inward normal, A beta', (*cases, n) [force length]; eq. (19)."""
        return self._loads[0] * self.dbeta

    @property
    @_quiet
    def M2(self) -> Array:
        """Bending moment about B, A sin^2(beta)/rho, (*cases, n) [force length]; eq. (19)."""
        return self._loads[0] * np.sin(self.beta) ** 2 / self._rho

    @cached_property
    @_quiet
    def h(self) -> Array:
        """First integral beta'^2 + G(beta), (*cases, n) [1/length^2]; eq. (32). Constant but for the method's error."""
        level = self.trajectory.dbeta**2 + potential(Loads.columns(self.problem), self.trajectory.beta)
        return self._along(level) / self._rho**2

    # of each case

    @cached_property
    @_quiet
    def FZ(self) -> Any:
        """Axial force, (*cases) [force]; eq. (26)."""
        return self._each(flat(self.case.loads[0], self.case.shape))

    @cached_property
    @_quiet
    def MZ(self) -> Any:
        """Axial moment, (*cases) [force length]; eq. (29)."""
        return self._each(flat(self.case.loads[1], self.case.shape))

    @cached_property
    @_quiet
    def M3(self) -> Any:
        """Twisting moment, (*cases) [force length]."""
        return self._each(flat(self.case.loads[2], self.case.shape))

    @property
    def outcome(self) -> Any:
        """ "solved" (perhaps with a remark after it), or why not, (*cases)."""
        return self._each(self.trajectory.outcome)

    @cached_property
    def solved(self) -> Any:
        """Whether each case's outcome is solved, (*cases) of bool."""
        return self._each(np.array([text.startswith("solved") for text in self.trajectory.outcome], dtype=bool))

    @property
    def selection(self) -> Any:
        """Of an ends problem solved without a seed: how many equilibria there are and which rule took this one,
        (*cases) of `selection.Selection`; None for others."""
        found = self.trajectory.selection
        return self._each(np.full(self.case.size, None, dtype=object) if found is None else found)

    @property
    def error(self) -> Any:
        """Estimated largest error of beta [rad], and of alpha and z/rho over max(1, L/rho), (*cases)."""
        return self._each(self.trajectory.error)

    @property
    def condition(self) -> Any:
        """How much a change of what is given grows along the rod, at least 1, (*cases).

        Start problems: the largest |d beta/d beta(0)| and w |d beta/d beta'(0)|/rho, with
        w = max(1, rho |beta'(0)|, rho sqrt|H'(beta(0))|). Ends problems: the largest |d beta/d beta(L)|.
        """
        return self._each(self.trajectory.condition)

    @property
    def evaluations(self) -> Any:
        """How often the method evaluated the equation, (*cases)."""
        return self._each(self.trajectory.evaluations)
