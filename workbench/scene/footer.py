"""What stands below the views of a scene: the directions of x, y, z, scale bar, colour bar, legend, notes.

Each block is measured before it is placed; what does not fit into a line begins the next. Lengths are in pixels at
`style.DPI`, from the lower left of the page.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from ..data import labels
from ..figures import style
from . import measure
from .colours import SURFACE, Bar
from .drawing import PATCH, SMALL, Block, line, ring, text
from .triad import triad

BAR = (330.0, 20.0)  # the colour bar
SCALE = 200.0  # the longest scale bar
APART, LINE = 34.0, 20.0  # between blocks of a line, and between lines
STACK = 24.0  # between two entries of the legend, one below the other
RING, OUTLINE = "ring", "outline"  # in place of a colour: an open circle, the outline of a hidden stretch


def blocks(
    axes: NDArray[np.float64],
    scale: tuple[float, str, float],
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
        Pixels per length, the unit of length, and the share of a length along the axis that is seen.
    radius
        Of the rings.
    """
    found = [triad(axes), _scale_bar(*scale)]
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
    for row in reversed(lines):
        tall, left = max(block.height for block in row), x
        for block in row:
            block.draw(fig, left, y + (tall - block.height) / 2)
            left += block.width + APART
        y += tall + LINE


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
            look: dict[str, Any] = {"facecolor": colour, "linewidth": 0.0}
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
