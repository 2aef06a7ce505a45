"""A rod whose load is changed until it snaps: along its stable branch to a fold, and then down in energy.

At a fold an equilibrium ceases to exist. Between two end angles and under dead loads the energy of a rod on its
cylinder is that of beta alone, and falls fastest by beta_t = beta'' + H(beta), whose rests are the equilibria. So the
rod moves as in a viscous medium that drags on the turning of its sections. It stays on its cylinder; one that is let go
sinks in space (`free.let_go_descent`). This is no dynamics: a real rod is faster, and may come to rest elsewhere.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.integrate import cumulative_simpson
from scipy.linalg import solve_banded

from solver import Case, Solution, equilibria, follow, solve
from solver.equilibria import nearest
from solver.equilibria_result import Equilibrium
from solver.follow import solutions_of
from solver.numerics.roots import Ending, newton
from solver.orbits.potential import dimensional_slope
from solver.problem.declared_fields import FIELDS
from solver.problem.errors import InputError
from studies.grammar.axes import in_words

from ..stored import quantity_variables
from ..stored.case_of_file import case_of_numbers
from ..stored.stored_study import StoredStudy
from .equilibria_dataset import EQUILIBRIUM, of_solutions

STATIONS = 401  # of each shape
VALUES = 121  # of the load along a stable branch
BEYOND = 2e-3  # of the axis: how far the load goes on beyond a fold, so that the rod begins to move
TURN, TURNS = 0.03, 4000  # rad by which a section turns in a step at most; steps
AT_REST = 1e-7  # of the steepness of the energy, times the length squared
AGREES = 0.02  # rad: between a shape at rest on a grid and the equilibrium there
ENDING = Ending(rounds=12, goal=1e-12, small=1e-9, longest=1.0)  # of Newton's rule in a step, in rad
MOST = 6  # snaps of one film
SLOWEST = 4.0  # radii of the wall as which a change of the load over all of the axis counts: a rod at rest is seen too
KEPT = ("title", "reading", "stiffness", "side", "length_unit", "force_unit", "versions")  # attributes

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Moment:
    """A rod at one moment of its way: the load, and beta at the stations (n,)."""

    load: float
    beta: Array


def rod_on(stored: StoredStudy, branch: int, at: int) -> Solution:
    """The rod of a branch at the value of the axis with an index, solved again. Raises `InputError`."""
    name = str(stored.attrs["axis"])
    (k,) = np.flatnonzero(stored["branch"].values[at] == branch)[:1]
    slope, energy = (float(stored[key].values[at, k]) for key in ("dbeta0", "energy"))
    case = case_at(stored, float(stored[name].values[at]))
    return nearest(equilibria(case, stations=STATIONS), slope, energy).solution


def rod_of_shape(stored: StoredStudy, k: int, stations: int) -> Solution:
    """The rod of the k-th shape that a file of branches keeps, solved again. Raises `InputError`, also for another."""
    name, number = str(stored.attrs["axis"]), float(stored[f"shape_{stored.attrs['axis']}"].values[k])
    case, rho = case_at(stored, number), float(stored["shape_rho"].values[k])
    alpha, z = (stored[f"shape_{key}"].values[k] for key in ("alpha", "z"))

    def away(one: Equilibrium) -> float:
        rod = one.solution
        around, along = rod.alpha - rod.alpha[0] - alpha + alpha[0], rod.z - rod.z[0] - z + z[0]
        return float(np.hypot(rho * around, along).max())

    equilibrium = min(equilibria(case, stations=alpha.size), key=away, default=None)
    if equilibrium is None or away(equilibrium) > AGREES * rho:
        raise InputError(f"the rod at {in_words(name, number)} is not found again")
    rod = equilibrium.solution
    return rod if stations == alpha.size else solve(case, seed=rod, stations=stations)


def rods_of_shapes(stored: StoredStudy, shapes: Sequence[int], stations: int) -> tuple[xr.Dataset, dict[int, str]]:
    """The rods of shapes that a file of branches keeps, solved again, as a list of equilibria; and of each shape that
    is not solved again the outcome. Raises `InputError` where none is, and as `rod_of_shape`."""
    rods, units = {k: rod_of_shape(stored, k, stations) for k in shapes}, stored.units
    unsolved = {k: str(rod.outcome) for k, rod in rods.items() if not rod.solved}
    solved = [rod for rod in rods.values() if rod.solved]
    if not solved:
        raise InputError(f"no stable rod of this file is solved again: {'; '.join(unsolved.values())}")
    numbers = [numbers_of(rod.case) for rod in solved]
    columns = {key: [number[key] for number in numbers] for key in numbers[0]}
    data = quantity_variables.variables(columns, EQUILIBRIUM, units)
    ds = of_solutions(solved, data, [str(rod.caution) for rod in solved], numbers[0]["L"], units)
    kept = {key: stored.attrs[key] for key in KEPT if key in stored.attrs}
    return ds.assign_attrs(kept | {"laws": "[]"}), unsolved


def case_at(stored: StoredStudy, value: float) -> Case:
    """The case of a file of branches at a value of its axis. Raises `InputError` for held ends and for weight."""
    name = str(stored.attrs["axis"])
    if "member" not in stored.sizes or stored.loads_vary:
        raise InputError("the rods of these branches are solved again under dead loads and without weight alone")
    numbers = {field: float(stored[field]) for field in FIELDS if field in stored and not stored[field].dims}
    return case_of_numbers(stored.ds, numbers | {name: value})


def way_of(stored: StoredStudy) -> list[Moment]:
    """The shapes of a rod on its way along the axis of a file of branches, from a stable branch that ends in a fold.

    Raises `InputError` for a file without such a branch, and as `case_at`.
    """
    at, branch, goal = _first_branch(stored)
    name, values = str(stored.attrs["axis"]), stored[str(stored.attrs["axis"])].values
    step = np.copysign(BEYOND * np.ptp(values), goal - values[at])
    rod, load, way = rod_on(stored, branch, at), float(values[at]), list[Moment]()
    for _ in range(MOST):
        values_passed: dict[str, Any] = {name: np.linspace(load, goal, VALUES)}
        followed = follow(rod, **values_passed)
        ends = [point.position for point in followed.special]
        stop = ends[0] if ends else len(followed) - 1
        shapes = solutions_of(followed, STATIONS)
        way += [Moment(float(followed.values[k]), shapes.beta[k]) for k in range(stop + 1)]
        if not ends or followed.special[0].kind != "fold":
            return way
        load = float(followed.values[stop]) + step
        case = case_at(stored, load)
        fall = [Moment(load, beta) for beta in descent(case, way[-1].beta)]
        rod = solve(case, seed=_slope_at_start(fall[-1].beta, float(case.rod.L)), tol=1e-10, stations=STATIONS)
        if not rod.solved or np.abs(rod.beta - fall[-1].beta).max() > AGREES:
            raise InputError(f"beyond the fold at {in_words(name, load)} the rod comes to rest at no equilibrium")
        way += fall
        if (load - goal) * step >= 0:
            return way
    return way


def _first_branch(stored: StoredStudy) -> tuple[int, int, float]:
    """The index of a value of the axis, the stable branch there, and the end of the axis towards which it has a fold:
    of several the branch with the longest way to it."""
    values, ways = stored[str(stored.attrs["axis"])].values, list[tuple[float, int, int, float]]()
    for row in stored.data("branches") if {"fold", "member"} <= {*stored.sizes} else ():
        on = np.flatnonzero((stored["branch"].values == row["branch"]).any(axis=1))
        folds = stored["fold"].values[(stored["fold_branches"].values == row["branch"]).any(axis=1)]
        if row["index"] == 0 and on.size:
            for fold in folds.tolist():
                up = bool(fold >= values[on].max())
                at = int(on.min() if up else on.max())
                ways.append((abs(fold - values[at]), at, row["branch"], float(values[-1] if up else values[0])))
    if not ways:
        raise InputError("no stable branch of this file ends in a fold, so no rod snaps")
    return max(ways)[1:]


def _slope_at_start(beta: Array, length: float) -> float:
    h = length / (beta.size - 1)
    return float(-25 * beta[0] + 48 * beta[1] - 36 * beta[2] + 16 * beta[3] - 3 * beta[4]) / (12 * h)


def descent(case: Case, beta: Array) -> Iterator[Array]:
    """The shapes of a rod between its end angles as its energy falls, from beta at even stations, (n,), to rest.

    Each step is one of the implicit Euler method, small enough that no section turns by more than `TURN`. Raises
    `InputError` where the rod does not come to rest.
    """
    beta = np.array(beta, dtype=float)
    beta[[0, -1]] = [float(np.asarray(getattr(case.given, name))) for name in ("beta0", "betaL")]  # one may change
    A, rho, length = (float(np.asarray(value)) for value in (case.rod.bending_stiffness, case.rho, case.rod.L))
    l, m, p = (float(np.asarray(getattr(case.given, name))) / A for name in ("MZ", "M3", "FZ"))
    slope = partial(dimensional_slope, l, m, p, rho)
    h = length / (beta.size - 1)

    def steepness(beta: Array) -> Array:
        return np.diff(beta, 2) / h**2 + slope(beta[1:-1])

    time, begun = TURN / max(float(np.abs(steepness(beta)).max()), 1e-12), beta
    for _ in range(TURNS):
        new = _step(beta, time, h, slope)
        if new is None or np.abs(new - beta).max() > TURN:
            time /= 2
            continue
        beta, time = new, 1.3 * time
        yield beta
        if np.abs(beta - begun).max() > 2 * TURN and np.abs(steepness(beta)).max() * length**2 < AT_REST:
            return
    raise InputError("beyond the fold the rod does not come to rest")


def _step(beta: Array, time: float, h: float, slope: Callable[[Array], Array]) -> Array | None:
    """beta after a time, by Newton's rule; None where that does not converge."""
    eps = 1e-6

    def correct(new: Array) -> tuple[Array, float]:
        inner = new[1:-1]
        pull = np.diff(new, 2) / h**2 + slope(inner)
        rate = (slope(inner + eps) - slope(inner - eps)) / (2 * eps)
        rows = np.full((3, inner.size), -1 / h**2)
        rows[1] = 1 / time + 2 / h**2 - rate
        change = solve_banded((1, 1), rows, (beta[1:-1] - inner) / time + pull)
        return np.concatenate([new[:1], inner + change, new[-1:]]), float(np.abs(change).max())

    new = newton(beta, correct, ENDING)
    return None if isinstance(new, str) else new


