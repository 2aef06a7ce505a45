"""The command animate: the cases along an axis as a film, an observable's curve growing beside the rod.

One frame a stored case; nothing is solved between them. The rod's part of a frame is what `scene --along` draws of that
case, so a still and a scene agree. MP4 and GIF are written by imageio, the extra `animate`.
"""

from collections.abc import Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from solver.observe.observables import OBSERVABLES
from solver.problem.errors import InputError, choices, no_such

from ..data import atomic, law_verdicts, schema, selection, writing
from ..scene import kinds
from . import console, plot_and_scene

FILMS = (".mp4", ".gif")
WIDE = 4.4  # inches of the diagram
HOLD = 1.0  # seconds that the last frame stays
LEAST, MOST = 2, 2000  # frames
RATES = (0.1, 60.0)  # frames a second
INSTALL = "pip install 'imageio[ffmpeg]', or the extra animate"


@dataclass(frozen=True)
class Wish:
    """What is asked of a film.

    axis: along which it runs; at: values of the other axes; kind: of the scene, one that shows one case; show: the
    observable whose curve grows; pixel_error, dpi: as of a scene.
    """

    axis: str
    at: dict[str, float]
    kind: str = "contact"
    show: str = ""
    pixel_error: float = 0.5
    dpi: int = 120


def animate_file(
    file: Path, axis: str | None, at: list[str], kind: str, show: str | None, out: list[Path], fps: float,
    pixel_error: float, dpi: int, force: bool,
) -> int:  # fmt: skip
    """Write the film of a stored dataset; 0, or 1 where this machine cannot draw. Raises `InputError`."""
    ds = writing.read(file)
    axes = schema.axes_of(ds)
    if not axes:
        raise InputError(f"{file} has one case and no axis, so nothing changes from frame to frame")
    if axis is None and len(axes) > 1:
        raise InputError(f"{file} has several axes: choose one with --axis from {choices(axes)}")
    axis = selection.axis_of(ds, axis or axes[0])
    where = plot_and_scene.chosen(ds, at)
    if axis in where:
        raise InputError(f"--at {axis}: the film runs along {axis}, so it has no one value")
    wish = Wish(axis, where, kind, observable(ds, axis, show), pixel_error, dpi)
    paths = [_free(path, force) for path in out or [file.with_name(f"{file.stem}_{axis}.mp4")]]
    cases = cases_of(ds, wish)
    if not RATES[0] <= fps <= RATES[1]:
        raise InputError(f"--fps must be between {RATES[0]:g} and {RATES[1]:g}, got {fps:g}")
    _able(paths)
    from ..scene import opengl

    able, advice = opengl.probe()
    if not able:
        console.warn(advice)
        return 1
    with console.progress(len(cases)) as step:
        write(paths, frames(ds, wish, step), fps)
    for path in paths:
        console.say(f"{path}: {len(cases)} frames, {fps:g} a second")
    return 0


def observable(ds: xr.Dataset, axis: str, show: str | None) -> str:
    """The observable whose curve is drawn: the one asked for, the axis's first law's, or the first that is stored."""
    stored = [name for name in OBSERVABLES if name in ds and ds[name].dims == ds["outcome"].dims]
    if not stored:
        raise InputError("the dataset stores no observable whose curve could grow: name some in the study")
    if show is not None:
        if show not in stored:
            raise no_such("observable", show, stored)
        return show
    judged = [law.observable for law in law_verdicts.laws(ds) if law.axis == axis]
    return next(name for name in (*judged, *stored) if name in stored)


def cases_of(ds: xr.Dataset, wish: Wish) -> list[dict[str, int]]:
    """The indices of each frame's case. Raises `InputError` for what no film can be made of."""
    single = [kind.name for kind in kinds.KINDS.values() if kind.cells == "one"]
    if kinds.kind_of(wish.kind).name not in single:
        raise InputError(f"a frame shows one case, so --kind is one of {choices(single)}, not {wish.kind!r}")
    cases = selection.line(ds, wish.axis, wish.at)
    if not LEAST <= len(cases) <= MOST:
        raise InputError(f"a film has {LEAST} to {MOST} frames, and the axis {wish.axis} {len(cases)} values")
    return cases


def frames(ds: xr.Dataset, wish: Wish, step: Any = None) -> Iterator[NDArray[np.uint8]]:
    """The frames in rising order of the axis, (height, width, 3) each, all of one even size.

    On the left what `scene --along` draws of the case, on the right the observable up to it. A case without a shape
    leaves the left side empty but for its outcome.
    """
    from ..scene import composition, layout, page_layout

    look = composition.Look(wish.pixel_error, wish.dpi)
    diagram = _Diagram(ds, wish)
    for k, where in enumerate(cases_of(ds, wish)):
        value = float(ds[wish.axis].values[where[wish.axis]])
        if step:
            step(f"{wish.axis} = {value:.4g}")
        outcome = str(ds["outcome"].isel(where).values)
        if ds["solved"].isel(where):
            taken = layout.take(ds, {**wish.at, wish.axis: value}, wish.kind, (), wish.axis, look)
            left = _pixels(page_layout.figure(taken.sheet))
        else:
            left = _empty(ds, outcome, wish.dpi, composition.PAGE)
        yield _even(np.concatenate([left, diagram.upto(k, left.shape[0])], axis=1))


