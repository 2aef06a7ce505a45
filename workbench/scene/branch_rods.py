"""The stable rods of a file of branches in three dimensions, below the diagram of the branches. Needs OpenGL.

Each rod has the number of its point in the diagram. Lengths are in inches.
"""

from collections.abc import Sequence
from dataclasses import replace

from matplotlib.figure import Figure

from ..figures import bifurcation, canvas, fonts
from ..figures.sheet import Sheet
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import body, composition, layout, page, signs
from .page import Page, Scene
from .scene_kinds import Cell, kind_of
from .settings import Settings
from .views import View, azimuth_of, front_camera, in_rows

DIAGRAM, RODS = 3.6, 3.2  # heights of the diagram and of the room of the rods
LEFT, BELOW, FOOT = 0.75, 1.0, 0.55  # beside and below the diagram, and below the rods for scale and colours
WORDS = 0.36  # above the rods, for their numbers
PITCH = 1.28  # heights of a row from one to the next: room for the numbers


def figure(stored: StoredStudy, shapes: Sequence[int], rods: StoredStudy, settings: Settings) -> tuple[Figure, Page]:
    """The figure, and the picture of its rods.

    shapes: of the file of branches. rods: they, solved again, over the dimension `equilibrium`. Raises
    `TooFewStations`.
    """
    scene, picture = _compose(rods, settings)
    high = picture.pixels.shape[0] / settings.dpi
    fig = canvas.figure(
        (page.WIDE, canvas.TITLE + DIAGRAM + BELOW + WORDS + high + FOOT),
        lambda fig: _draw(fig, stored, shapes, scene, picture),
        dpi=settings.dpi,
        layout=None,
    )
    fig.set_facecolor(settings.look[page.WHITE])
    x, y = round((page.WIDE - picture.pixels.shape[1] / settings.dpi) / 2 * settings.dpi), round(FOOT * settings.dpi)
    fig.figimage(picture.pixels, x, y, origin="upper", zorder=-1)
    page.recolour(fig, settings.look)
    return fig, picture


def _compose(stored: StoredStudy, settings: Settings) -> tuple[Scene, Page]:
    """The rods side by side, each of which faces the viewer, upright or lying as they are larger."""
    kind, count = kind_of("contact"), stored.sizes["equilibrium"]
    each = [body.read(stored, {"equilibrium": k}, kind) for k in range(count)]
    room = page.WIDE - 2 * canvas.MARGIN, RODS
    size = round(room[0] * settings.dpi), round(room[1] * settings.dpi)
    bare = replace(settings, bare=True, size=size)
    views = [View([rod], Cell(), -azimuth_of([rod])) for rod in each]
    cameras = [front_camera([], layout.LEVEL, lying) for lying in (False, True)]
    scenes = [
        Scene(stored, kind, in_rows(views, camera, room), each, "", camera, bare, pitch=PITCH) for camera in cameras
    ]
    return scenes[0], layout.compose_larger(scenes, room)


def _draw(fig: Figure, stored: StoredStudy, shown: Sequence[int], scene: Scene, picture: Page) -> None:
    """The diagram, the numbers of the rods, the scale of lengths and the colours of the push."""
    wide, high = map(float, fig.get_size_inches())
    canvas.write_title(fig, str(stored.attrs["title"]), stored.reading)
    top = canvas.TITLE / high
    ax = fig.add_axes((LEFT / wide, 1 - top - DIAGRAM / high, 1 - (LEFT + 0.2) / wide, DIAGRAM / high))
    bifurcation.panel(stored, ax, str(stored.attrs["shown"]), DIAGRAM, Sheet(page.WIDE - LEFT), shown)
    canvas.add_legend(ax, loc="upper left", bbox_to_anchor=(0, -0.5 / DIAGRAM), ncols=3, borderpad=0)
    words = fig.add_axes((0.0, 0.0, 1.0, 1.0))
    words.set(xlim=(0, wide), ylim=(high, 0))
    words.axis("off")
    name, names = str(stored.attrs["axis"]), bifurcation.names_of_shapes(stored)
    left, down = (wide - picture.pixels.shape[1] / fig.dpi) / 2, high - FOOT - picture.pixels.shape[0] / fig.dpi
    boxes = picture.arrangement.boxes.reshape(-1, 4)
    for k, (x, y, across, _) in zip(shown, boxes, strict=False):
        value = labels.value(float(stored[f"shape_{name}"].values[k]), stored[name], 3)
        at = left + x + across / 2, down + y - 0.04
        words.text(*at, f"{names[k]}\n{value}", ha="center", va="bottom", size=fonts.SMALL)
    paint = composition.colour_rods(scene)[0].paint
    signs.draw_scale(words, LEFT, high - 0.25, picture.arrangement.scale, stored.units["length"], 1.0)
    if paint.label:
        signs.draw_bar(words, paint, (LEFT + signs.SCALE + 0.4, high - 0.3), (page.BAR, 0.1))
