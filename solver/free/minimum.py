"""A minimum of the energy of a discrete rod beside its wall: Newton's method sharpens what Uno finds.

Push and gap are then complementary to rounding, so the push, which is a fourth difference of the shape, has no noise.
"""

from typing import Any, NamedTuple

import numpy as np

from ..numerics.arrays import Array, Booleans, Integers
from .discrete_rod import CONDITIONS, EDGE, HELD_ON, DiscreteRod
from .program import Program, Sizes

COLD, WARM = 1e-2, 1e-4  # first barrier: from another problem's shape, and from one of this problem on another mesh
MOST_STEPS = 30  # of Newton's method; usual are 3 to 6
SHARP, BLUNT = 1e-10, 1e-7  # changes of the unknowns: the last one; one below which rounding may end the progress
ROUNDING = 1e-11  # of derivatives of the energy, a hundred times what is seen
FIRM = 1e-6  # of the order of the second derivatives: what holds a rod that may turn as a whole
STIFF, TINY = 1e-4, 1e-14  # of the force that bends an edge by the radius, what a gap counts as; least of a derivative
ALONE = 2  # nodes: where no more touch together, the rod touches at one point, somewhere between the nodes
FARTHEST, LEAST_PART = 1.2, 1e-3  # edges by which a point moves in a step; least part of a step
LAGRANGE = np.array([[0.0, -0.5, 0.5], [1.0, 0.0, -1.0], [0.0, 0.5, 0.5]])  # of three nodes: powers of the place


class Minimum(NamedTuple):
    """y: the unknowns (size,). multipliers: of the conditions (M,), 0 off the wall. unstable: in how many ways it is,
    so 0 at a minimum; None where that is not decided. steps: of both methods."""

    y: Array
    multipliers: Array
    unstable: int | None
    steps: int


class Points(NamedTuple):
    """Where a rod touches the wall at a point: nodes (S,), and how far beyond each, in edges, |offset| < 1/2 or so.

    The gap next to the point is a parabola through three nodes. value: its least one. bend: its second derivative.
    weights, rates: of the three nodes at the point, and their derivatives by the place, (S, 3).
    """

    nodes: Integers
    offset: Array
    value: Array
    bend: Array
    weights: Array
    rates: Array


def points_at(nodes: Integers, gap: Array) -> Points:
    """The points next to some nodes; gap: of all nodes, (N + 1,)."""
    before, at, after = (gap[nodes + k] for k in (-1, 0, 1))
    bend = before - 2 * at + after
    with np.errstate(all="ignore"):
        v = np.nan_to_num((before - after) / (2 * bend), nan=FARTHEST, posinf=FARTHEST, neginf=FARTHEST)
    power = np.stack([v**0, v, v**2])
    weights = (LAGRANGE @ power).T
    rates = (LAGRANGE[:, 1:] @ np.stack([v**0, 2 * v])).T
    return Points(nodes, v, (weights * np.stack([before, at, after], axis=1)).sum(axis=1), bend, weights, rates)


class State(NamedTuple):
    """An equilibrium: free unknowns z, multipliers (M,), which conditions hold (M,), and the nodes next to points."""

    z: Array
    multipliers: Array
    active: Booleans
    nodes: Integers
    steps: int


def minimise(
    rod: DiscreteRod, guess: Array, sizes: Sizes, barrier: float = COLD, multipliers: Array | None = None
) -> Minimum | None:
    """The minimum near a guess (size,); None where none is found.

    multipliers: a guess of those too, (M,), with which Newton's method alone is tried first. Raises `InputError` where
    Uno is not installed.
    """
    program = Program(rod, sizes, rod.with_known(guess))
    newton = Newton(program)
    if multipliers is not None:
        sharp = exact_state(program, np.zeros(program.free.size), multipliers * program.unit_of / sizes.energy, 0)
        if sharp is not None and unstable_ways(newton, sharp) == 0:
            return newton.minimum(sharp, 0)
    rough = program.minimise(barrier)
    sharp = None if rough is None else exact_state(program, *rough)
    return None if sharp is None else newton.minimum(sharp, unstable_ways(newton, sharp))


