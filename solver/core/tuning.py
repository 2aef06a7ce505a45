"""The tuned constants that C and Python share. Each stands once in Python: here, or where a package before this one has
it. The core has them as the struct of `tuning.h`, by their names in small letters: `library` fills it when it loads the
core, and the core for browsers is compiled with them.
"""

import re
from pathlib import Path

from ..numerics.arclength import COSINE as COSINE
from ..numerics.arclength import ENDING
from ..numerics.arclength import OFF as OFF
from ..numerics.arrays import EPS
from ..numerics.roots import CLOSE as CLOSE
from ..problem.trajectory import SHAPELESS as SHAPELESS

# steps along a branch
LONGEST = 0.25  # in scales
NARROW = 1e-3  # length of a step below which other coordinates and a leap are tried
STEPS_KEPT = 10  # steps for which another coordinate is kept
EASY_BEND = 0.05  # distance from the predictor, as a share of the step, that the next step aims at
SLOWER, FASTER = 0.3, 2.0  # the next step over this one, at least and at most
STEEP = 0.2  # dp along the branch, in scales, above which a step may end at a given p
SHARE = 0.1  # of the change of p in a step, over which differences in p are taken
LEAST, AHEAD = 1e-10, 1e-6  # the least and the largest of it, in scales of p
NUDGE = 1e-5  # of the unknown's scale, for differences
SAME_SADDLE = 0.1  # half of the largest angle by which a saddle moves in a step
BACK = 1e-6  # in scales: an equilibrium as near to the first is the first
BESIDE_HELIX = 1e-6  # of the size of G: H at the ends of a rod that is nearly a helix
BESIDE_HELD_HELIX = 1e-3  # the same with held ends
ROUNDS, SETTLED, SMALL, CONTRACTION = ENDING.rounds, ENDING.goal, ENDING.small, ENDING.growth

# levels and orbits
LOWEST = -575.0  # log of the smallest gap that a float can hold with what is made of it
ON = 1e-110  # an end this near to a saddle lies on it
MOVED = 1e-7  # of a pin by rounding, at most: the root of that of G, where a saddle is about to meet a centre
AT_REST = 4e-16  # of the size of G: an H that is rounding
# of the size of G: saddles whose heights differ by less are as high. Rounding made at most a third of it between
# two saddles that are mirror images, in 1,200 pairs
AS_HIGH = 1e-14
MOST_PANELS = 10_000  # of one orbit, beyond which none is halved any more

# marches and what is measured along them
MOST_STEPS = 200_000  # of a stretch: a longer march, of a second or two, is lost
SAFETY = 3.0  # of a standard deviation, or of an estimated error
BARELY = 64 * EPS  # of the size of its terms: a push, or a difference of numbers, below this is rounding

ROWS = re.findall(  # types, and the names that have them
    r"^    (double|int64_t) ([\w, ]+);", Path(__file__).with_name("tuning.h").read_text(encoding="utf-8"), re.MULTILINE
)
NAMES = [name for _, names in ROWS for name in names.split(", ")]


def values() -> dict[str, float]:
    """The constants by their names in the struct, in its order."""
    return {name: globals()[name.upper()] for name in NAMES}


def initializer() -> str:
    """The constants as C writes the struct."""
    return f"{{{', '.join(map(repr, values().values()))}}}"
