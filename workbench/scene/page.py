"""A scene, and its page: a figure of the canvas, and on its one panel the rendered picture among words and bars.

Lengths on the page are in inches; those of the panel go to the right and down. The picture is put pixel by pixel: in
the axes it would be resampled.
"""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex, to_rgba
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from numpy.typing import NDArray

from ..figures import canvas, colours, crossing_rings, fonts, print_heights
from ..figures.arrangement import Arrangement
from ..figures.halo import Halo
from ..figures.legend_room import GAP, HANDLE
from ..geometry.centreline import Array
from ..run import atomic
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import signs, true_scale
from .body import Body
from .scene_kinds import Cell, Paint, SceneKind
from .settings import Settings
from .views import EDGE, Camera, View, lies

Pixels = NDArray[np.uint8]

WIDE, LOW, TALL = 7.2, 5.5, print_heights.TALLEST  # inches of a page as a journal prints it: width, largest heights
A_ROW = 9  # rods; with more a page may be tall
LEAST = 0.3  # the least height of the views
HEAD = 0.17  # the height of a line of headings
FOOT, APART = 0.59, 0.22  # the height of glyph and bars below the views, and the gap after each
NAMED = 0.1  # more where words below the wall name the ends of a rod
BARS, ABOVE_WORDS = 0.26, 0.06  # from the middle of the bars to their lower edge, and from there to the line of words
WEIGHT, BAR = 0.66, 1.6  # widths: the arrow of the weight, the colour bar
BESIDE_BARS = 3  # entries of the legend one below the other that have room beside the bars
QUALITY = 92  # of JPEG
WHITE = colours.THEMES["light"][0]
EMPTY_LINE = "\N{ZERO WIDTH SPACE}"  # in place of a note: room for one
RUNS = 3  # the strategy of zlib that looks for runs alone: at level 1 the size of level 3 in two thirds of the time


@dataclass(frozen=True, eq=False)
class Mark:
    """A line between two places, (2, 2) in inches of the picture, with its words.

    sign: as of `signs.draw_mark`.
    """

    places: Array
    sign: str
    words: str = ""


