"""`shooting`: ends problems by the quadrature of `orbit`, exact to rounding for a rod of any length.

If the seed is a solution, its equilibrium is continued; if it is a number, Newton's rule on the slope at the start
finds the equilibrium near it, for all problems at once. Without a seed, and near a saddle, where the slope at the start
does not resolve the equilibria, the search over levels and paths of `equilibria` is used.
"""

from dataclasses import dataclass

from ..choose.selection import NEAREST, Choose
from ..numerics.arrays import Array
from ..problem.reduced import EndsProblem
from ..problem.trajectory import Seed, Trajectory
from .base import EndsMethod, Ladder, tens


@dataclass(frozen=True)
class Shooting(EndsMethod):
    """The orbit of the right length; it has no knobs."""

    name = "shooting"
    summary = "the level at which the orbit's length is the rod's"
    order = float("inf")
    knows_orbit = True
    ladders = (Ladder("shooting", "tol", tens(2, 13, 2), "#009e9e", "o", bold=True),)

    def run(
        self, problem: EndsProblem, t: Array, tol: float, seed: Seed | None = None, choose: Choose = NEAREST
    ) -> Trajectory:
        from ..choose.each_equilibrium import each_equilibrium

        return each_equilibrium(problem, t, tol, seed, choose)
