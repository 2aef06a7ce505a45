"""Equilibria of rods without weight between hinges, and the ways from one to others, on nodes.

A hinged rod may rest at both ends, where an orbit between its own two angles is singular. So the shape on nodes counts:
a `HingedState` has its numbers and its index.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..branches.branch_events import Bounds, Stop
from ..branches.deflation import are_same
from ..branches.given_numbers import FREE, Given, Mirror, OrbitState
from ..branches.orbit_rates import NUMBERS, rates_of_helices, start_rates
from ..branches.path_correction import state_from_start
from ..numerics.arclength import END, POINTS, Lengths
from ..numerics.arrays import ALIKE, Array
from ..numerics.chebyshev import GAUSS
from ..numerics.roots import DIVERGED, REACH
from ..orbits.boundary import helix_path, wrap
from ..orbits.path_orbits import orbit_of
from ..orbits.potential import Loads, potential
from ..problem.dimensionless import EndsProblem
from .banded_newton import correct, deflate, open_at
from .constant_loads import end_numbers, shape_of_orbit
from .loaded_rod import ALPHA, BETA, HELD, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q
from .node_branch import BESIDE, UNSOLVED, NodeCurve, inner, trace_shapes
from .shape_index import index_at, shape_like
from .varying_shapes import Shape
from .weak_modes import weakest_modes

# of steps, in the sizes of the angles and of the way: the whole way at once where nothing is in between. x10: the same,
# but given up early
CARRIED = Lengths(first=1.0, longest=1.0, least=1e-5)
# times the estimated way to an equilibrium across a fold; points on the way to it. x10: more searches that find none
MAY_BE, FEW = 4.0, 20
KICK = 0.3  # rad: the push towards the equilibrium beyond a fold. x10: half a turn, to any other


@dataclass(frozen=True, eq=False, kw_only=True)
class HingedState(OrbitState):
    """One equilibrium with an end moment given, whose index is known. shape: on nodes; its azimuth begins at 0."""

    shape: Shape


def rod_of(given: Given) -> LoadedRod:
    """The rod of given numbers, one of which is an end moment; its azimuth begins at 0."""
    number = dict(zip(given.names, given.values.tolist(), strict=True))
    near, *far = (
        next(number[name] for name in pair if name in number)
        for pair in (("beta0", "dbeta0"), ("betaL", "dbetaL"), ("lam", "alpha"), ("phi", "z"), ("mu", "turn"))
    )
    held = frozenset(field for field, name in HELD.items() if name in number)
    numbers = np.array([given.ratio, *5 * [0.0], 1.0])
    return LoadedRod(numbers, given.span, held, np.array([near, 0.0]), np.array(far))


def shape_of(state: OrbitState, rod: LoadedRod) -> Shape:
    """The shape of a state on nodes; rod: says what its ends are given."""
    if isinstance(state, HingedState):
        return of_rod(state.shape, rod)
    return shape_of_orbit(rod, orbit_of(state.problem, state.path), state.problem)


def of_rod(shape: Shape, rod: LoadedRod) -> Shape:
    """A shape as that of another rod without weight, with its ratio of stiffnesses and where its azimuth begins."""
    y = shape.y.copy()
    y[:, ROUND] += (rod.numbers[0] - shape.rod.numbers[0]) * y[:, MU] * shape.t
    y[:, ALPHA] += rod.near[1] - y[0, ALPHA]
    return replace(shape, rod=rod.in_scales(shape.rod.scale), y=y)


def state_of(shape: Shape) -> HingedState:
    """The state of a shape."""
    number = end_numbers(shape)
    problem = EndsProblem(**{name: np.array([number[name]]) for name in FREE}, span=shape.t[-1:])
    is_helix = np.ptp(shape.y[:, BETA]) < ALIKE  # rad by which beta of a helix varies by rounding
    start = problem.with_start(np.array([number["dbeta0"]]))
    rates = rates_of_helices(problem) if is_helix else start_rates(start)
    rates = replace(rates, problem=problem, values=np.append(end_vector(shape), np.nan)[None])
    path = helix_path(wrap(number["beta0"])) if is_helix else state_from_start(rates, number["dbeta0"]).path
    index, energy = index_at(shape), energy_of(shape)
    return HingedState(problem=problem, path=path, rates=rates, known_index=index, known_energy=energy, shape=shape)


def energy_of(shape: Shape) -> float:
    """The bending energy less the work of the loads, the twist eliminated, in units of A/rho."""
    places, weights = GAUSS
    y = shape.between(places)
    density = y[:, :, SPEED] ** 2 - potential(Loads(y[:, :, Q] + y[:, :, MU], y[:, :, MU], y[:, :, PHI]), y[:, :, BETA])
    return float((density @ weights) @ np.diff(shape.t) / 4)


def with_ends_of(shape: Shape, wanted: Given) -> HingedState:
    """The state of a shape whose ends hold what those of the wanted numbers hold, as the shape has it."""
    shape = of_rod(shape, rod_of(wanted))
    return state_of(replace(shape, rod=with_own_ends(shape).in_scales(shape.rod.scale)))


def carry_hinged(state: OrbitState, wanted: Given, most: int = POINTS) -> HingedState | Stop:
    """The equilibrium with the wanted numbers on the branch of a state, as of `continuation.carry`."""
    curve, shape = line_from(state, wanted)
    begun = curve.begin(shape, 0.0)
    if begun is None:
        return Stop(UNSOLVED, 0.0)
    places, stop = trace_shapes(curve, begun, True, Bounds(0.0, 1.0, (), most), lengths=CARRIED, to_fold=True)
    return state_of(places[-1].path) if stop.reason == END else stop


def line_from(state: OrbitState, wanted: Given) -> tuple[NodeCurve, Shape]:
    """The equilibria on the line from the numbers of a state, at 0, to the wanted ones, at 1; and its shape."""
    target = rod_of(wanted)
    shape = shape_of(state, target)
    first = with_own_ends(shape)
    u = max(shape.t / shape.t[-1], target.nodes() / target.span, key=len)

    def rod_at(x: float) -> LoadedRod:
        span, near, far = (
            (1 - x) * getattr(first, name) + x * getattr(target, name) for name in ("span", "near", "far")
        )
        return target if x == 1 else replace(first, span=span, near=near, far=far)

    return NodeCurve(rod_at, 1.0, shape.rod.scale), shape_like(first.in_scales(shape.rod.scale), shape, u * first.span)


def with_own_ends(shape: Shape) -> LoadedRod:
    """The rod of a shape, whose ends are given what the shape has there."""
    rod, number = shape.rod, end_numbers(shape)
    pairs = ("betaL", "dbetaL"), ("azimuth", "lam"), ("height", "phi"), ("rotation", "mu")
    far = [number[HELD[field] if field in rod.held else load] for field, load in pairs]
    near = np.array([number["beta0" if "beta0" in rod.held else "dbeta0"], rod.near[1]])
    return replace(rod, near=near, far=np.array(far))


def settle_hinged(guess: OrbitState, wanted: Given) -> HingedState | str:
    """The equilibrium next to a guess, or why there is none."""
    shape = shape_of(guess, rod_of(wanted))
    corrected = correct(shape_like(shape.rod, shape, shape.t * (wanted.span / shape.t[-1])))
    if corrected is None or np.abs(corrected.y[:, BETA] - shape.y[:, BETA]).max() > REACH:
        return DIVERGED
    return state_of(corrected)


def deflate_hinged(state: OrbitState, wanted: Given, known: Sequence[Array]) -> HingedState | None:
    """An equilibrium with the wanted numbers that is none of the known ones, as of `deflation.deflate`."""

    def change_of_ends(shape: Shape, change: Array) -> Array:
        return end_vector(replace(shape, y=shape.y + change * shape.rod.scale)) - end_vector(shape)

    shape = shape_of(state, rod_of(wanted))
    shape = shape_like(shape.rod, shape, shape.t * (wanted.span / shape.t[-1]))
    other = deflate(shape, known, end_vector, change_of_ends, REACH / float(shape.rod.scale[BETA]))
    if other is None or any(are_same(end_vector(other), ends) for ends in known):
        return None
    return state_of(other)


def end_vector(shape: Shape) -> Array:
    """The `NUMBERS` of a shape but the level, (10,): all linear in its states."""
    number = end_numbers(shape)
    return np.array([number[name] for name in NUMBERS[:-1]])


def across_fold_hinged(state: OrbitState, wanted: Given) -> list[OrbitState]:
    """Guesses of the equilibrium that meets this one at the nearest fold, on either side of it, the likelier first."""
    if not isinstance(state, HingedState):
        return []
    shape = replace(state.shape, rod=rod_of(wanted).in_scales(state.shape.rod.scale))
    modes = weakest_modes(shape)
    pushed = [replace(shape, y=shape.y + sign * KICK * modes[0]) for sign in (1, -1)]
    pushed.sort(key=lambda beside: float(np.linalg.norm(open_at(beside))))
    return [replace(state, shape=beside) for beside in pushed]


def mirror_image(shape: Shape, mirror: Mirror) -> Shape:
    """The image of a shape."""
    y, way, sense = shape.y, -1 if mirror.backward else 1, mirror.direction
    # the signs of azimuth and lam, and of height and phi
    across, along = (-1 if changed else 1 for changed in (mirror.negated, mirror.turned))
    t = shape.t[-1] - shape.t[::-1] if mirror.backward else shape.t
    image = np.empty_like(y)
    image[:, BETA] = mirror.angle(y[::way, BETA])
    image[:, SPEED] = sense * way * y[::way, SPEED]
    image[:, MU], image[:, PHI] = sense * y[::way, MU], along * y[::way, PHI]
    image[:, Q] = across * (y[::way, Q] + y[::way, MU]) - image[:, MU]

    def gain(values: Array, sign: int) -> Array:
        return np.asarray(sign * way * (values[::way] - values[::way][0]))

    twist = shape.rod.numbers[0] * y[0, MU]
    image[:, ALPHA] = gain(y[:, ALPHA], across)
    image[:, SHORT] = t - gain(shape.t - y[:, SHORT], along)
    swirl = gain(twist * shape.t - y[:, ROUND] + y[:, ALPHA], sense)
    image[:, ROUND] = sense * twist * t - swirl + image[:, ALPHA]
    return replace(shape, t=t, y=image)


def half_period_later(shape: Shape) -> Shape | None:
    """The shape that begins at the other turning point of the same orbit; None unless it is whole periods long.

    shape: of a rod that rests at both ends.
    """
    span, halves = float(shape.t[-1]), len(shape.bends(1.0)) + 1
    if halves % 2 or np.ptp(shape.y[:, BETA]) < ALIKE:
        return None
    at = shape.t + span / halves
    late = at > span
    first, second = shape.at(at[~late]), shape.at(at[late] - span)
    sums = [ALPHA, SHORT, ROUND]
    second[:, sums] += shape.y[-1, sums] - shape.y[0, sums]
    y = np.concatenate([first, second])
    y[:, sums] -= y[0, sums]
    return replace(shape, y=y)


def is_nearer_across_fold(seed: OrbitState, state: OrbitState, wanted: Given) -> bool:
    """Whether another equilibrium with the wanted numbers, across a fold of the branch from a seed, is nearer than it.

    The branch is followed to it only where its bend says that a fold may be near.
    """
    assert isinstance(state, HingedState)
    curve, begin = line_from(seed, wanted)
    point = curve.begin(shape_like(state.shape.rod, state.shape, begin.t * (wanted.span / begin.t[-1])), 1.0)
    behind = None if point is None else curve.ahead(point, -BESIDE)
    if point is None or behind is None:
        return False
    far = _apart(curve, begin, point.shape)
    if not 0 < 2 * point.rises * BESIDE < MAY_BE * far * (behind.rises - point.rises):
        return False
    places, _ = trace_shapes(curve, point, True, Bounds(-1.0, 3.0, (1.0,), FEW))
    return any(place.p == 1 and _apart(curve, place.path, point.shape) < far for place in places)


def _apart(curve: NodeCurve, shape: Shape, other: Shape) -> float:
    """The mean difference of the angles of two shapes, in their sizes."""
    change = curve.in_sizes(shape.y - other.y, 0.0)
    return float(np.sqrt(inner(change, change)))


def meetings_of(seed: OrbitState, state: OrbitState, wanted: Given, bounds: Bounds) -> list[OrbitState]:
    """Where the branch of an equilibrium meets the wanted numbers, on the line from those of a seed."""
    assert isinstance(state, HingedState)
    curve, _ = line_from(seed, wanted)
    begun = curve.begin(state.shape, 1.0)
    ways = () if begun is None else (trace_shapes(curve, begun, rises, bounds)[0] for rises in (True, False))
    return [state_of(place.path) for places in ways for place in places if place.p == 1]
