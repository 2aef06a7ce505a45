"""The pieces of the rods of a solution, on which beta and beta_t are Chebyshev series in time, for observables.

If the method computes the orbit, the pieces are the panels or steps of the orbit, which are graded towards saddles;
each counts as often as the rod passes it, and the panel in which the rod ends is cut there. Elsewhere the pieces lie
between neighbouring stations: quintic polynomials through beta, beta_t and their rates, which the equation gives.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as C

from ..core.measures import NODES, station_series
from ..numerics.arrays import Array, Booleans, Integers
from ..numerics.chebyshev import basis, through
from ..orbits.marched_orbit import MarchedOrbit
from ..orbits.periodic_orbit import cover
from ..orbits.potential import Loads, slope_rate
from ..orbits.shape_arrays import ShapeArrays
from ..problem.dimensionless import Reduced

# of a block; with 192 a case of 50 us takes 3 us more for the calls, with 48 `orbit` takes 1.5 times as long. x10: ten
# times the memory of their steps, 9 MB here
CASES = 512
# rad between two stations: they show no shape, and the bends of such a polynomial take seconds. x10: so they do
_WILDEST = 100.0
COLUMNS = ("case", "row", "low", "high", "time", "count", "begin")  # fields of each piece


@dataclass(frozen=True, eq=False)
class SolutionPieces:
    """Q pieces of the rods of B problems.

    series: (P, 2, N), Chebyshev coefficients of beta and |beta_t| on panels; where loads vary along the rods (P, 7, N),
    also of lam, mu, phi, the weight across times cos(alpha), and what friction divides the contact by.
    case: (Q,), of which problem. row: (Q,),
    on which panel. low, high: (Q,), from where to where on it, in [-1, 1]. time: (Q,), length in t. count: (Q,), how
    often the rod passes the piece. begin: (Q,), the t at which it first enters the piece. monotone: whether beta does
    not turn back on any piece, as on those of an orbit.
    """

    problem: Reduced
    series: Array
    case: Integers
    row: Integers
    low: Array
    high: Array
    time: Array
    count: Array
    begin: Array
    monotone: bool = False

    def take(self, index: Any) -> "SolutionPieces":
        """The pieces that an index picks."""
        return replace(self, **{name: getattr(self, name)[index] for name in COLUMNS})


def join_pieces(parts: Sequence[SolutionPieces], problem: Reduced) -> SolutionPieces:
    """Pieces one after the other, as those of `problem`."""
    if len(parts) == 1:
        return replace(parts[0], problem=problem)
    N = max(p.series.shape[2] for p in parts)
    padded = [np.pad(p.series, ((0, 0), (0, 0), (0, N - p.series.shape[2]))) for p in parts]
    before = np.cumsum([0, *(p.series.shape[0] for p in parts)])
    row = np.concatenate([p.row + k for p, k in zip(parts, before, strict=False)])
    rest = {name: np.concatenate([getattr(p, name) for p in parts]) for name in COLUMNS if name != "row"}
    return SolutionPieces(problem, np.concatenate(padded), row=row, monotone=all(p.monotone for p in parts), **rest)


def blocks(cases: Integers) -> Iterator[Integers]:
    """Cases in blocks, the numbers of each."""
    for start in range(0, cases.size, CASES):
        yield cases[start : start + CASES]


def pieces_of(sol: ShapeArrays, cases: Integers, until: float = 1.0, step: int = 1) -> SolutionPieces:
    """The pieces of some of the cases, numbered from 0, of the first share `until` of their length.

    cases: numbers of cases, rising. step: where no orbit is known, every `step`-th station is used.
    """
    if sol.trajectory.shapes is not None:
        return of_nodes(sol, cases, until)
    if sol.trajectory.orbit is None:
        return of_stations(sol, cases, step, until)
    return of_orbit(sol.trajectory.orbit, cases, until)


def of_nodes(sol: ShapeArrays, cases: Integers, until: float = 1.0) -> SolutionPieces:
    """The pieces of rods whose loads vary along them: the stretches between their nodes."""
    x, parts, problem = basis(NODES), [], sol.problem.take(cases)
    for k, i in enumerate(cases.tolist()):
        shape = sol.trajectory.shapes.of(i)
        if shape is None:
            still = _still(problem, np.array([k]), until * problem.span[[k]])
            parts.append(replace(still, series=np.pad(still.series, ((0, 0), (0, 5), (0, 0)), constant_values=1.0)))
            continue
        values = shape.local_values(shape.between(x.nodes))
        share = np.clip((until * shape.t[-1] - shape.t[:-1]) / np.diff(shape.t), 0, 1)
        row = np.flatnonzero(share > 0)
        ones, share, time = np.ones(row.size), share[row], np.diff(shape.t)[row]
        series = through(values.reshape(-1, NODES), x.analyse).reshape(values.shape)
        columns = np.full(row.size, k), row, -ones, 2 * share - 1, share * time, ones, shape.t[row]
        parts.append(SolutionPieces(problem, series, *columns))
    return join_pieces(parts, problem)


def of_orbit(orbit: Any, cases: Integers, until: float = 1.0) -> SolutionPieces:
    """The pieces of some of the problems of an `Orbit` or a `Swing`, of the first share `until` of their length."""
    if not isinstance(orbit, MarchedOrbit):
        return _of_panels(orbit, cases, np.arange(cases.size), cases, until)
    lost = orbit.lost[cases]
    pieces = [_of_steps(orbit, cases, np.flatnonzero(~lost), until)] if not lost.all() else []
    if lost.any() and orbit.rest is not None:
        pieces.append(_of_panels(orbit.rest, orbit.in_rest[cases[lost]], np.flatnonzero(lost), cases, until, orbit))
    return join_pieces(pieces, orbit.problem.take(cases))


def _of_panels(
    orbit: Any, rows: Integers, case: Integers, cases: Integers, until: float, whole: Any = None
) -> SolutionPieces:
    """The pieces of the problems `rows` of an `Orbit`, which are the problems `case` of the block."""
    panels, problem = orbit.panels, orbit.problem.take(rows)
    arcs_of_case = (2 * rows[:, None] + [0, 1]).reshape(-1)
    arcs = orbit.first[arcs_of_case], orbit.count[arcs_of_case], orbit.duration[arcs_of_case]
    covered = cover(problem.span * until, orbit.kind[rows], *arcs, orbit.since, panels.duration)
    series = panels.series[:, :2].copy()
    series[:, 0, 0] += panels.base
    pieces = _cover(problem, series, covered, until)
    block = (orbit if whole is None else whole).problem.take(cases)
    return replace(pieces, problem=block, case=case[pieces.case])


def _of_steps(orbit: MarchedOrbit, cases: Integers, case: Integers, until: float) -> SolutionPieces:
    """The pieces of the problems `case` of a block of a marched orbit: its steps."""
    mine = orbit.take(cases[case])
    steps, first, count = mine.steps, mine.found["first"], mine.found["count"]
    arcs = np.stack([first, first + count[:, 0]], axis=1), count, np.stack([mine.ahead, mine.back], axis=1)
    covered = cover(mine.problem.span * until, mine.kind, *arcs, steps.since, steps.width)
    pieces = _cover(mine.problem, steps.angles, covered, until)
    return replace(pieces, problem=orbit.problem.take(cases), case=case[pieces.case])


def _cover(problem: Reduced, series: Array, covered: tuple[Array, ...], until: float) -> SolutionPieces:
    """The pieces that the rods cover, on panels with these series, up to a share of their length."""
    pieces = SolutionPieces(problem, series, **dict(zip(COLUMNS, covered, strict=True)), monotone=True)
    still = np.flatnonzero(np.bincount(pieces.case, minlength=problem.size) == 0)  # nothing moves
    if still.size:
        pieces = join_pieces([pieces, _still(problem, still, until * problem.span[still])], problem)
    return pieces


def _still(problem: Reduced, case: Array, time: Array, speed: Array | float = 0.0) -> SolutionPieces:
    """Rods of constant angle, each one piece that lasts `time`."""
    series = np.zeros((case.size, 2, 1))
    series[:, 0, 0], series[:, 1, 0] = problem.beta0[case], speed
    ones = np.ones(case.size)
    return SolutionPieces(problem, series, case, np.arange(case.size), -ones, ones, time, ones, 0 * ones, monotone=True)


def of_stations(sol: ShapeArrays, cases: Integers, step: int = 1, until: float = 1.0) -> SolutionPieces:
    """The pieces between neighbouring stations of some of the cases, or between every `step`-th of them, up to the
    share `until` of the length."""
    problem, n = sol.problem.take(cases), sol.t.shape[1]
    kept = np.unique([*range(0, n, step), n - 1])
    t, beta, rate = (v[cases][:, kept] for v in (sol.t, sol.trajectory.beta, sol.trajectory.dbeta))
    B, case = t.shape[0], np.repeat(np.arange(t.shape[0]), max(t.shape[1] - 1, 0))
    time = np.diff(t, axis=1).reshape(-1)
    series = station_series(np.stack([problem.lam, problem.mu, problem.phi], axis=1), t, beta, rate)
    with np.errstate(over="ignore", invalid="ignore"):
        wild = np.abs(series[:, 0, 1:]).sum(axis=1) > _WILDEST
    series[np.isin(case, case[wild])] = np.nan
    row, ones = np.arange(time.size), np.ones(time.size)
    begin = t[:, :-1].reshape(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.clip((until * problem.span[case] - begin) / time, 0, 1) if until < 1 else ones
    pieces = SolutionPieces(problem, series, case, row, -ones, 2 * share - 1, share * time, ones, begin)
    pieces = pieces.take((time > 0) & (share > 0))
    short = np.flatnonzero(np.bincount(pieces.case, minlength=B) == 0)
    if not short.size:
        return pieces
    points = _still(replace(problem, beta0=beta[:, 0]), short, until * problem.span[short], rate[short, 0])
    return join_pieces([pieces, points], problem)


def off_between(sol: ShapeArrays, cases: Integers) -> Array:
    """How far beta between the stations may be off, (b,): as far as it is at every other station without that one."""
    n = sol.t.shape[1]
    t, beta = sol.t[cases], sol.trajectory.beta[cases]
    off = np.zeros(t.shape[0])
    if n < 3:
        return off
    fewer, many = of_stations(sol, cases, 2), n // 2  # intervals of a case
    fewer = fewer.take((fewer.row < t.shape[0] * many) & (2 * (fewer.row % many) + 1 < n - 1))
    left_out = fewer.case, 2 * (fewer.row % many) + 1
    x = 2 * (t[left_out] - fewer.begin) / fewer.time - 1
    between = C.chebval(np.clip(x, -1, 1), fewer.series[fewer.row, 0].T, tensor=False)
    np.fmax.at(off, fewer.case, np.abs(between - beta[left_out]))
    return off


def is_resolved(sol: ShapeArrays) -> Booleans:
    """Whether the stations of each case cover its rod and resolve every bend that the loads allow, (B,)."""
    t, beta, span = sol.t, sol.trajectory.beta, sol.problem.span
    column = Loads.columns(sol.problem)
    with np.errstate(invalid="ignore", over="ignore"):
        quickest = np.sqrt(np.abs(slope_rate(column, beta)).max(axis=1))
        swift = np.abs(sol.trajectory.dbeta).max(axis=1)
        step = np.diff(t, axis=1).max(axis=1, initial=0.0)
        dense = step * np.maximum(np.maximum(quickest, swift), 1) <= 1  # in units of 1/sqrt(|H'|)
    return dense & (t[:, 0] == 0) & (t[:, -1] >= span * (1 - 1e-12)) & (t.shape[1] >= 5)
