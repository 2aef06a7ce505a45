"""The rod on its cylinder in three dimensions: off-screen pictures of a stored dataset, never solving.

The tube has the rod's true radius and touches the surface; where the cylinder would have to pull to hold it there, the
scale of colours says so. All views are parallel projections. Needs OpenGL: ask `opengl.probe` first, as without it VTK
ends the process.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from solver.orbits import frames
from solver.problem.errors import InputError

from ..figures import colours
from ..geometry.centreline import Array
from ..run import atomic
from ..stored import chosen_cases
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import body as rods
from . import composition, long_rod, page, scene_kinds
from .body import Body
from .composition import room_of
from .page import Page, Scene
from .scene_kinds import Cell, Paint, SceneKind, default_kind, kind_of
from .settings import DEFAULT, PICTURES, Settings, check, check_name
from .views import (
    EDGE,
    Camera,
    View,
    arrange,
    azimuth_of,
    camera_before,
    camera_of,
    ends_of,
    front_camera,
    gravity,
    in_rows,
    one_view_of,
)

HEADS = ("", "s = 0 cm")  # the room before the lines of a long rod
GHOST = 0.25  # of its thickness is a rod drawn among others
BESIDE = 0.5  # of the drawn thickness is each of these farther from the wall than the one before, so that all are seen
MOST_ROWS = 5  # of upright rods, or columns of lying ones
BEFORE = 0.5  # of a rod is before the axis at least, where it is so from one of two sides
LEVEL = 12.0  # degrees from which a row of rods is seen

Where = dict[str, int]


def render(
    stored: StoredStudy,
    path: str | Path,
    at: Mapping[str, float] | None = None,
    kind: str = "contact",
    axes: Sequence[str] = (),
    along: str | None = None,
    settings: Settings = DEFAULT,
    level: int = 1,
) -> Page:
    """Draw a scene and save it; parameters as of `compose`; level: of the compression of a PNG."""
    path = atomic.check_name(path, PICTURES)
    check_name(path, settings)
    picture = compose(stored, at, kind, axes, along, settings)
    page.save(picture, path, level)
    return picture


def draw(stored: StoredStudy, path: str | Path) -> dict[str, Path]:
    """Draw the scenes of a dataset: every equilibrium, or a row along each axis, or the one case large.

    path: of the file; with several axes each row's file has the axis's name appended. Returns name -> file. Raises
    `InputError`.
    """
    path, axes = Path(path), stored.axes
    if default_kind(stored) == "equilibria" or not axes:
        render(stored, path, kind=default_kind(stored))
        return {"scene": path}
    files = {axis: path.with_stem(f"{path.stem}_{axis}") if len(axes) > 1 else path for axis in axes}
    for axis, file in files.items():
        render(stored, file, kind="grid", axes=[axis])
    return {f"scene {axis}": file for axis, file in files.items()}


def compose(
    stored: StoredStudy,
    at: Mapping[str, float] | None = None,
    kind: str = "contact",
    axes: Sequence[str] = (),
    along: str | None = None,
    settings: Settings = DEFAULT,
) -> Page:
    """The scene of a dataset. In place of a case without a shape stands the nearest one that has one, which is said.

    Parameters
    ----------
    at
        Values of axes, which are stored; default: those of the study's laws or of Table 1.
    kind
        A name of `scene_kinds.KINDS`.
    axes
        The axis or two that a scene of several cases shows; default: the dataset's first.
    along
        An axis whose cases fix the camera and the colour scale of a scene of one of them.

    Raises
    ------
    InputError
        An invalid name or value, one case that `at` names and that has no shape, stations that are far too few.
    """
    chosen, along = kind_of(kind), along and stored.axis(along)
    check(settings)
    if chosen.cells == "one":
        if axes:
            raise InputError(f"a scene of kind {kind} shows one case, so it takes no axis; choose ghosts or grid")
        return _single(stored, chosen, at, along, settings)
    if along:
        raise InputError(f"a scene of kind {kind} shows a whole axis already: it takes no --along")
    if chosen.of_equilibria and default_kind(stored) != kind:
        raise InputError(f"a scene of kind {kind} takes a dataset that `workbench equilibria --out FILE` stored")
    names = [stored.axis(name) for name in axes] or stored.axes[:1]
    most = 1 if chosen.cells == "together" else 2
    if not names:
        raise InputError(f"a scene of kind {kind} shows the cases of an axis, and the study has none")
    if len(names) > most:
        raise InputError(f"a scene of kind {kind} shows at most {most} of the axes {', '.join(names)}")
    if chosen.cells == "together":
        return _together(stored, chosen, names[0], at, settings)
    return (_row if len(names) == 1 else _table)(stored, chosen, names, at, settings)


def _single(
    stored: StoredStudy, kind: SceneKind, at: Mapping[str, float] | None, along: str | None, settings: Settings
) -> Page:
    """One case large; a long one in lines."""
    chosen = stored.place(at)
    where = chosen if at else _nearest_solved(stored, chosen)
    case = scene_kinds.case_values(stored, where)
    body, why = rods.of_case(stored, where, kind, settings.span)
    if body is None:
        raise InputError(f"nothing to draw{f' at {case}' if case else ''}: {why}")
    context = [body]
    if along:
        held = {name: float(stored[name].values[i]) for name, i in where.items() if name != along}
        line = [rods.of_case(stored, each, kind, settings.span)[0] for each in stored.places(along, held)]
        context = [each for each in line if each]
    notes = [*kind.numbers(body.line, stored.select(where)), *kind.notes]
    if where != chosen:
        notes += [f"{scene_kinds.case_values(stored, chosen)} is not solved; this is the nearest solved case"]
    down = gravity(stored, where)
    if not settings.is_end_view:
        body, *context = long_rod.compress([body, *context])
    notes = [*long_rod.notes_on([body], stored.units["length"]), *notes]
    if long_rod.is_long(context) and not settings.is_end_view:
        return _in_lines(stored, kind, body, context, case, settings, notes, down)
    rows, camera = _from_sides([body], context, settings, down)
    return composition.compose(Scene(stored, kind, rows, context, case, camera, settings, notes))


def _counts(names: Sequence[str], shown: Sequence[int], stored: Sequence[int]) -> list[str]:
    """How many of the values of each axis, or of the equilibria, are shown, where not all are."""
    each = zip(names, shown, stored, strict=False)
    return [
        f"{count} of {of} {'equilibria' if name in scene_kinds.UNNAMED else f'values of {labels.axis_symbol(name)}'}."
        for name, count, of in each
        if count < of
    ]


def _nearest_solved(stored: StoredStudy, where: Where, among: Sequence[Where] | None = None) -> Where:
    """The solved case with the fewest steps along the axes to a case, of a list or of all; the case where none is."""
    solved = stored["solved"]
    if bool(solved.isel(where)):
        return where
    if among is None:
        names = [str(name) for name in solved.dims]
        among = [dict(zip(names, map(int, place), strict=True)) for place in np.argwhere(solved.values)]
    able = [each for each in among if bool(solved.isel(each))]
    return min(able, key=lambda each: sum(abs(each[name] - where[name]) for name in where), default=where)


def _from_sides(
    bodies: Sequence[Body], context: Sequence[Body], settings: Settings, down: Array | None = None
) -> tuple[list[list[View]], Camera]:
    """Rods from all sides that the settings name; context, down: as of `camera_before`."""
    camera, sides, lying = camera_before(context, settings.camera, down)
    ends = ends_of(context)
    cells = [Cell(_side(*side) if len(sides) > 1 else "") for side in sides]
    views = [View(bodies, cell, -np.radians(side[0]), ends, context) for side, cell in zip(sides, cells, strict=True)]
    toward = views[0].turn.T @ camera.toward
    camera = camera if camera.is_end_view else replace(camera, seen_from=toward)
    return ([[view] for view in views] if lying else [views]), camera


def _side(azimuth: float, elevation: float) -> str:
    """In words from which side one of several views shows rods."""
    text = f"turned by {labels.number(azimuth)}° about the axis" if azimuth else "facing the rod"
    from_where = f", from {labels.number(abs(elevation))}° {'above' if elevation > 0 else 'below'}"
    return labels.minus_signs(text + (from_where if elevation else ""))


def _in_lines(
    stored: StoredStudy,
    kind: SceneKind,
    body: Body,
    context: Sequence[Body],
    case: str,
    settings: Settings,
    notes: list[str],
    down: Array | None,
) -> Page:
    """All of a rod that would be too thin to see in one view."""
    azimuth, elevation = one_view_of(settings.camera or "front", "a rod this long, which is set in lines,")
    if elevation:
        raise InputError(
            f"a rod this long is set in lines, seen at right angles to its axis: --camera {settings.camera} has an "
            f"elevation of {elevation:g} degrees; draw a part of the rod with --from and --to"
        )
    camera, turned = front_camera(context, lying=True, down=down), -np.radians(azimuth)
    rows = [[View([body], Cell())]]
    scene = Scene(stored, kind, rows, context, case, camera, settings, notes, heads=HEADS, ringed=False)
    wide, high = (side * settings.dpi for side in room_of(scene))
    lines, ends = long_rod.lines_for(context, (int(wide - 2 * EDGE * settings.dpi), int(high)))
    spans, unit = lines.cut(*body.span), stored.units["length"]
    rows = [[View([piece], Cell(), turned, ends)] for piece in long_rod.cut(lines, body)]
    notes, heads = [lines.note(spans, unit), *notes], ["", *lines.heads(spans, unit)]
    scene = replace(scene, rows=rows, heads=heads, notes=notes)
    return composition.compose(replace(scene, pitch=long_rod.PITCH, edge=0.0))  # thin lines have no room for edges


def _together(
    stored: StoredStudy, kind: SceneKind, axis: str, at: Mapping[str, float] | None, settings: Settings
) -> Page:
    """The cases of an axis on one cylinder, thin, each in the colour of its value."""
    if settings.color_range:
        raise InputError(f"a scene of kind {kind.name} has one colour for each rod, so it takes no --color-range")
    line = stored.places(axis, at)
    cases = chosen_cases.spread(line, kind.most)
    drawn = [rods.of_case(stored, where, kind, settings.span)[0] for where in cases]
    whole = {k: body for k, body in enumerate(drawn) if body}
    if not whole:
        raise InputError(f"nothing to draw along {axis}: no case of it has a shape")
    thin = [_thin(body, k) for k, body in whole.items()]
    words = [scene_kinds.values(stored, {axis: cases[k][axis]})[0] for k in whole]
    held = {k: i for k, i in cases[0].items() if k != axis}
    down = gravity(stored, held)
    bodies = in_view(thin, down, settings)
    case = ", ".join(scene_kinds.values(stored, held))  # the legend names the axis
    notes = [f"drawn at {GHOST:.2g} of the thickness, one upon the other"]
    notes += long_rod.notes_on(bodies, stored.units["length"])
    rows, camera = _from_sides(bodies, bodies, settings, down)
    scene = Scene(stored, kind, rows, bodies, case, camera, settings, notes, ringed=False, names=words)
    return composition.compose(replace(scene, caption=_counts([axis], [len(cases)], [len(line)])))


def _thin(body: Body, k: int) -> Body:
    """The k-th of so many rods on one cylinder, thin; the first touches the wall."""
    a, above = GHOST * body.a, 2 * BESIDE * GHOST * body.a * k
    lift = (body.a - a - above) * (1 if body.side == "inside" else -1)
    return replace(body, line=replace(body.line, a=a), lift=lift, paint=Paint(colours.SEVERAL[k]))


def _row(
    stored: StoredStudy, kind: SceneKind, names: list[str], at: Mapping[str, float] | None, settings: Settings
) -> Page:
    """The cases of an axis in rows, as large as they fit; each rod faces the viewer."""
    line = stored.places(names[0], at)
    spread, chosen = chosen_cases.spread(line, kind.most), list[Where]()
    for where in spread:
        chosen.append(_nearest_solved(stored, where, [other for other in line if other not in [*spread, *chosen]]))
    chosen.sort(key=lambda where: where[names[0]])
    moved = sum(where not in chosen for where in spread)
    rows, cameras = _cells(stored, kind, names, [chosen], settings)
    heading = [labels.axis_label(stored[name]) for name in names if name not in scene_kinds.UNNAMED]
    notes = [f"in place of {moved} unsolved case{'s' * (moved > 1)} the nearest solved"] if moved else []
    scene = _several(stored, kind, names, rows, cameras[0], settings, chosen[0], notes)
    scene = replace(scene, columns=heading, caption=[*kind.caption, *_counts(names, [len(chosen)], [len(line)])])
    room = room_of(scene)
    scenes = [replace(scene, rows=in_rows(rows[0], camera, room), camera=camera) for camera in cameras]
    return compose_larger(scenes, room)


def _table(
    stored: StoredStudy, kind: SceneKind, names: list[str], at: Mapping[str, float] | None, settings: Settings
) -> Page:
    """The cases of two axes, with headings: of upright rods more columns, of lying ones more rows."""
    lines = [stored.places(name, at) for name in names]
    scenes = []
    for k, most in enumerate([(kind.most, MOST_ROWS), (MOST_ROWS, kind.most)]):
        across, down = (chosen_cases.spread(line, count) for line, count in zip(lines, most, strict=True))
        cases = [[{**case, names[1]: row[names[1]]} for case in across] for row in down]
        rows, cameras = _cells(stored, kind, [], cases, settings)
        camera = cameras[k % len(cameras)]
        scene = _several(stored, kind, names, rows, camera, settings, cases[0][0], [])
        counts = _counts(names, (len(across), len(down)), [len(line) for line in lines])
        columns, heads = (scene_kinds.headings(stored, *of) for of in zip(names, (across, down), strict=True))
        scenes.append(replace(scene, columns=columns, heads=heads, caption=counts))
    return compose_larger(scenes, room_of(scenes[0]))


def compose_larger(scenes: Sequence[Scene], room: tuple[float, float]) -> Page:
    """The picture of cases side by side, upright or lying, whose rods take the larger share of their page."""
    least = composition.least_width(scenes[0])

    def share(scene: Scene) -> float:
        arranged = arrange(scene.rows, scene.camera, room, columns=scene.columns)
        wide, high = arranged.size
        return arranged.scale**2 / (max(wide, least) * (high + page.FOOT))

    return composition.compose(max(scenes, key=share))


def _cells(
    stored: StoredStudy, kind: SceneKind, names: list[str], cases: Sequence[Sequence[Where]], settings: Settings
) -> tuple[list[list[View]], list[Camera]]:
    """The views of cases, in which each rod faces the camera; of a case without a shape its reason.

    The cameras have the rods upright and lying; rods with weight in one direction lie or are inclined as they are.
    """
    azimuth, elevation = one_view_of(settings.camera or f"0,{LEVEL}", f"each rod of the kind {kind.name}")
    held = {name: i for name, i in cases[0][0].items() if all(each[name] == i for row in cases for each in row)}
    down = None if settings.camera else gravity(stored, held)
    each = [[rods.of_case(stored, where, kind, settings.span) for where in row] for row in cases]
    drawn = in_view([body for row in each for body, _ in row if body], down, settings)
    flat = [front_camera([], elevation, lying) for lying in (False, True)]
    cameras = [camera_of(drawn, front_camera([], 0.0, True, down))] if down is not None else flat
    profile = _profile(drawn) if kind.name == scene_kinds.LET_GO and not (settings.camera or down is not None) else None
    fitted, rows = iter(drawn), []
    for row, bodies_of_row in zip(cases, each, strict=True):
        views = []
        for where, (body, why) in zip(row, bodies_of_row, strict=True):
            body = next(fitted) if body else None
            cell = replace(kind.cell(stored, names, where) if names else Cell(), why_empty=why)
            own_azimuth = azimuth_of([body]) if body and down is None else 0.0
            own_azimuth = 0.0 if settings.is_end_view else own_azimuth if profile is None else profile
            turned = -np.radians(azimuth) - own_azimuth
            views.append(View([body] if body else [], cell, turned))
        rows.append(views)
    return rows, cameras


def _profile(bodies: Sequence[Body]) -> float | None:
    """The azimuth [rad] from which the widest gap of rods is seen at its full length; None where they are all on the
    wall. It is upward of a lying cylinder, unless most of a rod is behind the cylinder then."""
    gaps = [body.widest_gap for body in bodies if body.widest_gap is not None]
    if not gaps:
        return None
    _, place = max(gaps, key=lambda ends: float(np.linalg.norm(np.subtract(*ends))))
    away = float(np.arctan2(place[1], place[0]))

    def in_front(azimuth: float) -> float:
        """The share of a rod before the axis, of that of which least is."""
        return min(float(np.mean(body.dense @ frames.outward(np.array(azimuth)) > 0)) for body in bodies)

    upward, downward = away + np.pi / 2, away - np.pi / 2
    return upward if in_front(upward) >= min(in_front(downward), BEFORE) else downward


def _several(
    stored: StoredStudy, kind: SceneKind, names: list[str], rows: list[list[View]], camera: Camera, settings: Settings,
    first: Where, notes: list[str],
) -> Scene:  # fmt: skip
    """The scene of cases side by side."""
    bodies = [body for row in rows for view in row for body in view.bodies]
    held = {name: i for name, i in first.items() if name not in names}
    words = [*scene_kinds.values(stored, held), str(stored.attrs.get(scene_kinds.CASE, ""))]
    case = ", ".join(word for word in words if word)
    notes = [*long_rod.notes_on(bodies, stored.units["length"]), *notes, *kind.notes]
    return Scene(stored, kind, rows, bodies, case, camera, settings, notes)


def in_view(bodies: Sequence[Body], down: Array | None, settings: Settings) -> list[Body]:
    """Rods as one view shows them; the part that is asked for whole."""
    if settings.is_end_view:
        return list(bodies)
    if settings.span:
        return long_rod.compress(bodies)
    return long_rod.in_view(bodies, down)