def as_dataset(stored: StoredStudy, way: list[Moment]) -> xr.Dataset:
    """The shapes of the way of a rod over its load and the stations, as a scene reads them, with what the diagram
    shows of each. Raises `InputError` for a diagram of a number that a shape on its way down does not have."""
    name, shown = str(stored.attrs["axis"]), str(stored.attrs["shown"])
    if shown not in ("height", "turns_around"):
        raise InputError(f"a film of a snap shows height or turns_around over the load, and this file has {shown}")
    rows, units = way, stored.units
    beta = np.array([row.beta for row in rows])
    numbers = [numbers_of(case_at(stored, row.load)) for row in rows]
    lengths, rho = np.array([n["L"] for n in numbers])[:, None], np.array([n["rho"] for n in numbers])[:, None]
    u = np.linspace(0, 1, beta.shape[1])
    along = {
        "beta": beta,
        "alpha": cumulative_simpson(np.sin(beta), x=u, initial=0.0) * lengths / rho,
        "z": cumulative_simpson(np.cos(beta), x=u, initial=0.0) * lengths,
    }
    along |= {"radius": np.broadcast_to(rho, beta.shape), "contact": np.zeros_like(beta)}
    data: dict[str, Any] = quantity_variables.variables(along, (name, "u"), units)
    seen = {"height": along["z"][:, -1], "turns_around": along["alpha"][:, -1] / (2 * np.pi)}
    data |= quantity_variables.variables({shown: seen[shown]}, (name,), units)
    each = {key: np.array([n[key] for n in numbers]) for key in numbers[0] if key != name}
    data |= quantity_variables.variables(each, (name,), units)
    data |= {"solved": ((name,), np.ones(len(rows), dtype=bool)), "outcome": ((name,), np.full(len(rows), ""))}
    loads = quantity_variables.variables({name: [row.load for row in rows]}, (name,), units)
    coords = {name: loads[name], "u": ("u", u)} | quantity_variables.variables({"s": u * lengths}, (name, "u"), units)
    ds = xr.Dataset(data, coords)
    attrs = {key: stored.attrs[key] for key in KEPT if key in stored.attrs}
    return ds.assign_attrs(attrs | {"contact": "unilateral", "laws": "[]"})


def evenly(ds: xr.Dataset, count: int) -> xr.Dataset:
    """So many of the shapes, the first and the last among them, between which the rod moves about as far."""
    axis = str(ds["z"].dims[0])
    load = ds[axis].values
    share = np.abs(np.diff(load)) / max(float(np.ptp(load)), 1e-300)
    way = np.append(0.0, np.cumsum(StoredStudy(ds).moves(axis) + SLOWEST * share))
    return ds.isel({axis: np.searchsorted(way, np.linspace(0, way[-1], count) - 1e-9 * way[-1])})


def numbers_of(case: Case) -> dict[str, float]:
    """The numbers of the rod and the cylinder of a case, and its loads."""
    loads = {name: getattr(case.given, name) for name in ("FZ", "MZ", "M3")}
    return {
        name: float(np.asarray(value)) for name, value in (quantity_variables.numbers_of_case(case) | loads).items()
    }
