"""All equilibria over an axis, joined by following each of them through its folds, under dead loads or with held ends.

At each value all equilibria are computed. Each that lies on no branch yet is followed over the whole axis (`follow`),
and the branch claims the equilibria at the other values that it passes. So branches, folds and the values between are
those of one curve, however coarse the axis; and none is followed twice.
"""

import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from solver import Branch, Case, InputError, Solution, equilibria, follow, solve
from solver.branches.charts import same_equilibrium
from solver.equilibria import Equilibrium
from solver.follow_result import HELIX, BranchPoint, SpecialPoint
from solver.nodes.loaded_rod import BETA
from solver.nodes.varying_shapes import Shape
from solver.numerics.arclength import POINTS
from solver.orbits.boundary import path_of
from solver.problem.case_fields import with_field
from solver.problem.declared_fields import PAIRS
from solver.problem.dimensionless import EndsProblem
from studies.grammar.axes import in_words
from studies.language.case_input import with_fields

PARTNER = {held: field for field, held in PAIRS}  # height -> FZ
_NEAR = 1e-6  # between the loads of one equilibrium, relative; rad between its shapes
PASSES = 10  # of one value by a branch, for which its points are not counted. x10: a branch that creeps takes long
FINE = 61  # values at which a followed branch has points at least, so that its curve is smooth


@dataclass(frozen=True)
class Piece:
    """A part of a followed branch between two special points: its number, and its points from the first to the last."""

    number: int
    curve: int
    first: int
    last: int


@dataclass(frozen=True)
class Traced:
    """The equilibria at each value, the number of the piece of each, the followed branches and their pieces.

    special: each special point once, with the two pieces that meet there (one twice where the branch goes on).
    remarks: why a branch was not followed to the end of the axis.
    """

    found: list[list[Equilibrium]]
    branch: list[list[int]]
    curves: list[Branch]
    pieces: list[Piece]
    special: list[tuple[Branch, SpecialPoint, tuple[int, int]]]
    remarks: list[str]


Place = tuple[int, int]  # a branch and a point of it
PieceKey = tuple[int, int]  # a branch and a piece of it
Step = Callable[[str, int, int], None]  # words, how much is done, of how much: of values, then of equilibria


def trace_branches(
    case: Case,
    name: str,
    values: list[float],
    stations: int,
    step: Step,
    points: int | None = None,
    until: float = np.inf,
) -> Traced:
    """The equilibria at each value of one field, and the branches on which they lie.

    step: called as the work goes on, first with how many equilibria both ends have. points: of each branch in either
    direction, at most; default: `POINTS`, and `PASSES` of each value. until: by `time.monotonic`; no further branch is
    followed then.
    """

    def list_at(value: float) -> list[Equilibrium]:
        return list(equilibria(with_field(case, name, value), stations=stations))

    known = {value: list_at(value) for value in (values[0], values[-1])}
    nouns = {1: "equilibrium"}
    counts = [
        f"{len(members)} {nouns.get(len(members), 'equilibria')} at {in_words(name, value, 4)}"
        for value, members in known.items()
    ]
    listed = []
    for done, value in enumerate(values):
        step(in_words(name, value, 4) if done else ", ".join(counts), done, len(values))
        listed.append(known[value] if value in known else list_at(value))
    # backwards at each value: those of few bends take longest
    starts = [(value, member) for value, members in zip(values, listed, strict=True) for member in reversed(members)]
    passed = _values_passed(values, min(values), max(values))
    places, curves, remarks = _follow_each(name, starts, passed, lambda _, start: start.solution, step, points, until)
    _share_solves(curves, zip(places, starts, strict=True))
    flat = iter(places)
    owner = [[next(flat) for _ in members][::-1] for members in listed]
    return number_pieces(listed, owner, curves, remarks)


def trace_held(
    case: Case, name: str, values: list[float], stations: int, step: Step, points: int | None = None
) -> Traced:
    """The branches over a held field on which the equilibria of a case under dead loads lie.

    Each of these is also one with its own height held, so it is a start. Other branches, which no start lies on, are
    not found.

    step: called before each branch is followed, first with how many there may be. points: as of `trace_branches`.
    Raises `InputError` for a value that no rod of that length reaches.
    """
    for value in (values[0], values[-1]):
        with_fields(case, {name: value})

    def begin(value: float, start: Equilibrium) -> Solution:
        return solve(with_fields(case, {name: value}), seed=start.solution, stations=stations)

    starts = [(own_value(start.solution, name), start) for start in equilibria(case, stations=stations)]
    begins = [value for value, _ in starts]
    passed = _values_passed([*values, *begins], values[0], values[-1])
    step(f"at most {len(starts)} branches, of the equilibria under dead loads", 0, len(starts))
    _, curves, remarks = _follow_each(name, starts, passed, begin, step, points)
    return number_pieces([[] for _ in values], [[] for _ in values], curves, remarks)