class Newton:
    """The equations of a program: stationary energy, and conditions; those of points in place of their nodes'.

    firm: added to the second derivatives in steps alone, where a rod may turn as a whole without any change of energy.
    """

    def __init__(self, program: Program, firm: float = 0.0) -> None:
        self.program, self.firm, rod = program, firm, program.rod
        self.first = CONDITIONS * rod.edges - 1  # so that the condition of node k is first + k
        self.wall = self.first + 1 + np.arange(rod.edges - 1)
        ends = rod.side * (rod.radius**2 - 1) / program.sizes.across
        self.ends = ends[:1], ends[1:]

    @property
    def blunt(self) -> float:
        """The change of the unknowns below which rounding may end the progress: what it moves a rod that may turn."""
        return max(BLUNT, ROUNDING / self.firm) if self.firm else BLUNT

    def minimum(self, state: "State", unstable: int | None) -> Minimum:
        """An equilibrium in the unknowns of the rod."""
        program, points = self.program, self.points(state.z, state.nodes)
        multipliers = self.spread(state.multipliers, points) * program.sizes.energy / program.unit_of
        return Minimum(program.whole(state.z), multipliers, unstable, state.steps)

    def gaps(self, c: Array) -> Array:
        """The gaps of all nodes, (N + 1,), from the conditions (M,)."""
        return np.concatenate([self.ends[0], self.program.rod.side * c[self.wall], self.ends[1]])

    def points(self, z: Array, nodes: Integers) -> Points:
        return points_at(nodes, self.gaps(self.program.conditions(z)))

    def spread(self, multipliers: Array, points: Points) -> Array:
        """The multipliers, those of the points on the nodes around them."""
        spread = multipliers.copy()
        spread[self.first + points.nodes] = 0.0
        for k in (-1, 0, 1):
            inner = (points.nodes + k > 0) & (points.nodes + k < self.program.rod.edges)
            force = points.weights[:, k + 1] * multipliers[self.first + points.nodes]
            np.add.at(spread, self.first + points.nodes[inner] + k, force[inner])
        return spread

    def entries(
        self, z: Array, multipliers: Array, active: Booleans, loose: Array, points: Points
    ) -> tuple[Any, Any, Any]:
        """Rows, columns and values of the matrix, some entries in parts.

        loose: how much an active condition gives way to its multiplier, (M,).
        """
        program, n = self.program, self.program.free.size
        _, rows, columns, _, _, above, beside, _ = program.places
        at_point = np.zeros(active.size, dtype=bool)
        at_point[self.first + points.nodes] = True
        slopes, bends = program.jacobian(z), program.hessian(z, 1.0, self.spread(multipliers, points))
        kept, lower, diagonal = (active & ~at_point)[rows], above != beside, n + np.arange(active.size)
        i, j, slope, curve = self._of_points(z, multipliers, points)
        parts = [
            (above, beside, bends), (beside[lower], above[lower], bends[lower]), (i[:, :, None], i[:, None], curve),
            (columns[kept], n + rows[kept], -slopes[kept]), (n + rows[kept], columns[kept], -slopes[kept]),
            (i, n + j, -slope), (n + j, i, -slope),
            (diagonal, diagonal, np.where(at_point, 0.0, np.where(active, -loose, -1.0))),
        ]  # fmt: skip
        each = [np.broadcast_arrays(*part) for part in parts]
        i, j, values = (np.concatenate([part[k].ravel() for part in each]) for k in range(3))
        inside = (i >= 0) & (j >= 0)
        return i[inside], j[inside], values[inside]

    def _of_points(self, z: Array, multipliers: Array, points: Points) -> tuple[Any, Any, Array, Array]:
        """Columns (S, 6), -1 where they are given, rows (S, 1), slopes (S, 6) and second derivatives (S, 6, 6)."""
        program, S = self.program, points.nodes.size
        place = np.full(program.rod.size, -1)
        place[program.free] = np.arange(program.free.size)
        node = points.nodes[:, None] + [-1, 0, 1]
        unknown = (EDGE * (node[..., None] - 1) + np.array([4, 5])).clip(0)
        columns = np.where(node[..., None] > 0, place[unknown], -1).reshape(S, 6)
        rows = self.first + points.nodes[:, None]
        y = program.whole(z)
        gradient = 2 * y[unknown] * program.unit[unknown] / program.unit_of[rows[0, 0]] if S else np.zeros((0, 3, 2))
        slope, across = ((gradient * w[..., None]).reshape(S, 6) for w in (points.weights, points.rates))
        curve = multipliers[rows[:, 0]] / (program.rod.side * points.bend) if S else np.zeros(0)
        return columns, rows, slope, curve[:, None, None] * across[:, :, None] * across[:, None]

    def step(self, z: Array, multipliers: Array, active: Booleans, loose: Array, left: Array, points: Points) -> Any:
        """The changes of z and of the multipliers; None where the matrix is singular. left: of the conditions, (M,)."""
        from scipy.sparse import coo_array, csc_array  # only a search loads SciPy
        from scipy.sparse.linalg import splu

        program, n = self.program, self.program.free.size
        _, rows, columns, *_ = program.places
        pull = program.jacobian(z) * self.spread(multipliers, points)[rows]
        i, j, values = self.entries(z, multipliers, active, loose, points)
        matrix = csc_array(coo_array((values, (i, j)), shape=(n + active.size,) * 2))
        matrix.setdiag(matrix.diagonal() + self.firm * (np.arange(n + active.size) < n))
        left = np.concatenate([np.bincount(columns, pull, minlength=n) - program.gradient(z), left])
        try:
            change = splu(matrix).solve(left)
        except RuntimeError:  # a singular matrix
            return None
        return (change[:n], change[n:]) if np.isfinite(change).all() else None


