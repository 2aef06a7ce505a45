"""The observables of rods that may leave the cylinder: of each mesh, and what is left to the limit of fine meshes."""

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from itertools import pairwise, takewhile
from typing import Any

import numpy as np
from numpy.polynomial import polynomial

from ..free.contacts import Contact, contacts_across, sure_parts
from ..free.free_rods import error_of, estimate, largest_left
from ..free.free_shape import Along, FreeShape
from ..nodes.varying_shapes import places_of_extremes
from ..numerics.arrays import FAINT, NEGLIGIBLE, Array
from ..orbits.frames import binormal, outward
from ..orbits.loop_orbits import MOST_PLACES
from ..orbits.shape_arrays import ShapeArrays
from ..problem.dimensionless import flat, natural_unit
from .measurement import MIDDLE

# rad: a smaller change of beta between two bends is no bend of a rod that is solved to 1e-4 of its length. x10: small
# waves are not counted
WAVE = 1e-3
# radii of the rod: stretches that are closer along it do not meet unless it is bent tighter than that. x10: turns of
# 31 radii around that touch are not seen
NEAREST = np.pi
COUNTS = ("bends", "loops", "overlaps", "index", "contact_count")
# those of the contacts of the solution, on the finest mesh; the largest push may be at an edge
OF_EDGES = ("attached", "contact_share", "contact_at", "contact_alpha", "point_force_max", "push_max")
OF_CONTACTS = ("contact_size_mean", "push_mean", "push_max_at", "contact_M2", *OF_EDGES)
# of which rounding is left where there is none
CANCELLING = ("turns_around", "amplitude", "FZ0", "MZ0")
# which load of the far end it is, and its sign: as given, or found
LOADS = {"FZ": ("FZ", 1), "MZ": ("MZ", 1), "M3": ("M3", 1), "M30": ("M3", 1), "surface_torque": ("M3", -1)}
UNDEFINED = {
    **dict.fromkeys(("contact_at", "contact_alpha", "contact_M2"), "the rod touches the wall nowhere"),
    "bend_number": "a rod that may leave the wall has no period",
}


