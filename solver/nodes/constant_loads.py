"""Rods under constant loads on nodes: the shapes of orbits and of other solutions, each read at nodes of its own."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..numerics.arrays import NEGLIGIBLE, Array
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q, scales
from .shape_index import change_rates, fine_nodes, indices_with_springs
from .varying_shapes import Shape

Read = Callable[[Array], tuple[Array, ...]]  # beta, beta_t, alpha and z from 0, and the swirl, at times (n,)


def shape_of_solution(rod: LoadedRod, trajectory: Any, problem: Any, t: Array) -> Shape:
    """The shape that the trajectory of one solved problem has, with stations t (n,).

    rod: says what its ends are given, and its azimuth at the start.
    """
    if trajectory.shapes is not None:
        shape: Shape = trajectory.shapes.of(0)
        return replace(shape, rod=rod.in_scales(shape.rod.scale))
    orbit = trajectory.orbit
    if orbit is not None:
        return shape_of_orbit(rod, orbit, problem)
    rows = (trajectory.beta, trajectory.dbeta, trajectory.alpha, trajectory.z, trajectory.swirl())
    return shape_from(rod, lambda at: tuple(np.interp(at, t, row[0]) for row in rows), problem)


def shape_of_orbit(rod: LoadedRod, orbit: Any, problem: Any) -> Shape:
    """The shape that the orbit of one problem has; rod: as of `shape_of_solution`."""

    def read(t: Array) -> tuple[Array, ...]:
        return *(row[0] for row in orbit.at(t[None])), orbit.swirl(t[None])[0]

    return shape_from(rod, read, problem)


def shape_from(rod: LoadedRod, read: Read, problem: Any) -> Shape:
    """The shape of a rod that can be read anywhere, under the loads and of the length of one problem.

    Its nodes are about one on each length on which it changes, and its scales are of these lengths.
    """
    lam, mu, phi, span = (float(getattr(problem, name)[0]) for name in ("lam", "mu", "phi", "span"))
    dead = replace(rod, span=span, held=frozenset({"beta0", "betaL"}), far=np.array([0.0, lam, phi, mu]))

    def states(t: Array) -> Array:
        return states_under(rod, t[None], (lam, mu, phi), [row[None] for row in read(t)])[0]

    coarse = dead.nodes()
    shape = Shape(dead, coarse, states(coarse))
    t = fine_nodes(shape)
    rate = float(np.hypot(change_rates(shape).max(), 1 / span))
    scale = np.array(scales(rate, min(1.0, rate)))
    return Shape(replace(rod, span=span).in_scales(scale), t, states(t))


def states_under(rod: LoadedRod, t: Array, loads: Sequence[Any], along: Sequence[Array]) -> Array:
    """The states (N, n, 8) at times t (N, n) of rods under constant loads lam, mu and phi, one or (N,) each.

    along: beta, beta_t, alpha and z from 0, and the swirl, (N, n) each.
    """
    lam, mu, phi = (np.reshape(load, (-1, 1)) for load in loads)
    beta, speed, alpha, z, swirl = along
    y = np.empty((*t.shape, 8))
    y[..., BETA], y[..., SPEED], y[..., ALPHA], y[..., SHORT] = beta, speed, rod.near[1] + alpha, t - z
    y[..., Q], y[..., PHI], y[..., MU] = lam - mu, phi, mu
    y[..., ROUND] = rod.numbers[0] * mu * t - swirl + alpha
    return y


def end_numbers(shape: Shape) -> dict[str, float]:
    """The numbers of a shape that ends can give, by the names of `dimensionless.NUMBER_OF`, and the swirl; loads at the
    far end."""
    first, last, span = shape.y[0].tolist(), shape.y[-1].tolist(), float(shape.t[-1])
    turned = last[ALPHA] - first[ALPHA]
    return {
        "beta0": first[BETA],
        "betaL": last[BETA],
        "dbeta0": first[SPEED],
        "dbetaL": last[SPEED],
        "alpha": turned,
        "z": span - last[SHORT],
        "turn": last[ROUND] - turned,
        "swirl": float(shape.rod.numbers[0]) * last[MU] * span - (last[ROUND] - turned),
        "lam": last[Q] + last[MU],
        "mu": last[MU],
        "phi": last[PHI],
    }


def dead_indices(shapes: Sequence[Shape | None]) -> Array:
    """The Morse index of B shapes under their dead loads and between their own end angles, (B,) of floats.

    NaN of a shape that is singular there to rounding, as that of a rod which rests at its ends, and without a shape.
    """
    return np.array([np.nan if shape is None else _dead_index(shape) for shape in shapes])


def _dead_index(shape: Shape) -> float:
    """The Morse index of one shape: as many negative directions with springs that hardly push it away or hold it."""
    alone = replace(shape, rod=replace(shape.rod, held=frozenset({"beta0", "betaL"})).in_scales(shape.rod.scale))
    # springs of `springs_of` as weak as this tell whether a direction is stiff at all
    _, *nearby = indices_with_springs(alone, (-NEGLIGIBLE, NEGLIGIBLE))
    return float(nearby[0]) if nearby[0] == nearby[1] else np.nan
