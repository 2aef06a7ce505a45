"""A dimensioned drawing of one rod on its cylinder at true scale, as a workshop draws it.

What the cylinder hides is dashed. A rod that leaves the wall has an end view too, with the point forces of the wall.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Ellipse, Rectangle
from scipy.spatial import KDTree

from solver import Solution

from ..geometry import solid_body
from ..stored.stored_study import StoredStudy
from ..words import free_rod_words, labels
from ..words.free_rod_words import MOST, places_of_contact
from ..words.unit_habits import plain, value_with_unit, within
from . import canvas, colours, drawn_rods, fonts, waves
from .dimensions import (
    AWAY,
    FINE,
    Length,
    dimension,
    dimension_distance,
    dimension_lay,
    dimension_pitch,
    dimension_rod,
    draw_forces,
    has_room,
)
from .drawn_numbers import CASING
from .sheet import MILLIMETRES, SCREEN, WIDEST, Sheet
from .views_on_paper import ABOVE, BELOW, HAIR, LEFT, RIGHT, SPARE, THICK, Values, Views, views_of

EDGE, THIN = 0.9, 0.35  # points of an outline, and of that of turns side by side at least
HIDDEN = (0, (4, 2.5))
AXIS: dict[str, Any] = {"color": colours.SOFT, "linewidth": FINE, "linestyle": (0, (12, 2.5, 2, 2.5)), "zorder": 2.2,
                        "gid": "axis"}  # fmt: skip
EVEN = math.radians(0.05)  # by which a lay varies that is one angle
SLIVER = 0.5  # millimetres beside a turn, within which a hidden edge is not drawn: it would be specks
LEAST_STEP = 1e-6  # of a step along the rod: that of its line on paper
PIECE = 0.5  # radii of the rod in a piece of one that passes before itself
TICK = 1.5  # millimetres: half of one across the wall
WIDER = 5.0  # millimetres from one width to the next at which is asked whether all has room
HINTED = 1.1  # by which a line of letters of few pixels is wider than it is measured
MOST_BELOW = 3  # point forces whose numbers the line below the views has
OFF = 0.5  # radii of the rod: an end so far off the wall has its distance from the axis


def figure(stored: StoredStudy, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN) -> Figure:
    """Draw one rod and its cylinder with their dimensions: diameters, pitch, lay, length along the axis.

    Parameters
    ----------
    stored : StoredStudy
    at : mapping, optional
        The values of axes; an axis that is not named stays where the laws or Table 1 put it.
    sheet : Sheet
        What it is drawn for.

    Raises
    ------
    InputError
        As of `drawn_rods.choose`.
    """
    stored = stored.coarse()
    where = stored.place(at)
    chosen = stored.select(where)
    rods = drawn_rods.choose(chosen, ("alpha", "beta", "z"))
    rod, R, side = rods.solved[0], float(chosen["R"]), str(chosen.attrs["side"])
    height, pitch = (float(value) for value in drawn_rods.numbers(chosen, "height", "pitch"))
    unit = partial(value_with_unit, units=chosen.units)
    free = chosen.at() if chosen.leaves else None
    radii = {k: float(free.radius[k]) for k in (0, -1)} if free else {}
    distances = {k: unit("L", radius) for k, radius in radii.items() if radius - rod.rho > OFF * rod.a}

    def views(of: Sheet) -> tuple[Views, list[str]]:
        """The views on a sheet, and the words for what has no room on it."""
        forces = _forces(free, chosen.units) if free else None
        with rc_context(fonts.RC | of.settings()):
            view = views_of(rod, chosen.units["length"], R, of, forces)
            left_out = [f"the distance {text}" for k, text in distances.items() if not has_room(view, k, R, text)]
        if forces and not (_are_below(view) or any(force.words for force in view.forces or ())):
            left_out.append("the numbers of the point forces" if view.forces else "the point forces")
        return view, left_out

    view, left_out = views(sheet)
    line, said = _words(chosen, rod, view, free, unit, stored.equations(where))
    if left_out:
        wider = np.arange(WIDER * math.ceil(sheet.width * MILLIMETRES / WIDER), WIDEST + 1, WIDER).tolist()
        fits = next((mm for mm in wider if not views(replace(sheet, width=mm / MILLIMETRES))[1]), None)
        said.append(f"{canvas.NOT_DRAWN}{' and '.join(left_out)}" + (f"; --width {fits:g} has room." if fits else "."))

    def draw(fig: Figure) -> None:
        title = canvas.write_title(fig, str(stored.attrs["title"]), "") if sheet.titled else 0.0
        wide, high = fig.get_size_inches()
        ax = fig.add_axes((0, 0, 1, 1 - title / high))
        ax.set_axis_off()
        first, top = float(view.x.min()), float(view.box[1, 1]) / view.mm
        left = LEFT + SPARE + (wide * MILLIMETRES - LEFT - RIGHT[sheet.narrow] - 2 * SPARE - view.wide) / 2
        ax.set_xlim(first - left / view.mm, first + (wide * MILLIMETRES - left) / view.mm)
        ax.set_ylim(top - ((high - title) * MILLIMETRES - ABOVE) / view.mm, top + ABOVE / view.mm)
        _draw_body(ax, view, R, rod.a, side)
        edge = first - SPARE / view.mm
        dimension(ax, view, (edge, -R), (edge, R), _diameter("R", 2 * R, chosen.units), AWAY)
        if view.squeeze == 1:
            dimension_pitch(ax, view, view.ends[1], pitch, unit)
        if view.whole and abs(height) * view.mm > THICK:
            low, words = view.ends[0], unit("L", abs(height))
            dimension(
                ax, view, (view.x[0], low), (view.x[-1], low), words, -AWAY, [view.foot(k, R, rod.a) for k in (0, -1)]
            )
        dimension_rod(ax, view, rod.a, _diameter("a", 2 * rod.a, chosen.units))
        if lay := _lay(view):
            dimension_lay(ax, view, rod.a, lay)
        if free:
            _draw_end(ax, view, R, rod.a, free.contacts)
            for k, text in distances.items():
                dimension_distance(ax, view, k, R, text)
            draw_forces(ax, view)
        ax.text(
            4 / MILLIMETRES / wide,
            3 / MILLIMETRES / (high - title),
            below(line, wide),
            transform=ax.transAxes,
            va="bottom",
            color=colours.INK,
        )
        canvas.add_to_caption(fig, [*said, *rods.notes])

    size = sheet.width, (np.ptp(view.box[:, 1]) + ABOVE + BELOW) / MILLIMETRES + canvas.TITLE * sheet.titled
    return canvas.figure(size, draw, layout=None, sheet=sheet)


def below(line: str, wide: float) -> str:
    """The line below the views in lines that stay on a page so many inches wide, also where letters have few pixels."""
    return fonts.break_lines(line, (wide - 8 / MILLIMETRES) / HINTED)


def _words(
    chosen: StoredStudy, rod: drawn_rods.DrawnRod, view: Views, free: Solution | None, unit: Length, case: str
) -> tuple[str, list[str]]:
    """The line below the views, and the sentences of the caption. case: where on the axes of its study the rod is."""
    height, kappa = (float(value) for value in drawn_rods.numbers(chosen, "height", "kappa_max"))
    parts = [*[case] * bool(case), f"length {unit('L', float(chosen['L']))}"]
    parts += [] if view.whole else [f"along the axis {unit('L', abs(height))}"]
    if wrap := _wrap(rod, free):
        error = math.degrees(free_rod_words.length_error(free) / rod.rho) if free else 0.0
        whole = f"{within(wrap / 360, error / 360)} turns = " * (abs(wrap) >= 360)
        parts += [f"wrap {whole}{within(wrap, error)}°"]
    if free:
        (turns,) = (float(value) for value in drawn_rods.numbers(chosen, "turns_around"))
        parts += [f"azimuth of the end {plain(360 * turns)}°"]
        (gap,) = (float(value) for value in drawn_rods.numbers(chosen, "gap_max"))
        unit_of_length = chosen.units["length"]
        where = places_of_contact(free, unit_of_length) if free.contacts else "nowhere between its ends"
        parts += [f"on the wall {where}", f"up to {unit('L', gap)} off it"]
        parts += free_rod_words.forces_in_words(free, chosen.units) if _are_below(view) else []
    elif lay := _lay(view):
        parts += [f"lay{labels.NO_BREAK}{lay}"]
    along = f" across, {_scale_words(view.scale * view.squeeze)} along the axis" if view.squeeze < 1 else ""
    line = ", ".join([*parts, f"scale{labels.NO_BREAK}{_scale_words(view.scale)}{along}"])
    said = [f"The rod: {line}.", f"Its least bend radius, of the centreline: {unit('L', 1 / kappa)}."] if kappa else []
    hides = str(chosen.attrs["side"]) == "outside"
    eye = "−90°, with the low side down" if view.low_side else "90°"
    said.append(f"A side view, seen from α = {eye}{'; dashed: behind the cylinder' * hides}.")
    if free:
        said.append("Beside it the end view, along the axis from s = 0.")
    texts = [chosen.restable, *(free_rod_words.sentences(free, chosen.units) if free else ())]
    said += [labels.sentence(text) for text in [*texts, labels.typeset(chosen.caution)] if text and text not in parts]
    said += ["The rod is thinner than its line."] if 2 * rod.a * view.mm < HAIR else []
    return line, [*said, *([] if view.whole else ["A part of the rod is drawn, from s = 0."])]


def _wrap(rod: drawn_rods.DrawnRod, free: Solution | None) -> float:
    """The angle round the axis in degrees along which a rod lies on the wall, positive if alpha grows.

    free: the solution of a rod that may leave the wall, with its contacts; any other lies on the wall everywhere.
    """
    edges = np.array(free.contacts if free else [rod["s"][[0, -1]]]).reshape(-1, 2)
    return float(np.degrees(np.diff(np.interp(edges, rod["s"], rod["alpha"])).sum()))


def _are_below(view: Views) -> bool:
    """Whether the numbers of the point forces stand in the line below the views, as arrows have no room for them."""
    return 0 < len(view.forces or ()) <= MOST_BELOW and not any(force.words for force in view.forces or ())


def _diameter(name: str, size: float, units: Mapping[str, str]) -> str:
    """A diameter in words; below 1 m in mm where lengths are in m, as a workshop states it."""
    in_mm = units["length"] == "m" and size < 1
    return f"Ø {plain(1e3 * size)} mm" if in_mm else f"Ø {value_with_unit(name, size, units)}"


def _lay(view: Views) -> str:
    """The angle of the rod to the axis, where it is one; of a rod that leaves the wall none is said."""
    even = view.forces is None and float(np.ptp(view.beta)) < EVEN
    return f"{plain(round(math.degrees(float(view.beta.mean())), 6))}°" if even else ""


def _forces(free: Solution, units: Mapping[str, str]) -> list[tuple[float, float, str]]:
    """The point forces of the wall: s, size, and words."""
    each = zip(free.point_forces, free_rod_words.point_forces(free), strict=True)
    said = [(s, force, f"{size} {units['force']}\ns = {place} {units['length']}") for (s, force), (place, size) in each]
    return said[:MOST]


def _scale_words(scale: float) -> str:
    return labels.powers_of_ten(f"1:{plain(1 / scale)}" if scale < 1 else f"{scale:g}:1")


def _strokes(view: Views, a: float) -> list[tuple[str, float]]:
    """The strokes of the rod, one upon the other: colour and points; of one thinner than a line its line alone."""
    thick = max(2 * a * view.mm, HAIR) / MILLIMETRES * 72
    outline = (colours.INK, thick)
    return [outline] if 2 * a * view.mm < HAIR else [outline, ("white", max(thick - 2 * _edge(view, a), 0.3 * thick))]


def _edge(view: Views, a: float) -> float:
    """Points of the outline of the rod: no more than the gap between its turns has, which is black else."""
    tops = np.flatnonzero((np.diff(view.near >= 0) != 0) & (view.y[1:] > 0))
    gaps = np.abs(np.diff(view.x[tops]) * np.sin(view.beta[tops[1:]])) - 2 * a
    gap = float(gaps.min(initial=np.inf)) * view.mm / MILLIMETRES * 72
    return float(np.clip(gap, THIN, EDGE)) if gap > 0 else EDGE


def _draw_end(ax: Axes, view: Views, R: float, a: float, contacts: Sequence[tuple[float, float]]) -> None:
    """The end view: the cylinder with its middle lines, and the rod, with ticks where its contacts begin and end
    without the arrow of a point force."""
    ax.add_patch(Circle(tuple(view.middle), R, facecolor=colours.CUT, edgecolor=colours.INK, linewidth=EDGE, zorder=2))
    half = R + SPARE / view.mm / 2
    for x, y in ((half, 0.0), (0.0, half)):
        ax.plot(*(view.middle + np.array([[-x, -y], [x, y]])).T, **AXIS)
    for colour, width in _strokes(view, a):
        ax.plot(*(view.middle + view.end).T, color=colour, linewidth=width, solid_capstyle="round",
                solid_joinstyle="round", zorder=4, snap=False, gid="rod, along the axis")  # fmt: skip
    arrows = {force.s for force in view.forces or ()}
    for s in sorted({edge for pair in contacts[:MOST] for edge in pair if 0 < edge < view.s[-1]} - arrows):
        place = np.array([np.interp(s, view.s, column) for column in view.end.T])
        across = view.middle + np.outer([R - TICK / view.mm, R + TICK / view.mm], place / np.hypot(*place))
        ax.plot(*across.T, color=colours.INK, linewidth=EDGE, zorder=5, gid="contact")


def _parts(view: Views, front: bool) -> Iterator[slice]:
    """The parts of the rod before the plane of the axis, or behind it; neighbours share a point."""
    is_front = view.near >= 0
    cuts = [0, *(np.flatnonzero(np.diff(is_front)) + 1).tolist(), view.x.size]
    for begin, end in pairwise(cuts):
        if bool(is_front[begin]) == front:
            yield slice(max(begin - 1, 0), min(end + 1, view.x.size))


def _pieces(view: Views, of: slice, a: float) -> tuple[list[slice], list[slice]]:
    """A part of the rod in short pieces, in the order of drawing, where it passes before itself, and the longer inside
    of each; else none. The round end of a piece stays within the part.

    Each is drawn upon those before it, so that each stretch has its outline there. On the wall all are as near, and the
    later one is upon the others; off the wall the nearer one.
    """
    points = np.stack([view.x[of], view.y[of], np.zeros(of.stop - of.start)], axis=1)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)  # along the line on paper, which is short towards the eye
    along = np.append(0.0, np.cumsum(np.maximum(steps, LEAST_STEP * np.diff(view.s[of]))))
    spare = math.ceil(a / float(view.s[1] - view.s[0]))
    low, high = of.start + spare, of.stop - spare
    first, last = low + spare * (of.start == 0), high - spare * (of.stop == view.x.size)  # its ends have their section
    if last - first < 2 or not any(i < j for i, j in solid_body.places(along, points, a) or ()):  # no bend alone
        return [], []
    step = math.ceil(spare * PIECE)
    pieces = [slice(k, min(k + step + 1, last)) for k in range(first, last - 1, step)]
    if view.forces is not None:
        pieces.sort(key=lambda piece: float(view.near[piece].mean()))
    return pieces, [slice(max(on.start - 2 * spare, low), min(on.stop + 2 * spare, high)) for on in pieces]


def _draw_body(ax: Axes, view: Views, R: float, a: float, side: str) -> None:
    """The cylinder with its axis, and the rod: solid where it is seen, dashed where the cylinder hides it."""
    spare = SPARE / view.mm
    low, high = float(view.x.min()) - spare, float(view.x.max()) + spare
    behind = 1.0 if side == "outside" else 3.0  # the order of drawing

    def strand(of: slice, order: float, name: str) -> None:
        """A part of the rod: flat at an end of the rod, round where it passes the plane of the axis.

        The outline there lies below all parts, so that none shows inside the rod.
        """
        if view.squeeze < 1:
            _draw_squeezed(ax, view, of, a, order, name)
            return
        middle = (of.start + of.stop) // 2
        inner = slice(middle if of.start == 0 else of.start, middle if of.stop == view.x.size else of.stop)
        for below, (colour, width) in zip((behind - 0.1, order), _strokes(view, a), strict=False):
            look: dict[str, Any] = {"color": colour, "linewidth": width, "solid_joinstyle": "round", "snap": False}
            ax.plot(view.x[of], view.y[of], solid_capstyle="butt", zorder=order, gid=name, **look)
            ax.plot(view.x[inner], view.y[inner], solid_capstyle="round", zorder=below, label=CASING, **look)
        for each in zip(*_pieces(view, of, a), strict=True):
            for on, (colour, width) in zip(each, _strokes(view, a), strict=False):
                ax.plot(view.x[on], view.y[on], color=colour, linewidth=width, solid_joinstyle="round", snap=False,
                        solid_capstyle="round", zorder=order + 0.01, label=CASING)  # fmt: skip

    as_one = view.squeeze < 1 and side == "inside"  # all of the rod, which is one polygon without seams
    for of in _parts(view, front=False) if not as_one else ():
        strand(of, behind, "rod, behind the plane of the axis")
    ax.add_patch(Rectangle((low, -R), high - low, 2 * R, facecolor=colours.CUT, edgecolor="none", zorder=2))
    for y in (-R, R):
        ax.plot([low, high], [y, y], color=colours.INK, linewidth=EDGE, zorder=2.1, gid="cylinder")
    for end in (low, high):
        ax.plot([end, end], [-R, R], color=colours.INK, linewidth=FINE, zorder=2.1, gid="end of the drawn cylinder")
    ax.plot([low - spare / 2, high + spare / 2], [0, 0], **AXIS)
    before = [np.stack([view.x[of], view.y[of]], axis=1) for of in _parts(view, front=True)]
    turns = KDTree(np.concatenate([*before, np.full((1, 2), 1e300)]))  # which the viewer sees, and none far away
    for of in _parts(view, front=False) if side == "outside" else ():
        for edge in (-a, a) if 2 * a * view.mm > 1 else (0.0,):
            right, up = _beside(view.x[of], view.y[of], edge)
            beside = turns.query(np.stack([right, up], axis=1))[0] - a
            beside[np.abs(up) >= R] = 0.0
            runs = np.cumsum(np.append(0, np.diff(beside > 0) != 0))  # each is drawn whole, or not at all
            wide = np.array([beside[runs == run].max() > SLIVER / view.mm for run in range(runs[-1] + 1)])
            seen = np.where((beside > 0) & wide[runs], right, np.nan)
            ax.plot(seen, up, color=colours.SOFT, linewidth=FINE, linestyle=HIDDEN, zorder=2.3, gid="hidden edge")
    for of in [slice(0, view.x.size)] if as_one else _parts(view, front=True):
        strand(of, 4, "rod" if as_one else "rod, before the plane of the axis")
    sections = 2 * a * view.mm >= HAIR and view.x.size > 1 and view.squeeze == 1
    for k in ((0, 1), (-1, -2))[: 1 + view.whole] if sections else ():
        _draw_section(ax, view, k, a, R, 4 if view.near[k[0]] >= 0 else behind, side == "outside")


def _draw_squeezed(ax: Axes, view: Views, of: slice, a: float, order: float, name: str) -> None:
    """A part of the rod where lengths along the axis are compressed: its edges are as far apart as it is thick. Waves
    that are too narrow are the band that they cover."""
    x, y = view.x[of], view.y[of]
    at, low, high = waves.outline(x, y, view.mm / MILLIMETRES)
    ax.fill_between(at, low - a, high + a, facecolor="white", edgecolor="none", zorder=order, gid=name)
    for edge in (low - a, high + a):
        ax.plot(at, edge, color=colours.INK, linewidth=EDGE, zorder=order, gid=name)
    for k in {0, view.x.size - 1} & {of.start, of.stop - 1}:
        ax.plot(
            view.x[[k, k]], view.y[k] + [-a, a], color=colours.INK, linewidth=EDGE, zorder=order, gid="end of the rod"
        )


def _draw_section(ax: Axes, view: Views, k: tuple[int, int], a: float, R: float, order: float, hides: bool) -> None:
    """The section at an end of the rod, k: the last point and that before it: upon the rod where it faces the viewer,
    else below, so that it closes the outline. order: of drawing the rod there. hides: whether the cylinder may."""
    out = np.array([column[k[0]] - column[k[1]] for column in (view.x, view.y, view.near)])
    low, edge = 2 * a * abs(out[2]) / max(float(np.linalg.norm(out)), 1e-300), _edge(view, a)
    line = edge / 72 * MILLIMETRES / view.mm

    def section(inset: float, zorder: float, **look: Any) -> None:
        size, angle = (max(low - inset, 0.0), max(2 * a - inset, 0.0)), math.degrees(math.atan2(out[1], out[0]))
        ax.add_patch(Ellipse((view.x[k[0]], view.y[k[0]]), *size, angle=angle, linewidth=edge, zorder=zorder, **look))

    section(line, order + math.copysign(0.05, out[2]), facecolor="white", edgecolor=colours.INK, gid="end of the rod")
    section(2 * line, order + 0.06, facecolor="white", edgecolor="none")  # no seam shows inside
    if hides and view.near[k[0]] < 0 and 2 * a * view.mm > 1:
        section(line, 2.3, fill=False, edgecolor=colours.SOFT, linestyle=HIDDEN, gid="hidden edge")
        x, high = view.x[k[0]], 2 * a
        ax.patches[-1].set_clip_path(Rectangle((x - high, -R), 2 * high, 2 * R, transform=ax.transData))


def _beside(x: Values, y: Values, distance: float) -> tuple[Values, Values]:
    """A curve at a distance to the left of another one."""
    dx, dy = np.gradient(x), np.gradient(y)
    length = np.maximum(np.hypot(dx, dy), 1e-300)
    return x - distance * dy / length, y + distance * dx / length
