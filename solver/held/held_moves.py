"""The ways from one equilibrium with held ends to others: on nodes where an end moment is given, else along orbits."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..branches import continuation, deflation, path_correction
from ..branches.branch_events import Bounds, Stop
from ..branches.branch_following import trace_branch
from ..branches.continuation import line_between
from ..branches.deflation import end_vector
from ..branches.given_numbers import FREE, Given, OrbitState
from ..branches.leaps import SHARES, angles_on
from ..branches.orbit_rates import orbit_rates
from ..nodes import banded_newton, hinges
from ..nodes.banded_newton import turns_above
from ..nodes.hinges import HingedState
from ..nodes.loaded_rod import BETA
from ..nodes.varying_shapes import Shape
from ..numerics.arclength import POINTS
from ..numerics.arrays import Array
from ..orbits.boundary import Path
from ..orbits.path_orbits import orbit_of
from ..problem.dimensionless import EndsProblem


def carry(state: OrbitState, wanted: Given, most: int = POINTS) -> OrbitState | Stop:
    """The equilibrium with the wanted numbers on the branch of a state; all numbers change in proportion."""
    return (hinges.carry_hinged if wanted.has_hinge else continuation.carry)(state, wanted, most)


def settle(guess: OrbitState, wanted: Given) -> OrbitState | str:
    """The equilibrium with the wanted numbers next to a guess, or why there is none."""
    if wanted.has_hinge:
        return hinges.settle_hinged(guess, wanted)
    return path_correction.settle(guess.problem, guess.path, wanted)


def deflate(state: OrbitState, wanted: Given, known: Sequence[Array]) -> OrbitState | None:
    """An equilibrium with the wanted numbers that is none of the known ones; None where the steps lead to none.

    known: the `end_vector` each.
    """
    return (hinges.deflate_hinged if wanted.has_hinge else deflation.deflate)(state, wanted, list(known))


def across_fold(state: OrbitState, wanted: Given) -> list[OrbitState]:
    """Guesses of the equilibrium that meets this one at the nearest fold, on either side of it, the likelier first."""
    return (hinges.across_fold_hinged if wanted.has_hinge else deflation.across_fold)(state, wanted)


def is_nearer_across_fold(seed: OrbitState, state: OrbitState, wanted: Given) -> bool:
    """Whether the equilibrium that meets one at its nearest fold is nearer to it than a seed is."""
    if wanted.has_hinge:
        return hinges.is_nearer_across_fold(seed, state, wanted)
    beside = deflation.fold_beside(state, wanted)
    return beside is not None and bool(abs(beside[1]) < np.linalg.norm(end_vector(state) - end_vector(seed)))


def meetings(seed: OrbitState, state: OrbitState, wanted: Given, bounds: Bounds) -> list[OrbitState]:
    """Where the branch of an equilibrium meets the wanted numbers again, on the line from those of a seed."""
    if wanted.has_hinge:
        return hinges.meetings_of(seed, state, wanted, bounds)
    if state.path.helix:
        return []
    line = line_between(state.problem, wanted.at(seed), wanted)
    places = [place for rises in (True, False) for place in trace_branch(line, state.path, 1.0, rises, bounds)[0]]
    return [path_correction.state_of(place.problem, place.path) for place in places if place.p == 1]


def state_of_seed(problem: EndsProblem, path: Path | None, shape: Shape | None, wanted: Given) -> OrbitState | None:
    """The state of a seed that is carried to the wanted numbers; None of one that is no equilibrium.

    path: of the seed under the dead loads of `problem`. shape: on nodes, which counts where an end moment is given.
    """
    state = None if path is None else path_correction.state_of(problem, path)
    if not wanted.has_hinge:
        return state
    if shape is None and state is not None:
        shape = hinges.shape_of(state, hinges.rod_of(wanted))
    return None if shape is None else hinges.with_ends_of(shape, wanted)


def angles_along(state: OrbitState) -> Array:
    """beta at equal shares of the rod, (257,)."""
    if isinstance(state, HingedState):
        return np.asarray(state.shape.at(SHARES * state.shape.t[-1])[:, BETA])
    return angles_on(orbit_of(state.problem, state.path))[0]


def within_a_turn(state: OrbitState) -> OrbitState:
    """The state with beta(0) in (-pi, pi], to rounding."""
    turns = turns_above(float(state.problem.beta0[0]))
    if not turns:
        return state
    if isinstance(state, HingedState):
        return hinges.state_of(banded_newton.within_a_turn(state.shape))
    problem = replace(state.problem, **{name: getattr(state.problem, name) - turns for name in FREE[:2]})
    return replace(state, problem=problem, rates=orbit_rates(problem, [state.path]))