NO_POINTS = points_at(np.zeros(0, dtype=np.int64), np.zeros(0))


def exact_state(program: Program, z: Array, multipliers: Array, steps: int) -> State | None:
    """An equilibrium to rounding; None where the steps do not converge."""
    ways = (solution_of(Newton(program, firm), z, multipliers, steps) for firm in (0.0, FIRM))
    return next((state for state in ways if state is not None), None)


def solution_of(newton: Newton, z: Array, multipliers: Array, steps: int) -> State | None:
    """The equilibrium of a program, by Newton's method on certain equations; None where it does not converge.

    At each node push a and gap b obey a + b - (a^2 + b^2)^(1/2) = 0 (Fischer and Burmeister), whose derivatives tell by
    themselves which of the two is 0. Points then move to where they belong between nodes.
    """
    program, last = newton.program, np.inf
    wall, side = newton.wall[: newton.wall.size * (program.rod.side != HELD_ON)], program.rod.side
    stiff = STIFF * program.sizes.across**2 / (program.sizes.energy * program.rod.h**3)
    loose, active = np.zeros(multipliers.size), np.ones(multipliers.size, dtype=bool)
    for _ in range(MOST_STEPS):
        left = program.conditions(z)
        push, gap = side * multipliers[wall], stiff * side * left[wall]
        size = np.hypot(push, gap) + TINY
        by_push, by_gap = 1 - push / size, np.maximum(1 - gap / size, TINY)
        loose[wall], left[wall] = by_push / (stiff * by_gap), side * (push + gap - size) / (stiff * by_gap)
        change = newton.step(z, multipliers, active, loose, left, NO_POINTS)
        if change is None:
            return None
        z, multipliers, steps, far = z + change[0], multipliers + change[1], steps + 1, np.abs(change[0]).max()
        if far < SHARP or (far < newton.blunt and far > last / 2):  # rounding ends the progress
            active[wall] = side * multipliers[wall] > stiff * side * program.conditions(z)[wall]
            state = State(z, np.where(active, multipliers, 0.0), active, NO_POINTS.nodes, steps)
            return state if side == HELD_ON else state_of_points(newton, state)
        last = far
    return None


