"""The shape of a rod beside its wall, read at any station, in units of A and rho."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import NEGLIGIBLE, ROUGHLY, Array, Booleans, whole_turns
from ..orbits.frames import binormal, outward
from .contacts import Contact, contacts_of
from .discrete_rod import DiscreteRod
from .quaternions import directors


class Along(NamedTuple):
    """A rod at n stations: (n,) each, vectors in space (n, 3).

    turned: azimuth, beta, tilt and rotation, (4, n); the tilt is the angle of the tangent out of the tangent plane of
    the cylinder through its point, outward. rate: of beta. tangent, d1: of the frame of the section. force, moment:
    internal. push: of the wall, per length.
    """

    x: Array
    radius: Array
    turned: Array
    rate: Array
    tangent: Array
    d1: Array
    force: Array
    moment: Array
    push: Array

    @classmethod
    def blank(cls, n: int) -> "Along":
        """The arrays of a rod without a shape: NaN everywhere."""
        line, vectors = np.full(n, np.nan), np.full((n, 3), np.nan)
        return cls(vectors, line, np.full((4, n), np.nan), line, vectors, vectors, vectors, vectors, line)


@dataclass(frozen=True, eq=False)
class FreeShape:
    """An equilibrium of a discrete rod, and whether it is a minimum of the energy.

    y: the unknowns of the rod (size,). multipliers: of its conditions (M,), 0 off the wall. unstable: in how many ways
    it is, so 0 at a minimum; None where that is not decided. steps: with which it was found.
    """

    rod: DiscreteRod
    y: Array
    multipliers: Array
    unstable: int | None = 0
    steps: int = 0

    @property
    def angles(self) -> Array:
        """Azimuth, beta, tilt and rotation of both ends, (8,), the rotation without the uniform twist."""
        return self.rod.parts(self.y)[2]

    @cached_property
    def nodes(self) -> Array:
        """Where the nodes are along the rod, (N + 1,)."""
        return np.linspace(0, self.rod.span, self.rod.edges + 1)

    @cached_property
    def middles(self) -> Array:
        """Where the start, the middles of the edges and the far end are along the rod, (N + 2,)."""
        return np.concatenate([[0.0], self.nodes[:-1] + self.rod.h / 2, [self.rod.span]])

    @cached_property
    def x(self) -> Array:
        """The nodes, (N + 1, 3)."""
        return np.concatenate([[[*self.rod.place(0, self.angles[0]), 0.0]], self.rod.parts(self.y)[1]])

    @cached_property
    def moments(self) -> Array:
        """The internal moment at the nodes, in the frames there without the uniform twist, (N + 1, 3).

        That of a joint at an end is the moment at the end itself, by the balance of the edge there, turned into the
        frame of the end; any other one is in the frame half way.
        """
        joints = self.rod.joints(self.y)
        moments = joints.pull / 2
        for end, sense in ((0, 1.0), (-1, -1.0)):
            moments[end] += np.cross(sense * joints.v[end] + self.rod.lead[end], moments[end])
        return moments

    @cached_property
    def forces(self) -> Array:
        """The internal force at the start, on the edges, and at the far end, (N + 2, 3).

        It changes by the push as it is read: next to an end on the wall the force of a node is partly that of the end.
        """
        edges = -self.rod.split(self.multipliers)[0][:, :3]
        forces, weight = np.concatenate([edges[:1], edges, edges[-1:]]), self.rod.h * self.rod.weight
        out, push = self.rod.side * self.x * [1, 1, 0], self.rod.h * self.push_at(self.nodes[[0, 1, -1, -2]])
        for way in (1, -1):
            force, away, (at, by) = forces[::way], out[::way], push.reshape(2, 2)[::way][0]
            if at > 0:
                force[1] = force[2] + way * (by * away[1] + weight)
                force[0] = force[1] + way * (3 * at + by) / 8 * away[0]
            force[0] += way * weight / 2
        return forces

    @cached_property
    def lead(self) -> Array:
        """By how much the frames of both ends should stand ahead where they meet the edges, over h^2, (2, 3).

        The moment M changes by F x D3 per length, the curvature k by as much and M3 D3 x k. Ends off the wall have no
        lead: a rod that may turn about the line through them would be turned by it.
        """
        moment, D = self.moments[[0, -1]], self._directors(self.nodes[[0, -1]])
        shear = np.einsum("nij,nj->ni", D, np.cross(self.forces[[0, -1]], D[:, 2]))
        return self.rod.on_wall[:, None] * (shear / 6 + moment[:, 2:] * np.cross([0, 0, 1.0], moment) / 24)

    def tilts_into_wall(self, leaning: Booleans) -> Booleans:
        """Which of these angles of ends (8,) lead into the wall, or would if they were not held along it."""
        outward = self.rod.side * np.array([0, 0, 1, 0, 0, 0, -1, 0])
        slopes = np.cos(self.angles) * self.rod.parts(self.rod.gradient(self.y))[2]
        return leaning & np.where(self.rod.free, outward * np.sin(self.angles) < 0, outward * slopes > 0)

    @property
    def far_loads(self) -> Array:
        """lam, mu and phi at the far end, the span, and beta at both ends."""
        force, moment = self.forces[-1], self.moments[-1] @ self._directors(self.nodes[-1:])[0]
        around = np.cross(self.x[-1], force)[2] + moment[2]
        return np.array([around, self.twist_moment, force[2], self.rod.span, *self.angles[[1, 5]]])

    @cached_property
    def twist_moment(self) -> float:
        """mu, which is constant along the rod; its mean."""
        return float(self.moments[:, 2] @ self.rod.lengths / self.rod.span)

    def name_of(self, motion: Array) -> str:
        """What a motion of the unknowns (size,) is, in words: it is known which turns of a whole rod need no force."""
        arms, moved = self.x[1:] - self.x[0], self.rod.parts(motion)[1]
        turns = np.cross(np.eye(3)[:, None], arms).reshape(3, -1).T
        turn = np.linalg.lstsq(turns, moved.ravel(), rcond=None)[0]
        # a motion is a turn of the whole rod if a turn leaves less than this share of it
        if np.linalg.norm(turns @ turn - moved.ravel()) > ROUGHLY * np.linalg.norm(moved):
            return "a motion of the rod needs no force"
        turn /= np.linalg.norm(turn)
        if self.rod.radius[0] < NEGLIGIBLE and np.hypot(*turn[:2]) < ROUGHLY:
            return "the rod may turn about the axis of the cylinder"
        if np.linalg.norm(np.cross(turn, arms[-1])) < ROUGHLY * np.linalg.norm(arms[-1]):
            return "the rod may turn about the line through its ends"
        return "the rod may turn as a whole about its start"

    @cached_property
    def wall_force(self) -> Array:
        """The force with which the wall pushes the nodes, (N + 1,); 0 at the ends, which are held."""
        return np.pad(2 * self.rod.side * self.rod.split(self.multipliers)[1], 1)

    @cached_property
    def contacts(self) -> list[Contact]:
        """The intervals of contact, in order."""
        return contacts_of(self.wall_force, self.rod.h, self.rod.on_wall)

    def push_at(self, t: Array) -> Array:
        """The push of the wall per length at stations (n,), point forces not included."""
        pushes = [np.interp(t, on.places, on.push, left=0.0, right=0.0) for on in self.contacts]
        return np.sum([np.zeros(t.size), *pushes], axis=0)

    @cached_property
    def _known_angles(self) -> Array:
        """The four angles at the nodes without jumps, (4, N + 1)."""
        turned = np.unwrap(self._angles(self.nodes, self.x, self._directors(self.nodes)))
        # an end that turned over is half a turn off, so the other one tells the turns; if both are, a radian less
        # rounds each half turn down
        k = int(np.cos(self.angles[2]) < 0)
        turns = whole_turns(self.angles[4 * k :][:4] - k - turned[:, -k]) * [1, 1, 0, 1]  # a tilt has none
        return turned + turns[:, None]

    def _directors(self, t: Array) -> Array:
        """D1, D2, D3 at stations (n, 3, 3), without the uniform twist."""
        q = between(t, self.middles, self.rod.chain(self.y))
        return directors(q / np.linalg.norm(q, axis=1, keepdims=True))

    def _angles(self, t: Array, x: Array, D: Array) -> Array:
        """Azimuth, beta, tilt and rotation at stations, (4, n), each but for full turns."""
        alpha = np.arctan2(x[:, 1], x[:, 0])
        # a station that is nearer to the axis, in rho, has no azimuth of its own
        off = np.hypot(x[:, 0], x[:, 1]) > NEGLIGIBLE
        ends = np.where(self.rod.radius[:, None] > NEGLIGIBLE, np.nan, self.angles[[0, 4]][:, None])
        alpha = np.where(off, alpha, np.where(2 * t < self.rod.span, *ends)) if not off.all() else alpha
        return angles_at(alpha, D)

    def at(self, t: Array) -> Along:
        """The rod at stations t (n,)."""
        from scipy.interpolate import CubicHermiteSpline  # only a search loads SciPy

        D = self._directors(t)
        x = CubicHermiteSpline(self.nodes, self.x, self._directors(self.nodes)[:, 2])(t)
        turned = self._angles(t, x, D)
        known = np.stack([np.interp(t, self.nodes, row) for row in self._known_angles])
        turned += whole_turns(known - turned)
        turned[3] += self.rod.twist * t
        radius = np.hypot(x[:, 0], x[:, 1])
        radius = np.fmax(radius, 1.0) if self.rod.side > 0 else np.fmin(radius, 1.0)
        for contact in self.contacts:
            radius[(t >= contact.begin) & (t <= contact.end)] = 1.0
        moment = np.einsum("ni,nij->nj", between(t, self.nodes, self.moments), D)
        c, s = np.cos(self.rod.twist * t)[:, None], np.sin(self.rod.twist * t)[:, None]
        d1, force = -(c * D[:, 0] + s * D[:, 1]), between(t, self.middles, self.forces)
        rate = np.interp(t, self.nodes, np.gradient(self._known_angles[1], self.rod.h))
        return Along(x, radius, turned, rate, D[:, 2], d1, force, moment, self.push_at(t))

    def at_stations(self, t: Array) -> Along:
        """The rod at stations t (n,), the ends of hinges that turned over in the angles in which they are given.

        There beta is that of the hinge, and the tilt from it beyond a right angle: between the ends the frame has beta
        and rotation turned by pi, the tilt the other way round, and so M2 the other sign.
        """
        along = self.at(t)
        for k in np.flatnonzero(np.cos(self.angles[2::4]) < 0):
            end, given = k * self.rod.span, self.angles[4 * k :][:4]
            given = given - [0, 0, whole_turns(given[2]), -self.rod.twist * end]
            along.turned[:, np.abs(t - end) <= NEGLIGIBLE * self.rod.span] = given[:, None]
        return along


def angles_at(alpha: Array, D: Array) -> Array:
    """Azimuth, beta, tilt and rotation, (4, n), each but for full turns, of frames D (n, 3, 3) at azimuths (n,)."""
    e_x = outward(alpha)
    e_y = np.column_stack([-e_x[:, 1], e_x[:, 0], np.zeros(alpha.size)])
    around, up, out = (D[:, 2] * e_y).sum(axis=1), D[:, 2, 2], (D[:, 2] * e_x).sum(axis=1)
    beta = np.arctan2(around, up)
    side = -binormal(alpha, beta)  # D2 where the rotation is 0
    gamma = np.arctan2((D[:, 0] * side).sum(axis=1), (D[:, 1] * side).sum(axis=1))
    return np.stack([alpha, beta, np.arcsin(np.clip(out, -1, 1)), gamma])


def between(t: Array, places: Array, values: Array) -> Array:
    """Values (m, k) at places (m,), at t (n, k): linear between them, and beyond the first and the last."""
    k = np.clip(np.searchsorted(places, t) - 1, 0, places.size - 2)
    share = ((t - places[k]) / (places[k + 1] - places[k]))[:, None]
    return np.asarray((1 - share) * values[k] + share * values[k + 1])
