"""The rod of one stored case as it is drawn: its curve, how it is painted, and the tube about it. No OpenGL."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from solver.mechanics.contact import push_from
from solver.problem.errors import InputError

from ..figures import style
from ..scene.kinds import Kind
from . import centreline
from .centreline import Array, Centreline
from .refinement import Detail, detail

TALLEST = 30.0  # diameters of the cylinder; beyond, the rod would be a hair
STRIPE = 3  # one side in so many is painted


@dataclass(frozen=True, eq=False)
class Paint:
    """The colour of a tube: one for all, or by a value along it between `low` and `high`, and below `low` another."""

    colour: str = style.PUSHED
    ramp: Any = None
    low: float = 0.0
    high: float = 1.0
    below: str = ""
    stripe: str = ""  # the colour of a stripe that turns with the material


@dataclass(frozen=True, eq=False)
class Body:
    """A rod to be drawn between two arc lengths, `span`.

    tint: the name of what is shown in colour. gamma: the section's rotation at the stations, where a stripe shows it.
    caution: what a real rod could not do, as `cautions` has it.
    """

    line: Centreline
    span: tuple[float, float]
    tint: str
    gamma: Array | None = None
    caution: str = ""
    paint: Paint = field(default_factory=Paint)

    @property
    def a(self) -> float:
        return self.line.a

    @property
    def R(self) -> float:
        return self.line.R

    @property
    def side(self) -> str:
        return self.line.side

    @property
    def whole(self) -> bool:
        """Whether all of the rod is drawn."""
        return self.span[1] - self.span[0] >= self.line.L * (1 - 1e-9)

    @property
    def reach(self) -> float:
        """The largest distance from the axis of the rod and the cylinder."""
        return max(self.line.R, self.line.rho + self.line.a)

    @cached_property
    def _sampled(self) -> tuple[Array, Array]:
        inside = self.line.s[(self.line.s > self.span[0]) & (self.line.s < self.span[1])]
        s = np.concatenate([[self.span[0]], inside, [self.span[1]]])
        alpha, _, z = self.line.at(s)
        # between stations that are far too few the curve goes anywhere; the rod does not, as it is not stretched
        return alpha, np.clip(z - z[0], s[0] - s, s - s[0])

    @property
    def alpha(self) -> Array:
        """Azimuth where the rod is drawn, at the stations, (k,) [rad]."""
        return self._sampled[0]

    @property
    def z(self) -> Array:
        """Height there, from where the drawing begins, (k,) [length]."""
        return self._sampled[1]

    def value(self, s: Array) -> Array:
        """What the colour shows at s: push or curvature."""
        if self.tint == "contact":
            return np.asarray(push_from(self.line.contact(s), self.side))
        return self.line.kappa(s)

    def extremes(self) -> tuple[float, float]:
        """Least and largest value where the rod is drawn."""
        s = np.linspace(*self.span, max(4 * self.alpha.size, 400))
        values = self.value(s)
        return float(values.min()), float(values.max())

    def turned(self) -> Any:
        """The angle of the stripe about the tangent as a function of s, from the outward normal."""
        return None if self.gamma is None else CubicSpline(self.line.s, -self.gamma)

    def detail(self, tolerance: float, blur: float) -> Detail:
        """Rings and sides for a tolerance [length]; colours on stretches longer than `blur` are true."""
        scale = (self.paint.high - self.paint.low) or 1.0
        parts = 2 * STRIPE if self.paint.stripe else 2
        tint = (lambda s: self.value(s) / scale) if self.paint.ramp is not None else None
        return detail(self.line, self.span, tolerance, self.turned(), tint, blur, parts)


@dataclass(frozen=True, eq=False)
class Mesh:
    """A closed tube. points, normals: (m, 3); triangles: (k, 3) as indices of points; values: (m,) or None, what the
    colour shows; striped: (k,) of bool, the triangles in the stripe."""

    points: Array
    normals: Array
    triangles: NDArray[np.int64]
    values: Array | None
    striped: NDArray[np.bool_]


def read(ds: xr.Dataset, where: Mapping[str, int], kind: Kind, span: tuple[float, float] | None = None) -> Body:
    """The rod of one case, by its indices along the axes; only what the kind reads is touched.

    span: the arc lengths between which it is drawn; where left out the whole rod. Raises `InputError` where the case
    has no shape, or the dataset lacks what the kind needs.
    """
    there = {name for name in kind.reads if name in ds}
    for name in sorted(kind.reads - set(centreline.NEEDED)):
        if name not in ds:
            raise InputError(f"the dataset stores no {name}, which the kind {kind.name} needs: add it to outputs")
    also = {name for name in ("solved", "outcome", "caution", "dbeta") if name in ds}
    one = ds[sorted(there | also)]
    line = centreline.read(one, where)
    this = one.isel(dict(where))
    gamma = np.asarray(this["gamma"], dtype=float) if kind.tint == "stripe" else None
    caution = str(this["caution"].values) if "caution" in this else ""
    return Body(line, span or (float(line.s[0]), float(line.s[-1])), kind.tint, gamma, caution)


def beginning(body: Body) -> Body:
    """The rod, or as much of its beginning as can be seen well: no taller than `TALLEST` diameters of the cylinder."""
    tall = TALLEST * 2 * body.reach
    return body if np.ptp(body.z) <= tall else replace(body, span=(body.span[0], body.span[0] + tall))


def mesh(body: Body, drawn: Detail) -> Mesh:
    """The tube of radius a about the curve, closed at both ends, its corners on the true surface."""
    s, sides = drawn.s, drawn.sides
    place, along, out, across = body.line.frame(s)
    place = place - [0, 0, body.line.at(s[:1])[2][0]]
    turned = body.turned()
    angle = np.linspace(0.0, 2 * np.pi, sides, endpoint=False) + (turned(s)[:, None] if turned else 0.0)
    angle = np.broadcast_to(angle, (s.size, sides))[..., None]
    normals = np.cos(angle) * out[:, None] + np.sin(angle) * across[:, None]
    points = place[:, None] + body.a * normals
    # the flat ends have points of their own, so that their edges stay sharp
    ends = [np.concatenate([points[i], place[i][None]]) for i in (0, -1)]
    flat = [np.broadcast_to(way * along[i], (sides + 1, 3)) for i, way in ((0, -1.0), (-1, 1.0))]
    n = s.size
    index = np.arange(n * sides).reshape(n, sides)
    beside = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1], beside[:-1], beside[1:], index[1:]
    # of its two diagonals a square takes the one along which the tube turns less: the other would cut off more of it
    first = angle[:-1, 0]
    ahead = np.einsum("ij,ij->i", normals[1:, 0], np.cos(first) * across[:-1] - np.sin(first) * out[:-1]) > 0
    ahead = np.broadcast_to(ahead[:, None], (n - 1, sides))
    one = np.stack([a, np.where(ahead, d, c), b], axis=-1)
    two = np.stack([np.where(ahead, d, a), np.where(ahead, c, d), np.where(ahead, b, c)], axis=-1)
    rim = np.arange(sides)
    fan = np.stack([rim, np.roll(rim, -1), np.full(sides, sides)], axis=-1)
    triangles = [np.stack([one, two], axis=2).reshape(-1, 3), n * sides + fan, n * sides + sides + 1 + fan[:, ::-1]]
    values = None
    if body.paint.ramp is not None:
        at = body.value(s)
        values = np.concatenate([np.repeat(at, sides), np.repeat(at[[0, -1]], sides + 1)])
    painted = np.tile(np.repeat((rim + sides // (2 * STRIPE)) % sides < sides // STRIPE, 2), n - 1)
    return Mesh(
        np.concatenate([points.reshape(-1, 3), *ends]),
        np.concatenate([normals.reshape(-1, 3), *flat]),
        np.concatenate(triangles),
        values,
        np.concatenate([painted, np.zeros(2 * sides, dtype=bool)]),
    )
