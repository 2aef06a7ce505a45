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
from ..figures import canvas
from . import body as rods
from . import camera as cameras
from . import captions, colours, long_rod, page, pixels, table, triad
from .arrangement import EDGE
from .body import Body
from .camera import Camera
from .cells import Cell
from .colours import Paint
from .composition import DEFAULT, Picture, Scene, composed, room
from .kinds import Kind, kind_of
from .settings import Settings, check, check_name
from .views import View, ends_of

SUFFIXES = (".png", ".jpg")
LYING = 1.3  # how much taller than wide a scene must be to be laid on its side
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
    level: int = 1,
) -> Picture:
    """Draw a scene and save it; parameters as of `compose`; level: of the compression of a PNG."""
    path = canvas.check_name(path, SUFFIXES)
    check_name(path, settings)
    picture = compose(ds, at, kind, axes, along, settings)
    pixels.save(page.figure(picture.page), path, level)
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
    check(settings)
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
    return table.several(ds, chosen, names, at, settings)


def _one(ds: xr.Dataset, kind: Kind, where: dict[str, int], along: str | None, settings: Settings) -> Picture:
    """One case large, from its front and from its side; a long one in lines."""
    case = captions.case_values(ds, where, settings.digits)
    body, why = rods.of_case(ds, where, kind, settings.span)
    if body is None:
        raise InputError(f"nothing to draw{f' at {case}' if case else ''}: {why}")
    film: list[tuple[str, Body]] = []
    if along:
        at = {name: float(ds[name].values[i]) for name, i in where.items() if name != along}
        film = [
            (captions.case_values(ds, each, settings.digits), found)
            for each in selection.line(ds, along, at)
            if (found := rods.of_case(ds, each, kind, settings.span)[0])
        ]
    context = [found for _, found in film] or [body]
    if long_rod.is_long(context):
        notes = captions.part_drawn([body], str(ds.attrs["length_unit"]))
        return _in_lines(ds, kind, body, context, case, settings, notes)

    def scene(case: str, body: Body) -> Scene:
        rows, camera = _from_sides([body], context, settings)
        notes = captions.part_drawn([body], str(ds.attrs["length_unit"]))
        return Scene(ds, kind, rows, context, case, camera, settings, notes, ringed="first")

    return composed(replace(scene(case, body), frames=[scene(*each) for each in film]))


def _from_sides(bodies: Sequence[Body], context: Sequence[Body], settings: Settings) -> tuple[list[list[View]], Camera]:
    """Rods from all sides that the settings name, lying where that is larger; context: the rods that fix the frame."""
    ends = ends_of(context)
    lying = bool(np.ptp(ends) > LYING * 2 * max(body.reach for body in context))
    sides = cameras.views_of(settings.camera)
    camera = cameras.facing(context, sides[0][1], lying)
    faced = f"facing the rod{'s'[: len(bodies) - 1]}" if set(context) <= set(bodies) else triad.seen_from(camera.toward)
    views = [View(bodies, Cell(_side(*side, faced)), -np.radians(side[0]), ends, context) for side in sides]
    return ([[view] for view in views] if lying else [views]), camera


def _side(azimuth: float, elevation: float, faced: str) -> str:
    """In words from which side a view shows rods; faced: those for the side to which the others are turned."""
    text = f"turned by {labels.number(azimuth)}° about the axis" if azimuth else faced
    from_where = f", from {labels.number(abs(elevation))}° {'above' if elevation > 0 else 'below'}"
    return labels.minus_signs(text + (from_where if elevation else ""))


def _in_lines(
    ds: xr.Dataset, kind: Kind, body: Body, context: Sequence[Body], case: str, settings: Settings, notes: list[str]
) -> Picture:
    """All of a rod that would be too thin to see in one view."""
    azimuth, elevation = cameras.views_of(settings.camera)[0]
    if elevation:
        raise InputError(
            f"a rod this long is set in lines, seen at right angles to its axis: --camera {settings.camera} has an "
            f"elevation of {elevation:g} degrees; draw a part of the rod with --from and --to"
        )
    camera, turned = cameras.facing(context, lying=True), -np.radians(azimuth)
    scene = Scene(ds, kind, [[View([body], Cell(""))]], context, case, camera, settings, notes, gutter=GUTTER)
    wide, high = room(scene)
    lines = long_rod.lines_for(context, (int(wide - GUTTER - 2 * EDGE), int(high)))
    pieces, unit = lines.cut(body), str(ds.attrs["length_unit"])
    cells = lines.cells(pieces, unit)
    rows = [[View([piece], cell, turned, lines.ends)] for piece, cell in zip(pieces, cells, strict=True)]
    notes = [*lines.notes(pieces, unit), *notes]
    return composed(replace(scene, rows=rows, notes=notes, pitch=long_rod.PITCH))


def _together(ds: xr.Dataset, kind: Kind, axis: str, at: Mapping[str, float] | None, settings: Settings) -> Picture:
    """The cases of an axis on one cylinder, thin, each in the colour of its value."""
    if settings.color_range:
        raise InputError(f"a scene of kind {kind.name} has one colour for each rod, so it takes no --color-range")
    line = selection.line(ds, axis, at)
    cases = selection.spread(line, kind.most)
    bodies, words = [], []
    for k, where in enumerate(cases):
        body, _ = rods.of_case(ds, where, kind, settings.span)
        if body:
            body = body if settings.span else rods.beginning(body)
            outward = (2 * k / max(len(cases) - 1, 1) - 1) * (1 - GHOST) * body.a  # no rod cuts another
            thin = replace(body.line, a=GHOST * body.a)
            bodies.append(replace(body, line=thin, lift=outward, paint=Paint(colours.SEVERAL[k])))
            words.append(captions.values(ds, {axis: where[axis]})[0])
    if not bodies:
        raise InputError(f"nothing to draw along {axis}: no case of it has a shape")
    case = ", ".join([labels.axis_label(axis, ds[axis]),
                      *captions.values(ds, {k: i for k, i in cases[0].items() if k != axis})])  # fmt: skip
    notes = [f"{len(cases)} of {len(line)} values"] if len(cases) < len(line) else []
    notes += [f"drawn at {GHOST:g} of the thickness, one above the other"]
    notes += captions.part_drawn(bodies, str(ds.attrs["length_unit"]))
    rows, camera = _from_sides(bodies, bodies, settings)
    return composed(Scene(ds, kind, rows, bodies, case, camera, settings, notes, labels=words))
