"""The compiled march of rods whose loads vary along them, and the linear algebra of a chain of stretches: the calls of
`weight_friction.c` and `banded.c` on NumPy arrays."""

from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array, Booleans, Integers
from .library import INT, begin_of, run, share_out, widest

# q: lam - mu; short: t - z; round: gamma + alpha
STATES = ("beta", "dbeta", "alpha", "q", "phi", "mu", "short", "round")
SIZE, ORDER = len(STATES), 20
HALF = SIZE // 2
# columns: by beta and beta_t; by the first six of the begin; by these, the weight along and across, the friction
BY_ANGLE, BY_STATE, BY_ALL = 2, 6, 9
# of the scale of each number: what a step leaves out at most, a tenth of rounding. x10: as large as rounding, which the
# estimates do not count
TRUNCATION = 1e-17
READ = [0, 1, 2, 3, 5, 4, 6, 7]  # the place of each state in what a march with `judge` reads: beta .. q, mu, phi, ..


@dataclass(frozen=True, eq=False)
class March:
    """What `march` found of N stretches.

    end: (N, SIZE); NaN where the march is lost. columns: (N, SIZE, columns), derivatives of the end. growth: (N, 6),
    the largest |d beta| by each number of the begin. errors: (N, 2), standard deviations of beta and alpha at their
    largest. out: the states at the stations. steps: (N,).
    """

    end: Array
    columns: Array
    growth: Array
    errors: Array
    out: Array
    steps: Integers


def march(
    rods: Array,
    scale: Array,
    begin: Array,
    length: Array,
    columns: int = 0,
    first: Integers | None = None,
    stations: Array | None = None,
    shorter: float = 1.0,
    deep: int = ORDER,
    judge: bool = False,
    truncation: Array | float = TRUNCATION,
    lanes: int = 0,
) -> March:
    """March N stretches by Taylor series, as many at once as the registers hold.

    Parameters
    ----------
    rods, scale : arrays, (7,) and (SIZE,), or (N, 7) and (N, SIZE)
        A/C, omega cos(theta), omega sin(theta), sigma mu_f, the way as of `Cylinder.sense`, a/rho, 1 outside or -1;
        the sizes of the numbers of the state, by which the error of a step is judged.
    begin : array, (N, SIZE)
        The states at which the stretches begin.
    length : array, (N,)
        Their lengths in t.
    columns : int
        0, BY_ANGLE, BY_STATE or BY_ALL: how many derivatives are marched too.
    first, stations : arrays, (N + 1,) and (first[-1],)
        Stations first[i] .. first[i + 1] are those of stretch i, in t from its begin, rising. `out` is (first[-1],
        SIZE); with `judge` it is (SIZE, first[-1]), with mu before phi.
    shorter : float
        A factor of all steps.
    deep : int
        The order of the series of the derivatives; with `judge` it is low.
    judge : bool
        Whether the errors are estimated, with columns BY_ANGLE.
    truncation : float or array, (N, 1)
        What a step may leave out, of the scales.
    lanes : int
        How many stretches at once, 0 for the most.
    """
    count = length.size
    rods, begin, length = (np.ascontiguousarray(v, dtype=float) for v in (rods, begin, length))
    goal, alike = np.ascontiguousarray(scale * truncation, dtype=float), rods.ndim == 1
    end, variations = np.empty((count, SIZE)), np.empty((count, SIZE, columns))
    growth, steps, errors = np.empty((count, BY_STATE)), np.empty(count, dtype=np.int64), np.empty((count, 2))
    room = 0 if stations is None else stations.size
    out = np.empty((SIZE, room) if judge else (room, SIZE))
    places = begin_of(out) + 8 * (room * np.array(READ) if judge else np.arange(SIZE))
    if stations is not None:
        stations, first = np.ascontiguousarray(stations, dtype=float), np.ascontiguousarray(first, dtype=np.int64)
    derived = (variations, growth) if columns else (None, None)
    task = (
        rods, goal, alike, float(shorter), begin, length, columns, deep, end, *derived, errors if judge else None,
        first, stations, places, 1 if judge else SIZE, steps, lanes, widest(),
    )  # fmt: skip
    share_out(lambda a, b: run("rod_loaded", a, b, *task, result=INT), count)
    return March(end, variations, growth, errors, out, steps)


def solve_chain(
    transfer: Array, scale: Array, start: Array, end: Array, stiffness: Array | None, right: Array
) -> Array | None:
    """The scaled changes (8 (N + 1), m) for right sides (8 (N + 1), m); None where the equations are singular.

    transfer: (N, 8, 8), of the stretches. scale: (8,), of the states. start, end: (4, 8), rows of the conditions.
    stiffness: (N + 1, 2), of springs at the nodes, or None.
    """
    changes = np.array(right, dtype=float, order="C")
    blocks = (np.ascontiguousarray(v, dtype=float) for v in (transfer, scale, start, end))
    springs = None if stiffness is None else np.ascontiguousarray(stiffness, dtype=float)
    columns = changes.size // changes.shape[0]
    return None if run("rod_solve_chain", len(transfer), *blocks, springs, columns, changes) else changes


def count_negatives(transfer: Array, unit: Array, springs: Array, free: Booleans, held: Booleans) -> int:
    """The number of negative eigenvalues of the Hessian of an action over nodes; `rod_negatives` says of which."""
    blocks = (np.ascontiguousarray(v, dtype=float) for v in (transfer, unit, springs))
    flags = (np.ascontiguousarray(v, dtype=np.int64) for v in (free, held))
    return int(run("rod_negatives", len(transfer), *blocks, *flags, result=INT))
