"""What is drawn on the page of a scene: words, lines, rings and dots, and the blocks that are made of them.

Lengths are in pixels at `style.DPI`, from the lower left of the page.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D

from ..figures import style
from . import measure

PATCH = 26.0  # a colour of the legend
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


def ring(fig: Figure, x: float, y: float, radius: float) -> None:
    """Draw an open circle in ink with a white edge, seen on every colour; everywhere as large as in the legend."""
    thin = min(1.0, radius / (PATCH / 2)) ** 0.5
    for colour, wide in (("white", 3.0), (style.INK, 1.4)):
        fig.add_artist(circle(fig, x, y, radius, fill=False, edgecolor=colour, linewidth=wide * thin))


def spot(fig: Figure, x: float, y: float, radius: float, colour: str) -> None:
    """Draw a filled circle over lines."""
    fig.add_artist(circle(fig, x, y, radius, facecolor=colour, linewidth=0, zorder=3))


def circle(fig: Figure, x: float, y: float, radius: float, **how: Any) -> Circle:
    """A circle on the page."""
    return Circle((x, y), radius, transform=pixels(fig), **how)


def pixels(fig: Figure) -> Any:
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
        Line2D([a[0], b[0]], [a[1], b[1]], transform=pixels(fig), solid_capstyle=how.pop("capstyle", "round"), **how)
    )


def dot(fig: Figure, x: float, y: float, number: str, stable: bool) -> None:
    """The number of an equilibrium in a dot: filled where it is stable."""
    look = {"facecolor": style.INK} if stable else {"facecolor": "white"}
    fig.add_artist(circle(fig, x, y, 15.0, edgecolor=style.INK if stable else style.SOFT, linewidth=0.9, **look))
    size = style.SMALL if len(number) < 2 else 0.8 * style.SMALL
    text(fig, x, y - 1, number, ha="center", va="center", color="white" if stable else style.INK, size=size)
