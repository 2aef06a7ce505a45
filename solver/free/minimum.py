"""A minimum of the energy of a discrete rod beside its wall: Newton's method sharpens what Uno finds.

Push and gap are then complementary to rounding, so the push, which is a fourth difference of the shape, has no noise.
"""

from functools import cached_property

import numpy as np

from ..numerics.arrays import Array, Integers
from ..numerics.roots import ROUNDS
from .discrete_rod import CONDITIONS, EDGE, HELD_ON, DiscreteRod
from .free_shape import FreeShape
from .program import Effort, Program, Sizes

SHARP = 1e-10  # of the last change of the unknowns: as far as rounding of long meshes allows. x10: a digit less
# steps of Newton's method from another shape before Uno takes over: usual are 3 to 16, and beyond that contacts mostly
# come and go in circles. x10: time
MOST_FOLLOWED = 20
# of what equations leave where rounding, 1e-11 of them, moves a rod that is held with `FIRM`; squared. x10: as good
EVEN = 1e-8
# of the order of the second derivatives: what holds a rod that may turn as a whole. x10: soft motions count as free
FIRM = 1e-6
# of the size of angles: of what leads away from an equilibrium that is no minimum; times. x10: to another minimum than
# the one below
NUDGE, NUDGES = 1e-2, 3
# of the force that bends an edge by the radius, what a gap counts as; least of a derivative. x10: as good; both only
# weigh gaps against pushes
STIFF, TINY = 1e-4, 1e-14


def minimise(
    rod: DiscreteRod, guess: Array, sizes: Sizes, multipliers: Array | None = None, effort: Effort | None = None
) -> FreeShape | None:
    """The minimum near a guess (size,), or beside an equilibrium near it that is no minimum; None where none is found.

    multipliers: of a shape near by, (M,), with which Newton's method alone is tried first. effort: of Uno; any if None.
    Raises `InputError` where Uno is not installed.
    """
    effort = effort or Effort()
    for seed in range(NUDGES + 1):
        newton = Newton(rod, sizes, rod.with_known(guess))
        minimum = None if multipliers is None else newton.equilibrium(multipliers * newton.scale)
        if minimum is None or minimum.unstable != 0:
            rough = newton.minimise(effort)
            minimum = None if rough is None else newton.equilibrium(*rough)
        if minimum is None or not minimum.unstable:
            return minimum
        guess, multipliers = minimum.y.copy(), None
        rod.parts(guess)[0][:] += NUDGE * sizes.turned * np.random.default_rng(seed).normal(size=(rod.edges, 4))
    return None


def free_motion(shape: FreeShape, sizes: Sizes) -> Array | None:
    """How a minimum can move although no force moves it, (size,); None where it is isolated.

    Of such motions the energy has no second derivative: it is below `FIRM`, by rounding; that of others is far above.
    """
    newton, still = Newton(shape.rod, sizes, shape.y), np.zeros(shape.rod.size)
    multipliers, loose = shape.multipliers * newton.scale, np.zeros(shape.multipliers.size)
    loose[newton.wall] = (multipliers[newton.wall] == 0) / TINY
    if not newton.unstable_ways(still, multipliers, loose, -FIRM):
        return None
    bands = newton.matrix(still, multipliers, loose)
    moved = np.random.default_rng(0).normal(size=still.size)
    for _ in range(6):  # inverse iteration, of which each takes a hundredth of the rest
        moved = newton.solve(bands, np.append(moved / np.linalg.norm(moved), 0 * multipliers))[: still.size]
    return moved * newton.unit


def complementarity(a: Array, b: Array) -> tuple[Array, Array, Array]:
    """a + b - (a^2 + b^2)^(1/2), which is 0 where one of a and b is 0 and the other above it (Fischer and Burmeister),
    with its derivatives by a and by b.

    No large numbers are subtracted from each other: far off the wall a gap of 10^6 would leave a push of 10^-10.
    """
    size = np.hypot(a, b) + TINY

    def rest(part: Array, other: Array) -> Array:
        """1 - part/size."""
        return np.where(part > 0, other**2 / (size * (size + np.abs(part))), 1 - part / size)

    return np.where(a + b > 0, 2 * a * b / (size + np.abs(a + b)), a + b - size), rest(a, b), rest(b, a)


