"""How much room words take before they are placed. Lengths in pixels at `style.DPI`."""

from functools import cache
from typing import Any

from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.font_manager import FontProperties

from ..figures import style

LINE = 1.18  # from line to line, in sizes of the font
ASCENT = 0.76  # of DejaVu Sans, to which Matplotlib's line spacing refers


@cache
def _renderer() -> Any:
    return RendererAgg(8, 8, style.DPI)


@cache
def width(text: str, size: float = style.NORMAL, bold: bool = False) -> float:
    """Width of the longest line of a text in a font of that size in points."""
    font = FontProperties(family=style.RC["font.family"], size=size, weight="bold" if bold else "normal")
    each = (_renderer().get_text_width_height_descent(line, font, False)[0] for line in text.split("\n"))
    return float(max(each, default=0.0))


def height(text: str, size: float = style.NORMAL) -> float:
    """Height of a text of one line or more; 0 without one."""
    return (1 + text.count("\n") * LINE) * size * style.DPI / 72 if text else 0.0


def step(size: float = style.NORMAL) -> float:
    """From line to line."""
    return size * LINE * style.DPI / 72


def wrapped(text: str, room: float, size: float = style.NORMAL, bold: bool = False) -> str:
    """The text in lines that are no longer than the room, broken at spaces only."""
    lines: list[str] = []
    for line in text.split("\n"):
        made = ""
        for word in line.split(" "):
            longer = f"{made} {word}" if made else word
            if made and width(longer, size, bold) > room:
                lines.append(made)
                longer = word
            made = longer
        lines.append(made)
    return "\n".join(lines)
