"""The rod on its cylinder in three dimensions: off-screen pictures of a stored dataset, never solving.

The tube has the rod's true radius and touches the surface; where the cylinder would have to pull to hold it
there, it has a colour of its own. All views are parallel projections, so one scale bar is right everywhere.
Needs OpenGL: ask `gl.probe` first, as without it VTK ends the process.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr

from solver.errors import InputError
from studies.model import MAX_STATIONS

from . import captions, lines, picking, sheet, style, tube
from .dataset import axes_of
from .detail import stations_for
from .kinds import Kind, kind_of
from .sheet import Bar, Cell, Sheet
from .stage import Shot, View, ends_of, photograph, side_view, view_of
from .tube import Body, Paint

ENDINGS = (".png", ".jpg")
LYING = 1.3  # how much taller than wide a scene is laid on its side
MOST_CELLS, MOST_GHOSTS, MOST_ROWS = 9, 5, 5
PAGE, ROW, GRID = (1600, 1200), (2000, 1100), (2000, 2000)  # pixels at `style.DPI` of one case, a row and a grid
DPIS = (50, 600)
COARSEST = 10.0  # pixels that a surface may be off; beyond, it is no picture of that rod
GUTTER = 130  # pixels before the lines of a long rod
GHOST = 0.3  # of its thickness is a rod drawn among others, so that none hides another


@dataclass(frozen=True)
class Look:
    """How a scene is taken. pixel_error: how far the drawn surface may be from the true one; dpi: of the picture;
    span: the arc lengths between which the rod is drawn, where not all of it; exactly: raise `TooFew` rather than draw
    less well than asked."""

    pixel_error: float = 0.5
    dpi: int = style.DPI
    span: tuple[float, float] | None = None
    exactly: bool = False


@dataclass(frozen=True)
class Room:
    """Pixels at `style.DPI` below each view and before the first."""

    label: int = sheet.LABEL
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


def render(
    ds: xr.Dataset,
    path: str | Path,
    at: Mapping[str, float] | None = None,
    kind: str = "contact",
    axes: Sequence[str] = (),
    along: str | None = None,
    look: Look = Look(),
) -> Taken:
    """Draw a scene and save it; what `take` takes."""
    path = Path(path)
    style.picture_kind(path, ENDINGS)
    taken = take(ds, at, kind, axes, along, look)
    sheet.figure(taken.sheet).savefig(path, dpi=look.dpi)
    return taken


def render_row(ds: xr.Dataset, path: str | Path, axis: str, at: Mapping[str, float] | None = None) -> Path:
    """Draw the cases along an axis side by side, at one scale and with one camera. Raises `InputError`."""
    render(ds, path, at, "grid", [axis])
    return Path(path)


def draw(ds: xr.Dataset, path: str | Path) -> dict[str, Path]:
    """The scenes of a study, name -> file: a row along each axis, or the one case large. Raises `InputError`.

    path: of the file; with several axes each row's file has the axis's name appended.
    """
    path = Path(path)
    axes = axes_of(ds)
    if not axes:
        render(ds, path)
        return {"scene": path}
    files = {axis: path.with_stem(f"{path.stem}_{axis}") if len(axes) > 1 else path for axis in axes}
    return {f"scene {axis}": render_row(ds, file, axis) for axis, file in files.items()}


def take(
    ds: xr.Dataset,
    at: Mapping[str, float] | None = None,
    kind: str = "contact",
    axes: Sequence[str] = (),
    along: str | None = None,
    look: Look = Look(),
) -> Taken:
    """The scene of a dataset.

    at: values of axes, which are stored; the study's own where left out. kind: a name of `kinds.KINDS`. axes: for
    ghosts, grid and equilibria the axis or two that they show, the dataset's first where left out. along: an axis whose
    cases fix the camera and the colour scale of a scene of one of them. A case without a shape leaves a cell that says
    why.
    Raises `InputError` for what is not there, for one case without a shape, and where the stations are far too few.
    """
    chosen = kind_of(kind)
    _check(look)
    if chosen.cells == "one":
        if axes:
            raise InputError(f"a scene of kind {kind} shows one case, so it takes no axis; choose ghosts or grid")
        return _one(ds, chosen, picking.case(ds, at), along, look)
    if along:
        raise InputError(f"a scene of kind {kind} shows a whole axis already: it takes no --along")
    names = list(axes) or axes_of(ds)[:1]
    if kind == "equilibria" and axes_of(ds) != ["equilibrium"]:
        raise InputError("a scene of kind equilibria takes a dataset that `workbench equilibria --out FILE` stored")
    if not names:
        raise InputError(f"a scene of kind {kind} shows the cases of an axis, and the study has none")
    if len(names) > (1 if chosen.cells == "together" else 2):
        raise InputError(f"a scene of kind {kind} shows too few axes for {', '.join(names)}")
    if chosen.cells == "together":
        return _together(ds, chosen, names[0], at, look)
    return _each(ds, chosen, names, at, look)


def _one(ds: xr.Dataset, kind: Kind, where: dict[str, int], along: str | None, look: Look) -> Taken:
    """One case large, from its front and from its side; a long one in lines."""
    told = captions.described(ds, where)
    body, why = _try(ds, where, kind, look)
    if body is None:
        raise InputError(f"nothing to draw{f' at {told}' if told else ''}: {why}")
    context = [body]
    if along:
        at = {name: float(ds[name].values[i]) for name, i in where.items() if name != along}
        context = [found for case in picking.line(ds, along, at) if (found := _try(ds, case, kind, look)[0])]
    notes = [] if body.whole else captions.covered([body], str(ds.attrs["length_unit"]))
    if lines.is_long(context):
        return _in_lines(ds, kind, body, context, told, look, notes)
    lying = np.ptp(ends_of(context)) > LYING * 2 * body.reach
    front = Shot([body], Cell("facing the rod"))
    side = Shot([body], Cell("turned by 90° about the axis"), -np.pi / 2)
    return _taken(ds, kind, [[front], [side]] if lying else [[front, side]], context, told, PAGE, look, lying, notes)


def _in_lines(
    ds: xr.Dataset, kind: Kind, body: Body, context: Sequence[Body], told: str, look: Look, notes: list[str]
) -> Taken:
    """A rod that would be a hair in one view, all of it."""
    finer = look.dpi / style.DPI
    room = PAGE[0] - 2 * sheet.MARGIN - GUTTER, PAGE[1] - sheet.HEAD - sheet.FOOT
    room = int(room[0] * finer), int(room[1] * finer)
    found = lines.lines_for(context, room)
    size = int((found.ends[1] - found.ends[0]) * found.per_unit), room[1] // found.count
    view = side_view(context, found.ends, found.per_unit, size)
    pieces, unit = found.cut(body), str(ds.attrs["length_unit"])
    rows = [[Shot([piece], cell, clear=True)] for piece, cell in zip(pieces, found.cells(pieces, unit), strict=True)]
    notes = [*found.told(pieces, unit), *notes]
    return _finished(ds, kind, rows, context, told, PAGE, look, found.ends, view, notes, None, Room(0, GUTTER))


def _each(ds: xr.Dataset, kind: Kind, names: list[str], at: Mapping[str, float] | None, look: Look) -> Taken:
    """The cases of an axis in a row, or of two axes in a table."""
    first = picking.line(ds, names[0], at)
    most = MOST_CELLS if kind.name != "equilibria" else 2 * MOST_CELLS
    cases = [picking.spread(first, most)]
    if len(names) == 2:
        down = picking.spread(picking.line(ds, names[1], at), MOST_ROWS)
        cases = [[{**case, names[1]: row[names[1]]} for case in cases[0]] for row in down]
    elif len(cases[0]) > MOST_CELLS:
        half = -(-len(cases[0]) // 2)
        cases = [cases[0][:half], cases[0][half:]]
    rows, bodies = [], []
    for row in cases:
        shots = []
        for where in row:
            body, why = _try(ds, where, kind, look)
            body = tube.beginning(body) if body and not look.span else body
            shots.append(Shot([body] if body else [], Cell(captions.under(ds, kind, names, where), why)))
            bodies += [body] if body else []
        rows.append(shots)
    rows[-1] += [Shot([], Cell("")) for _ in range(len(rows[0]) - len(rows[-1]))]
    told = ", ".join([*(style.axis_label(n, ds[n], len(names) == 1) for n in names if n != "equilibrium"),
                      *captions.facts(ds, {k: i for k, i in cases[0][0].items() if k not in names})])  # fmt: skip
    notes = [] if len(first) <= len(cases[0]) * len(cases) else [f"{len(cases[0])} of {len(first)} values"]
    part = [body for body in bodies if not body.whole]
    notes += captions.covered(part[:1], str(ds.attrs["length_unit"]))
    notes += ["below each shape its energy"] if kind.name == "equilibria" else []
    page = ROW if len(rows) == 1 else GRID
    return _taken(ds, kind, rows, bodies, told, page, look, False, notes)


def _together(ds: xr.Dataset, kind: Kind, axis: str, at: Mapping[str, float] | None, look: Look) -> Taken:
    """The cases of an axis on one cylinder, thin, each in the colour of its value."""
    line = picking.line(ds, axis, at)
    cases = picking.spread(line, MOST_GHOSTS)
    values = ds[axis].values.astype(float)[[where[axis] for where in cases]]
    values = np.degrees(values) if style.is_angle(ds[axis]) else values
    low, high = float(values.min()), float(values.max())
    bodies = []
    for where, value in zip(cases, values, strict=True):
        body, _ = _try(ds, where, kind, look)
        if body:
            share = (float(value) - low) / ((high - low) or 1.0)
            colour = style.hex_of(style.RAMP, share * style.RAMP_ENDS[1])
            body = body if look.span else tube.beginning(body)
            bodies.append(replace(body, line=replace(body.line, a=GHOST * body.a), paint=Paint(colour)))
    if not bodies:
        raise InputError(f"nothing to draw along {axis}: no case of it has a shape")
    lying = np.ptp(ends_of(bodies)) > LYING * 2 * bodies[0].reach
    shots = [Shot(bodies, Cell("facing the rods")), Shot(bodies, Cell("turned by 90° about the axis"), -np.pi / 2)]
    told = ", ".join(captions.facts(ds, {k: i for k, i in cases[0].items() if k != axis}))
    notes = [f"{len(cases)} of {len(line)} values"] if len(cases) < len(line) else []
    notes += [f"drawn at {GHOST:g} of the thickness"]
    notes += captions.covered([body for body in bodies if not body.whole][:1], str(ds.attrs["length_unit"]))
    rows = [[shot] for shot in shots] if lying else [shots]
    bar = Bar(style.ramp_part(), low, high, style.axis_label(axis, ds[axis])) if high > low else None
    return _taken(ds, kind, rows, bodies, told, PAGE, look, lying, notes, bar)


def _taken(
    ds: xr.Dataset,
    kind: Kind,
    rows: Sequence[Sequence[Shot]],
    context: Sequence[Body],
    told: str,
    page: tuple[int, int],
    look: Look,
    lying: bool,
    notes: list[str],
    bar: Bar | None = None,
) -> Taken:
    """Rods before a camera that sees them all, in cells of one size; context: the rods that fix it."""
    finer = look.dpi / style.DPI
    ends = ends_of(context)
    room = page[0] - 2 * sheet.MARGIN, page[1] - sheet.HEAD - sheet.FOOT
    cell = room[0] // len(rows[0]), room[1] // len(rows) - sheet.LABEL
    view = _at(view_of(context, ends, cell, lying), finer)
    if context and 2 * context[0].reach * view.per_unit < lines.THINNEST:
        raise InputError(
            f"a cylinder {2 * context[0].reach:.3g} wide and {np.ptp(ends):.4g} long is "
            f"{2 * context[0].reach * view.per_unit:.2g} pixels wide in the picture: give a shorter stretch with "
            "--from and --to, or draw one case, which is set in lines"
        )
    return _finished(ds, kind, rows, context, told, page, look, ends, view, notes, bar, Room())


def _finished(
    ds: xr.Dataset,
    kind: Kind,
    rows: Sequence[Sequence[Shot]],
    context: Sequence[Body],
    told: str,
    page: tuple[int, int],
    look: Look,
    ends: tuple[float, float],
    view: View,
    notes: list[str],
    bar: Bar | None,
    beside: Room,
) -> Taken:
    """Paint, photograph and write around it; context: the rods that fix the scale of colours."""
    finer = look.dpi / style.DPI
    if kind.cells != "together":
        paint, bar = _paint(ds, kind, context)
        rows = [[replace(shot, bodies=[replace(b, paint=paint) for b in shot.bodies]) for shot in row] for row in rows]
    n, stations = _stations(rows, look.pixel_error / view.per_unit)
    if look.exactly and stations > n:
        raise TooFew(f"{n} stations are too few, about {stations} are needed", stations)
    pixels, off = photograph(rows, ends, view, look.pixel_error, round(beside.label * finer))
    if off > COARSEST:
        raise TooFew(_too_few(n, stations, off, look), stations)
    if off > look.pixel_error * (1 + 1e-9):
        notes = [
            *notes,
            f"drawn to within {off:.1f} pixels",
        ]
    if kind.cells != "together" and any(body.overlaps for row in rows for shot in row for body in shot.bodies):
        notes = [*notes, "the rod passes through itself"]
    inside = "inside the cylinder, cut open" if ds.attrs["side"] == "inside" else ""
    subtitle = " · ".join(fact for fact in (told, style.reading(ds), inside) if fact)
    drawn = Sheet(
        str(ds.attrs["title"]), subtitle, pixels, [[shot.cell for shot in row] for row in rows], view.per_unit,
        str(ds.attrs["length_unit"]), view.page.T, captions.legend(kind, context), notes,
        page if page == PAGE else (PAGE[0], 0), bar, look.dpi, beside.label, beside.gutter,
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


def _try(ds: xr.Dataset, where: dict[str, int], kind: Kind, look: Look) -> tuple[Body | None, str]:
    """The rod, or why there is none. Raises `InputError` for a stretch that is not on the rod."""
    outcome = str(ds["outcome"].isel(where).values)
    if not outcome.startswith("solved"):
        return None, outcome
    body = tube.read(ds, where, kind, look.span)
    if look.span and not 0 <= look.span[0] < look.span[1] <= body.line.L * (1 + 1e-9):
        raise InputError(
            f"no stretch from {look.span[0]:g} to {look.span[1]:g} on a rod of length {body.line.L:g}: give --from "
            "and --to with 0 <= from < to <= L"
        )
    return body, ""


def _check(look: Look) -> None:
    if not 0.01 <= look.pixel_error <= 10:
        raise InputError(f"--pixel-error must be between 0.01 and 10 pixels, got {look.pixel_error:g}")
    if not DPIS[0] <= look.dpi <= DPIS[1]:
        raise InputError(f"--dpi must be between {DPIS[0]} and {DPIS[1]}, got {look.dpi}")


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
