"""The chain rule: how the dimensionless numbers of a case answer a change of each of its fields.

Each derivative is the imaginary part that an imaginary change of the field makes of a number. Nothing is subtracted, so
it is exact to rounding, and the formulas of `Case` and `reduced` stand nowhere else.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array, Integers
from ..numerics.complex_step import STEP
from .case import Case, Ends
from .case_fields import unchecked_with_fields, values_of
from .errors import InputError
from .reduced import dimensionless_numbers, held_problem

ACTING = ("lam", "mu", "phi", "span", "beta0", "end")  # the numbers on which a shape depends
NUMBERS = (*ACTING, "A", "rho", "ratio", "alpha", "gamma")
_FROM_ENDS = {"lam": "lam", "mu": "mu", "phi": "phi", "beta0": "beta0", "betaL": "end"}


@dataclass(frozen=True, eq=False)
class FieldRates:
    """The derivatives of the numbers of B cases with respect to F fields.

    table: (11, B, F), by number as in `NUMBERS`. lam, mu, phi, span, beta0: as in `Reduced`. end: of beta_t(0) of a
    start problem, of beta(L) of an ends problem. A, rho: as in `Case`. ratio: A/C. alpha, gamma: at the start. given:
    (B, 5, F), of the five numbers that the ends of an ends problem give, in the order of `reduced.given_numbers`; None
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
        if field in ("weight", "friction"):
            raise InputError(f"the derivative by {field} of a rod without {field} is not known; give it a little")
        moved[k] = steps[k] = values_of(case, field)
    steps = STEP * np.where(steps == 0, 1.0, np.abs(steps))
    moved.imag[range(F), range(F)] = steps
    with np.errstate(all="ignore"):  # a case whose numbers overflow has an outcome that says so
        other = unchecked_with_fields(case, dict(zip(fields, moved, strict=True)))
        vars(other)["shape"] = moved.shape[1:]
        numbers, given = _numbers(other)
        steps = steps.reshape(F, size)
        table = np.ascontiguousarray((numbers.imag.reshape(-1, F, size) / steps).swapaxes(1, 2))
        if given is not None:
            given = np.moveaxis(given.imag.reshape(F, size, 5) / steps[..., None], 0, 2)
    return FieldRates(tuple(fields), table, given)


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
    held = held_problem(case)
    for name, values in {"span": held.span, **dict(zip(held.numbers, held.values.T, strict=True))}.items():
        if name in _FROM_ENDS or name == "span":
            numbers[NUMBERS.index(_FROM_ENDS.get(name, name))] = values.reshape(case.shape)
    return numbers, held.values
