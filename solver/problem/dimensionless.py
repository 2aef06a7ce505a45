"""The dimensionless problems: all that a method sees.

In units of rho (t = s/rho, lam = l rho, mu = m rho, phi = p rho^2) every case leaves three numbers and its ends. E is
in none of them: doubling E and every load changes no bit.

Each dead load has a displacement that does its work: FZ the height, MZ the azimuth, M3 the rotation, and the bending
moment M1 at an end the angle there. An ends problem takes one of each pair; the other one is an unknown. Under dead
loads, which both angles and all three loads determine, it is an `EndsProblem`; with any five given it is a
`HeldProblem`.

How the numbers answer a change of a field of the case is the imaginary part that an imaginary change of the field makes
of a number. Nothing is subtracted, so it is exact to rounding, and the formulas of `Case` and of the reduction stand
nowhere else.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import ROUNDED, Array, Columns, Integers
from ..numerics.complex_step import STEP
from .case import Case, Ends
from .case_fields import values_of, with_fields_unchecked
from .declared_fields import PAIRS, POSITIVE, VARY_LOADS
from .errors import InputError
from .quantities import AT_START, quantity

# The number (`equilibrium.orbit_rates`, and the rotation "turn") that each field of Ends fixes, in the order of PAIRS.
NUMBER_OF = {
    "beta0": "beta0",
    "M10": "dbeta0",
    "betaL": "betaL",
    "M1L": "dbetaL",
    "FZ": "phi",
    "height": "z",
    "MZ": "lam",
    "azimuth": "alpha",
    "M3": "mu",
    "rotation": "turn",
}


def number_of(field: str, value: Any, A: Any, rho: Any) -> Any:
    """The number that a value of a field of `Ends` fixes."""
    if field == "FZ":
        return value / A * rho * rho
    if field in ("MZ", "M3", "M10", "M1L"):
        return value / A * rho
    return value / rho if field == "height" else value


def value_of_number(field: str, number: Any, A: Any, rho: Any) -> Any:
    """The value of a field of `Ends` that fixes a number: the inverse of `number_of`."""
    if field == "FZ":
        return number * A / rho / rho
    if field in ("MZ", "M3", "M10", "M1L"):
        return number * A / rho
    return number * rho if field == "height" else number


@dataclass(frozen=True, eq=False)
class Reduced(Columns):
    """The fields that both kinds of problem share, for B problems, (B,) each.

    lam, mu, phi: MZ rho/A, M3 rho/A, FZ rho^2/A. span: L/rho. beta0: angle at the start.
    """

    lam: Array
    mu: Array
    phi: Array
    span: Array
    beta0: Array

    @property
    def size(self) -> int:
        """The number of problems."""
        return self.beta0.size

    def with_start(self, dbeta0: Array) -> "StartProblem":
        """The start problems with the same loads, length and beta0, and the given slopes."""
        return StartProblem(self.lam, self.mu, self.phi, self.span, self.beta0, dbeta0)

    def with_end(self, betaL: Array) -> "EndsProblem":
        """The ends problems with the same loads, length and beta0, and the given far angles."""
        return EndsProblem(self.lam, self.mu, self.phi, self.span, self.beta0, betaL)


@dataclass(frozen=True, eq=False)
class StartProblem(Reduced):
    """B start problems. dbeta0: d beta/dt at the start, (B,)."""

    dbeta0: Array
    kind: ClassVar[str] = "start"


@dataclass(frozen=True, eq=False)
class EndsProblem(Reduced):
    """B ends problems. betaL: angle at the far end, (B,)."""

    betaL: Array
    kind: ClassVar[str] = "ends"


@dataclass(frozen=True, eq=False)
class HeldProblem(Columns):
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

    def known(self, number: str) -> Array | None:
        """The given values of a number, (B,); None where it is unknown."""
        return self.values[:, self.numbers.index(number)] if number in self.numbers else None


def fields_held(case: Case) -> tuple[str, ...]:
    """The fields of a case that replace a dead load or an end angle; empty for dead loads and for a start problem."""
    if not isinstance(case.given, Ends):
        return ()
    return tuple(partner for _, partner in PAIRS if getattr(case.given, partner) is not None)


def end_fields(case: Case) -> tuple[str, ...]:
    """The five fields of `Ends` that a case gives, one of each of `PAIRS`."""
    return tuple(field if getattr(case.given, field) is not None else partner for field, partner in PAIRS)


def end_number_names(case: Case) -> tuple[str, ...]:
    """The names of the five numbers that the ends of a case give."""
    return tuple(NUMBER_OF[name] for name in end_fields(case))


def reduce(case: Case) -> StartProblem | EndsProblem:
    """The dimensionless problems of a case; section 2 of the physics notes.

    Raises `InputError` for a case whose loads vary along the rod.
    """
    refuse_varying(case)
    return dimensionless_problem(case)


def dimensionless_problem(case: Case, kind: type = float) -> StartProblem | EndsProblem:
    """The dimensionless problem of any case, of varying loads those that it gives. kind: of the numbers."""
    numbers = dimensionless_numbers(case, kind).reshape(6, -1)
    return EndsProblem(*numbers) if isinstance(case.given, Ends) else StartProblem(*numbers)


def dimensionless_numbers(case: Case, kind: type = float) -> Array:
    """The fields of the problems, (6, *cases)."""
    FZ, MZ, M3 = case.loads
    rho, A, given = case.rho, case.rod.bending_stiffness, case.given
    numbers: Array = np.empty((6, *case.shape), kind)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        numbers[0], numbers[1] = number_of("MZ", MZ, A, rho), number_of("M3", M3, A, rho)
        numbers[2], numbers[3] = number_of("FZ", FZ, A, rho), case.rod.L / rho
        ends = (given.beta0, given.betaL) if isinstance(given, Ends) else (given.beta, given.dbeta * rho)
        numbers[4], numbers[5] = ends
    return numbers


def span_of(case: Case) -> Array:
    """L/rho, (B,)."""
    return flat(case.rod.L / case.rho, case.shape)


def refuse_varying(case: Case) -> None:
    """Raise `InputError` for a case whose loads vary along the rod."""
    if case.varies:
        given = ((name, value) for _, name, value in case._numeric if name in VARY_LOADS)
        got = " and ".join(f"{name}={value}" for name, value in given if np.any(value))
        raise InputError(
            f"this task needs loads that are constant along the rod, got {got}; of a rod with weight or friction "
            "solve, observe, follow, equilibria, sensitivity and fit are known"
        )


def flat(value: Any, shape: tuple[int, ...]) -> Array:
    """A field of a case as a contiguous array, (B,)."""
    value = np.asarray(value)
    value = np.asarray(value, dtype=complex if value.dtype.kind == "c" else float)
    if value.ndim == 0:
        return np.full(math.prod(shape), value)
    return np.ascontiguousarray(np.broadcast_to(value, shape)).reshape(-1)


def size_of_field(case: Case, name: str, unit: Any = None) -> Array:
    """The size of a field of a case, (B,): its own; of one that may be 0 at least that of its dimension.

    name: of the field, or of its quantity. unit: the length of which, and of A, the dimension is made; default: L.
    """
    size = np.abs(flat(values_of(case, name), case.shape))
    if name in (*POSITIVE, "inner_radius"):
        return size
    return np.maximum(size, natural_unit(case, name, case.rod.L if unit is None else unit))


def natural_unit(case: Case, name: str, unit: Any = None) -> Array:
    """The unit of a quantity that a length and A make, (B,). unit: this length; default: rho."""
    unit, A = (flat(value, case.shape) for value in (case.rho if unit is None else unit, case.rod.bending_stiffness))
    dimension = quantity(AT_START.get(name, name)).dimension
    length, force = dimension if not isinstance(dimension, str) else (-1 if "length" in dimension else 0, 0)
    natural: Array = unit ** float(length) * (A / unit**2) ** float(force)
    return natural


def reduce_held(case: Case) -> HeldProblem:
    """The five given numbers of a case with Ends. Raises `InputError` where loads vary along the rod."""
    refuse_varying(case)
    return problem_at_ends(case)


def problem_at_ends(case: Case) -> HeldProblem:
    """The five given numbers of any case with Ends; of varying loads those of the far end."""
    fields = end_fields(case)
    with np.errstate(all="ignore"):  # overflow is reported in the outcome
        *five, span, ratio = (flat(number, case.shape) for number in end_values(case, fields))
    return HeldProblem(fields, np.stack(five, axis=1), span, ratio)


def end_values(case: Case, fields: Sequence[str], new: Mapping[str, Any] | None = None) -> tuple[Any, ...]:
    """The five given numbers, L/rho and A/C of an ends problem; new: values in place of those of its ends."""
    A, rho, new = case.rod.bending_stiffness, case.rho, new or {}
    five = [number_of(name, new[name] if name in new else getattr(case.given, name), A, rho) for name in fields]
    return (*five, case.rod.L / rho, case.rod.stiffness_ratio)


def numbers_over(case: Case, *names: str) -> Callable[..., tuple[float, ...]]:
    """The five given numbers, L/rho and A/C of one ends problem over some fields: those of `problem_at_ends`, for
    valid values, many times as fast."""
    fields, alters_rod = end_fields(case), any(not hasattr(case.given, name) for name in names)

    def numbers(*values: float) -> tuple[float, ...]:
        new = dict(zip(names, values, strict=True))
        return end_values(with_fields_unchecked(case, new) if alters_rod else case, fields, new)

    return numbers


def loads_of(problem: Reduced, A: Any, rho: Any, shape: tuple[int, ...]) -> tuple[Array, Array, Array]:
    """FZ, MZ and M3 of B problems, (B,) each."""
    A, rho = flat(A, shape), flat(rho, shape)
    with np.errstate(all="ignore"):
        return (
            value_of_number("FZ", problem.phi, A, rho),
            value_of_number("MZ", problem.lam, A, rho),
            value_of_number("M3", problem.mu, A, rho),
        )


ACTING = ("lam", "mu", "phi", "span", "beta0", "end")  # the numbers on which a shape depends
NUMBERS = (*ACTING, "A", "rho", "ratio", "alpha", "gamma")


@dataclass(frozen=True, eq=False)
class FieldRates:
    """The derivatives of the numbers of B cases with respect to F fields.

    table: (11, B, F), by number as in `NUMBERS`. lam, mu, phi, span, beta0: as in `Reduced`. end: of beta_t(0) of a
    start problem, of beta(L) of an ends problem. A, rho: as in `Case`. ratio: A/C. alpha, gamma: at the start. given:
    (B, 5, F), of the five numbers that the ends of an ends problem give, in the order of `given_numbers`; None
    for a start problem. Numbers that are not given have 0.
    """

    fields: tuple[str, ...]
    table: Array
    given: Array | None = None

    def of(self, number: str) -> Array:
        """The derivatives of one of `NUMBERS`, (B, F)."""
        rates: Array = self.table[NUMBERS.index(number)]
        return rates

    def by(self, field: str) -> Array:
        """The derivatives of a field of the case itself, (B, F)."""
        return np.zeros_like(self.table[0]) + (np.array(self.fields) == field)

    def take(self, rows: Integers) -> "FieldRates":
        """The rates of some of the cases."""
        return FieldRates(self.fields, self.table[:, rows], None if self.given is None else self.given[rows])


def field_rates(case: Case, fields: Sequence[str]) -> FieldRates:
    """The derivatives of the numbers of a case with respect to `fields`, names of `fields_of`.

    Raises `InputError` for the weight or the friction of a case that has none.
    """
    F, size = len(fields), case.size
    moved = np.empty((F, F, *case.shape), dtype=complex)  # one row of cases for each field
    steps = np.empty((F, *case.shape))
    for k, field in enumerate(fields):
        if field in VARY_LOADS:
            raise InputError(f"the derivative by {field} of a rod without {field} is not known; give it a little")
        moved[k] = steps[k] = values_of(case, field)
    has_size = steps != 0
    steps = STEP * np.where(has_size, np.abs(steps), 1.0)
    moved.imag[range(F), range(F)] = steps
    with np.errstate(all="ignore"):  # a case whose numbers overflow has an outcome that says so
        other = with_fields_unchecked(case, dict(zip(fields, moved, strict=True)))
        vars(other)["shape"] = moved.shape[1:]
        numbers, given = _numbers(other)
        numbers[:3].imag[has_size & _is_rounding(numbers[:3])] = 0.0
        steps = steps.reshape(F, size)
        table = np.ascontiguousarray((numbers.imag.reshape(-1, F, size) / steps).swapaxes(1, 2))
        if given is not None:
            given = np.moveaxis(given.imag.reshape(F, size, 5) / steps[..., None], 0, 2)
    return FieldRates(tuple(fields), table, given)


def _is_rounding(loads: Array) -> NDArray[np.bool_]:
    """Which changes of lam, mu and phi by `STEP` of each field, (3, F, *cases), are rounding of terms that cancel."""
    size = STEP * (1 + np.abs(loads.real).sum(axis=0))
    return np.asarray(np.abs(loads.imag) < ROUNDED * size)


def _numbers(case: Case) -> tuple[Array, Array | None]:
    """The `NUMBERS` of a case, (11, *cases), and those that its ends give, (B, 5)."""
    rod, given = case.rod, case.given
    numbers = np.zeros((len(NUMBERS), *case.shape), dtype=complex)
    others = rod.bending_stiffness, case.rho, rod.stiffness_ratio, given.alpha, given.gamma
    for k, number in enumerate(others, len(ACTING)):
        numbers[k] = number
    if not isinstance(given, Ends):
        numbers[: len(ACTING)] = dimensionless_numbers(case, complex)
        return numbers, None
    held = problem_at_ends(case)
    for name, values in {"span": held.span, **dict(zip(held.numbers, held.values.T, strict=True))}.items():
        if (number := "end" if name == "betaL" else name) in ACTING:
            numbers[NUMBERS.index(number)] = values.reshape(case.shape)
    return numbers, held.values
