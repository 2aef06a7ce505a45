"""Two experiments of cosseratbench whose end is known exactly: a rod outside a cylinder, its far end carried round it.

The rod begins in an exact equilibrium: clamped at both ends at `ANGLE` from the axis, pulled along the axis. Its far
end is carried round the axis, and either slides along the axis under a load or is carried to a given height.
"""

from functools import cache
from typing import Any

import numpy as np
from cosseratbench.experiment import Experiment, Parameter
from cosseratbench.metrics import settling_residual
from cosseratbench.scenario import Cylinder, EndCondition, Material, Motion, PointLoad, Rod, Scenario
from cosseratbench.solver import Capability
from cosseratbench.trajectory import Trajectory

import solver
from solver.numerics.arrays import Array

from .exact import axes, equilibrium

LENGTH, RADIUS, CYLINDER = 0.2, 0.0015, 0.0485  # [m]; the centreline is at 0.05 from the axis
MATERIAL = Material(youngs_modulus=1e7, shear_modulus=1e7 / 3, density=1000.0)
ANGLE = np.pi / 6
STIFFNESS = MATERIAL.youngs_modulus * np.pi * RADIUS**4 / 4  # A [N m^2]
UNIT = STIFFNESS / (CYLINDER + RADIUS) ** 2  # A/rho^2 [N]
POINTS = 1601  # of the centreline at the beginning
DURATION = 1.0  # [s]; the end moves during the first half
STEPS = 200  # straight pieces of the motion
# The rod begins a little outside, so that chords of 5 mm do not cut into the cylinder; at its ends it is in its place.
LIFT, RISE = 4e-5, 0.025  # [m]; reached at this arc length from each end


@cache
def first_equilibrium() -> solver.Solution:
    """The equilibrium at the beginning: pulled with 2 A/rho^2, and carried round by a moment of 2.45 A/rho."""
    rod = solver.Rod(a=RADIUS, L=LENGTH, EI=STIFFNESS, GJ=STIFFNESS * 2 / 3)
    ends = solver.Ends(beta0=ANGLE, betaL=ANGLE, FZ=2 * UNIT, MZ=2.45 * UNIT * (CYLINDER + RADIUS))
    return solver.solve(solver.Case(rod, solver.Cylinder(R=CYLINDER), ends), stations=POINTS)


def carry(turn: float, load: float | None, height: float = 0.0) -> Scenario:
    """The scenario: the far end is carried round by `turn` [rad], and to a height [m] or under an axial load [N]."""
    first = first_equilibrium()
    time = np.linspace(0.0, DURATION / 2, STEPS + 1)
    share = (1 - np.cos(np.pi * np.linspace(0, 1, STEPS + 1))) / 2
    rho, last = CYLINDER + RADIUS, float(first.alpha[-1])
    angle = last + turn * share
    rise = share * (0.0 if load is not None else height - float(first.z[-1] - first.z[0]))
    path = np.stack([rho * (np.cos(angle) - np.cos(last)), rho * (np.sin(angle) - np.sin(last)), rise], axis=-1)
    path[0] = 0.0
    motion = Motion(
        times=tuple(time.tolist()), displacement=_vectors(path),
        rotation=_vectors(np.outer(turn * share, [0.0, 0.0, 1.0])),
        slides_along=None if load is None else (0.0, 0.0, 1.0),
    )  # fmt: skip
    to_end = np.minimum(first.s, LENGTH - first.s)
    lifted = LIFT * (1 - np.cos(np.pi * np.minimum(to_end / RISE, 1.0))) / 2
    places = first.position - lifted[:, None] * first.normal
    rod = Rod(
        centerline=_vectors(places), rest_arc_length=tuple(first.s.tolist()), radius=RADIUS, material=MATERIAL,
        normal=tuple(float(x) for x in -first.normal[0]), start=EndCondition.CLAMPED, end=EndCondition.CLAMPED,
        loads=() if load is None else (PointLoad(force=(0.0, 0.0, load)),), end_motion=motion,
    )  # fmt: skip
    wall = Cylinder(center=(0.0, 0.0, LENGTH / 2), axis=(0.0, 0.0, 1.0), radius=CYLINDER, length=3 * LENGTH)
    return Scenario(rods=(rod,), obstacles=(wall,), duration=DURATION, quasi_static=True, self_contact=False)


