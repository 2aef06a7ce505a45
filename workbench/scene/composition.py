"""A scene composed: rods in their cells are coloured, rendered, and set on a page. Needs OpenGL."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from solver.problem.errors import InputError
from studies.model import MAX_STATIONS

from ..data import labels
from ..figures import style
from ..geometry.refinement import stations_for
from . import captions, long_rod, page
from .body import Body
from .colours import Bar
from .kinds import Kind
from .page import Page
from .rendering import MOST_PIXELS, Camera, View, ends_of, front_camera, render

SIZE = (1600, 1200)  # pixels at `style.DPI` of the page of one case
COARSEST = 10.0  # pixels that a surface may be off; beyond, it is no picture of that rod


@dataclass(frozen=True)
class Settings:
    """How a scene is drawn.

    Attributes
    ----------
    pixel_error
        The error allowed of the drawn surface in pixels.
    dpi
        Pixels per inch of the picture.
    span
        The arc lengths between which the rod is drawn [length]; default: all of it.
    strict
        Raise `TooFewStations` where the stations do not allow the pixel error; default: draw as well as they allow.
    most_pixels
        Of a picture that is rendered at once.
    """

    pixel_error: float = 0.5
    dpi: int = style.DPI
    span: tuple[float, float] | None = None
    strict: bool = False
    most_pixels: int = MOST_PIXELS


DEFAULT = Settings()


@dataclass(frozen=True)
class Room:
    """Pixels at `style.DPI` below each view and before the first."""

    caption: int = page.CAPTION
    gutter: int = 0


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
        The rods that fix the camera and the scale of colours.
    case
        The case in words.
    size
        Least size of the page in pixels at `style.DPI`.
    bar
        The colour bar of rods that already have their colours.
    """

    ds: xr.Dataset
    kind: Kind
    rows: Sequence[Sequence[View]]
    context: Sequence[Body]
    case: str
    settings: Settings
    notes: Sequence[str] = ()
    size: tuple[int, int] = SIZE
    bar: Bar | None = None


def in_one_view(scene: Scene, lying: bool = False) -> Picture:
    """Rods before a camera that sees all of them, in cells of one size. Raises `InputError`."""
    rows, context, size = scene.rows, scene.context, scene.size
    ends = ends_of(context)
    room = size[0] - 2 * page.MARGIN, size[1] - page.HEAD - page.FOOT
    cell = room[0] // len(rows[0]), room[1] // len(rows) - page.CAPTION
    camera = _at_dpi(front_camera(context, ends, cell, lying), scene.settings.dpi / style.DPI)
    if context and 2 * context[0].reach * camera.per_unit < long_rod.THINNEST:
        raise InputError(
            f"a cylinder {2 * context[0].reach:.3g} wide and {np.ptp(ends):.4g} long is "
            f"{2 * context[0].reach * camera.per_unit:.2g} pixels wide in the picture: draw a shorter part with "
            "--from and --to, or draw one case, which is set in lines"
        )
    return composed(scene, ends, camera)


def composed(scene: Scene, ends: tuple[float, float], camera: Camera, beside: Room = Room()) -> Picture:
    """Colour the rods, render them, and set the page. Raises `TooFewStations`."""
    ds, kind, settings, rows = scene.ds, scene.kind, scene.settings, scene.rows
    bar, together = scene.bar, kind.cells == "together"
    if not together:
        paint, bar = kind.paint(ds, scene.context)
        rows = [[replace(view, bodies=[replace(b, paint=paint) for b in view.bodies]) for view in row] for row in rows]
    n, stations = _stations(rows, settings.pixel_error / camera.per_unit)
    if settings.strict and stations > n:
        raise TooFewStations(f"{n} stations are too few, about {stations} are needed", stations)
    caption = round(beside.caption * settings.dpi / style.DPI)
    pixels, error = render(rows, ends, camera, settings.pixel_error, caption, settings.most_pixels)
    if error > COARSEST:
        raise TooFewStations(_too_few(n, stations, error, settings), stations)
    notes = list(scene.notes)
    if error > settings.pixel_error * (1 + 1e-9):
        notes = [*notes, f"drawn to within {error:.1f} pixels"]
    if not together:
        notes += captions.impossible([body for row in rows for view in row for body in view.bodies])
    inside = "inside the cylinder, cut open" if ds.attrs["side"] == "inside" else ""
    subtitle = " · ".join(fact for fact in (scene.case, labels.reading(ds), inside) if fact)
    composed_page = Page(
        str(ds.attrs["title"]), subtitle, pixels, [[view.cell for view in row] for row in rows], camera.per_unit,
        str(ds.attrs["length_unit"]), camera.page.T, kind.legend(scene.context), notes,
        scene.size if scene.size == SIZE else (SIZE[0], 0), bar, settings.dpi, beside.caption, beside.gutter,
    )  # fmt: skip
    return Picture(composed_page, error, stations)


def _at_dpi(camera: Camera, finer: float) -> Camera:
    # cut, not rounded: the page must not grow by a pixel
    size = int(camera.size[0] * finer), int(camera.size[1] * finer)
    return replace(camera, per_unit=camera.per_unit * finer, size=size)


def _stations(rows: Sequence[Sequence[View]], tolerance: float) -> tuple[int, int]:
    """How many stations the rods have, and about how many are needed to draw them all to a tolerance [length]."""
    found = {id(body.line): body.line for row in rows for view in row for body in view.bodies}.values()
    each = [(line.s.size, stations_for(line, tolerance)) for line in found] or [(0, 0)]
    return max(n for n, _ in each), max(needed for _, needed in each)


def _too_few(n: int, needed: int, error: float, settings: Settings) -> str:
    most = f" (a study stores at most {MAX_STATIONS})" if needed > MAX_STATIONS else ""
    return (
        f"{n} stations are too few to draw this rod to within {settings.pixel_error:g} pixels (it could be off by "
        f"{error:.0f}): store about {needed}{most}, with workbench run --stations or with the study's key stations; or "
        "draw the study itself, with workbench scene STUDY"
    )
