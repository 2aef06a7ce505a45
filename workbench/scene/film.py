"""A film of the rods along an axis: one camera, one scale of colours, and the growing curve of an observable.

Of a rod that snaps a dot moves in the diagram of its branches in place of the curve. One frame a case of the dataset;
nothing is solved. MP4 and GIF are written by imageio, the extra `animate`, and WebP by Pillow. Frames need OpenGL.
Lengths are in inches.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from solver.problem.errors import InputError, choices
from solver.problem.quantities import current
from studies.grammar.axes import SAMPLE

from ..figures import bifurcation, canvas, colours, fonts
from ..figures.trends import BRACKET, trend
from ..run import atomic
from ..stored.stored_cases import no_such_observable
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import body as rods
from . import long_rod, page, scene_kinds, signs
from .page import Page, Pixels, Scene
from .scene_kinds import Cell
from .settings import DEFAULT, Settings
from .views import View, camera_before, ends_of, gravity, one_view_of

SUFFIXES = (".mp4", ".webp", ".gif")
SIZE = (8.0, 4.5)  # of a frame
TOP, FOOT = 0.72, 0.58  # the room above the views for the value, and below them for the colours
WARNED = 0.62  # from the top: what a real rod could not do
DIAGRAM = (3.0, 1.5)  # the width of a diagram beside the rod, its height below it
DIAGRAM_LABEL = "diagram"  # of its axes
SAMPLES = 2  # along each side of a pixel: a frame is seen for an instant
FPS, HOLD = 24.0, 0.5  # frames a second; seconds for which the first and the last stay
QUALITY = 80  # of WebP
TITLES = (fonts.LARGE, fonts.NORMAL, fonts.SMALL)  # sizes of the value of a frame: the first that has room
LEAST, MOST = 2, 2000  # frames
RATES = (0.1, 60.0)  # frames a second
INSTALL = "pip install 'rod-workbench[animate]'"


@dataclass(frozen=True)
class Film:
    """What a film shows.

    Attributes
    ----------
    axis, at
        The axis along which it runs, and values of the others.
    observable
        The observable whose curve grows; None: no diagram.
    kind
        A kind of scene that shows one case.
    settings
        As of a scene, seen from one side.
    branches
        A file of branches, in whose diagram a dot moves; default: the curve of the observable grows.
    count
        Frames, of so many stored cases at even steps from the first to the last; default: all of them.
    """

    axis: str
    at: dict[str, float]
    observable: str | None = None
    kind: str = "contact"
    settings: Settings = DEFAULT
    count: int | None = None
    branches: StoredStudy | None = None

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of a frame [inch]."""
        wide, high = self.settings.size or np.array(SIZE) * self.settings.dpi
        return float(wide / self.settings.dpi), float(high / self.settings.dpi)


def observable_of(
    stored: StoredStudy,
    axis: str,
    name: str | None = None,
    at: Mapping[str, float] | None = None,
    measured: Sequence[str] = (),
) -> str:
    """The observable whose curve is drawn; default: that of the axis's first law, else the first that is stored, of
    those that change along the axis, with the other axes at `at`.

    measured: others that may be asked for, as the cases are solved anew. Raises `InputError` where there is no such
    observable.
    """
    known = stored.all_observables
    if name is not None:
        name = current(name)
        if name not in (*known, *measured):
            raise no_such_observable(name, known)
        return name
    if not known:
        raise InputError("the dataset stores no observable whose curve could be drawn: add some to the study")
    judged = [law.observable for law in stored.laws if law.axis == axis]
    candidates = [candidate for candidate in (*judged, *known) if candidate in known]
    held = {other: i for other, i in stored.place(at or {}).items() if other != axis}
    line = stored.select(held)
    return next((candidate for candidate in candidates if not line.is_level(candidate)), candidates[0])


