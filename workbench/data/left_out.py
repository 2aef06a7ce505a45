"""What the model leaves out, in one sentence, and the load at which weight begins to matter: a help to judge a pipe.

`docs/explanation/what-the-model-leaves-out.md` says how much each of these may change.
"""

import math
from typing import TYPE_CHECKING

from solver.problem.errors import InputError

if TYPE_CHECKING:
    from solver import Case, Solution

SENTENCE = "The model leaves out weight, friction, joints, and clearance at the ends."


def note(case: "Case", sol: "Solution", weight: float | None, unit: str) -> str:
    """The sentence that belongs to a rod inside a cylinder, and what its weight would do; "" for one outside.

    weight: per length in the fluid [force/length], or None. unit: of force. Raises `InputError` for a weight that is
    not positive, or of a rod outside.
    """
    if case.cylinder.side != "inside":
        if weight is not None:
            raise InputError("--weight compares with a pipe that lies on the low side of a hole: --side inside")
        return ""
    if weight is None:
        return SENTENCE
    if not (weight > 0 and math.isfinite(weight)):
        raise InputError(f"--weight must be positive and finite, got {weight:g}")
    load = dawson_paslay(float(case.rod.bending_stiffness), weight, float(case.rho))
    push = -float(sol.FZ)
    effect = (
        "beyond it the pipe buckles with its weight too" if push > load else "below it a pipe with weight is straight"
    )
    return (
        f"{SENTENCE} A long horizontal pipe of this weight begins to buckle at a compression of {load:.4g} {unit} "
        f"(Dawson and Paslay); here it is {push:.4g} {unit}: {effect}."
    )


def dawson_paslay(bending_stiffness: float, weight: float, rho: float) -> float:
    """The compression at which a long horizontal pipe on the low side of a hole begins to buckle [force].

    2 sqrt(A w/rho), without friction (Dawson and Paslay, 1984).

    Parameters
    ----------
    bending_stiffness : float
        A [force length^2].
    weight : float
        Weight per length in the fluid [force/length].
    rho : float
        Distance of the pipe's centreline from the axis of the hole [length].
    """
    return 2 * math.sqrt(bending_stiffness * weight / rho)
