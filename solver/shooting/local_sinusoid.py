"""The sinusoid of a long lying rod inside a cylinder, whose amplitude and wave number follow the local compression.

Of a slender rod, with F the compression in units of sqrt(A w sin(theta)/rho), x in (A rho/(w sin(theta)))^(1/4), and
the mean over a wave in brackets: the energy e = <alpha''^2 + alpha'^4 - F alpha'^2>/2 + <1 - cos(alpha)> is least at
the wave number k of the table. Friction f per push P pulls the phase:  d/dx (de/dk) = -f c,  with
c = <P alpha'^2 + <P> alpha'^2>/(2k) of a rod that slides along itself and <<P> alpha'^2 - P alpha'^2>/(2k) of one that
moves along the axis.
"""

import numpy as np

from ..numerics.arrays import Array
from ..problem.case import ALONG_ITSELF, IN_PLACE
from .loaded_rod import ALPHA, BETA, PHI, SHORT, SPEED, LoadedRod, Q
from .newton import Shape, correct

# F - 2; k, a/(F - 2)^(1/2) and a3/a^3 of the first and third harmonics, d2e/dk2/(F - 2), <P>, c/(F - 2) along itself,
# c/(F - 2)^2 along the axis
TABLE = np.array([
    [0.0, 1.00000, 0.8528, -0.0240, 1.4545, 1.0000, 0.3636, 0.1480],
    [0.4, 0.98944, 0.8724, -0.0227, 1.4556, 1.1042, 0.3632, 0.1319],
    [0.8, 0.97591, 0.8948, -0.0213, 1.4440, 1.2740, 0.4050, 0.1170],
    [1.2, 0.95924, 0.9206, -0.0200, 1.4188, 1.5133, 0.4927, 0.1040],
    [1.6, 0.93905, 0.9510, -0.0187, 1.3776, 1.8265, 0.6324, 0.0927],
    [2.0, 0.91458, 0.9876, -0.0173, 1.3146, 2.2193, 0.8341, 0.0830],
    [2.4, 0.88429, 1.0340, -0.0160, 1.2163, 2.6995, 1.1151, 0.0752],
    [2.8, 0.84433, 1.0985, -0.0145, 1.0461, 3.2807, 1.5134, 0.0695],
    [3.2, 0.77721, 1.2207, -0.0125, 0.6093, 4.0084, 2.1801, 0.0681],
])  # fmt: skip
CURVES = np.polynomial.polynomial.polyfit(TABLE[:, 0], TABLE[:, 1:], 7)
LAST = 3.2613  # F - 2 at the fold of the sinusoid
SOFT = 0.03  # of F: how softly the amplitude comes to 0
FINE, ROUNDS, LEAST = 12, 15, 0.1  # places for a node; of the compression; of the square of the amplitude
STEPS = 25  # of Newton's method from it
STEEPEST = 0.9  # sine of beta


def has_sinusoid(rod: LoadedRod) -> bool:
    """Whether this is a rod that may lie as a sinusoid: inside, with weight across, on the low side at its start."""
    inside = rod.numbers[6] < 0 < rod.across and "height" not in rod.held and rod.numbers[4] != IN_PLACE
    return bool(inside and not np.any(rod.near))


def compression(rod: LoadedRod, t: Array) -> tuple[Array, Array]:
    """F - 2 at t (n,) where friction acts on a sinusoid, and the columns of the table there, (7, n)."""
    rubbed, unit = rod.numbers[3] * rod.across, np.sqrt(rod.across)
    given = rod.tension_known - rod.along * (rod.span - t)
    lost = rod.span - t
    over, columns = -(given - rubbed * lost) / unit - 2, np.empty(0)
    for _ in range(ROUNDS if rubbed else 1):
        columns = np.polynomial.polynomial.polyval(np.minimum(positive_part(over), TABLE[-1, 0]), CURVES)
        passed = integral(columns[4], t)
        over = -(given - rubbed * (passed[-1] - passed)) / unit - 2
    return over, columns


def positive_part(over: Array) -> Array:
    """F - 2 where it is positive, and nearly 0 elsewhere."""
    return np.asarray((over + np.sqrt(over**2 + SOFT**2)) / 2)


def integral(values: Array, t: Array) -> Array:
    """From the first of t, (n,)."""
    return np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2 * np.diff(t))])


def local_sinusoid(rod: LoadedRod, nodes: Array, more: int = 0) -> Shape:
    """Nearly an equilibrium: the sinusoid with the half waves of least energy, or with a few more."""
    ell = rod.across**-0.25
    t = np.linspace(0, rod.span, FINE * nodes.size)
    x = t / ell
    over, (k, first, third, stiff, _, itself, axis) = compression(rod, t)
    soft = positive_part(over)
    pull = itself * soft if rod.numbers[4] == ALONG_ITSELF else axis * soft**2
    flux = integral(rod.numbers[3] * rod.across * ell**3 * pull, x)
    ends = soft[[0, -1]] ** 1.5  # as much as each end can bear
    change = (flux - flux[-1] * ends[0] / ends.sum()) / (stiff * soft)
    phase = integral(k + change, x)
    if over.min() > 0:
        phase *= (np.round(phase[-1] / np.pi) + more) * np.pi / phase[-1]
    elif over[0] < over[-1]:
        phase -= phase[-1]
    size = first * np.sqrt(soft * np.maximum(LEAST, 1 - 4 * change**2 / soft))
    for name, place, end in (("beta0", x, soft[0]), ("betaL", x[-1] - x, soft[-1])):
        size *= np.tanh(place * np.sqrt(end / 8)) if name in rod.held else 1.0
    alpha = size * np.sin(phase) + third * size**3 * np.sin(3 * phase)

    def rate(values: Array) -> Array:
        return np.asarray(np.gradient(values, t, edge_order=2))

    beta = np.arcsin(np.clip(rate(alpha), -STEEPEST, STEEPEST))
    speed, phi = rate(beta), -(over + 2) * np.sqrt(rod.across)
    moment = ((phi + 2 * np.cos(beta) * np.sin(beta) ** 2) * np.sin(beta) - rate(speed)) / np.cos(beta)
    y = rod.lying(nodes)
    short = integral(1 - np.cos(beta), t)
    for column, values in ((BETA, beta), (SPEED, speed), (ALPHA, alpha), (Q, moment), (PHI, phi), (SHORT, short)):
        y[:, column] = np.interp(nodes, t, values)
    return Shape(rod, nodes, y)


def sinusoid(rod: LoadedRod) -> Shape | None:
    """The equilibrium near the local sinusoid, with its half waves or one more or less; None where there is none."""
    if not has_sinusoid(rod):
        return None
    t = rod.nodes()
    over = compression(rod, t)[0]
    if not 0 < over.max() < LAST:
        return None
    found = (correct(local_sinusoid(rod, t, more), most=STEPS) for more in (0, 1, -1))
    return next((shape for shape in found if shape is not None), None)


def passes_fold(rod: LoadedRod) -> bool:
    """Whether the compression somewhere passes the fold of the sinusoid."""
    return has_sinusoid(rod) and bool(compression(rod, rod.nodes())[0].max() >= LAST)
