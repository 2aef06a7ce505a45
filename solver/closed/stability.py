"""The Morse index of a closed rod: by Bloch phases of the period, and the compliance of one period.

The second variation of the energy at the loads found is S = -d2/dt2 - H'(beta) for periodic changes of beta; closing
holds the integrals of cos(beta) eta and of sin(beta) eta at 0. beta_t is the change that shifts the start and belongs
to the eigenvalue 0. It has two zeros a period, so of the changes that come back after `folds` periods

* those that do not come back after one (the Bloch phases other than 0) have 2 (folds - 1) negative eigenvalues, and no
  constraint touches them: a loop of two folds or more is unstable on the surface;
* those that come back after one have one negative eigenvalue where the period rises with the level, and two where it
  falls; of these the held displacements take away as many as the compliance of a period has negative eigenvalues.

The compliance K = d(azimuth, height)/d(lam, phi) at a fixed period is a Schur complement of the Hessian M of the
action. The section is free to turn, so M3 stays 0; where the ends are glued, twist adds energy that is not negative, so
a loop of index 0 is stable there too.
"""

import numpy as np

from .orbits import start, vary_from

_HELD = [1, 3]  # the rows of M of lam and phi, whose displacements are held


def index_of(lowest: float, lam: float, folds: int) -> int:
    """The Morse index of a loop from its orbit about pi/2; 0: stable."""
    varied = vary_from(start(np.array([lowest]), np.array([lam])))
    M = np.empty((4, 4))
    rows, columns = np.triu_indices(4)
    M[rows, columns] = M[columns, rows] = varied.gain[0].sum(axis=0)
    own = 1 if M[0, 0] < 0 else 2  # the derivative of half the period by half the level is -M_00
    K = (M - np.outer(M[:, 0], M[0]) / M[0, 0])[np.ix_(_HELD, _HELD)]
    scale = 1 / np.sqrt(np.abs(np.diag(K)))
    return 2 * (folds - 1) + own - int((np.linalg.eigvalsh(K * np.outer(scale, scale)) < 0).sum())