def _values_passed(values: Sequence[float], low: float, high: float) -> NDArray[np.float64]:
    """The values, rising, and between two others those of an even axis that rounding alone does not set apart from one
    of them: a branch would pass one of the two, and not be that of the equilibria at the other."""
    even = np.linspace(low, high, FINE)
    apart = np.abs(even[:, None] - np.asarray(values)).min(axis=1) > _NEAR * (high - low)
    return np.union1d(values, even[apart])


def _follow_each(
    name: str,
    starts: list[tuple[float, Equilibrium]],
    passed: NDArray[np.float64],
    begin: Callable[[float, Equilibrium], Solution],
    step: Step,
    points: int | None = None,
    until: float = np.inf,
) -> tuple[list[Place | None], list[Branch], list[str]]:
    """Follow each start that lies on no branch yet: where each lies, the branches, the remarks.

    starts: the value of the field and the equilibrium. passed: the values over which branches are followed, rising.
    begin: what is followed from a start. step: called before each branch. points: as of `trace_branches`.
    """
    most = points or POINTS + PASSES * passed.size
    places, curves, remarks = list[Place | None]([None] * len(starts)), list[Branch](), list[str]()
    for k, (value, start) in enumerate(starts):
        if places[k] is not None or time.monotonic() >= until:
            continue
        step(f"{in_words(name, value, 4)}: branch {len(curves) + 1}", sum(at is not None for at in places), len(starts))
        try:
            branch = follow(begin(value, start), points=most, **{name: passed})
        except InputError as error:
            remarks.append(f"{in_words(name, value)}: {error}")
            continue
        places[k] = len(curves), branch.start
        for curve in (branch, *_mirror_image(branch)):
            claimed = _claim(curve, starts, places, len(curves))
            if curve is branch or claimed:
                curves.append(curve)
                remarks += [
                    f"{in_words(name, end.value)}: {end.reason}"
                    for end in (curve.begin, curve.end)
                    if end.value not in (passed[0], passed[-1])
                ]
    return places, curves, remarks


def _claim(branch: Branch, starts: list[tuple[float, Equilibrium]], places: list[Place | None], number: int) -> int:
    """Say of each start without a place that lies on a branch where it lies; how many they are.

    number: of the branch, in `places`, which are changed.
    """
    points_at = defaultdict[float, list[int]](list)
    for at, value in enumerate(branch.values.tolist()):
        points_at[value].append(at)
    free = [i for i, place in enumerate(places) if place is None]
    for i in free:
        value, equilibrium = starts[i]
        on = next((at for at in points_at[value] if _is_on(branch.points[at], equilibrium)), None)
        places[i] = None if on is None else (number, on)
    return sum(places[i] is not None for i in free)


def _mirror_image(branch: Branch) -> list[Branch]:
    """The branch of the mirror images (-beta) of all rods of a branch; none where they have other ends or loads.

    A branch next to whose end a helix ceases to exist has none here either: the end says which helix that is.
    """
    if HELIX in (branch.begin.kind, branch.end.kind) or isinstance(branch.points[0].path, Shape):
        return []
    numbers = ("lam", "mu", "beta0", "betaL")
    if any(getattr(point.problem, number)[0] for point in branch.points for number in numbers):
        return []
    # G is even: the pins of the two are of one height, so the level may be measured from the same
    points = [
        point.with_path(replace(point.path, leaving=-point.path.leaving), point.problem) for point in branch.points
    ]
    return [replace(branch, points=tuple(points))]


def _share_solves(curves: list[Branch], placed: Iterable[tuple[Place | None, tuple[float, Equilibrium]]]) -> None:
    """Give the points of branches at which listed equilibria lie the paths of these: both are then one solve.

    Shapes on nodes have no path, and are those of the branch.
    """
    points = [list(curve.points) for curve in curves]
    for place, (_, equilibrium) in placed:
        if place is None:
            continue
        curve, at = place
        point, problem = points[curve][at], equilibrium.solution.problem
        if isinstance(problem, EndsProblem) and not isinstance(point.path, Shape):
            points[curve][at] = point.with_path(path_of(equilibrium.path, 0), problem)
    curves[:] = [replace(curve, points=tuple(new)) for curve, new in zip(curves, points, strict=True)]


