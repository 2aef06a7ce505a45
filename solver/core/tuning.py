"""The tuned constants that C and Python share. Each stands once in Python: here, or where a package before this one has
it. The core has them as the struct of `tuning.h`, by their names in small letters: `library` fills it when it loads the
core, and the core for browsers is compiled with them.
"""

import re
from pathlib import Path

from ..numerics.arclength import COSINE as COSINE
from ..numerics.arclength import ENDING
from ..numerics.arclength import OFF as OFF
from ..numerics.arrays import ALIKE as ALIKE
from ..numerics.arrays import EPS
from ..numerics.arrays import SHAPELESS as SHAPELESS
from ..numerics.roots import CLOSE as CLOSE

# steps along a branch
LONGEST = 0.25  # in scales. x10: a step passes two folds, or lands on another branch
# length of a step below which other coordinates and a leap are tried. x10: often in vain, which costs time
NARROW = 1e-3
STEPS_KEPT = 10  # steps for which another coordinate is kept. x10: short steps where the first would be better again
# distance from the predictor, as a share of the step, that the next step aims at. x10: above what is accepted, so that
# steps are halved
EASY_BEND = 0.05
# the next step over this one, at least and at most. x10: a step is never made shorter, so that most are refused
SLOWER, FASTER = 0.3, 2.0
# dp along the branch, in scales, above which a step may end at a given p. x10: none ends so, and places are located
# instead
STEEP = 0.2
# of the change of p in a step, over which differences in p are taken, where the largest of these allows. x10: as far as
# the step, a derivative at the next point
SHARE = 0.1
# the least and the largest of it, in scales of p: between rounding and curvature. x10: derivatives by p lose a digit
LEAST, AHEAD = 1e-10, 1e-6
NUDGE = 1e-5  # of the unknown's scale, for differences: the cube root of rounding. x10: their error of order 2 is 1e-8
# half of the largest angle by which a saddle moves in a step. x10: another saddle is taken for it, and the path for
# another
SAME_SADDLE = 0.1
# of the size of G: H at the ends of a rod that is nearly a helix. x10: branches leap where they could step
BESIDE_HELIX = 1e-6
# of the size of G: H at the ends of a held rod that is nearly a helix, which the solver leaves earlier. x10: rods that
# bend leap
BESIDE_HELD_HELIX = 1e-3
# of the scale of p, before and after an end of the rod crosses a saddle, over which a branch leaps where it cannot be
# stepped over: half of the longest leap. x10: a leap ends before the crossing, and branches creep to it
BESIDE_SADDLE = 5e-4
# rad: an end that crosses a saddle within a narrower range of its own angle, where angles have 1e-16, is leapt over.
# x10: branches leap where they could step
UNRESOLVED = 1e-7
ROUNDS, SETTLED, SMALL, CONTRACTION = ENDING.rounds, ENDING.goal, ENDING.small, ENDING.growth

# levels and orbits

# log of the smallest gap that a float can hold with what is made of it: exp(-575) = 1e-250. x10: it underflows
LOWEST = -575.0
ON = 1e-110  # an end this near to a saddle lies on it: its square is a float. x10: no change
# of a pin by rounding, at most: the root of that of G, where a saddle is about to meet a centre. x10: another critical
# point is taken for it
MOVED = 1e-7
# of the size of G: an H that is rounding, two units in the last place. x10: rods that turn by rounding only count as
# helices
AT_REST = 4e-16
# of the size of G: saddles whose heights differ by less are as high. Rounding makes at most a third of it. x10: a rod
# cannot rest between two that differ so little
AS_HIGH = 1e-14
# of one orbit, beyond which none is halved any more. x10: ten times the time and memory before a rod is refused
MOST_PANELS = 10_000

# marches and what is measured along them
MOST_STEPS = 200_000  # of a stretch: a longer march, of a second or two, is lost. x10: so is one of 20 seconds
SAFETY = 3.0  # of a standard deviation, or of an estimated error. x10: good answers are said to have fewer digits
# of the size of its terms: a push, or a difference of numbers, below this is rounding. x10: a small push has no sign
BARELY = 64 * EPS

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
