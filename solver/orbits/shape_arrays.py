"""The shape of rods: beta and the unrolled curve at the stations; other quantities are computed when first read."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np

from ..numerics.arrays import Array
from ..problem.case import Case
from ..problem.case_fields import cases_at
from ..problem.declared_fields import PAIRS
from ..problem.dimensionless import EndsProblem, StartProblem, fields_held, flat, loads_of
from ..problem.errors import InputError, T, show
from ..problem.trajectory import Trajectory
from . import forces, frames
from .forces import contact_force, push_from, with_weight
from .potential import Loads, dimensional_slope, potential

_quiet = np.errstate(all="ignore")  # the numbers of an unsolved case may overflow


def _property(compute: Callable[[Any], T]) -> cached_property[T]:
    """A property that is computed, quietly, when it is first read."""
    return cached_property(_quiet(compute))


@dataclass(frozen=True, eq=False, repr=False)
class ShapeArrays:
    """The shape and the forces of a case, or of each case of a grid: what a `Solution` is, without what it offers.

    The attributes are those of `Solution`.
    """

    case: Case
    problem: StartProblem | EndsProblem = field(repr=False)
    trajectory: Trajectory = field(repr=False)
    t: Array = field(repr=False)
    method: str
    tol: float

    def __getitem__(self, index: Any) -> Self:
        """The solutions of some cases of a grid, as NumPy indexes an array of its shape; nothing is solved again.

        Raises
        ------
        InputError
            For a single case, an index that NumPy refuses, and cases that are repeated or not in their order.
        """
        if not self.case.shape:
            raise InputError("a solution of one case has no others to select; its arrays are attributes, as solution.z")
        try:
            order = np.ravel(np.arange(self.case.size).reshape(self.case.shape)[index])
        except (IndexError, ValueError) as error:  # a slice whose step is 0 is no value
            raise InputError(f"cases of shape {self.case.shape} have no index {show(index)}: {error}") from None
        if order.size == 0 or (np.diff(order) <= 0).any():
            raise InputError("an index of a solution must select cases in their order, each once, and at least one")
        parts = self.problem.take(order), self.trajectory.take(order), self.t[order]
        return type(self)(cases_at(self.case, index), *parts, self.method, self.tol)

    def __len__(self) -> int:
        """The number of solutions along the first axis of the cases. Raises `TypeError` for a single case."""
        if not self.case.shape:
            raise TypeError("a solution of one case has no length; its arrays are attributes, as solution.z")
        return self.case.shape[0]

    def __bool__(self) -> bool:
        """True, also of a single case and of unsolved ones: see `solved`."""
        return True

    def __iter__(self) -> Iterator[Self]:
        """The solutions along the first axis of the cases. Raises `TypeError` for a single case."""
        return (self[i] for i in range(len(self)))

    def _along(self, values: Array) -> Array:
        return values.reshape(*self.case.shape, values.shape[-1])

    def _each(self, values: Any) -> Any:
        """One value a case, (*cases); a plain number for a single case."""
        shaped = np.asarray(values).reshape(self.case.shape)
        return shaped if self.case.shape else shaped[()]

    def _known(self, values: Any, otherwise: Any = None) -> Any:
        """Values (B,) as `_each` gives them, or the same for each case where they are not known."""
        return self._each(np.full(self.case.size, otherwise) if values is None else values)

    def _column(self, value: Any) -> Array:
        """A field of the case against the stations, (*cases, 1)."""
        return flat(value, self.case.shape).reshape(*self.case.shape, 1)

    @_property
    def _loads(self) -> tuple[Array, Array, Array, Array]:
        """A, l = MZ/A, m = M3/A and p = FZ/A, (*cases, 1) each, or (*cases, n) where they vary along the rod."""
        A = self._column(self.case.rod.bending_stiffness)
        if self.trajectory.loads is not None:
            lam, mu, phi = (self._along(load) / self._rho for load in self.trajectory.loads)
            return A, lam, mu, phi / self._rho
        FZ, MZ, M3 = (self._column(load) for load in self.loads)
        return A, MZ / A, M3 / A, FZ / A

    @_property
    def loads(self) -> tuple[Any, Any, Any]:
        """FZ [force], MZ and M3 [force length]: those of the case, or found where displacements are held.

        Where loads vary along the rod, those of its far end.
        """
        held = fields_held(self.case)
        if not held and (self.case.kind == "ends" or not self.case.varies):
            return self.case.loads
        A, rho, given = self.case.rod.bending_stiffness, self.case.rho, self.case.given
        loads = loads_of(self.problem, A, rho, self.case.shape)
        shown = (np.where(self.trajectory.solved, value, np.nan).reshape(self.case.shape)[()] for value in loads)
        given_loads = (getattr(given, name) if held else None for name in ("FZ", "MZ", "M3"))
        FZ, MZ, M3 = (value if known is None else known for known, value in zip(given_loads, shown, strict=True))
        return FZ, MZ, M3

    @property
    def held(self) -> tuple[str, ...]:
        """The names of what the ends of the case hold in place of loads and angles; empty under dead loads."""
        return fields_held(self.case)

    @cached_property
    def reactions(self) -> dict[str, Any]:
        """What holds the ends: the found partner of each held value, by name, (*cases) each; empty under dead loads."""
        partner = {other: field for field, other in PAIRS}
        return {partner[name]: self._end_value(partner[name]) for name in self.held}

    def _end_value(self, name: str) -> Any:
        """A load, or the angle at an end, (*cases)."""
        if name in ("beta0", "betaL"):
            return self._each(np.where(self.trajectory.solved, getattr(self.problem, name), np.nan))
        return getattr(self, name)

    @_property
    def _rho(self) -> Array:
        return self._column(self.case.rho)

    # along the rod

    @_property
    def s(self) -> Array:
        """Arc length, (*cases, n) [length]."""
        return self._along(self.t) * self._rho

    @_property
    def beta(self) -> Array:
        """Angle from the axis to the tangent, (*cases, n) [rad]."""
        return self._along(self.trajectory.beta)

    @_property
    def dbeta(self) -> Array:
        """d beta/ds, (*cases, n) [rad/length]."""
        return self._along(self.trajectory.dbeta) / self._rho

    @_property
    def alpha(self) -> Array:
        """Azimuth, (*cases, n) [rad]; eq. (37)."""
        return self._column(self.case.given.alpha) + self._along(self.trajectory.alpha)

    @_property
    def z(self) -> Array:
        """Height along the axis from the start, (*cases, n) [length]; eq. (37)."""
        return self._along(self.trajectory.z) * self._rho

    @_property
    def gamma(self) -> Array:
        """Rotation of the section against the frame N, B, T, (*cases, n) [rad]; eq. (24), row 6."""
        twist = self._column(self.loads[2] / self.case.rod.torsional_stiffness)
        return self._column(self.case.given.gamma) + twist * self.s - self._along(self.trajectory.swirl())

    @_property
    def position(self) -> Array:
        """Position of the centreline, (*cases, n, 3) [length]; z is the axis of the cylinder."""
        return frames.position(self._rho, self.alpha, self.z)

    @_property
    def radius(self) -> Array:
        """Distance of the centreline from the axis, (*cases, n) [length]."""
        return self._rho + np.zeros(self.t.shape[-1])

    @_property
    def gap(self) -> Array:
        """Distance of the rod from the wall, at least 0, (*cases, n) [length]; 0 if the cylinder holds the rod on."""
        return np.abs(self.radius - self._rho)

    @_property
    def tilt(self) -> Array:
        """Angle of the tangent out of the tangent plane of the cylinder through its point, outward, (*cases, n) [rad];
        0 where the cylinder holds the rod on."""
        return np.zeros((*self.case.shape, self.t.shape[-1]))

    @property
    def contacts(self) -> Any:
        """Of rods that may leave the cylinder, where they lie on the wall: pairs of s [length], (*cases) of tuples.

        Both are equal where the rod touches the wall at a point. None for other rods, and for an unsolved case.
        """
        return self._known(None)

    @property
    def point_forces(self) -> Any:
        """Of rods that may leave the cylinder, the forces at edges and single points of contact, (*cases) of tuples.

        Pairs of s [length] and the force with which the cylinder pushes [force]; `push` is without them. At an edge the
        shear of the rod on the wall and that of the free arc differ by it. None for other rods, and for an unsolved
        case.
        """
        return self._known(None)

    @_property
    def tangent(self) -> Array:
        """Unit tangent, (*cases, n, 3); eq. (3)."""
        return frames.tangent(self.alpha, self.beta)

    @_property
    def normal(self) -> Array:
        """Unit normal N = B x T, (*cases, n, 3): towards the axis; off the wall it leans by the tilt, as T does."""
        return -frames.outward(self.alpha)

    @_property
    def material_frame(self) -> Array:
        """Frame of the section: d1, d2, d3 as rows, (*cases, n, 3, 3); eq. (13)."""
        return frames.material(self.alpha, self.beta, self.gamma)

    @_property
    def kappa(self) -> Array:
        """Curvature, (*cases, n) [1/length]."""
        return forces.curvature(self._rho, self.beta, self.dbeta)

    @_property
    def FY(self) -> Array:
        """Circumferential force, (*cases, n) [force]; eq. (30)."""
        A, l, m, _ = self._loads
        return forces.circumferential_force(A, l, m, self._rho, self.beta)

    @_property
    def F1(self) -> Array:
        """Internal force along the normal, (*cases, n) [force]; eq. (33), corrected."""
        A, _, m, _ = self._loads
        return forces.normal_force(A, m, self._rho, self.beta, self.dbeta)

    @_property
    def _surface_forces(self) -> tuple[Array, Array]:
        A, _, _, p = self._loads
        return forces.surface_forces(self.FY, self._column(self.FZ) if p.shape[-1] == 1 else A * p, self.beta)

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

    @_property
    def contact(self) -> Array:
        """Contact force per length, positive outward, (*cases, n) [force/length]; eq. (34), corrected."""
        A, l, m, p = self._loads
        H = dimensional_slope(l, m, p, self._rho, self.beta)
        contact = contact_force(A, m, self._rho, self.FY, H, self.beta, self.dbeta)
        return with_weight(self.case, contact, self.alpha, self.dbeta) if self.case.varies else contact

    @property
    @_quiet
    def push(self) -> Array:
        """Contact force per length, positive where the cylinder pushes, negative where it would have to pull.

        (*cases, n) [force/length]; on either side of the wall.
        """
        return push_from(self.contact, self.case.cylinder.side)

    @property
    @_quiet
    def M1(self) -> Array:
        """Bending moment about the normal, A beta', (*cases, n) [force length]; eq. (19)."""
        return self._loads[0] * self.dbeta

    @property
    @_quiet
    def M2(self) -> Array:
        """Bending moment about B, A sin^2(beta)/rho, (*cases, n) [force length]; eq. (19)."""
        return self._loads[0] * np.sin(self.beta) ** 2 / self._rho

    @_property
    def M3_along(self) -> Array:
        """Twisting moment along the rod, (*cases, n) [force length].

        It is `M3` but along a rod that turns in place against friction f: there it grows by f a per push.
        """
        if self.trajectory.loads is None:
            return np.broadcast_to(self._column(self.M3), self.s.shape)
        return self._loads[0] * self._loads[2]

    @_property
    def h(self) -> Array:
        """First integral beta'^2 + G(beta), constant but for the error, (*cases, n) [1/length^2]; eq. (32).

        With weight or friction G has the loads of each place, and varies.
        """
        if self.trajectory.loads is not None:
            _, l, m, p = self._loads
            local = Loads(l * self._rho, m * self._rho, p * self._rho**2)
            return self.dbeta**2 + potential(local, self.beta) / self._rho**2
        level = self.trajectory.dbeta**2 + potential(Loads.columns(self.problem), self.trajectory.beta)
        return self._along(level) / self._rho**2

    # of each case

    @_property
    def FZ(self) -> Any:
        """Axial force, (*cases) [force]; eq. (26)."""
        return self._each(flat(self.loads[0], self.case.shape))

    @_property
    def MZ(self) -> Any:
        """Axial moment, (*cases) [force length]; eq. (29)."""
        return self._each(flat(self.loads[1], self.case.shape))

    @_property
    def M3(self) -> Any:
        """Twisting moment, (*cases) [force length]; of a rod that turns in place against friction at its far end."""
        return self._each(flat(self.loads[2], self.case.shape))

    @property
    def outcome(self) -> Any:
        """A sentence: "solved", or "solved; " and a remark, or "failed: " and the reason, (*cases)."""
        return self._each(self.trajectory.outcome)

    @property
    def solved(self) -> Any:
        """Whether each case was solved, (*cases) of bool."""
        return self._each(self.trajectory.solved)

    @property
    def selection(self) -> Any:
        """The number of equilibria and the rule that took this one, (*cases) of `held.equilibrium_choice.Selection`.

        Of held ends those that were found and compared; it begins with the index where the equilibrium is unstable.
        None for a start problem, of a rod with weight or friction, for a solution from a seed, and where floats cannot
        hold the problem.
        """
        return self._known(self.trajectory.selection)

    @property
    def held_index(self) -> Any:
        """Morse index under held ends, (*cases) of floats; NaN where it is not decided, and under dead loads.

        The observable ``index`` of held ends is the same: it is that under the ends as they are given.
        """
        return self._known(self.trajectory.held_index, np.nan)

    @property
    def dead_index(self) -> Any:
        """Of held ends, the Morse index of the same shape under dead loads between its own end angles, (*cases) of
        floats.

        NaN where it is not decided, under dead loads (the observable ``index``), and with weight or friction.
        """
        return self._known(self.trajectory.dead_index, np.nan)

    @property
    def begun(self) -> Any:
        """How the equilibrium was found, (*cases) of sentences: of held ends with a seed, and with weight or friction.

        Of a seed it says how far it is, and where another equilibrium is nearer (`alternatives`). Else None: see
        `selection`.
        """
        return self._known(self.trajectory.begun)

    @cached_property
    def states(self) -> Any:
        """Of rods with weight or friction, their states along s: straight, sinusoidal or helical, (*cases) of tuples.

        Each state has a word, and the s at which it begins and ends [length]. None for other rods, and for an unsolved
        case. `shooting.state.states` says what the words mean.
        """
        return self._stretches("states")

    @cached_property
    def lift_offs(self) -> Any:
        """Of rods with weight or friction, where the wall would have to pull: pairs of s [length], (*cases) of tuples.

        None for other rods, and for an unsolved case. Elsewhere the wall pushes.
        """
        return self._stretches("lift_offs")

    @cached_property
    def bends_at(self) -> Any:
        """Of rods with weight or friction, where beta turns back, and by how much, (*cases) of tuples of pairs.

        s [length], and the smaller one of the changes of beta from there to the next bend or end on either side [rad].
        The observable `bends` is their number, so it counts ripples too; it is 0 where beta changes by rounding alone.
        None for other rods, whose beta swings between the same two angles, and for an unsolved case.
        """
        return self._stretches("bends")

    def _stretches(self, name: str) -> Any:
        """What a method of the shapes says of each solved case, (*cases)."""
        stretches = np.full(self.case.size, None, dtype=object)
        if self.case.varies and self.trajectory.shapes is not None:
            rho = flat(self.case.rho, self.case.shape)
            for i in np.flatnonzero(np.reshape(self.solved, -1)):
                stretches[i] = getattr(self.trajectory.shapes.of(int(i)), name)(rho[i])
        return self._each(stretches)

    @property
    def error(self) -> Any:
        """Estimated largest error of beta [rad], and of alpha and z/rho over max(1, L/rho), (*cases)."""
        return self._each(self.trajectory.error)

    @property
    def condition(self) -> Any:
        """Condition number: the growth of a change of the given angles along the rod, at least 1, (*cases).

        Start problems: the largest |d beta/d beta(0)| and w |d beta/d beta'(0)|/rho, with
        w = max(1, rho |beta'(0)|, rho sqrt|H'(beta(0))|). Ends problems: the largest |d beta/d beta(L)|.
        """
        return self._each(self.trajectory.condition)

    @property
    def evaluations(self) -> Any:
        """Number of evaluations of the equation, (*cases)."""
        return self._each(self.trajectory.evaluations)
