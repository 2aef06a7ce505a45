"""What stands below the views of a scene: the directions of x, y, z, scale bar, colour bar, legend, notes.

Each block is measured before it is placed; what does not fit into a line begins the next. Lengths are in pixels at
`style.DPI`, from the lower left of the page.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon, Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from ..data import labels
from ..figures import style
from . import measure
from .colours import SURFACE, Bar

TRIAD = 46.0  # an arrow of the axes
FLAT = 0.08  # an axis that is seen shorter points along the sight; all of it is 1
BAR = (330.0, 20.0)  # the colour bar
SCALE, SMALL_SCALE = 200.0, 110.0  # the longest scale bar, and that of a cell
APART, LINE = 34.0, 20.0  # between blocks of a line, and between lines
PATCH, STACK = 26.0, 18.0  # a colour of the legend, and between two entries one below the other
RING, OUTLINE = "ring", "outline"  # in place of a colour: an open circle, the outline of a hidden stretch
SMALL: dict[str, Any] = {"size": style.SMALL}
HALO: dict[str, Any] = {
    "weight": "bold", "size": style.SMALL, "path_effects": [withStroke(linewidth=2.5, foreground="white")],
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Block:
    """A piece of the footer: its width and height, and what draws it from its lower left corner on."""

    width: float
    height: float
    draw: Callable[[Figure, float, float], Any]


def blocks(
    axes: NDArray[np.float64],
    scale: tuple[float, str, float] | None,
    bar: Bar | None,
    legend: Sequence[tuple[str, str]],
    notes: Sequence[str],
    room: float,
    radius: float = PATCH / 2,
) -> list[Block]:
    """All blocks in order.

    Parameters
    ----------
    axes
        Where x, y, z point on the page, (3, 2).
    scale
        Pixels per length, the unit of length, and the share of a length along the axis that is seen; default:
        no scale bar.
    radius
        Of the rings.
    """
    found = [_triad(axes), *([_scale_bar(*scale)] if scale else [])]
    if bar:
        found.append(colour_bar(bar))
    if legend:
        found.append(stacked([entry(colour, text, radius) for colour, text in legend]))
    if notes:
        found.append(_words("\n".join(measure.wrapped(note, 0.45 * room, style.SMALL) for note in notes)))
    return found


def lines_of(found: Sequence[Block], room: float) -> list[list[Block]]:
    """The blocks in lines no longer than the room."""
    lines: list[list[Block]] = [[]]
    for block in found:
        if lines[-1] and sum(one.width + APART for one in lines[-1]) + block.width > room:
            lines.append([])
        lines[-1].append(block)
    return lines


def height(lines: Sequence[Sequence[Block]]) -> float:
    """The height of all lines."""
    return sum(max(block.height for block in line) for line in lines) + LINE * max(len(lines) - 1, 0)


def draw(fig: Figure, lines: Sequence[Sequence[Block]], x: float, y: float) -> None:
    """Draw the lines from the lower left corner on."""
    for line in reversed(lines):
        tall, left = max(block.height for block in line), x
        for block in line:
            block.draw(fig, left, y + (tall - block.height) / 2)
            left += block.width + APART
        y += tall + LINE


def _triad(axes: NDArray[np.float64]) -> Block:
    """The axes x, y, z as the camera sees them: an arrow each, as short as it is seen, or a circle along the sight.

    The circle has a dot for an axis that points at the viewer and a cross for one that points away. Where x and y are
    slanted, and so lie in one line, the azimuth from which the camera looks is said beside them.
    """
    low, high = np.minimum(axes.min(axis=0), 0), np.maximum(axes.max(axis=0), 0)
    size = TRIAD * (high - low) + 30
    toward = np.cross(axes[:, 0], axes[:, 1])
    words = slant(toward)

    def draw(fig: Figure, x: float, y: float) -> None:
        origin = np.array([x, y]) + 15 - TRIAD * low + [0, (max(size[1], 86.0) - size[1]) / 2]
        along = int(np.argmax(np.abs(toward)))
        for k, (name, way) in enumerate(zip("xyz", axes, strict=True)):
            seen = float(np.hypot(*way))
            if seen > FLAT:
                line(fig, origin, origin + TRIAD * way, color=style.INK, linewidth=1.4)
                _head(fig, origin + TRIAD * way, way / seen)
            side = way / max(seen, 0.3) if seen > FLAT else 1.4 * _free_side(axes)
            if seen > FLAT and any(_along(way, other) and np.hypot(*other) > seen for other in axes):
                side = np.array([-way[1], way[0]]) / seen  # beside the longer arrow over it
            place = origin + TRIAD * way * (seen > FLAT) + (13 if k != along else 14) * side
            text(fig, place[0], place[1], name, ha="center", va="center", **SMALL)
        if np.hypot(*axes[along]) <= FLAT:
            _along_sight(fig, origin, toward[along] > 0)
        else:
            fig.add_artist(_circle(fig, origin[0], origin[1], 3.5, facecolor=style.INK, linewidth=0))
        if words:
            text(fig, x + size[0] + 14, y + max(size[1], 86.0) / 2, words, color=style.SOFT, va="center", **SMALL)

    wide = 14 + measure.width(words, style.SMALL) if words else 0.0
    return Block(float(size[0]) + wide, float(max(size[1], 86.0)), draw)


def _along(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether two arrows lie over each other."""
    return bool(one @ other > 0.95 * np.hypot(*one) * np.hypot(*other))


