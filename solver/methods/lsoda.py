"""`lsoda`: scipy's LSODA, Adams' multistep formulas of order up to 12 that change to BDF where the problem is stiff.

One call of the equation a step, so it is strong where calls are dear; here they are cheap.
"""

from .adaptive import make_run
from .base import Knob, Method

LSODA = Method(
    "lsoda",
    make_run("LSODA"),
    ("start",),
    12,
    "multistep formulas of variable order, to 12 (scipy's LSODA)",
    {"rtol": Knob(float)},
)
