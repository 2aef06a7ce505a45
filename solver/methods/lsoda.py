"""`lsoda`: scipy's LSODA, Adams' multistep formulas of order up to 12 that change to BDF where the problem is stiff.

It evaluates the equation once a step, an advantage where evaluations are expensive; here they are cheap.
"""

from dataclasses import dataclass

from .adaptive import ScipyAdaptive
from .base import MOST_CALLED, Ladder, tens


@dataclass(frozen=True)
class LSODA(ScipyAdaptive):
    """Multistep formulas. rtol: the tolerance of a step; default: sought so that `tol` is met."""

    name = "lsoda"
    summary = "multistep formulas of variable order, to 12 (scipy's LSODA)"
    order = 12
    integrator = "LSODA"
    ladders = (Ladder("lsoda", "rtol", (*tens(2, 12, 2), 1e-13), "#a04890", "^", most=2 * MOST_CALLED),)