def slant(toward: NDArray[np.float64]) -> str:
    """From where the camera looks, where it looks across the axis z but neither along x nor along y; else nothing.

    toward: the direction to the viewer, (3,).
    """
    if abs(toward[2]) > 1e-9 or np.abs(toward[:2]).min() <= FLAT:
        return ""
    azimuth = labels.minus_signs(f"{np.degrees(np.arctan2(toward[1], toward[0])):.0f}")
    return f"seen from\n\N{GREEK SMALL LETTER ALPHA} = {azimuth}°"


def _head(fig: Figure, tip: NDArray[np.float64], way: NDArray[np.float64]) -> None:
    """The head of an arrow; way: its direction, of length 1."""
    across = np.array([-way[1], way[0]])
    corners = [tip + 5 * way, tip - 6 * way + 5 * across, tip - 6 * way - 5 * across]
    fig.add_artist(Polygon(corners, transform=_pixels(fig), facecolor=style.INK, linewidth=0))


def _along_sight(fig: Figure, middle: NDArray[np.float64], at_viewer: bool) -> None:
    """A circle with a dot for an arrow that points at the viewer, with a cross for one that points away."""
    fig.add_artist(_circle(fig, middle[0], middle[1], 9.0, facecolor="white", edgecolor=style.INK, linewidth=1.2,
                           zorder=3))  # fmt: skip
    if at_viewer:
        spot(fig, middle[0], middle[1], 3.5, style.INK)
        return
    for up in (-1, 1):
        arm = 9.0 * np.sqrt(0.5) * np.array([1, up])
        line(fig, middle - arm, middle + arm, color=style.INK, linewidth=1.2, zorder=4)


