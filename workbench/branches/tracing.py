"""All equilibria over an axis, joined by following each of them through its folds, under dead loads or with held ends.

At each value all equilibria are computed. Each that lies on no branch yet is followed over the whole axis (`follow`),
and the branch claims the equilibria at the other values that it passes. So branches, folds and the values between are
those of one curve, however coarse the axis; and none is followed twice.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from solver import Branch, Case, InputError, Solution, equilibria, follow, solve
from solver.equilibria import Equilibrium
from solver.equilibrium.charts import same_equilibrium
from solver.equilibrium_branch import HELIX, SpecialPoint
from solver.follow import MOST
from solver.levels.line_point import LinePoint, path_of
from solver.problem.case import PAIRS
from solver.problem.case_fields import with_field
from solver.problem.reduced import EndsProblem, reduce
from studies.language.case_input import with_fields

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


def trace_branches(
    case: Case, name: str, values: list[float], stations: int, step: Callable[[float], None], until: float = np.inf
) -> Traced:
    """The equilibria at each value of one field, and the branches on which they lie.

    step: called with each value before it is solved. until: by `time.monotonic`; no further branch is followed then.
    """
    low, high = min(values), max(values)
    listed, owner = [], list[list[tuple[int, int] | None]]()
    for value in values:
        step(value)
        listed.append(list(equilibria(with_field(case, name, value), stations=stations)))
        owner.append([None] * len(listed[-1]))
    curves, remarks = list[Branch](), list[str]()
    passed = np.union1d(values, np.linspace(low, high, FINE))
    for k, members in enumerate(listed):
        for i, equilibrium in reversed([*enumerate(members)]):  # those of few bends take longest
            if owner[k][i] is None and time.monotonic() < until:
                try:
                    branch = follow(equilibrium.solution, points=MOST, **{name: passed})
                except InputError as error:
                    remarks.append(f"{name} = {values[k]:.6g}: {error}")
                    continue
                owner[k][i] = (len(curves), branch.start)
                _claim(listed, owner, branch, len(curves), values)
                curves.append(branch)
                remarks += [
                    f"{name} = {end.value:.6g}: {end.reason}" for end in (branch.begin, branch.end)
                    if end.value not in (low, high)
                ]  # fmt: skip
    return number_pieces(listed, owner, curves, remarks)


def _claim(
    listed: list[list[Equilibrium]], owner: list[list[tuple[int, int] | None]], branch: Branch, curve: int,
    values: list[float],
) -> None:  # fmt: skip
    """Mark the equilibria on a branch."""
    position = {value: k for k, value in enumerate(values)}
    for at, point in enumerate(branch.points):
        k = position.get(point.value)
        if k is None:
            continue
        problem = reduce(point.case)
        assert isinstance(problem, EndsProblem)
        place = LinePoint(problem)
        for i, equilibrium in enumerate(listed[k]):
            if owner[k][i] is None and same_equilibrium(place, path_of(equilibrium.path, 0), point.path):
                owner[k][i] = (curve, at)


def number_pieces(
    found: list[list[Equilibrium]], owner: list[list[tuple[int, int] | None]], curves: list[Branch], remarks: list[str]
) -> Traced:
    """The pieces in the order in which their equilibria appear; those without any come last."""
    cuts = [
        [0, *(point.position for point in curve.special if point.kind != HELIX), len(curve) - 1] for curve in curves
    ]
    spans = {(c, j): span for c, cut in enumerate(cuts) for j, span in enumerate(pairwise(cut))}

    def piece_of(curve: int, at: int) -> tuple[int, int]:
        return curve, int(np.searchsorted(cuts[curve][1:-1], at, side="right"))

    order = dict.fromkeys(piece_of(*place) for row in owner for place in row if place is not None)
    number = {key: n for n, key in enumerate([*order, *(key for key in spans if key not in order)])}
    pieces = [Piece(n, key[0], *spans[key]) for key, n in number.items()]
    branch = [[-1 if place is None else number[piece_of(*place)] for place in row] for row in owner]
    special = [
        (curve, point, (number[c, j], number[c, j + 1]))
        for c, curve in enumerate(curves)
        for j, point in enumerate(point for point in curve.special if point.kind != HELIX)
    ]
    for c, curve in enumerate(curves):
        ends = [point for point in curve.special if point.kind == HELIX]
        special += [(curve, end, (number[piece_of(c, end.position)],) * 2) for end in ends]
    return Traced(found, branch, curves, pieces, special, remarks)


PARTNER = {held: field for field, held in PAIRS}  # height -> FZ
_NEAR = 1e-6  # between the loads of one equilibrium, relative


def trace_held(case: Case, name: str, values: list[float], stations: int, step: Callable[[float], None]) -> Traced:
    """The branches over a held field on which the equilibria of a case under dead loads lie.

    Each of these is also one with its own height held, so it is a start. Other branches, which no start lies on, are
    not found.

    step: called with each value of the field before the branch from it is followed. Raises `InputError` for a value
    that no rod of that length reaches.
    """
    for value in (values[0], values[-1]):
        with_fields(case, {name: value})
    starts = list(equilibria(case, stations=stations))
    begins = [own_value(start.solution, name) for start in starts]
    passed = np.union1d([*values, *begins], np.linspace(values[0], values[-1], FINE))
    curves, remarks, known = list[Branch](), list[str](), [False] * len(starts)
    for i, start in enumerate(starts):
        if known[i]:
            continue
        step(begins[i])
        try:
            held = solve(with_fields(case, {name: begins[i]}), seed=start.solution, stations=stations)
            branch = follow(held, points=MOST, **{name: passed})
        except InputError as error:
            remarks.append(f"{name} = {begins[i]:.6g}: {error}")
            continue
        curves.append(branch)
        known = [
            lies or _lies_on(branch, other, begins[k])
            for k, (lies, other) in enumerate(zip(known, starts, strict=True))
        ]
        ends = float(passed[0]), float(passed[-1])
        remarks += [
            f"{name} = {end.value:.6g}: {end.reason}" for end in (branch.begin, branch.end) if end.value not in ends
        ]
    empty = [list[Equilibrium]() for _ in values]
    return number_pieces(empty, [[] for _ in values], curves, remarks)


def own_value(solution: Solution, name: str) -> float:
    """The value of a displacement or an end moment that a solution has."""
    if name in ("M10", "M1L"):
        return float(solution.M1[0 if name == "M10" else -1])
    along = {"height": solution.z, "azimuth": solution.alpha, "rotation": solution.gamma}[name]
    return float(along[-1] - along[0])


def _lies_on(branch: Branch, equilibrium: Equilibrium, value: float) -> bool:
    """Whether a branch passes an equilibrium under dead loads."""
    problem = equilibrium.solution.problem
    for point in branch.points:
        if point.value == value:
            pairs = [(getattr(point.problem, load)[0], getattr(problem, load)[0]) for load in ("lam", "mu", "phi")]
            near = all(abs(a - b) < _NEAR * (1 + abs(b)) for a, b in pairs)
            if near and same_equilibrium(LinePoint(point.problem), path_of(equilibrium.path, 0), point.path):
                return True
    return False
