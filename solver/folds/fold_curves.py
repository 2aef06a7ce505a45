"""Fold curves over two fields of an ends problem: where equilibria appear and disappear."""

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Booleans
from ..problem.case import Case
from ..problem.errors import InputError
from .curve_crossings import change_along
from .fold_search import Curve, Searched, search_curves
from .fold_tracing import PIECES
from .parameter_plane import parameter_plane

MOST = 101  # points of the lattice along a field


@dataclass(frozen=True, eq=False)
class FoldCurve:
    """A curve on which two equilibria meet; `fold_curves` makes it.

    Attributes
    ----------
    kind : str
        "fold", or "pitchfork": where the problem has a symmetry, two equilibria split off a third.
    values : array (N, 2)
        The two fields along the curve, in their units (angles in rad).
    exact : array (N,)
        Whether the point was solved for; between two such points lies a cubic with their tangents.
    dbeta0 : array (N,)
        beta'(0) of the equilibrium there [rad/length].
    cusps : array (C, 2)
        The cusps of the curve, where three equilibria meet.
    cusp_dbeta0 : array (C,)
        beta'(0) there [rad/length].
    lower : int
        The lower Morse index of the two equilibria that meet; the other is higher by one.
    more : array (N, 2)
        A vector towards the side of two more equilibria, in shares of the two ranges.
    ends : tuple of str
        How the curve ends at either side: "border" of the rectangle, "closed", or "stopped": it could not be followed.
    """

    kind: str
    values: Array
    exact: Booleans
    dbeta0: Array
    cusps: Array
    cusp_dbeta0: Array
    lower: int
    more: Array
    ends: tuple[str, str]


@dataclass(frozen=True, eq=False)
class FoldCurves:
    """The fold and pitchfork curves in a rectangle of two fields; `fold_curves` makes them.

    Attributes
    ----------
    case : Case
        The ends problem; its own values of the two fields do not matter.
    names : tuple of str
        The two fields.
    low, high : array (2,)
        The rectangle.
    curves : list of FoldCurve
    remark : str
        Where curves may be missing or incomplete; empty if the equilibria of all points that were looked at agree with
        the curves.
    """

    case: Case
    names: tuple[str, str]
    low: Array
    high: Array
    curves: list[FoldCurve]
    remark: str
    searched: Searched

    def case_at(self, values: Any) -> Case:
        """The case at a point (2,) of the plane."""
        return self.searched.plane.case_at(self.searched.plane.shares(values))

    def indices_at(self, values: Any) -> Counter[int]:
        """How many equilibria of each Morse index exist at a point (2,), counted from the curves crossed on the way."""
        shares = self.searched.plane.shares(values)
        start = self._reference
        there = Counter(self.searched.counted.at(start).indices)
        for index, n in change_along(self.searched.pieces, start, shares).items():
            there[index] += n
        return Counter({index: n for index, n in there.items() if n})

    @cached_property
    def _reference(self) -> Array:
        """A counted point of which the curves count right most others."""
        known = self.searched.counted.known
        points = np.array(list(known))[:: max(1, len(known) // 60)]
        alike = []
        for point in points[:10]:
            base = Counter(known[tuple(point)].indices)
            right = 0
            for other in points:
                change = Counter(base)
                change.update(change_along(self.searched.pieces, point, other))
                right += {k: n for k, n in change.items() if n} == dict(known[tuple(other)].indices)
            alike.append(right)
        return np.asarray(points[int(np.argmax(alike))])


def fold_curves(case: Case, *, lattice: int = 9, **ranges: Any) -> FoldCurves:
    """All fold curves that cross a rectangle of two fields, under dead loads.

    On a lattice of points all equilibria are counted by their Morse index. Between two neighbours whose numbers differ
    a point of a curve is found, and the curve is traced from it both ways, until the curves explain every difference. A
    closed curve that lies between the lines of the lattice is not found, nor are two curves that cross the same lines
    next to each other and undo each other's change, unless one of thirty further points lies between; a finer lattice
    finds them.

    Parameters
    ----------
    case : Case
        A single ends problem.
    lattice : int
        Points of the lattice along each field, 2 to 101.
    **ranges
        Two numeric fields of rod, cylinder or ends with their ranges, such as ``FZ=(-10, 10)`` and ``betaL=("-90deg",
        "90deg")``.

    Returns
    -------
    FoldCurves

    Raises
    ------
    InputError
        For a start problem, a grid of cases, an unknown field, a range that is not two finite numbers, the first lower,
        and values in it that no case has.

    Examples
    --------
    >>> from solver import Case, Cylinder, Ends, Rod, fold_curves
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=3.0)
    >>> case = Case(rod, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8))
    >>> (curve,) = fold_curves(case, FZ=(-60, -20), L=(1.5, 3), lattice=3).curves
    >>> curve.kind, curve.lower, curve.cusps.round(6).tolist()
    ('fold', 0, [[-55.891532, 2.293935]])
    """
    plane = parameter_plane(case, ranges)
    if not 2 <= lattice <= MOST or lattice != int(lattice):
        raise InputError(f"lattice must be a whole number from 2 to {MOST}, got {lattice!r}")
    searched = search_curves(plane, int(lattice))
    curves = [_fold_curve(searched, curve) for curve in searched.curves]
    return FoldCurves(case, plane.names, plane.low, plane.high, curves, _remark(searched), searched)


def _fold_curve(searched: Searched, curve: Curve) -> FoldCurve:
    """A traced curve in the units of its case."""
    plane = searched.plane
    line, more = curve.dense()
    slopes, cusps, turned = [], [], []
    for trace in curve.stretches:
        slope = [trace.system.start_rate(point.x) for point in trace.points]
        fine = np.arange(PIECES * (len(slope) - 1) + 1) / PIECES
        slopes.append(np.interp(fine, np.arange(len(slope)), slope))
        cusps += [trace.points[i].shares for i in trace.cusps]
        turned += [slope[i] for i in trace.cusps]
    rho = np.broadcast_to(plane.case_at(line).rho, line.shape[:1])
    dense = np.concatenate(slopes) / rho
    cusps_at = np.array(cusps).reshape(-1, 2)
    at_cusps = np.array(turned) / np.broadcast_to(plane.case_at(cusps_at).rho, len(cusps)) if cusps else np.zeros(0)
    return FoldCurve(
        curve.kind,
        plane.values(line),
        curve.exact,
        dense,
        plane.values(cusps_at),
        at_cusps,
        curve.lower,
        more,
        curve.ends,
    )


def _remark(searched: Searched) -> str:
    """Where the curves may be incomplete, or nothing."""
    said = []
    stopped = sum("stopped" in curve.ends for curve in searched.curves)
    if stopped:
        said.append(f"{stopped} of {len(searched.curves)} curves could not be followed to the border")
    if searched.open_lines:
        said.append(f"on {len(searched.open_lines)} lines of the lattice the numbers change where no curve was found")
    incomplete = sum(not one.complete for one in searched.counted.known.values())
    if incomplete:
        said.append(f"at {incomplete} of {len(searched.counted.known)} points the equilibria may be incomplete")
    return "; ".join(said)