def _free_side(axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """The direction on the page that is farthest from the axes, for the letter of one that points at the viewer."""
    away = -axes.sum(axis=0)
    return away / max(float(np.hypot(*away)), 0.3)


def _scale_bar(per_unit: float, unit: str, along_axis: float) -> Block:
    """A bar of a round length; where the axis is seen at a slant, of a length along it."""
    length = round_length(SCALE / (per_unit * along_axis))
    pixels = length * per_unit * along_axis
    words = f"{labels.number(length)} {unit}" + ("" if along_axis > 1 - 1e-9 else " along the axis")
    wide = max(measure.width(words), pixels)

    def draw(fig: Figure, x: float, y: float) -> None:
        left = x + (wide - pixels) / 2
        for a, b in (((0, 0), (pixels, 0)), ((0, -7), (0, 7)), ((pixels, -7), (pixels, 7))):
            line(fig, np.add((left, y + 14), a), np.add((left, y + 14), b), color=style.INK, linewidth=1.4)
        text(fig, x + wide / 2, y + 30, words, ha="center", va="bottom")

    return Block(wide, 64.0, draw)


def small_scale(fig: Figure, middle: float, top: float, per_unit: float, unit: str) -> None:
    """Draw a scale bar and its length in one line, the middle of which is below a place of the page."""
    length = round_length(SMALL_SCALE / per_unit)
    pixels, words = length * per_unit, f"{labels.number(length)} {unit}"
    left, y = middle - (pixels + 10 + measure.width(words, style.SMALL)) / 2, top - 24
    for a, b in (((0, 0), (pixels, 0)), ((0, -6), (0, 6)), ((pixels, -6), (pixels, 6))):
        line(fig, np.add((left, y), a), np.add((left, y), b), color=style.INK, linewidth=1.2)
    text(fig, left + pixels + 10, y, words, va="center", **SMALL)


def round_length(target: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above the target."""
    power = 10.0 ** np.floor(np.log10(target))
    return float(max(step for step in (1, 2, 5) if step * power <= target * (1 + 1e-9)) * power)


def colour_bar(bar: Bar) -> Block:
    """The colour bar with a few round values below and its quantity above."""
    label = measure.wrapped(bar.label, BAR[0] + 60, style.SMALL)
    words = measure.height(label, style.SMALL)

    def draw(fig: Figure, x: float, y: float) -> None:
        width, high = fig.get_size_inches() * style.DPI
        ax = fig.add_axes((x / width, (y + 30) / high, BAR[0] / width, BAR[1] / high))
        ax.imshow(np.linspace(0, 1, 256)[None], cmap=bar.ramp, aspect="auto", extent=(bar.low, bar.high, 0, 1))
        ax.set(yticks=[])
        ax.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]))
        ax.xaxis.set_major_formatter(lambda value, _: labels.number(value).replace("-", "−"))
        ax.tick_params(axis="x", length=3, labelsize=style.SMALL, labelcolor=style.INK, pad=2)
        for spine in ax.spines.values():
            spine.set(visible=True, color=style.SOFT, linewidth=0.5)
        text(fig, x, y + 34 + BAR[1], label, va="bottom", **SMALL)

    return Block(max(BAR[0], measure.width(label, style.SMALL)) + 12, 34 + BAR[1] + words, draw)


def entry(colour: str, words: str, radius: float = PATCH / 2) -> Block:
    """A colour of the legend and its meaning; radius: of a ring."""
    words = measure.wrapped(words, 420.0, style.SMALL)
    high = max(measure.height(words, style.SMALL), PATCH)

    def draw(fig: Figure, x: float, y: float) -> None:
        middle = y + high / 2
        if colour == RING:
            ring(fig, x + PATCH / 2, middle, radius)
        else:
            size = fig.get_size_inches() * style.DPI
            look = {"facecolor": colour, "linewidth": 0.0}
            if colour == OUTLINE:
                look = {"facecolor": SURFACE, "edgecolor": style.SOFT, "linewidth": 0.6}
            fig.add_artist(Rectangle((x / size[0], (middle - 8) / size[1]), PATCH / size[0], 16 / size[1],
                                     transform=fig.transFigure, **look))  # fmt: skip
        text(fig, x + PATCH + 12, middle, words, va="center", **SMALL)

    return Block(PATCH + 12 + measure.width(words, style.SMALL), high, draw)


def stacked(found: Sequence[Block]) -> Block:
    """Blocks one below the other, on a common left edge."""
    high = sum(block.height for block in found) + STACK * (len(found) - 1)

    def draw(fig: Figure, x: float, y: float) -> None:
        top = y + high
        for block in found:
            block.draw(fig, x, top - block.height)
            top -= block.height + STACK

    return Block(max(block.width for block in found), high, draw)


def _words(words: str) -> Block:
    high = measure.height(words, style.SMALL)
    return Block(
        measure.width(words, style.SMALL), high,
        lambda fig, x, y: text(fig, x, y + high / 2, words, color=style.SOFT, va="center", **SMALL),
    )  # fmt: skip


def ring(fig: Figure, x: float, y: float, radius: float) -> None:
    """Draw an open circle in ink with a white edge, seen on every colour; everywhere as large as in the legend."""
    thin = min(1.0, radius / (PATCH / 2)) ** 0.5
    for colour, wide in (("white", 3.0), (style.INK, 1.4)):
        fig.add_artist(_circle(fig, x, y, radius, fill=False, edgecolor=colour, linewidth=wide * thin))


def spot(fig: Figure, x: float, y: float, radius: float, colour: str) -> None:
    """Draw a filled circle over lines."""
    fig.add_artist(_circle(fig, x, y, radius, facecolor=colour, linewidth=0, zorder=3))


def _circle(fig: Figure, x: float, y: float, radius: float, **how: Any) -> Circle:
    return Circle((x, y), radius, transform=_pixels(fig), **how)


def _pixels(fig: Figure) -> Any:
    """From pixels at `style.DPI` to the figure's own."""

    return Affine2D().scale(1 / style.DPI) + fig.dpi_scale_trans


def text(fig: Figure, x: float, y: float, words: str, **how: Any) -> None:
    """Write words at a place of the page."""
    width, high = fig.get_size_inches() * style.DPI
    if "\n" in words:
        how = {"linespacing": measure.LINE / measure.ASCENT, **how}
    fig.text(x / width, y / high, words, **how)


def line(fig: Figure, a: Any, b: Any, **how: Any) -> None:
    """Draw a line from a to b."""
    fig.add_artist(
        Line2D([a[0], b[0]], [a[1], b[1]], transform=_pixels(fig), solid_capstyle=how.pop("capstyle", "round"), **how)
    )


def dot(fig: Figure, x: float, y: float, number: str, stable: bool) -> None:
    """The number of an equilibrium in a dot: filled where it is stable."""
    look = {"facecolor": style.STABLE} if stable else {"facecolor": "white"}
    fig.add_artist(_circle(fig, x, y, 15.0, edgecolor=style.STABLE if stable else style.SOFT, linewidth=0.9, **look))
    size = style.SMALL if len(number) < 2 else 0.8 * style.SMALL
    text(fig, x, y - 1, number, ha="center", va="center", color="white" if stable else style.INK, size=size)
