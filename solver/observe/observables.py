"""The observables: scalar functions of a solution, one number for each case, with its estimated error.

Integrals, means and extremes are those of the whole rod, computed on the panels of the orbit (`measurement`), whatever
the stations are; so they are also right for a rod of a million bends, and for one that bends on a millionth of its
length.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..core.tuning import BARELY
from ..nodes.loaded_rod import MU, PHI, Q, numbers_of
from ..nodes.lock_up import largest_arriving, lock_up_length
from ..nodes.pipe_states import least_pull
from ..numerics.arrays import EPS, ROUNDED, Array
from ..numerics.complex_step import size_of
from ..orbits.marched_orbit import MarchedOrbit
from ..orbits.periodic_orbit import LIBRATION, ROTATION, TIGHT, solve_orbit
from ..orbits.potential import load_size
from ..orbits.shape_arrays import ShapeArrays
from ..problem.case import Case, Rod
from ..problem.declared_fields import DEAD_LOADS
from ..problem.dimensionless import flat
from ..problem.errors import check_type, known_name, names_of, no_such, yes_or_no
from ..problem.quantities import ByName, current, quantity
from .free_numbers import UNDEFINED, free_numbers
from .measurement import SPREAD, MeasuredNumbers, Pair
from .morse_index import index
from .self_contact import overlaps
from .solution_pieces import is_resolved

# over the root of the size of H: half a period that is longer is next to a separatrix. x10: orbits there are not looked
# at, whose counts may be unsure
_LONG = 12.0
# of the pushes: a wall that would pull more than so much of them has no friction, and a torque against it no meaning.
# x10: a torque is stated that pulls have cancelled
_PULLS = 0.25


def bends(read: MeasuredNumbers) -> Any:
    """Number of bends: interior extrema of beta, (B,). A helix has none, whatever the rounding of beta.

    NaN where the method knows no orbit and the stations are too few.
    """
    sol, orbit = read.sol, read.sol.trajectory.orbit
    if sol.trajectory.shapes is not None:
        return np.where(_librates(read), sol.trajectory.shapes.numbers(lambda shape: len(shape.bends(1.0))), 0)
    if orbit is None:
        sign = np.sign(sol.trajectory.dbeta)
        count = np.count_nonzero(sign[:, 1:] * sign[:, :-1] < 0, axis=1)
        return np.where(is_resolved(sol), np.where(_librates(read), count, 0), np.nan)
    return np.where(_librates(read), _inner_turns(orbit), 0)


def _inner_turns(orbit: Any) -> Any:
    """Turning points passed by the far end, (B,); one that is the far end itself, to rounding, is not interior."""
    span, half_period = orbit.problem.span, orbit.ahead + orbit.back
    passed, since = orbit.far_end
    just = since <= np.minimum(1e-12 * span, 1e-6 * half_period)
    return np.where(just, np.minimum(orbit.turns, passed - 1), orbit.turns)


def _librates(read: MeasuredNumbers) -> Any:
    """Whether beta changes by more than rounding, and where no orbit is known, by more than the tolerance, (B,)."""
    low, high = read.value("low"), read.value("high")
    rounding = BARELY * np.maximum(1, np.maximum(np.abs(low), np.abs(high)))
    allowed = np.minimum(2 * read.error, 1e-6)
    if read.sol.trajectory.orbit is None:
        allowed = np.fmax(allowed, read.sol.tol)
    return high - low > np.fmax(rounding, allowed)


def loops(read: MeasuredNumbers) -> Any:
    """Full turns of beta between the two ends of the rod, (B,); a libration has none."""
    orbit, sol = read.sol.trajectory.orbit, read.sol
    if orbit is None:
        return np.floor(np.ptp(sol.trajectory.beta, axis=1) / (2 * np.pi))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(orbit.kind == ROTATION, np.floor(orbit.problem.span / orbit.ahead), 0)


def self_intersection(read: MeasuredNumbers, **limits: int) -> Any:
    """Self-intersection: 1 where the rod would intersect itself, else 0, (B,); NaN where that was not decided.

    limits: options of `self_contact.overlaps`.
    """
    bounds = (read.each(v) for v in (read.scale("tightest", 1 / read.rho)[0], read.value("low"), read.value("high")))
    return np.reshape(overlaps(read.sol, *bounds, **limits), -1)


def bend_number(read: MeasuredNumbers) -> Pair:
    """L divided by the half period of beta: a continuous number of bends; 0 where beta does not librate.

    NaN where the method knows no orbit.
    """
    orbit = read.orbit
    if orbit is None:
        unknown = np.full(read.sol.problem.size, np.nan)
        return unknown, unknown
    with np.errstate(divide="ignore", invalid="ignore"):
        librates, plain = (orbit.kind == LIBRATION) & _librates(read.plain), read.plain
        straight = np.where(orbit.kind == ROTATION, 0.0, read.at_jump(0.0))
        count = np.where(librates, read.length / read.half_period, straight)
        # the error of the half period: that of beta over the largest |beta_t|, at least the range over half a period
        late = np.where(librates, 2 * read.error / (plain.value("high") - plain.value("low")), 0.0)
        if isinstance(orbit, MarchedOrbit):
            late = late + SPREAD * orbit.late * np.where(librates, count / read.half_period, 0.0)
        if plain is read:
            late = late + _by_rounding(orbit, count, librates | (orbit.kind == ROTATION))
    return count, late + 8 * EPS * count


def _by_rounding(orbit: Any, count: Array, moves: Array) -> Array:
    """What rounding of the start and the loads adds to the number of half periods `count`, (B,): next to a separatrix
    half a period has few digits, also where the rod is much shorter and its shape has all of them. moves: (B,)."""
    change, problem = np.zeros(count.shape), orbit.problem
    if getattr(orbit, "paths", None) is not None:  # the level of a path is known by the logarithm of its gap
        return change
    rate = np.sqrt(1 + load_size(problem))
    near = np.flatnonzero(moves & ((orbit.ahead + orbit.back) * rate > _LONG))
    if not near.size:
        return change
    nearest = problem.take(near)
    for name, size in (("dbeta0", rate), ("lam", rate**2), ("phi", rate**2)):
        for nudge in (-ROUNDED * size[near], ROUNDED * size[near]):
            other = solve_orbit(replace(nearest, **{name: getattr(nearest, name) + nudge}), TIGHT)
            counted = np.where(other.kind == LIBRATION, nearest.span / (other.ahead + other.back), 0.0)
            change[near] = np.fmax(change[near], np.abs(counted - count[near]))
    return change


def amplitude(read: MeasuredNumbers) -> Pair:
    """Largest less smallest beta along the rod [rad]."""
    range_, orbit = read.value("high") - read.value("low"), read.sol.trajectory.orbit
    error = read.error_of("high") + read.error_of("low")
    if orbit is None or not (orbit.kind == ROTATION).any():
        return range_, error
    beta0, betaL = read.end_angles
    return np.where(orbit.kind == ROTATION, size_of(betaL - beta0), range_), error


def turns_around(read: MeasuredNumbers) -> Pair:
    """Turns about the axis, (alpha(L) - alpha(0))/2 pi."""
    return read.gain[0] / (2 * np.pi), _far(read) / (2 * np.pi)


def height(read: MeasuredNumbers) -> Pair:
    """z(L) [length]."""
    return read.gain[1] * read.rho, _far(read) * read.rho


def _far(read: MeasuredNumbers) -> Array:
    """The error of alpha and z/rho at the far end, (B,)."""
    return read.error * np.maximum(1, read.sol.problem.span)


def _at_start(read: MeasuredNumbers, number: int, unit: Array, constant: Any) -> Pair:
    shapes = read.sol.trajectory.shapes
    if shapes is None:
        return constant, 0.0
    first = shapes.ends()[0]
    value = first[:, number] + (first[:, MU] if number == Q else 0.0)
    return value * unit, read.error * read.steepness**2 * unit


def twist_at_start(read: MeasuredNumbers) -> Pair:
    """The twisting moment at s = 0 [force length]: M3, unless the rod turns in place against friction."""
    value, error = _at_start(read, MU, read.unit_moment, read.loads[2])
    return value if read.sol.case.cylinder.turns_in_place else read.loads[2], error


def neutral_at(read: MeasuredNumbers) -> Pair:
    """The first s at which the axial force FZ is 0 [length]; NaN where it is nowhere 0."""
    shapes = read.sol.trajectory.shapes
    if shapes is None:
        return read.loads[0] * np.nan, np.nan
    value = shapes.numbers(lambda shape: shape.neutral()) * read.rho
    return value, np.abs(value) * read.error


def surface_torque(read: MeasuredNumbers) -> Pair:
    """The torque at s = 0, the surface end, that turns the rod about its axis towards larger gamma [force length].

    NaN of a rod that turns in place where the wall pulls more than a quarter of what it pushes.
    """
    start, error = twist_at_start(read)
    torque = 0.0 - start
    if read.sol.case.cylinder.turns_in_place:
        pushed, pulled = (np.real(read.value(name)) for name in ("pushed", "pulled"))
        torque = np.where(pulled > _PULLS * pushed + least_pull(0.0) * read.length, np.nan, torque)
    return torque, error


def _lock_up(read: MeasuredNumbers, number: Callable[[float, float, float, float, float], float]) -> Array:
    """A number of each rod that friction holds back as it is pushed, (B,); NaN of other rods, of those that a tension
    pulls at the end towards which they slide, and where it is infinite.

    number: of along, across, friction, the compression that arrives and the length, as in `nodes.lock_up`, from
    the end where the push arrives: s = L of a rod that slides towards larger s.
    """
    sol, case = read.sol, read.sol.case
    values = np.full(sol.problem.size, np.nan)
    if not case.varies or case.cylinder.friction is None or case.cylinder.turns_in_place:
        return values
    numbers = numbers_of(case)
    start, _ = _at_start(read, PHI, np.ones(sol.problem.size), sol.problem.phi)
    for i, (_, along, across, rubbed, _, _, outward) in enumerate(numbers):
        phi = sol.problem.phi[i] if rubbed > 0 else start[i]
        if rubbed and outward < 0 and phi <= 0:
            length = sol.problem.span[i]
            values[i] = number(np.sign(rubbed) * along, across, abs(rubbed), -phi, length)
    return np.where(np.isinf(values), np.nan, values)


def reach(read: MeasuredNumbers) -> Pair:
    """The length at which the rod locks up, under the compression at the end towards which it slides [length]."""
    return _lock_up(read, lambda along, across, f, F, _: lock_up_length(along, across, f, F)) * read.rho, np.nan


def arriving_max(read: MeasuredNumbers) -> Pair:
    """The largest compression that arrives at the end towards which the rod slides, before it locks up [force]."""
    values = _lock_up(read, lambda along, across, f, _, span: largest_arriving(along, across, f, span))
    return values * read.unit_force, np.nan


def _end_moment(read: MeasuredNumbers, end: int) -> Pair:
    error = np.where(np.isfinite(read.error), read.error, 1.0) * read.steepness
    return read.end_rates[end] * read.A / read.rho, error * read.unit_moment


def contact_size_mean(read: MeasuredNumbers) -> Pair:
    """Mean of |f| over the whole length [force/length]; pull counts as much as push."""
    pushed, pulled = read.scale("pushed", read.unit_mean_push), read.scale("pulled", read.unit_mean_push)
    return pushed[0] + pulled[0], pushed[1]


def push_middle(read: MeasuredNumbers) -> Pair:
    """Mean of the push over the middle third of the length [force/length], where pull counts as 0."""
    pushed, error = read.middle("push")
    factor = 3 * read.unit_mean_push
    return pushed * factor, error * factor


def pitch(read: MeasuredNumbers) -> Pair:
    """Height of one whole turn about the axis in the middle third of the rod [length], positive along z.

    2 pi (z_2 - z_1)/|alpha_2 - alpha_1| between s = L/3 and s = 2L/3, also where the rod turns less than once there.
    NaN where alpha changes by no more than its error.
    """
    (turned, doubt), (risen, error) = read.middle("turned"), read.middle("risen")
    size = size_of(turned)
    with np.errstate(divide="ignore", invalid="ignore"):
        a_turn = np.where(np.real(size) > doubt, 2 * np.pi * read.rho / size, np.nan)
    value = a_turn * risen
    return value, a_turn * error + size_of(value) * doubt / np.where(np.real(size) > doubt, size - doubt, np.nan)


def twist_energy(read: MeasuredNumbers) -> Pair:
    """Integral of M3^2/(2 C) along the rod [force length].

    M3 is constant but along a rod that turns in place against friction.
    """
    turning = read.sol.case.cylinder.turns_in_place
    square = read.square_twist if turning else read.mu**2
    value = read.unit_moment * (square * read.ratio / 2) * read.length
    error = 8 * EPS * value
    if turning:
        error = error + read.unit_moment * np.sqrt(square) * read.ratio * read.length * read.error * read.steepness**2
    return value, error


def energy(read: MeasuredNumbers) -> Pair:
    """Bending and twist energy minus the work of the dead loads FZ, MZ and M3 [force length].

    That is bending_energy + twist_energy - FZ (z(L) - z(0)) - MZ (alpha(L) - alpha(0)) - M3 (gamma(L) - gamma(0)), the
    potential that equilibria under dead loads make stationary. As gamma(L) - gamma(0) = M3 L/C - integral of
    sin cos/rho, it is Routh's integral of A kappa^2/2 + M3 sin cos/rho - FZ cos - MZ sin/rho less M3^2 L/(2 C). With
    weight the loads are those of the far end, and the potential of the weight is added; with friction there is none.
    """
    value, error = read.scale("potential", read.unit_moment)
    twist, rounding = twist_energy(read)
    rubbed = read.sol.case.cylinder.friction
    if rubbed is not None:
        value = np.where(flat(rubbed, read.sol.case.shape) != 0, np.nan, value)
    return value - twist, error + rounding


def first_azimuth(read: MeasuredNumbers) -> Pair:
    """The azimuth at s = 0 [rad], where a rod that lies on the wall touches it first."""
    return flat(read.sol.case.given.alpha, read.sol.case.shape), 0 * read.rho


def first_bending(read: MeasuredNumbers) -> Pair:
    """The bending moment M2 = A sin^2(beta)/rho at s = 0 [force length]."""
    beta = read.sol.trajectory.beta[:, 0]
    return read.unit_moment * np.sin(beta) ** 2, read.unit_moment * np.abs(np.sin(2 * beta)) * read.error


@dataclass(frozen=True)
class Observable:
    """One number a case.

    compute: the values (B,), with their errors if `Quantity.estimated`. measured: what `MeasuredNumbers` measures for
    it; what is measured over the middle third alone has "middle" before it. undefined: where it has no value although
    the case is solved, in words; "" if nowhere. not_smooth: where it has a value, and may have no derivative; ""
    for the reasons that go with what is measured. needs: the field of the rod without which it does not exist.
    holds: whether it is a load or a moment that holds an end, which is computed only where it is asked for by name.
    free: whether it is of a rod that may leave the cylinder; of another one, which lies on the wall, it is computed
    only where it is asked for by name. least, most: the bounds of its value and of its size, in which "L" is the
    length of the rod; whole numbers are never negative.
    """

    compute: Callable[[MeasuredNumbers], Any]
    measured: tuple[str, ...] = ()
    undefined: str = ""
    not_smooth: str = ""
    needs: str = ""
    holds: bool = False
    free: bool = False
    least: float = -np.inf
    most: float | str = np.inf


SEVERAL = "several places of the rod reach the extreme, and a change moves them apart"
STRAIGHT = "the rod is straight, or has no such period, where the value is not smooth"
NO_TURN = "the rod does not turn about the axis in its middle third"
NO_TORQUE = "the wall would pull more than a quarter of what it pushes, and a wall that pulls has no friction"
NEVER_LOCKS = "only a rod inside that is pushed along its cylinder locks up, and none that its weight carries"


def _in_unit(name: str, unit: Callable[[MeasuredNumbers], Any], **rest: Any) -> Observable:
    """An observable that is a number measured along the rod, in a unit of each rod."""
    return Observable(lambda read: read.scale(name, unit(read)), (name,), **rest)


# The row in `problem.quantities` says whether the error is estimated; if not, the values are loads or whole numbers.
OBSERVABLES: dict[str, Observable] = {
    "bends": Observable(bends, ("low", "high")),
    "bend_number": Observable(bend_number, ("low", "high"), not_smooth=STRAIGHT, least=0),
    "loops": Observable(loops),
    "amplitude": Observable(amplitude, ("low", "high"), least=0),
    "kappa_mean": _in_unit("curvature", lambda read: 1 / (read.length * read.rho), least=0),
    "kappa_max": _in_unit("tightest", lambda read: 1 / read.rho, least=0),
    "turns_around": Observable(turns_around),
    "height": Observable(height, most="L"),
    "pitch": Observable(pitch, ("middle turned", "middle risen"), undefined=NO_TURN, not_smooth=NO_TURN),
    "contact_size_mean": Observable(contact_size_mean, ("pushed", "pulled"), least=0),
    "push_mean": _in_unit("pushed", lambda read: read.unit_mean_push, least=0),
    "pull_mean": _in_unit("pulled", lambda read: read.unit_mean_push, least=0),
    "push_min": _in_unit("least", lambda read: read.unit_push),
    "push_max": _in_unit("most", lambda read: read.unit_push),
    # its error: the distance to the farthest s at which the push may be larger, by the error of `push_max`
    "push_max_at": _in_unit(
        "peak",
        lambda read: read.rho,
        not_smooth="several places of the rod have the largest push, or the place may leave an end of the rod",
        least=0,
        most="L",
    ),
    "push_middle": Observable(push_middle, ("middle push",), least=0),
    # push counts where it exceeds rounding, 64 eps times the sizes of its terms; so a rod that lies along the cylinder
    # without any contact force is not attached
    "attached": _in_unit("share", lambda read: 1 / read.length, least=0, most=1),
    "lift_off_at": _in_unit(
        "lifts",
        lambda read: read.rho,
        not_smooth="the push touches zero without a change of sign, where a change makes lift-off jump",
        least=0,
        most="L",
    ),
    "F3_size_max": _in_unit(
        "tension",
        lambda read: read.unit_force,
        not_smooth=f"{SEVERAL}; or there is no force along the tangent",
        least=0,
    ),
    "bending_moment_max": _in_unit("tightest", lambda read: read.unit_moment, least=0),
    "bending_stress_max": _in_unit("tightest", lambda read: read.E * read.a / read.rho, needs="E", least=0),
    "overlaps": Observable(self_intersection, ("tightest", "low", "high"), most=1),
    "energy": Observable(energy, ("potential",), undefined="a rod that slides with friction has no energy to minimise"),
    "bending_energy": _in_unit("bending", lambda read: read.unit_moment, least=0),
    "twist_energy": Observable(twist_energy, least=0),
    "index": Observable(index),
    "gap_max": Observable(lambda read: (0 * read.rho, 0 * read.rho), free=True, least=0),
    "contact_share": Observable(lambda read: (1 + 0 * read.rho, 0 * read.rho), free=True, least=0, most=1),
    "contact_count": Observable(lambda read: np.ones(read.sol.problem.size, dtype=np.int64), free=True),
    "contact_at": Observable(lambda read: (0 * read.rho, 0 * read.rho), free=True, least=0, most="L"),
    "contact_alpha": Observable(first_azimuth, free=True),
    "contact_M2": Observable(first_bending, free=True),
    "point_force_max": Observable(lambda read: (0 * read.rho, 0 * read.rho), free=True, least=0),
    "FZ": Observable(lambda read: (read.loads[0], 0.0), holds=True),
    "MZ": Observable(lambda read: (read.loads[1], 0.0), holds=True),
    "M3": Observable(lambda read: (read.loads[2], 0.0), holds=True),
    "FZ0": Observable(lambda read: _at_start(read, PHI, read.unit_force, read.loads[0]), holds=True),
    "MZ0": Observable(lambda read: _at_start(read, Q, read.unit_moment, read.loads[1]), holds=True),
    "M30": Observable(twist_at_start, holds=True),
    "neutral_at": Observable(neutral_at, undefined="the axial force is nowhere 0", holds=True),
    "surface_torque": Observable(surface_torque, undefined=NO_TORQUE, holds=True),
    "reach": Observable(reach, undefined=NEVER_LOCKS, holds=True, least=0),
    "arriving_max": Observable(arriving_max, undefined=NEVER_LOCKS, holds=True),
    "M10": Observable(lambda read: _end_moment(read, 0), holds=True),
    "M1L": Observable(lambda read: _end_moment(read, 1), holds=True),
}


def observables_of(rod: Rod, leaves: bool = False) -> tuple[str, ...]:
    """The names of the observables of the shape of a rod: without Young's modulus there is no stress.

    leaves: whether it may leave the cylinder.
    """
    rows = ((name, row) for name, row in OBSERVABLES.items() if not row.holds and (leaves or not row.free))
    return tuple(name for name, row in rows if not row.needs or getattr(rod, row.needs) is not None)


def is_count(name: str) -> bool:
    """Whether an observable is a whole number."""
    return name in OBSERVABLES and not OBSERVABLES[name].holds and not quantity(name).estimated


def error_name(name: str, leaves: bool = False) -> str | None:
    """The name of the error of an observable, or None for a whole number, and for a load of a rod on the cylinder.

    leaves: whether the rod may leave the cylinder.
    """
    return f"{name}_error" if quantity(name).estimated and (leaves or name not in DEAD_LOADS) else None


def why_unknown(name: str, values: Any, leaves: bool = False) -> list[tuple[str, Any]]:
    """Sentences on the missing values of an observable, each with where it holds among solved cases, (*cases).

    leaves: whether the rods may leave the cylinder.
    """
    numbers, words = np.asarray(values, dtype=float), OBSERVABLES[name].undefined
    words = UNDEFINED.get(name, words) if leaves else words
    sentences = [(f"{name} is not defined: {words}", np.isnan(numbers))] if words else []
    return [*sentences, (f"{name} is beyond floats in these units", np.isinf(numbers))]


def check_names(names: Any) -> tuple[str, ...]:
    """One name or several as a tuple, former ones as those of today. Raises `InputError` for an unknown one."""
    chosen = tuple(current(name) for name in names_of(names))
    for name in chosen:
        if not known_name(name, OBSERVABLES):
            raise no_such("observable", name, OBSERVABLES)
    return chosen


@np.errstate(all="ignore")  # the numbers of an unsolved case may overflow
def observe(sol: ShapeArrays, names: Iterable[str], errors: bool = False) -> dict[str, Any]:
    """Observables of a solution: one number a case.

    Parameters
    ----------
    sol : Shape
    names : iterable of str
        Names of `solver.observe.observables.OBSERVABLES`, for example ``["bends", "energy"]``; their units are in
        `solver.problem.quantities`.
    errors : bool
        Whether to add the estimated error of each, as ``<name>_error`` in the same unit, except for the whole numbers
        `bends`, `loops`, `overlaps` and `index`, for the loads `FZ`, `MZ` and `M3` of rods that are on the
        cylinder, and for `reach` and `arriving_max`.

    Returns
    -------
    dict
        Name -> array (*cases), or a number for a single case; NaN for a case without a shape. An error is NaN if it
        cannot be estimated: the method does not know the orbit, and the stations do not resolve every bend or cover
        only a part of the rod.

    Raises
    ------
    InputError
        For an unknown name.

    Examples
    --------
    >>> from solver import Case, Cylinder, Rod, Start, observe, solve
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> solution = solve(Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)))
    >>> seen = observe(solution, ["bends", "kappa_max"])
    >>> print(f"{seen['bends']} bends, largest curvature {seen['kappa_max']:.4f}")
    5 bends, largest curvature 2.6140
    """
    names, errors = check_names(names), yes_or_no("errors", errors)
    read = MeasuredNumbers(check_type("observe", sol, ShapeArrays))
    off = sol.trajectory.free is not None
    known = free_numbers(sol, names) if off else {}
    read.measure(key for name in names for key in OBSERVABLES[name].measured if not off)
    shapeless = ~np.isfinite(sol.trajectory.beta).all(axis=1)
    observed = ByName()
    for name in names:
        computed: Any = known[name] if off else OBSERVABLES[name].compute(read)
        if is_count(name):
            computed = computed[0] if off else computed
            observed[name] = read.each(_whole(np.where(shapeless, np.nan, computed)))
            continue
        values, error = computed
        if off:
            values = _within_range(OBSERVABLES[name], values, sol.case)
        observed[name] = read.each(np.where(shapeless, np.nan, values) + 0.0)  # no -0
        if errors and (column := error_name(name, off)):
            observed[column] = read.each(np.where(shapeless, np.nan, error))
    return observed


def _within_range(row: Observable, values: Array, case: Case) -> Array:
    """The nearest values (B,) that the observable can have: what is left to the limit of meshes may lead beyond."""
    most = flat(case.rod.L, case.shape) if row.most == "L" else row.most
    return np.clip(values, row.least, most)


def _whole(values: Array) -> Array:
    """The values as integers where all of them are known."""
    return values.astype(np.int64) if (np.abs(values) < 2**62).all() else values
