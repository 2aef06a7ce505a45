"""The Morse index of a rod on nodes: the negative eigenvalues of the Hessian of its action.

The action over nodes is the sum of p' q' - W(q, p') over the stretches, where W generates the map of a stretch from
(q, p) to (q', p'), with q = (beta, alpha, z, gamma) and p = (beta_t, lam, phi, mu). Its second derivatives exist on any
stretch shorter than a conjugate distance, also where a height or a rotation does not change. Eliminating the p, of
which each stretch has four, leaves the energy with its constraints: the index is the number of negative eigenvalues
less that of the p.
"""

import numpy as np

from ..core.banded import count_negatives
from ..core.varying_loads import SIZE
from ..numerics.arrays import Array
from .loaded_rod import ALPHA, BETA, MU, PHI, ROUND, SHORT, SPEED, LoadedRod, Q

HALF = SIZE // 2


def canonical(transfer: Array) -> Array:
    """Transfer matrices in the canonical numbers (beta, alpha, z, gamma, beta_t, lam, phi, mu), (N, 8, 8)."""
    to = np.zeros((SIZE, SIZE))  # from the state
    to[0, BETA], to[1, ALPHA], to[2, SHORT], to[3, ROUND], to[3, ALPHA] = 1, 1, -1, 1, -1
    to[4, SPEED], to[5, Q], to[5, MU], to[6, PHI], to[7, MU] = 1, 1, 1, 1, 1
    return np.asarray(to @ transfer @ np.linalg.inv(to))


def generators(transfer: Array) -> tuple[Array, Array, Array]:
    """The second derivatives W_qq, W_qp and W_pp of the stretches by q at their begin and p at their end."""
    M = canonical(transfer)
    B, C, D = M[:, :HALF, HALF:], M[:, HALF:, :HALF], M[:, HALF:, HALF:]
    back = np.linalg.inv(D)
    qq, pp = -back @ C, B @ back
    return (qq + qq.transpose(0, 2, 1)) / 2, back, (pp + pp.transpose(0, 2, 1)) / 2


def index_of(rod: LoadedRod, transfer: Array, scale: Array, stiffness: Array | None = None) -> int:
    """The index from the transfer matrices (N, 8, 8) of the stretches. stiffness: (N + 1, 2), springs at the nodes."""
    N = transfer.shape[0]
    qq, qp, pp = generators(transfer)
    S, P = scale[[BETA, ALPHA, SHORT, ROUND]], scale[[SPEED, Q, PHI, MU]]
    free = np.array(["beta0" not in rod.held, False, False, False])
    held = np.array([name in rod.held for name in ("betaL", "azimuth", "height", "rotation")])
    springs = np.zeros((N + 1, HALF))
    if stiffness is not None:
        springs[:, :2] = stiffness * S[:2] ** 2
    blocks = qq * S[:, None] * S, qp * S[:, None] * P, pp * P[:, None] * P
    return count_negatives(*blocks, S * P, springs, free, held) - HALF * (N - 1) - int(held.sum())