@dataclass(frozen=True, eq=False)
class Scene:
    """What is drawn.

    Attributes
    ----------
    rows
        Views in rows of cells.
    context
        The rods that fix the scale of colours, and of which the legend speaks.
    case
        The case in words.
    camera
        Its scale is chosen by `composition.compose`.
    notes, caption
        What the picture has to say of itself, as much of it as stands on one line; sentences for the caption alone.
    columns, heads
        Headings of columns and of rows: the quantity, then the values, if these do not stand in the cells; the quantity
        may be empty. Default: none.
    pitch, edge
        As of `views.arrange`.
    ringed
        Whether self-intersections are ringed.
    has_room_for_words
        Whether a bare scene has room for the words of its cells, which it does not write.
    names
        Of the rods of the first view, in the legend.
    paint
        Whose bar the page has; chosen by `composition.colour_rods`.
    """

    stored: StoredStudy
    kind: SceneKind
    rows: Sequence[Sequence[View]]
    context: Sequence[Body]
    case: str
    camera: Camera
    settings: Settings
    notes: Sequence[str] = ()
    caption: Sequence[str] = ()
    columns: Sequence[str] = ()
    heads: Sequence[str] = ()
    pitch: float = 0.0
    edge: float = EDGE
    ringed: bool = True
    has_room_for_words: bool = False
    names: Sequence[str] = ()
    paint: Paint = field(default_factory=Paint)

    @property
    def said(self) -> list[str]:
        """The case, and how its wall is drawn."""
        inside = str(self.stored.attrs["side"]) == "inside"
        return [*filter(None, [self.case]), *["the near half of the wall is cut away"] * inside]

    @property
    def bodies(self) -> list[Body]:
        return [body for view in self.views for body in view.bodies]

    @property
    def views(self) -> list[View]:
        return [view for row in self.rows for view in row]

    @property
    def seen_along(self) -> list[str]:
        """What a view along the axis says of its side."""
        up = "down" if self.down is not None else "up"
        return [f"seen along the axis from s = 0, α = 0 {up}"] * self.camera.is_end_view

    @property
    def page_size(self) -> tuple[float, float]:
        """Width and height of the page, or its largest height where its content fixes it."""
        chosen, dpi = self.settings.size, self.settings.dpi
        return (chosen[0] / dpi, chosen[1] / dpi) if chosen else (WIDE, TALL if len(self.bodies) > A_ROW else LOW)

    @property
    def beside(self) -> tuple[float, float]:
        """The room of the headings: to the left of the views, and above them."""
        left = max((fonts.width_of(head, fonts.NORMAL) for head in self.heads[1:]), default=0.0) + 0.08
        left += 1.5 * HEAD * bool(self.heads and self.heads[0])
        return (left if self.heads else 0.0), HEAD * min(len(self.columns), 2)

    @property
    def bars(self) -> dict[str, float]:
        """What stands below the views, with its width: from where one view is seen, the weight, scale, colour bar."""
        label, is_turned = self.paint.label, self.camera.seen_from is not None
        each = [
            ("glyph", signs.GLYPH, is_turned and len(self.rows[0]) == 1 and not self.has_true_scale),
            ("weight", WEIGHT, self.down is not None),
            ("scale", signs.SCALE, True),
            ("bar", max(BAR, fonts.width_of(label, fonts.SMALL)), bool(label)),
        ]
        return {name: wide for name, wide, shown in each if shown}

    @property
    def has_true_scale(self) -> bool:
        """Whether what its compressed axis hides is drawn below the view."""
        return true_scale.is_needed(self.views)

    @property
    def has_named_ends(self) -> bool:
        """Whether words below the wall name the ends of the only rod, in a cylinder that lies on the page."""
        inside = [body.side == "inside" for body in self.bodies]
        return len(self.views) == 1 and inside == [True] and lies(self.camera)

    @property
    def start_of_legend(self) -> float:
        """Where a legend beside the bars begins, from the left of the panel."""
        return 0.05 + sum(self.bars.values()) + APART * len(self.bars)

    @property
    def along(self) -> float:
        """The share of a length along the axis that is seen; 1 where lengths across it alone are."""
        if self.camera.is_end_view:
            return 1.0
        return self.camera.along_axis * (self.context[0].squeeze if self.context else 1.0)

    @property
    def down(self) -> Array | None:
        """The direction of the weight on the page, (2,), of views that are turned alike; else None."""
        if self.camera.down is None or len({view.turned for view in self.views}) != 1:
            return None
        return np.asarray(self.camera.page @ (self.views[0].turn @ self.camera.down))


