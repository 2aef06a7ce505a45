"""Every colour of a figure, a scene, a report and a page by its role, and the scales of colours.

Red is for what fails and for nothing else. The push has one diverging scale, pale at 0: blue where the cylinder pushes,
orange to brown where it would pull. Stability is the weight of a line. Matplotlib is loaded where a scale is drawn.
"""

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from studies.laws.line_verdicts import FAILS, HOLDS, QUALIFIED, TREND, UNDECIDED

if TYPE_CHECKING:
    from matplotlib.colors import Colormap, ListedColormap

INK, SOFT, FAINT = "#1c2430", "#5b6675", "#d5dae1"
BAND = "#f1f3f6"  # behind a line of a long rod
DATA, OTHERS = "#2f5f8f", "#b3c6da"  # numbers that are no push, at the chosen and at other values of another axis
PAIR = ("#5b3f8c", "#2f9a82")  # two of a kind that is no push
SEVERAL = ("#2b3442", "#7440b0", "#259e73")  # several rods on one cylinder, dark to light; none is red
CROSSED = "#7d2ea0"  # rings where a rod passes through itself
UNKNOWN = "#ffffff"  # a cell of a map without a number
# a cell without a solution: grey, and hatched, because some colours of a map are as light
UNSOLVED: dict[str, Any] = {"facecolor": FAINT, "edgecolor": SOFT, "hatch": "////", "linewidth": 0}
# each 4.5 : 1 on white, and distinct under each kind of colour blindness
VERDICTS = {HOLDS: "#01834e", TREND: "#1b4cc8", QUALIFIED: "#707500", UNDECIDED: "#6d727c", FAILS: "#8a050f"}
# behind words and lines, words, words that stand back, lines that stand back, curves of numbers, rings
THEMES = {
    "light": ("#ffffff", INK, SOFT, FAINT, DATA, CROSSED),
    "dark": ("#14181e", "#e9edf2", "#b0bac6", "#38414d", "#8ab8e6", "#a45cc8"),
}
LEAST = (4.5, 4.5, 1.3, 3.0, 3.0)  # contrast of each of these to what is behind it; of words and marks as of WCAG
BLACK, LIGHTEST = "#000000", "#fefefe"  # the latter is not the white that stands for a background
STABLE: dict[str, Any] = {"color": INK, "linewidth": 1.7}
UNSTABLE: dict[str, Any] = {"color": SOFT, "linewidth": 0.8}
STATES = {"straight": "#968f62", "sinusoidal": PAIR[1], "helical": PAIR[0]}  # of `solver.nodes.pipe_states`
# cells of the map of extremes; solved ones by how near their error is to what the method promises
EXTREMES = {"refused": "#e3e6ea", "inaccurate": "#e98f88", "non-finite": "#e0cdea", "vague": "#c9d8f2"}
SOLVED = ("#7fc6a6", "#cfe8dc", "#f8f7d8")

# A rod on its cylinder
NEUTRAL = "#8d96a1"  # a rod in one colour
UNPAINTED, STRIPE = "#d9c9a3", "#5a9667"  # the rod beside its stripe, and the stripe; no colours of the push or rings
STRANDS = ("#5d4a72", "#2f9a82", "#cbb893")  # of DNA, and its base pairs; no colours of the push
LETTERED = (0.60, 0.63, 0.68)  # the rod that shows the letters of its geometry: grey, as blue would be a push
CUT = "#f4f1eb"  # the end of a drawn cylinder
SURFACE = "#e6e1d8"  # the cylinder: warm, so a pale blue rod stands out from it
DEPTH = 0.55  # of the shadow on it where nothing of the light from all around arrives
REACH = 6.0  # radii of the rod, beyond which its shadow is not computed
OUTLINE = SOFT  # of a hidden stretch
HIDDEN_LINE, EDGE_LINE = 0.8, 0.7  # its opacity; that of the outline of a stretch in sight
HIDDEN_SHADE = 0.06  # by which the cylinder is darker there

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
PUSHED, PULLED = "#2a7bb7", "#de7800"  # where one colour says push, or pull
ENDS = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # round numbers, at which a scale ends
UNIFORM, BEYOND = 0.95, 1.5  # a push that varies less than that; how far beyond it its scale then ends
ROUNDING = 1e-9  # share of the largest push below which a pull is rounding
LIFTS = "below 0 the rod would lift off"  # the one sentence on the sign of a push
WORDS, PULL_WORDS = "push [{unit}]", f"; {LIFTS}"

