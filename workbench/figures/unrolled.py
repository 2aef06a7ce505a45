"""Unrolled views: the cylinder is cut open and laid flat, and the rods lie on it in rows, all at one scale.

z is to the right and the distance around the cylinder down, as one sees it from outside. A rod a thousand times as long
as it is wide is a hair at one scale: one such rod is set in lines, as text is, several have one direction drawn larger.

Of a rod in lines each line continues the one above it and shows the whole unrolled cylinder, or as much of its width as
the rod needs. A rod that leaves a line below comes back above, as it goes about the axis.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import floor, log10
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.transforms import Affine2D, ScaledTranslation, Transform
from numpy.typing import NDArray

from solver.orbits import frames

from ..geometry import lines, solid_body, varying_lines
from ..stored.stored_study import StoredStudy
from ..words import caution_words, labels
from . import arrangement, canvas, colours, crossing_rings, drawn_rods, fonts, push_scale, waves
from .arrangement import Arrangement
from .axis_scales import round_below
from .drawn_rods import DrawnRod, DrawnRods
from .halo import Halo
from .sheet import SCREEN, Sheet

NAMES = ("alpha", "z", "push")
TALLEST, EACH = 0.78, 0.6  # the height of all views of a figure as a share of its width; inches of each on a narrow one
STRIPS, LEAST_STRIP = (0.75, 0.42), 0.9  # height over a narrow and another width of a sheet; inches in print at least
LABELS = 0.35  # inches below and above views in a panel
BESIDE, BELOW, LEGEND = 0.5, 0.15, 0.25  # inches of a figure beside views, below them, and of a legend of rings
WORDS, ABOVE = 1.3 / 72, 0.06  # inches of a line of words per point of its size; from the words to their view
CROSS = 0.09  # inches from the words to the middle of a cross behind them
HANGING = 0.236  # of the size of letters, by which those such as p hang below their line
SMALLEST = 0.1  # inches of the largest view
WORTH = 1.7  # a scale so many times larger is worth another row of a list
HAIRLINE, TINY = 1.1 / 72, 1e-12  # inches of the width of a line; no length
LEAST, FLAT = 0.12, 1 / 25  # inches of a view, and share of its other direction, below which one is drawn larger
TOUCH = 2  # stations on the wall at most, where a rod touches it at one place
STRAIGHT = 1e-9  # of the other extent: less is rounding, which no scale shows
SLENDER, UPRIGHT = 0.25, 3.0  # of rods that fill so little of the width, inches of all upwards at most
REACH = 2.0  # radii of the rod between a ring and its line at most: two stretches overlap within one radius of it
NEAR = 3.0  # radii of the rod on the unrolled cylinder: two places that are nearer have one ring between them
BEGINNING: dict[str, Any] = {"color": colours.INK, "markersize": 2.0, "markeredgewidth": 0, "zorder": 6}
BARRED: dict[str, Any] = {"color": colours.INK, "markersize": 4.0, "markeredgewidth": 0.8}
ARROW, FOOT = 0.45, 0.55  # inches of the arrows of the key at most, and of all of it downwards
BAR, BAR_GAP = 0.3, 0.3  # inches of the bar of colours per point of its words, and between the key and the bar
VIEWS = "unrolled views"  # the label of their axes
AROUND = (
    "A rod that winds more than once around the unrolled cylinder leaves it at one edge, and comes back at the other."
)
THROUGH = "the rod passes through itself at its true thickness"
TIGHT = ", also in a bend tighter than its radius"  # where a place is one
TURNED = ", also after a turn around the cylinder"  # where a place has two rings
CLOSE = "; one ring where several would touch"
TOO_LONG = "is too long to search for the places where it passes through itself"
# of a rod in lines
THINNEST = 0.07  # inches of a line; below, nothing of its curve is seen
TALLEST_LINES = 0.5, 2.8  # height of all lines as a share of the width, and inches at least
HEADS = 0.7  # inches before the lines
HAIR = 0.3  # inches: a rod less wide is a hair
MOST_WIDE = 1.15  # of the width that the rod needs is that of a line
EDGES = "A tick marks where a contact along a length begins or ends; touches at a point have none."
TICK, MOST_EDGES = 0.05, 100  # inches of half a tick; ticks of a rod, beyond which they would hide it
DENSE = 4  # places for each station, so that a rod leaves a line at its edge

Values = NDArray[np.float64]


class Crossing(NamedTuple):
    """A place where a rod passes through itself on the unrolled cylinder, (2,) each [length].

    place: z and distance around. apart: how far its two stretches are apart; NaN where it comes back after a turn.
    bend: whether it is a bend tighter than the radius of the rod, for which `apart` is the diameter of the rod.
    """

    place: Any
    apart: Values
    bend: bool = False


@dataclass(frozen=True, eq=False)
class UnrolledView:
    """An unrolled view.

    x, y: z and the distance around the cylinder, (n,) each [length]; none of a rod that is not solved, whose name says
    so. text: above it. look: of its line; or its push and the scale of its colours. rings: as of `crossings`. name: of
    its line in a table; default: the first line of the text. over: x, y, look and name of further lines on the same
    cylinder. band: the distances around between which that is drawn, where the rod is in lines. begins: whether the rod
    begins here. edges: places where contacts begin and end, and directions of the rod there, (2,) each [length].
    barred: whether a cross behind the text says that no real rod could keep the shape.
    """

    x: Values
    y: Values
    text: str
    look: Mapping[str, Any]
    rings: Sequence[Crossing] = ()
    name: str = ""
    over: Sequence[tuple[Any, Any, Mapping[str, Any], str]] = ()
    band: tuple[float, float] | None = None
    begins: bool = True
    edges: Sequence[tuple[Values, Values]] = ()
    barred: bool = False

    @property
    def box(self) -> Values:
        """The least and the largest of x and of y, (2, 2) [length]; zeros without any."""
        places = np.hstack([(self.x, self.y), *((x, y) for x, y, _, _ in self.over)])
        ends = np.stack([places.min(axis=1), places.max(axis=1)]) if places.size else np.zeros((2, 2))
        return ends if self.band is None else np.column_stack([ends[:, 0], self.band])

    @property
    def size(self) -> Values:
        """Width and height [length]."""
        return np.asarray(np.ptp(self.box, axis=0))


def view_of(
    s: Values,
    rho: float,
    alpha: Values,
    z: Values,
    a: float,
    text: str,
    look: Mapping[str, Any],
    name: str = "",
    ringed: bool = True,
    radius: Any = None,
) -> tuple[UnrolledView, bool]:
    """The unrolled view of a rod, and whether it is too long to search for the places where it passes through itself.

    s, rho, alpha, z, a: of the rod, (n,) or a number [length]. text, look, name: as of `UnrolledView`. ringed: whether
    those places have rings. radius: the distance from the axis, (n,); default: rho all along.
    """
    rings = crossings(s, rho, alpha, z, a, rho if radius is None else radius) if ringed else []
    y, turn = rho * (alpha - alpha[0]), 2 * np.pi * rho
    leaves = radius is not None and bool(np.any(np.abs(radius - rho) > STRAIGHT * rho))
    if float(np.ptp(y)) <= turn or leaves or not all(_is_monotone(row) for row in (y, z)):  # its bends stay whole
        return UnrolledView(z, y, text, look, rings or [], name), rings is None
    low = 0.0 if y[-1] >= 0 else -turn * (1 - STRAIGHT)  # s = 0 is at the edge that the rod leaves from
    (z, y, look, name), *over = on_one_turn(z, y, look, name or text.partition("\n")[0], low, turn)
    placed = [ring._replace(place=(ring.place[0], low + (ring.place[1] - low) % turn)) for ring in rings or []]
    return UnrolledView(z, y, text, look, placed, name, over), rings is None


def _is_monotone(row: Values) -> bool:
    steps = np.diff(row)
    return bool((steps >= 0).all() or (steps <= 0).all())


def plan(
    views: Sequence[UnrolledView], room: tuple[float, float], letters: float, foot: tuple[float, float], even: bool
) -> Arrangement:
    """Where views and their key stand, as large as they fit in so many inches; the key is the last.

    letters: points of the texts. foot: width and height of the key. even: the views are a series, all in columns of one
    width; else each has its own width, and stands below the one before where there is room.
    """
    sizes = np.array([view.size for view in views])
    sizes[:, 0] = sizes[:, 0].max() if even else sizes[:, 0]
    wide, tall = map(float, sizes.max(axis=0))
    words = np.array([words_size(view.text, letters) + np.array([2 * CROSS * view.barred, 0.0]) for view in views])
    words[:, 1] = words[:, 1].max()
    if len(views) * wide * room[1] < SLENDER * room[0] * tall:
        room = room[0], min(room[1], UPRIGHT)
    boxes, texts = np.vstack([sizes, np.zeros(2)]), np.vstack([words, foot])

    def arrange(rows: int, columns: int) -> Arrangement:
        rows_high = room[1] - foot[1] - rows * (float(words[0, 1]) + arrangement.BETWEEN)
        cell = room[0] / columns - arrangement.GAP, rows_high / -(-len(views) // columns)
        factor = stretch(wide, tall, (max(cell[0], LEAST), max(cell[1], LEAST)))
        whole = max(wide, tall * factor) or 1.0
        layout = arrangement.flow(boxes * [1, factor], texts, room, rows, even, SMALLEST / whole)
        return replace(layout, factor=factor)

    worth = arrangement.WORTH if even else WORTH
    flat = tall / (FLAT * wide) if tall > STRAIGHT * wide > 0 else 1.0
    return arrangement.in_rows(len(boxes), arrange, len(boxes), room[0], worth, flat, ragged=not even)[1]


def plan_lines(views: Sequence[UnrolledView], room: tuple[float, float], foot: tuple[float, float]) -> Arrangement:
    """The arrangement of the lines of one rod, whose texts stand before them, and of their key, the last."""
    sizes = np.array([[view.size] for view in views])
    below = foot[1] + arrangement.BETWEEN
    layout = arrangement.arrange(sizes, np.zeros_like(sizes), (room[0], room[1] - below), pitch=lines.PITCH)
    wide, high = layout.size
    boxes = np.append(layout.boxes, [[[0.0, high + arrangement.BETWEEN, *foot]]], axis=0)
    return replace(layout, boxes=boxes, size=(wide, high + below))


def words_size(text: str, letters: float) -> tuple[float, float]:
    """Width and height of a text above a view in inches."""
    return fonts.width_of(text, letters), (text.count("\n") + 1) * WORDS * letters + ABOVE


def _draw_line(
    ax: Axes, x: Values, y: Values, look: Mapping[str, Any], name: str, where: Transform, inches: float
) -> list[str]:
    """Draw a line in the colours of the push, or in one colour; returns what is to be said of it.

    inches: of a unit of x.
    """
    if "push" in look:
        return push_scale.line(ax, x, y, **look, name=name, where=where, inches=inches)
    look = {"solid_capstyle": "round", "zorder": 3, **look, "gid": name}
    if "marker" in look:  # of points, which are no curve
        ax.plot(x, y, transform=where, **look)
        return []
    return waves.draw(ax, x, y, inches, look, where, 3.0)


def _draw_edges(ax: Axes, edges: Sequence[tuple[Values, Values]], to_page: Affine2D) -> None:
    """Draw a tick across the line of a rod at each place, by its direction there; `to_page` leads to inches."""
    for at, way in edges:
        place, ahead = to_page.transform(np.stack([at, at + way]))
        x, y = (ahead - place) * TICK / max(float(np.linalg.norm(ahead - place)), TINY)
        ends = place[:, None] + np.array([[-y, y], [x, -x]])
        ax.plot(*ends, color=colours.INK, linewidth=1.1, zorder=4, gid="contact")


def _look(rod: DrawnRod, norm: Normalize | None) -> dict[str, Any]:
    """The look of the line of a rod, in the colours of the push where they have a scale."""
    if norm is not None:
        return {"push": rod["push"], "norm": norm, "width": 1.6}
    pieces = _by_wall(rod)
    lies = len(pieces) > 1 and any(on.size > TOUCH for on, away in pieces if not away)
    return {"color": colours.DATA, "linewidth": 1.1} | ({"label": push_scale.ON_WALL} if lies else {})


def _draw_key(ax: Axes, form: Arrangement, place: Any, unit: str) -> None:
    """Two arrows, to the right and down, of round lengths: with one number where they have one scale."""
    left, top = place[0], place[1] + WORDS * fonts.small()
    scales = form.scale, form.scale * form.factor
    lengths = [round_below(ARROW / scale) for scale in scales]
    look: Any = {"textcoords": "offset points", "size": fonts.small(), "color": colours.SOFT, "annotation_clip": False}
    right, down = (length * scale for length, scale in zip(lengths, scales, strict=True))
    along, around = (f"{labels.number(length)} {unit}" for length in lengths)
    above, beside, below = (along, "z", "around") if form.factor == 1 else (f"z: {along}", "", f"around: {around}")
    ax.annotate(above, (left, top), (0, 3), va="bottom", **look)
    for tip, text in (((left + right, top), beside), ((left, top + down), below)):
        canvas.draw_arrow(ax, (left, top), tip, colour=colours.SOFT, width=0.8, mutation_scale=6)
        ax.annotate(text, tip, (4, 0), va="center", **look)


def stretch(wide: float, tall: float, room: tuple[float, float]) -> float:
    """How many times larger than the width the height of a curve is drawn in so many inches: 1, unless it is a hair."""
    if min(wide, tall) <= STRAIGHT * max(wide, tall):
        return 1.0
    across, up = room[0] / wide, room[1] / tall  # inches per length that would fill the room
    if tall * across < max(LEAST, FLAT * room[0]) and up > across:
        return _one_digit(up / across)
    if wide * up < max(LEAST, FLAT * room[1]) and across > up:
        return 1 / _one_digit(across / up)
    return 1.0


def _one_digit(ratio: float) -> float:
    """The ratio cut to one digit."""
    power = 10.0 ** floor(log10(ratio * (1 + 1e-9)))
    return float(floor(ratio / power * (1 + 1e-9)) * power)


def larger(factor: float, name: str = "") -> str:
    """The end of an axis label where a direction is enlarged: ``, drawn 50 times larger``; else nothing."""
    return f", {name} drawn {factor:g} times larger".replace("  ", " ") if factor > 1 else ""


def sentence(form: Arrangement, several: bool, more: str = "") -> str:
    """How one or several views are read; more: what is said of them before the dot."""
    enlarged = larger(1 / form.factor, "z") + larger(form.factor, fonts.AROUND)
    if enlarged:
        scale = ", all alike" * several + enlarged
    else:
        scale = ", all at one scale" if several else ", at one scale"
    return f"Unrolled view{'s' * several}, seen from outside: {fonts.WAYS}{scale}{more}; dot: s = 0."


def has_curve(stored: StoredStudy) -> bool:
    """Whether the dataset stores what the unrolled view is made of."""
    return all(name in stored for name in ("alpha", "z", "rho"))


def figure(
    stored: StoredStudy, x: str | None = None, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN
) -> Figure:
    """Draw the unrolled views of the rods along an axis, or of one rod, in the colours of the push.

    A ring marks where a rod passes through itself. On the unrolled cylinder such a place has two rings where the rod
    comes back to it after a turn about the axis.

    Parameters
    ----------
    stored : StoredStudy
    x, at
        As `axis` and `at` of `drawn_rods.choose`.
    sheet : Sheet
        What the figure is drawn for; its only panel is called ``curves``.

    Raises
    ------
    InputError
        As of `drawn_rods.choose`, and for an unknown panel.
    """
    sheet.choose(["curves"])
    rods = drawn_rods.choose(stored, NAMES, x, at)
    room = sheet.width - BESIDE, max(TALLEST * sheet.width, EACH * len(rods.rods) * sheet.narrow)
    panel = panel_of(rods, room, sheet.small, bar=rods.source.units)
    said = [*rods.said(), *rods.notes]
    return canvas.page(rods.source, sheet, [(panel.height, [panel.draw])], said, panel.below)


class UnrolledPanel:
    """Unrolled views in a room of inches, in rows, or the lines of one rod.

    height: inches of all; unit: of lengths; notes: said of them; in_lines: what is said of lines, else nothing; bar:
    the units of the push, whose bar of colours stands beside the key, else None.
    """

    def __init__(
        self,
        views: Sequence[UnrolledView],
        room: tuple[float, float],
        letters: float,
        unit: str,
        even: bool = False,
        notes: Sequence[str] = (),
        in_lines: str = "",
        bar: Mapping[str, str] | None = None,
    ) -> None:
        self.views, self.unit, self.notes, self.in_lines = views, unit, list(dict.fromkeys(notes)), in_lines
        self.pushes = [np.asarray(view.look["push"]) for view in views if "push" in view.look]
        self.bar = bar if self.pushes else None
        self.before = max(words_size(view.text, letters)[0] for view in views) + ABOVE if in_lines else 0.0
        room = room[0] - self.before, room[1]
        self.key = words_size("around: 0.05 mm", letters)[0]
        foot = min(self.key + (BAR_GAP + BAR * letters) * bool(self.bar), room[0]), FOOT
        self.form = plan_lines(views, room, foot) if in_lines else plan(views, room, letters, foot, even)
        self.height = self.form.size[1]

    @property
    def below(self) -> float:
        """Inches of a figure below its views."""
        off = any("label" in look for view in self.views for _, _, look, _ in view.over)
        return BELOW + LEGEND * (any(view.rings for view in self.views) + off)

    @property
    def is_straight(self) -> bool:
        """Whether each view is one straight line as it is drawn, within its width: there is nothing to see."""
        if any(view.over for view in self.views):
            return False
        for view in self.views:
            x, y = self.form.scale * view.x, self.form.scale * self.form.factor * view.y
            if x.size:
                along, across = x[-1] - x[0], y[-1] - y[0]
                away = np.abs(along * (y - y[0]) - across * (x - x[0])) / max(float(np.hypot(along, across)), TINY)
                if max(away.max(), 0.0) > HAIRLINE:
                    return False
        return True

    def draw(self, ax: Axes, more: str = "") -> list[str | Artist]:
        """Draw the views and the key; returns what is said of them. more: said before the dot."""
        form, small = self.form, fonts.small()
        ax.set(xlim=(-self.before, form.size[0]), ylim=(form.size[1], 0), aspect="equal", anchor="NW")
        ax.set_axis_off()
        ax.set_label(VIEWS)
        ax.set_xlabel(f"z [{self.unit}]")
        ax.set_ylabel(f"{fonts.AROUND} [{self.unit}]")
        rings, places, sizes, said = list[Crossing](), list[Any](), list[float](), list[str]()
        words = max(words_size(view.text, small)[1] for view in self.views)
        text: dict[str, Any] = {"size": small, "linespacing": 1.1, "annotation_clip": False}
        for view, (left, top, _, high) in zip(self.views, form.places, strict=False):
            if view.band is None:
                top += words
                under = 0.0 if "\n" in view.text else HANGING * small / 72  # an index hangs lower than other letters
                ax.annotate(view.text, (left, top - ABOVE - under), va="baseline" if under else "bottom", **text)
                if view.barred:
                    behind = fonts.width_of(view.text, small) + CROSS, WORDS * small / 2  # inches, as of the text
                    page: Any = ax.get_figure(root=True)
                    where = ax.transData + ScaledTranslation(*behind, page.dpi_scale_trans)
                    ax.plot(left, top - ABOVE, "x", transform=where, label=caution_words.BARRED, **BARRED)
            else:
                ax.annotate(view.text, (left - ABOVE, top + high / 2), ha="right", va="center", **text)
                ax.add_patch(Rectangle((left, top), form.size[0], high, color=colours.BAND, linewidth=0, zorder=0))
            if not view.x.size:
                ax.annotate(view.name, (left, top), va="top", color=colours.SOFT, size=small, annotation_clip=False)
                continue
            to_page = Affine2D().translate(*-view.box[0]).scale(form.scale, form.scale * form.factor)
            where = to_page.translate(left, top) + ax.transData
            name = view.name or view.text.partition("\n")[0]
            said += _draw_line(ax, view.x, view.y, view.look, name, where, form.scale)
            if view.begins:
                ax.plot(view.x[0], view.y[0], "o", transform=where, gid="s = 0", **BEGINNING)
            for x, y, look, name in view.over:
                said += _draw_line(ax, x, y, look, name, where, form.scale)
            _draw_edges(ax, view.edges, to_page)
            rings += view.rings
            for ring in view.rings:
                apart = form.scale * np.nan_to_num(ring.apart) * [1, form.factor]
                places.append(to_page.transform(ring.place))
                sizes.append(72 * float(np.linalg.norm(apart)) + crossing_rings.SMALLEST)
        tight = TIGHT * any(ring.bend for ring in rings)
        turned = TURNED * any(np.isnan(ring.apart).any() for ring in rings)
        close = ""
        if rings:  # below lines, which need no pale edge then
            drawn = crossing_rings.draw(ax, places, sizes, THROUGH, zorder=2, path_effects=None)
            close = CLOSE * (np.shape(drawn.get_offsets())[0] < len(places))
        for artist in (*ax.lines, *ax.collections):
            artist.set_clip_on(False)
        left, top, wide, _ = form.places[len(self.views)]
        _draw_key(ax, form, (left, top), self.unit)
        if self.bar:
            beside = self.key + BAR_GAP
            push_scale.bar(ax, self.bar, wide - beside, (left + beside, top))
        return [
            *[crossing_rings.entry(THROUGH + tight + turned + close)] * bool(rings),
            sentence(self.form, len(self.views) > 1 and not self.in_lines, self.in_lines + more),
            *self.notes,
            *said[:1],
        ]


def lines_of(
    rod: DrawnRod,
    room: tuple[float, float],
    letters: float,
    unit: str = "",
    coloured: bool = True,
    bar: Mapping[str, str] | None = None,
) -> UnrolledPanel | None:
    """A rod in the lines in which it is largest; None where it needs none: in one piece it is no hair.

    Parameters as of `panel_of`.
    """
    s, (z, across) = rod["s"], rod.plane_points()
    tall, spread, inner = float(np.ptp(z)), float(np.ptp(across)), (room[0] - HEADS, room[1] - FOOT)
    if not lines.is_long(tall, rod.rho + rod.a) or spread * inner[0] >= HAIR * tall:
        return None
    turn = 2 * np.pi * rod.rho
    around = spread > turn
    wide = turn if around else max(MOST_WIDE * spread, 0.25 * turn)
    low = -turn / 2 if around else float(across.min() + across.max() - wide) / 2
    setting = lines.set_in_lines(tall, wide, tall / float(np.ptp(s)), inner, THINNEST)
    spans = setting.cut(float(s[0]), float(s[-1]))
    dense = np.union1d(s, np.linspace(s[0], s[-1], DENSE * s.size))
    look = _look(rod, push_scale.scale([rod["push"]]) if coloured else None)
    views = []
    for (start, stop), head in zip(spans, setting.heads(spans, unit), strict=True):
        places = np.concatenate([[start], dense[(dense > start) & (dense < stop)], [stop]])
        x, y = np.interp(places, s, z), np.interp(places, s, across)
        painted = look | ({"push": np.interp(places, s, look["push"])} if "push" in look else {})
        (x, y, of_first, name), *over = on_one_turn(x, y, painted, rod.name, low, turn if around else np.inf)
        views.append(UnrolledView(x, y, head, of_first, (), name, over, (low, low + wide), start == s[0]))
    notes = [AROUND] * around
    notes += off_wall([rod])
    if "overlaps" in caution_words.keys(rod.caution):
        rings = crossings(s, rod.rho, rod["alpha"], z, rod.a, rod.radius)
        notes += [f"The rod {TOO_LONG}."] * (rings is None)
        views = _with_rings(views, rings or [], low, turn if around else np.inf, REACH * rod.a)
    said = f"; {setting.note(spans, unit)}, each {labels.number(wide)} {unit} wide"
    return UnrolledPanel(views, room, letters, unit, notes=notes, in_lines=said, bar=bar)


def _with_rings(
    views: Sequence[UnrolledView], rings: Sequence[Crossing], low: float, turn: float, reach: float
) -> list[UnrolledView]:
    """The lines of one rod with rings, each on the line that passes its place nearest, and within reach.

    rings: as of `crossings` of the whole rod, of which lines may show only pieces. low, turn: as of `on_one_turn`.
    """
    on_lines: list[list[Crossing]] = [[] for _ in views]
    points = [np.hstack([(view.x, view.y), *((x, y) for x, y, _, _ in view.over)]) for view in views]
    for ring in rings:
        along, across = ring.place
        place = np.array([along, low + (across - low) % turn if np.isfinite(turn) else across])
        away = [np.linalg.norm(line - place[:, None], axis=0).min() for line in points]
        if min(away) < reach:
            on_lines[int(np.argmin(away))].append(ring._replace(place=place))
    return [replace(view, rings=rings) for view, rings in zip(views, on_lines, strict=True)]


def on_one_turn(
    x: Values, y: Values, look: Mapping[str, Any], name: str, low: float, turn: float
) -> list[tuple[Values, Values, Mapping[str, Any], str]]:
    """The parts of a curve on the cylinder that is unrolled between two distances around, low and low + turn.

    look, name: as of `UnrolledView`.
    """
    turns = np.floor((y - low) / turn)
    parts: list[tuple[Values, Values, Mapping[str, Any], str]] = []
    for on in np.split(np.arange(y.size), np.flatnonzero(np.diff(turns)) + 1):
        of_part = {"push": np.asarray(look["push"])[on]} if "push" in look else {}
        parts.append((x[on], y[on] - (turns[on] * turn if np.isfinite(turn) else 0.0), {**look, **of_part}, name))
    return parts


def panel_of(
    rods: DrawnRods,
    room: tuple[float, float],
    letters: float,
    coloured: bool = True,
    bar: Mapping[str, str] | None = None,
) -> UnrolledPanel:
    """The unrolled views of rods of a study in a room of inches: in rows, or one long rod in lines.

    coloured: whether the lines have the colours of the push; else a cross says which shapes no real rod could keep,
    where these are not all of the file. bar: as of `UnrolledPanel`.
    """
    unit = labels.unit(rods.source.units["length"])
    if len(rods.rods) == 1:
        inches = room[0], max(TALLEST_LINES[0] * room[0], TALLEST_LINES[1])
        if in_lines := lines_of(rods.rods[0], inches, letters, unit, coloured, bar):
            return in_lines
    norm = push_scale.scale([rod["push"] for rod in rods.solved]) if coloured else None
    is_marked = not (coloured or rods.axis is None or rods.source.restable.startswith(caution_words.NONE))
    views, notes, winds = [], list[str](), False
    for k, rod in enumerate(rods.in_study_order):
        text = "" if rods.axis is None else rod.name if k == 0 else rod.value
        if rod.arrays is None:
            views.append(UnrolledView(np.zeros(0), np.zeros(0), text, {}, name=rod.why))
            continue
        passes = "overlaps" in caution_words.keys(rod.caution)
        view, is_too_long = view_of(
            rod["s"], rod.rho, rod["alpha"], rod["z"], rod.a, text, _look(rod, norm), rod.name, passes, rod.radius
        )
        if is_too_long:
            notes.append(f"The rod {TOO_LONG}." if rods.axis is None else f"The rod of {rod.name} {TOO_LONG}.")
        winds, edges = winds or bool(view.over), edges_of(rod)
        if len(edges) > MOST_EDGES:
            notes.append(f"{len(edges)} ticks would hide the rod{f' of {rod.name}' * bool(rod.value)}: it has none.")
            edges = []
        barred = is_marked and caution_words.is_barred(rod.caution)
        views.append(replace(view, over=[*view.over, *parts_off_wall(rod)], edges=edges, barred=barred))
    notes = [*[AROUND] * winds, *off_wall(rods.solved), *[EDGES] * any(view.edges for view in views), *notes]
    return UnrolledPanel(views, room, letters, unit, even=True, notes=notes, bar=bar)


def off_wall(rods: Sequence[DrawnRod]) -> list[str]:
    """How the unrolled views of rods are read that leave the wall; nothing where none does."""
    leaves = any(np.any(np.abs(rod.radius - rod.rho) > STRAIGHT * rod.rho) for rod in rods)
    return ["Where a rod is off the wall, it is seen along the radius, at its azimuth times ρ."] * leaves


def parts_off_wall(rod: DrawnRod) -> list[tuple[Any, Any, Mapping[str, Any], str]]:
    """Each stretch of a rod that is off the wall, white with an outline upon that of the rod, and a dot where it
    touches the wall at one place, as `over` of a view."""
    x, y = rod.plane_points()
    pieces = _by_wall(rod)
    look = {**push_scale.OFF_WALL, "linewidth": 1.6, "zorder": 3.1}
    off = [(x[on], y[on], look, f"{rod.name}, off the wall") for on, away in pieces if away and on.size > 1]
    dots = [on.mean(dtype=int) for on, away in pieces[1:-1] if not away and on.size <= TOUCH]
    return [*off, *((x[[k]], y[[k]], push_scale.TOUCH | {"zorder": 3.2}, f"{rod.name}, touch") for k in dots)]


def _by_wall(rod: DrawnRod) -> list[tuple[NDArray[np.int64], bool]]:
    """The stretches of a rod on and off the wall, in their order: their stations, and whether they are off it."""
    away = np.broadcast_to(np.abs(rod.radius - rod.rho) > STRAIGHT * rod.rho, rod["s"].shape)
    pieces = np.split(np.arange(away.size), np.flatnonzero(np.diff(away)) + 1)
    return [(on, bool(away[on[0]])) for on in pieces]


def edges_of(rod: DrawnRod) -> list[tuple[Values, Values]]:
    """Where the contacts of a rod that may leave the wall begin and end, as `edges` of a view; none without a push."""
    if rod.arrays is None or not {"radius", "push"} <= set(rod.arrays):
        return []
    s, points = rod["s"], np.stack(rod.plane_points(), axis=-1)
    places = varying_lines.contact_edges(s, rod["push"])
    before, after = (np.searchsorted(s, places) + k for k in (-1, 0))
    return [*zip((points[before] + points[after]) / 2, points[after] - points[before], strict=True)]


def crossings(s: Any, rho: float, alpha: Any, z: Any, a: float, radius: Any) -> list[Crossing] | None:
    """Where a rod passes through itself: two places where it comes back after a turn, else one between its stretches.
    None for a rod that is too long.

    radius: the distance from the axis, so that stretches that cross one over the other off the wall are none.
    """
    pairs = solid_body.places(s, frames.position(radius, alpha, z), a)
    if pairs is None:
        return None
    rings: list[Crossing] = []
    line = np.stack([z, rho * (alpha - alpha[0])], axis=1)
    for first, last in pairs:
        places = np.array([np.interp((first, last), s, values) for values in line.T]).T
        if first == last:
            rings.append(Crossing(places[0], np.array([2 * a, 0.0]), bend=True))
        elif np.linalg.norm(places[1] - places[0]) < NEAR * a:
            rings.append(Crossing(places.mean(axis=0), places[1] - places[0]))
        else:
            rings += [Crossing(place, np.full(2, np.nan)) for place in places]
    return rings


def draw_inset(
    ax: Axes, box: Sequence[float], x: Any, y: Any, extent: tuple[float, float], factor: float = 1.0, **look: Any
) -> None:
    """Draw one view in the middle of a box inside axes, with a white edge.

    box: left, low, width and height in shares of the axes. x, y: as of `DrawnRod.plane_points`. extent: the lengths to
    the right and down for which there is room. factor: as of `Arrangement`.
    """
    view = ax.inset_axes((box[0], box[1], box[2], box[3]), zorder=6)
    view.plot(x, y, color=colours.INK, clip_on=False, **{"linewidth": 1.1, "path_effects": [Halo(2.6, 0.8)], **look})
    view.plot(x[0], y[0], "o", color=colours.INK, markersize=2.4, clip_on=False)
    for set_ends, values, size in ((view.set_xlim, x, extent[0]), (view.set_ylim, y, -extent[1])):
        middle, half = (values.min() + values.max()) / 2, 0.5 * size or 0.5
        set_ends(middle - half, middle + half)
    view.set_aspect(factor, adjustable="box")
    view.set_axis_off()