def cases_of(stored: StoredStudy, film: Film) -> list[dict[str, int]]:
    """The indices of each frame's case. Raises `InputError` for a kind, a camera or an axis that makes no film."""
    single = [*(kind.name for kind in scene_kinds.TABLE if kind.cells == "one"), scene_kinds.LET_GO]
    if scene_kinds.kind_of(film.kind).cells != "one":
        raise InputError(f"a frame shows one case, so --kind is one of {choices(single)}, not {film.kind!r}")
    one_view_of(film.settings.camera, "a film")
    cases = stored.places(film.axis, film.at)
    if film.branches is not None:  # the load falls and rises as the rod goes its way
        cases.sort(key=lambda where: where[film.axis])
    if not LEAST <= len(cases) <= MOST:
        raise InputError(f"a film has {LEAST} to {MOST} frames, and the axis {film.axis} {len(cases)} values")
    if film.count is None:
        return cases
    if film.count > len(cases):
        raise InputError(
            f"--frames {film.count}: {film.axis} has {len(cases)} stored values, and no cases are solved between them"
        )
    return [cases[round(i)] for i in np.linspace(0, len(cases) - 1, film.count)]


def check_counts(count: int | None, fps: float) -> None:
    """Raise `InputError` for a number of frames, or of frames per second, that no film has."""
    if not RATES[0] <= fps <= RATES[1]:
        raise InputError(f"--fps must be between {RATES[0]:g} and {RATES[1]:g}, got {fps:g}")
    if count is not None and not LEAST <= count <= MOST:
        raise InputError(f"--frames must be between {LEAST} and {MOST}, got {count}")


def check_writers(paths: Sequence[Path]) -> None:
    """Raise `InputError` with what to install where films of these suffixes cannot be written."""
    if not any(path.suffix.lower() == ".mp4" for path in paths):
        return
    _imageio()
    if not find_spec("imageio_ffmpeg"):
        raise InputError(f"an MP4 needs imageio-ffmpeg, which is not installed: {INSTALL}; .gif and .webp do not")


def write_pictures(paths: Sequence[Path], made: Iterator[Pixels]) -> None:
    """Write each frame as a picture, .png or .jpg. Raises `InputError` where that fails."""
    from PIL import Image

    for path, frame in zip(paths, made, strict=True):
        atomic.write(path, partial(Image.fromarray(frame).save, quality=page.QUALITY))


def frames(
    stored: StoredStudy, film: Film, step: Callable[[str], None] = lambda text: None, strict: bool = False
) -> Iterator[Pixels]:
    """The frames in rising order of the axis, (height, width, 3) each, all of one even size.

    A case without a shape shows its outcome in place of the rod. step: called with a text as each frame begins. Before
    the first it raises `InputError` where no case has a shape, and `TooFewStations` as of `Settings`; strict: its own.
    """
    from . import composition, layout  # VTK, which ends the process where OpenGL does not work

    kind, cases, chosen = scene_kinds.kind_of(film.kind), cases_of(stored, film), film.settings
    each = [rods.of_case(stored, where, kind, chosen.span)[0] for where in cases]
    down = gravity(stored, {name: i for name, i in cases[0].items() if name != film.axis})
    context = layout.in_view([body for body in each if body], down, chosen)
    if not context:
        raise InputError(f"no case along {film.axis} has a shape: there is nothing to show")
    fitted = iter(context)
    bodies = [next(fitted) if body else None for body in each]
    camera, sides, lying = camera_before(context, chosen.camera, down)
    turned, ends, (wide, high) = -np.radians(sides[0][0]), ends_of(context), _room(film, lying)
    composition.check_room((wide, high), film.size, chosen.dpi)
    size = round(wide * chosen.dpi), round(high * chosen.dpi)
    settings = replace(chosen, bare=True, strict=strict, samples=SAMPLES, size=size)
    first = View(context[:1], Cell(), turned, ends, context)
    scene = Scene(stored, kind, [[first]], context, "", camera, settings)
    composition.check_stations(replace(scene, rows=[[replace(first, bodies=context)]]))
    return _frames(scene, film, cases, bodies, (wide, high), lying, step)