COUNTS = "Blues"  # how many cases lie in a cell
RAMP = "viridis"  # of a quantity that is no push
RAMP_ENDS = (0.0, 0.59)  # of lines and dots: beyond, their contrast to white is below 3
# Maps: the same ramp mixed with white, so that ink (numbers, marks, lines) stands out from every colour of it
MAP_ENDS, WHITE_OF_MAP = (0.0, 0.88), 0.42


def of_line(look: Mapping[str, Any]) -> dict[str, Any]:
    """Colour and width of a look."""
    return {"color": look["color"], "linewidth": look["linewidth"]}


def push_scale(least: float, largest: float) -> tuple[float, float]:
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


def push_words(unit: str, low: float) -> str:
    """What a scale of pushes that begins at `low` is called."""
    return WORDS.format(unit=unit) + (PULL_WORDS if low < 0 else "")


@cache
def push_ramp() -> "Colormap":
    """The colours of a push, from the strongest pull to the strongest push; pale at 0."""
    from matplotlib.colors import LinearSegmentedColormap

    stops = [((share + 1) / 2, (r / 255, g / 255, b / 255)) for share, (r, g, b) in DIVERGING]
    return LinearSegmentedColormap.from_list("push", stops, 4096)  # so many that a jump from pull to push is sharp


def ramp() -> "Colormap":
    """The colours of a quantity that is no push, from its lowest value to its highest."""
    from matplotlib import colormaps

    return colormaps[RAMP]


def ramp_colours(count: int, ends: tuple[float, float] = RAMP_ENDS) -> list[Any]:
    """That many colours along the ramp, between two places on it."""
    return list(map(tuple, ramp()(np.linspace(*ends, count)).tolist()))


def map_colours(count: int = 256) -> "ListedColormap":
    """The colours of a map, from its lowest value to its highest."""
    from matplotlib.colors import ListedColormap

    pure = np.array(ramp_colours(count, MAP_ENDS))
    return ListedColormap(pure * (1 - WHITE_OF_MAP) + WHITE_OF_MAP, name="map")


def rgb(colour: str) -> tuple[int, int, int]:
    """``#2a7bb7`` as red, green and blue between 0 and 255."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue


def theme_on(background: str) -> str:
    """The theme whose words stand out more from a background."""
    return "light" if contrast(BLACK, background) > contrast(LIGHTEST, background) else "dark"


def theme_with(background: str) -> tuple[str, ...]:
    """A row of `THEMES` on any background: of the theme whose words stand out more, each colour as much nearer to black
    or to white as its contrast to the background needs."""
    theme = theme_on(background)
    end = np.array(rgb(BLACK if theme == "light" else LIGHTEST))

    def nearer(colour: str, least: float) -> str:
        shades = (np.rint(rgb(colour) + share * (end - rgb(colour))).astype(int) for share in np.linspace(0, 1, 21))
        each = ["#" + bytes(shade.tolist()).hex() for shade in shades]
        return next((shade for shade in each if contrast(shade, background) >= least), each[-1])

    return background, *map(nearer, THEMES[theme][1:], LEAST)


def contrast(colour: str, other: str) -> float:
    """The contrast of two colours as of the Web Content Accessibility Guidelines, between 1 and 21."""
    dark, bright = sorted(float(linear(each) @ [0.2126, 0.7152, 0.0722]) + 0.05 for each in (colour, other))
    return bright / dark


def linear(colour: str) -> Any:
    """A colour of the screen (sRGB) as the light it stands for, (3,) between 0 and 1, which is what glTF stores."""
    c = np.array(rgb(colour)) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def for_pages() -> dict[str, Any]:
    """The look of a rod on its cylinder as plain data for the scripts of a page."""
    return {
        "stops": DIVERGING, "pushed": rgb(PUSHED), "pulled": rgb(PULLED), "ends": ENDS, "uniform": UNIFORM,
        "beyond": BEYOND, "rounding": ROUNDING, "words": WORDS, "pullWords": PULL_WORDS, "surface": rgb(SURFACE),
        "depth": DEPTH, "reach": REACH, "outline": rgb(OUTLINE), "line": HIDDEN_LINE, "shade": HIDDEN_SHADE,
    }  # fmt: skip
