"""The rod of one stored case as a scene draws it: its curve, the part that is drawn, its colours. No OpenGL."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from solver.numerics.roots import largest_between
from solver.orbits import frames
from solver.problem.declared_fields import VARY_LOADS
from solver.problem.errors import InputError

from ..geometry import centreline, solid_body, varying_lines
from ..geometry.centreline import Array, Centreline
from ..geometry.lines import TALLEST
from ..geometry.tube_tolerance import COLOUR_STEPS, MOST_TRIANGLES, Rings, rings, stations_for
from ..stored.centrelines import VARIES
from ..stored.quantity_variables import SECTION
from ..stored.solved_again import POINT_FORCES
from ..stored.stored_study import StoredStudy
from .scene_kinds import Paint, SceneKind

STRIPE = 3  # one side in so many is painted
ARROW = 1.4  # radii of the cylinder: the length of the arrow of the largest force
SEEN = 0.05  # radii of the rod: a smaller gap is not seen
MOST_EDGES = 24  # of contacts of a rod, beyond which marks of them would hide it


@dataclass(frozen=True, eq=False)
class Body:
    """A rod to be drawn.

    Attributes
    ----------
    span
        The arc lengths between which it is drawn [length].
    value_of
        What its colour shows at s (`SceneKind.value_in`), None for one colour.
    gamma
        The section's rotation at the stations, (n,) [rad], where a stripe shows it.
    caution
        What a real rod could not do, as `caution_words` writes it.
    lift
        By how much it is drawn farther from the axis than it is [length], to set rods apart.
    squeeze
        The factor of its heights in the drawing, less than 1 for a rod that is compressed along the axis.
    point_forces
        The arc length of each point force of the wall, its size and the error of that.
    """

    line: Centreline
    span: tuple[float, float]
    value_of: Callable[[Centreline, Array], Array] | None = None
    gamma: Array | None = None
    caution: str = ""
    lift: float = 0.0
    squeeze: float = 1.0
    point_forces: Sequence[tuple[float, float, float]] = ()
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
        return max(self.line.R, self.line.reach + self.line.a + self.lift)

    @cached_property
    def _sampled(self) -> tuple[Array, Array]:
        inside = self.line.s[(self.line.s > self.span[0]) & (self.line.s < self.span[1])]
        s = np.concatenate([[self.span[0]], inside, [self.span[1]]])
        alpha, _, z = self.line.at(s)
        # with far too few stations the curve may go too far; the rod is not stretched, which bounds z
        return alpha, self.squeeze * np.clip(z - z[0], s[0] - s, s - s[0])

    @property
    def alpha(self) -> Array:
        """Azimuth where the rod is drawn, at the stations, (k,) [rad]."""
        return self._sampled[0]

    @property
    def z(self) -> Array:
        """Height there, from where the drawing begins, (k,) [length]."""
        return self._sampled[1]

    def value(self, s: Array) -> Array:
        """What the colour shows at s, (k,)."""
        assert self.value_of is not None
        return self.value_of(self.line, s)

    def extremes(self) -> tuple[float, float]:
        """Least and largest value where the rod is drawn, between its stations too."""
        s = np.linspace(*self.span, max(4 * self.alpha.size, 400))
        values = self.value(s)
        low, high = float(values.min()), float(values.max())
        rise, fall = largest_between(lambda s: np.array([1, -1])[:, None] * (self.value(s) - [[low], [high]]), s)[0]
        return float(high - fall), float(low + rise)

    def stripe_angle(self) -> Any:
        """The angle of the stripe about the tangent as a function of s, from the outward normal; None without one."""
        return None if self.gamma is None else CubicSpline(self.line.s, -self.gamma)

    def places(self, s: Array) -> Array:
        """The centreline where it is drawn, (k, 3) [length]; heights are from where the drawing begins."""
        place, _, out, _ = self.line.frame(s)
        return self._place_on_page(place + self.lift * out)

    def _place_on_page(self, place: Array) -> Array:
        """Places where they are drawn: heights are from where the drawing begins, and squeezed."""
        return (place - [0, 0, self.line.at(np.array(self.span[:1]))[2][0]]) * [1, 1, self.squeeze]

    @cached_property
    def dense(self) -> Array:
        """The centreline where it is drawn, four places for each station, (n, 3) [length]."""
        return self.places(np.linspace(*self.span, 4 * self.alpha.size))

    @cached_property
    def crossings(self) -> list[Array]:
        """Where the rod passes through itself, (3,) each [length]; heights are from where the drawing begins."""
        return [self._place_on_page(place) for place in solid_body.middles(self.line, self.span)]

    @cached_property
    def widest_gap(self) -> Array | None:
        """The shortest line from the wall to the rod where it is farthest off, its two ends, (2, 3); None on the wall.

        Heights are from where the drawing begins.
        """
        if not isinstance(self.line, varying_lines.FreeLine):
            return None
        s = np.linspace(*self.span, 4 * self.alpha.size)
        place = self.line.frame(s)[0]
        radius, sign = np.hypot(place[:, 0], place[:, 1]), -1.0 if self.side == "inside" else 1.0
        gap = sign * (radius - self.line.rho)
        k = int(np.argmax(gap))
        if gap[k] < SEEN * self.a:
            return None
        away = frames.outward(self.line.at(s[[k]])[0])[0]  # a place on the axis has no direction of its own
        ends = np.array([self.R, radius[k] - sign * self.a])[:, None] * away
        return self._place_on_page(ends + np.array([0.0, 0.0, place[k, 2]]))

    @cached_property
    def pushes(self) -> list[tuple[Array, Array, float, float]]:
        """Point forces of the wall on the rod: where each acts on its surface, (3,), its direction, its size, and the
        error of that."""
        each = []
        for s, force, error in self.point_forces:
            if self.span[0] <= s <= self.span[1]:
                place, radial = self.line.frame(np.array([s]))[0][0], frames.outward(self.line.at(np.array([s]))[0])[0]
                away = radial if self.side == "outside" else -radial
                each.append((self._place_on_page(place + self.a * away), away, force, error))
        return each

    @cached_property
    def contact_edges(self) -> list[tuple[Array, Array]]:
        """Where contacts begin and end without a point force, whose arrow marks its edge: the place on the centreline,
        and the direction of that as it is drawn, (3,)."""
        if not isinstance(self.line, varying_lines.FreeLine):
            return []
        s = varying_lines.contact_edges(self.line.s, self.line.push(self.line.s))
        if s.size > MOST_EDGES:
            return []
        for at, *_ in self.point_forces:
            s = s[np.abs(s - at) > self.line.L / (self.line.s.size - 1)]
        s = s[(s > self.span[0]) & (s < self.span[1])]
        return [*zip(self.places(s), self.line.frame(s)[1] * [1, 1, self.squeeze], strict=True)]

    @property
    def _colour_step(self) -> float:
        """By how much what the colour shows may be off."""
        return (self.paint.high - self.paint.low) / COLOUR_STEPS

    def stations_for(self, tolerance: float) -> int:
        """About how many stations it takes to draw the rod to a tolerance [length], and in its true colours."""
        return stations_for(self.line, tolerance, self._shown, self._colour_step)

    @property
    def has_true_colours(self) -> bool:
        """Whether the stations are enough for what the colour shows."""
        return stations_for(self.line, np.inf, self._shown, self._colour_step) == self.line.s.size

    @property
    def _shown(self) -> Callable[[Centreline, Array], Array] | None:
        return self.value_of if self.paint.ramp is not None else None

    def rings(self, tolerance: float, colour_length: float, most: int = MOST_TRIANGLES) -> Rings:
        """Rings and sides for a tolerance [length]; colours are true on intervals longer than `colour_length`.

        most: triangles. Raises `InputError` for a rod that takes more.
        """
        scale = (self.paint.high - self.paint.low) or 1.0
        multiple = 2 * STRIPE if self.paint.stripe else 2
        colour = (lambda s: self.value(s) / scale) if self._shown else None
        return rings(self.line, self.span, tolerance, self.stripe_angle(), colour, colour_length, multiple, most)


def read(
    stored: StoredStudy, where: Mapping[str, int], kind: SceneKind, span: tuple[float, float] | None = None
) -> Body:
    """The rod of one case, by its indices along the axes; only what the kind reads is opened.

    span: the arc lengths between which it is drawn; default: the whole rod. Raises `InputError` where the case has no
    shape, or the dataset lacks what the kind needs.
    """
    reads = {name for name in kind.reads if name in stored}
    for name in sorted(kind.reads - set(centreline.NEEDED)):
        if name not in stored:
            raise InputError(f"the dataset stores no {name}, which the kind {kind.name} needs: add it to outputs")
    also = {name for name in ("solved", "outcome", "caution", "dbeta", *SECTION) if name in stored}
    if stored.leaves or any(name in stored for name in VARY_LOADS):
        also |= {name for name in VARIES if name in stored}
    variables = stored.only(sorted(reads | also))
    this = variables.select(dict(where))
    line = this.centreline
    gamma = np.asarray(this["gamma"], dtype=float) if "gamma" in kind.reads else None
    caution = str(this["caution"].values) if "caution" in this else ""
    forces = list[tuple[float, float, float]]()
    if POINT_FORCES[0] in stored:
        each = [stored[name].isel(dict(where)).values.tolist() for name in POINT_FORCES]
        forces = [row for row in zip(*each, strict=True) if np.isfinite(row[0])]
    if isinstance(line, varying_lines.FreeLine):
        line = replace(line, edges=np.array([s for s, *_ in forces]))
    low, high = span or (float(line.s[0]), inf)
    drawn = low, (high if high < inf else float(line.s[-1]))
    return Body(line, drawn, kind.value_in(stored.units), gamma, caution, point_forces=forces)


def of_case(
    stored: StoredStudy, where: Mapping[str, int], kind: SceneKind, span: tuple[float, float] | None = None
) -> tuple[Body | None, str]:
    """The rod of a case, or why there is none. Raises `InputError` for a part that is not on the rod."""
    if not stored["solved"].isel(dict(where)):
        return None, str(stored["outcome"].isel(dict(where)).values)
    body = read(stored, where, kind, span)
    if span and not 0 <= span[0] < body.span[1] <= body.line.L * (1 + 1e-9):
        raise InputError(
            f"no part from {span[0]:g} to {body.span[1]:g} on a rod of length {body.line.L:g}: give --from and "
            "--to with 0 <= from < to <= L"
        )
    return body, ""


def part_in_view(body: Body, last: bool = False) -> Body:
    """The rod, or its beginning or last part that is no taller than `TALLEST` diameters of the cylinder."""
    low, high = body.span
    length = TALLEST * 2 * body.reach / body.squeeze
    if np.ptp(body.z) <= length * body.squeeze:
        return body
    return replace(body, span=(high - length, high) if last else (low, low + length))
