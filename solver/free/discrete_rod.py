"""A discrete rod in space: its energy, its constraints, and their exact derivatives.

In units of A and rho. N edges, which are chords of lengths h of the rod, lead from node 0 to node N. Edge k has a
frame, a quaternion q_k whose third director is the direction of the edge:  x_{k+1} = x_k + h_k D3(q_k), |q_k| = 1.
Between two edges, over a length d (h; h/2 between the frame of an end and its edge), the strain is u = 2 v/d with v the
imaginary part of conj(q) q', and the energy there d/2 (u1^2 + u2^2 + c (u3 + tau)^2), with c = C/A. Frames turn with
the uniform twist tau, which is therefore no strain of theirs: however often a rod is twisted, neighbouring frames are
close to one another. At the nodes between the ends the wall asks for  side (x^2 + y^2 - 1) >= 0, or for equality where
it holds the rod on.

The caller gives two corrections of order h^2, from a known shape. A chord is shorter than h by the curvature: a rod
that is wound nearly taut has far less slack than chords of length h would leave it. And the joint at an end has the
moment of the end, not of the middle of its half edge, and a chord another direction than the tangent there. So the
frame of an end meets its edge turned on by a lead: h^2/8 of what the moment and h^2/24 of what the curvature changes by
per length. Without it an end tilts by order h^2, and on a wall that is a force of order 1 at node 1, or a gap on a
length of order h^(2/3).
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from ..numerics.arrays import NEGLIGIBLE, Array, Booleans
from .quaternions import BILINEAR, BY_FIRST, BY_FRAME, BY_SECOND, QUADRATIC, contract, end_frame, product

EDGE = 7  # unknowns of an edge: its quaternion, and the node behind it
ENDS = 8  # the angles of both ends: azimuth, beta, tilt, rotation
CONDITIONS = 4  # of an edge: where it leads, and the size of its quaternion
HELD_ON, OUTSIDE, INSIDE = 0, 1, -1
LOWER = np.tril_indices(8)  # of a joint's second derivatives


class _Joints(NamedTuple):
    """The strains between neighbouring frames, with derivatives.

    v: (N + 1, 3). slopes: its derivatives by what both frames depend on, (N + 1, 3, 8): the quaternions of edges, and
    the angles of ends. pull: the derivative of the energy by v, (N + 1, 3). bends: of the energy's second derivatives,
    (N + 1, 8, 8), those that are due to the second ones of v.
    """

    v: Array
    slopes: Array
    pull: Array
    bends: Array


@dataclass(frozen=True, eq=False)
class DiscreteRod:
    """A rod between its ends, on N edges.

    edges: N. span: L/rho. ratio: C/A. twist: tau. side: `OUTSIDE`, `INSIDE` or `HELD_ON`. weight: (3,), force per
    length. angles: (8,), azimuth, beta, tilt and rotation of both ends, anything where `free` (8,) says that they
    are unknown, an azimuth that of the start; never the azimuth and the rotation of the start. flip: sign of the
    quaternion of the far end. radius: (2,), distance of both ends from the axis. height: z of node N; None if
    unknown. loads: (8,), what does work with the angles. tension: what does work with the height. lead: (2, 3), of
    the frames of both ends, in these [rad]. chords: (N,), of the edges, over h. drag: of a medium in which nodes 1
    to N have moved from places (N, 3), per length, over the time of that motion.
    """

    edges: int
    span: float
    ratio: float
    twist: float
    side: int
    weight: Array
    angles: Array
    free: Booleans
    flip: float
    radius: Array
    height: float | None
    loads: Array
    tension: float
    lead: Array
    chords: Array | float = 1.0
    drag: float = 0.0
    places: Array | float = 0.0

    @property
    def h(self) -> float:
        """The length of the rod along an edge."""
        return self.span / self.edges

    @cached_property
    def chord_lengths(self) -> Array:
        """The lengths of the edges in space, (N, 1)."""
        return np.broadcast_to(self.h * self.chords, self.edges)[:, None]

    @property
    def size(self) -> int:
        """The number of unknowns, those included that are given."""
        return EDGE * self.edges + ENDS

    @property
    def on_wall(self) -> Booleans:
        """Which ends are on the wall, (2,)."""
        return np.abs(self.radius - 1) < NEGLIGIBLE

    @property
    def may_tilt(self) -> Booleans:
        """Which angles of both ends (8,) are the tilts of hinges on the wall."""
        return self.free & np.outer(self.on_wall, [False, False, True, False]).ravel()

    def parts(self, y: Array) -> tuple[Array, Array, Array]:
        """Quaternions (N, 4), nodes 1 to N (N, 3), and the angles of both ends (8,), as views of the unknowns."""
        edges = y[:-ENDS].reshape(-1, EDGE)
        return edges[:, :4], edges[:, 4:], y[-ENDS:]

    def place(self, end: int, azimuth: float) -> Array:
        """Where an end is across the axis, (2,)."""
        return np.asarray(self.radius[end] * np.array([np.cos(azimuth), np.sin(azimuth)]))

    @cached_property
    def known(self) -> Booleans:
        """Which unknowns are given, (size,)."""
        known = np.zeros(self.size, dtype=bool)
        known[-ENDS:] = ~self.free
        known[-ENDS - 1] = self.height is not None
        return known

    def with_known(self, y: Array) -> Array:
        """The unknowns with those that are given put in."""
        y = y.copy()
        _, x, angles = self.parts(y)
        angles[~self.free] = self.angles[~self.free]
        x[-1, :2] = self.place(1, angles[4])
        if self.height is not None:
            x[-1, 2] = self.height
        return y

    # the energy

    @cached_property
    def lengths(self) -> Array:
        """The lengths of the joints, between the middles of edges and from an end to one, (N + 1,)."""
        lengths = np.full(self.edges + 1, self.h)
        lengths[[0, -1]] /= 2
        return lengths

    @cached_property
    def _stiffness(self) -> Array:
        """What multiplies v v/2 at each joint, (N + 1, 3)."""
        return 4 * np.array([1.0, 1.0, self.ratio]) / self.lengths[:, None]

    @cached_property
    def _node_weights(self) -> Array:
        """The weight at nodes 1 to N, (N, 3)."""
        return np.outer(np.append(np.full(self.edges - 1, self.h), self.h / 2), self.weight)

    def chain(self, y: Array, led: bool = False) -> Array:
        """The frames of the start, of the edges and of the far end, (N + 2, 4). led: the ends with the lead."""
        ends = _recall_ends(self, y[-ENDS:].tobytes(), led)[0]
        return np.concatenate([ends[:1], self.parts(y)[0], ends[1:]])

    def joints(self, y: Array) -> _Joints:
        """The strains between neighbouring frames."""
        return _recall_joints(self, y.tobytes())

    def _joints(self, y: Array) -> _Joints:
        chain = self.chain(y, led=True)
        before, after = contract(chain[1:], BY_SECOND), contract(chain[:-1], BY_FIRST)
        v = (before @ chain[:-1, :, None])[..., 0]
        pull = self._stiffness * v
        pull[:, 2] += 2 * self.ratio * self.twist
        slopes, mixed = np.concatenate([before, after], axis=2), contract(pull, BILINEAR)
        bends = np.zeros((self.edges + 1, 8, 8))
        _, by_angle, by_angles = _recall_ends(self, y[-ENDS:].tobytes(), True)
        (near, far), (near2, far2) = np.moveaxis(by_angle, 1, 0), np.moveaxis(by_angles, 2, 0)
        bends[0, :4, :4], bends[-1, 4:, 4:] = near2 @ (pull[0] @ before[0]), far2 @ (pull[-1] @ after[-1])
        slopes[0, :, :4], slopes[-1, :, 4:] = before[0] @ near.T, after[-1] @ far.T
        mixed[0], mixed[-1] = near @ mixed[0], mixed[-1] @ far.T
        bends[:, :4, 4:], bends[:, 4:, :4] = mixed, np.swapaxes(mixed, 1, 2)
        return _Joints(v, slopes, pull, bends)

    @cached_property
    def _joint_places(self) -> Array:
        """Which unknowns both frames of each joint depend on, (N + 1, 8)."""
        n = EDGE * self.edges
        first = np.concatenate([[n], np.arange(0, n, EDGE), [n + 4]])[:, None] + np.arange(4)
        return np.concatenate([first[:-1], first[1:]], axis=1)

    def weight_energy(self, y: Array) -> float:
        """The energy of the weight, 0 at the axis and at z = 0."""
        return -float((self._node_weights * self.parts(y)[1]).sum())

    def energy(self, y: Array) -> float:
        """Bending and twist energy, less the work of weight and loads."""
        _, x, angles = self.parts(y)
        joints = self.joints(y)
        strain = ((self._stiffness * joints.v / 2 + [0, 0, 2 * self.ratio * self.twist]) * joints.v).sum()
        evenly = (self.ratio * self.twist / 2 - self.loads[7]) * self.twist * self.span
        work = self.loads @ angles + self.tension * (x[-1, 2] - self.span)
        moved = self.drag * self.h * float(((x - self.places) ** 2).sum()) / 2
        return float(strain + evenly + self.weight_energy(y) - work) + moved

    def gradient(self, y: Array) -> Array:
        """The derivatives of the energy, (size,)."""
        joints = self.joints(y)
        pulls = (joints.pull[:, None] @ joints.slopes).ravel()
        gradient = np.bincount(self._joint_places.ravel(), pulls, minlength=self.size)
        _, by_x, by_angle = self.parts(gradient)
        by_x += self.drag * self.h * (self.parts(y)[1] - self.places) - self._node_weights
        by_x[-1, 2] -= self.tension
        by_angle -= self.loads
        return gradient

    # what the unknowns obey

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """The least and the largest values of the conditions, (M,) each."""
        low, high = np.zeros((2, CONDITIONS * self.edges + self.edges + 1))
        if self.side != HELD_ON:
            self.split(low if self.side == INSIDE else high)[1][:] = self.side * np.inf
        return low, high

    def split(self, values: Array) -> tuple[Array, Array, Array]:
        """Numbers of the conditions (M,): of edges (N, 4), of the wall (N - 1,), and of the far end (2,), as views."""
        n = CONDITIONS * self.edges
        return values[:n].reshape(-1, CONDITIONS), values[n:-2], values[-2:]

    def conditions(self, y: Array) -> Array:
        """How far an edge leads beside its node, and |q|^2 - 1, of each edge; x^2 + y^2 - 1 at nodes 1 to N - 1; how
        far the far end is across the axis from its place. (M,)"""
        q, x, angles = self.parts(y)
        start = np.append(self.place(0, angles[0]), 0.0)
        along = (contract(q, BY_FRAME) @ q[..., None])[..., 0]
        led = np.diff(x, axis=0, prepend=start[None]) - self.chord_lengths * along
        of_edges = np.column_stack([led, (q * q).sum(axis=1) - 1])
        wall = (x[:-1, :2] ** 2).sum(axis=1) - 1
        return np.concatenate([of_edges.ravel(), wall, x[-1, :2] - self.place(1, angles[4])])

    @cached_property
    def jacobian_places(self) -> tuple[Array, Array]:
        """Rows and columns of the entries of `jacobian_values`, the unknowns that are given included."""
        k = np.arange(self.edges)[:, None, None]
        by_q = CONDITIONS * k + np.arange(4)[:, None], EDGE * k + np.arange(4)
        ahead = CONDITIONS * k[..., 0] + np.arange(3), EDGE * k[..., 0] + 4 + np.arange(3)
        back = ahead[0][1:], ahead[1][:-1]
        walls = CONDITIONS * self.edges + k[:-1, 0] + np.zeros(2, int), EDGE * k[:-1, 0] + np.array([4, 5])
        last, n = CONDITIONS * self.edges + self.edges - 1, EDGE * self.edges
        far = [last, last + 1] * 2, [n - 3, n - 2, n + 4, n + 4]
        groups = [np.broadcast_arrays(*part) for part in (by_q, ahead, back, walls, far)]
        rows, columns = (np.concatenate([np.ravel(group[i]) for group in groups]) for i in (0, 1))
        return rows.astype(np.int64), columns.astype(np.int64)

    def jacobian_values(self, y: Array) -> Array:
        """The derivatives of the conditions, at the places of `jacobian_places`."""
        q, x, angles = self.parts(y)
        led = self.chord_lengths[..., None] * contract(q, BY_FRAME)
        by_q = 2 * np.concatenate([-led, q[:, None]], axis=1)
        far = [1.0, 1.0, *(self.place(1, angles[4])[::-1] * [1, -1])]
        ones = np.ones(3 * self.edges)
        return np.concatenate([by_q.ravel(), ones, -ones[3:], 2 * x[:-1, :2].ravel(), far])

    # the second derivatives of the Lagrangian  size E - multipliers . conditions

    @cached_property
    def hessian_places(self) -> tuple[Array, Array]:
        """Rows and columns of the entries of `hessian_values`: the lower triangle, some entries in several parts."""
        i, j = LOWER
        nodes = (EDGE * np.arange(self.edges)[:, None] + np.arange(4, EDGE)).ravel()
        first, second = self._joint_places[:, i].ravel(), self._joint_places[:, j].ravel()
        return np.append(np.maximum(first, second), nodes), np.append(np.minimum(first, second), nodes)

    def hessian_values(self, y: Array, size: float, multipliers: Array) -> Array:
        """The second derivatives, at the places of `hessian_places`."""
        (of_edges, wall, far), joints = self.split(multipliers), self.joints(y)
        stiff = self._stiffness[..., None] * joints.slopes
        blocks = size * (np.swapaxes(joints.slopes, 1, 2) @ stiff + joints.bends)
        blocks[:-1, 4:, 4:] += 2 * contract(self.chord_lengths * of_edges[:, :3], QUADRATIC)
        blocks[:-1, 4:, 4:] -= 2 * of_edges[:, 3, None, None] * np.eye(4)
        blocks[-1, 4, 4] -= far @ self.place(1, self.parts(y)[2][4])
        nodes = np.full((self.edges, 3), size * self.drag * self.h)
        nodes[:-1, :2] -= 2 * wall[:, None]
        return np.append(blocks[:, *LOWER], nodes)


@lru_cache(maxsize=2)
def _recall_joints(rod: DiscreteRod, y: bytes) -> _Joints:
    """The joints of a rod with these unknowns; the last two are kept, which energy and derivatives share."""
    return rod._joints(np.frombuffer(y))


@lru_cache(maxsize=4)
def _recall_ends(rod: DiscreteRod, angles: bytes, led: bool) -> tuple[Array, ...]:
    """The frames of both ends of a rod with these angles, (2, 4), and their first and second derivatives by the angles,
    (4, 2, 4) and (4, 4, 2, 4); the last ones are kept, as most ends stand still. led: turned on by the lead."""
    ahead = np.insert(led * rod.lead / 2, 0, 1.0, axis=1) * [[1.0], [rod.flip]]
    return tuple(product(part, ahead) for part in end_frame(np.frombuffer(angles).reshape(2, 4).T))
