"""A discrete rod as a program in numbers of order 1, which Uno minimises by its interior-point method.

Unknowns, conditions and energy are divided by their sizes. Without that Uno does not converge for a pipe of 100 m whose
azimuth swings by a radian where its angle to the axis swings by a hundredth.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Integers
from ..problem.errors import InputError
from .discrete_rod import DiscreteRod

OPTIONS = {
    "logger": "SILENT",
    "use_function_scaling": False,  # the sizes do that
    "primal_tolerance": 1e-8,
    "dual_tolerance": 1e-8,
    # of the first barrier problem. x10: minima on coarser meshes are lost
    "barrier_initial_parameter": 1e-2,
    "barrier_k_epsilon": 100.0,  # how closely each barrier problem is solved: with 10, the default, some steps more
}
MOST = 300  # steps of a search: usual are 10 to 200. x10: only failures take longer
ENOUGH = 1e-6  # of what Uno may leave of the equations: Newton's method ends them. x10: from there it may fail
# edges whose equations take as long as what a step of Uno takes besides. x10: fewer steps on coarse meshes
EACH_STEP = 50
CUT = " in as many steps as a search may take"
ANGLES = "alpha", "beta0", "tilt0", "gamma", "azimuth", "betaL", "tiltL", "rotation"


@dataclass
class Effort:
    """What searches for one rod by Uno may still take.

    left: steps, each times the sum of the edges of its mesh and `EACH_STEP`. why: why a search ended early, in words
    that go on after those that it found nothing; empty where none did.
    """

    left: float = np.inf
    why: str = ""


class Sizes(NamedTuple):
    """What unknowns and conditions are divided by: lengths across and along the axis, angles; and the energy."""

    across: float
    along: float
    turned: float
    energy: float


@dataclass(frozen=True, eq=False)
class Program:
    """A discrete rod as a program in numbers of order 1: its unknowns over their sizes, z (size,), 0 at a guess.

    Those that are given have no size, and so no effect; a second derivative of 1 keeps them at 0.
    """

    rod: DiscreteRod
    sizes: Sizes
    base: Array

    @cached_property
    def unit(self) -> Array:
        """The sizes of the unknowns, (size,)."""
        unit = np.full(self.rod.size, self.sizes.turned)
        self.rod.parts(unit)[1][:] = self.sizes.across, self.sizes.across, self.sizes.along
        return np.where(self.rod.known, 0.0, unit)

    @cached_property
    def unit_of(self) -> Array:
        """The sizes of the conditions, (M,)."""
        unit = np.full(self.rod.bounds[0].size, self.sizes.across)
        self.rod.split(unit)[0][:, 2:] = self.sizes.along, self.sizes.turned
        return unit

    @cached_property
    def slopes(self) -> tuple[Integers, Integers, Array]:
        """Rows and columns of the derivatives of the conditions, and their factors of those of the rod."""
        rows, columns = self.rod.jacobian_places
        return rows, columns, self.unit[columns] / self.unit_of[rows]

    @cached_property
    def bends(self) -> tuple[Integers, Integers, Array]:
        """Rows and columns of the second derivatives, of the lower triangle, some in several parts; their factors."""
        (rows, columns), given = self.rod.hessian_places, np.flatnonzero(self.rod.known)
        return np.append(rows, given), np.append(columns, given), self.unit[rows] * self.unit[columns]

    def whole(self, z: Array) -> Array:
        """The unknowns (size,) of the rod."""
        return self.base + self.unit * z

    def energy(self, z: Array) -> float:
        return self.rod.energy(self.whole(z)) / self.sizes.energy

    def gradient(self, z: Array) -> Array:
        return self.rod.gradient(self.whole(z)) * self.unit / self.sizes.energy

    def conditions(self, z: Array) -> Array:
        return self.rod.conditions(self.whole(z)) / self.unit_of

    def jacobian(self, z: Array) -> Array:
        return self.rod.jacobian_values(self.whole(z)) * self.slopes[2]

    def hessian(self, z: Array, share: float, multipliers: Array) -> Array:
        values = self.rod.hessian_values(self.whole(z), share / self.sizes.energy, multipliers / self.unit_of)
        return np.append(values * self.bends[2], np.ones(self.rod.known.sum()))

    def endless_turn(self, z: Array) -> str:
        """The angle of an end that has turned farther than the rod is long, which the wall cannot make it; else ""."""
        turned = np.abs(self.rod.parts(self.unit * z)[2])
        turned[7] *= not self.rod.free[4]  # a rotation follows a free azimuth
        return ANGLES[turned.argmax()] if turned.max() > self.rod.span + 2 * np.pi else ""

    def minimise(self, effort: Effort) -> tuple[Array, Array, int] | None:
        """The multipliers of the minimum near the guess, the minimum, and the steps; None where Uno finds none.

        Raises `InputError` where Uno is not installed.
        """
        try:
            import unopy
        except ImportError:
            raise InputError(
                "contact='unilateral' needs the package unopy: pip install 'rod-workbench[contact]'"
            ) from None

        def into(compute: Any) -> Any:
            """A function that writes its last argument."""
            return lambda *arguments: np.copyto(arguments[-1], compute(*arguments[:-1]))

        low, high = (bound / self.unit_of for bound in self.rod.bounds)
        (rows, columns, _), (above, beside, _) = self.slopes, self.bends
        model = unopy.Model(unopy.PROBLEM_NONLINEAR, self.rod.size, unopy.ZERO_BASED_INDEXING)
        model.set_objective(unopy.MINIMIZE, self.energy, into(self.gradient))
        model.set_constraints(low.size, into(self.conditions), low, high, rows.size, rows, columns, into(self.jacobian))
        model.set_lagrangian_hessian(above.size, unopy.LOWER_TRIANGLE, above, beside, into(self.hessian))
        model.set_initial_primal_iterate(np.zeros(self.rod.size))
        cost = self.rod.edges + EACH_STEP
        # where the first way to accept steps jams, as between clamps near a straight rod, the other often does not
        for strategy in ("waechter_filter_method", "funnel_method"):
            most = int(min(MOST, effort.left // cost))
            if most < 1:
                effort.why = effort.why or CUT
                break
            solver = unopy.UnoSolver()
            solver.set_termination_callback(lambda z, *_: bool(self.endless_turn(z[: self.rod.size])))
            solver.set_preset("ipopt")
            for name, value in {**OPTIONS, "max_iterations": most, "globalization_strategy": strategy}.items():
                solver.set_option(name, value)
            result = solver.optimize(model)
            effort.left -= cost * result.number_iterations
            z = np.array(result.primal_solution)
            left = result.solution_primal_feasibility, result.solution_stationarity, result.solution_complementarity
            if angle := self.endless_turn(z):
                effort.why = f", as {angle} turns without end: hold it, or lower the load that turns it"
                break
            if max(left) < ENOUGH:
                return np.array(result.constraint_dual_solution), z, int(result.number_iterations)
            if MOST > most <= result.number_iterations:
                effort.why = effort.why or CUT
        return None
