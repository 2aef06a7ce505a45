"""The answer to dimensionless problems, at stations along each rod."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import Array, Columns
from .dimensionless import EndsProblem, Reduced

# a rod that every method solves
PLAIN = {"lam": 0.0, "mu": 0.0, "phi": 0.0, "span": 1.0, "beta0": 0.5, "dbeta0": 0.0, "betaL": 0.5}


P = TypeVar("P", bound=Reduced)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The answer to B problems at n stations, in units of rho.

    beta, dbeta (d/dt), alpha (from 0), z (from 0): (B, n). swirl: a function that returns the integral of sin(beta)
    cos(beta), (B, n); it can be pickled. solved: (B,) of bool. outcome: (B,) sentences, "solved" or the reason of a
    failure. error, condition, evaluations: (B,).
    orbit: the periodic orbit if the method knows it (`orbits.periodic_orbit`), else None.
    selection: (B,) of `held.equilibrium_choice.Selection`, how each equilibrium was selected; None for a seed, for a
    start problem, and where floats cannot hold the problem.
    begun: (B,) phrases, how each rod with held ends, weight or friction was found; None where the selection says it.
    held_index, dead_index: (B,) of floats, the Morse index under held ends, and without weight or friction that of the
    shape under dead loads between its own end angles; None for other problems.
    alternatives: a function of the stations (1, n) that finds other equilibria with the held ends of a single problem,
    near its seed: distance from the seed, problem and trajectory of each; None for other problems.
    loads: lam, mu and phi at the stations, (3, B, n), and shapes: `nodes.varying_shapes.VaryingShapes`, where loads
    vary along the rod; else None.
    free: `free.free_rods.FreeRods` of rods that may leave the cylinder; else None.
    """

    beta: Array
    dbeta: Array
    alpha: Array
    z: Array
    swirl: Callable[[], Array]
    solved: NDArray[np.bool_]
    outcome: NDArray[np.object_]
    error: Array
    condition: Array
    evaluations: NDArray[np.int64]
    orbit: Any = None
    selection: NDArray[np.object_] | None = None
    begun: NDArray[np.object_] | None = None
    held_index: Array | None = None
    dead_index: Array | None = None
    alternatives: Callable[[Array], Any] | None = None
    loads: Array | None = None
    shapes: Any = None
    free: Any = None

    def take(self, rows: NDArray[np.int64]) -> "Trajectory":
        """The answers to the problems `rows`, (b,) rising."""
        values = vars(self)
        arrays = {name: value for name, value in values.items() if isinstance(value, np.ndarray) and name != "loads"}
        picked = {name: value[rows] for name, value in arrays.items()}
        picked |= {name: values[name].take(rows) for name in ("orbit", "shapes", "free") if values[name] is not None}
        if self.loads is not None:
            picked["loads"] = self.loads[:, rows]
        return replace(self, **picked, swirl=partial(_rows_of, self.swirl, rows), alternatives=None)


def _rows_of(compute: Callable[[], Array], rows: NDArray[np.int64]) -> Array:
    return compute()[rows]


@dataclass(frozen=True, eq=False)
class Seed(Columns):
    """Selects one of many solutions: the one near the seed.

    dbeta0: beta_t(0), (B,). beta: at s/L = u, (B, n). If the seeds are solutions, problem: the ends problems that they
    solve; paths: `orbits.boundary.Paths` if the method knows them; shapes: on nodes, (B,), None where there is none.
    """

    dbeta0: Array
    u: Array
    beta: Array
    problem: EndsProblem | None = None
    paths: Any = None
    shapes: Any = None

    def on(self, problem: EndsProblem, nodes: int) -> Array:
        """The single shape on equal steps, (nodes,), changed linearly to meet the end angles of the problem."""
        u = np.linspace(0, 1, nodes)
        beta = np.interp(u, self.u[0], self.beta[0])
        first, last = problem.beta0[0] - beta[0], problem.betaL[0] - beta[-1]
        return beta + first + (last - first) * u


def where_shown(shown: NDArray[np.bool_], values: Callable[..., Array], *at: Array) -> Array:
    """What `values` returns at these stations, with NaN for each problem that is not shown."""
    return np.where(shown, values(*at), np.nan)


def stood_in(problem: P, fit: NDArray[np.bool_]) -> P:
    """The problems with a plain rod in place of each that is not `fit` (B,), so that a method can solve them all."""
    if fit.all():
        return problem
    return type(problem)(**{name: np.where(fit, value, PLAIN[name]) for name, value in vars(problem).items()})


def blank(answer: Trajectory, fit: NDArray[np.bool_], why: str | NDArray[np.str_]) -> Trajectory:
    """The answer with NaN for each problem that is not `fit` (B,); `why`, one or (B,), becomes its outcome."""
    if fit.all():
        return answer
    nothing = {"solved": False, "outcome": why, "error": np.inf, "condition": np.inf, "evaluations": 0}
    nothing |= dict.fromkeys(("selection", "begun"), np.array(None))
    shown = fit[:, None]

    def without(name: str, values: Array) -> Array:
        return np.where(fit if values.ndim == 1 else shown, values, nothing.get(name, np.nan))

    known = {name: values for name, values in vars(answer).items() if isinstance(values, np.ndarray)}
    arrays: dict[str, Any] = {name: without(name, values) for name, values in known.items()}
    shapes = None if answer.shapes is None else answer.shapes.only(fit)
    return replace(answer, **arrays, swirl=partial(where_shown, shown, answer.swirl), shapes=shapes)
