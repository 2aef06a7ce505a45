"""Fold and pitchfork curves over two fields of a rod whose loads vary along it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from .equilibria import equilibria
from .equilibrium_branch import Branch
from .folds.curve_crossings import join_pieces
from .folds.fold_curves import FoldCurve, FoldCurves, curves_of, fold_curve
from .folds.fold_search import Curve as FoundCurve
from .folds.fold_search import Searched, lies_on
from .folds.fold_seeds import Counted, change_beyond
from .folds.fold_system import CurvePoint
from .folds.parameter_plane import ParameterPlane, read_range
from .levels.census import Census
from .numerics.arclength import FOLD, PITCHFORK, node_at
from .numerics.arrays import Array
from .problem.case_fields import unchecked_with_field, value_of
from .problem.errors import InputError, choices
from .shooting.curve import Curve, Point
from .shooting.descent import on_nodes
from .shooting.fold_line import FoldPoint, fold_line, indices_beside
from .shooting.further_shapes import angles_of
from .shooting.lattice_branches import Branches, Meeting, branches_on
from .shooting.loaded_rod import SPEED, LoadedRod
from .shooting.newton import Shape
from .shooting.numbers import rods_of
from .shooting.pitchfork_line import CROSSING, PitchforkPoint, pitchfork_at, pitchfork_line

MOST = 500  # points in each sense
ASKEW = 0.013  # lines of the lattice stay off lines of symmetry


@dataclass(frozen=True, eq=False)
class Line:
    """A curve of a rod with weight as `folds.fold_search` has it, with the shapes at its points."""

    kind: str
    points: list[CurvePoint]
    cusps: list[int]
    shapes: list[Shape]

    @property
    def slopes(self) -> list[float]:
        """beta_t(0) at each point."""
        return [float(shape.y[0, SPEED]) for shape in self.shapes]

    def holds(self, z: Array, shape: Shape) -> bool:
        """Whether the special point of a branch at z lies on the curve."""
        pairs = zip(self.points, self.shapes, strict=True)
        places = np.array([np.concatenate([point.shares, angles_of(one)]) for point, one in pairs])
        return lies_on(places, np.concatenate([z, angles_of(shape)]))


def trace_fold(branch: Branch, number: int = 0, **ranges: Any) -> FoldCurve:
    """The curve of a fold of a branch of a rod with weight or friction, while a second field changes too.

    Parameters
    ----------
    branch : Branch
        As of `follow`, over the first field.
    number : int
        Which of its folds, from 0.
    **ranges
        The second field with its range, such as ``weight=(0, 0.5)``, and, if wanted, the first one with another range
        than that of the branch. The curve ends at their borders.

    Returns
    -------
    FoldCurve
        As of `fold_curves`; its values are those of the first and of the second field. `lower` is 0 with friction,
        which has no index.

    Raises
    ------
    InputError
        For a branch without weight and friction, one without such a fold, a field that the case does not give, and a
        range that does not hold its value.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, follow, solve, trace_fold
    >>> rod, hole = Rod(E=1.07e4, nu=0.25, a=0.25, L=3.0, weight=0.1), Cylinder(R=0.75, inclination="60deg")
    >>> branch = follow(solve(Case(rod, hole, Ends(beta0=0.5, betaL=0.8, FZ=-40.0))), FZ=[-60, -20])
    >>> trace_fold(branch, weight=(0.09, 0.11)).ends
    ('border', 'border')
    """
    special = [point for point in branch.special if point.kind == FOLD]
    case = branch.points[0].case
    if not case.varies:
        raise InputError("trace_fold takes a branch of a rod with weight or friction; fold_curves has those of others")
    if not 0 <= number < len(special):
        raise InputError(f"the branch has {len(special)} folds, got number {number!r}")
    others = [name for name in ranges if name != branch.field]
    if len(others) != 1:
        raise InputError(f"trace_fold takes one second field with its range, got {choices(others) or 'none'}")
    names, place = (branch.field, others[0]), special[number].position
    value, second = float(branch.values[place]), value_of(case, names[1])
    own = float(branch.values.min()), float(branch.values.max())
    low, high = np.array([read_range(names[0], ranges.get(names[0], own)), read_range(names[1], ranges[names[1]])]).T
    if not low[1] <= second <= high[1]:
        raise InputError(
            f"the range of {names[1]} must hold its value {second:.10g}, got {low[1]:.10g} to {high[1]:.10g}"
        )
    plane = ParameterPlane(case, names, low, high)
    shapes = [branch.points[i].path.shape for i in (place - 1, place, place + 1)]
    z = plane.shares(np.array([value, second]))
    return fold_curve(plane, fold_of(rods_over(plane), z, 0, shapes))


def rods_over(plane: ParameterPlane) -> Callable[[Array], LoadedRod]:
    """The rod at shares of a plane. Beyond the border, where differences reach, no case may have such values."""

    def rod_of(z: Array) -> LoadedRod:
        case = plane.case
        for name, value in zip(plane.names, plane.values(z), strict=True):
            case = unchecked_with_field(case, name, float(value))
        return rods_of(case)[1][0]

    def rod_at(z: Array) -> LoadedRod:
        border = np.clip(z, 0.0, 1.0)
        if (z == border).all():
            return rod_of(z)
        here, inside = rod_of(border), rod_of(2 * border - z)
        numbers = {name: 2 * getattr(here, name) - getattr(inside, name) for name in ("numbers", "span", "near", "far")}
        return replace(here, **numbers)

    return rod_at


def fold_of(rod_at: Callable[[Array], LoadedRod], z: Array, axis: int, shapes: list[Shape]) -> FoundCurve:
    """The curve of the fold at z of a branch along number `axis`, from the shapes before, at and after it."""
    curve = Curve(lambda n: shapes[1].rod, 1.0, shapes[1].rod.scale)
    tangent = curve.direction(shapes[2].y - shapes[0].y, 0.0)
    across, along = np.eye(2)[[axis, 1 - axis]]
    first = FoldPoint(rod_at, z, along, across, Point(shapes[1], 0.0, tangent))
    node = node_at(first, np.zeros(2), np.array([0.0, 1.0]))
    moved = None if isinstance(node, str) else first.fold_at(node)
    first = first if moved is None else moved[0]
    back, ahead = (fold_line(first, sense, np.zeros(2), np.ones(2), MOST) for sense in (-1.0, 1.0))
    points = [*back.points[::-1], first, *ahead.points]
    middle = len(back.points)
    cusps = [*(middle - 1 - i for i in back.cusps), *(middle + 1 + i for i in ahead.cusps)]
    places = np.array([point.z for point in points])
    ways = [point.along for point in points]
    line = Line(FOLD, curve_points(places, ways, [p.more * p.across for p in points], cusps), cusps,
                [point.point.shape for point in points])  # fmt: skip
    return FoundCurve([line], (back.end, ahead.end), indices_beside(first)[0])


def pitchforks_of(first: PitchforkPoint, known: Callable[[Array, Shape], bool]) -> list[FoundCurve]:
    """The curve of a pitchfork in parts of equal index: it changes where another such curve crosses.

    known: whether a point lies on a known curve; where the shape becomes that of a known curve this one ends.
    """
    (back, begin), (ahead, end) = (pitchfork_line(first, sense, MOST, known) for sense in (-1.0, 1.0))
    points = [*back[::-1], first, *ahead]
    places = np.array([point.z for point in points])
    marks = curve_points(places, [np.array([-p.more[1], p.more[0]]) for p in points], [p.more for p in points], [])
    cuts = [0, *(i + 1 for i, (one, other) in enumerate(pairwise(points)) if one.lower != other.lower), len(points) - 1]
    found = []
    for a, b in pairwise(dict.fromkeys(cuts)):
        line = Line(PITCHFORK, marks[a : b + 1], [], [point.shape for point in points[a : b + 1]])
        ends = begin if a == 0 else CROSSING, end if b == len(points) - 1 else CROSSING
        found.append(FoundCurve([line], ends, points[a].lower))
    return found


def curve_points(places: Array, ways: list[Array], sides: list[Array], cusps: list[int]) -> list[CurvePoint]:
    """Points of a curve at places (N, 2) with tangents along `ways`, in the order of the points."""
    chord = np.gradient(places, axis=0) if len(places) > 1 else np.zeros_like(places)
    found = []
    for i, (place, way, side) in enumerate(zip(places, ways, sides, strict=True)):
        tangent = np.zeros(2) if i in cusps else way * np.sign(way @ chord[i])
        found.append(CurvePoint(np.append(0.0, place), np.append(0.0, tangent), 0.0, side))
    return found


def search_varying(plane: ParameterPlane, lattice: int) -> FoldCurves:
    """The curves that branches along the lines of a lattice meet, from the equilibria found at its middle."""
    rod_at = rods_over(plane)
    ticks = np.linspace(0, 1, lattice + 2)[1:-1] + ASKEW / lattice
    middle = lattice // 2, lattice // 2
    z = ticks[list(middle)]
    rods = [rod_at(np.array([u, w])) for u in (0.0, 0.5, 1.0) for w in (0.0, 0.5, 1.0)]
    u = max((rod.nodes() / rod.span for rod in rods), key=len)
    scale = rod_at(z).scale
    shapes = [on_nodes(one.path.shape, u * one.path.shape.rod.span) for one in equilibria(plane.case_at(z))]
    begin = [replace(shape, rod=shape.rod.in_scales(scale)) for shape in shapes]
    branches = branches_on(rod_at, ticks, scale, {middle: begin})
    curves, failed = curves_through(rod_at, branches.meetings)
    pieces = join_pieces([curve.dense() for curve in curves], [curve.lower for curve in curves])
    counted = Counted(plane)
    for (i, j), known in branches.known.items():
        index = np.array([one.index for one in known], dtype=np.int64)
        counted.known[float(ticks[i]), float(ticks[j])] = Census(0.0 * index, index, index, False)
    searched = Searched(plane, curves, pieces, counted, [])
    return curves_of(searched, remark_of(searched, branches, failed, ticks))


def curves_through(rod_at: Callable[[Array], LoadedRod], meetings: list[Meeting]) -> tuple[list[FoundCurve], int]:
    """The curves through the special points of branches, and how many of these gave none."""
    curves: list[FoundCurve] = []
    failed = 0
    for meeting in meetings:
        kind = FOLD if meeting.stages[1].kind == FOLD else PITCHFORK
        lines = [line for curve in curves for line in curve.stretches if isinstance(line, Line) and line.kind == kind]
        before, shape, after = (stage.point.shape for stage in meeting.stages)

        def is_known(z: Array, shape: Shape, lines: list[Line] = lines) -> bool:
            return any(line.holds(z, shape) for line in lines)

        if is_known(meeting.z, shape):
            continue
        if kind == FOLD:
            curves.append(fold_of(rod_at, meeting.z, meeting.axis, [before, shape, after]))
            continue
        first = pitchfork_at(rod_at, meeting.z, meeting.axis, shape)
        if first is None:
            failed += 1
        elif not np.isnan(first.more).any():  # else branches exchange their indices, and no number changes
            curves += pitchforks_of(first, is_known)
    return curves, failed


def remark_of(searched: Searched, branches: Branches, failed: int, ticks: Array) -> str:
    """What is known of the search, which nothing proves complete."""
    said = [f"not proved complete: {branches.count} branches along {2 * ticks.size} lines were followed"]
    if branches.stopped:
        said.append(f"{branches.stopped} of them could not be followed to the border")
    if not branches.whole:
        said.append("more were met and not followed")
    stopped = sum("stopped" in curve.ends for curve in searched.curves)
    if stopped:
        said.append(f"{stopped} of {len(searched.curves)} curves could not be followed to the border")
    if failed:
        said.append(f"of {failed} points where branches meet no curve was found")
    ends = [(np.array([a, w]), np.array([b, w])) for a, b in pairwise(ticks) for w in ticks]
    ends += [(one[::-1], other[::-1]) for one, other in ends]
    unlike = sum(bool(change_beyond(searched.counted, searched.pieces, *two)) for two in ends)
    if unlike:
        said.append(f"on {unlike} of {len(ends)} pieces of these lines the equilibria do not fit the curves")
    return "; ".join(said)
