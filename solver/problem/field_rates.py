"""The chain rule: how the dimensionless numbers of a case answer a change of each of its fields.

Each derivative is the imaginary part that an imaginary change of the field makes of a number. Nothing is subtracted, so
it is exact to rounding, and the formulas of `Case` and `reduced` stand nowhere else.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..numerics.arrays import Array
from .case import Case, Ends
from .case_fields import unchecked_with_fields, values_of
from .errors import InputError
from .reduced import dimensionless_problem, flat, held_problem

ACTING = ("lam", "mu", "phi", "span", "beta0", "end")  # the numbers on which a shape depends
_OTHERS = ("A", "rho", "ratio", "alpha", "gamma")
_FROM_ENDS = {"lam": "lam", "mu": "mu", "phi": "phi", "beta0": "beta0", "betaL": "end"}
_STEP = 2.0**-60  # of a field, or of one where that is 0: its square is far below rounding


@dataclass(frozen=True, eq=False)
class FieldRates:
    """The derivatives of the numbers of B cases with respect to F fields, (B, F) each.

    lam, mu, phi, span, beta0: as in `Reduced`. end: of beta_t(0) of a start problem, of beta(L) of an ends problem. A,
    rho: as in `Case`. ratio: A/C. alpha, gamma: at the start. given: (B, 5, F), of the five numbers that the ends of an
    ends problem give, in the order of `reduced.given_numbers`; None for a start problem. Numbers that are not given
    have 0.
    """

    fields: tuple[str, ...]
    lam: Array
    mu: Array
    phi: Array
    span: Array
    beta0: Array
    end: Array
    A: Array
    rho: Array
    ratio: Array
    alpha: Array
    gamma: Array
    given: Array | None = None

    def by(self, field: str) -> Array:
        """The derivatives of a field of the case itself, (B, F)."""
        return np.zeros_like(self.rho) + (np.array(self.fields) == field)


def field_rates(case: Case, fields: Sequence[str]) -> FieldRates:
    """The derivatives of the numbers of a case with respect to `fields`, names of `fields_of`.

    Raises `InputError` for the weight or the friction of a case that has none.
    """
    F, moved, steps = len(fields), {}, np.empty((len(fields), case.size))
    alone = np.eye(F).reshape(F, F, *[1] * len(case.shape))  # one row of cases for each field
    for k, field in enumerate(fields):
        if field in ("weight", "friction"):
            raise InputError(f"the derivative by {field} of a rod without {field} is not known; give it a little")
        value = np.broadcast_to(np.asarray(values_of(case, field), dtype=float), case.shape)
        step = _STEP * np.where(value == 0, 1.0, np.abs(value))
        moved[field], steps[k] = value + 1j * step * alone[k], step.reshape(-1)
    with np.errstate(all="ignore"):  # a case whose numbers overflow has an outcome that says so
        numbers, given = _numbers(unchecked_with_fields(case, moved))
        rates = {name: number.imag.reshape(F, -1).T / steps.T for name, number in numbers.items()}
        if given is not None:
            given = np.moveaxis(given.imag.reshape(F, -1, 5) / steps[..., None], 0, 2)
    none = {name: np.zeros((case.size, F)) for name in ACTING if name not in rates}
    return FieldRates(tuple(fields), **rates, **none, given=given)


def _numbers(case: Case) -> tuple[dict[str, Array], Array | None]:
    """The numbers of a case by their names in `FieldRates`, (B,), and those that its ends give, (B, 5)."""
    rod, given = case.rod, case.given
    plain = rod.bending_stiffness, case.rho, rod.stiffness_ratio, given.alpha, given.gamma
    numbers = {name: flat(number, case.shape) for name, number in zip(_OTHERS, plain, strict=True)}
    if isinstance(given, Ends):
        held = held_problem(case)
        known = dict(zip(held.numbers, held.values.T, strict=True))
        known = {_FROM_ENDS[name]: number for name, number in known.items() if name in _FROM_ENDS}
        return numbers | known | {"span": held.span}, held.values
    problem = dimensionless_problem(case, complex)
    return numbers | dict(zip(ACTING, vars(problem).values(), strict=True)), None