def _frames(
    scene: Scene,
    film: Film,
    cases: Sequence[dict[str, int]],
    bodies: Sequence[rods.Body | None],
    room: tuple[float, float],
    lying: bool,
    step: Callable[[str], None],
) -> Iterator[Pixels]:
    """The frames of a scene that shows the first rod: of each case with its body."""
    from . import composition

    stored, settings, ((first,),) = scene.stored, scene.settings, scene.rows
    fig = canvas.figure(film.size, lambda fig: _begin(fig, film, scene, lying), dpi=settings.dpi, layout=None)
    fig.set_facecolor(settings.look[page.WHITE])
    for where, body in zip(cases, bodies, strict=True):
        step(_value(stored, film.axis, where[film.axis]))
        view = replace(first, bodies=[body] if body else [])
        shown = replace(scene, rows=[[view]])
        picture = composition.compose(shown) if body else None
        with rc_context(fonts.RC):
            drawn = [] if film.settings.bare else [*_draw_case(fig, film, stored, where[film.axis])]
            drawn += _draw_rod(fig, film, shown, picture, room, where)
        page.recolour(fig, settings.look)
        yield _even(page.pixels_of(fig))
        for artist in drawn:
            artist.remove()


def _room(film: Film, lying: bool) -> tuple[float, float]:
    """Width and height of the rod on a frame; lying: whether the diagram stands below it, else beside it."""
    if film.settings.bare:
        return film.size
    beside, below = DIAGRAM if film.observable else (0.0, 0.0)
    wide, high = film.size[0] - 2 * canvas.MARGIN, film.size[1] - TOP - FOOT
    return (wide, high - below) if lying else (wide - beside, high)


def _begin(fig: Figure, film: Film, scene: Scene, lying: bool) -> None:
    """What all frames have: the name of the axis, the scale of colours, and the scales of the diagram."""
    from . import composition

    (across, tall), (_, high), stored = film.size, _room(film, lying), scene.stored
    ax = fig.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set(xlim=(0, across), ylim=(tall, 0))
    ax.axis("off")
    if film.settings.bare:
        return
    left, right = canvas.MARGIN, across - canvas.MARGIN
    ax.plot([left, right], [left + 0.34] * 2, color=colours.FAINT, linewidth=2.0, solid_capstyle="round")
    weight, (painted, beyond) = scene.down, composition.colour_rods(scene)
    paint = painted.paint
    if weight is not None:
        signs.draw_weight(ax, right - 0.85, tall - 0.27, weight)
    if paint.label:
        signs.draw_bar(ax, paint, (2 * left, tall - 0.32), (1.6, 0.1))
    inside, note = str(stored.attrs["side"]) == "inside", str(stored.attrs.get(scene_kinds.NOTE, ""))
    notes = [*scene.seen_along, *beyond, *(long_rod.notes_on(scene.context, stored.units["length"]) * inside)]
    start = max(2.3, 2 * left + fonts.width_of(paint.label, fonts.SMALL) + 0.1)  # beside the bar
    room = across - start - (0.1 if weight is None else 1.2)
    said = [fonts.break_lines(text, room, fonts.SMALL) for text in (labels.capital(note), stored.left_out)]
    words = "\n".join(filter(None, [", ".join(notes), *said]))
    ax.text(start, tall - 0.24, words, size=fonts.SMALL, color=colours.SOFT)
    if film.observable:
        box = (0.62, FOOT + 0.3, across - 0.9, DIAGRAM[1] - 0.5)
        if not lying:
            box = (across - DIAGRAM[0] + 0.45, FOOT + 0.35, DIAGRAM[0] - 0.65, high - 0.55)
        place = box[0] / across, box[1] / tall, box[2] / across, box[3] / tall
        _draw_diagram(fig.add_axes(place), stored, film)


def _draw_case(fig: Figure, film: Film, stored: StoredStudy, i: int) -> Iterator[Artist]:
    """The i-th value of the axis in words and among the others, on its scale; the curve of the diagram up to it."""
    ax, array = fig.axes[0], stored[film.axis]
    left, right = canvas.MARGIN, film.size[0] - canvas.MARGIN
    words, name = _value(stored, film.axis, i), labels.long_name(array)
    name = labels.equation(array, array.values[i]) if film.axis == SAMPLE else labels.capital(name)
    yield ax.text(right, left + 0.02, name, color=colours.SOFT, va="top", ha="right")
    room = right - left - fonts.width_of(name, fonts.NORMAL) - 0.1
    size = next((size for size in TITLES if fonts.width_of(words, size) < room), TITLES[-1])
    yield ax.text(left, left, words, size=size, va="top", weight="bold")
    ends = array.values[[0, i, -1]]
    if film.branches is not None:  # as in the diagram
        ends[[0, -1]] = array.values.min(), array.values.max()
    first, at, last = np.log(ends) if stored.is_logarithmic(film.axis) else ends
    place = left + (at - first) / (last - first) * (right - left)
    yield from ax.plot([left, place], [left + 0.34] * 2, color=colours.SOFT, linewidth=2.0, solid_capstyle="round")
    yield from ax.plot(place, left + 0.34, "o", color=colours.INK, markersize=6)
    for diagram in (ax for ax in fig.axes if ax.get_label() == DIAGRAM_LABEL):
        at = float(labels.in_label_unit(array, array.values[i]))
        yield from _grow(diagram, at) if film.branches is None else _place_dot(diagram, film, stored, i, at)