def under_load(turn: float, load: float) -> Scenario:
    """The far end slides along the axis under a dead load of `load` A/rho^2, carried round by `turn` degrees."""
    return carry(np.radians(turn), load * UNIT)


def held(height: float) -> Scenario:
    """The far end is carried round by 30 degrees, and to a height of `height` lengths of the rod."""
    return carry(np.pi / 6, None, height * LENGTH)


def shape_error(scenario: Scenario, trajectory: Trajectory) -> float:
    """The greatest distance of a node from the exact place of its material point, over the length of the rod."""
    nodes, length = trajectory.positions[0][-1], scenario.rods[0].length
    exact = equilibrium(scenario).points(np.linspace(0.0, length, len(nodes)))
    return float(np.linalg.norm(nodes - exact, axis=1).max() / length)


def angle_error(scenario: Scenario, trajectory: Trajectory) -> float:
    """The greatest error of the angle of an element from the axis [rad], against the chord of the exact shape."""
    nodes, length = trajectory.positions[0][-1], scenario.rods[0].length
    exact = equilibrium(scenario).points(np.linspace(0.0, length, len(nodes)))
    axis = scenario.obstacles[0].unit_axis
    along, straight = (np.diff(points, axis=0) for points in (nodes, exact))
    cosines = [steps @ axis / np.linalg.norm(steps, axis=1) for steps in (along, straight)]
    return float(np.abs(np.arccos(cosines[0]) - np.arccos(cosines[1])).max())


def height_error(scenario: Scenario, trajectory: Trajectory) -> float:
    """The error of the height of the far end above the start, over the length of the rod."""
    nodes, length = axes(scenario.obstacles[0]).inward(trajectory.positions[0][-1]), scenario.rods[0].length
    exact = equilibrium(scenario).solution.z
    return float(abs(nodes[-1, 2] - nodes[0, 2] - (exact[-1] - exact[0])) / length)


def reference(scenario: Scenario) -> tuple[Array]:
    """The exact curve, (201, 3) [m]."""
    return (equilibrium(scenario).points(np.linspace(0.0, scenario.rods[0].length, 201)),)


def _vectors(rows: Array) -> tuple[Any, ...]:
    return tuple(tuple(row) for row in rows.tolist())


TURN = Parameter("turn", 30.0, (0.0, 15.0, 30.0), "deg", "How far the far end is carried round the axis.")
COMMON: dict[str, Any] = {
    "requires": frozenset({Capability.CYLINDER_CONTACT}), "n_elements": 40, "n_frames": 41, "reference": reference,
}  # fmt: skip
NOTES = (
    "The reference is the exact equilibrium of an inextensible rod that lies on the cylinder, and it presses on it "
    "everywhere. A solver whose rod stretches comes within its strain of it. Look at max_penetration: the contact of a "
    "solver is a spring."
)
rod_under_load = Experiment(
    name="rod-on-cylinder-load",
    description="Rod outside a cylinder, its far end carried round it under an axial load, against the exact shape.",
    build=under_load,
    metrics={
        "shape_error": shape_error, "angle_error": angle_error, "height_error": height_error,
        "settling_residual": settling_residual,
    },
    parameters=(TURN, Parameter("load", 2.0, (1.0, 2.0, 5.0), "A/rho^2", "Axial load on the far end.")),
    notes=NOTES,
    **COMMON,
)  # fmt: skip
rod_held = Experiment(
    name="rod-on-cylinder-held",
    description="Rod outside a cylinder, both ends held, the far one carried round it, against the exact shape.",
    build=held,
    metrics={"shape_error": shape_error, "angle_error": angle_error, "settling_residual": settling_residual},
    parameters=(Parameter("height", 0.632, (0.63, 0.632, 0.635), "L", "Height at which the far end is held."),),
    notes=NOTES,
    **COMMON,
)