class FreeReading:
    """One mesh of a rod, in units of A and rho.

    a: the radius of the rod. contacts: in another reading; None for the contacts as they are.
    """

    def __init__(self, shape: FreeShape, a: float, contacts: list[Contact] | None = None) -> None:
        self.shape, self.rod, self.a = shape, shape.rod, a
        self.contacts = shape.contacts if contacts is None else contacts

    @cached_property
    def along(self) -> Along:
        """The rod at its nodes and half way between them."""
        return self.shape.at(np.linspace(0, self.rod.span, 2 * self.rod.edges + 1))

    def at(self, share: float) -> Along:
        """The rod at one place."""
        return self.shape.at(np.array([share * self.rod.span]))

    @cached_property
    def bend(self) -> Array:
        """The curvature at the joints, (N + 1,)."""
        return np.hypot(*self.shape.moments[:, :2].T)

    def mean(self, values: Array) -> float:
        """The mean of values at the joints."""
        return float(values @ self.rod.lengths / self.rod.span)

    @property
    def pushes(self) -> Array:
        """Where the wall pushes inside contacts, and how hard, (2, n)."""
        return np.concatenate([np.zeros((2, 0)), *(np.stack(on[:2]) for on in self.contacts)], axis=1)

    @property
    def push(self) -> float:
        """The force of the wall on the rod, the sum of its sizes."""
        return sum(float(np.trapezoid(on.push, on.places)) + sum(f for _, f in on.points) for on in self.contacts)

    @property
    def share(self) -> float:
        """The share of the length on the wall."""
        return sum(on.end - on.begin for on in self.contacts) / self.rod.span

    @cached_property
    def bend_energy(self) -> float:
        return self.mean(self.bend**2) * self.rod.span / 2

    @cached_property
    def twist_energy(self) -> float:
        about = self.shape.moments[:, 2]
        return self.mean(np.where(np.abs(about) < FAINT, 0.0, about) ** 2) * self.rod.span / (2 * self.rod.ratio)

    @property
    def energy(self) -> float:
        """Of bending, twist and weight, less the work of the dead loads at the far end."""
        (lam, mu, phi), far = self.shape.far_loads[:3], self.at(1.0).turned[:, 0]
        first = self.at(0.0).turned[:, 0]
        work = phi * self.shape.x[-1, 2] + lam * (far[0] - first[0]) + mu * (far[3] - first[3])
        return self.bend_energy + self.twist_energy + self.rod.weight_energy(self.shape.y) - work

    def end_moment(self, share: float) -> float:
        """The bending moment about the inward normal at an end."""
        end = self.at(share)
        return float(-end.moment[0] @ outward(end.turned[0])[0])

    @property
    def first(self) -> float:
        """Where the rod first touches the wall; NaN where it does nowhere."""
        return self.contacts[0].begin if self.contacts else np.nan

    def first_bending(self) -> float:
        """The bending moment M2 at the first contact, from the side of the start: its slope jumps by a point force."""
        if not self.contacts:
            return np.nan
        k = max(2, int(self.first / self.rod.h))  # a node of which the next one may already feel the wall
        before = self.shape.at(self.shape.nodes[k - 2 : k + 1])
        M2 = (before.moment * binormal(*before.turned[:2])).sum(axis=1)
        return float(polynomial.polyval(self.first / self.rod.h - k, polynomial.polyfit([-2, -1, 0], M2, 2)))

    def middle_push(self) -> float:
        """The push over the middle third, point forces included, per length."""
        nodes, half = self.shape.nodes, self.rod.h / 2
        low, high = MIDDLE[0] * self.rod.span, MIDDLE[1] * self.rod.span
        inside = np.clip(np.minimum(nodes + half, high) - np.maximum(nodes - half, low), 0, None) / self.rod.h
        return float(inside @ self.shape.wall_force) / (high - low)

    def pitch(self) -> float:
        """The height of a turn about the axis in the middle third; NaN where it does not turn there."""
        low, high = self.at(MIDDLE[0]), self.at(MIDDLE[1])
        turned = abs(float(high.turned[0, 0] - low.turned[0, 0]))
        return float(high.x[0, 2] - low.x[0, 2]) * 2 * np.pi / turned if turned > WAVE else np.nan

    def turns(self) -> float:
        """The turns about the axis; at an end on the axis from or to the azimuth at which the rod leaves it."""
        azimuths = self.along.turned[0]
        ends = np.where(self.rod.radius < NEGLIGIBLE, 2 * azimuths[[1, -2]] - azimuths[[2, -3]], azimuths[[0, -1]])
        return float(ends[1] - ends[0]) / (2 * np.pi)

    def bends(self) -> int:
        """The interior extrema of beta that differ from their neighbours by more than `WAVE`."""
        return len(places_of_extremes(self.along.turned[1], WAVE)) - 2

    def neutral_at(self) -> float:
        """The first place where the axial force is 0; NaN where it is nowhere."""
        force, t = self.along.force[:, 2], np.linspace(0, self.rod.span, 2 * self.rod.edges + 1)
        k = np.flatnonzero(force[1:] * force[:-1] <= 0)
        if not k.size or not force.any():
            return np.nan
        first = k[0]
        return float(t[first] + (t[1] - t[0]) * force[first] / (force[first] - force[first + 1]))

    def overlaps(self) -> float:
        """1 where two stretches of the rod are closer than 2 a, 0 where none are; NaN for too long a rod."""
        from scipy.spatial import cKDTree  # only a search loads SciPy

        count = int(2 * self.rod.span / self.a) + 2
        if count > MOST_PLACES:
            return np.nan
        t = np.linspace(0, self.rod.span, count)
        pairs = cKDTree(self.shape.at(t).x).query_pairs(2 * self.a * (1 - 1e-3), output_type="ndarray")
        return float((t[pairs[:, 1]] - t[pairs[:, 0]] > NEAREST * self.a).any())


def _largest(read: FreeReading) -> Array:
    """Where the largest push inside contacts is, and how large, (2,)."""
    places = read.pushes
    return places[:, places[1].argmax()] if places.size else np.zeros(2)


