"""Where a discrete rod lies against its wall: intervals of contact, the push inside, and the point forces.

Off the wall the push is 0; inside a contact it is finite; at an edge the shear of the free arc meets that of the rod on
the wall with a jump, which is a point force. The multipliers of the nodes are the forces of both, lumped as by linear
hat functions. So the sum and the first moment of those next to an edge say where the edge is, between two nodes, and
how large the point force: both to second order in h.
"""

from typing import NamedTuple

import numpy as np

from ..numerics.arrays import Array

NEAR = 3  # nodes: those of an edge, and the widest gap that is none
FEWEST = 5  # nodes of an interval; fewer are a point
STEPS = 4  # of Newton's method for the place of an edge
FAINT = 1e-9  # of the largest force, or of those next to an edge: less is rounding


class Contact(NamedTuple):
    """An interval of contact, from the first of the places to the last one, in units of rho; a point, if there is one.

    places, push: (n,), and the push per length there. points: places of point forces, and these.
    """

    places: Array
    push: Array
    points: tuple[tuple[float, float], ...]

    @property
    def begin(self) -> float:
        return float(self.places[0])

    @property
    def end(self) -> float:
        return float(self.places[-1])


class _Edge(NamedTuple):
    """An edge of a contact, on its far side.

    place: in edges of the rod. force: at that point. push: per length, next to it. inner: the last node of which the
    whole force is of this push.
    """

    place: float
    force: float
    push: float
    inner: int


def contacts_of(force: Array, h: float, grounded: tuple[bool, bool]) -> list[Contact]:
    """The contacts of a rod, in order.

    force: of the wall on the nodes, (N + 1,). grounded: whether the ends of the rod are on the wall.
    """
    touching = np.flatnonzero(force > FAINT * force.max())
    runs = np.split(touching, np.flatnonzero(np.diff(touching) > NEAR) + 1) if touching.size else []
    return [_contact(force, h, int(run[0]), int(run[-1]), grounded) for run in runs]


def _contact(force: Array, h: float, first: int, last: int, grounded: tuple[bool, bool]) -> Contact:
    """The contact of the nodes from first to last."""
    end, count = force.size - 1, last - first + 1
    from_start, to_end = grounded[0] and first == 1, grounded[1] and last == end - 1
    if count < FEWEST and not (from_start or to_end):
        nodes = np.arange(first - 1, last + 2)  # a point between nodes has a small negative share of the next one
        total = float(force[nodes].sum())
        place = float(force[nodes] @ nodes) / total * h
        return Contact(np.array([place]), np.zeros(1), ((place, total),))
    few = max(1, min(NEAR, (count - 1) // 2))
    near = _Edge(float(end), 0.0, force[1], end - 1) if from_start else edge_of(force[::-1], end - first, few)
    far = _Edge(float(end), 0.0, force[-2], end - 1) if to_end else edge_of(force, last, few)
    inner = np.arange(end - near.inner, far.inner + 1)
    places = np.concatenate([[end - near.place], inner, [far.place]]) * h
    push = np.concatenate([[near.push], force[inner], [far.push]]) / h
    points = ((end - near.place) * h, near.force), (far.place * h, far.force)
    return Contact(places, push, tuple((place, point) for place, point in points if point > 0))


def edge_of(force: Array, last: int, few: int) -> _Edge:
    """The edge of a contact whose last node is given, which only so few nodes feel.

    Before the first of them on, the push is f + g x, with x in edges; a point force at x = d is added.
    """
    begin = last - few + 1
    inside = force[max(begin - NEAR - 1, 0) : begin]
    inside = inside[inside > 0]
    f, g = (float(inside.mean()) if inside.size else 0.0), 0.0
    if inside.size > 2:
        g, f = map(float, np.polyfit(np.arange(-inside.size, 0), inside, 1))
    nodes = force[begin : last + 1]
    total, moment = float(nodes.sum()) - f / 2 + g / 6, float(nodes @ np.arange(nodes.size))
    d = 2 * moment / max(total + np.sqrt(max(total**2 - 2 * f * moment, 0.0)), FAINT * nodes.sum())
    for _ in range(STEPS):  # moment = total d - f d^2/2 - g d^3/6, whose slope is the point force
        slope = max(total - f * d - g * d**2 / 2, FAINT * nodes.sum())
        d = float(np.clip(d - (d * total - f * d**2 / 2 - g * d**3 / 6 - moment) / slope, 0, nodes.size))
    return _Edge(begin + d, max(float(total - f * d - g * d**2 / 2), 0.0), max(float(f + g * d), 0.0), begin - 1)
