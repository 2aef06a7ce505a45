"""The story in one figure: the rod and its letters, the rods of an axis, a law, the claims under each reading.

Rods on their cylinder are drawn by Matplotlib alone: shaded faces, the farthest first, in a parallel projection.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from string import ascii_lowercase
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from solver.orbits import frames
from studies.laws.line_verdicts import FAILS, HOLDS, QUALIFIED, TREND, UNDECIDED
from studies.paper.readings import STIFFNESSES_SAID, parse

from ..figures import canvas, colours, crossing_rings, drawn_rods, fonts, law_panel, push_scale, unrolled
from ..figures.sheet import Sheet
from ..figures.trends import trend
from ..geometry import solid_body, tube
from ..stored.stored_study import StoredStudy
from ..words import caution_words, labels

ROD, ALONG, CLAIMS = "fig6", "fig7_1_modulus", "readings"  # the datasets by the name of their study
NEEDED = (ROD, ALONG, CLAIMS)
TURNED = np.radians(38.0)  # from facing the middle of a rod: three quarters
PART = 0.45  # of the rod with its letters: more would be small
SHOWN = 0.42  # of its length, where the angle is drawn
HEADS = 58, 76  # points from the table to the heads of its columns
# the height of the figure, and left, low, width and height of the panels a to d and of the bar of colours, in inches
ONE, TWO = 3.5, 7.2
WIDE = (
    5.5,
    (
        (0.05, 2.65, 1.75, 2.75),
        (1.9, 3.12, 5.25, 2.1),
        (0.5, 0.42, 1.95, 1.4),
        (4.3, 0.3, 2.85, 0.92),
        (4.6, 2.87, 1.9, 0.08),
    ),
)
NARROW = 5.75, ((0.0, 4.0, 1.25, 1.6), (1.25, 4.0, 2.2, 1.55), (0.55, 2.17, 2.8, 1.0), (1.5, 0.2, 1.95, 0.58),
                (2.15, 3.78, 1.2, 0.05))  # fmt: skip
# the left and upper edges of the letters of the panels in two columns or one
LETTERS = (
    ((0.05, 5.45), (1.9, 5.45), (0.05, 2.2), (2.5, 2.2)),
    ((0.03, 5.72), (1.25, 5.72), (0.03, 3.32), (0.03, 1.62)),
)
MARKS: dict[str, dict[str, Any]] = {
    HOLDS: {"marker": "o"},
    TREND: {"marker": "o", "fillstyle": "bottom"},
    QUALIFIED: {"marker": "o", "fillstyle": "left"},
    UNDECIDED: {"marker": "o", "fillstyle": "none"},
    FAILS: {"marker": "X"},
}
MOST, ROOM = 9, 0.45  # rods side by side; inches for each, or every second one is left out
SHORT = {"tension": "tens.", "compression": "compr."}  # on one column
WIDE_TABLE = 2.2  # inches of a table of claims from which its heads are written in full
WORDS = {"mean |f|": "contact force"}
ARROWS = {"rises": "↑", "falls": "↓", "not-falling": "not ↓", "not-rising": "not ↑"}

ELEVATION = np.radians(22.0)  # of the eye above the horizon
SIDES, STRIPS = 32, 60  # of a tube, of half a cylinder
LIGHT = np.array([-0.45, 0.55, 0.7])  # to the right, up, towards the eye
SHADE = 0.5  # brightness of a face that looks away from the light
VEIL = 0.86  # how much of a rod behind the cylinder is hidden

Values = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Eye:
    """From where a rod is seen. azimuth: of the eye about the axis; shift: of what is drawn, to the right [length]."""

    azimuth: float
    shift: float = 0.0

    def to_page(self, points: Any) -> Values:
        """Places on the page, (..., 2), of points in space (..., 3)."""
        return np.asarray(self.project(points)[..., :2] + [self.shift, 0.0])

    def project(self, points: Any) -> Values:
        """Points or directions as seen: to the right, up, towards the eye."""
        x, y, z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
        cos, sin = np.cos(self.azimuth), np.sin(self.azimuth)
        right, near = y * cos - x * sin, x * cos + y * sin
        up, out = np.cos(ELEVATION), np.sin(ELEVATION)
        return np.stack([right, z * up - near * out, z * out + near * up], axis=-1)


def figure(datasets: Mapping[str, StoredStudy], page: Sheet) -> Figure:
    """Draw the story of the stored datasets of `reproduce`, by the name of their study.

    page: the sheet; its width is that of two columns of a journal, or of one.
    """
    height, boxes = NARROW if page.narrow else WIDE
    share = page.width / (ONE if page.narrow else TWO)

    def draw(fig: Figure) -> None:
        axes = [
            fig.add_axes((x / page.width * share, y / height, wide / page.width * share, high / height))
            for x, y, wide, high in boxes
        ]
        letters(datasets[ROD], axes[0])
        row(datasets[ALONG], axes[1], axes[4])
        verdict = law(datasets[ALONG], axes[2])
        claims(datasets[CLAIMS], axes[3])
        sentences = [
            "The first part of the rod of Table 1, with its letters.",
            f"The rods along {labels.axis_symbol(datasets[ALONG].axes[0])} in the colours of the push.",
            verdict,
            "The claims of the paper under each reading of Table 1: these differ in the twist, the sign of F₃₀ and the "
            f"stiffness. {STIFFNESSES_SAID}",
        ]
        for letter, (x, y) in zip(ascii_lowercase, LETTERS[page.narrow], strict=False):
            fig.text(x * share / page.width, y / height, letter, weight="bold", size=fonts.large(), va="top")
        captions = zip(ascii_lowercase, sentences, strict=False)
        canvas.add_to_caption(fig, [f"({letter}) {text}" for letter, text in captions])

    return canvas.figure((page.width, height), draw, layout=None, sheet=page)


def letters(stored: StoredStudy, ax: Axes) -> None:
    """The first part of the rod of a dataset of one case in three-quarter view, with the letters of its geometry."""
    (rod,) = drawn_rods.choose(stored, ("alpha", "beta", "z")).rods
    R, beta = float(stored["R"]), rod["beta"]
    eye = _Eye(float(rod["alpha"].mean()) - TURNED)
    shown = rod.between(0.0, PART)
    low = float(shown["z"].min() - R)  # where the azimuth is drawn
    ends = low - 1.5 * R, float(shown["z"].max() + 1.2 * R)
    _rod(ax, eye, shown, np.tile(colours.LETTERED, (shown["s"].size, 1)), ends, R)
    k = int(np.argmin(np.abs(rod["s"] - SHOWN * rod["s"][-1])))
    places = frames.position(rod.rho, rod["alpha"], rod["z"])
    start, at, up = places[0], places[k], np.array([0, 0, 1.0])
    way = frames.tangent(rod["alpha"][k : k + 1], beta[k : k + 1])[0]
    fan = np.linspace(0, 1, 40)[:, None]
    arc = (1 - fan) * up + fan * way
    arc = at + 1.7 * R * arc / np.linalg.norm(arc, axis=1)[:, None]
    around = frames.position(R, np.linspace(rod["alpha"][0], rod["alpha"][k], 40), np.asarray(low))
    for foot, head in ((around[0], start), (around[-1], at)):  # the meridians of s = 0 and of the point
        way_up = [foot, [foot[0], foot[1], head[2]], head]
        _line(ax, eye, way_up, colours.INK, linestyle=(0, (1, 1.5)), zorder=4)  # on the wall, seen through the rod
        ax.plot(*eye.to_page(head), "o", color=colours.INK, markersize=3, zorder=6)
    _line(ax, eye, around, colours.INK)
    _line(ax, eye, around[-3:], colours.INK, arrow="")
    _line(ax, eye, arc, colours.INK)
    _line(ax, eye, [at, at + 2.3 * R * up], colours.INK, linestyle=(0, (3, 2)))
    _line(ax, eye, [at, at + 2.6 * R * way], colours.INK, arrow="")
    top = ends[1] * up
    _line(ax, eye, [top, top + 1.2 * R * up], colours.INK, arrow="z")
    _line(ax, eye, [top, top + R * frames.outward(np.array(eye.azimuth - 1.0))], colours.INK, arrow="R")
    left, height = -1.12 * R, eye.to_page(start)[1]  # beside the cylinder
    ax.plot([left, eye.to_page(start)[0]], [height, height], color=colours.INK, linewidth=0.5, zorder=5)
    _write(ax, (left, height), "s = 0", (-2, 0), ha="right")
    _write(ax, eye.to_page(at + 1.3 * (arc[20] - at)), "β", (-1, 4))
    _write(ax, eye.to_page(around[20]), "α", (0, -6))
    _frame(ax)
    _ring(ax, rod, eye, R, PART)


def row(stored: StoredStudy, ax: Axes, below: Axes) -> None:
    """The rods along the axis of a dataset side by side, each seen from its own side, in the colours of the push.

    below: the axes of the bar of the colours.
    """
    most = MOST if fonts.inches(ax)[0] > ROOM * MOST else MOST // 2 + 1  # every second one
    chosen = drawn_rods.choose(stored, ("alpha", "beta", "z", "push"), most=most)
    R, norm = float(stored["R"]), push_scale.scale([rod["push"] for rod in chosen.solved])
    heights = np.concatenate([rod["z"] for rod in chosen.solved])
    ends = float(heights.min()) - R, float(heights.max()) + R
    step = 2.9 * (R + 2 * chosen.solved[0].a)
    eyes = [
        _Eye(float(np.mean(rod["alpha"])) - TURNED if rod.arrays is not None else 0.0, k * step)
        for k, rod in enumerate(chosen.rods)
    ]
    for rod, eye in zip(chosen.rods, eyes, strict=True):
        foot = eye.to_page([0, 0, ends[0]]) - [0, 0.5 * R]
        if rod.arrays is not None:
            shown = rod.between(0.0, 1.0, 260)
            _rod(ax, eye, shown, colours.push_ramp()(norm(shown["push"]))[:, :3], ends, R)
        _write(ax, foot, rod.value if rod.arrays is not None else rod.why, (0, -5))
    _frame(ax)
    ringed = [_ring(ax, rod, eye, R) for rod, eye in zip(chosen.rods, eyes, strict=True) if rod.arrays is not None]
    ax.set_title(chosen.axis_label(), loc="center", size=fonts.small(), pad=2)
    bar = canvas.colour_bar(
        [ax], push_scale.in_habitual_unit(float(norm.vmax or 1.0), stored.units), cax=below, orientation="horizontal"
    )
    said = push_scale.trim(bar, stored.units, [rod["push"] for rod in chosen.solved])
    _write(below, (0, 0.5), said.replace("; ", "\n"), (-14, -4), xycoords="axes fraction", ha="right")
    if any(ringed):
        entry, down = crossing_rings.entry(unrolled.THROUGH), 2.2 * fonts.small() / 72 / fonts.inches(below)[1]
        below.legend(handles=[entry], loc="upper right", bbox_to_anchor=(1, -down), borderpad=0)


def law(stored: StoredStudy, ax: Axes) -> str:
    """The first law of a dataset: its observable along the axis, and its verdict. Returns its sentence in captions."""
    (verdict, *_) = stored.verdicts
    line = stored.law_line(verdict)
    trend(line, ax)
    (title,) = law_panel.titles([line], fonts.inches(ax)[0], fonts.small())
    colour = colours.VERDICTS[verdict["verdict"]]
    ax.set_title(fonts.wrap(title, ax, fonts.small()), loc="left", size=fonts.small(), color=colour, pad=3)
    canvas.add_legend(ax, loc="upper right", borderpad=0.0, borderaxespad=0.9, handlelength=1.3)
    return law_panel.caption_of(line)


def claims(stored: StoredStudy, ax: Axes) -> None:
    """The verdict on each claim, (reading, claim), as a table of marks: a row a claim, a column a reading."""
    names = [str(value) for value in stored["claim"].values]
    readings = [parse(str(value)).symbols for value in stored["reading"].values]
    verdicts, wide = stored["claim_verdict"].values.astype(str), bool(fonts.inches(ax)[0] > WIDE_TABLE)
    for (j, i), verdict in np.ndenumerate(verdicts):
        ax.plot(j, i, **_mark(verdict))
    sayings = [_claim(stored, name) for name in names]
    ax.set_yticks(range(len(names)), [saying if wide else saying.replace("mean ", "") for saying in sayings])
    heads = [", ".join(word if wide else SHORT.get(word, word) for word in words[1:]) for words in readings]
    ax.set_xticks(range(len(readings)), heads, rotation=90)
    ax.xaxis.tick_top()
    ax.set(xlim=(-0.6, len(readings) - 0.4), ylim=(len(names) - 0.4, -0.6))
    for first in dict.fromkeys(reading[0] for reading in readings):
        on = [j for j, reading in enumerate(readings) if reading[0] == first]
        _write(ax, (np.mean(on), 1), first, (0, HEADS[wide]), xycoords=("data", "axes fraction"), va="bottom")
        if on[0]:
            ax.axvline(on[0] - 0.5, color=colours.FAINT, linewidth=0.8)
    force = "sign of the force, stiffness" if wide else "force, stiffness"
    for text, above in (("claim", 4), (force, 30), ("twist from", HEADS[wide])):  # what the readings differ in
        _write(ax, (0, 1), text, (-8, above), xycoords="axes fraction", ha="right", va="bottom", color=colours.SOFT)
    ax.tick_params(length=0, colors=colours.INK, pad=2)
    ax.spines[:].set_visible(False)
    handles = [Line2D([], [], label=mark, **_mark(mark)) for mark in MARKS if mark in verdicts]
    ax.legend(handles=handles, loc="upper right", bbox_to_anchor=(1.02, 0.0), ncols=len(handles), borderaxespad=0,
              handletextpad=0.1, columnspacing=0.7, handlelength=1.2)  # fmt: skip


def _mark(verdict: str) -> dict[str, Any]:
    return {
        "color": colours.VERDICTS[verdict],
        "markersize": 4.8,
        "linestyle": "none",
        "markeredgewidth": 0.8,
        "markerfacecoloralt": "white",
        **MARKS[verdict],
    }


def _claim(stored: StoredStudy, name: str) -> str:
    """``(1) bends ↓ with E``: the observables of the laws of a claim, their direction, and their axes."""
    rows = [row for row in next(iter(stored.data("rows").values())) if row["claim"] == name]
    groups: dict[str, dict[str, None]] = {}
    for row in rows:
        symbol = labels.symbol_of(row["observable"])
        groups.setdefault(row["direction"], {})[WORDS.get(symbol, symbol)] = None
    does = ", ".join(f"{', '.join(nouns)} {ARROWS.get(way, '')}" for way, nouns in groups.items())
    return f"{name} {does} with {', '.join(dict.fromkeys(labels.axis_symbol(row['axis']) for row in rows))}"


def _line(ax: Axes, eye: _Eye, points: Any, colour: str, arrow: str | None = None, **look: Any) -> None:
    """A line in space; an arrow with the letter at its end where one is given."""
    places = eye.to_page(points)
    if arrow is None:
        ax.plot(*places.T, **{"color": colour, "linewidth": 0.8, "zorder": 5, **look})
        return
    ax.update_datalim(places)
    canvas.draw_arrow(ax, places[0], places[-1], colour=colour, width=0.9, order=6, mutation_scale=6)
    way = (places[-1] - places[0]) / np.linalg.norm(places[-1] - places[0])
    _write(ax, places[-1], arrow, tuple((7.5 if way[1] > 0 else 10.0) * way))


def _write(ax: Axes, place: Any, text: str, offset: Any, **look: Any) -> None:
    ax.annotate(text, place, offset, textcoords="offset points", size=fonts.small(), zorder=8, annotation_clip=False,
                **{"ha": "center", "va": "center", **look})  # fmt: skip


def _frame(ax: Axes) -> None:
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.margins(0.02)
    ax.set_axis_off()


def _ring(ax: Axes, rod: Any, eye: _Eye, R: float, share: float = 1.0) -> bool:
    """Ring the places in sight where a rod passes through itself; whether there are any. Its axes have their limits.

    rod: a `drawn_rods.DrawnRod`. share: of its length that is drawn.
    """
    if "overlaps" not in caution_words.keys(rod.caution):
        return False
    points = frames.position(rod.rho, rod["alpha"], rod["z"])
    pairs = [pair for pair in solid_body.places(rod["s"], points, rod.a) or [] if pair[1] <= share * rod["s"][-1]]
    middles = CubicSpline(rod["s"], points)(np.reshape(pairs, (-1, 2))).mean(axis=1)
    aside, _, near = np.moveaxis(_Eye(eye.azimuth).project(middles), -1, 0)
    seen = middles[(near > np.sin(ELEVATION) * middles[:, 2]) | (np.abs(aside) > R)]
    if not len(seen):
        return False
    ax.apply_aspect()
    fig = ax.get_figure(root=True)
    assert fig is not None
    places = ax.transData.transform(eye.to_page(seen)) / fig.dpi
    a = np.ptp(ax.transData.transform([[0, 0], [rod.a, 0]])[:, 0]) / fig.dpi
    sizes = np.full(len(seen), 2 * 72 * crossing_rings.radius(a))
    crossing_rings.draw(ax, places, sizes, unrolled.THROUGH, transform=fig.dpi_scale_trans)
    return True


def _rod(ax: Axes, eye: _Eye, rod: Any, shades: Any, ends: tuple[float, float], R: float) -> None:
    """Draw a rod on the outside of its cylinder.

    Parameters
    ----------
    rod
        alpha, beta, z along the rod, rho and a, as of `drawn_rods.DrawnRod`.
    shades
        The colour of each station, (n, 3) between 0 and 1.
    ends
        The height at which the cylinder begins and ends [length].
    R
        The radius of the cylinder [length].
    """
    alpha = rod["alpha"]
    place = frames.position(rod.rho, alpha, rod["z"])
    frame = place, frames.tangent(alpha, rod["beta"]), frames.outward(alpha), frames.binormal(alpha, rod["beta"])
    mesh = tube.mesh(frame, rod.a, SIDES)
    corner = mesh.triangles[:, 0]
    behind = tube.at_points(np.cos(alpha - eye.azimuth) < 0, SIDES)[corner]
    base = tube.at_points(np.asarray(shades), SIDES)[corner]
    for part, order in ((behind, 1.0), (~behind, 3.0)):
        _faces(ax, eye, mesh.points[mesh.triangles[part]], mesh.normals[corner[part]], base[part], order)
    _cylinder(ax, eye, R, ends)


def _faces(ax: Axes, eye: _Eye, faces: Values, normals: Values, shades: Values, order: float) -> None:
    """Shaded triangles, (n, 3, 3), the farthest first."""
    corners, seen = eye.project(faces), eye.project(normals)
    towards = seen[:, 2] > -0.05
    light = np.clip(seen @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)[:, None]
    shaded = np.clip(shades * (SHADE + (1.08 - SHADE) * light) + 0.35 * light**24, 0, 1)
    first = np.argsort(corners[towards, :, 2].mean(axis=1))
    drawn = shaded[towards][first]
    triangles: Any = corners[towards][first][..., :2] + [eye.shift, 0.0]  # of one array Matplotlib makes paths sooner
    ax.add_collection(
        PolyCollection(triangles, facecolors=drawn, edgecolors=drawn, linewidths=0.25, zorder=order, rasterized=True)
    )


def _cylinder(ax: Axes, eye: _Eye, R: float, ends: tuple[float, float]) -> None:
    """The near half of the surface, over what lies behind it, and the flat end above."""
    angle = eye.azimuth + np.linspace(-np.pi / 2, np.pi / 2, STRIPS + 1)
    low, high = (frames.position(R, angle, np.asarray(z)) for z in ends)
    light = np.clip(eye.project(frames.outward((angle[1:] + angle[:-1]) / 2)) @ LIGHT, 0, 1)[:, None]
    base = np.array(colours.rgb(colours.SURFACE)) / 255
    shades = np.clip(base * (0.8 + 0.22 * light), 0, 1)
    strips = np.stack([low[:-1], low[1:], high[1:], high[:-1]], axis=1)
    ax.add_collection(PolyCollection(list(eye.to_page(strips)), facecolors=shades, linewidths=0, antialiaseds=False,
                                     alpha=VEIL, zorder=2, rasterized=True))  # fmt: skip
    top = frames.position(R, np.linspace(0, 2 * np.pi, 120, endpoint=False), np.asarray(ends[1]))
    ax.fill(*eye.to_page(top).T, facecolor=colours.CUT, edgecolor=colours.SOFT, linewidth=0.5, zorder=2.1)
    for side in (0, -1):
        ax.plot(*eye.to_page([low[side], high[side]]).T, color=colours.SOFT, linewidth=0.5, zorder=2.1)
    ax.plot(*eye.to_page(low).T, color=colours.SOFT, linewidth=0.5, zorder=2.1)