NUMBERS: dict[str, Callable[[FreeReading], Any]] = {
    "bends": FreeReading.bends,
    "bend_number": lambda read: np.nan,
    "loops": lambda read: np.floor(np.ptp(read.along.turned[1]) / (2 * np.pi)),
    "amplitude": lambda read: np.ptp(read.along.turned[1]),
    "kappa_mean": lambda read: read.mean(read.bend),
    "kappa_max": lambda read: read.bend.max(),
    "turns_around": FreeReading.turns,
    "height": lambda read: read.shape.x[-1, 2],
    "pitch": FreeReading.pitch,
    "contact_size_mean": lambda read: read.push / read.rod.span,
    "push_mean": lambda read: read.push / read.rod.span,
    "pull_mean": lambda read: 0.0,
    "push_min": lambda read: read.pushes[1].min() if read.share > 1 - 1e-9 else 0.0,
    "push_max": lambda read: _largest(read)[1],
    "push_max_at": lambda read: _largest(read)[0],
    "push_middle": FreeReading.middle_push,
    "attached": lambda read: read.share,
    "lift_off_at": lambda read: read.rod.span,  # a cylinder that only pushes pulls nowhere
    "F3_size_max": lambda read: np.abs((read.along.force * read.along.tangent).sum(axis=1)).max(),
    "bending_moment_max": lambda read: read.bend.max(),
    "bending_stress_max": lambda read: read.bend.max(),
    "overlaps": FreeReading.overlaps,
    "energy": lambda read: read.energy,
    "bending_energy": lambda read: read.bend_energy,
    "twist_energy": lambda read: read.twist_energy,
    "index": lambda read: 0,
    "gap_max": lambda read: np.abs(read.along.radius - 1).max(),
    "contact_share": lambda read: read.share,
    "contact_count": lambda read: len(read.contacts),
    "contact_at": lambda read: read.first,
    "contact_alpha": lambda read: read.at(read.first / read.rod.span).turned[0, 0] if read.contacts else np.nan,
    "contact_M2": FreeReading.first_bending,
    "point_force_max": lambda read: max((force for on in read.contacts for _, force in on.points), default=0.0),
    # for their errors: the loads are the solution's
    **dict.fromkeys(LOADS, lambda read: read.shape.twist_moment),
    "FZ": lambda read: read.shape.far_loads[2],
    "MZ": lambda read: read.shape.far_loads[0],
    "FZ0": lambda read: read.at(0.0).force[0, 2],
    "MZ0": lambda read: np.cross(read.at(0.0).x[0], read.at(0.0).force[0])[2] + read.at(0.0).moment[0, 2],
    "neutral_at": FreeReading.neutral_at,
    "reach": lambda read: np.nan,
    "arriving_max": lambda read: np.nan,
    "M10": lambda read: read.end_moment(0.0),
    "M1L": lambda read: read.end_moment(1.0),
}


def narrow_gaps(shapes: Sequence[FreeShape]) -> list[tuple[float, float]]:
    """Where the last of several shapes is off its wall, between contacts or one and an end on the wall, by no more than
    the error of its places all along: such a stretch cannot be told from contact."""
    shape, rod = shapes[-1], shapes[-1].rod
    edges = [(on.begin, on.end) for on in shape.contacts]
    edges = [(0.0, 0.0)] * bool(rod.on_wall[0]) + edges + [(rod.span, rod.span)] * bool(rod.on_wall[1])
    off, error = np.abs(np.hypot(*shape.x[:, :2].T) - 1), error_of(shapes) * rod.span
    stretches = [(low, high) for (_, low), (high, _) in pairwise(edges) if low < high] if shape.contacts else []
    return [each for each in stretches if (off[(shape.nodes > each[0]) & (shape.nodes < each[1])] <= error).all()]


def readings_of(shapes: Sequence[FreeShape]) -> list[list[Contact]]:
    """What else the contacts of the last of several shapes may be, as far as their meshes tell.

    Contacts of a few nodes have other readings; stretches off the wall may be closed within the error of the shape, and
    stretches on it open, where the push is within its own.
    """
    contacts = shapes[-1].contacts
    each = [[on if k >= len(on.readings) else on.readings[k] for on in contacts] for k in (0, 1)]
    return [
        *each,
        contacts_across(contacts, narrow_gaps(shapes)),
        [part for on in contacts for part in _sure_parts(shapes, on)],
    ]


def _sure_parts(shapes: Sequence[FreeShape], on: Contact) -> list[Contact]:
    """The parts of a contact of the last of several shapes that are surely pressed; points are as they are."""
    known = [shape for shape in shapes if shape.contacts]
    if on.begin == on.end or not known[1:]:
        return [on]
    pushes = [np.concatenate([other[:2] for other in shape.contacts], axis=1) for shape in known]
    return sure_parts(on, estimate([np.interp(on.places, *push) for push in pushes])[1])


def error_of_edges(numbers: Sequence[Array] | Sequence[float]) -> Array:
    """The error of numbers (...) of edges of contacts on two meshes or more, each of twice as many edges.

    As an edge of contact passes from node to node, the changes have no order of their own: the error is the last one,
    or half of one before for each mesh since, where that is more. Of two meshes it is twice their difference.
    """
    return largest_left(np.diff(numbers, axis=0), 2.0) * (1 + (len(numbers) == 2))


def alike(shapes: Sequence[FreeShape]) -> int:
    """How many of the last shapes have as many contacts as the last one."""
    return len([*takewhile(lambda shape: len(shape.contacts) == len(shapes[-1].contacts), shapes[::-1])])


