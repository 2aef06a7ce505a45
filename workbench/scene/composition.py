"""A scene composed: rods in their cells are coloured, rendered, and set on a page. Needs OpenGL."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from solver.problem.errors import InputError
from studies.language.study import MAX_STATIONS

from ..figures import canvas, crossing_rings, fonts
from ..figures.arrangement import Arrangement
from ..geometry.centreline import APART, Array, TooFewStations
from ..words import caution_words, labels, unit_habits
from ..words.free_rod_words import ERROR, amounts
from . import dna_strands, long_rod, page, scene_kinds, signs
from .body import ARROW, Body
from .page import Mark, Page, Scene
from .rendering import Placed, render
from .scene_kinds import Cell, set_range
from .settings import DEFAULT, Settings
from .views import Camera, View, arrange

LINE = 1.5  # width of lines in pixels at `fonts.DPI`
COARSEST = 10.0  # pixels that a surface may be off; beyond, it is no picture of that rod
# of a tick where a contact begins or ends: its least half length in inches, else in radii of its rod
TICK = 0.05, 1.3
ITSELF = "the rod passes through itself"
UNSEEN = ", where in sight"
FLAT, BELOW = 1e-3, 0.1  # the slope of a cylinder without a top; inches from the wall to the words of an end
CUT, ALONG = " (as far as the cylinder does not hide it)", 65  # places along a line at which that is asked
BEHIND = "a stretch behind the cylinder"

__all__ = ["DEFAULT", "Scene", "Settings", "TooFewStations", "compose"]


def compose(scene: Scene) -> Page:
    """Colour the rods, render them, and set the page. Raises `InputError`, `TooFewStations`."""
    settings, dpi = scene.settings, scene.settings.dpi
    scene, (legend, notes), beyond, arranged = _arrangement_of(scene)
    camera = replace(scene.camera, per_unit=arranged.scale * dpi)
    error, stations = _error_and_stations(scene, camera)
    size = int(np.ceil(arranged.size[0] * dpi)), int(np.ceil(arranged.size[1] * dpi))
    placed = [
        Placed(view, (float(x * dpi), float(size[1] - down * dpi))) for view, (x, down) in _middles(scene, arranged)
    ]
    pixels, outlined = render(
        placed,
        camera,
        size,
        settings.pixel_error,
        settings.transparent,
        max(LINE * dpi / fonts.DPI, 0.8),
        settings.samples,
        settings.look[page.WHITE],
    )
    rough = [f"drawn to within {error:.1f} pixels"] * (error > settings.pixel_error * (1 + 1e-9))
    kept = outlined or len(scene.context) > len(scene.bodies)
    wide, high = scene.page_size
    if settings.bare and not settings.size:
        wide, high = size[0] / dpi, size[1] / dpi
    elif not settings.size:
        wide = min(wide, max(least_width(scene), arranged.size[0] + scene.beside[0] + 2 * canvas.MARGIN))
    legend = [entry for entry in legend if kept or entry[0] != signs.OUTLINE]
    final = Page(scene, legend, [*beyond, *rough, *notes], (wide, high))
    if not (settings.size or settings.bare):
        final.fit(size[1] / dpi)
    final.paste(pixels, arranged, rings_in(scene, arranged), _marks_of_contact(scene, arranged))
    final.error, final.stations = error, stations
    return final


def check_stations(scene: Scene) -> None:
    """Raise what `compose` would of the scene before it renders: `InputError`, `TooFewStations`."""
    scene, _, _, arranged = _arrangement_of(scene)
    _error_and_stations(scene, replace(scene.camera, per_unit=arranged.scale * scene.settings.dpi))


def _arrangement_of(scene: Scene) -> tuple[Scene, tuple[list[tuple[str, str]], list[str]], list[str], Arrangement]:
    """The scene coloured, its words, what lies beyond its scale, and where the views are. Raises `InputError`."""
    scene, beyond = colour_rods(_bare(scene) if scene.settings.bare else scene)
    words = words_of(scene)
    room = _room_on(Page(scene, *words))
    arranged = arrange(scene.rows, scene.camera, room, scene.pitch, scene.columns, scene.edge)
    if scene.heads and fonts.width_of(scene.heads[0], fonts.NORMAL) > arranged.size[1]:  # no room beside the rows
        case = ", ".join(text for text in (scene.case, f"rows: {scene.heads[0]}") if text)
        return _arrangement_of(replace(scene, heads=["", *scene.heads[1:]], case=case))
    return scene, words, beyond, arranged


def _error_and_stations(scene: Scene, camera: Camera) -> tuple[float, int]:
    """By how many pixels the rods may be off, and about how many stations they need for as many as are asked for.

    Raises `InputError`, `TooFewStations`.
    """
    settings = scene.settings
    _check_width(scene, camera)
    n, stations = _stations(scene.bodies, settings.pixel_error / camera.per_unit)
    if settings.strict and stations > n:
        raise TooFewStations(f"{n} stations are too few, about {stations} are needed", stations)
    missed = max((body.line.error for body in scene.bodies), default=0.0) * camera.per_unit
    error = max(settings.pixel_error, missed + settings.pixel_error / 2)
    blind = any(body.line.phase_step > APART for body in scene.bodies)
    coarse = error > (settings.pixel_error * (1 + 1e-9) if blind else COARSEST)
    if coarse or not all(body.has_true_colours for body in scene.bodies):
        raise TooFewStations(_too_few(n, stations, error, settings), stations)
    return error, stations


def words_of(scene: Scene) -> tuple[list[tuple[str, str]], list[str]]:
    """The legend and the notes of a scene."""
    legend = [*scene.kind.legend]
    legend += [(body.paint.colour, name) for body, name in zip(scene.bodies, scene.names, strict=False)]
    views = scene.views
    if len(views) == 1 and len(scene.context) > 1 and not scene.names:  # the pictures along an axis share a legend
        views = [replace(views[0], bodies=[body]) for body in scene.context]
    if ringed := rings_in_words(views, scene.camera) if scene.ringed else "":
        legend.append((signs.RING, ringed))
    if any(view.hides(body, scene.camera) for view in views for body in view.bodies):
        legend.append((signs.OUTLINE, BEHIND))
    bodies = scene.bodies
    if any(body.widest_gap is not None for body in bodies):
        legend.append((signs.GAP, "the widest gap to the wall" + CUT * _hides(scene, signs.GAP)))
        off = scene_kinds.OFF_WALL if bodies[0].paint.ramp else bodies[0].paint.colour  # no push, no scale of pushes
        legend += [(off, "off the wall")] * (scene.kind.paint is scene_kinds.by_push)
    if any(body.contact_edges for body in bodies):
        legend.append((signs.EDGE, "a contact begins or ends"))
    if any(body.pushes for body in bodies):
        lines = [words for view in views for _, sign, words in _lines_of_contact(scene, view) if sign == signs.FORCE]
        error = f", {ERROR} its error" * any(ERROR in words for words in lines)
        legend.append((signs.FORCE, f"a point force of the wall{error}" + CUT * _hides(scene, signs.FORCE)))
    warnings = impossible(scene.bodies, bool(ringed)) if scene.kind.cells != "together" else []
    if len(scene.context) > len(scene.bodies) and any(impossible([body], bool(ringed)) for body in scene.context):
        warnings = warnings or [page.EMPTY_LINE]  # the views of the pictures along an axis stand at one place
    return legend, [*scene.seen_along, *scene.notes, *warnings]


def rings_in_words(views: Sequence[View], camera: Camera) -> str:
    """What the rings of views mean; "" where no place at which a rod passes through itself is in sight."""
    crossings = [view.crossings(camera) for view in views]
    if not any(seen for seen, _ in crossings):
        return ""
    return ITSELF + UNSEEN * any(hidden for _, hidden in crossings)


def impossible(bodies: Sequence[Body], ringed: bool = False) -> list[str]:
    """What a real rod could not do, beyond what colours and a legend of rings show; of several rods how many."""
    each = {id(body.line): body.caution for body in bodies}.values()
    sentences = []
    for key in (caution_words.MEETS, caution_words.TIGHT):
        if count := sum(key in caution_words.keys(caution) for caution in each):
            who = "the rod" if len(each) == 1 else f"{count} of {len(each)}"
            sentences.append(f"{who} {caution_words.WORDS[key][count > 1]}")
    return [note for note in map(labels.typeset, sentences) if not (ringed and note == ITSELF)]


def least_width(scene: Scene) -> float:
    """The width that the words of a scene need on its page in inches; all of it for pictures along an axis, whose words
    differ."""
    if len(scene.context) > len(scene.bodies):
        return scene.page_size[0]
    scene = colour_rods(scene)[0]
    return page.least_width(scene, *words_of(scene))


def room_of(scene: Scene) -> tuple[float, float]:
    """The room for the views of a scene on its page in inches. Raises `InputError` where there is none."""
    return _room_on(Page(colour_rods(scene)[0], *words_of(scene)))


def _room_on(draft: Page) -> tuple[float, float]:
    room = draft.room()
    check_room(room, draft.scene.page_size, draft.scene.settings.dpi)
    return room


def check_room(room: tuple[float, float], size: tuple[float, float], dpi: int) -> None:
    """Raise `InputError` where views have no room on a page or a frame of this size; both in inches."""
    if min(room) < page.LEAST:
        pixels = "x".join(f"{side * dpi:.0f}" for side in size)
        raise InputError(
            f"--size {pixels} leaves no room for the views beside the words at {dpi} dots per inch: give "
            "a larger size, fewer --dpi, or --bare"
        )


def _bare(scene: Scene) -> Scene:
    """The scene without words and marks beside its views."""

    def bare(view: View) -> View:
        bodies, frame = ([replace(body, point_forces=()) for body in each] for each in (view.bodies, view.frame))
        return replace(view, bodies=bodies, frame=frame, cell=view.cell if scene.has_room_for_words else Cell())

    rows = [[bare(view) for view in row] for row in scene.rows]
    return replace(scene, rows=rows, columns=(), heads=(), names=(), ringed=False)


def colour_rods(scene: Scene) -> tuple[Scene, list[str]]:
    """The scene with the colours of its kind on all rods, and what lies beyond a chosen scale."""
    if scene.kind.cells == "together":
        return scene, []
    each = [body.extremes() for body in scene.context] if scene.kind.value else []
    extremes = (min(low for low, _ in each), max(high for _, high in each)) if each else None
    units = scene.stored.units
    paint, notes = scene.kind.paint(units, extremes), list[str]()
    if color := scene.settings.color:
        if paint.ramp is not None or paint.stripe:
            raise InputError(
                f"the colours of a scene of kind {scene.kind.name} have a meaning; --color is for the kind plain"
            )
        paint = replace(paint, colour=color)
    if chosen := scene.settings.color_range:
        if scene.kind.value is None:
            raise InputError(f"a scene of kind {scene.kind.name} has no colour bar, so it takes no --color-range")
        if paint.label and extremes:
            paint = set_range(paint, chosen)
            beyond = [f"up to {labels.number(extremes[1])}"] if extremes[1] > paint.high else []
            beyond += [f"down to {labels.number(extremes[0])}"] if extremes[0] < paint.low else []
            ends = {(False, True): "min", (True, False): "max", (True, True): "both"}
            past = extremes[1] > paint.high, extremes[0] < paint.low
            paint = replace(paint, extend=ends.get(past, "neither"))
            unit = labels.unit(unit_habits.unit_shown(scene.kind.quantity, units))
            notes = [f"beyond the colours: {', '.join(beyond)} {unit}"] if beyond else []
    rows = [
        [replace(view, bodies=[replace(body, paint=paint) for body in view.bodies]) for view in row]
        for row in scene.rows
    ]
    return replace(scene, rows=rows, paint=paint), notes


def _check_width(scene: Scene, camera: Camera) -> None:
    """Raise `InputError` where nothing of a rod would be seen: it is long, or the words leave no room."""
    for body in scene.bodies[:1]:
        wide, ends = 2 * body.reach * camera.per_unit, scene.rows[0][0].cylinder
        if wide < long_rod.THINNEST * (1 - 1e-6) and not scene.pitch:
            if not long_rod.is_long(scene.bodies):
                check_room((0.0, 0.0), scene.page_size, scene.settings.dpi)
            raise InputError(
                f"a cylinder {2 * body.reach:.3g} wide and {np.ptp(ends):.4g} long is {wide:.2g} pixels wide in the "
                "picture: draw a shorter part with --from and --to, or draw one case, which is set in lines"
            )


def _middles(scene: Scene, arranged: Arrangement) -> Iterator[tuple[View, Array]]:
    """Each view with rods, and where its middle is in the picture, in inches from its upper left: its box stands on the
    lower edge of its cell."""
    for view, (x, y, wide, high) in zip(scene.views, arranged.places, strict=True):
        if view.bodies:
            low, top = view.box(scene.camera)
            foot = y + high - scene.edge
            yield view, np.array([x + wide / 2, foot - (top - low)[1] / 2 * arranged.scale])


def _in_picture(scene: Scene, arranged: Arrangement, view: View, middle: Array, places: Array) -> Array:
    """Where places of a view, (..., 3) as they are turned, are in the picture, (..., 2) in inches; middle: its own."""
    away = places @ scene.camera.page.T - sum(view.box(scene.camera)) / 2
    return np.asarray(middle + away * arranged.scale * [1, -1])


def rings_in(scene: Scene, arranged: Arrangement) -> list[tuple[float, float, float]]:
    """Where rods pass through themselves in sight: x, y and radius of each ring in inches of the picture."""
    circles = []
    for view, middle in _middles(scene, arranged) if scene.ringed else ():
        radius = crossing_rings.radius(min(body.a for body in view.bodies) * arranged.scale)
        for place in view.crossings(scene.camera)[0]:
            x, y = _in_picture(scene, arranged, view, middle, place)
            circles.append((float(x), float(y), radius))
    return circles


def _marks_of_contact(scene: Scene, arranged: Arrangement) -> list[Mark]:
    """The widest gap of each rod as a line to the wall, and the point forces of the wall as arrows, as far as the
    cylinder does not hide them; ticks at other edges of contacts; the marked base pairs of DNA; in inches."""
    marks, camera = [], scene.camera
    for view, middle in _middles(scene, arranged):
        in_picture = partial(_in_picture, scene, arranged, view, middle)
        lines = [
            (places[~view.covers(places, camera)], sign, words)
            for places, sign, words in _lines_of_contact(scene, view)
        ]
        lines += [
            (places @ view.turn.T, signs.LEADER, words)
            for body in view.bodies
            if body.paint.strands
            for places, words in dna_strands.marks(body)
        ]
        lines += [(places, signs.LEADER, words) for places, words in _marks_of_ends(scene, view, arranged.scale)]
        for places, sign, words in lines:
            if places.size:
                marks.append(Mark(in_picture(places[[0, -1]]), sign, words))
        for body in view.bodies:
            half = max(TICK[0], TICK[1] * body.a * arranged.scale)
            for at, along in body.contact_edges:
                (x, y), place = camera.page @ view.turn @ along, view.turn @ at
                size = np.hypot(x, y)
                if size > 0 and not view.covers(place[None], camera)[0]:
                    tick = half / size * np.array([[y, x], [-y, -x]])
                    marks.append(Mark(in_picture(place) + tick, signs.EDGE))
    return marks


def _lines_of_contact(scene: Scene, view: View) -> Iterator[tuple[Array, str, str]]:
    """The widest gap of each rod of a view and its point forces, on the page as long as they are large: places along
    each line, (n, 3) as they are turned, its sign, and its size in words."""
    units = scene.stored.units
    largest = max((force for body in scene.bodies for *_, force, _ in body.pushes), default=1.0)
    share = np.linspace(0, 1, ALONG)[:, None]
    for body in view.bodies:
        if body.widest_gap is not None:
            wall, rod = body.widest_gap
            size = labels.number(float(np.linalg.norm(rod - wall)), 3)
            yield (wall + share * (rod - wall)) @ view.turn.T, signs.GAP, f"{size} {units['length']}"
        said = amounts([force for *_, force, _ in body.pushes], [error for *_, error in body.pushes])
        for (at, away, force, _), size in zip(body.pushes, said, strict=True):
            start, tip = view.arrow(body, at, away, ARROW * body.R * force / largest, scene.camera)
            yield start + share * (tip - start), signs.FORCE, f"{size} {units['force']}"


def _marks_of_ends(scene: Scene, view: View, scale: float) -> Iterator[tuple[Array, str]]:
    """A line from where the only rod of a scene begins, in a cylinder that lies on the page, to its words below the
    wall, (2, 3) as it is turned; of a rod with weight which end is the top. scale: inches per length."""
    if not scene.has_named_ends:
        return
    page, (body,) = scene.camera.page, scene.bodies
    down = -page[1] * [1, 1, 0] / np.linalg.norm(page[1, :2])
    slope = 0.0 if scene.camera.down is None else float(scene.camera.down[2])
    names = ("bottom", "top")[:: 1 if slope < 0 else -1] if abs(slope) > FLAT else ("", "")
    for foot, name, s in zip(view.places(body)[[0, -1]], names, ("s = 0", ""), strict=True):
        if words := ", ".join(filter(None, (s, name))):
            yield np.stack([foot, foot + (body.R + BELOW / scale - foot @ down) * down]), words


def _hides(scene: Scene, kind: str) -> bool:
    """Whether the cylinder hides a part of a gap or of a point force; kind: which of them, a sign."""
    lines = ((view, line) for view in scene.views for line in _lines_of_contact(scene, view))
    return any(view.covers(places, scene.camera).any() for view, (places, sign, _) in lines if sign == kind)


def _stations(bodies: Sequence[Body], tolerance: float) -> tuple[int, int]:
    """How many stations the rods have, and about how many are needed to draw them all to a tolerance [length]."""
    apart = {id(body.line): body for body in bodies}.values()
    each = [(body.line.s.size, body.stations_for(tolerance)) for body in apart] or [(0, 0)]
    return max(n for n, _ in each), max(needed for _, needed in each)


def _too_few(n: int, needed: int, error: float, settings: Settings) -> str:
    off = f" (it could be off by {error:.0f})" if error > settings.pixel_error * (1 + 1e-9) else " in its true colours"
    few = f"{n} stations are too few to draw this rod to within {settings.pixel_error:g} pixels{off}"
    if needed > MAX_STATIONS:
        return f"{few}: about {needed} are needed, and a study stores at most {MAX_STATIONS}; study a shorter rod"
    return (
        f"{few}: store about {needed}, with workbench run --stations or with the study's key stations; or draw the "
        "study itself, with workbench scene STUDY"
    )