def _is_on(point: BranchPoint, equilibrium: Equilibrium) -> bool:
    """Whether a point of a branch is an equilibrium under dead loads."""
    solution, problem = equilibrium.solution, equilibrium.solution.problem
    if not isinstance(point.path, Shape):
        same = same_equilibrium(point.problem, path_of(equilibrium.path, 0), point.path)
    else:
        same = bool(np.abs(point.path.at(solution.t[0])[:, BETA] - solution.beta).max() < _NEAR)
    loads = ((getattr(point.problem, load)[0], getattr(problem, load)[0]) for load in ("lam", "mu", "phi"))
    return same and all(abs(a - b) < _NEAR * (1 + abs(b)) for a, b in loads)


def own_value(solution: Solution, name: str) -> float:
    """The value of a displacement or an end moment that a solution has."""
    if name in ("M10", "M1L"):
        return float(solution.M1[0 if name == "M10" else -1])
    along = {"height": solution.z, "azimuth": solution.alpha, "rotation": solution.gamma}[name]
    return float(along[-1] - along[0])


def number_pieces(
    found: list[list[Equilibrium]], owner: list[list[Place | None]], curves: list[Branch], remarks: list[str]
) -> Traced:
    """The pieces in the order in which their equilibria appear; those without any come last."""
    cuts = [
        [0, *(point.position for point in curve.special if point.kind != HELIX), len(curve) - 1] for curve in curves
    ]
    spans = {(c, j): span for c, cut in enumerate(cuts) for j, span in enumerate(pairwise(cut))}

    def piece_of(curve: int, at: int) -> PieceKey:
        return curve, int(np.searchsorted(cuts[curve][1:-1], at, side="right"))

    places = [place for row in owner for place in row if place is not None]
    order = dict.fromkeys(piece_of(*place) for place in places)
    listed = defaultdict[float, list[tuple[PieceKey, BranchPoint]]](list)
    for place in places:
        on = curves[place[0]].points[place[1]]
        listed[on.value].append((piece_of(*place), on))
    again = {}
    for key in spans.keys() - order.keys():
        if first := _repetition(curves[key[0]].points[slice(*spans[key])][1:], listed):
            again[key] = first
    number = {key: n for n, key in enumerate(key for key in {**order, **spans} if key not in again)}
    pieces = [Piece(n, key[0], *spans[key]) for key, n in number.items()]
    number |= {key: number[first] for key, first in again.items()}
    branch = [[-1 if place is None else number[piece_of(*place)] for place in row] for row in owner]
    special = list[tuple[Branch, SpecialPoint, tuple[int, int]]]()
    for c, curve in enumerate(curves):
        for j, point in enumerate(point for point in curve.special if point.kind != HELIX):
            meets = number[c, j], number[c, j + 1]
            if again.keys() & {(c, j), (c, j + 1)} and (len({*meets}) == 1 or _is_among(point, meets, special)):
                continue  # a branch that goes on along another one turns into it, or has its special points
            special.append((curve, point, meets))
    for c, curve in enumerate(curves):
        ends = [(point, piece_of(c, point.position)) for point in curve.special if point.kind == HELIX]
        special += [(curve, end, (number[piece],) * 2) for end, piece in ends if piece not in again]
    return Traced(found, branch, curves, pieces, special, remarks)


def _repetition(
    points: Sequence[BranchPoint], listed: Mapping[float, list[tuple[PieceKey, BranchPoint]]]
) -> PieceKey | None:
    """The piece that one without listed equilibria repeats: a branch may meet itself or another, and go on along it.

    All equilibria at a value of the axis are listed, so each that the piece passes there is one of the other piece.
    points: of the piece, without its ends, where pieces meet. Shapes on nodes are not compared.
    """
    same = [
        {key for key, on in listed[point.value] if _is_same(point, on)} for point in points if point.value in listed
    ]
    counts = Counter(key for keys in same for key in sorted(keys))
    return counts.most_common(1)[0][0] if same and all(same) else None


def _is_among(
    point: SpecialPoint, pieces: tuple[int, int], special: Iterable[tuple[Branch, SpecialPoint, tuple[int, int]]]
) -> bool:
    """Whether a point where two pieces meet is one of the special points."""
    return any(
        (other.kind, {*meets}) == (point.kind, {*pieces}) and np.isclose(other.value, point.value, _NEAR, _NEAR)
        for _, other, meets in special
    )


def _is_same(point: BranchPoint, other: BranchPoint) -> bool:
    """Whether two points of branches at one value of the field are one equilibrium under dead loads."""
    paths = point.path, other.path
    return not any(isinstance(path, Shape) for path in paths) and same_equilibrium(point.problem, *paths)
