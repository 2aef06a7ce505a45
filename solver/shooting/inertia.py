"""The Morse index of a rod on nodes: the negative eigenvalues of the Hessian of its action.

The action over nodes is the sum of p' q' - W(q, p') over the stretches, where W generates the map of a stretch from
(q, p) to (q', p'), with q = (beta, alpha, z, gamma) and p = (beta_t, lam, phi, mu). Its second derivatives exist on any
stretch shorter than a conjugate distance, also where a height or a rotation does not change. Eliminating the p, of
which each stretch has four, leaves the energy with its constraints: the index is the number of negative eigenvalues
less that of the p.
"""

import numpy as np

from ..core.banded import count_negatives
from ..core.varying_loads import HALF
from ..numerics.arrays import Array
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q


def index_of(rod: LoadedRod, transfer: Array, scale: Array, stiffness: Array | None = None) -> int:
    """The index from the transfer matrices (N, 8, 8) of the stretches. stiffness: (N + 1, 2), springs at the nodes."""
    N = transfer.shape[0]
    S, P = scale[[BETA, ALPHA, SHORT, ROUND]], scale[[SPEED, Q, PHI, MU]]
    free = np.array(["beta0" not in rod.held, False, False, False])
    held = np.array([name in rod.held for name in ("betaL", "azimuth", "height", "rotation")])
    springs = np.zeros((N + 1, HALF))
    if stiffness is not None:
        springs[:, :2] = stiffness * S[:2] ** 2
    unit = np.concatenate([S, P])
    return count_negatives(transfer, unit, springs, free, held) - HALF * (N - 1) - int(held.sum())
