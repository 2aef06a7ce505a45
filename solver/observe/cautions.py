"""Cautions: what a real rod could not do although the shape solves the equations, and how much of it; and
where along a rod the cylinder would have to pull.

Like the observables they are judged on the whole rod, whatever its stations and whatever is stored. The caution of a
case is a text of parts, ", " between: `TIGHT`, `MEETS`, `TURNED`, `STRAINED` with the strain, one of the kinds of
lift-off, and parts of `UNCHECKED`.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..core.measures import densities
from ..nodes.loaded_rod import MU
from ..nodes.pipe_states import SLIGHT, least_pull
from ..numerics.arrays import NEGLIGIBLE, Array, Booleans, Integers
from ..orbits.forces import circumferential_force, curvature, surface_forces
from ..orbits.shape_arrays import ShapeArrays
from ..problem.dimensionless import EndsProblem, flat
from .measurement import MeasuredNumbers
from .observables import error_name, observe

QUARTER = 0.25  # of the length at each end: a rod pulled only there lifts off at its ends. x10: more than the rod
PLACES, FINER = 256, 64  # at which the push is computed in a quarter, and between two of these places. x10: only time

_INSIDE = np.linspace(QUARTER, 1 - QUARTER, 34)[1:-1]  # shares of the length in its middle half. x10: only time


def only_at_ends(sol: ShapeArrays, cases: Integers) -> Integers:
    """The computed cases, (k,), rising, on which the cylinder does not pull in their whole middle half.

    The error of the shares is left out: it is as large as the tolerance of the solution lets it be, and would excuse
    stretches with a pull.
    """
    if sol.trajectory.orbit is not None:  # a pull at one of these places is found sooner than by measuring
        cases = cases[_last_pull(sol, cases, np.broadcast_to(_INSIDE, (cases.size, _INSIDE.size)), far=False) < 0]
    if not cases.size:
        return cases
    first, last = (_share_of_pulls(sol, cases, until) for until in (QUARTER, 1 - QUARTER))
    return np.asarray(cases[last - first <= NEGLIGIBLE])  # a stretch that is shorter, of the length, is rounding


def _share_of_pulls(sol: ShapeArrays, cases: Integers, until: float = 1.0) -> Array:
    """The share of the length of some cases, (k,), on which the cylinder would have to pull before `until` of it."""
    read, shapes = MeasuredNumbers(sol), sol.trajectory.shapes
    if shapes is None:
        pulled = read.value("lifted")[cases] if until == 1 else read.over("lifted", until, cases)
        return np.asarray(pulled / read.length[cases])
    ends = until * read.length
    stretches = [[(a, min(b, ends[i])) for a, b in shapes.of(i).lift_offs(1.0) if a < ends[i]] for i in cases.tolist()]
    return np.array([sum(b - a for a, b in each) for each in stretches]) / read.length[cases]


def distance_from_ends(sol: ShapeArrays, cases: Array) -> Array:
    """The largest distance from the nearer end at which the cylinder would have to pull, as a share of the length.

    Parameters
    ----------
    sol : Shape
        The rods.
    cases : array of int, (k,)
        Which of them; the cylinder pulls nowhere in their middle halves.

    Returns
    -------
    array (k,)
        At most `QUARTER`; 0 where no such place is found.
    """
    share = np.zeros(cases.size)
    for far in (False, True):
        places = np.broadcast_to(np.geomspace(QUARTER * 1e-4, QUARTER, PLACES), (cases.size, PLACES))
        at = _last_pull(sol, cases, places, far)
        spread = np.linspace(0, 1, FINER)
        low = np.take_along_axis(places, at[:, None], axis=1)
        high = np.take_along_axis(places, np.minimum(at + 1, PLACES - 1)[:, None], axis=1)
        finer = low + (high - low) * spread
        best = np.take_along_axis(finer, np.maximum(_last_pull(sol, cases, finer, far), 0)[:, None], axis=1)
        share = np.maximum(share, np.where(at < 0, 0, best[:, 0]))
    return share


def _last_pull(sol: ShapeArrays, cases: Array, places: Array, far: bool) -> Array:
    """The number of the last of places (k, m), shares of the length, with a pull, (k,); -1 where there is none.

    far: the places are counted from the far end.
    """
    span = sol.problem.span[cases, None]
    push = _push_terms(sol, cases, span * (1 - places if far else places))
    pulled, m = push.values < -push.rounding, places.shape[1]
    return np.where(pulled.any(axis=1), m - 1 - np.argmax(pulled[:, ::-1], axis=1), -1)


def _push_terms(sol: ShapeArrays, cases: Array, t: Array) -> Any:
    """The push and its rounding at places t (k, m), in units of rho, of some cases (k,), in units of A/rho^3; between
    stations, where the method knows no orbit, linear in t."""
    if sol.trajectory.orbit is None:
        shape = sol.trajectory
        rows = [[np.interp(t[i], sol.t[k], v[k]) for i, k in enumerate(cases)] for v in (shape.beta, shape.dbeta)]
        beta, rate = (np.array(row).reshape(t.shape) for row in rows)
    else:
        beta, rate = sol.trajectory.orbit.take(cases).at(t)[:2]
    problem, sign = sol.problem.take(cases), flat(sol.case.outward, sol.case.shape)[cases]
    return densities("outward", np.stack([problem.lam, problem.mu, problem.phi, sign], axis=1), beta, rate)


TIGHT, MEETS, TURNED, STRAINED, PULLED = "too tight", "overlaps", "turned back", "strained", "pulled"
NO_PUSH, PULL = "no push", "a pull"
AT_ENDS, IN_PART, ALL_ALONG = f"{PULLED} at the ends", f"{PULLED} in part", f"{PULLED} nearly everywhere"
UNKNOWN = "not checked: "
UNCHECKED = (f"{UNKNOWN}curvature", f"{UNKNOWN}self-contact", f"{UNKNOWN}lift-off")
# rad: beyond a quarter turn a rod turns back. x10: no rod does, and the caution is not given
_QUARTER = np.pi / 2 + NEGLIGIBLE
NEARLY_ALL = 0.95  # of the length with a pull. x10: the caution never says so
# least modulus in MPa -> strain up to which its materials are surely linear. Metals, glass and composites: steel of
# grade E-75 yields at 0.25 %, strong wire at 1 %. Plastics are linear to about 1 %, rubber to about 10 %. x10: no
# caution on rods that yield
LINEAR = {1e4: 0.0025, 1e3: 0.01, 0.0: 0.1}
SURELY = min(LINEAR.values())  # where the modulus or its unit is not known: that of metals
JUDGED = ("kappa_max", MEETS, "push_min", "push_max", "attached", "height")  # the observables that a caution is made of


def of_cases(sol: ShapeArrays, observed: Mapping[str, Any] | None = None, unit: str = "", linear: Any = None) -> Any:
    """The caution of each case, (*cases) of str.

    "" means that the rod was checked and is free of all of them, or that the case is not solved. "not checked" means
    that the method knows no orbit and its stations are too few, or that two stretches of the rod are so close over such
    a length that the search for self-contact was abandoned.

    Parameters
    ----------
    sol : Shape
        The cases.
    observed : mapping, optional
        Observables already known, with their errors, by name.
    unit : str
        Unit of length of the cases, in which a distance is stated; default: it is stated as a share of the length.
    linear : array, (*cases)
        The strain up to which the material is surely linear; default: that of metals, and the caution says so.
    """
    known = dict(observed or {})
    needed = [*JUDGED, *(error for name in JUDGED if (error := error_name(name)))]
    missing = dict.fromkeys(name.removesuffix("_error") for name in needed if name not in known)
    known = {**observe(sol, missing, errors=True), **known}
    tight, free = _tight(sol, known)
    meets = np.asarray(known[MEETS], dtype=float)
    pulled, held = _pull(sol, known)
    unknown = zip(UNCHECKED, (~(tight | free), ~np.isfinite(meets), ~(pulled | held)), strict=True)
    text = np.full(sol.case.shape, "", dtype=object)
    strains, limit = largest_strain(sol, known["kappa_max"]), SURELY if linear is None else linear
    of = "metals are " * (linear is None)
    strained = _strain_words(strains, np.broadcast_to(limit, sol.case.shape), of), strains > limit
    sure = (TIGHT, tight), (MEETS, meets == 1), (TURNED, turns_back(sol, known["height"])), strained
    for words, where in (*sure, (_lift_off(sol, known, pulled, unit), pulled), *unknown):
        where = np.asarray(where) & sol.solved
        if where.any():
            text = np.where(where, text + np.where(text == "", "", ", ") + words, text)
    return text.astype(str)


def turns_back(sol: ShapeArrays, height: Any) -> Any:
    """Whether a rod between two ends runs against the direction of both of them, (*cases) of bool.

    Its beta goes more than 90 degrees beyond both end angles; or its ends are parallel, and the far one lies behind the
    start. A rod that may leave the cylinder is not judged. height: z(L) - z(0) [length].
    """
    if not isinstance(sol.problem, EndsProblem) or sol.case.leaves:
        return np.zeros(sol.case.shape, dtype=bool)
    reading = MeasuredNumbers(sol)
    numbers = reading.value("low"), reading.value("high"), sol.problem.beta0, sol.problem.betaL
    low, high, beta0, betaL = (np.reshape(number, sol.case.shape) for number in numbers)
    with np.errstate(invalid="ignore"):
        far = (high > np.maximum(beta0, betaL) + _QUARTER) | (low < np.minimum(beta0, betaL) - _QUARTER)
        behind = np.asarray(height) * np.cos(beta0) < -NEGLIGIBLE * np.asarray(sol.case.rod.L)
        return far | (behind & (np.abs(beta0 - betaL) < NEGLIGIBLE))


def largest_strain(sol: ShapeArrays, kappa_max: Any) -> Any:
    """The largest strain of the section's outermost fibre: along the fibre, or by the twist; (*cases), NaN without E.

    Along the fibre that is a kappa + |F3|/(E S), S the area of the section; by the twist a |M3|/(2 C), the largest
    elongation of a shear. Where the loads are constant along the rod, F3 + A kappa^2/2 is too, and the strain along the
    fibre rises with kappa (up to kappa = 2/a at least); elsewhere it is read along the rod. kappa_max: the largest
    curvature, (*cases) [1/length].
    """
    rod = sol.case.rod
    if rod.E is None:
        return np.full(sol.case.shape, np.nan)
    each = [rod.a, rod.bending_stiffness, rod.E, 0.0 if rod.inner_radius is None else rod.inner_radius, sol.case.rho]
    a, A, E, bore, rho = (flat(value, sol.case.shape) for value in each)
    with np.errstate(all="ignore"):  # a case beyond floats is not solved
        stretch = A / rho**2 / (E * np.pi * (a**2 - bore**2))  # of the unit of forces
        mu, shapes = np.abs(sol.problem.mu), sol.trajectory.shapes
        if shapes is not None and sol.case.cylinder.turns_in_place:  # its torque grows from one end to the other
            mu = np.abs(np.stack(shapes.ends())[:, :, MU]).max(axis=0)
        twisted = a * mu * flat(rod.stiffness_ratio, sol.case.shape) / (2 * rho)
        if shapes is None:
            first, tight = _bend_and_tension(sol), np.reshape(kappa_max, -1) * rho
            along = a / rho * tight + np.abs(first[1] + (first[0] ** 2 - tight**2) / 2) * stretch
        else:
            along = np.full(sol.case.size, np.nan)
            for i in np.flatnonzero(np.reshape(sol.solved, -1)).tolist():
                along[i] = shapes.of(i).largest_strain(a[i] / rho[i], stretch[i])
        return np.maximum(along, twisted).reshape(sol.case.shape)


def _bend_and_tension(sol: ShapeArrays) -> tuple[Array, Array]:
    """kappa and F3 at the first station of rods with constant loads, in units of rho and A, (B,) each."""
    problem, beta, speed = sol.problem, sol.trajectory.beta[:, 0], sol.trajectory.dbeta[:, 0]
    around = circumferential_force(1.0, problem.lam, problem.mu, 1.0, beta)
    return curvature(1.0, beta, speed), surface_forces(around, problem.phi, beta)[1]


def _strain_words(strains: Any, linear: Any, of: str) -> Any:
    """The strain of each rod that is strained too far, in words; "" of the others. (*cases) of str objects.

    of: whose the limit is, where it is not that of materials of the rod's modulus.
    """
    words, far = np.full(np.shape(strains), "", dtype=object), strains > linear
    ends = {limit: f" %; {of}linear to {_round(100 * limit)} %)" for limit in np.unique(linear).tolist()}
    rows = zip(strains[far].tolist(), linear[far].tolist(), strict=True)
    words[far] = [f"{STRAINED} ({_round(100 * strain)}{ends[limit]}" for strain, limit in rows]
    return words


def _tight(sol: ShapeArrays, known: Mapping[str, Any]) -> tuple[Any, Any]:
    """Whether kappa a > 1 somewhere, and whether it surely is nowhere, (*cases)."""
    sure = np.isfinite(known["kappa_max_error"])
    most = np.asarray(known["kappa_max"]) if sure.all() else np.where(sure, known["kappa_max"], sol.kappa.max(axis=-1))
    bend = most * sol.case.rod.a
    return bend > 1, (bend <= 1) & sure


def _pull(sol: ShapeArrays, known: Mapping[str, Any]) -> tuple[Any, Any]:
    """Whether the cylinder would have to pull somewhere, and whether it surely does nowhere, (*cases)."""
    sure = np.isfinite(known["push_min_error"])
    low, high = np.asarray(known["push_min"]), np.asarray(known["push_max"])
    if not sure.all():  # the stations are all there is
        low, high = np.where(sure, low, sol.push.min(axis=-1)), np.where(sure, high, sol.push.max(axis=-1))
    largest = np.maximum(np.abs(low), np.abs(high))
    with np.errstate(all="ignore"):  # on a very large cylinder rho^3 overflows
        unit = sol.case.rod.bending_stiffness / np.asarray(sol.case.rho, dtype=float) ** 3
        least = least_pull(largest, unit)
    known = np.maximum(largest, unit) > np.finfo(float).tiny  # else the push has underflowed, and its sign is lost
    return (low < -least) & known, (low >= -least) & sure & known


def _lift_off(sol: ShapeArrays, known: Mapping[str, Any], pulled: Any, unit: str) -> Any:
    """On how much of each rod that would lift off the cylinder pulls, and where, (*cases) of str objects."""
    pulled = np.reshape(pulled, -1) & np.reshape(sol.solved, -1)
    free = 1 - np.clip(np.reshape(known["attached"], -1), 0, 1)
    words = np.full(pulled.size, PULLED, dtype=object)
    measured = pulled & np.isfinite(free) & np.isfinite(np.reshape(known["attached_error"], -1))
    if not measured.any():
        return words.reshape(sol.case.shape)
    share = np.zeros(pulled.size)
    share[measured] = _share_of_pulls(sol, np.flatnonzero(measured))
    ends = _lift_off_ends(sol, measured & (share <= 0.5))
    length = np.broadcast_to(sol.case.rod.L, sol.case.shape).reshape(-1)
    rows = zip(np.flatnonzero(measured).tolist(), share[measured].tolist(), free[measured].tolist(), strict=True)
    for i, pull, no_push in rows:
        kind = ALL_ALONG if pull >= NEARLY_ALL else AT_ENDS if i in ends else IN_PART
        near = ""
        if i in ends:
            off = f"{_round(ends[i] * length[i])} {unit} of"
            near = f" within {off if unit else f'{_round(100 * ends[i])} % of the length from'} an end"
        what = NO_PUSH if no_push - pull <= SLIGHT else PULL  # elsewhere it may neither push nor pull
        words[i] = f"{kind} ({what} on {_round(100 * pull)} % of the length{near})"
    return words.reshape(sol.case.shape)


def _lift_off_ends(sol: ShapeArrays, candidates: Booleans) -> dict[int, float]:
    """Case -> how far from an end the cylinder pulls, as a share of the length, of rods pressed in between."""
    cases = only_at_ends(sol, np.flatnonzero(candidates)) if candidates.any() else np.array([], dtype=int)
    if (shapes := sol.trajectory.shapes) is not None:
        return {i: float(shapes.of(i).lift_off_reach() / sol.problem.span[i]) for i in cases.tolist()}
    return dict(zip(cases.tolist(), distance_from_ends(sol, cases).tolist(), strict=True)) if cases.size else {}


def _round(value: float) -> str:
    """A positive number with two digits, or without a fraction."""
    return f"{value:.0f}" if 9.95 <= value < 1e5 else f"{value:.2g}"
