"""Ends problems in which displacements are held instead of loads, or end moments are given instead of end angles.

Each dead load has a displacement that does its work: FZ the height, MZ the azimuth, M3 the rotation, and the bending
moment M1 at an end the angle there. An ends problem takes one of each pair; the other one is an unknown.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .case import PAIRS, Case, Ends
from .case_fields import unchecked_with_field
from .reduced import Reduced, flat, refuse_varying

# The number (`equilibrium.orbit_rates`, and the rotation "turn") that each field of Ends fixes, in the order of PAIRS.
NUMBER_OF = {
    "beta0": "beta0", "M10": "dbeta0", "betaL": "betaL", "M1L": "dbetaL",
    "FZ": "phi", "height": "z", "MZ": "lam", "azimuth": "alpha", "M3": "mu", "rotation": "turn",
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class HeldProblem:
    """B ends problems, each with five given numbers.

    given: the names of the five fields, one of each of `PAIRS`. values: (B, 5), the numbers of `NUMBER_OF` that they
    fix: angles, beta_t = M1 rho/A, phi, z/rho, lam, azimuth, mu, rotation. span: L/rho, (B,). ratio: A/C, (B,).
    """

    given: tuple[str, ...]
    values: Array
    span: Array
    ratio: Array

    @property
    def size(self) -> int:
        """The number of problems."""
        return self.span.size

    @property
    def numbers(self) -> tuple[str, ...]:
        """The names of the five numbers."""
        return tuple(NUMBER_OF[name] for name in self.given)

    def take(self, index: Any) -> "HeldProblem":
        """The problems that an index array, a mask or a slice selects."""
        return HeldProblem(self.given, self.values[index], self.span[index], self.ratio[index])

    def known(self, number: str) -> Array | None:
        """The given values of a number, (B,); None where it is unknown."""
        return self.values[:, self.numbers.index(number)] if number in self.numbers else None


def held_of(case: Case) -> tuple[str, ...]:
    """The fields of a case that replace a dead load or an end angle; empty for dead loads and for a start problem."""
    if not isinstance(case.given, Ends):
        return ()
    return tuple(partner for _, partner in PAIRS if getattr(case.given, partner) is not None)


def given_fields(case: Case) -> tuple[str, ...]:
    """The five fields of `Ends` that a case gives, one of each of `PAIRS`."""
    return tuple(field if getattr(case.given, field) is not None else partner for field, partner in PAIRS)


def given_numbers(case: Case) -> tuple[str, ...]:
    """The names of the five numbers that the ends of a case give."""
    return tuple(NUMBER_OF[name] for name in given_fields(case))


def reduce_held(case: Case) -> HeldProblem:
    """The dimensionless numbers of a case with Ends. Raises `InputError` where loads vary along the rod."""
    refuse_varying(case)
    return held_problem(case)


def held_problem(case: Case) -> HeldProblem:
    """The same of any case with Ends; where loads vary along the rod, its loads are those of the far end."""
    g, A, rho = case.given, case.rod.bending_stiffness, case.rho
    assert isinstance(g, Ends)
    with np.errstate(all="ignore"):  # overflow is reported in the outcome
        factor, given = _factors(A, rho), given_fields(case)
        columns = [flat(getattr(g, name) * factor.get(name, 1.0), case.shape) for name in given]
        span, ratio = flat(case.rod.L / rho, case.shape), flat(case.rod.stiffness_ratio, case.shape)
    return HeldProblem(given, np.stack(columns, axis=1), span, ratio)


def held_numbers_over(case: Case, *names: str) -> Callable[..., tuple[float, ...]]:
    """The five given numbers, L/rho and A/C of one held problem over some fields: those of `reduce_held`."""
    given = given_fields(case)
    alters_rod = any(not hasattr(case.given, name) for name in names)

    def numbers(*values: float) -> tuple[float, ...]:
        new, moved = dict(zip(names, values, strict=True)), case
        for name, value in new.items() if alters_rod else ():
            moved = unchecked_with_field(moved, name, value)
        A, rho = moved.rod.bending_stiffness, moved.rho
        factor = _factors(A, rho)
        in_units = (new[key] if key in new else getattr(case.given, key) for key in given)
        fixed = (number * factor.get(key, 1.0) for key, number in zip(given, in_units, strict=True))
        return (*fixed, moved.rod.L / rho, moved.rod.stiffness_ratio)

    return numbers


def _factors(A: Any, rho: Any) -> dict[str, Any]:
    """What makes dimensionless numbers of the fields of `Ends`."""
    return {"M10": rho / A, "M1L": rho / A, "FZ": rho * rho / A, "MZ": rho / A, "M3": rho / A, "height": 1 / rho}


def loads_of(problem: Reduced, A: Any, rho: Any, shape: tuple[int, ...]) -> tuple[Array, Array, Array]:
    """FZ, MZ and M3 of B problems, (B,) each."""
    A, rho = flat(A, shape), flat(rho, shape)
    with np.errstate(all="ignore"):
        return problem.phi * A / rho / rho, problem.lam * A / rho, problem.mu * A / rho
