"""PyElastica and MuJoCo against the exact shape of a rod on a cylinder, run by cosseratbench (the extra `bench`).

    python -m benchmarks.cosserat [pyelastica] [mujoco] [ELEMENTS ...]

The rod begins in an exact equilibrium: clamped at both ends at `ANGLE` from the axis, pulled along it. Its far end is
carried round the axis by 30 degrees, and either slides along the axis under a dead load or is carried to a height. In
both the exact rod is stable and presses on the cylinder everywhere, so contact that only pushes has the same shape.
"""

import sys
import time
from functools import cache
from typing import Any

import numpy as np
from cosseratbench.experiment import Experiment, run
from cosseratbench.metrics import settling_residual
from cosseratbench.scenario import Cylinder, EndCondition, Material, Motion, PointLoad, Rod, Scenario
from cosseratbench.solver import Capability
from cosseratbench.trajectory import Trajectory
from scipy.interpolate import CubicHermiteSpline

import solver
from solver.numerics.arrays import Array

LENGTH, RADIUS, CYLINDER = 0.2, 0.0015, 0.0485  # [m]; the centreline is at 0.05 from the axis
RHO = CYLINDER + RADIUS
MATERIAL = Material(youngs_modulus=1e7, shear_modulus=1e7 / 3, density=1000.0)
ANGLE, TURN = np.pi / 6, np.pi / 6
STIFFNESS = MATERIAL.youngs_modulus * np.pi * RADIUS**4 / 4  # A [N m^2]
UNIT = STIFFNESS / RHO**2  # A/rho^2 [N]
POINTS = 1601  # of the centreline at the beginning
DURATION = 1.0  # [s]; the end moves during the first half
STEPS = 200  # straight pieces of the motion
# The rod begins a little outside, so that chords of 5 mm do not cut into the cylinder; at its ends it is in its place.
LIFT, RISE = 4e-5, 0.025  # [m]; reached at this arc length from each end
ENDS = {"under a dead load": {"FZ": 2 * UNIT}, "both ends held": {"height": 0.632 * LENGTH}}


@cache
def first_equilibrium() -> solver.Solution:
    """The equilibrium at the beginning: pulled with 2 A/rho^2, and carried round by a moment of 2.45 A/rho."""
    rod = solver.Rod(a=RADIUS, L=LENGTH, EI=STIFFNESS, GJ=STIFFNESS * 2 / 3)
    ends = solver.Ends(beta0=ANGLE, betaL=ANGLE, FZ=2 * UNIT, MZ=2.45 * UNIT * RHO)
    return solver.solve(solver.Case(rod, solver.Cylinder(R=CYLINDER), ends), stations=POINTS)


@cache
def last_equilibrium(name: str) -> solver.Solution:
    """The exact equilibrium at the end of one of `ENDS`. Raises `ValueError` if no rod could rest there."""
    first = first_equilibrium()
    azimuth, rotation = first.alpha[-1] - first.alpha[0] + TURN, first.gamma[-1] - first.gamma[0]
    ends = solver.Ends(beta0=ANGLE, betaL=ANGLE, azimuth=azimuth, rotation=rotation, **ENDS[name])
    last = solver.solve(solver.Case(first.case.rod, first.case.cylinder, ends), seed=first, stations=POINTS)
    if not last.solved or last.held_index != 0 or last.push.min() < 0:
        raise ValueError(f"{name}: {last.outcome}, index {last.held_index:g}, least push {last.push.min():g}")
    return last


def points(name: str, count: int) -> Array:
    """The exact places of `count` equally spaced points of the centreline, (count, 3) [m]."""
    last, s = last_equilibrium(name), np.linspace(0.0, LENGTH, count)
    alpha = CubicHermiteSpline(last.s, last.alpha - last.alpha[0], np.sin(last.beta) / RHO)(s)
    alpha += first_equilibrium().alpha[0]
    z = CubicHermiteSpline(last.s, last.z - last.z[0] + first_equilibrium().z[0], np.cos(last.beta))(s)
    return np.stack([RHO * np.cos(alpha), RHO * np.sin(alpha), z], axis=-1)


