"""A film of the cases along an axis: the rod of each stored case, and beside it the growing curve of an observable.

One frame a stored case; nothing is solved between them. The rod's part of a frame is what `layout.compose` draws of
that case with the same axis as `along`. MP4 and GIF are written by imageio, the extra `animate`. Frames need OpenGL.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from solver.problem.errors import InputError, choices, no_such

from ..data import atomic, labels, law_verdicts, schema, selection
from ..figures import canvas, style
from ..figures.trends import trend
from . import page, pixels
from .arrangement import Arrangement
from .kinds import KINDS, kind_of
from .page import Page, Words
from .pixels import Pixels

SUFFIXES = (".mp4", ".gif")
DIAGRAM = 3.52  # inches of width
SIZE = (1280, 848)  # pixels at `style.DPI` of the scene in a frame
DIGITS = 4  # of the values in a frame
HOLD = 1.0  # seconds for which the last frame stays
LEAST, MOST = 2, 2000  # frames
INSTALL = "pip install 'rod-workbench[animate]'"


@dataclass(frozen=True)
class Film:
    """What a film shows.

    Attributes
    ----------
    axis
        The axis along which it runs.
    at
        Values of the other axes.
    observable
        The observable whose curve grows.
    kind
        A kind of scene that shows one case.
    pixel_error, dpi
        As of a scene.
    """

    axis: str
    at: dict[str, float]
    observable: str
    kind: str = "contact"
    pixel_error: float = 0.5
    dpi: int = 150


def observable_of(ds: xr.Dataset, axis: str, name: str | None = None) -> str:
    """The observable whose curve is drawn; default: that of the axis's first law, else the first that is stored.

    Raises `InputError` where the dataset stores no such observable.
    """
    stored = [one for one in schema.observables_of(ds) if ds[one].dims == ds["outcome"].dims]
    if not stored:
        raise InputError("the dataset stores no observable whose curve could be drawn: add some to the study")
    if name is not None:
        if name not in stored:
            raise no_such("observable", name, stored)
        return name
    judged = [law.observable for law in law_verdicts.laws(ds) if law.axis == axis]
    return next(one for one in (*judged, *stored) if one in stored)


def cases_of(ds: xr.Dataset, film: Film) -> list[dict[str, int]]:
    """The indices of each frame's case. Raises `InputError` for a kind or an axis that makes no film."""
    single = [kind.name for kind in KINDS.values() if kind.cells == "one"]
    if kind_of(film.kind).name not in single:
        raise InputError(f"a frame shows one case, so --kind is one of {choices(single)}, not {film.kind!r}")
    cases = selection.line(ds, film.axis, film.at)
    if not LEAST <= len(cases) <= MOST:
        raise InputError(f"a film has {LEAST} to {MOST} frames, and the axis {film.axis} {len(cases)} values")
    return cases


def check_writers(paths: Sequence[Path]) -> None:
    """Raise `InputError` with what to install where films of these suffixes cannot be written."""
    _imageio()
    if any(path.suffix.lower() == ".mp4" for path in paths) and not find_spec("imageio_ffmpeg"):
        raise InputError(f"an MP4 needs imageio-ffmpeg, which is not installed: {INSTALL}; a .gif does not")


def frames(ds: xr.Dataset, film: Film, step: Callable[[str], None] = lambda text: None) -> Iterator[Pixels]:
    """The frames in rising order of the axis, (height, width, 3) each, all of one even size.

    On the left the scene of the case, on the right the observable up to it. A case without a shape leaves the left side
    empty but for its outcome. step: called with a text as each frame begins.
    """
    from . import composition, layout  # VTK, which ends the process where OpenGL does not work

    size = tuple(round(n * film.dpi / style.DPI) for n in SIZE)
    settings = composition.Settings(film.pixel_error, film.dpi, size=(size[0], size[1]), digits=DIGITS)
    for k, where in enumerate(cases_of(ds, film)):
        value = float(ds[film.axis].values[where[film.axis]])
        step(f"{film.axis} = {value:.4g}")
        if ds["solved"].isel(where):
            picture = layout.compose(ds, {**film.at, film.axis: value}, film.kind, (), film.axis, settings)
            left = pixels.drawn(page.figure(picture.page))
        else:
            left = _empty(ds, str(ds["outcome"].isel(where).values), film.dpi, SIZE)
        yield even(np.concatenate([left, pixels.drawn(diagram(ds, film, k, left.shape[0]))], axis=1))


