"""Whether floats can represent a case: its stiffness, forces, curvatures and their squares, in its own units.

And whether its held ends are within reach of each other.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import ROUNDED, SQUARE_LOST
from .case import Case, Start
from .dimensionless import HeldProblem, Reduced, StartProblem, flat


@dataclass(frozen=True)
class _SizeLimit:
    """A size of dimensionless numbers up to which problems are solved, and the outcome of those beyond it."""

    most: float
    why: str


# a larger dimensionless number would overflow when squared with a margin for sums. x10: as good; 1e154 overflows
LARGEST = _SizeLimit(
    1e100, "failed: loads, slope or L/rho are beyond 1e100 in units of A and rho, or L/rho below 1e-200"
)
# of problems with held ends, whose search takes fourth powers. x10: as good; 1e77 overflows
LARGEST_HELD = _SizeLimit(
    1e70, "failed: held numbers, loads or L/rho are beyond 1e70 in units of A and rho, or L/rho below 1e-70"
)
# of L/rho between two ends: beyond, a rounding of s is larger than rho. x10: the far end is anywhere around the
# cylinder
LONGEST = _SizeLimit(
    1e16, "failed: L/rho of a problem between two ends must be below 1e16; beyond, rounding of s exceeds rho"
)
OUT_OF_RANGE = "failed: stiffness, radius, forces or curvatures are beyond 1e290 or 1e-290 in these units"
TAUT = (
    "the ends are held as far apart, along the cylinder, as the rod is long; it can only be straight or a helix then, "
    "and the force that holds it so is not determined"
)
# with it the largest sum of decades in `representable` is 62 + 7 * 30 = 272. x10: 279, still below `_DECADES`
_ORDINARY = 1e30
_DECADES = 290.0  # a float has 308; the margin is for factors and sums. x10: cases overflow instead of being refused


def beyond_limits(problem: Reduced | HeldProblem) -> NDArray[np.str_]:
    """The outcome of each problem whose numbers cannot be squared, or whose L/rho is beyond a limit, (B,); else ""."""
    numbers = np.column_stack([part for part in vars(problem).values() if isinstance(part, np.ndarray)])
    with np.errstate(invalid="ignore"):
        short = (problem.span < LONGEST.most) | isinstance(problem, StartProblem)
        held = isinstance(problem, HeldProblem)
        limit = LARGEST_HELD if held else LARGEST
        least = 1 / limit.most if held else limit.most**-2  # below it times underflow
        fine = (np.abs(numbers) < limit.most).all(axis=1) & (problem.span > least)
    return np.where(fine, np.where(short, "", LONGEST.why), limit.why)


def refusals(case: Case, problem: Reduced) -> NDArray[np.str_]:
    """Why floats cannot hold each problem of a case, or its solution in the units of the case, (B,); "" where they can.

    Between ends beta'(0) is not known, so `representable` judges the solution again.
    """
    limits = beyond_limits(problem)
    first = [~units_held(case), limits == LARGEST.why, ~representable(case, problem), twist_lost(case, problem)]
    lost = (
        "failed: M3 is lost in rounding, as GJ is so much larger than EI that the last digit of dgamma decides: give M3"
    )
    return np.select(first, [OUT_OF_RANGE, LARGEST.why, OUT_OF_RANGE, lost], limits)


def farthest(case: Case) -> tuple[NDArray[np.str_], NDArray[np.float64]]:
    """The field of each case whose value is farthest from 1 by its decades, by name, and this value, (B,) each."""
    named = [(name, flat(value, case.shape)) for _, name, value in case._numeric]
    values = np.stack([value for _, value in named])
    with np.errstate(divide="ignore"):
        decades = np.where(values == 0, 0, np.abs(np.log10(np.abs(values))))
    which = np.argmax(decades, axis=0)
    return np.array([name for name, _ in named])[which], values[which, np.arange(which.size)]


def beyond(why: Any, case: Case) -> NDArray[np.str_]:
    """The outcomes of cases out of range, (B,): why, one or (B,), and the field that is farthest from 1."""
    rows = zip(np.broadcast_to(why, case.size), *(part.tolist() for part in farthest(case)), strict=True)
    return np.array([f"{said}; the most extreme field is {name} = {value:g}" for said, name, value in rows])


def reason_beyond(why: str, case: Case) -> str:
    """The outcome of one case out of range, for a list that it leaves empty, and for an error."""
    return str(beyond(why, case)[0]).removeprefix("failed: ")


def units_held(case: Case) -> NDArray[np.bool_]:
    """Whether A and the square of rho are neither denormal nor infinite, (B,)."""
    with np.errstate(all="ignore"):
        A, rho = (np.log10(flat(v, case.shape)) for v in (case.rod.bending_stiffness, case.rho))
        return np.asarray((np.abs(A) < _DECADES) & (2 * np.abs(rho) < _DECADES))


def twist_lost(case: Case, problem: Reduced) -> NDArray[np.bool_]:
    """Whether the rounding of dgamma + sin cos/rho decides M3, (B,): GJ times it, eq. (24)."""
    given = case.given
    if not isinstance(given, Start) or given.dgamma is None:
        return np.zeros(case.size, dtype=bool)
    with np.errstate(all="ignore"):
        parts = np.abs(case.rho * given.dgamma) + np.abs(np.sin(2 * given.beta) / 2)
        loads = np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 1
        return flat(2.0**-52 * parts / case.rod.stiffness_ratio, case.shape) > SQUARE_LOST * loads


def unreachable(height: float, azimuth: float, span: float, seeded: bool = False) -> str:
    """Why no rod of a span reaches from end to end, or only a taut one does; "" where one may.

    height, azimuth: over rho, 0 where not held. seeded: whether there is a seed, which may be a taut helix itself.
    """
    apart = np.hypot(height, azimuth)
    taut = abs(apart - span) <= ROUNDED * span and not (seeded and azimuth)
    return TAUT if taut else too_far(height, azimuth, span)


def too_far(height: float, azimuth: float, span: float) -> str:
    """That no rod of a span reaches from end to end, in words."""
    apart = float(np.hypot(height, azimuth)) / span
    if not apart > 1 + ROUNDED:
        return ""
    return f"the ends are held apart, along the cylinder, by {apart:.6g} times the length of the rod"


def ends_and_span(problem: HeldProblem) -> tuple[float, float, float]:
    """What `unreachable` and `too_far` take of one problem: height and azimuth over rho, 0 where not held, and span."""
    held = (problem.known(number) for number in ("z", "alpha"))
    height, azimuth = (0.0 if values is None else float(values[0]) for values in held)
    return height, azimuth, float(problem.span[0])


def representable(case: Case, problem: Reduced) -> NDArray[np.bool_]:
    """Whether every quantity of each solution is finite in the units of its case, for any shape of the rod, (B,).

    Each quantity is a sum of products of powers of A, rho, L/rho and q, where q bounds beta_t^2 and the square of the
    dimensionless loads; so it is enough to add decades.
    """
    slope = problem.dbeta0 if isinstance(problem, StartProblem) else 0.0
    with np.errstate(all="ignore"):
        A, rho = (np.log10(flat(v, case.shape)) for v in (case.rod.bending_stiffness, case.rho))
        loads = np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 1
        q, span = np.log10(np.maximum(loads**2, loads + slope**2)), np.log10(np.maximum(problem.span, 1))
        quantities = (
            rho + span,  # L, z
            q + span,  # gamma
            q - np.minimum(2 * rho, 3 * rho),  # h, kappa^2, and the terms of contact
            A + q - np.minimum(rho, 3 * rho),  # moments, forces, contact
            A + q - 2 * rho + np.maximum(rho + span, 0),  # energy
        )
        return np.asarray(units_held(case) & (np.max(quantities, axis=0) < _DECADES))


def ordinary(case: Case, problem: Reduced) -> bool:
    """Whether all numbers of all cases lie so far inside the range of floats that every other limit is kept as well."""
    least, numbers = 1 / _ORDINARY, vars(problem).values()
    lengths = case.rod.bending_stiffness, case.rho, problem.span
    if problem.size == 1:  # much quicker than arrays of one
        fits = [abs(v.item()) < _ORDINARY for v in numbers]
        fits += [least < np.asarray(v).item() < _ORDINARY for v in lengths]
    else:
        fits = [bool(np.abs(v).max() < _ORDINARY) for v in numbers]
        fits += [bool(np.min(v) > least and np.max(v) < _ORDINARY) for v in lengths]
    return all(fits) and not twist_lost(case, problem).any()  # a comparison with NaN is False
