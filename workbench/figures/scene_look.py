"""The look of a rod on its cylinder that pictures and pages share: the wall, the shadow on it, hidden stretches."""

from typing import Any

from . import push_colours

SURFACE = "#e6e1d8"  # the cylinder: warm, so a pale blue rod stands out from it
DEPTH = 0.55  # of the shadow where nothing of the light from all around arrives
REACH = 6.0  # radii of the rod, beyond which its shadow is not computed
OUTLINE = "#5b6675"  # of a hidden stretch
HIDDEN_LINE = 0.8  # its opacity
HIDDEN_SHADE = 0.06  # by which the cylinder is darker there


def for_pages() -> dict[str, Any]:
    """All of this and the colours of the push as plain data for the scripts of a page."""
    surface, outline = ([int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in (SURFACE, OUTLINE))
    return push_colours.for_pages() | {
        "surface": surface, "depth": DEPTH, "reach": REACH,
        "outline": outline, "line": HIDDEN_LINE, "shade": HIDDEN_SHADE,
    }  # fmt: skip
