"""The exact equilibrium of a scenario of cosseratbench, and a solver of cosseratbench that returns it."""

from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from cosseratbench.scenario import Scenario
from cosseratbench.solver import Capability
from cosseratbench.trajectory import Trajectory
from scipy.interpolate import CubicHermiteSpline

from solver import InputError, Solution, solve
from solver.mechanics import frames
from solver.numerics.arrays import Array

from .ends import Axes, axes, beginning, case_of, one_of_each

STATIONS = 1001  # of a solution; between them cubics with the exact slopes


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """The exact shape, the frame of its cylinder, and azimuth and height where it begins there."""

    solution: Solution
    frame: Axes
    alpha0: float
    z0: float

    def _curve(self, s: Array) -> tuple[Array, Array]:
        sol, rho = self.solution, self.solution.case.rho
        alpha = CubicHermiteSpline(sol.s, sol.alpha - sol.alpha[0], np.sin(sol.beta) / rho)(s)
        z = CubicHermiteSpline(sol.s, sol.z - sol.z[0], np.cos(sol.beta))(s)
        return alpha + self.alpha0, z + self.z0

    def beta(self, s: Array) -> Array:
        """The angle from the axis at arc lengths s (n,), (n,) [rad]."""
        return np.asarray(CubicHermiteSpline(self.solution.s, self.solution.beta, self.solution.dbeta)(s))

    def points(self, s: Array) -> Array:
        """The places of the centreline at arc lengths s (n,) in the world, (n, 3) [m]."""
        return self.frame.outward(frames.position(self.solution.case.rho, *self._curve(s)))

    def directors(self, s: Array, normal: Array) -> Array:
        """The material direction at arc lengths s (n,) that is `normal` (3,) at the start, (n, 3) unit vectors."""
        alpha, beta = self._curve(s)[0], self.beta(s)
        first = frames.material(np.array(self.alpha0), self.solution.beta[0], np.array(0.0))
        began = first @ self.frame.rows @ normal
        sol, case = self.solution, self.solution.case
        rate = sol.M3 / case.rod.torsional_stiffness - np.sin(2 * sol.beta) / (2 * case.rho)
        gamma = CubicHermiteSpline(sol.s, sol.gamma - sol.gamma[0], rate)(s)
        d1 = frames.material(alpha, beta, gamma + np.arctan2(began[1], began[0]))[:, 0]
        return np.asarray(d1 @ self.frame.rows)


@lru_cache(maxsize=64)
def equilibrium(scenario: Scenario) -> Equilibrium:
    """The exact shape in which a scenario comes to rest.

    Parameters
    ----------
    scenario : cosseratbench.scenario.Scenario
        One rod outside one frictionless cylinder, without gravity, its ends clamped. The far end may be carried along
        and about the axis, and may slide along the axis under a load.

    Returns
    -------
    Equilibrium

    Raises
    ------
    NotImplementedError
        The scenario is of another kind, or its equilibrium was not found, is not stable, or leaves the cylinder.
    """
    rod, cylinder = one_of_each(scenario)
    try:
        solution = solve(case_of(rod, cylinder), stations=STATIONS)
    except InputError as error:
        raise NotImplementedError(str(error)) from None
    if not solution.solved:
        raise NotImplementedError(f"no equilibrium on the cylinder was found: {solution.outcome}")
    if solution.held_index != 0:
        raise NotImplementedError(f"the equilibrium on the cylinder is not stable: index {solution.held_index:g}")
    if solution.push.min() < 0:
        raise NotImplementedError("the equilibrium leaves the cylinder: the cylinder would have to pull")
    began = beginning(rod, cylinder)
    return Equilibrium(solution, axes(cylinder), float(began.alpha[0]), float(began.z[0]))


class RodOnCylinder:
    """The solver `rod-on-cylinder` of cosseratbench: the exact equilibrium of a rod on a cylinder.

    It has no dynamics. The first frame is the beginning of the scenario, each later frame the equilibrium of its end.
    The rod neither stretches nor shears.
    """

    name = "rod-on-cylinder"
    capabilities: ClassVar[frozenset[Capability]] = frozenset({Capability.CYLINDER_CONTACT})

    def run(self, scenario: Scenario, *, n_elements: int, n_frames: int) -> Trajectory:
        """The nodes and directors of `n_elements` equal elements in `n_frames` frames.

        Raises `NotImplementedError` for a scenario that `equilibrium` refuses.
        """
        exact, rod = equilibrium(scenario), scenario.rods[0]
        nodes = np.linspace(0.0, rod.length, n_elements + 1)
        began = rod.directors(n_elements)
        middles = (nodes[1:] + nodes[:-1]) / 2
        normal = np.asarray(rod.normal, dtype=float)
        places, turned = exact.points(nodes), exact.directors(middles, normal)
        return Trajectory(
            np.linspace(0.0, scenario.duration, n_frames),
            (np.stack([rod.nodes(n_elements), *[places] * (n_frames - 1)]),),
            (np.stack([began, *[turned] * (n_frames - 1)]),),
        )
