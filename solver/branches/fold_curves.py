"""Fold curves over two fields of an ends problem: where equilibria appear and disappear."""

from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from ..numerics.arrays import Array, Booleans
from ..problem.case import Case
from ..problem.errors import InputError, show
from ..problem.field_values import floats_in
from .fold_lattice import Searched
from .parameter_plane import ParameterPlane
from .whole_curve import PIECES, WholeCurve, change_along, without_zeros


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
        How the curve ends at either side: "border" of the rectangle, "closed", "crossing": with weight, where another
        curve crosses and the index changes, or "stopped": it could not be followed.
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
        the curves. Under held ends it states `within` too.
    within : dict
        Under held ends, the lowest and the highest value of each reaction between which the counted equilibria were
        searched, by its name; else empty.
    """

    case: Case
    names: tuple[str, str]
    low: Array
    high: Array
    curves: list[FoldCurve]
    remark: str
    searched: Searched
    within: dict[str, tuple[float, float]] = field(default_factory=dict)

    def case_at(self, values: Any) -> Case:
        """The case at a point (2,) of the plane."""
        return self.searched.plane.case_at(self._shares(values))

    def indices_at(self, values: Any) -> Counter[int]:
        """How many equilibria of each Morse index exist at a point (2,), counted from the curves crossed on the way."""
        return self._indices_from(self._reference, self._shares(values))

    def _shares(self, values: Any) -> Array:
        """The shares of a point (2,). Raises `InputError` for what is no point."""
        point = floats_in(values)
        if point.shape != (2,) or not np.isfinite(point).all():
            raise InputError(f"a point is a value of {self.names[0]} and one of {self.names[1]}, got {show(values)}")
        return self.searched.plane.shares(point)

    @cached_property
    def _reference(self) -> Array:
        """A counted point of which the curves count right most others."""
        known = self.searched.counted
        points = np.array(list(known))[:: max(1, len(known) // 60)]

        def alike(point: Array) -> int:
            return sum(self._indices_from(point, other) == known[tuple(other)].indices for other in points)

        return np.asarray(max(points[:10], key=alike))

    def _indices_from(self, start: Array, end: Array) -> Counter[int]:
        """How many equilibria of each index exist at a point, counted from another one."""
        indices = Counter(self.searched.at(start).indices)
        indices.update(change_along(self.searched.pieces, start, end))
        return without_zeros(indices)


def curves_of(searched: Searched, remark: str | None = None) -> FoldCurves:
    """What a search found, in the units of the case. remark: default: where the equilibria do not fit the curves."""
    plane = searched.plane
    curves = [fold_curve(plane, curve) for curve in searched.curves]
    said = _remark(searched) if remark is None else remark
    return FoldCurves(plane.case, plane.names, plane.low, plane.high, curves, said, searched)


def fold_curve(plane: ParameterPlane, curve: WholeCurve) -> FoldCurve:
    """A traced curve in the units of its case."""
    line, more = curve.dense()
    at, cusps = np.arange(len(line)) / PIECES, curve.cusps
    rho = np.broadcast_to(plane.case_at(line).rho, len(line))
    return FoldCurve(
        curve.kind,
        plane.values(line),
        curve.exact,
        np.interp(at, np.arange(len(curve.dbeta0)), curve.dbeta0) / rho,
        plane.values(curve.z[cusps]),
        curve.dbeta0[cusps] / rho[PIECES * cusps],
        curve.lower,
        more,
        curve.ends,
    )


def said_of_stopped(searched: Searched) -> list[str]:
    """A sentence on curves that could not be followed, where there are any."""
    stopped = sum("stopped" in curve.ends for curve in searched.curves)
    return [f"{stopped} of {len(searched.curves)} curves could not be followed to the border"] * bool(stopped)


def _remark(searched: Searched) -> str:
    """Where the curves may be incomplete, or nothing."""
    said = said_of_stopped(searched)
    if searched.open_lines:
        lines = f"{len(searched.open_lines)} line{'s' * (len(searched.open_lines) > 1)}"
        said.append(f"on {lines} of the lattice the numbers change where no curve was found")
    incomplete = sum(not count.complete for count in searched.counted.values())
    if incomplete:
        said.append(f"at {incomplete} of {len(searched.counted)} points the equilibria may be incomplete")
    return "; ".join(said)
