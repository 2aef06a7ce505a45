"""The rod on its cylinder in three dimensions: off-screen pictures of a stored dataset, never solving.

The tube has the rod's true radius and touches the surface; where the cylinder would have to pull to hold it
there, it has a colour of its own. All views are parallel projections, so one scale bar is right everywhere.
Needs OpenGL: ask `opengl.probe` first, as without it VTK ends the process.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from solver.problem.errors import InputError

from ..data import labels, selection
from ..data.schema import axes_of
from ..figures import canvas, style
from . import body as rods
from . import captions, colours, long_rod, page
from .body import Body
from .colours import Bar, Paint
from .composition import DEFAULT, SIZE, Picture, Room, Scene, Settings, composed, in_one_view
from .kinds import Kind, kind_of
from .page import Cell
from .rendering import View, ends_of, side_camera

SUFFIXES = (".png", ".jpg")
LYING = 1.3  # how much taller than wide a scene must be to be laid on its side
MOST_COLUMNS, MOST_ROWS = 9, 5
ROW, GRID = (2000, 1100), (2000, 2000)  # pixels at `style.DPI` of a row and of a grid
DPIS = (50, 600)
GUTTER = 130  # pixels before the lines of a long rod
GHOST = 0.3  # of its thickness is a rod drawn among others, so that none hides another


def render(
    ds: xr.Dataset,
    path: str | Path,
    at: Mapping[str, float] | None = None,
    kind: str = "contact",
    axes: Sequence[str] = (),
    along: str | None = None,
    settings: Settings = DEFAULT,
) -> Picture:
    """Draw a scene and save it; parameters as of `compose`."""
    path = canvas.check_name(path, SUFFIXES)
    picture = compose(ds, at, kind, axes, along, settings)
    canvas.save(page.figure(picture.page), path, settings.dpi, SUFFIXES)
    return picture


def render_row(ds: xr.Dataset, path: str | Path, axis: str, at: Mapping[str, float] | None = None) -> Path:
    """Draw the cases along an axis side by side, at one scale and with one camera. Raises `InputError`."""
    render(ds, path, at, "grid", [axis])
    return Path(path)


def draw(ds: xr.Dataset, path: str | Path) -> dict[str, Path]:
    """Draw the scenes of a study: a row along each axis, or the one case large.

    path: of the file; with several axes each row's file has the axis's name appended. Returns name -> file. Raises
    `InputError`.
    """
    path = Path(path)
    axes = axes_of(ds)
    if not axes:
        render(ds, path)
        return {"scene": path}
    files = {axis: path.with_stem(f"{path.stem}_{axis}") if len(axes) > 1 else path for axis in axes}
    return {f"scene {axis}": render_row(ds, file, axis) for axis, file in files.items()}


def compose(
    ds: xr.Dataset,
    at: Mapping[str, float] | None = None,
    kind: str = "contact",
    axes: Sequence[str] = (),
    along: str | None = None,
    settings: Settings = DEFAULT,
) -> Picture:
    """The scene of a dataset. A case without a shape leaves an empty cell with the reason.

    Parameters
    ----------
    at
        Values of axes, which are stored; default: those of the study's laws or of Table 1.
    kind
        A name of `kinds.KINDS`.
    axes
        The axis or two that a scene of several cases shows; default: the dataset's first.
    along
        An axis whose cases fix the camera and the colour scale of a scene of one of them.

    Raises
    ------
    InputError
        An invalid name or value, one case without a shape, stations that are far too few.
    """
    chosen, along = kind_of(kind), along and selection.axis_of(ds, along)
    _check(settings)
    if chosen.cells == "one":
        if axes:
            raise InputError(f"a scene of kind {kind} shows one case, so it takes no axis; choose ghosts or grid")
        return _one(ds, chosen, selection.case(ds, at), along, settings)
    if along:
        raise InputError(f"a scene of kind {kind} shows a whole axis already: it takes no --along")
    chosen.check(ds)
    names = [selection.axis_of(ds, name) for name in axes] or axes_of(ds)[:1]
    most = 1 if chosen.cells == "together" else 2
    if not names:
        raise InputError(f"a scene of kind {kind} shows the cases of an axis, and the study has none")
    if len(names) > most:
        raise InputError(f"a scene of kind {kind} shows at most {most} of the axes {', '.join(names)}")
    if chosen.cells == "together":
        return _together(ds, chosen, names[0], at, settings)
    return _each(ds, chosen, names, at, settings)


def _one(ds: xr.Dataset, kind: Kind, where: dict[str, int], along: str | None, settings: Settings) -> Picture:
    """One case large, from its front and from its side; a long one in lines."""
    case = captions.case_values(ds, where)
    body, why = _body(ds, where, kind, settings)
    if body is None:
        raise InputError(f"nothing to draw{f' at {case}' if case else ''}: {why}")
    context = [body]
    if along:
        at = {name: float(ds[name].values[i]) for name, i in where.items() if name != along}
        cases = selection.line(ds, along, at)
        context = [found for each in cases if (found := _body(ds, each, kind, settings)[0])]
    notes = captions.part_drawn([body], str(ds.attrs["length_unit"]))
    if long_rod.is_long(context):
        return _in_lines(ds, kind, body, context, case, settings, notes)
    lying = np.ptp(ends_of(context)) > LYING * 2 * body.reach
    front = View([body], Cell("facing the rod"))
    side = View([body], Cell("turned by 90° about the axis"), -np.pi / 2)
    rows = [[front], [side]] if lying else [[front, side]]
    return in_one_view(Scene(ds, kind, rows, context, case, settings, notes), bool(lying))


def _in_lines(
    ds: xr.Dataset, kind: Kind, body: Body, context: Sequence[Body], case: str, settings: Settings, notes: list[str]
) -> Picture:
    """All of a rod that would be too thin to see in one view."""
    finer = settings.dpi / style.DPI
    room = SIZE[0] - 2 * page.MARGIN - GUTTER, SIZE[1] - page.HEAD - page.FOOT
    room = int(room[0] * finer), int(room[1] * finer)
    lines = long_rod.lines_for(context, room)
    size = int((lines.ends[1] - lines.ends[0]) * lines.per_unit), room[1] // lines.count
    camera = side_camera(context, lines.ends, lines.per_unit, size)
    pieces, unit = lines.cut(body), str(ds.attrs["length_unit"])
    rows = [[View([piece], cell, clear=True)] for piece, cell in zip(pieces, lines.cells(pieces, unit), strict=True)]
    notes = [*lines.notes(pieces, unit), *notes]
    return composed(Scene(ds, kind, rows, context, case, settings, notes), lines.ends, camera, Room(0, GUTTER))


def _each(ds: xr.Dataset, kind: Kind, names: list[str], at: Mapping[str, float] | None, settings: Settings) -> Picture:
    """The cases of an axis in a row or two, or of two axes in a table."""
    line = selection.line(ds, names[0], at)
    cases = _table(ds, kind, names, at, line)
    rows, bodies = [], []
    for row in cases:
        views = []
        for where in row:
            body, why = _body(ds, where, kind, settings)
            body = rods.beginning(body) if body and not settings.span else body
            views.append(View([body] if body else [], Cell(kind.caption(ds, names, where), why), clear=True))
            bodies += [body] if body else []
        rows.append(views)
    rows[-1] += [View([], Cell("")) for _ in range(len(rows[0]) - len(rows[-1]))]
    held = {k: i for k, i in cases[0][0].items() if k not in names}
    case = ", ".join([*(labels.axis_label(n, ds[n], len(names) == 1) for n in names if n != "equilibrium"),
                      *captions.values(ds, held)])  # fmt: skip
    shown = {names[0]: (sum(map(len, cases)) if len(names) == 1 else len(cases[0]), len(line))}
    if len(names) == 2:
        shown[names[1]] = len(cases), ds.sizes[names[1]]
    notes = [f"{count} of {of} values of {labels.axis_symbol(name) if name != 'equilibrium' else 'the list'}"
             for name, (count, of) in shown.items() if count < of]  # fmt: skip
    notes += [*captions.part_drawn(bodies, str(ds.attrs["length_unit"])), *kind.notes]
    size = ROW if len(rows) == 1 else GRID
    return in_one_view(Scene(ds, kind, rows, bodies, case, settings, notes, size))


def _table(
    ds: xr.Dataset, kind: Kind, names: list[str], at: Mapping[str, float] | None, line: list[dict[str, int]]
) -> list[list[dict[str, int]]]:
    """The cases that are shown, row by row."""
    if len(names) == 2:
        across = selection.spread(line, kind.most)
        down = selection.spread(selection.line(ds, names[1], at), MOST_ROWS)
        return [[{**case, names[1]: row[names[1]]} for case in across] for row in down]
    cases = selection.spread(line, kind.most)
    half = -(-len(cases) // 2)
    return [cases] if len(cases) <= MOST_COLUMNS else [cases[:half], cases[half:]]


def _together(ds: xr.Dataset, kind: Kind, axis: str, at: Mapping[str, float] | None, settings: Settings) -> Picture:
    """The cases of an axis on one cylinder, thin, each in the colour of its value."""
    line = selection.line(ds, axis, at)
    cases = selection.spread(line, kind.most)
    values = labels.in_label_unit(ds[axis], ds[axis].values.astype(float)[[where[axis] for where in cases]])
    low, high = float(values.min()), float(values.max())
    bodies = []
    for where, value in zip(cases, values, strict=True):
        body, _ = _body(ds, where, kind, settings)
        if body:
            share = (float(value) - low) / ((high - low) or 1.0)
            colour = colours.hex_of(style.RAMP, share * style.RAMP_ENDS[1])
            body = body if settings.span else rods.beginning(body)
            bodies.append(replace(body, line=replace(body.line, a=GHOST * body.a), paint=Paint(colour)))
    if not bodies:
        raise InputError(f"nothing to draw along {axis}: no case of it has a shape")
    lying = np.ptp(ends_of(bodies)) > LYING * 2 * bodies[0].reach
    views = [View(bodies, Cell("facing the rods")), View(bodies, Cell("turned by 90° about the axis"), -np.pi / 2)]
    case = ", ".join(captions.values(ds, {k: i for k, i in cases[0].items() if k != axis}))
    notes = [f"{len(cases)} of {len(line)} values"] if len(cases) < len(line) else []
    notes += [f"drawn at {GHOST:g} of the thickness"]
    notes += captions.part_drawn(bodies, str(ds.attrs["length_unit"]))
    rows = [[view] for view in views] if lying else [views]
    bar = Bar(colours.AXIS_RAMP, low, high, labels.axis_label(axis, ds[axis])) if high > low else None
    return in_one_view(Scene(ds, kind, rows, bodies, case, settings, notes, bar=bar), bool(lying))


def _body(ds: xr.Dataset, where: dict[str, int], kind: Kind, settings: Settings) -> tuple[Body | None, str]:
    """The rod of a case, or why there is none. Raises `InputError` for a part that is not on the rod."""
    if not ds["solved"].isel(where):
        return None, str(ds["outcome"].isel(where).values)
    span = settings.span
    body = rods.read(ds, where, kind, span)
    if span and not 0 <= span[0] < span[1] <= body.line.L * (1 + 1e-9):
        raise InputError(
            f"no part from {span[0]:g} to {span[1]:g} on a rod of length {body.line.L:g}: give --from and --to with "
            "0 <= from < to <= L"
        )
    return body, ""


def _check(settings: Settings) -> None:
    if not 0.01 <= settings.pixel_error <= 10:
        raise InputError(f"--pixel-error must be between 0.01 and 10 pixels, got {settings.pixel_error:g}")
    if not DPIS[0] <= settings.dpi <= DPIS[1]:
        raise InputError(f"--dpi must be between {DPIS[0]} and {DPIS[1]}, got {settings.dpi}")
