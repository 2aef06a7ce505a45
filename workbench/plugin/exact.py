"""The exact equilibrium of a scenario of cosseratbench, and a solver of cosseratbench that returns it.

What a scenario says about the ends of its rod is read in the frame of its cylinder.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, ClassVar

import numpy as np
from cosseratbench.scenario import Scenario
from cosseratbench.solver import Capability
from cosseratbench.trajectory import Trajectory
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from solver import Case, Cylinder, Ends, InputError, Rod, Solution, solve
from solver.numerics.arrays import Array
from solver.orbits import frames

STATIONS = 1001  # of a solution; between them cubics with the exact slopes
NEAR = 1e-3  # of rho: how far the rod may begin from the surface
ALONG = 1e-9  # how exactly directions are along the axis


@dataclass(frozen=True, eq=False)
class Axes:
    """The frame of a cylinder: its centre (3,), and as rows two directions across the axis and the axis, (3, 3)."""

    centre: Array
    rows: Array

    def inward(self, points: Array) -> Array:
        """Points of the world in this frame, (..., 3)."""
        return np.asarray((points - self.centre) @ self.rows.T)

    def outward(self, points: Array) -> Array:
        """Points of this frame in the world, (..., 3)."""
        return np.asarray(points @ self.rows + self.centre)


def axes(cylinder: Any) -> Axes:
    """The frame of a cylinder of cosseratbench."""
    axis = np.asarray(cylinder.unit_axis, dtype=float)
    across = np.eye(3)[np.argmin(np.abs(axis))]
    across -= (across @ axis) * axis
    across /= np.linalg.norm(across)
    return Axes(np.asarray(cylinder.center, dtype=float), np.stack([across, np.cross(axis, across), axis]))


@dataclass(frozen=True, eq=False)
class Beginning:
    """How the rod begins: azimuth and height (n,) at arc lengths s (n,), and the angles from the axis at its ends."""

    s: Array
    alpha: Array
    z: Array
    rho: float

    @cached_property
    def beta(self) -> Array:
        """The angle from the axis, (n,) [rad], of cubic splines through the points."""
        across, along = (CubicSpline(self.s, values)(self.s, 1) for values in (self.rho * self.alpha, self.z))
        return np.asarray(np.arctan2(across, along))

    @property
    def untwisted(self) -> float:
        """The rotation of the section from start to end without twist: minus the integral of alpha' cos(beta)."""
        turning = np.sin(2 * self.beta) / (2 * self.rho)
        return -float(CubicSpline(self.s, turning).integrate(self.s[0], self.s[-1]))


def beginning(rod: Any, cylinder: Any) -> Beginning:
    """How the rod begins, in the frame of the cylinder. Raises `NotImplementedError` where it is not on the surface."""
    x, y, z = axes(cylinder).inward(np.asarray(rod.centerline, dtype=float)).T
    rho = cylinder.radius + rod.radius
    if np.abs(np.hypot(x, y) - rho).max() > NEAR * rho:
        raise NotImplementedError("the rod must begin on the outside of the cylinder")
    if len(x) < 3:
        raise NotImplementedError("the rod must begin as a curve of three points or more")
    if rod.rest_arc_length is None:
        steps = np.linalg.norm(np.diff(np.asarray(rod.centerline, dtype=float), axis=0), axis=1)
        s = np.concatenate([[0.0], np.cumsum(steps)])
    else:
        s = np.asarray(rod.rest_arc_length, dtype=float)
    return Beginning(s, np.unwrap(np.arctan2(y, x)), z, rho)


def one_of_each(scenario: Any) -> tuple[Any, Any]:
    """The rod and the cylinder of a scenario. Raises `NotImplementedError` where it has others, or other loads."""
    rods, obstacles = scenario.rods, scenario.obstacles
    if len(rods) != 1 or len(obstacles) != 1 or obstacles[0].kind != "cylinder":
        raise NotImplementedError("exact for one rod on one cylinder only")
    rod, cylinder = rods[0], obstacles[0]
    for wrong, reason in (
        (not scenario.quasi_static, "an equilibrium only: the scenario must be quasi-static"),
        (any(scenario.gravity), "exact without gravity only"),
        (max(cylinder.friction, rod.friction) > 0, "exact without friction only"),
        ({rod.start.value, rod.end.value} != {"clamped"}, "exact for clamped ends only"),
        (rod.start_motion is not None, "exact for a start that is held still only"),
    ):
        if wrong:
            raise NotImplementedError(reason)
    return rod, cylinder


def case_of(rod: Any, cylinder: Any) -> Case:
    """The case whose equilibrium the scenario comes to. Raises `NotImplementedError` for a motion that is not axial."""
    began, frame = beginning(rod, cylinder), axes(cylinder)
    beta = began.beta
    moved, turned, slides = _move(rod.end_motion, frame)
    x, y, z = frame.inward(np.asarray(rod.centerline[-1])) + moved
    if abs(np.hypot(x, y) - began.rho) > NEAR * began.rho:
        raise NotImplementedError("the moved end must end on the outside of the cylinder")
    azimuth = float(began.alpha[-1] - began.alpha[0]) + turned
    if abs(np.sin(np.arctan2(y, x) - began.alpha[-1] - turned)) > NEAR:
        raise NotImplementedError("the end must be turned about the axis by the angle through which it is carried")
    force = frame.rows @ np.sum([load.force for load in rod.loads] or [np.zeros(3)], axis=0)
    if any(load.at.value != "end" for load in rod.loads) or (rod.loads and not slides):
        raise NotImplementedError("a load must act at a far end that slides along the axis")
    if np.hypot(force[0], force[1]) > ALONG * max(abs(force[2]), 1e-300):
        raise NotImplementedError("a load must be along the axis")
    material = rod.material
    elastic_rod = Rod(
        a=rod.radius, L=rod.length, EI=material.youngs_modulus * rod.second_moment_of_area,
        GJ=2 * material.shear_modulus * rod.second_moment_of_area,
    )  # fmt: skip
    axial = {"FZ": float(force[2])} if slides else {"height": float(z - began.z[0])}
    ends = Ends(
        beta0=float(beta[0]), betaL=float(beta[-1]), azimuth=azimuth, rotation=began.untwisted, **axial
    )  # fmt: skip
    return Case(elastic_rod, Cylinder(R=cylinder.radius, side="outside"), ends)


def _move(motion: Any, frame: Axes) -> tuple[Array, float, bool]:
    """Where a motion ends: its displacement (3,) in the frame, its turn about the axis [rad], whether it slides."""
    if motion is None:
        return np.zeros(3), 0.0, False
    turn = frame.rows @ np.asarray(motion.rotation[-1], dtype=float)
    slides = motion.slides_along is not None
    if np.hypot(turn[0], turn[1]) > ALONG or (slides and abs(abs(motion.axis @ frame.rows[2]) - 1) > ALONG):
        raise NotImplementedError("the end must be turned about the axis of the cylinder, and slide along it")
    return frame.rows @ np.asarray(motion.displacement[-1], dtype=float), float(turn[2]), slides


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
