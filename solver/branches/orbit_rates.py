"""The numbers of equilibria and the linear equations between their changes, regular at folds and next to saddles.

One equilibrium is an orbit from one end to the other. Its numbers are the two end angles, beta_t at both ends, the
integrals of sin(beta), sin(beta) cos(beta) and cos(beta), the loads and the length. A change of the orbit has five
parts: a0 along its flow, g0 of its level (`orbit.variations`), and those of the three loads. Every number answers them
linearly. Any five numbers may be held; the five parts then follow from five equations. Two held end angles and three
given loads make those of a dead-load problem, which are singular at its folds; with held displacements or end moments
the equations are other ones, and their singular points are the folds of that problem.

The level of `variations` counts from the critical point to which the orbit comes closest, so next to a saddle only the
column of g0 is large, by one common factor. Columns are scaled before the equations are solved.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..core import branch_calls as core
from ..core.library import numbers_of
from ..numerics.arrays import ROUNDED, Array, Columns
from ..numerics.roots import solve
from ..orbits.boundary import CUTTING, STRETCH, Path
from ..orbits.periodic_orbit import Pin
from ..orbits.variations import HOW as VARIED
from ..orbits.variations import POINTS, Change, HelixVariations, Variations
from ..problem.dimensionless import EndsProblem, Reduced, StartProblem

NUMBERS = ("beta0", "betaL", "dbeta0", "dbetaL", "alpha", "swirl", "z", "lam", "mu", "phi", "y")
HOW = CUTTING, VARIED._replace(stretch=STRETCH)


@dataclass(frozen=True, eq=False)
class OrbitRates(Columns):
    """The numbers of B equilibria, and how they answer a change.

    problem: the ends problems that the orbits solve, span: the lengths at which their paths meet beta(L). values:
    (B, 11), the `NUMBERS`: end angles, beta_t at both ends, the integrals of sin(beta), sin(beta) cos(beta) and
    cos(beta) over t, the loads, and y of the path (`boundary.Path`). rows: (B, 11, 5), what a unit of each
    part of a change adds to them; NaN for y of a helix. by_span: (B, 11), what a unit of the length adds.
    """

    problem: EndsProblem
    values: Array
    rows: Array
    by_span: Array

    @property
    def length(self) -> Array:
        """The lengths T at which the paths meet beta(L), (B,)."""
        return self.problem.span

    def value(self, name: str) -> Array:
        """One of the `NUMBERS`, (B,)."""
        return np.asarray(self.values[:, NUMBERS.index(name)])

    def rows_of(self, names: Sequence[str], ratio: Array | float) -> tuple[Array, Array]:
        """The rows of k of the `NUMBERS` or of "turn" = ratio mu span - swirl, (B, k, 5), and what a unit of the length
        adds to them, (B, k). ratio: A/C, (B,) or one."""
        at = [NUMBERS.index("swirl" if name == "turn" else name) for name in names]
        rows, by_span = self.rows[:, at], self.by_span[:, at]
        if "turn" in names:
            k, mu = names.index("turn"), NUMBERS.index("mu")
            rows[:, k] = (ratio * self.length)[:, None] * self.rows[:, mu] - rows[:, k]
            by_span[:, k] = ratio * self.values[:, mu] - by_span[:, k]
        return rows, by_span

    def parts(self, names: Sequence[str], ratio: Array | float = np.nan) -> Array:
        """The five parts by a unit of each of five given numbers, as of `rows_of`, and last of the length, (B, 5, 6).

        NaN where the five do not determine the equilibrium: at a fold.
        """
        rows, by_span = self.rows_of(names, ratio)
        forced = np.broadcast_to(np.eye(5, 6), (len(rows), 5, 6)).copy()
        forced[:, :, 5] = -by_span
        return solve(rows, forced)

    def compliance(self, ratio: Array, ends: Sequence[str] = ("beta0", "betaL")) -> Array:
        """d(z, alpha, gamma)/d(phi, lam, mu) with two numbers of the ends held: symmetric, (B, 3, 3).

        ratio: A/C, (B,): the rotation is gamma = ratio mu span - swirl.
        """
        with np.errstate(invalid="ignore", over="ignore"):
            parts = self.parts((*ends, "phi", "lam", "mu"))[:, :, 2:5]
            return np.asarray(self.rows_of(("z", "alpha", "turn"), ratio)[0] @ parts)


def orbit_rates(problem: EndsProblem, paths: Sequence[Path]) -> OrbitRates:
    """The numbers and the equations of B equilibria.

    Parameters
    ----------
    problem : EndsProblem
        B ends problems.
    paths : sequence of Path
        The path of each. Its level need not be that at which the path has the length of the rod: the orbits are those
        of the lengths that the paths have. The numbers are NaN where no orbit of a path joins the ends.

    Returns
    -------
    OrbitRates
    """
    B, numbers = problem.size, numbers_of(problem)
    values, rows, by_span, span = np.empty((B, 11)), np.empty((B, 11, 5)), np.empty((B, 11)), np.empty(B)
    for i, path in enumerate(paths):
        if path.helix:
            still = rates_of_helices(problem.take(slice(i, i + 1)))
            values[i], rows[i], by_span[i], span[i] = still.values[0], still.rows[0], still.by_span[0], still.length[0]
        else:
            values[i], rows[i], by_span[i], span[i] = core.orbit_rates(numbers[i], path, POINTS, HOW)
    return OrbitRates(replace(problem, span=span), values, rows, by_span)


def start_rates(problem: StartProblem, pin: Pin | None = None) -> OrbitRates:
    """The numbers and the equations of one orbit that is given by its start, at its far end.

    They are regular where the rod is at rest at an end, or at both: there the length at which an orbit meets beta(L)
    has no derivative. y has neither value nor row. NaN for a helix, and where the core cannot follow the orbit.

    pin: the level, if beta_t(0) does not tell it.
    """
    numbers = numbers_of(problem)[0]
    numbers[5] = numbers[5] if abs(numbers[5]) > ROUNDED else 0.0  # a start that moves so slowly is one at rest
    pinned = None if pin is None else np.concatenate(pin)
    answer = core.start_rates(numbers, pinned, POINTS, HOW[1])
    values, rows, by_span = (
        (np.full(11, np.nan), np.full((11, 5), np.nan), np.full(11, np.nan)) if answer is None else answer[:3]
    )
    values[NUMBERS.index("dbeta0")] = problem.dbeta0[0]  # not as it is read from the orbit
    rows[NUMBERS.index("y")] = by_span[NUMBERS.index("y")] = np.nan
    return OrbitRates(problem.with_end(values[[NUMBERS.index("betaL")]]), values[None], rows[None], by_span[None])


def rates_of_variations(problem: EndsProblem, varied: Variations) -> OrbitRates:
    """The numbers of orbits that are no helices at t = span, at rest at an end too, and their rows but that of y."""
    t, unit = ends_of(problem), np.broadcast_to(np.eye(5), (problem.size, 5, 5))
    ends, (_, _, turned, risen) = varied.change(t, unit), varied.orbit.at(t)
    v, H = ends.beta[..., 0].T, -ends.rate[..., 0].T  # by a unit of a0, which is one of time
    return _assemble(problem, ends, v, H, np.stack([turned, varied.orbit.swirl(t), risen])[..., 1])


def ends_of(problem: Reduced) -> Array:
    """t at the two ends, (B, 2)."""
    return np.asarray(problem.span[:, None] * np.array([0.0, 1.0]))


def rates_of_helices(problem: EndsProblem) -> OrbitRates:
    """The numbers of helices at t = span, and their rows but that of y."""
    s, c, none = np.sin(problem.beta0), np.cos(problem.beta0), np.zeros((2, problem.size))
    with np.errstate(all="ignore"):  # beside a critical point and for long rods some terms overflow and are not taken
        ends = HelixVariations(problem, held=True).units(ends_of(problem))
    rates = _assemble(problem, ends, none, none, np.stack([s, s * c, c]) * problem.span)
    y = NUMBERS.index("y")
    rates.values[:, y], rates.rows[:, y] = -np.inf, np.nan
    return rates


def _assemble(problem: EndsProblem, ends: Change, v: Array, H: Array, integrals: Array) -> OrbitRates:
    """ends: the changes at the two ends, (B, 2, 5). v, H: at the two ends, (2, B). integrals: (3, B)."""
    rows, by_span = np.zeros((problem.size, len(NUMBERS), 5)), np.zeros((problem.size, len(NUMBERS)))
    rows[:, :2], rows[:, 2:4] = ends.beta, ends.rate
    rows[:, 4:7] = ends.integrals[:, 1].swapaxes(1, 2) * np.array([1, -1, 1])[:, None]
    rows[:, [7, 8, 9], [2, 3, 4]] = 1
    s, c = np.sin(problem.betaL), np.cos(problem.betaL)
    by_span[:, [1, 3, 4, 5, 6]] = np.stack([v[1], -H[1], s, s * c, c], axis=1)
    loads = problem.lam, problem.mu, problem.phi
    values = np.stack([problem.beta0, problem.betaL, *v, *integrals, *loads, np.zeros(problem.size)], axis=1)
    return OrbitRates(problem, values, rows, by_span)