def errors_of_contacts(shapes: Sequence[FreeShape]) -> tuple[Array, Array]:
    """The errors of where each contact of the last of several shapes begins and ends, in units of rho, and of the point
    forces there, (n, 2) each.

    They are those of the meshes that have as many contacts; where only the last one has, an edge of the mesh before,
    and twice the force. To that come stretches next to an edge that may be closed, or open.
    """
    last, tables = shapes[-1], [_edges_of(shape.contacts) for shape in shapes[-alike(shapes) :]]
    if len(tables) == 1:
        tables.insert(0, tables[0] * [1, 0] - [last.rod.h, 0])
    (edges, points), (places, forces) = (np.moveaxis(each, 2, 0) for each in (tables[-1], error_of_edges(tables)))
    others = [np.abs(other.places[[0, -1]] - on.places[[0, -1]]) for on in last.contacts for other in on.readings]
    places[:] = np.max([places.max(), *np.ravel(others)])
    for low, high in narrow_gaps(shapes):
        beside = (edges == low) | (edges == high)
        places[beside] += high - low
        forces[beside] = np.maximum(forces, points)[beside]
    for row, force, on in zip(places, forces, last.contacts, strict=True):
        totals = [sum(size for _, size in other.points) for other in (on, *on.readings)]
        force[:] = np.maximum(force, np.ptp(totals))
        sure = [part for part in _sure_parts(shapes, on) if part.end > part.begin]
        if on.end > on.begin:
            row += (sure[0].begin - on.begin, on.end - sure[-1].end) if sure else on.end - on.begin
    return places, forces


def _edges_of(contacts: list[Contact]) -> Array:
    """Where contacts begin and end, and the point forces there, (n, 2, 2)."""
    rows = [[(place, dict(on.points).get(place, 0.0)) for place in (on.begin, on.end)] for on in contacts]
    return np.array(rows).reshape(-1, 2, 2)


def free_numbers(sol: ShapeArrays, names: Iterable[str]) -> dict[str, tuple[Array, Array]]:
    """Observables of rods that may leave the cylinder, and their errors, (B,) each; NaN where a rod has no shape.

    The value is that of the finest mesh, and what the order 2 leaves; of edges of contacts that of the finest mesh.
    """
    case = sol.case
    rho, a = (flat(value, case.shape) for value in (case.rho, case.rod.a))
    E = np.nan if case.rod.E is None else flat(case.rod.E, case.shape)
    readings = [
        [FreeReading(shape, a[i] / rho[i]) for shape in answer.shapes]
        for i, answer in enumerate(sol.trajectory.free.answers)
    ]
    numbers = {}
    for name in names:
        pairs = np.array([_limit(name, reads) for reads in readings])
        unit = E * a / rho if name == "bending_stress_max" else natural_unit(case, name)
        numbers[name] = pairs[:, 0] * unit, pairs[:, 1] * unit
        if name in LOADS:
            load, sign = LOADS[name]
            # what holds the frame of an end on the axis is found, whether the azimuth is given or not
            unknown = getattr(case.given, load) is None or (name == "MZ" and flat(case.end_radii[1] == 0, case.shape))
            numbers[name] = flat(0.0 + sign * getattr(sol, load), case.shape), unknown * numbers[name][1]
    return numbers


def _limit(name: str, reads: list[FreeReading]) -> tuple[float, float]:
    """The value of one rod and its error, from its meshes."""
    if not reads:
        return np.nan, np.nan
    values = [float(NUMBERS[name](read)) for read in reads]
    if name in COUNTS:
        return values[-1], 0.0
    first = int(np.flatnonzero(np.isnan([np.nan, *values]))[-1])  # mesh from which on it is known
    rest, error = (float(part) for part in estimate(values[first:])) if values[first + 1 :] else (0.0, np.nan)
    error = max(error, 3 * abs(rest))  # of one number changes may agree by chance: at least the last one
    if name in OF_EDGES:
        meshes = max(2, alike([read.shape for read in reads]))
        rest, error = 0.0, float(error_of_edges(values[-meshes:]))
    if name in OF_CONTACTS:
        last, shapes = reads[-1], [read.shape for read in reads]
        others = [FreeReading(last.shape, last.a, contacts) for contacts in readings_of(shapes)]
        error = max(error, *(abs(float(NUMBERS[name](other)) - values[-1]) for other in others))
    if name == "push_max_at":  # a node of one of the last two meshes, or an edge
        error = max(error, 2 * reads[-1].rod.h)
    value = values[-1] + rest
    return (0.0, max(error, abs(value))) if name in CANCELLING and abs(value) < FAINT else (value, error)
