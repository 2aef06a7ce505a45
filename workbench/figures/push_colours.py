"""The look of a rod on its cylinder, for scenes, figures, the report and the live page.

The push has one diverging scale, pale at 0: blue where the cylinder pushes, orange to brown where it would pull.
"""

from typing import Any

import numpy as np

# share of the strongest push (1) or pull (-1) -> red, green, blue between 0 and 255, which are interpolated between two
# rows; the tint changes at 0
DIVERGING: tuple[tuple[float, tuple[int, int, int]], ...] = (
    (-1.0, (126, 58, 4)),
    (-0.6, (189, 98, 4)),
    (-0.25, (232, 146, 48)),
    (-1e-6, (250, 214, 170)),
    (0.0, (211, 227, 241)),
    (0.2, (146, 195, 226)),
    (0.4, (88, 161, 207)),
    (0.6, (42, 123, 183)),
    (0.8, (15, 84, 152)),
    (1.0, (7, 44, 105)),
)
PUSHED, PULLED = (42, 123, 183), (222, 120, 0)  # where one colour says push, or pull
ENDS = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # round numbers, at which a scale ends
UNIFORM, BEYOND = 0.95, 1.5  # a push that varies less than that; how far beyond it its scale then ends
ROUNDING = 1e-9  # share of the largest push below which a pull is rounding
WORDS, PULL_WORDS = "push [{unit}]", ", orange: pull"
SURFACE = "#e6e1d8"  # the cylinder: warm, so a pale blue rod stands out from it
DEPTH = 0.55  # of the shadow on it where nothing of the light from all around arrives
REACH = 6.0  # radii of the rod, beyond which its shadow is not computed
OUTLINE = "#5b6675"  # of a hidden stretch
HIDDEN_LINE = 0.8  # its opacity
HIDDEN_SHADE = 0.06  # by which the cylinder is darker there


def scale(least: float, largest: float) -> tuple[float, float]:
    """Where the drawn scale of pushes between two values begins and ends: (-end, end), or (0, end) without a pull.

    (0, 0) without any push. A uniform push does not have the darkest colour.
    """
    size = max(abs(least), abs(largest))
    if size == 0:
        return 0.0, 0.0
    end = round_up(size * (BEYOND if least > UNIFORM * size else 1.0))
    return (-end if least < -ROUNDING * size else 0.0), end


def round_up(size: float) -> float:
    """The least of `ENDS` times a power of ten that is not below a size."""
    power = 10.0 ** np.floor(np.log10(size))
    return float(next(end for end in (*ENDS, 10.0 * ENDS[1]) if end * power >= size * (1 - 1e-9)) * power)


def words(unit: str, low: float) -> str:
    """What a scale that begins at `low` is called."""
    return WORDS.format(unit=unit) + (PULL_WORDS if low < 0 else "")


def for_pages() -> dict[str, Any]:
    """All of this as plain data for the scripts of a page."""
    surface, outline = ([int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in (SURFACE, OUTLINE))
    return {
        "stops": DIVERGING, "pushed": PUSHED, "pulled": PULLED, "ends": ENDS, "uniform": UNIFORM, "beyond": BEYOND,
        "rounding": ROUNDING, "words": WORDS, "pullWords": PULL_WORDS, "surface": surface, "depth": DEPTH,
        "reach": REACH, "outline": outline, "line": HIDDEN_LINE, "shade": HIDDEN_SHADE,
    }  # fmt: skip
