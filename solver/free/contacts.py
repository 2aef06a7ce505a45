"""Where a discrete rod lies against its wall: intervals of contact, the push inside, and the point forces.

Off the wall the push is 0; inside a contact it is finite; at an edge the shear of the free arc meets that of the rod on
the wall with a jump, which is a point force. The multipliers of the nodes are the forces of both, lumped as by linear
hat functions. So the sum and the first moment of those next to an edge say where the edge is, between two nodes, and
how large the point force: both to second order in h.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial

from ..numerics.arrays import NEGLIGIBLE, Array, Booleans

NEAR = 3  # nodes: those of an edge, and the widest gap that is none. x10: contacts near each other become one
FEWEST = 5  # nodes of an interval; fewer are a point. x10: short intervals count as points, and their lengths are lost
STEPS = 8  # of Newton's method for the place of an edge. x10: only time


class Contact(NamedTuple):
    """An interval of contact, from the first of the places to the last one, in units of rho; a point, if there is one.

    places, push: (n,), and the push per length there. points: places of point forces, and these. readings: what else a
    point of a few nodes may be, where these are too few to tell: a point an edge aside, a short interval, next to an
    end one that begins there and a point nearer to it, or no contact but a part of what holds that end; and of a short
    interval, one that is pressed evenly.
    """

    places: Array
    push: Array
    points: tuple[tuple[float, float], ...]
    readings: tuple["Contact", ...] = ()

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


def contacts_of(force: Array, h: float, grounded: Booleans) -> list[Contact]:
    """The contacts of a rod, in order.

    force: of the wall on the nodes, (N + 1,). grounded: whether the ends of the rod are on the wall.
    """
    # a force below this share of the largest one is rounding
    touching = np.flatnonzero(force > NEGLIGIBLE * force.max())
    runs = np.split(touching, np.flatnonzero(np.diff(touching) > NEAR) + 1) if touching.size else []
    return [_contact(force, h, int(run[0]), int(run[-1]), grounded) for run in runs]


def _contact(force: Array, h: float, first: int, last: int, grounded: Booleans) -> Contact:
    """The contact of the nodes from first to last."""
    end, count = force.size - 1, last - first + 1
    from_start, to_end = grounded[0] and first == 1, grounded[1] and last == end - 1
    if count < FEWEST:
        nodes = np.arange(first - 1, last + 2)  # a point between nodes has a small negative share of the next one
        total = float(force[nodes].sum())
        place = float(force[nodes] @ nodes) / total * h
        point = Contact(np.array([place]), np.zeros(1), ((place, total),))
        at_ends = grounded & [first <= NEAR, last >= end - NEAR]
        if not at_ends.any() and count <= 2:
            return point._replace(readings=(Contact(point.places - h, point.push, point.points),))
        near, far = np.where(at_ends, [0.0, end * h], place + count * h * np.array([-0.5, 0.5]))
        # next to a clamp a force bends the rod by the square of its distance: half as far, it is four times as large
        nearer = ((place, 4 * total),) if at_ends.any() and count <= 2 else ()
        spread = Contact(np.array([near, far]), np.full(2, total / (far - near)), nearer)
        return point._replace(readings=(spread, *[Contact(*point[:2], ())] * bool(at_ends.any())))
    few = max(1, min(NEAR, (count - 1) // 2))
    feel = 1 if from_start else few, 1 if to_end else few  # so many nodes at each edge
    known = min(count - sum(feel), NEAR + 1)
    near = edge_of(force[::-1], end - first, feel[0], known, from_start)
    far = edge_of(force, last, feel[1], known, to_end)
    inner = np.arange(end - near.inner, far.inner + 1)
    places = np.concatenate([[end - near.place], inner, [far.place]]) * h
    push = np.concatenate([[near.push], force[inner], [far.push]]) / h
    points = ((end - near.place) * h, near.force), (far.place * h, far.force)
    evenly = Contact(places[[0, -1]], np.full(2, force[first : last + 1].sum() / np.ptp(places)), ())
    readings = (evenly,) if count < 2 * FEWEST else ()
    return Contact(places, push, tuple((place, point) for place, point in points if point > 0), readings)


def edge_of(force: Array, last: int, few: int, known: int, at_end: bool) -> _Edge:
    """The edge of a contact whose last node is given, which only so few nodes feel.

    From the first of them on the push goes on as a parabola, x in edges, through the known nodes before it. To that
    comes a point force at the edge; but where the contact goes on to the end of the rod, the rest belongs to that end.
    """
    begin = last - few + 1
    push = polynomial.polyfit(np.arange(-known, 0), force[begin - known : begin], min(2, known - 1, (known + 1) // 2))
    once, twice = polynomial.polyint(push), polynomial.polyint(push, 2)
    nodes, half = force[begin : last + 1], float(polynomial.polyval(-1.0, twice))  # of the push before `begin`
    total, moment, d = float(nodes.sum()) - half, float(nodes @ np.arange(nodes.size)), float(at_end)
    for _ in range(0 if at_end else STEPS):  # moment = total d - twice(d), whose slope is the point force
        point = max(total - float(polynomial.polyval(d, once)), NEGLIGIBLE * nodes.sum())
        d = float(np.clip(d - (d * total - polynomial.polyval(d, twice) - moment) / point, 0, nodes.size))
    point = 0.0 if at_end else max(total - float(polynomial.polyval(d, once)), 0.0)
    return _Edge(begin + d, point, max(float(polynomial.polyval(d, push)), 0.0), begin - 1)


def contacts_across(contacts: list[Contact], stretches: list[tuple[float, float]]) -> list[Contact]:
    """The contacts, those at both sides of each stretch joined, or one and the end of the rod: the point forces at its
    edges are then spread over it."""
    joined = list(contacts)
    for low, high in stretches:
        before, after = ([on for on in joined if on.end == low], [on for on in joined if on.begin == high])
        points = [point for on in before + after for point in on.points]
        spread = sum(force for place, force in points if low <= place <= high) / (high - low)
        parts = [*(on[:2] for on in before), ([low, high], [spread] * 2), *(on[:2] for on in after)]
        places, push = (np.concatenate(part) for part in zip(*parts, strict=True))
        rest = [on for on in joined if on.end != low and on.begin != high]
        outer = tuple(point for point in points if not low <= point[0] <= high)
        joined = sorted([*rest, Contact(places, push, outer)], key=lambda on: on.begin)
    return joined


def sure_parts(on: Contact, error: Array) -> list[Contact]:
    """The parts of an interval that are surely pressed, and its point forces alone. error: of the push, (n,)."""
    sure = np.flatnonzero(on.push > error)
    runs = np.split(sure, np.flatnonzero(np.diff(sure) > 1) + 1) if sure.size else []
    alone = [Contact(np.array([place]), np.zeros(1), ((place, force),)) for place, force in on.points]
    return sorted([*(Contact(on.places[run], on.push[run], ()) for run in runs), *alone], key=lambda part: part.begin)
