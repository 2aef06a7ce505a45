"""Taking a scene: rods in their places are coloured, photographed and written around. Needs OpenGL, as `scenes`."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from solver.problem.errors import InputError
from studies.model import MAX_STATIONS

from ..figures import style
from ..geometry.refinement import stations_for
from ..geometry.tube import Body, Paint
from . import captions, line_breaks, page_layout
from .kinds import Kind
from .page_layout import Bar, Sheet
from .rendering import Shot, View, ends_of, photograph, view_of

PAGE = (1600, 1200)  # pixels at `style.DPI` of one case
COARSEST = 10.0  # pixels that a surface may be off; beyond, it is no picture of that rod


@dataclass(frozen=True)
class Look:
    """How a scene is taken. pixel_error: how far the drawn surface may be from the true one; dpi: of the picture;
    span: the arc lengths between which the rod is drawn, where not all of it; exactly: raise `TooFew` rather than draw
    less well than asked."""

    pixel_error: float = 0.5
    dpi: int = style.DPI
    span: tuple[float, float] | None = None
    exactly: bool = False


AS_USUAL = Look()


@dataclass(frozen=True)
class Room:
    """Pixels at `style.DPI` below each view and before the first."""

    label: int = page_layout.LABEL
    gutter: int = 0


@dataclass(frozen=True, eq=False)
class Taken:
    """A scene. off: by how many pixels its surface may be off; above what was asked where the stations are too few.
    stations: about how many it takes."""

    sheet: Sheet
    off: float
    stations: int


class TooFew(InputError):
    """The stations are too few for the pixel error; `stations`: about how many it takes."""

    def __init__(self, said: str, stations: int) -> None:
        super().__init__(said)
        self.stations = stations


@dataclass(frozen=True, eq=False)
class Scene:
    """What is taken: rods in rows of cells. context: the rods that fix the camera and the scale of colours. told: the
    case in words. bar: of rods that bring their colours."""

    ds: xr.Dataset
    kind: Kind
    rows: Sequence[Sequence[Shot]]
    context: Sequence[Body]
    told: str
    look: Look
    notes: Sequence[str] = ()
    page: tuple[int, int] = PAGE
    bar: Bar | None = None


def in_one_view(scene: Scene, lying: bool = False) -> Taken:
    """Rods before a camera that sees them all, in cells of one size. Raises `InputError`."""
    rows, context, page = scene.rows, scene.context, scene.page
    ends = ends_of(context)
    room = page[0] - 2 * page_layout.MARGIN, page[1] - page_layout.HEAD - page_layout.FOOT
    cell = room[0] // len(rows[0]), room[1] // len(rows) - page_layout.LABEL
    view = _at(view_of(context, ends, cell, lying), scene.look.dpi / style.DPI)
    if context and 2 * context[0].reach * view.per_unit < line_breaks.THINNEST:
        raise InputError(
            f"a cylinder {2 * context[0].reach:.3g} wide and {np.ptp(ends):.4g} long is "
            f"{2 * context[0].reach * view.per_unit:.2g} pixels wide in the picture: give a shorter stretch with "
            "--from and --to, or draw one case, which is set in lines"
        )
    return finished(scene, ends, view)


def finished(scene: Scene, ends: tuple[float, float], view: View, beside: Room = Room()) -> Taken:
    """Paint, photograph and write around it. Raises `TooFew`."""
    ds, kind, look, rows = scene.ds, scene.kind, scene.look, scene.rows
    bar = scene.bar
    if kind.cells != "together":
        paint, bar = _paint(ds, kind, scene.context)
        rows = [[replace(shot, bodies=[replace(b, paint=paint) for b in shot.bodies]) for shot in row] for row in rows]
    n, stations = _stations(rows, look.pixel_error / view.per_unit)
    if look.exactly and stations > n:
        raise TooFew(f"{n} stations are too few, about {stations} are needed", stations)
    pixels, off = photograph(rows, ends, view, look.pixel_error, round(beside.label * look.dpi / style.DPI))
    if off > COARSEST:
        raise TooFew(_too_few(n, stations, off, look), stations)
    notes = list(scene.notes)
    if off > look.pixel_error * (1 + 1e-9):
        notes = [*notes, f"drawn to within {off:.1f} pixels"]
    if kind.cells != "together":
        notes += captions.impossible([body for row in rows for shot in row for body in shot.bodies])
    inside = "inside the cylinder, cut open" if ds.attrs["side"] == "inside" else ""
    subtitle = " · ".join(fact for fact in (scene.told, style.reading(ds), inside) if fact)
    drawn = Sheet(
        str(ds.attrs["title"]), subtitle, pixels, [[shot.cell for shot in row] for row in rows], view.per_unit,
        str(ds.attrs["length_unit"]), view.page.T, captions.legend(kind, scene.context), notes,
        scene.page if scene.page == PAGE else (PAGE[0], 0), bar, look.dpi, beside.label, beside.gutter,
    )  # fmt: skip
    return Taken(drawn, off, stations)


def _at(view: View, finer: float) -> View:
    # cut, not rounded: the page must not grow by a pixel
    return replace(view, per_unit=view.per_unit * finer, size=(int(view.size[0] * finer), int(view.size[1] * finer)))


def _paint(ds: xr.Dataset, kind: Kind, bodies: Sequence[Body]) -> tuple[Paint, Bar | None]:
    """The colours of a kind, one scale for all the rods, and their bar."""
    if kind.tint == "stripe":
        return Paint(style.UNPAINTED, stripe=style.PUSHED), None
    if kind.tint == "one colour" or not bodies:
        return Paint(style.PUSHED), None
    extremes = np.array([body.extremes() for body in bodies])
    low, high = float(extremes[:, 0].min()), float(extremes[:, 1].max())
    if kind.tint == "contact":
        if high <= 0:
            return Paint(style.LIFTED), None
        unit = style.unit(f"{ds.attrs['force_unit']}/{ds.attrs['length_unit']}")
        return (Paint(ramp=style.PUSH_RAMP, high=high, below=style.LIFTED),
                Bar(style.PUSH_RAMP, 0.0, high, f"push of the cylinder [{unit}]"))  # fmt: skip
    if high - low < 1e-9 * high or high == 0:
        return Paint(style.PUSHED), None
    bar = Bar(style.RAMP, low, high, f"curvature κ [1/{ds.attrs['length_unit']}]")
    return Paint(ramp=style.RAMP, low=low, high=high), bar


def _stations(rows: Sequence[Sequence[Shot]], tolerance: float) -> tuple[int, int]:
    """How many stations the rods have, and about how many it takes to draw them all to a tolerance [length]."""
    found = {id(body.line): body.line for row in rows for shot in row for body in shot.bodies}.values()
    each = [(line.s.size, stations_for(line, tolerance)) for line in found] or [(0, 0)]
    return max(n for n, _ in each), max(needed for _, needed in each)


def _too_few(n: int, needed: int, off: float, look: Look) -> str:
    most = f" (a study stores at most {MAX_STATIONS})" if needed > MAX_STATIONS else ""
    return (
        f"{n} stations are too few to draw this rod to within {look.pixel_error:g} pixels (it could be off by "
        f"{off:.0f}): store about {needed}{most}, with workbench run --stations or with the study's key stations; or "
        "draw the study itself, with workbench scene STUDY"
    )