def state_of_points(newton: Newton, state: State) -> State:
    """A state whose points of contact stand where they belong between nodes; the state itself where that fails."""
    program, (z, multipliers, active, _, steps) = newton.program, state
    touching = np.flatnonzero(active[newton.wall]) + 1
    runs = np.split(touching, np.flatnonzero(np.diff(touching) > 1) + 1) if touching.size else []
    alone = [run for run in runs if run.size <= ALONE]
    if not alone:
        return state
    active, multipliers = active.copy(), multipliers.copy()
    force = program.rod.side * multipliers[newton.first + np.arange(program.rod.edges)]
    nodes = np.array([run[force[run].argmax()] for run in alone])
    for run, node in zip(alone, nodes, strict=True):
        total = multipliers[newton.first + run].sum()
        multipliers[newton.first + run], active[newton.first + run] = 0.0, False
        multipliers[newton.first + node] = total
    active[newton.first + nodes], last, points = True, np.inf, newton.points(z, nodes)
    for _ in range(2 * MOST_STEPS):
        left = program.conditions(z) * active
        left[newton.first + nodes] = program.rod.side * points.value
        change = newton.step(z, multipliers, active, np.zeros(active.size), left, points)
        if change is None:
            return state
        part, ahead = 1.0, newton.points(z + change[0], nodes)
        while not (ahead.bend.min() > 0 and np.abs(ahead.offset).max() < FARTHEST):
            part /= 2
            if part < LEAST_PART:
                return state
            ahead = newton.points(z + part * change[0], nodes)
        z, multipliers, steps, points = z + part * change[0], multipliers + part * change[1], steps + 1, ahead
        far = np.abs(change[0]).max()
        if far < SHARP or (far < newton.blunt and far > last / 2):
            pushes, gaps = program.rod.side * multipliers[newton.wall], newton.gaps(program.conditions(z))
            return state if pushes.min() < 0 or gaps.min() < -BLUNT else State(z, multipliers, active, nodes, steps)
        last, moved = far, nodes + np.round(points.offset).astype(np.int64)
        if moved.min() < 1 or moved.max() >= program.rod.edges:  # it moves to an end, which is held
            return state
        if (moved != nodes).any():
            at, goal = newton.first + nodes, newton.first + moved
            force = multipliers[at]
            multipliers[at], active[at] = 0.0, False
            multipliers[goal], active[goal], nodes = force, True, moved
            points = newton.points(z, nodes)
    return state


def unstable_ways(newton: Newton, state: State) -> int | None:
    """In how many ways an equilibrium is unstable while its active conditions hold; 0: it is a minimum.

    The matrix of the equations has a negative eigenvalue for each condition, and one for each such way. They are
    counted while it is eliminated in blocks of two edges, of which each touches the next one alone. None where one is
    singular. A way by which the energy falls less than a rod that may turn as a whole is held counts as none.
    """
    program, active = newton.program, state.active
    N, edge = program.rod.edges, np.arange(program.rod.edges)
    of_unknowns = np.concatenate([np.repeat(edge, EDGE), np.zeros(4, int), np.full(4, N - 1)])[program.free]
    of_conditions = np.concatenate([np.repeat(edge, CONDITIONS), edge[:-1], np.full(2 * program.rod.swings, N - 1)])
    block = np.concatenate([of_unknowns, of_conditions]) // 2
    count = np.bincount(block)
    local = np.empty_like(block)
    local[np.argsort(block, kind="stable")] = np.arange(block.size) - np.repeat(np.cumsum(count) - count, count)
    points = newton.points(state.z, state.nodes)
    i, j, values = newton.entries(state.z, state.multipliers, active, np.zeros(active.size), points)
    m = int(count.max())
    square, cross = np.zeros((2, count.size, m, m))
    square[:, np.arange(m), np.arange(m)] = np.arange(m) >= count[:, None]  # in place of what a smaller block lacks
    unknown = np.arange(program.free.size)
    np.add.at(square, (block[unknown], local[unknown], local[unknown]), FIRM)
    for blocks, mine in ((square, block[i] == block[j]), (cross, block[i] == block[j] + 1)):
        np.add.at(blocks, (block[i[mine]], local[i[mine]], local[j[mine]]), values[mine])
    negative, reduced = 0, np.zeros((m, m))
    for k in range(count.size):
        try:
            reduced = square[k] - (cross[k] @ np.linalg.solve(reduced, cross[k].T) if k else 0.0)
        except np.linalg.LinAlgError:
            return None
        negative += int((np.linalg.eigvalsh(reduced) < 0).sum())
    return negative - active.size