def diagram(ds: xr.Dataset, film: Film, k: int, height: int) -> Figure:
    """The observable against the axis up to the k-th case, with the scales of the whole curve; height in pixels."""
    cases = selection.line(ds, film.axis, film.at)
    values = np.array([float(ds[film.observable].isel(where)) for where in cases])
    along = labels.in_label_unit(ds[film.axis], ds[film.axis].values[[where[film.axis] for where in cases]])

    def draw(fig: Figure) -> None:
        ax = trend(ds, fig.add_subplot(), film.observable, film.axis, film.at)
        limits = ax.get_xlim(), ax.get_ylim()
        for artist in (*ax.lines, *ax.collections):  # the scales, labels and ticks stay those of the whole curve
            artist.remove()
        ax.plot(along[: k + 1], values[: k + 1], color=style.SOFT, linewidth=1.4)
        ax.scatter(along[:k], values[:k], color=style.SOFT, s=14, zorder=3)
        ax.scatter(along[k], values[k], color=style.PUSHED, s=60, zorder=4, edgecolors="white")
        ax.set(xlim=limits[0], ylim=limits[1])
        ax.set_title(style.wrapped(f"{_capital(labels.long_name(ds[film.observable]))} against {along_axis}", ax),
                     loc="left")  # fmt: skip

    along_axis = labels.long_name(ds[film.axis])
    room = ConstrainedLayoutEngine(rect=(0.02, 0.08, 0.92, 0.78))
    return canvas.figure((DIAGRAM, height / film.dpi), draw, dpi=film.dpi, layout=room)


def write(paths: Sequence[Path], made: Iterator[Pixels], fps: float) -> None:
    """Write the frames as films, each complete before it takes its name. Raises `InputError` where that fails."""
    with atomic.refusing(paths[0].parent), ExitStack() as whole:
        aside = [whole.enter_context(atomic.replacing(path)) for path in paths]
        with ExitStack() as open_ones:
            # imageio's own context leaves ffmpeg running where something fails inside
            writers = [open_ones.enter_context(closing(_writer(path, fps))) for path in aside]
            adding = [_adding(path, writer) for path, writer in zip(aside, writers, strict=True)]
            last = np.zeros((0, 0, 3), dtype=np.uint8)
            for last in made:
                for add in adding:
                    add(last)
            for _ in range(round(HOLD * fps)):
                for add in adding:
                    add(last)


def _adding(path: Path, writer: Any) -> Callable[[Pixels], None]:
    """What adds a frame to a film; a GIF has 256 colours, which are mixed in dots where a colour changes smoothly."""
    if path.suffix.lower() != ".gif":
        return lambda frame: writer.append_data(frame)

    def add(frame: Pixels) -> None:
        from PIL import Image

        picture = Image.fromarray(frame)
        palette = picture.quantize(256, method=Image.Quantize.FASTOCTREE)
        mixed = picture.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
        writer.append_data(np.asarray(mixed.convert("RGB")))

    return add


def even(frame: Pixels) -> Pixels:
    """The frame with a white row or column more where its size is odd: MP4 takes even sizes only."""
    high, wide = frame.shape[:2]
    return np.pad(frame, ((0, high % 2), (0, wide % 2), (0, 0)), constant_values=255)


def _imageio() -> Any:
    """The library that writes films, or `InputError` with what to install."""
    try:
        import imageio.v2
    except ImportError:
        raise InputError(f"a film needs imageio, which is not installed: {INSTALL}") from None
    return imageio.v2


def _writer(path: Path, fps: float) -> Any:
    """The writer of one film."""
    if path.suffix.lower() == ".gif":
        return _imageio().get_writer(path, mode="I", duration=1000 / fps, loop=0)
    return _imageio().get_writer(path, fps=fps, codec="libx264", quality=8, macro_block_size=2,
                                  ffmpeg_log_level="error")  # fmt: skip


def _capital(text: str) -> str:
    """The text with a capital letter at its beginning, except where it begins with a symbol."""
    return text[:1].upper() + text[1:] if text[1:2].isalpha() else text


def _empty(ds: xr.Dataset, outcome: str, dpi: int, size: tuple[int, int]) -> Pixels:
    """A page of a scene's size with the reason why there is no rod."""
    blank = np.full((8, 8, 3), 255, dtype=np.uint8)
    nothing = Arrangement([], (0.0, 0.0), 1.0)
    words = Words(str(ds.attrs["title"]), outcome, str(ds.attrs["length_unit"]))
    return pixels.drawn(page.figure(Page(words, blank, nothing, np.zeros((3, 2)), size[0], size[1], dpi)))