class Page:
    """The page of a scene with its words, as high as its content where the height is not given.

    legend: colours, or those of `signs` in place of one, and their meaning; it stands beside the bars where there is
    room, else below. size: default: of the scene. error: of the drawn surface in pixels, above what was asked where the
    stations are too few; stations: about how many are needed for what was asked.
    """

    error: float
    stations: int

    def __init__(
        self,
        scene: Scene,
        legend: Sequence[tuple[str, str]],
        notes: Sequence[str],
        size: tuple[float, float] | None = None,
    ) -> None:
        self.scene, self.legend, self.notes = scene, legend, notes
        bare, size = scene.settings.bare, size or scene.page_size
        self.has_true_scale = not bare and scene.has_true_scale
        self.bare, self.head = bare, (0.0, 0.0) if bare else scene.beside
        self.line, self.more = one_line(list(dict.fromkeys(notes)), size[0] - 2 * canvas.MARGIN)
        if not scene.settings.titled:
            self.line, self.more = "", [note for note in notes if note != EMPTY_LINE]
        self.high_line = fonts.height_of(self.line, fonts.SMALL) + ABOVE_WORDS * bool(self.line)
        high = FOOT + NAMED * scene.has_named_ends + true_scale.HIGH * self.has_true_scale + self.high_line
        self.foot = 0.0 if bare else high
        titled, layout = scene.stored if scene.settings.titled and not bare else None, None if bare else "constrained"
        room = size[0] - 2 * canvas.MARGIN - scene.start_of_legend
        self.columns_beside = min(int((room + GAP) / max(width_of_legend(legend), 1e-9)), len(legend))
        if len(legend) > BESIDE_BARS * self.columns_beside:
            self.columns_beside = 0
        self.fig = canvas.figure(size, self._begin, titled, scene.settings.dpi, layout, said=" · ".join(scene.said))
        self.left = size[1] if bare else print_heights.resize(self.fig, size)
        if scene.settings.transparent:
            self.fig.patch.set_alpha(0.0)
        self.fig.set_facecolor(scene.settings.look[WHITE])

    def _begin(self, fig: Figure) -> None:
        self.ax = fig.add_axes((0.0, 0.0, 1.0, 1.0)) if self.bare else fig.add_subplot()
        self.ax.axis("off")
        if not self.bare:
            below = [] if self.columns_beside else [signs.legend_sign(*entry) for entry in self.legend]
            sentences = [f"{fact}." for fact in ([] if self.scene.settings.titled else self.scene.said)]
            sentences += [labels.sentence(text.rstrip(".")) for text in self.more]
            facts = [self.scene.stored.left_out, f"{self.scene.stored.reading}." * bool(self.scene.stored.reading)]
            canvas.write_below(fig, [*sentences, *self.scene.caption, *filter(None, facts), *below])

    def panel(self) -> tuple[float, float, float, float]:
        """Lay out the page; returns left, low, width and height of the panel in inches."""
        engine = self.fig.get_layout_engine()
        if engine is not None:
            engine.execute(self.fig)
        left, low, wide, high = self.ax.get_position().bounds
        across, tall = self.fig.get_size_inches()
        return left * across, low * tall, wide * across, high * tall

    def room(self) -> tuple[float, float]:
        """Lay out the page; returns width and height for the views, (0, 0) where the words need all of it."""
        if self.left < self.head[1] + self.foot + LEAST:
            return 0.0, 0.0
        _, _, wide, high = self.panel()
        return wide - self.head[0], high - self.head[1] - self.foot

    def fit(self, high: float) -> None:
        """Give the page the height at which its views have so many inches."""
        wide, tall = map(float, self.fig.get_size_inches())
        print_heights.resize(self.fig, (wide, tall + high - self.room()[1]))

    def paste(
        self,
        pixels: Pixels,
        arrangement: Arrangement,
        rings: Sequence[tuple[float, float, float]],
        marks: Sequence[Mark] = (),
    ) -> None:
        """Put the picture in the middle of the room, pixel by pixel, and the words of its cells beside their boxes.

        pixels: of all views, (height, width, 3 or 4). rings: x, y and radius of each in inches of the picture. marks:
        of contact.
        """
        left, low, wide, high = self.place = self.panel()
        self.fig.set_layout_engine("none")  # it would move the panel, with its marks, off the picture
        dpi, shape = self.fig.dpi, np.array(pixels.shape[1::-1]) / self.fig.dpi
        free = np.maximum([wide - self.head[0] - shape[0], high - self.head[1] - self.foot - shape[1]], 0.0) / 2
        corner = np.array([left + self.head[0] + free[0], low + self.foot + free[1]])
        x, y = np.round(np.maximum(corner, 0.0) * dpi).astype(int)
        self.fig.figimage(pixels, x, y, origin="upper", zorder=-1)
        self.pixels, self.arrangement, self.rings = pixels, arrangement, rings
        start = x / dpi - left, low + high - y / dpi - shape[1]
        self.ax.set(xlim=(0, wide), ylim=(high, 0))
        self.boxes = arrangement.boxes + np.array([*start, 0.0, 0.0])
        if self.bare:
            return
        self._write(start, high, rings)
        with rc_context(fonts.RC):
            for mark in marks:
                signs.draw_mark(self.ax, mark.places + start, mark.sign, mark.words)
        recolour(self.fig, self.scene.settings.look)

    def _write(self, start: tuple[float, float], high: float, rings: Sequence[tuple[float, float, float]]) -> None:
        """Write all words beside the picture, whose corner is at `start` on a panel so high."""
        with rc_context(fonts.RC):
            for view, box in zip(self.scene.views, self.boxes.reshape(-1, 4), strict=True):
                signs.draw_cell(self.ax, view.cell, box)
            self._draw_headings()
            self._draw_foot(high - self.high_line - BARS)
            self.ax.text(0.05, high, self.line, va="bottom", size=fonts.SMALL, color=colours.SOFT)
            draw_rings(self.ax, start, rings)

    @property
    def places(self) -> list[list[float]]:
        """Left, top, right and bottom of each cell with words, in order, as shares of the page from its upper left."""
        left, low, _, high = self.place
        wide, tall = self.fig.get_size_inches()
        edges = np.concatenate([self.boxes[..., :2], self.boxes[..., :2] + self.boxes[..., 2:]], axis=-1)
        shares = (edges + [left, tall - low - high] * 2) / [wide, tall, wide, tall]
        places = zip(self.scene.views, shares.reshape(-1, 4), strict=True)
        return [place.round(5).tolist() for view, place in places if view.cell != Cell()]

    def _draw_headings(self) -> None:
        """The headings: the values above the columns and to the left of the rows, once."""
        boxes, columns, heads = self.boxes, self.scene.columns, self.scene.heads
        middles, top = boxes[0, :, 0] + boxes[0, :, 2] / 2, boxes[0, 0, 1]
        for x, value in zip(middles, columns[1:], strict=False):
            self.ax.text(x, top - 0.05, value, ha="center", va="bottom")
        if columns:
            up = HEAD * (len(columns) > 1) + 0.05
            self.ax.text((middles[0] + middles[-1]) / 2, top - up, columns[0], ha="center", va="bottom")
        lefts, rows = boxes[:, 0, 0], boxes[:, 0, 1] + boxes[:, 0, 3] / 2
        size = fonts.NORMAL if heads and heads[0] else fonts.SMALL
        for left, y, value in zip(lefts, rows, heads[1:], strict=False):
            self.ax.text(left - 0.08, y, value, ha="right", va="center", size=size)
        if heads and heads[0]:
            x, y = lefts[0] - self.head[0] + HEAD / 2, (rows[0] + rows[-1]) / 2
            self.ax.text(x, y, heads[0], ha="center", va="center", rotation=90)

    def _draw_foot(self, y: float) -> None:
        """The bars of the scene, and the legend where it stands beside them."""
        scene, x, shown, unit = self.scene, 0.05, self.scene.bars, self.scene.stored.units["length"]
        if self.has_true_scale:
            corner = x, y - true_scale.HIGH - 0.1
            true_scale.draw(self.ax, scene.views[0], scene.camera, corner, self.place[2] - 2 * x, unit)
        if scene.camera.seen_from is not None and "glyph" in shown:
            signs.draw_glyph(self.ax, x, y, scene.camera.seen_from)
            x += signs.GLYPH + APART
        if scene.down is not None:
            signs.draw_weight(self.ax, x, y, scene.down)
            x += WEIGHT + APART
        per_unit = self.arrangement.scale * scene.along
        signs.draw_scale(self.ax, x, y, per_unit, unit, scene.along, upright=not lies(scene.camera))
        if "bar" in shown:
            signs.draw_bar(self.ax, scene.paint, (x + signs.SCALE + APART, y - 0.04), (BAR, 0.1))
        if self.columns_beside:
            entries = [signs.legend_sign(*entry) for entry in self.legend]
            self.ax.legend(
                handles=entries, ncols=self.columns_beside, loc="center left", borderpad=0, borderaxespad=0,
                bbox_to_anchor=(scene.start_of_legend, y), bbox_transform=self.ax.transData, handlelength=1.8,
                handleheight=1.2,
            )  # fmt: skip


