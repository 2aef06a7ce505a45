"""How the dimensionless numbers of a solution between two ends answer a change of each field of its case.

What is given answers directly; the loads that are found follow from the equations of the equilibrium
(`motions.Motion.parts`).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ..numerics.arrays import Array
from ..problem.case import Ends
from ..problem.field_rates import FieldRates, field_rates
from ..problem.held_ends import given_numbers, under_dead_loads
from ..problem.reduced import EndsProblem, flat
from ..shape import Shape

_HELD = ("height", "azimuth", "rotation", "M10", "M1L")


def ends_field_rates(sol: Shape, fields: Sequence[str]) -> FieldRates:
    """The derivatives of the numbers of an ends problem by fields of its case, but those of loads that are found."""
    case, problem = sol.case, sol.problem
    assert isinstance(problem, EndsProblem)
    plain = [name for name in fields if name not in _HELD]
    dead = under_dead_loads(case, problem) if sol.held else case
    base = _widen(field_rates(dead, plain), plain, fields, case.size)
    return replace(base, given=_values(sol, base, fields, given_numbers(case)))


def _widen(rates: FieldRates, own: Sequence[str], fields: Sequence[str], size: int) -> FieldRates:
    """The rates by `fields`, 0 for those that are not among `own`."""
    columns = {}
    for name, value in vars(rates).items():
        if name not in ("fields", "given"):
            columns[name] = np.zeros((size, len(fields)))
            columns[name][:, [list(fields).index(one) for one in own]] = value
    return FieldRates(tuple(fields), **columns)


def _values(sol: Shape, base: FieldRates, fields: Sequence[str], numbers: tuple[str, ...]) -> Array:
    """The derivatives of the five given numbers, (B, 5, F)."""
    case, problem = sol.case, sol.problem
    given, shape = case.given, case.shape
    assert isinstance(given, Ends)
    A, rho = (flat(value, shape)[:, None] for value in (case.rod.bending_stiffness, case.rho))

    def by(name: str) -> Array:
        return np.asarray(np.array(fields) == name)

    def own(name: str) -> Array:
        return flat(getattr(given, name), shape)[:, None]

    def moment(name: str) -> Array:
        return by(name) * rho / A + own(name) * (base.rho - rho / A * base.A) / A

    rules: dict[str, Callable[[], Array]] = {
        "beta0": lambda: base.beta0, "betaL": lambda: base.end,
        "phi": lambda: base.phi, "lam": lambda: base.lam, "mu": lambda: base.mu,
        "z": lambda: by("height") / rho - own("height") / rho**2 * base.rho,
        "alpha": lambda: by("azimuth") + 0 * rho,
        "turn": lambda: by("rotation") - (problem.mu * problem.span)[:, None] * base.ratio,
        "dbeta0": lambda: moment("M10"), "dbetaL": lambda: moment("M1L"),
    }  # fmt: skip
    return np.stack([np.broadcast_to(rules[name](), base.rho.shape) for name in numbers], axis=1)
