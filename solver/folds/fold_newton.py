"""Newton's rule for points of fold and pitchfork curves and for cusps, and the tangents of the curves."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..numerics.arclength import FOLD, PITCHFORK
from ..numerics.arrays import Array
from ..numerics.roots import null_vector, root
from .fold_system import expansion, is_deep, reach_of, turns_at
from .parameter_plane import MARGIN, ParameterPlane

_LONGEST = 0.5  # change of an unknown in a step of Newton's rule
_UNFOLDED = 1e-8  # rad: the largest change of beta(L) at which a point counts as a pitchfork
_STRAYS = 1e-4  # of that change along the curve, in units of its length


@dataclass(frozen=True, eq=False)
class CurvePoint:
    """A point of a curve.

    x: (v / scale, u, w), u and w the shares of the two fields; of a pitchfork curve with the change e of beta(L) as a
    fourth. tangent: of the same size, of length 1. bend: d^2B/dv^2 at a fold, d^3B/dv^3 at a pitchfork. more: (2,),
    towards the side, in the plane of shares, where two more equilibria exist.
    """

    x: Array
    tangent: Array
    bend: float
    more: Array

    @property
    def shares(self) -> Array:
        return self.x[1:3]


class CurveSystem(Protocol):
    """The equations of one curve in a plane of fields, FOLD or PITCHFORK; scale: unit of beta_t(0)."""

    @property
    def plane(self) -> ParameterPlane: ...

    @property
    def kind(self) -> str: ...

    @property
    def scale(self) -> float: ...

    @property
    def size(self) -> int:
        """The number of unknowns."""
        ...

    def equations(self, x: Array) -> tuple[Array, Array, float, Array]:
        """Values, derivatives, `bend` and `more` (as of `CurvePoint`) at x."""
        ...

    def leaves(self, x: Array) -> bool:
        """Whether other equations suit the curve better from x on."""
        ...

    def start_rate(self, x: Array) -> float:
        """beta_t(0) at x."""
        ...


def correct(system: CurveSystem, x: Array, row: Array, value: float) -> CurvePoint | None:
    """The point of the curve near x at which row . x = value; None where Newton's rule does not converge."""
    last: list[tuple[Array, Array, float, Array]] = []

    def equations(x: Array) -> tuple[Array, Array] | None:
        if not _is_inside(x):
            return None
        last[:] = [system.equations(x)]
        return np.append(last[0][0], row @ x - value), np.vstack([last[0][1], row])

    found = root(equations, x, _LONGEST)
    if found is None:
        return None
    _, rates, bend, more = last[0]
    return CurvePoint(found, tangent_of(rates, row), bend, more)


def _is_inside(x: Array) -> bool:
    return bool(np.abs(x[1:3] - 0.5).max() <= 0.5 + MARGIN)


@dataclass(frozen=True)
class FoldSystem:
    """The equations in v = beta_t(0), in units of `scale`, and the two shares; kind: FOLD or PITCHFORK."""

    plane: ParameterPlane
    kind: str
    scale: float

    @property
    def size(self) -> int:
        return 3 if self.kind == FOLD else 4

    def equations(self, x: Array) -> tuple[Array, Array, float, Array]:
        """Values, derivatives, `bend` and `more` (as of `CurvePoint`) at x."""
        a, p = self._expansion(x)
        if self.kind == FOLD:
            values = a[:2].copy()
            rates = np.array([[a[1], *p[:, 0]], [a[2], *p[:, 1]]])
            return values, rates, float(a[2]), -p[:, 0] * np.sign(a[2])
        values = a[:3] - np.array([x[3], 0, 0])
        rates = np.array([[a[1], *p[:, 0], -1], [a[2], *p[:, 1], 0], [a[3], *p[:, 2], 0]])
        return values, rates, float(a[3]), -p[:, 1] * np.sign(a[3])

    def cusp(self, x: Array) -> Array | None:
        """The cusp of a fold curve near x."""

        def equations(x: Array) -> tuple[Array, Array] | None:
            if not _is_inside(x):
                return None
            a, p = self._expansion(x)
            return a[:3], np.column_stack([a[1:4], p[:, :3].T])

        return root(equations, x, _LONGEST)

    def _expansion(self, x: Array) -> tuple[Array, Array]:
        """The derivatives of B by v, (4,), and of these by the shares, (2, 4), in units of `scale`."""
        v, shares = float(x[0]) * self.scale, x[1:3]
        found = expansion(self.plane, v, shares, reach_of(self.plane, v, shares))
        return found.along * self.scale ** np.arange(4), found.across * self.scale ** np.arange(4)

    def leaves(self, x: Array) -> bool:
        return is_deep(self.plane, float(x[0]) * self.scale, x[1:3])

    def start_rate(self, x: Array) -> float:
        return float(x[0]) * self.scale

    def has_index(self, point: CurvePoint, lower: int) -> bool:
        """Whether two equilibria of index lower and lower + 1 meet in the point of a fold: at turning points of beta
        the Jacobi field has a zero between each two, and it begins and ends with one."""
        v = float(point.x[0]) * self.scale
        return self.kind == PITCHFORK or turns_at(self.plane, v, point.shares) == lower + 1

    def is_true(self, point: CurvePoint) -> bool:
        """Whether the point belongs to the problem itself: a pitchfork on a curve of e = 0, a fold that moves with the
        fields. Where e changes along the curve the fields break the symmetry, and folds meet in a cusp there."""
        if self.kind == PITCHFORK:
            return bool(abs(point.x[3]) < _UNFOLDED and abs(point.tangent[3]) < _STRAYS)
        return bool(np.abs(point.more).max() > 1e-6)


def tangent_of(rates: Array, along: Array) -> Array:
    """The direction in which the equations hold, of length 1, on the side of `along`."""
    direction = null_vector(rates)
    return np.asarray(direction if direction @ along >= 0 else -direction)
