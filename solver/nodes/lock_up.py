"""Lock-up: how far a push arrives along a rod inside a cylinder, against friction, in units of A and rho.

Away from the end where it arrives the compression F grows as  dF/dx = along + friction P(F),  with the mean push P of a
straight rod, a sinusoid or a helix (`local_waves`). The right side does not depend on x, so of a small change of F at
the other end, the share that arrives is the ratio of dF/dx at both ends. A helix without weight has P = F^2/4: then F
has no bound at x = 4/(friction F), and a hundredth of a change arrives at nine tenths of that.
"""

import numpy as np

from ..numerics.chebyshev import GAUSS
from ..numerics.roots import halve
from .loaded_rod import LoadedRod
from .local_waves import EQUAL, HELIX, LIGHTEST, SOFT, has_waves, mean_push

# of a change of the push: less is lock-up, as drillers have it. x10: another definition, and shorter lengths
PASSED = 0.01
WAVELESS = 1e-8  # of F^2: a weight across that is too small for a sinusoid, in place of none. x10: as good
PANELS = 12  # where the push is smooth; with `GAUSS` to 1e-9 of the length. x10: only time
FINE = 1e-10  # of the compression. x10: a digit less of it


def lock_up_length(along: float, across: float, friction: float, arriving: float) -> float:
    """The length from which on less than `PASSED` of a change of the push arrives; infinite where that is nowhere.

    along: what phi grows by in a unit of length towards the end where the compression `arriving` arrives. across: the
    weight across, or 0. friction: the coefficient.
    """
    across = max(across, WAVELESS * arriving**2 * (arriving > 0), LIGHTEST)
    unit = np.sqrt(across)

    def rate(F: np.ndarray) -> np.ndarray:
        return along + friction * across * mean_push(F / unit - 2, EQUAL)

    first = float(rate(np.array(arriving)))
    if first <= 0:
        return np.inf
    front = unit * (2 + EQUAL)
    wound = 2 * unit * np.sqrt(max(0.0, first / PASSED - along) / (friction * across))
    last = max(arriving, min(max(front, wound), HELIX))
    bends = unit * (2 + SOFT * np.linspace(-20, 20, PANELS + 1))
    helix = np.geomspace(max(front, arriving, FINE * last), last, PANELS + 1) if last > front else ()
    edges = np.unique(np.clip(np.concatenate([[arriving, last], bends, [front], helix]), arriving, last))
    width, (x, w) = np.diff(edges)[:, None] / 2, GAUSS
    return float(np.sum(width * w / rate(edges[:-1, None] + width * (1 + x))))


def largest_arriving(along: float, across: float, friction: float, span: float) -> float:
    """The compression at which a push that grows locks up over a length; infinite where none does.

    Where the sinusoid becomes a helix the push jumps, and a length that is locked up before may be none just after.
    """
    front = np.nextafter(np.sqrt(max(across, LIGHTEST)) * (2 + EQUAL), 0)

    def locks(F: float) -> bool:
        return lock_up_length(along, across, friction, F) < span

    if locks(-HELIX):
        return np.nan
    most = next((F for F in (front, HELIX) if F <= HELIX and locks(F)), np.inf)
    return most if np.isinf(most) else halve(locks, -HELIX, most, FINE)[0]


def lock_up_tension(rod: LoadedRod) -> float | None:
    """The far end's phi below which a rod that pushes towards it locks up; None where none is known."""
    arriving = largest_arriving(rod.along, rod.across, float(rod.numbers[3]), rod.span)
    return -arriving if np.isfinite(arriving) else None


def lock_up_share(rod: LoadedRod) -> float | None:
    """The share of the length, from the far end, on which friction lets too little of a change of the force pass.

    None where it lets enough pass, and where friction lowers the compression from the far end on.
    """
    if not (rod.numbers[3] > 0 and has_waves(rod)) or rod.rotates:
        return None
    share = lock_up_length(rod.along, rod.across, float(rod.numbers[3]), -rod.tension_known) / rod.span
    return share if share < 1 else None