def _value(stored: StoredStudy, axis: str, i: int) -> str:
    """The i-th value of an axis in words; of a sample those of its fields."""
    fields = (stored.sampled if axis == SAMPLE else []) or [axis]
    return stored.equations(dict.fromkeys(fields, i))


def _grow(ax: Axes, at: float) -> Iterator[Artist]:
    """Show the curve of a diagram up to a value, and a dot where it ends."""
    (low, _), (foot, top) = ax.get_xlim(), ax.get_ylim()
    shown = Rectangle((low, foot), at - low, top - foot, transform=ax.transData)
    for artist in (*ax.lines, *ax.collections):
        artist.set_clip_path(shown)
    for line in ax.lines:
        if line.get_label() == BRACKET:
            line.set_visible(float(np.max(np.asarray(line.get_xdata()))) <= at)
    curve = max(ax.lines, key=Artist.get_zorder)
    values = np.asarray(curve.get_ydata())[np.asarray(curve.get_xdata()) == at]
    yield from ax.plot([at] * values.size, values, "o", color=colours.INK, markersize=5, zorder=5)


def _place_dot(ax: Axes, film: Film, stored: StoredStudy, i: int, at: float) -> Iterator[Artist]:
    """A dot in a diagram of branches, at the i-th case."""
    assert film.observable is not None
    height = float(labels.in_label_unit(stored[film.observable], stored[film.observable].values[i]))
    yield from ax.plot(at, height, "o", color=colours.DATA, markersize=8, zorder=10, markeredgecolor="white")


def _draw_rod(
    fig: Figure, film: Film, scene: Scene, picture: Page | None, room: tuple[float, float], where: dict[str, int]
) -> Iterator[Artist]:
    """The picture of a rod in the middle of its room, with the rings and warnings of a still; or why there is none."""
    from . import composition

    bare, dpi = film.settings.bare, film.settings.dpi
    ax, left, low = fig.axes[0], canvas.MARGIN * (not bare), film.size[1] - TOP * (not bare) - room[1]
    if picture is None:
        outcome = str(scene.stored["outcome"].isel(where).values)
        yield ax.text(canvas.MARGIN, TOP + room[1] / 2, outcome, color=colours.SOFT)
        return
    size = np.array(picture.pixels.shape[1::-1]) / dpi
    corner = np.array([left, low]) + (np.array(room) - size) / 2
    x, y = np.round(corner * dpi).astype(int)
    yield fig.figimage(picture.pixels, x, y, origin="upper", zorder=-1)
    if bare:
        return
    start = x / dpi, film.size[1] - y / dpi - size[1]
    yield from page.draw_rings(ax, start, composition.rings_in(scene, picture.arrangement))
    ringed = composition.rings_in_words(scene.views, scene.camera)
    said = [signs.legend_sign(signs.RING, ringed)] if ringed else []
    said += [signs.legend_sign("none", text) for text in composition.impossible(scene.bodies, bool(ringed))]
    if said:
        yield ax.legend(
            handles=said, ncols=len(said), loc="center left", bbox_to_anchor=(canvas.MARGIN, WARNED),
            bbox_transform=ax.transData, borderpad=0, borderaxespad=0, handlelength=1.0, fontsize=fonts.SMALL,
        )  # fmt: skip


