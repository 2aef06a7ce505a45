"""A scene composed: rods in their cells are coloured, rendered, and set on a page. Needs OpenGL."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import xarray as xr

from solver.problem.errors import InputError
from studies.model import MAX_STATIONS

from ..geometry.centreline import APART, Array
from ..geometry.refinement import stations_for
from . import captions, colours, footer, long_rod, overlays, page, wording
from .arrangement import EDGE, Arrangement, arrange
from .body import Body
from .camera import Camera
from .cells import Cell
from .colours import Bar
from .kinds import Kind
from .page import Page, Words
from .rendering import Placed, render
from .settings import DEFAULT, Settings
from .views import View

SIZE = (1600, 1200)  # pixels at `style.DPI`: width, and largest height, of the page of one case
LINE = 1.5  # width of lines in pixels at `style.DPI`
NARROWEST = 1400.0  # width of a page, for the line below the views
COARSEST = 10.0  # pixels that a surface may be off; beyond, it is no picture of that rod

__all__ = ["DEFAULT", "SIZE", "Picture", "Scene", "Settings", "TooFewStations", "composed"]


@dataclass(frozen=True, eq=False)
class Picture:
    """A composed scene.

    error: of its surface in pixels; above what was asked where the stations are too few. stations: about how many are
    needed for what was asked.
    """

    page: Page
    error: float
    stations: int


class TooFewStations(InputError):
    """The stations are too few for the pixel error; `stations`: about how many are needed."""

    def __init__(self, sentence: str, stations: int) -> None:
        super().__init__(sentence)
        self.stations = stations


@dataclass(frozen=True, eq=False)
class Scene:
    """What is drawn.

    Attributes
    ----------
    rows
        Views in rows of cells.
    context
        The rods that fix the scale of colours.
    case
        The case in words.
    camera
        Its scale is chosen here.
    size
        Width and largest height of the page in pixels at `style.DPI`.
    bar
        The colour bar of rods that already have their colours.
    columns, heads
        Headings of columns and of rows.
    gutter, pitch
        As of `arrangement.arrange`.
    ringed
        The views in which self-intersections are ringed.
    labels
        Of the rods of the first view, beside them.
    outlined
        Hidden stretches are drawn in outline.
    frames
        The scenes of all frames of the film of which this scene is one: they share legend and room.
    """

    ds: xr.Dataset
    kind: Kind
    rows: Sequence[Sequence[View]]
    context: Sequence[Body]
    case: str
    camera: Camera
    settings: Settings
    notes: Sequence[str] = ()
    size: tuple[int, int] = SIZE
    bar: Bar | None = None
    columns: Sequence[str] = ()
    heads: Sequence[str] = ()
    gutter: float = 0.0
    pitch: float = 0.0
    ringed: Literal["none", "first", "all"] = "none"
    labels: Sequence[str] = ()
    outlined: bool = True
    frames: Sequence["Scene"] = ()

    @property
    def bodies(self) -> list[Body]:
        return [body for view in self.views for body in view.bodies]

    @property
    def views(self) -> list[View]:
        return [view for row in self.rows for view in row]

    @property
    def ringed_views(self) -> list[View]:
        return {"none": [], "first": self.views[:1], "all": self.views}[self.ringed]

    @property
    def axes(self) -> Array:
        """Where x, y, z point on the page in the first view, (3, 2)."""
        return (self.camera.page @ self.rows[0][0].turn).T


def composed(scene: Scene) -> Picture:
    """Colour the rods, render them, and set the page. Raises `InputError`, `TooFewStations`."""
    scene = _coloured(_bare(scene) if scene.settings.bare else scene)
    settings, finer = scene.settings, scene.settings.finer
    words = wording.words(scene)
    arranged = arrange(scene.rows, scene.camera, room(scene, words), scene.gutter, scene.pitch)
    camera = replace(scene.camera, per_unit=arranged.per_unit * finer)
    _check_width(scene, camera)
    n, stations = _stations(scene.bodies, settings.pixel_error / camera.per_unit)
    if settings.strict and stations > n:
        raise TooFewStations(f"{n} stations are too few, about {stations} are needed", stations)
    size = int(np.ceil(arranged.size[0] * finer)), int(np.ceil(arranged.size[1] * finer))
    pixels, error, outlined = render(
        _placed(scene, arranged, camera, size), camera, size, settings.pixel_error, settings.transparent,
        max(LINE * finer, 0.8), scene.outlined,
    )  # fmt: skip
    blind = any(body.line.swing > APART for body in scene.bodies)  # then the push between stations is not known
    if error > (settings.pixel_error * (1 + 1e-9) if blind else COARSEST):
        raise TooFewStations(_too_few(n, stations, error, settings), stations)
    if error > settings.pixel_error * (1 + 1e-9):
        words = replace(words, notes=[*words.notes, f"drawn to within {error:.1f} pixels"])
    boxes = [box for row in arranged.rows for box in row]
    rings, radius = overlays.rings(list(zip(scene.ringed_views, boxes, strict=False)), camera, arranged.per_unit)
    legend = [entry for entry in words.legend if outlined or scene.frames or entry[0] != footer.OUTLINE]
    words = replace(words, legend=legend, radius=radius)
    first = scene.rows[0][0], arranged.rows[0][0], camera, arranged.per_unit
    labelled = overlays.names(*first, scene.labels, arranged.size) if scene.labels else []
    wide, high = page_size(scene)
    if settings.bare and not settings.size:
        wide, high = size[0] / finer, size[1] / finer
    elif not settings.size:
        wide = min(wide, max(NARROWEST, arranged.size[0] + words.heads[0] + 2 * page.MARGIN))
    made = Page(words, pixels, arranged, scene.axes, wide, high, settings.dpi, rings, labelled,
                settings.bare, _reserved(scene) if scene.frames else (0.0, 0.0))  # fmt: skip
    return Picture(made, error, stations)


def page_size(scene: Scene) -> tuple[float, float]:
    """Width and height of the page in pixels at `style.DPI`; height 0: as its content needs."""
    if scene.settings.size:
        return scene.settings.size[0] / scene.settings.finer, scene.settings.size[1] / scene.settings.finer
    return float(scene.size[0]), 0.0


def room(scene: Scene, words: Words | None = None) -> tuple[float, float]:
    """The room of the views on the page, in pixels at `style.DPI`."""
    words = words or wording.words(scene)
    wide, high = page_size(scene)
    high = high or float(scene.size[1])
    if scene.settings.bare:
        return wide, high
    left, top = words.heads
    head, foot = np.maximum(_around(scene, words), _reserved(scene))
    inside = wide - 2 * page.MARGIN - left, float(high - head - foot - top)
    if min(inside) < 60:
        raise InputError(
            f"--size {wide * scene.settings.finer:.0f}x{high * scene.settings.finer:.0f} leaves no room for the views "
            f"beside the words at {scene.settings.dpi} dots per inch: give a larger size, fewer --dpi, or --bare"
        )
    return inside


def _around(scene: Scene, words: Words) -> tuple[float, float]:
    """The heights of the words above and below the views."""
    wide = page_size(scene)[0]
    return page.above(words, wide), page.below(page.feet(words, scene.axes, 1.0, scene.camera.along_axis, wide))


def _reserved(scene: Scene) -> tuple[float, float]:
    """The largest of these heights in the frames of a film; 0 for a scene alone."""
    each = [_around(frame, wording.words(replace(frame, frames=scene.frames))) for frame in scene.frames]
    above, below = zip(*each, strict=True) if each else ((0.0,), (0.0,))
    return max(above), max(below)


def _bare(scene: Scene) -> Scene:
    """The scene without words beside its views."""
    rows = [[replace(view, cell=Cell("")) for view in row] for row in scene.rows]
    return replace(scene, rows=rows, columns=(), heads=(), gutter=0.0, labels=(), ringed="none")


def _coloured(scene: Scene) -> Scene:
    """The scene with the colours of its kind on all rods."""
    if scene.kind.cells == "together":
        return scene
    (paint, bar), notes = scene.kind.paint(scene.ds, scene.context), list[str]()
    if chosen := scene.settings.color_range:
        if scene.kind.value is None:
            raise InputError(f"a scene of kind {scene.kind.name} has no colour bar, so it takes no --color-range")
        paint, bar = colours.ranged(paint, bar, chosen)
        notes = captions.beyond(scene.context, bar, chosen)
    painted = {body: replace(body, paint=paint) for body in scene.bodies}
    rows = [[replace(view, bodies=[painted[body] for body in view.bodies]) for view in row] for row in scene.rows]
    frames = [replace(frame, bar=bar, notes=[*frame.notes, *notes]) for frame in scene.frames]
    return replace(scene, rows=rows, bar=bar, notes=[*scene.notes, *notes], frames=frames)


def _check_width(scene: Scene, camera: Camera) -> None:
    for body in scene.bodies[:1]:
        wide, ends = 2 * body.reach * camera.per_unit, scene.rows[0][0].cylinder
        if wide < long_rod.THINNEST * (1 - 1e-6) and not scene.pitch:
            raise InputError(
                f"a cylinder {2 * body.reach:.3g} wide and {np.ptp(ends):.4g} long is {wide:.2g} pixels wide in the "
                "picture: draw a shorter part with --from and --to, or draw one case, which is set in lines"
            )


def _placed(scene: Scene, arranged: Arrangement, camera: Camera, size: tuple[int, int]) -> list[Placed]:
    """The views where they stand in the picture: each in the middle of its box, on the lower edge of it."""
    finer, found = scene.settings.finer, []
    for row, boxes in zip(scene.rows, arranged.rows, strict=True):
        for view, box in zip(row, boxes, strict=True):
            if view.bodies:
                low, high = view.box(camera)
                x = (box.x + box.width / 2) * finer
                bottom = box.y + box.height - (0.0 if scene.pitch else EDGE)
                y = size[1] - bottom * finer + (high - low)[1] / 2 * camera.per_unit
                found.append(Placed(view, (float(x), float(y))))
    return found


def _stations(bodies: Sequence[Body], tolerance: float) -> tuple[int, int]:
    """How many stations the rods have, and about how many are needed to draw them all to a tolerance [length]."""
    found = {id(body.line): body.line for body in bodies}.values()
    each = [(line.s.size, stations_for(line, tolerance)) for line in found] or [(0, 0)]
    return max(n for n, _ in each), max(needed for _, needed in each)


def _too_few(n: int, needed: int, error: float, settings: Settings) -> str:
    most = f" (a study stores at most {MAX_STATIONS})" if needed > MAX_STATIONS else ""
    return (
        f"{n} stations are too few to draw this rod to within {settings.pixel_error:g} pixels (it could be off by "
        f"{error:.0f}): store about {needed}{most}, with workbench run --stations or with the study's key stations; or "
        "draw the study itself, with workbench scene STUDY"
    )
