"""The compiled march of rods whose loads vary along them: the calls of `varying_loads.c` on NumPy arrays."""

import ctypes
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array, Integers
from .library import begin_of, function, share_out

# q: lam - mu; short: t - z; round: gamma + alpha
STATES = ("beta", "dbeta", "alpha", "q", "phi", "mu", "short", "round")
SIZE = len(STATES)
BY_ANGLE, BY_STATE, BY_ALL = (
    2,
    6,
    9,
)  # columns: by beta and beta_t; by the first six of the begin; by these, the weight along and across, the friction
_TRUNCATION = 1e-17  # of the scale of each number, in a step

_INT, _AT, _FLOAT = ctypes.c_int64, ctypes.c_void_p, ctypes.c_double


@dataclass(frozen=True, eq=False)
class March:
    """What `march` found of N stretches.

    end: (N, SIZE); NaN where the march is lost. columns: (N, SIZE, columns), derivatives of the end. growth: (N, 6),
    the largest |d beta| by each number of the begin. out: (stations, SIZE). steps: (N,).
    """

    end: Array
    columns: Array
    growth: Array
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
) -> March:
    """March N stretches by Taylor series.

    Parameters
    ----------
    rods, scale : arrays, (7,) and (SIZE,), or (N, 7) and (N, SIZE)
        A/C, omega cos(theta), omega sin(theta), sigma mu_f, 1 for a rod that turns in place, a/rho, 1 outside or -1;
        the sizes of the numbers of the state, by which the error of a step is judged.
    begin : array, (N, SIZE)
        The states at which the stretches begin.
    length : array, (N,)
        Their lengths in t.
    columns : int
        0, BY_ANGLE, BY_STATE or BY_ALL: how many derivatives are marched too.
    first, stations : arrays, (N + 1,) and (first[-1],)
        Stations first[i] .. first[i + 1] are those of stretch i, in t from its begin, rising.
    shorter : float
        A factor of all steps.
    """
    count = length.size
    rods, begin, length = (np.ascontiguousarray(v, dtype=float) for v in (rods, begin, length))
    scale, alike = np.ascontiguousarray(scale, dtype=float), rods.ndim == 1
    end, found = np.empty((count, SIZE)), np.empty((count, SIZE, columns))
    growth, steps = np.empty((count, BY_STATE)), np.empty(count, dtype=np.int64)
    out = np.empty((0 if stations is None else stations.size, SIZE))
    numbers = _INT, _AT, _AT, _INT, _FLOAT, _FLOAT, _AT, _AT, ctypes.c_int, *7 * [_AT]
    call = function("rod_loaded", _INT, *numbers)
    if stations is not None:
        assert first is not None
        stations, first = np.ascontiguousarray(stations, dtype=float), np.ascontiguousarray(first, dtype=np.int64)

    def part(a: int, b: int) -> None:
        def at(array: Array, width: int) -> int:
            return begin_of(array) + 8 * a * width

        rod = at(rods, 0 if alike else 7), at(scale, 0 if alike else SIZE), alike
        stretch = at(begin, SIZE), at(length, 1), columns, at(end, SIZE)
        derived = (at(found, SIZE * columns), at(growth, BY_STATE)) if columns else (None, None)
        read = None if first is None else at(first, 1), None if stations is None else begin_of(stations), begin_of(out)
        call(b - a, *rod, _TRUNCATION, shorter, *stretch, *derived, *read, at(steps, 1))

    share_out(part, count)
    return March(end, found, growth, out, steps)