def draw_rings(
    ax: Axes, start: tuple[float, float], rings: Sequence[tuple[float, float, float]]
) -> list[PathCollection]:
    """Draw the rings of a picture whose upper left corner is at `start` on axes in inches, downward; rings: as of
    `Page.paste`. Returns what is drawn."""
    if not rings:
        return []
    across, down, radii = np.transpose(rings)
    places = np.column_stack([start[0] + across, start[1] + down])
    return [crossing_rings.draw(ax, places, 2 * 72 * radii, "rings")]


def one_line(texts: Sequence[str], width: float) -> tuple[str, list[str]]:
    """The first texts, as many as stand on one line of so many inches, and the others; a longer first one is broken."""
    shown = [text for text in texts if text != EMPTY_LINE] or [*texts[:1]]
    count = 1
    while count < len(shown) and fonts.width_of(" · ".join(shown[: count + 1]), fonts.SMALL) <= width:
        count += 1
    return fonts.break_lines(" · ".join(shown[:count]), width, fonts.SMALL), shown[count:]


def width_of_legend(legend: Sequence[tuple[str, str]]) -> float:
    """The width of a column of a legend, and of the gap after it."""
    wide = max((fonts.width_of(text, fonts.SMALL) for _, text in legend), default=0.0)
    return HANDLE + wide + GAP if legend else 0.0


