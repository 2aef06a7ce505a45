"""Numbers along a rod with weight or friction: at its ends, in its middle, and the largest."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from solver.problem.reduced import flat
from solver.shooting.loaded_rod import MU
from solver.shooting.varying_shapes import read_states

if TYPE_CHECKING:
    from solver import Case, Solution

REACHES = {"m": 30.0, "ft": 100.0}  # lengths on which drillers state a dogleg
MEGAPASCALS = {"N": 1e-6, "kN": 1e-3, "MN": 1.0}  # per m^2
ROUNDING = 1e-12  # relative


class Row(NamedTuple):
    """A quantity along a rod: at s = 0, its mean over the middle third, its largest size and where, and at s = L.

    inside: its largest size at least a wave away from both ends.
    """

    name: str
    unit: str
    start: float
    middle: float
    largest: float
    at: float
    far: float
    inside: float


def lower_end(sol: "Solution") -> str:
    """That ``s = 0`` or ``s = L`` is the lower end, in a sentence."""
    rise = math.cos(float(sol.case.cylinder.inclination or 0)) * bool(sol.case.rod.weight)
    if abs(rise) < ROUNDING:
        return "neither end is lower"
    low, high = ("s = 0", "s = L")[:: 1 if rise > 0 else -1]
    return f"{low} is the lower end, {high} the upper one"


def axial_force(sol: "Solution") -> Any:
    """FZ at the stations, (n,) [force]."""
    return np.asarray(sol.F2 * np.sin(sol.beta) + sol.F3 * np.cos(sol.beta))


def profile(sol: "Solution", units: dict[str, str]) -> list[Row]:
    """Forces, curvature and stresses along a rod with weight or friction; none of another one, or where unsolved."""
    if not (sol.case.varies and sol.solved):
        return []
    rod, wall, (length, force) = sol.case.rod, sol.case.cylinder, (units["length"], units["force"])
    fine = _at_dense_stations(sol)
    kappa = np.where(fine.kappa * sol.case.rho < ROUNDING, 0.0, fine.kappa)
    per_length, reach = f"{force}/{length}", REACHES.get(length, 1.0)
    columns = [("axial force FZ", force, axial_force(fine)), ("push of the wall", per_length, fine.push)]
    if wall.friction:
        columns.append(("friction", per_length, wall.friction * fine.push))
    columns.append(("dogleg of the pipe", f"deg/{reach:g} {length}", np.degrees(kappa) * reach))
    if rod.E is not None:
        unit, size = stress_unit(units)
        axial = fine.F3 / (math.pi * (rod.a**2 - (rod.inner_radius or 0) ** 2)) * size
        bending = rod.E * rod.a * kappa * size
        stresses = axial, bending, np.abs(axial) + bending
        names = "axial stress", "bending stress", "both stresses together"
        columns += [(name, unit, values) for name, values in zip(names, stresses, strict=True)]
    wave = _wave(sol)
    return [_row(*column, fine.s, wave) for column in columns]


def _wave(sol: "Solution") -> float:
    """The length of a wave of a buckled pipe under its largest axial force, at most a third of the rod [length]."""
    stiffness, across = float(sol.case.rod.bending_stiffness), weight_across(sol.case)
    most = max(abs(number(sol, name)) for name in ("FZ0", "FZ"))
    waves = most / (2 * stiffness), math.sqrt(across / (stiffness * float(sol.case.rho)))
    return min(2 * math.pi / math.sqrt(max(*waves, 1e-300)), float(sol.case.rod.L) / 3)


def number(sol: "Solution", name: str) -> float:
    from solver import observe

    return float(observe(sol, [name])[name])


def weight_across(case: "Case") -> float:
    """The weight per length across the cylinder's axis; 0 for a rod outside."""
    wall, weight = case.cylinder, float(case.rod.weight or 0)
    across = weight * math.sin(float(wall.inclination or 0))
    return across if across > ROUNDING * weight and wall.side == "inside" else 0.0


def stress_unit(units: dict[str, str]) -> tuple[str, float]:
    """The unit in which a stress is stated, and how many of it one of the case's units is."""
    length, force = units["length"], units["force"]
    return ("MPa", MEGAPASCALS[force]) if length == "m" and force in MEGAPASCALS else (f"{force}/{length}^2", 1.0)


def _at_dense_stations(sol: "Solution") -> "Solution":
    """One rod at stations so dense that they show each of its bends."""
    nodes = sol.trajectory.shapes.of(0)
    t, y = nodes.dense
    read = read_states(y[None], t[None], flat(sol.case.given.alpha, ()), nodes.numbers[:1] * y[-1:, MU])
    return replace(sol, t=t[None], trajectory=replace(sol.trajectory, **read))


def _row(name: str, unit: str, values: Any, s: Any, wave: float) -> Row:
    values = np.where(np.abs(values) < ROUNDING * np.abs(values).max(), 0.0, values)
    inner = np.linspace(s[-1] / 3, 2 * s[-1] / 3, s.size)
    most = int(np.argmax(np.abs(values) > (1 - 1e-9) * np.abs(values).max()))
    middle = np.interp(inner, s, values).mean()
    inside = np.abs(values[(s >= wave) & (s <= s[-1] - wave)]).max()
    return Row(name, unit, *(float(x) for x in (values[0], middle, values[most], s[most], values[-1], inside)))
