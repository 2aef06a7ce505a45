"""The numbers along a rod with weight or friction: at its ends, in its middle, and the largest."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from solver.numerics.roots import largest_between
from solver.problem.dimensionless import flat

from .unit_habits import CURVATURES, dogleg_unit, plain, size_shown, unit_shown
from .unit_habits import size as size_of

if TYPE_CHECKING:
    from solver import Case, Solution

# rows of a profile
FORCE, PUSH, DOGLEG = "axial force FZ", "push of the wall", "dogleg"
STRESSES = ("axial stress", "bending stress", "both stresses together")
ROUNDING = 1e-12  # relative
LEVEL = 1e-4  # relative: a smaller change along a rod shows in none of four digits
GAUSS = 8  # places between two nodes, for a mean


class ProfileRow(NamedTuple):
    """A quantity along a rod: at s = 0, its mean over the middle third, its largest size and where, and at s = L.

    at: NaN where it is as large everywhere. inside: its largest size at least a wave away from both ends.
    """

    name: str
    unit: str
    start: float
    middle: float
    largest: float
    at: float
    far: float
    inside: float


def axial_force(along: Any) -> Any:
    """FZ at the stations, (n,) [force], of a solution or of arrays along a rod, which have beta, F2 and F3."""
    return np.asarray(along.F2 * np.sin(along.beta) + along.F3 * np.cos(along.beta))


def profile(sol: "Solution", units: dict[str, str]) -> list[ProfileRow]:
    """Forces, curvature and stresses along a rod with weight or friction; none of another one, or where unsolved."""
    if not (sol.case.varies and sol.solved):
        return []
    rho, free = float(sol.case.rho), sol.trajectory.free
    shape = sol.trajectory.shapes.of(0) if free is None else free.answers[0].shapes[-1]
    t, nodes = (shape.dense[0], shape.t) if free is None else (shape.nodes, shape.nodes)

    def read(t: Any) -> Any:
        return np.stack([values for *_, values in quantities(sol.case, _at_times(sol, t), units)])

    def sizes(t: Any) -> Any:
        return np.abs(read(t))

    wave = wave_length(sol.case, max(abs(number(sol, name)) for name in ("FZ0", "FZ"))) / rho
    largest, at = largest_between(sizes, t)
    away = np.concatenate([[wave], t[(t > wave) & (t < t[-1] - wave)], [t[-1] - wave]])
    inside, _ = largest_between(sizes, away)
    order = np.argsort(at)
    peaks = np.empty((at.size, at.size))
    peaks[:, order] = read(at[order])
    start, far = read(t[[0, -1]]).T
    at = np.where(is_level(np.concatenate([read(t), peaks], axis=1)), np.nan, at * rho)
    numbers = np.stack([start, _means(read, nodes), peaks.diagonal(), at, far, inside], axis=1)
    numbers[np.abs(numbers) < ROUNDING * np.maximum(largest, 1e-300)[:, None]] = 0.0
    heads = [(name, unit) for name, unit, _ in quantities(sol.case, _at_times(sol, t[:1]), units)]
    return [ProfileRow(*head, *row) for head, row in zip(heads, numbers.tolist(), strict=True)]


def is_level(values: Any) -> Any:
    """Whether numbers along a rod (..., n) are the same all along in four digits, so that none is the largest."""
    return np.ptp(values, axis=-1) <= LEVEL * np.abs(values).max(axis=-1)


def place_in_words(at: float, unit: str = "") -> str:
    """Where a quantity is largest: ``at s = 53.71 m``; ``everywhere`` for NaN."""
    return "everywhere" if math.isnan(at) else f"at s = {plain(at)} {unit}".rstrip()


def _means(read: Any, nodes: Any) -> Any:
    """The means over the middle third of numbers along a rod, (rows,), by Gauss's rule between its nodes."""
    low, high = nodes[-1] / 3, 2 * nodes[-1] / 3
    ends = np.concatenate([[low], nodes[(nodes > low) & (nodes < high)], [high]])
    x, w = np.polynomial.legendre.leggauss(GAUSS)
    width = np.diff(ends)[:, None] / 2
    places = ends[:-1, None] + width * (1 + x)
    return read(places.reshape(-1)) @ (width * w).reshape(-1) / (high - low)


def quantities(case: "Case", along: Any, units: dict[str, str]) -> list[tuple[str, str, Any]]:
    """The quantities of a profile, their units and their values (n,) each.

    along: has the arrays beta, push, kappa, F2 and F3 of one rod, (n,) each, M3_along too where it turns in place.
    """
    rod, wall, (length, force) = case.rod, case.cylinder, (units["length"], units["force"])
    kappa = np.where(along.kappa * case.rho < ROUNDING, 0.0, along.kappa)
    per_length, dogleg = unit_shown("push_max", units), dogleg_unit(units)
    push = along.push * size_shown("push_max", units)
    columns = [(FORCE, force, axial_force(along)), (PUSH, per_length, push)]
    if wall.side == "outside":
        columns.insert(1, ("tension F3", force, along.F3))
    if wall.friction:
        columns.append(("friction", per_length, wall.friction * push))
    if wall.turns_in_place:
        columns.append(("torque M3", f"{force} {length}", along.M3_along))
    columns.append((DOGLEG, dogleg, kappa * size_of(dogleg, CURVATURES[0], units)))
    if rod.E is not None:
        unit, size = unit_shown("bending_stress_max", units), size_shown("bending_stress_max", units)
        axial = along.F3 / (math.pi * (rod.a**2 - (rod.inner_radius or 0) ** 2)) * size
        bending = rod.E * rod.a * kappa * size
        stresses = axial, bending, np.abs(axial) + bending
        columns += [(name, unit, values) for name, values in zip(STRESSES, stresses, strict=True)]
    return columns


def wave_length(case: "Case", most: float) -> float:
    """The length of a wave of a buckled pipe under its largest axial force, at most a third of the rod [length]."""
    stiffness, across = float(case.rod.bending_stiffness), weight_across(case)
    waves = most / (2 * stiffness), math.sqrt(across / (stiffness * float(case.rho)))
    return min(2 * math.pi / math.sqrt(max(*waves, 1e-300)), float(case.rod.L) / 3)


def number(sol: "Solution", name: str) -> float:
    from solver import observe

    return float(observe(sol, [name])[name])


def weight_across(case: "Case") -> float:
    """The weight per length across the cylinder's axis; 0 for a rod outside."""
    wall, weight = case.cylinder, float(case.rod.weight or 0)
    across = weight * math.sin(float(wall.inclination or 0))
    return across if across > ROUNDING * weight and wall.side == "inside" else 0.0


def _at_times(sol: "Solution", t: Any) -> "Solution":
    """One rod at rising times t (n,)."""
    if (free := sol.trajectory.free) is not None:
        from solver.free.free_rods import trajectory_of

        return replace(sol, t=t[None], trajectory=trajectory_of(sol.case, free.answers, t[None], float(sol.tol))[1])
    read = sol.trajectory.shapes.read(t[None], flat(sol.case.given.alpha, ()))
    return replace(sol, t=t[None], trajectory=replace(sol.trajectory, **read))
