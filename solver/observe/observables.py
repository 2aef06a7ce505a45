"""Scalar functions of a solution: what a study tabulates. Each gives one number a case, and how far it may be off.

Integrals, means and extremes are those of the whole rod, measured on the orbit's own panels (`measurement`), whatever
stations were asked for: a rod of a million bends, and one that is bent on a millionth of its length, as any other.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ..boundary.stability import index_at_stations, jacobi_zeros
from ..numerics.arrays import Array
from ..orbit.pieces import LIBRATION, ROTATION
from ..problem.errors import no_such
from ..problem.reduced import flat
from ..solution import Solution
from .measurement import Pair, Reading
from .rod_pieces import resolved
from .self_contact import overlaps


def turns(read: Reading) -> Any:
    """Interior extrema of beta: the bends one counts. A helix that only trembles by rounding has none.

    NaN where the method knows no orbit and its stations are too few to tell.
    """
    sol, orbit = read.sol, read.sol.trajectory.orbit
    if orbit is None:
        sign = np.sign(sol.trajectory.dbeta)
        count = np.count_nonzero(sign[:, 1:] * sign[:, :-1] < 0, axis=1)
        return np.where(resolved(sol), np.where(_swings(read), count, 0), np.nan)
    return np.where(_swings(read), orbit.turns - _just_turned(orbit), 0)


def _just_turned(orbit: Any) -> Any:
    """Whether the far end itself, which is not interior, is the last turning point, but for rounding, (B,)."""
    span, swing = orbit.problem.span, orbit.ahead + orbit.back
    where = orbit.locate(span[:, None])
    since = np.where(where.second[:, 0], orbit.back, orbit.ahead) - where.local[:, 0]
    return where.mirrored[:, 0] & (since <= np.minimum(1e-12 * span, 1e-6 * swing))


def _swings(read: Reading) -> Any:
    """Whether beta changes by more than rounding, and, where no orbit is known, than the error allowed, (B,)."""
    low, high = read.value("low"), read.value("high")
    rounding = 64 * 2.0**-52 * np.maximum(1, np.maximum(np.abs(low), np.abs(high)))
    allowed = np.minimum(2 * read.error, 1e-6)
    if read.sol.trajectory.orbit is None:
        allowed = np.fmax(allowed, read.sol.tol)
    return high - low > np.fmax(rounding, allowed)


def loops(read: Reading) -> Any:
    """Full turns of beta between the two ends of the rod (a rod whose beta swings has none)."""
    orbit, sol = read.sol.trajectory.orbit, read.sol
    if orbit is None:
        return np.floor(np.ptp(sol.trajectory.beta, axis=1) / (2 * np.pi))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(orbit.kind == ROTATION, np.floor(orbit.problem.span / orbit.ahead), 0)


def overlapping(read: Reading) -> Any:
    """1 where the rod would pass through itself, else 0; NaN where that cannot be told."""
    told = (read.each(v) for v in (kappa_max(read)[0], read.value("low"), read.value("high")))
    return np.reshape(overlaps(read.sol, *told), -1)


def index(read: Reading) -> Any:
    """Morse index of the shape between its own two end angles, the loads dead: 0 is stable.

    NaN where it cannot be told: the case is not solved; or the method knows no orbit, and the stations do not resolve
    the shape or its condition number leaves too few digits.
    """
    sol, problem, told = read.sol, read.sol.problem, read.sol.trajectory
    if told.orbit is not None:
        found = jacobi_zeros(told.orbit.exact)
    else:
        found = index_at_stations(problem, sol.t, told.beta, told.dbeta)
        found = np.where((told.error <= 1e-3) & (told.condition <= 1e8), found, np.nan)
    return np.where(np.reshape(sol.solved, -1), found, np.nan)


def bend_number(read: Reading) -> Pair:
    """L over half a period of beta: the number of bends without its steps; 0 where beta does not swing.

    NaN where the method knows no orbit.
    """
    orbit = read.sol.trajectory.orbit
    if orbit is None:
        unknown = np.full(read.sol.problem.size, np.nan)
        return unknown, unknown
    with np.errstate(divide="ignore", invalid="ignore"):
        swings = (orbit.kind == LIBRATION) & _swings(read)
        count = np.where(swings, orbit.problem.span / (orbit.ahead + orbit.back), 0.0)
        # beta is late by what its error takes at its fastest, and that is a swing in half a period or faster
        late = np.where(swings, 2 * read.error / (read.value("high") - read.value("low")), 0.0)
    return count, late + 8 * 2.0**-52 * count


def amplitude(read: Reading) -> Pair:
    """Largest less smallest beta along the rod [rad]."""
    swing, orbit = read.value("high") - read.value("low"), read.sol.trajectory.orbit
    error = read.error_of("high") + read.error_of("low")
    if orbit is None:
        return swing, error
    way = np.abs(orbit.at(orbit.problem.span[:, None])[0][:, 0] - orbit.problem.beta0)
    return np.where(orbit.kind == ROTATION, way, swing), error


def kappa_mean(read: Reading) -> Pair:
    """Mean curvature [1/length]."""
    return read.scaled("curvature", 1 / (read.length * read.rho))


def kappa_max(read: Reading) -> Pair:
    """Largest curvature [1/length]."""
    return read.scaled("tightest", 1 / read.rho)


def wraps(read: Reading) -> Pair:
    """Turns about the axis, (alpha(L) - alpha(0))/2 pi."""
    return _gain(read)[0] / (2 * np.pi), _far(read) / (2 * np.pi)


def height(read: Reading) -> Pair:
    """z(L) [length]."""
    return _gain(read)[1] * read.rho, _far(read) * read.rho


def _gain(read: Reading) -> tuple[Array, Array]:
    """alpha(L) - alpha(0) [rad] and z(L)/rho, (B,)."""
    told = read.sol.trajectory
    if told.orbit is None or (read.sol.t[:, -1] == read.sol.problem.span).all():
        return told.alpha[:, -1], told.z[:, -1]
    _, _, alpha, z = told.orbit.at(told.orbit.problem.span[:, None])
    return alpha[:, 0], z[:, 0]


def _far(read: Reading) -> Array:
    """The error of alpha and z/rho at the far end, (B,)."""
    return read.error * np.maximum(1, read.sol.problem.span)


def contact_size_mean(read: Reading) -> Pair:
    """Mean of |f| over the whole length [force/length]: pull counts like push."""
    pushed, pulled = read.scaled("pushed", _a_length(read)), read.scaled("pulled", _a_length(read))
    return pushed[0] + pulled[0], pushed[1]


def push_mean(read: Reading) -> Pair:
    """Integral of the pushes alone over the whole length L [force/length]; pulls count as nothing.

    push_mean L is all that the cylinder pushes; push_mean + pull_mean is the mean of |f|.
    """
    return read.scaled("pushed", _a_length(read))


def pull_mean(read: Reading) -> Pair:
    """Integral of the pulls alone over the whole length L [force/length], not negative; pushes count as nothing."""
    return read.scaled("pulled", _a_length(read))


def push_min(read: Reading) -> Pair:
    """Smallest push of the cylinder [force/length]: below zero where it would have to pull, on either side."""
    return read.scaled("least", read.A / read.rho**3)


def push_max(read: Reading) -> Pair:
    """Largest push of the cylinder [force/length], positive where it pushes, on either side."""
    return read.scaled("most", read.A / read.rho**3)


def attached(read: Reading) -> Pair:
    """Share of the length on which the cylinder pushes; elsewhere the equations hold the rod on, or nothing does.

    What counts is push > 0 beyond rounding: above 64 eps times the sizes of the terms that the push is the sum of. A
    rod that only lies along the cylinder, where nothing presses, is not attached.
    """
    return read.scaled("share", 1 / read.length)


def _a_length(read: Reading) -> Array:
    return read.A / (read.rho**3 * read.length)


def bending_energy(read: Reading) -> Pair:
    """Integral of A kappa^2/2 [force length]."""
    return read.scaled("bending", read.A / read.rho)


def twist_energy(read: Reading) -> Pair:
    """M3^2 L/(2 C) [force length]."""
    value = read.A / read.rho * _twist(read) * read.length
    return value, 8 * 2.0**-52 * value


def energy(read: Reading) -> Pair:
    """Bending and twist energy less the work of the dead loads FZ, MZ and M3 [force length].

    That is bending_energy + twist_energy - FZ (z(L) - z(0)) - MZ (alpha(L) - alpha(0)) - M3 (gamma(L) - gamma(0)), the
    potential that equilibria under dead loads make stationary. As gamma(L) - gamma(0) = M3 L/C - integral of
    sin cos/rho, it is Routh's integral of A kappa^2/2 + M3 sin cos/rho - FZ cos - MZ sin/rho less M3^2 L/(2 C).
    """
    value, error = read.scaled("potential", read.A / read.rho)
    twist, rounding = twist_energy(read)
    return value - twist, error + rounding


def _twist(read: Reading) -> Array:
    """M3^2/(2 C) in units of A/rho^2, (B,)."""
    case = read.sol.case
    return read.sol.problem.mu**2 * flat(1 + np.asarray(case.rod.nu), case.shape) / 2


# whole numbers, of which there is no error: NaN where they cannot be told
COUNTED: dict[str, Callable[[Reading], Any]] = {
    "turns": turns,
    "loops": loops,
    "overlaps": overlapping,
    "index": index,
}

# each with what it is measured from
MEASURED: dict[str, tuple[Callable[[Reading], Pair], tuple[str, ...]]] = {
    "bend_number": (bend_number, ("low", "high")),
    "amplitude": (amplitude, ("low", "high")),
    "kappa_mean": (kappa_mean, ("curvature",)),
    "kappa_max": (kappa_max, ("tightest",)),
    "wraps": (wraps, ()),
    "height": (height, ()),
    "contact_size_mean": (contact_size_mean, ("pushed", "pulled")),
    "push_mean": (push_mean, ("pushed",)),
    "pull_mean": (pull_mean, ("pulled",)),
    "push_min": (push_min, ("least",)),
    "push_max": (push_max, ("most",)),
    "attached": (attached, ("share",)),
    "energy": (energy, ("potential",)),
    "bending_energy": (bending_energy, ("bending",)),
    "twist_energy": (twist_energy, ()),
}
_FROM = {"turns": ("low", "high"), "overlaps": ("tightest", "low", "high")}  # what a whole number is measured from

OBSERVABLES = (
    "turns", "bend_number", "loops", "amplitude", "kappa_mean", "kappa_max", "wraps", "height", "contact_size_mean",
    "push_mean", "pull_mean", "push_min", "push_max", "attached", "overlaps", "energy", "bending_energy",
    "twist_energy", "index",
)  # fmt: skip


def error_name(name: str) -> str | None:
    """What the error of an observable is called, or None for a whole number."""
    return f"{name}_error" if name in MEASURED else None


def observe(sol: Solution, names: Iterable[str], errors: bool = False) -> dict[str, Any]:
    """The named observables of a solution: name -> (*cases), a number for a single case; NaN where a case has no shape.

    names: of `OBSERVABLES`, for example `["turns", "energy"]`; `solver.problem.quantities` has their units.
    errors: also how far each may be off, as `<name>_error` in the same unit, but for the whole numbers `turns`,
    `loops`, `overlaps` and `index`. NaN where it cannot be told: the method knows no orbit, and its stations do not
    show every bend, or are those of a stretch of the rod. Raises `InputError` for an unknown name.
    """
    names = list(names)
    for name in names:
        if name not in OBSERVABLES:
            raise no_such("observable", name, OBSERVABLES)
    read = Reading(sol)
    read.measure(key for name in names for key in (MEASURED[name][1] if name in MEASURED else _FROM.get(name, ())))
    shapeless = ~np.isfinite(sol.trajectory.beta).all(axis=1)
    found: dict[str, Any] = {}
    for name in names:
        if name in COUNTED:
            found[name] = read.each(_whole(np.where(shapeless, np.nan, COUNTED[name](read))))
            continue
        values, error = MEASURED[name][0](read)
        found[name] = read.each(np.where(shapeless, np.nan, values))
        if errors:
            found[f"{name}_error"] = read.each(np.where(shapeless, np.nan, error))
    return found


def _whole(values: Array) -> Array:
    """Whole numbers as such where all of them are known."""
    return values.astype(np.int64) if (np.abs(values) < 2**62).all() else values