def least_width(scene: Scene, legend: Sequence[tuple[str, str]], notes: Sequence[str]) -> float:
    """The width of a page on which the title, the first note and the bars with the legend have one line each."""
    beside = scene.start_of_legend + width_of_legend(legend)
    words = [
        fonts.width_of(str(scene.stored.attrs["title"]), fonts.LARGE, bold=True),
        fonts.width_of(scene.case, fonts.NORMAL),
        fonts.width_of(notes[0], fonts.SMALL) if notes else 0.0,
    ]
    heading = fonts.width_of(scene.columns[0], fonts.NORMAL) if scene.columns else 0.0
    return 2 * canvas.MARGIN + max(
        min(beside, WIDE - 2 * canvas.MARGIN), heading, *words if scene.settings.titled else ()
    )


def recolour(fig: Figure, look: Mapping[str, str]) -> None:
    """Give all words, lines and areas of a figure in the colours of the theme light those of another look."""
    if all(colour == other for colour, other in look.items()):
        return
    parts = [part for part in fig.findobj() if part is not fig.patch]
    parts += [text.arrow_patch for text in fig.findobj(Annotation) if text.arrow_patch is not None]  # it finds none
    for artist in parts:
        effects = artist.get_path_effects() or ()
        artist.set_path_effects([each.on(look[WHITE]) if isinstance(each, Halo) else each for each in effects])
        for name in ("color", "edgecolor", "facecolor", "markeredgecolor", "markerfacecolor"):
            read, write = getattr(artist, f"get_{name}", None), getattr(artist, f"set_{name}", None)
            if read is None or write is None:
                continue
            with suppress(ValueError, TypeError):  # none, or several colours
                colour = to_rgba(np.squeeze(read()) if not isinstance(read(), str) else read())
                if (other := look.get(to_hex(colour))) and colour[3] > 0:
                    write((*to_rgba(other)[:3], colour[3]))


def pixels_of(fig: Figure) -> Pixels:
    """The figure as pixels, (height, width, 3), or 4 where its background is transparent."""
    shown: Any = fig.canvas
    canvas.set_in_mathematics(fig)
    with rc_context(fonts.RC):
        shown.draw()
    channels = 3 if fig.patch.get_alpha() is None else 4
    return np.array(shown.buffer_rgba())[..., :channels]


def save(page: Page, path: Path, level: int = 1) -> None:
    """Save the page as PNG or JPEG by the suffix of the path; level: how hard a PNG is compressed, from 1 to 9.

    A PNG has the places of its rods in its text "rods": a list of left, top, right and bottom, as shares of the page
    from its upper left. Raises `InputError` where the file cannot be written; an existing file then stays as it was.
    """
    from PIL import Image, PngImagePlugin

    picture, how = Image.fromarray(pixels_of(page.fig)), dict[str, Any](quality=QUALITY)
    if path.suffix.lower() == ".png":
        facts = PngImagePlugin.PngInfo()
        facts.add_text("rods", json.dumps(page.places))
        how = {"compress_level": level, "compress_type": RUNS if level == 1 else 0, "pnginfo": facts}
    dpi = page.fig.dpi
    atomic.write(path, lambda aside: picture.save(aside, dpi=(dpi, dpi), **how))