class Newton(Program):
    """The equations of a program: stationary energy, and conditions.

    At each node push and gap are complementary, by an equation whose derivatives tell by themselves which of them is 0.
    """

    @cached_property
    def scale(self) -> Array:
        """Of multipliers of the program, over those of the rod, (M,)."""
        return self.unit_of / self.sizes.energy

    @cached_property
    def wall(self) -> slice:
        """Where the conditions of the wall are, if it only pushes."""
        return slice(CONDITIONS * self.rod.edges, -2 if self.rod.side != HELD_ON else CONDITIONS * self.rod.edges)

    @cached_property
    def stiff(self) -> float:
        """What a gap counts as, of a push."""
        return STIFF * self.sizes.across**2 / (self.sizes.energy * self.rod.h**3)

    @cached_property
    def order(self) -> Integers:
        """Where unknowns and conditions stand in the order of the edges, in which the matrix is a narrow band."""
        edge, last = np.arange(self.rod.edges), self.rod.edges - 1
        of_unknowns = np.concatenate([np.repeat(edge, EDGE), np.zeros(4, int), np.full(4, last)])
        of_conditions = [np.repeat(edge, CONDITIONS), edge[:-1], np.full(2, last)]
        return np.argsort(np.argsort(np.concatenate([of_unknowns, *of_conditions]), kind="stable"))

    @cached_property
    def _places(self) -> tuple[int, Integers]:
        """How many bands the matrix has beside its diagonal on each side, and where its entries are among all."""
        n, (rows, columns, _), (above, beside, _) = self.rod.size, self.slopes, self.bends
        lower, diagonal = above != beside, np.arange(self.order.size)
        i = self.order[np.concatenate([above, beside[lower], columns, n + rows, diagonal])]
        j = self.order[np.concatenate([beside, above[lower], n + rows, columns, diagonal])]
        width = int(np.abs(i - j).max())
        return width, (width + i - j) * self.order.size + j

    def matrix(self, z: Array, multipliers: Array, loose: Array, firm: float = FIRM) -> Array:
        """The derivatives of the equations as LAPACK stores bands. loose: how much a condition gives way to its
        multiplier, (M,).

        firm: what is added to the second derivatives of the energy by each unknown.
        """
        above, beside, _ = self.bends
        slopes, bends = -self.jacobian(z), self.hessian(z, 1.0, multipliers)
        values = [bends, bends[above != beside], slopes, slopes, np.full(self.rod.size, firm), -loose]
        (width, places), n = self._places, self.order.size
        bands = np.bincount(places, np.concatenate(values), minlength=(2 * width + 1) * n)
        return bands.reshape(-1, n)

    def solve(self, bands: Array, right: Array) -> Array:
        """What the equations change by right; not finite where the matrix is singular."""
        from scipy.linalg import LinAlgError, solve_banded  # only a search loads SciPy

        width, rows = bands.shape[0] // 2, np.argsort(self.order)
        try:
            return np.asarray(solve_banded((width, width), bands, right[rows], check_finite=False)[self.order])
        except LinAlgError:
            return np.full(right.size, np.nan)

    def equilibrium(self, multipliers: Array, z: Array | None = None, steps: int = 0) -> FreeShape | None:
        """The equilibrium near a guess; None where the steps do not converge.

        z: as Uno found it; None: the guess of the program, a shape of another mesh or time.
        """
        n, last, side = self.rod.size, np.inf, self.rod.side
        most = MOST_FOLLOWED if z is None else ROUNDS
        z, loose = np.zeros(n) if z is None else z, np.zeros(multipliers.size)
        rows, columns, _ = self.slopes
        for _ in range(most):
            missed = self.conditions(z)
            push, gap = side * multipliers[self.wall], self.stiff * side * missed[self.wall]
            equation, by_push, by_gap = complementarity(push, gap)
            by_gap = np.maximum(by_gap, TINY) * self.stiff
            pull = np.bincount(columns, self.jacobian(z) * multipliers[rows], minlength=n) - self.gradient(z)
            missed[self.wall] = side * equation
            left = max(np.abs(pull).max(), np.abs(missed).max())
            loose[self.wall] = by_push / by_gap
            missed[self.wall] /= by_gap
            change = self.solve(self.matrix(z, multipliers, loose), np.append(pull, missed))
            # beyond a change of an unknown by its own size Newton's method diverges
            if not np.isfinite(change).all() or np.abs(change[:n]).max() > 1:
                return None
            z, multipliers, steps, far = z + change[:n], multipliers + change[n:], steps + 1, np.abs(change[:n]).max()
            if far < SHARP or (left < EVEN and far > last / 2):  # rounding ends the progress
                off = side * multipliers[self.wall] <= self.stiff * side * self.conditions(z)[self.wall]
                multipliers[self.wall][off] = 0.0
                loose[self.wall] = off / TINY
                unstable = self.unstable_ways(z, multipliers, loose)
                return FreeShape(self.rod, self.whole(z), multipliers / self.scale, unstable, steps)
            last = far
        return None

    def unstable_ways(self, z: Array, multipliers: Array, loose: Array, firm: float = FIRM) -> int | None:
        """In how many ways an equilibrium is unstable while active conditions stay active. firm: of `matrix`.

        Without such a way it is a minimum. The matrix has a negative eigenvalue for each condition, and one for each
        such way: as many as pivots of an elimination without exchanges. None where that meets a zero, or finds fewer
        than conditions by rounding. A way by which the energy falls less than a rod that may turn as a whole is held
        counts as none.
        """
        from scipy.sparse import dia_array
        from scipy.sparse.linalg import splu

        bands = self.matrix(z, multipliers, loose, firm)
        width, n = bands.shape[0] // 2, self.order.size
        square = dia_array((bands, width - np.arange(2 * width + 1)), shape=(n, n)).tocsc()
        plain = {"SymmetricMode": True, "Equil": False}
        try:
            factors = splu(square, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=plain)
        except RuntimeError:
            return None
        exchanged = (factors.perm_r != factors.perm_c).any()
        ways = int((factors.U.diagonal() < 0).sum()) - multipliers.size
        return None if exchanged or ways < 0 else ways
