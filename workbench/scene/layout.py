"""The rod on its cylinder in three dimensions: off-screen pictures of a stored dataset, never solving.

The tube has the rod's true radius and touches the surface; where the cylinder would have to pull to hold it
there, it has a colour of its own. All views are parallel projections, so one scale bar is right everywhere.
Needs OpenGL: ask `gl.probe` first, as without it VTK ends the process.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from solver.problem.errors import InputError

from ..data import selection
from ..data.schema import axes_of
from ..figures import style
from ..geometry import tube
from ..geometry.tube import Body, Paint
from . import captions, line_breaks, page_layout
from .composition import AS_USUAL, PAGE, Look, Room, Scene, Taken, finished, in_one_view
from .kinds import Kind, kind_of
from .page_layout import Bar, Cell
from .rendering import Shot, ends_of, side_view

ENDINGS = (".png", ".jpg")
LYING = 1.3  # how much taller than wide a scene is laid on its side
MOST_CELLS, MOST_GHOSTS, MOST_ROWS = 9, 5, 5
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
    look: Look = AS_USUAL,
) -> Taken:
    """Draw a scene and save it; what `take` takes."""
    path = Path(path)
    style.picture_kind(path, ENDINGS)
    taken = take(ds, at, kind, axes, along, look)
    page_layout.figure(taken.sheet).savefig(path, dpi=look.dpi)
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
    look: Look = AS_USUAL,
) -> Taken:
    """The scene of a dataset.

    at: values of axes, which are stored; the study's own where left out. kind: a name of `kinds.KINDS`. axes: for
    ghosts, grid and equilibria the axis or two that they show, the dataset's first where left out. along: an axis whose
    cases fix the camera and the colour scale of a scene of one of them. A case without a shape leaves a cell that says
    why.
    Raises `InputError` for what is not there, for one case without a shape, and where the stations are far too few.
    """
    chosen, along = kind_of(kind), along and selection.axis_of(ds, along)
    _check(look)
    if chosen.cells == "one":
        if axes:
            raise InputError(f"a scene of kind {kind} shows one case, so it takes no axis; choose ghosts or grid")
        return _one(ds, chosen, selection.case(ds, at), along, look)
    if along:
        raise InputError(f"a scene of kind {kind} shows a whole axis already: it takes no --along")
    names = [selection.axis_of(ds, name) for name in axes] or axes_of(ds)[:1]
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
        context = [found for case in selection.line(ds, along, at) if (found := _try(ds, case, kind, look)[0])]
    notes = [] if body.whole else captions.covered([body], str(ds.attrs["length_unit"]))
    if line_breaks.is_long(context):
        return _in_lines(ds, kind, body, context, told, look, notes)
    lying = np.ptp(ends_of(context)) > LYING * 2 * body.reach
    front = Shot([body], Cell("facing the rod"))
    side = Shot([body], Cell("turned by 90° about the axis"), -np.pi / 2)
    rows = [[front], [side]] if lying else [[front, side]]
    return in_one_view(Scene(ds, kind, rows, context, told, look, notes), bool(lying))


def _in_lines(
    ds: xr.Dataset, kind: Kind, body: Body, context: Sequence[Body], told: str, look: Look, notes: list[str]
) -> Taken:
    """A rod that would be a hair in one view, all of it."""
    finer = look.dpi / style.DPI
    room = PAGE[0] - 2 * page_layout.MARGIN - GUTTER, PAGE[1] - page_layout.HEAD - page_layout.FOOT
    room = int(room[0] * finer), int(room[1] * finer)
    found = line_breaks.lines_for(context, room)
    size = int((found.ends[1] - found.ends[0]) * found.per_unit), room[1] // found.count
    view = side_view(context, found.ends, found.per_unit, size)
    pieces, unit = found.cut(body), str(ds.attrs["length_unit"])
    rows = [[Shot([piece], cell, clear=True)] for piece, cell in zip(pieces, found.cells(pieces, unit), strict=True)]
    notes = [*found.told(pieces, unit), *notes]
    return finished(Scene(ds, kind, rows, context, told, look, notes), found.ends, view, Room(0, GUTTER))


def _each(ds: xr.Dataset, kind: Kind, names: list[str], at: Mapping[str, float] | None, look: Look) -> Taken:
    """The cases of an axis in a row, or of two axes in a table."""
    first = selection.line(ds, names[0], at)
    most = MOST_CELLS if kind.name != "equilibria" else 2 * MOST_CELLS
    cases = [selection.spread(first, most)]
    if len(names) == 2:
        down = selection.spread(selection.line(ds, names[1], at), MOST_ROWS)
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
            cell = Cell(captions.under(ds, kind, names, where), why)
            shots.append(Shot([body] if body else [], cell, clear=True))
            bodies += [body] if body else []
        rows.append(shots)
    rows[-1] += [Shot([], Cell("")) for _ in range(len(rows[0]) - len(rows[-1]))]
    told = ", ".join([*(style.axis_label(n, ds[n], len(names) == 1) for n in names if n != "equilibrium"),
                      *captions.facts(ds, {k: i for k, i in cases[0][0].items() if k not in names})])  # fmt: skip
    shown = {names[0]: (sum(map(len, cases)) if len(names) == 1 else len(cases[0]), len(first))}
    if len(names) == 2:
        shown[names[1]] = len(cases), ds.sizes[names[1]]
    notes = [f"{count} of {of} values of {style.symbol(name) if name != 'equilibrium' else 'the list'}"
             for name, (count, of) in shown.items() if count < of]  # fmt: skip
    part = [body for body in bodies if not body.whole]
    notes += captions.covered(part[:1], str(ds.attrs["length_unit"]))
    notes += ["below each shape its energy"] if kind.name == "equilibria" else []
    page = ROW if len(rows) == 1 else GRID
    return in_one_view(Scene(ds, kind, rows, bodies, told, look, notes, page))


def _together(ds: xr.Dataset, kind: Kind, axis: str, at: Mapping[str, float] | None, look: Look) -> Taken:
    """The cases of an axis on one cylinder, thin, each in the colour of its value."""
    line = selection.line(ds, axis, at)
    cases = selection.spread(line, MOST_GHOSTS)
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
    return in_one_view(Scene(ds, kind, rows, bodies, told, look, notes, bar=bar), bool(lying))


def _try(ds: xr.Dataset, where: dict[str, int], kind: Kind, look: Look) -> tuple[Body | None, str]:
    """The rod, or why there is none. Raises `InputError` for a stretch that is not on the rod."""
    if not ds["solved"].isel(where):
        return None, str(ds["outcome"].isel(where).values)
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
