"""The Morse index of an equilibrium under the ends that are meant.

Under dead loads and between two given angles the index is that of `stability`. Where a moment is given instead of an
angle, directions in which that angle turns are admitted: the index grows by the number of negative eigenvalues of the
stiffness of those ends, d(-beta_t(0), beta_t(L))/d(beta(0), beta(L)). Where a displacement is held instead of its load,
directions are excluded: the index falls by the number of negative eigenvalues of the block of the compliance
d(z, alpha, gamma)/d(phi, lam, mu), at these ends, that belongs to the held displacements.
"""

from dataclasses import replace

import numpy as np

from ..numerics.arrays import Array
from .held_continuation import Stopped, carried
from .held_system import Given, State
from .orbit_rates import NUMBERS, OrbitRates
from .path_orbits import orbit_of
from .stability import jacobi_zeros

_DISPLACEMENTS = ("z", "alpha", "turn")  # in the order of `OrbitRates.compliance`
_DEAD = ("beta0", "betaL", "lam", "mu", "phi")
_BESIDE = 1e-4  # a small moment, in units of A/rho
_DOUBT = 1e-11  # of the largest eigenvalue: a smaller one has no sign


def held_index(rates: OrbitRates, ratio: Array, names: tuple[str, ...], dead: Array) -> Array:
    """The index of B equilibria under held ends, (B,) of floats; NaN where an eigenvalue is zero to rounding.

    names: the five given numbers (`problem.held_ends.HeldProblem.numbers`). dead: (B,), the index under dead loads
    between the equilibrium's own end angles.
    """
    ends = tuple(name for name in names if name.endswith(("beta0", "betaL")))
    free = [k for k, name in enumerate(ends) if name.startswith("d")]
    held = [k for k, name in enumerate(_DISPLACEMENTS) if name in names]
    index = np.asarray(dead, dtype=float).copy()
    if free:
        rows = [NUMBERS.index("dbeta0"), NUMBERS.index("dbetaL")]
        stiffness = rates.response(_DEAD)[:, rows, :2] * np.array([-1.0, 1.0])[:, None]
        index += negative(stiffness[:, free][:, :, free])
    if held:
        index -= negative(rates.compliance(ratio, ends)[:, held][:, :, held])
    return index


def dead_index(rates: OrbitRates, turns: Array) -> Array:
    """The index of B equilibria that are no helices between their own end angles under dead loads, (B,) of floats.

    Of k turning points passed it is k or k - 1, and even where eta(L) = d beta(L)/d beta_t(0) is positive. So a turning
    point at the very end of a hinged rod need not be told from one just outside.
    """
    eta = 1 / rates.response(_DEAD)[:, NUMBERS.index("dbeta0"), 1]
    even = np.where(eta > 0, 1, np.where(eta < 0, 0, np.nan))
    index = np.where(turns % 2 == (1 - even), turns, turns - 1)
    return np.where(np.isnan(even), np.nan, np.maximum(index, 0))


def negative(matrix: Array) -> Array:
    """The number of negative eigenvalues of symmetric matrices (B, n, n), (B,); NaN where one is zero to rounding."""
    out = np.full(matrix.shape[0], np.nan)
    for b in np.flatnonzero(np.isfinite(matrix).all(axis=(1, 2))):
        scale = 1 / np.sqrt(np.maximum(np.abs(matrix[b]).max(axis=1), 1e-300))
        scaled = matrix[b] * scale * scale[:, None]
        values = np.linalg.eigvalsh((scaled + scaled.T) / 2)
        if np.abs(values).min() > _DOUBT * np.abs(values).max():
            out[b] = np.count_nonzero(values < 0)
    return out


def index_of(state: State, wanted: Given) -> float:
    """The Morse index under the held ends; NaN where it is not decided.

    A rod with a hinge at both ends rests at both, so between its own two angles beta_t is a direction of no stiffness.
    Its index is then that of two neighbours, with small moments at both ends, if they agree.
    """
    found = decided_index(state, wanted)
    hinged = [k for k, name in enumerate(wanted.names) if name.startswith("dbeta")]
    if np.isfinite(found) or not hinged:
        return found
    beside = []
    for small in (_BESIDE, -_BESIDE):
        values = wanted.values.copy()
        values[hinged] += small
        near = replace(wanted, values=values)
        moved = carried(state, near)
        beside.append(np.nan if isinstance(moved, Stopped) else decided_index(moved, near))
    return beside[0] if beside[0] == beside[1] else np.nan


def dead_index_of(state: State) -> float:
    """The Morse index under dead loads between its own end angles; NaN where it is not decided."""
    if state.path.helix:
        return float(jacobi_zeros(orbit_of(state.problem, state.path))[0])
    return float(dead_index(state.rates, np.array([state.path.turns]))[0])


def decided_index(state: State, wanted: Given) -> float:
    """The Morse index under the held ends by the rule alone; NaN where an eigenvalue is zero to rounding."""
    dead = np.array([dead_index_of(state)])
    return float(held_index(state.rates, np.array([wanted.ratio]), wanted.names, dead)[0])