def scenario(name: str) -> Scenario:
    """What the other programs are given: the first equilibrium, and the motion of its far end."""
    first, height = first_equilibrium(), ENDS[name].get("height")
    share = (1 - np.cos(np.pi * np.linspace(0, 1, STEPS + 1))) / 2
    last = float(first.alpha[-1])
    angle = last + TURN * share
    rise = share * (0.0 if height is None else height - float(first.z[-1] - first.z[0]))
    path = np.stack([RHO * (np.cos(angle) - np.cos(last)), RHO * (np.sin(angle) - np.sin(last)), rise], axis=-1)
    path[0] = 0.0
    motion = Motion(
        times=tuple(np.linspace(0.0, DURATION / 2, STEPS + 1).tolist()), displacement=_vectors(path),
        rotation=_vectors(np.outer(TURN * share, [0.0, 0.0, 1.0])),
        slides_along=(0.0, 0.0, 1.0) if height is None else None,
    )  # fmt: skip
    to_end = np.minimum(first.s, LENGTH - first.s)
    lifted = LIFT * (1 - np.cos(np.pi * np.minimum(to_end / RISE, 1.0))) / 2
    rod = Rod(
        centerline=_vectors(first.position - lifted[:, None] * first.normal), rest_arc_length=tuple(first.s.tolist()),
        radius=RADIUS, material=MATERIAL, normal=tuple(float(x) for x in -first.normal[0]),
        start=EndCondition.CLAMPED, end=EndCondition.CLAMPED,
        loads=(PointLoad(force=(0.0, 0.0, ENDS[name]["FZ"])),) if height is None else (), end_motion=motion,
    )  # fmt: skip
    wall = Cylinder(center=(0.0, 0.0, LENGTH / 2), axis=(0.0, 0.0, 1.0), radius=CYLINDER, length=3 * LENGTH)
    return Scenario(rods=(rod,), obstacles=(wall,), duration=DURATION, quasi_static=True, self_contact=False)


def _vectors(rows: Array) -> tuple[Any, ...]:
    return tuple(tuple(row) for row in rows.tolist())


def shape_error(name: str, nodes: Array) -> float:
    """The greatest distance of a node (n, 3) from the exact place of its material point, over the length of the rod."""
    return float(np.linalg.norm(nodes - points(name, len(nodes)), axis=1).max() / LENGTH)


def angle_error(name: str, nodes: Array) -> float:
    """The greatest error of the angle of an element from the axis [rad], against the chord of the exact shape."""
    steps = [np.diff(line, axis=0) for line in (nodes, points(name, len(nodes)))]
    angles = [np.arccos(step[:, 2] / np.linalg.norm(step, axis=1)) for step in steps]
    return float(np.abs(angles[0] - angles[1]).max())


def experiment(name: str, elements: int) -> Experiment:
    """One of `ENDS` as an experiment of cosseratbench."""

    def of_shape(measure: Any) -> Any:
        def metric(scenario: Scenario, trajectory: Trajectory) -> float:
            return float(measure(name, trajectory.positions[0][-1]))

        return metric

    metrics = {"shape": of_shape(shape_error), "angle": of_shape(angle_error), "settling": settling_residual}
    return Experiment(
        name=name, description=name, build=lambda: scenario(name), metrics=metrics, n_elements=elements, n_frames=41,
        requires=frozenset({Capability.CYLINDER_CONTACT}),
    )  # fmt: skip


def program(name: str) -> Any:
    """The adapter of cosseratbench for `pyelastica` or `mujoco`."""
    if name == "pyelastica":
        from cosseratbench.solvers.pyelastica import PyElasticaSolver

        return PyElasticaSolver()
    from cosseratbench.solvers.mujoco import MuJoCoSolver

    return MuJoCoSolver()


def main(words: list[str]) -> None:
    """Print a row for each end, program and number of elements: its errors, and its seconds."""
    programs = [word for word in words if not word.isdigit()] or ["pyelastica", "mujoco"]
    print("ends, program, elements: shape error [L], angle error [rad], settling [L/s], seconds")
    for name in ENDS:
        for label in programs:
            for elements in [int(word) for word in words if word.isdigit()] or [20, 40]:
                began = time.perf_counter()
                result = run(experiment(name, elements), program(label))
                numbers = ", ".join(f"{value:.1e}" for value in result.metrics.values())
                print(f"{name}, {label}, {elements}: {numbers or result.outcome}, {time.perf_counter() - began:.0f}")


if __name__ == "__main__":
    main(sys.argv[1:])
