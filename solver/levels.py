"""How long the ways between two angles take, as functions of the level: what an ends problem comes down to.

An orbit of level eta that joins beta(0) to beta(L) swings n times between its turning points, leaving upward or
downward and arriving upward or downward. Its length in t is a sum of times from both angles to the turning points;
the equilibria are the levels at which that sum is the rod's.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .chebyshev import basis
from .course import LIBRATION, ROTATION, course
from .landscape import TAU, Extrema, Well, extrema, potential, slope, slope_rate
from .panels import panelled
from .reduced import Array, Reduced

UP, DOWN = 1, -1
_FINEST = 650.0  # gaps down to exp(-650) of the interval, as far as a float reaches


@dataclass(frozen=True, eq=False)
class Ladder:
    """Levels between two neighbouring heights of the landscape, seen from one of them: eta = G(pin) + sign exp(y).

    y: (M,), falling towards the pin.
    """

    pin: float
    sign: float
    y: Array


def many(problem: Reduced, count: int, **changed: Array) -> Reduced:
    """One problem, `count` times over, with some fields changed."""
    fields: dict[str, Any] = {k: v if v is None else np.repeat(v, count) for k, v in vars(problem).items()}
    return Reduced(**{**fields, **changed})


def ladders(problem: Reduced, found: Extrema) -> list[Ladder]:
    """Ladders that together cover every level of one ends problem."""
    assert problem.betaL is not None
    ends = np.array([problem.beta0[0], problem.betaL[0]])
    ends -= TAU * np.round(ends / TAU)
    ends = np.where(ends >= np.pi, ends - TAU, ends)
    angles = np.concatenate([found.beta[0, : found.count[0]], ends])
    heights = potential(problem, angles)
    lowest = heights[-2:].max()
    order = np.argsort(heights)
    angles, heights = angles[order], heights[order]
    keep = heights >= lowest - 1e-14 * (1 + abs(lowest))
    angles, heights = angles[keep], heights[keep]
    out: list[Ladder] = []
    scale = 1 + np.abs(heights).max()
    for k in range(heights.size - 1):
        width = heights[k + 1] - heights[k]
        if width > 1e-13 * scale:
            start = np.log(width / 2)
            out.append(Ladder(float(angles[k]), 1.0, start - _rungs(problem, angles[k])))
            out.append(Ladder(float(angles[k + 1]), -1.0, start - _rungs(problem, angles[k + 1])))
    way = float(problem.betaL[0] - problem.beta0[0])
    if way:  # above every saddle only a rod that turns all the way can join the ends
        top = np.log((2 * way / problem.span[0]) ** 2 + 1e-3 * scale)
        out.append(Ladder(float(angles[-1]), 1.0, top - _rungs(problem, angles[-1])))
    return out


def _rungs(problem: Reduced, pin: float) -> Array:
    """Steps down in log(gap): as far as the time next to a saddle can grow to the rod's length.

    The first goes up, so that two ladders that meet overlap and no fold falls between them.
    """
    rate = float(slope_rate(problem, np.array([pin]))[0])
    deepest = 34.0
    if rate < 0:
        deepest = min(_FINEST, 45 + 1.2 * np.sqrt(-rate) * float(problem.span[0]))
    dense = np.arange(-0.25, 8, 0.25)
    rest = [8.0]
    while rest[-1] < deepest:
        rest.append(rest[-1] + max(0.75, 0.15 * rest[-1]))
    return np.concatenate([dense, rest])


@dataclass(frozen=True, eq=False)
class Ways:
    """Times at M levels: from beta(0) up and down to the turning points, and from beta(L); (M,) each, NaN where the
    level does not join the two angles. direct: the way without a turn, for orbits that have no turning points."""

    up: Array
    down: Array
    up_far: Array
    down_far: Array
    direct: Array

    @property
    def period(self) -> Array:
        return 2 * (self.up + self.down)

    def length(self, leaving: Any, arriving: Any, swings: Any) -> Array:
        """Length of the orbit that passes `swings` whole periods and the way in the given directions, (M,)."""
        base = np.where(
            np.equal(leaving, UP),
            np.where(np.equal(arriving, UP), self.down_far - self.down, self.up + self.up_far),
            np.where(np.equal(arriving, UP), self.down + self.down_far, self.down - self.down_far),
        )
        return np.where(np.isnan(self.direct), base + swings * self.period, self.direct)


def ways(problem: Reduced, pin: Array, gap: Array, tol: float) -> tuple[Ways, Array]:
    """The times at levels G(pin) + gap, (M,) each, of one problem; and beta_t(0)^2 there."""
    assert problem.betaL is not None
    M = pin.size
    start = many(problem, M)
    v2 = [
        _speed2(start, pin, gap, many(problem, M, beta0=np.full(M, b)).beta0)
        for b in (problem.beta0[0], problem.betaL[0])
    ]
    joins = (v2[0] > 0) & (v2[1] > 0)
    way = float(problem.betaL[0] - problem.beta0[0])
    sense = UP if way >= 0 else DOWN
    ends = [problem.beta0[0], problem.betaL[0]][: 2 if way else 1]  # seen from one alone where they are the same
    n = len(ends)
    slope0 = sense * np.sqrt(np.where(joins, np.stack(v2[:n]), 1.0)).reshape(-1)
    both = many(problem, n * M, beta0=np.repeat(ends, M), betaL=None, dbeta0=slope0)  # type: ignore[arg-type]
    course_ = course(both, (np.tile(pin, n), np.tile(gap, n)))
    panels = panelled(both, course_, basis(16) if tol > 1e-9 else basis(22), 0.7, 0.01 * tol, times_only=True)
    total = np.bincount(panels.part, weights=panels.duration, minlength=2 * n * M).reshape(n, M, 2)
    total, kind = (np.broadcast_to(v, (2, *v.shape[1:])) for v in (total, course_.kind.reshape(n, M)))
    ahead, back = total[..., 0], total[..., 1]
    up, down = (ahead, back) if sense == UP else (back, ahead)
    joins &= kind[0] == kind[1]
    swings = joins & (kind[0] == LIBRATION)
    if way:
        swings &= _same_well(both, course_, panels, M)
    turns = joins & (kind[0] == ROTATION) & (way != 0)
    direct = np.full(M, np.nan)
    if turns.any():
        direct[turns] = _direct(both, panels, M)[turns]
    there, back_, there_far, back_far = (np.where(swings, v, np.nan) for v in (up[0], down[0], up[1], down[1]))
    return Ways(there, back_, there_far, back_far, direct), np.where(joins, v2[0], np.nan)


def _speed2(problem: Reduced, pin: Array, gap: Array, beta: Array) -> Array:
    """beta_t^2 at beta on the level G(pin) + gap, (M,); relative accuracy next to the pin."""
    x = beta - pin
    x = x - TAU * np.round(x / TAU)
    well = Well.about(problem, pin)
    linear = potential(problem, pin) - potential(problem, beta)
    # the pin is an extremum of G, or one of the two ends itself
    near = np.where(np.abs(x) < 1, well.drop(x[:, None])[:, 0], linear)
    at_extremum = np.abs(slope(problem, pin)) < 1e-9 * (
        1 + np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi)
    )
    return gap + np.where(x == 0, 0.0, np.where(at_extremum, near, linear))


def _same_well(both: Reduced, way: Any, panels: Any, M: int) -> NDArray[np.bool_]:
    """Whether the orbits from both ends turn at the same angles, (M,)."""
    last = np.full((2, M, 2), np.nan)
    end = panels.series[:, 0].sum(axis=1)
    last.reshape(-1)[panels.part] = end  # the last panel of each part is written last
    first, second = np.sort(np.where(np.isnan(last), both.beta0.reshape(2, M, 1), last), axis=2)
    return np.abs(first - second).max(axis=1) < 1e-6


def _direct(both: Reduced, panels: Any, M: int) -> Array:
    """Time from beta(0) to beta(L) on orbits that turn all the way, (M,): up to the next extremum after beta(L), less
    the time from beta(L) to it."""
    found = extrema(both)
    m = int(found.count[0])
    passed = abs(_interval(both, found, M) - _interval(both, found, 0))
    rounds, rest = divmod(passed, m)
    forward = panels.part % 2 == 0
    index = panels.part // 2
    first = forward & (index < M) & (panels.rank <= rest)
    near = forward & (index >= M) & (panels.rank == 0)
    to_mark = np.bincount(index[first], weights=panels.duration[first], minlength=2 * M)[:M]
    from_far = np.bincount(index[near], weights=panels.duration[near], minlength=2 * M)[M:]
    whole = np.bincount(index[forward], weights=panels.duration[forward], minlength=2 * M)[:M]
    return to_mark - from_far + rounds * whole


def _interval(problem: Reduced, found: Extrema, i: int) -> int:
    """Between which extrema the start of problem i lies: the number of the lower one, counted on through whole turns,
    and told as `course` tells it."""
    beta = problem.beta0[i]
    start = beta - TAU * np.round(beta / TAU)
    start = start - TAU if start >= np.pi else start
    behind = int(np.count_nonzero(found.beta[i] <= start)) - 1
    return behind + int(found.count[i]) * round(float((beta - start) / TAU))
