"""The stable rods of a file of branches in three dimensions, below the diagram of the branches. Needs OpenGL.

Below each rod stands the number of its point in the diagram. Lengths are in inches.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from ..figures import bifurcation, canvas, legend_room
from ..figures.print_heights import TALLEST
from ..figures.sheet import Sheet
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import body, layout, page, signs
from .page import Page, Scene
from .scene_kinds import Cell, kind_of
from .settings import Settings
from .views import View, azimuth_of, front_camera, in_rows

DIAGRAM = 2.6  # the height of the diagram
# around the diagram, of which wide labels leave more on the left, and below the rods for scale and colours
LEFT, RIGHT, BELOW, FOOT = 0.75, 0.2, 0.55, 0.65
ROW, ROWS = 0.19, 3  # the height of a row of the legend, and as many as it has at most
# the largest height of the rods with their words
RODS = TALLEST - canvas.TITLE - DIAGRAM - BELOW - ROWS * ROW - FOOT


def figure(stored: StoredStudy, shapes: Sequence[int], rods: StoredStudy, settings: Settings) -> tuple[Figure, Page]:
    """The figure, and the picture of its rods.

    shapes: of the file of branches. rods: they, solved again, over the dimension `equilibrium`. Raises
    `TooFewStations`.
    """
    picture = _compose(rods, _cells(stored, shapes), settings)
    high = picture.pixels.shape[0] / settings.dpi
    fig = canvas.figure(
        (page.WIDE, canvas.TITLE + DIAGRAM + BELOW + high + FOOT),
        lambda fig: _draw(fig, stored, shapes, picture),
        dpi=settings.dpi,
        layout=None,
    )
    fig.set_facecolor(settings.look[page.WHITE])
    x, y = round((page.WIDE - picture.pixels.shape[1] / settings.dpi) / 2 * settings.dpi), round(FOOT * settings.dpi)
    fig.figimage(picture.pixels, x, y, origin="upper", zorder=-1)
    page.recolour(fig, settings.look)
    return fig, picture


def _cells(stored: StoredStudy, shapes: Sequence[int]) -> list[Cell]:
    """The number of each rod and the value at which it is shown."""
    name, names = str(stored.attrs["axis"]), bifurcation.names_of_shapes(stored)
    values = stored[f"shape_{name}"].values
    return [Cell(f"{names[k]}\n{labels.value(float(values[k]), stored[name])}") for k in shapes]


def _compose(stored: StoredStudy, cells: Sequence[Cell], settings: Settings) -> Page:
    """The rods side by side, each of which faces the viewer, upright or lying as they are larger, with room for the
    words of their cells."""
    kind, count = kind_of("contact"), stored.sizes["equilibrium"]
    each = [body.read(stored, {"equilibrium": k}, kind) for k in range(count)]
    room = page.WIDE - 2 * canvas.MARGIN, RODS
    size = round(room[0] * settings.dpi), round(room[1] * settings.dpi)
    bare = replace(settings, bare=True, size=size)
    views = [View([rod], cell, -azimuth_of([rod])) for rod, cell in zip(each, cells, strict=True)]
    cameras = [front_camera([], layout.LEVEL, lying) for lying in (False, True)]
    scenes = [
        Scene(stored, kind, in_rows(views, camera, room), each, "", camera, bare, has_room_for_words=True)
        for camera in cameras
    ]
    return layout.compose_larger(scenes, room)


def _draw(fig: Figure, stored: StoredStudy, shown: Sequence[int], picture: Page) -> None:
    """The diagram, the words of the rods, the scale of lengths and the colours of the push.

    The figure grows for its legend.
    """
    wide, high = map(float, fig.get_size_inches())
    ax = fig.add_axes((LEFT / wide, 0.0, 1 - (LEFT + RIGHT) / wide, DIAGRAM / high))
    bifurcation.panel(stored, ax, str(stored.attrs["shown"]), DIAGRAM, Sheet(page.WIDE - LEFT), shown)
    names = [*dict.fromkeys(str(entry.get_label()) for entry in canvas.legend_entries(ax))]
    drawn = ax.get_tightbbox()
    assert drawn is not None
    inset = LEFT + max(canvas.MARGIN - drawn.x0 / fig.dpi, 0.0)
    columns, _ = legend_room.legend_columns(names, wide - inset - RIGHT, most=1)
    high += ROW * -(-len(names) // columns)
    fig.set_figheight(high)
    ax.set_position((inset / wide, 1 - (canvas.TITLE + DIAGRAM) / high, 1 - (inset + RIGHT) / wide, DIAGRAM / high))
    canvas.add_legend(ax, loc="upper left", bbox_to_anchor=(0, -0.5 / DIAGRAM), ncols=columns, borderpad=0)
    canvas.write_title(fig, str(stored.attrs["title"]), stored.reading)
    words = fig.add_axes((0.0, 0.0, 1.0, 1.0))
    words.set(xlim=(0, wide), ylim=(high, 0))
    words.axis("off")
    left, down = (wide - picture.pixels.shape[1] / fig.dpi) / 2, high - FOOT - picture.pixels.shape[0] / fig.dpi
    for view, box in zip(picture.scene.views, picture.arrangement.places, strict=True):
        signs.draw_cell(words, view.cell, box + np.array([left, down, 0.0, 0.0]))
    paint = picture.scene.paint
    signs.draw_scale(words, LEFT, high - 0.25, picture.arrangement.scale, stored.units["length"], 1.0)
    if paint.label:
        signs.draw_bar(words, paint, (LEFT + signs.SCALE + 0.4, high - 0.3), (page.BAR, 0.1))