def write(paths: list[Path], made: Iterator[NDArray[np.uint8]], fps: float) -> None:
    """The frames as films, each whole before it takes its name. Raises `InputError` where they cannot be written."""
    with atomic.refusing(paths[0].parent), ExitStack() as whole:
        aside = [whole.enter_context(atomic.replacing(path)) for path in paths]
        with ExitStack() as open_ones:
            # imageio's own context leaves ffmpeg running where something fails inside
            writers = [open_ones.enter_context(closing(_writer(path, fps))) for path in aside]
            last = None
            for last in made:
                for writer in writers:
                    writer.append_data(last)
            for _ in range(round(HOLD * fps)):
                for writer in writers:
                    writer.append_data(last)


def _able(paths: list[Path]) -> None:
    """Raise `InputError` where what writes such films is not installed: before anything is drawn."""
    _imageio()
    if any(path.suffix.lower() == ".mp4" for path in paths) and not find_spec("imageio_ffmpeg"):
        raise InputError(f"an MP4 needs imageio-ffmpeg, which is not installed: {INSTALL}; a .gif does not")


def _imageio() -> Any:
    """The library that writes films, or `InputError` with what to install."""
    try:
        import imageio.v2
    except ImportError:
        raise InputError(f"a film needs imageio, which is not installed: {INSTALL}") from None
    return imageio.v2


def _writer(path: Path, fps: float) -> Any:
    """What takes the frames of one film."""
    if path.suffix.lower() == ".gif":
        return _imageio().get_writer(path, mode="I", duration=1000 / fps, loop=0)
    return _imageio().get_writer(path, fps=fps, codec="libx264", quality=8, macro_block_size=2,
                                  ffmpeg_log_level="error")  # fmt: skip


class _Diagram:
    """The observable against the axis, its frame that of the whole curve, drawn up to a case."""

    def __init__(self, ds: xr.Dataset, wish: Wish) -> None:
        self.ds, self.wish = ds, wish

    def upto(self, k: int, height: int) -> NDArray[np.uint8]:
        """Pixels, (height, ., 3), with the curve up to the k-th case."""
        from matplotlib import rc_context
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
        from matplotlib.layout_engine import ConstrainedLayoutEngine

        from ..figures import style, trends

        ds, wish = self.ds, self.wish
        with rc_context(style.RC):
            room = ConstrainedLayoutEngine(rect=(0.02, 0.2, 0.92, 0.6))
            fig = Figure(figsize=(WIDE, height / wish.dpi), dpi=wish.dpi, layout=room)
            FigureCanvasAgg(fig)
            ax = trends.trend(ds, fig.add_subplot(), wish.show, wish.axis, wish.at)
            limits = ax.get_xlim(), ax.get_ylim()
            for artist in (*ax.lines, *ax.collections):  # the scales, labels and ticks stay those of the whole curve
                artist.remove()
            cases = selection.line(ds, wish.axis, wish.at)
            values = np.array([float(ds[wish.show].isel(where)) for where in cases])
            along = ds[wish.axis].values[[where[wish.axis] for where in cases]].astype(float)
            along = np.degrees(along) if style.is_angle(ds[wish.axis]) else along
            ax.plot(along[: k + 1], values[: k + 1], color=style.SOFT, linewidth=1.4)
            ax.scatter(along[:k], values[:k], color=style.SOFT, s=14, zorder=3)
            ax.scatter(along[k], values[k], color=style.PUSHED, s=60, zorder=4, edgecolors="white")
            ax.set(xlim=limits[0], ylim=limits[1])
            ax.set_title(style.wrapped(style.words(ds[wish.show]), ax), loc="left")
            return _pixels(fig)


def _pixels(fig: Any) -> NDArray[np.uint8]:
    fig.canvas.draw()
    return np.array(fig.canvas.buffer_rgba())[..., :3]


def _empty(ds: xr.Dataset, outcome: str, dpi: int, page: tuple[int, int]) -> NDArray[np.uint8]:
    """A page of a scene's size that says why there is no rod."""
    from ..scene import page_layout
    from ..scene.page_layout import Cell, Sheet

    blank = np.full((8, 8, 3), 255, dtype=np.uint8)
    made = Sheet(str(ds.attrs["title"]), outcome, blank, [[Cell("")]], 1.0, str(ds.attrs["length_unit"]),
                 np.zeros((3, 2)), least=page, dpi=dpi)  # fmt: skip
    return _pixels(page_layout.figure(made))


def _even(frame: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """With a white row or column more where one is missing: MP4 takes even sizes only."""
    high, wide = frame.shape[:2]
    return np.pad(frame, ((0, high % 2), (0, wide % 2), (0, 0)), constant_values=255)


def _free(path: Path, force: bool) -> Path:
    return plot_and_scene.free_picture(path, FILMS, force)