def _draw_diagram(ax: Axes, stored: StoredStudy, film: Film) -> None:
    """The whole curve of the observable, with its name above it."""
    assert film.observable is not None
    if film.branches is None:
        trend(stored.trend(film.observable, film.axis, film.at), ax)
    else:
        bifurcation.panel(film.branches, ax, film.observable, fonts.inches(ax)[1])
    ax.set_label(DIAGRAM_LABEL)
    wide = fonts.inches(ax)[0]
    ax.set(xlabel=fonts.fit_label(partial(labels.axis_label, stored[film.axis]), wide), ylabel="")
    is_wide = wide > DIAGRAM[0]
    side, place = ("right", (1.0, 1.0)) if is_wide else ("left", (0.0, 1.0))
    columns = {} if film.branches is None else {"ncols": len(canvas.legend_entries(ax)), "handlelength": 1.3}
    canvas.add_legend(
        ax, loc=f"lower {side}", bbox_to_anchor=place, borderpad=0.2, fontsize=fonts.SMALL, columnspacing=1.0, **columns
    )
    has_line = not is_wide and ax.get_legend() is not None  # of its own, below the name
    name = labels.label(stored[film.observable], long=True)
    if has_line and fonts.width_of(name, fonts.SMALL) > wide:  # no room for two lines
        name = labels.label(stored[film.observable])
    name = fonts.break_lines(labels.capital(name), wide, fonts.SMALL)
    ax.set_title(name, loc="left", size=fonts.SMALL, pad=18 if has_line else 6)


def write(
    paths: Sequence[Path],
    made: Iterator[Pixels],
    fps: float = FPS,
    each: int = 1,
    back: bool = False,
    stay: float = HOLD,
) -> None:
    """Write the frames as films, each complete before it takes its name. Raises `InputError` where that fails.

    each: how often a frame is shown. back: the film runs back again, and has no beginning. stay: seconds for which the
    first frame and the last stay.
    """
    with atomic.refusing(paths[0].parent), ExitStack() as whole:
        aside = [whole.enter_context(atomic.replacement(path)) for path in paths]
        with ExitStack() as open_ones:
            # imageio's own context leaves ffmpeg running where something fails inside
            writers = [open_ones.enter_context(closing(_writer(path, fps))) for path in aside]
            hold = 0 if back else round(stay * fps)
            shown: list[Pixels] = []
            for frame in made:
                for writer in writers:
                    for _ in range(each + (0 if shown else hold)):
                        writer.append_data(frame)
                shown = [*shown, frame] if back else [frame]
            for frame in shown[-2:0:-1] if back else shown * hold:
                for writer in writers:
                    for _ in range(each if back else 1):
                        writer.append_data(frame)


class _Pillow:
    """A writer of WebP and GIF; a GIF has 256 colours, which are mixed in dots where a colour changes smoothly."""

    def __init__(self, path: Path, fps: float) -> None:
        self.path, self.duration, self.frames = path, 1000 / fps, list[Any]()

    def append_data(self, frame: Pixels) -> None:
        from PIL import Image

        picture: Any = Image.fromarray(frame)
        if self.path.suffix.lower() == ".gif":
            palette = picture.quantize(256, method=Image.Quantize.FASTOCTREE)
            picture = picture.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
        self.frames.append(picture)

    def close(self) -> None:
        if not self.frames:
            return
        gif = self.path.suffix.lower() == ".gif"
        duration = max(round(self.duration / 10) * 10, 20) if gif else round(self.duration)
        how: dict[str, Any] = {} if gif else {"quality": QUALITY, "method": 4}
        self.frames[0].save(self.path, save_all=True, append_images=self.frames[1:], duration=duration, loop=0, **how)


def _even(frame: Pixels) -> Pixels:
    """The frame with its last row or column twice where its size is odd: MP4 takes even sizes only."""
    high, wide = frame.shape[:2]
    return np.pad(frame, ((0, high % 2), (0, wide % 2), (0, 0)), mode="edge")


def _imageio() -> Any:
    """The library that writes films, or `InputError` with what to install."""
    try:
        import imageio.v2
    except ImportError:
        raise InputError(f"an MP4 needs imageio, which is not installed: {INSTALL}; .gif and .webp do not") from None
    return imageio.v2


def _writer(path: Path, fps: float) -> Any:
    """The writer of one film."""
    if path.suffix.lower() != ".mp4":
        return _Pillow(path, fps)
    return _imageio().get_writer(
        path, fps=fps, codec="libx264", quality=8, macro_block_size=2, ffmpeg_log_level="error"
    )
