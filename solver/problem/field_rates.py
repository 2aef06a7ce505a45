"""The chain rule: how the dimensionless numbers of a case answer a change of each of its fields.

Each field acts through A, A/C, rho, L and the values given at the ends. The partial derivatives of `Case.loads` and
`reduced.reduce` stand here and nowhere else.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .case import Case, Ends
from .errors import InputError, choices, near
from .reduced import flat
from .rod import fourth_powers

NUMBERS = ("lam", "mu", "phi", "span", "beta0", "end", "A", "rho", "ratio", "alpha", "gamma")
# Fields of Start and Ends whose quantity has another name.
_QUANTITY = {"beta": "beta0", "dbeta": "dbeta0", "alpha": "alpha0", "gamma": "gamma0"}

Partials = dict[str, Any]  # number -> its derivative, (B,) or a float; a number that is not there has none


@dataclass(frozen=True, eq=False)
class FieldRates:
    """The derivatives of the numbers of B cases with respect to F fields, (B, F) each.

    lam, mu, phi, span, beta0: as in `Reduced`. end: of beta_t(0) of a start problem, of beta(L) of an ends problem. A,
    rho: as in `Case`. ratio: A/C. alpha, gamma: at the start. given: (B, 5, F), of the five numbers that the ends of an
    ends problem give; None for a start problem.
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


def fields_of(case: Case) -> tuple[str, ...]:
    """The names of the fields of a case with respect to which there are derivatives."""
    given = (_QUANTITY.get(name, name) for part, name, _ in case._numeric() if part is case.given)
    return (*(name for part, name, _ in case._numeric() if part is not case.given), *given)


def check_fields(case: Case, names: Any) -> tuple[str, ...]:
    """The names as a tuple. Raises `InputError` for a name that is no numeric field of the case or is repeated."""
    fields = (names,) if not isinstance(names, Iterable) or isinstance(names, str) else tuple(names)
    known = fields_of(case)
    for name in fields:
        if name not in known:
            raise InputError(f"no field {name!r} in this case{near(name, known)}; choose from {choices(known)}")
    if not fields or len(set(fields)) < len(fields):
        raise InputError(f"fields must be one or several different names, got {choices(fields) or 'none'}")
    return fields


def field_rates(case: Case, fields: Sequence[str]) -> FieldRates:
    """The derivatives of the numbers of a case with respect to `fields`, names of `fields_of`."""
    with np.errstate(all="ignore"):  # a case whose numbers overflow has an outcome that says so
        table = _ends_partials(case) if isinstance(case.given, Ends) else _start_partials(case)
        found = {number: np.zeros((case.size, len(fields))) for number in NUMBERS}
        for k, field in enumerate(fields):
            for source, factor in _SOURCES.get(field, _itself)(case, field):
                for number, value in table[source]().items():
                    found[number][:, k] += flat(value * factor, case.shape)
    return FieldRates(tuple(fields), **found)


def _itself(case: Case, field: str) -> list[tuple[str, Any]]:
    return [(field, 1.0)]


def _of_radius(case: Case, _: str) -> list[tuple[str, Any]]:
    rod = case.rod
    by_a = 4 * rod.bending_stiffness / rod.a if rod.E is not None else 0.0
    if rod.inner_radius is not None:
        by_a = 4 * rod.bending_stiffness * (np.power(rod.a, 3.0) / fourth_powers(rod.a, rod.inner_radius))
    return [("A", by_a), ("rho", case.outward)]


def _of_bore(case: Case, _: str) -> list[tuple[str, Any]]:
    rod = case.rod
    by_bore = np.power(rod.inner_radius, 3.0) / fourth_powers(rod.a, rod.inner_radius)
    return [("A", -4 * rod.bending_stiffness * by_bore)]


# How fields act on A, A/C and rho; every other field is a source of its own.
_SOURCES: dict[str, Callable[[Case, str], list[tuple[str, Any]]]] = {
    "E": lambda case, _: [("A", case.rod.bending_stiffness / case.rod.E)],
    "nu": lambda case, _: [("ratio", 1.0)],
    "EI": lambda case, _: [("A", 1.0), ("ratio", 1 / case.rod.GJ)],
    "GJ": lambda case, _: [("ratio", -case.rod.stiffness_ratio / case.rod.GJ)],
    "a": _of_radius,
    "inner_radius": _of_bore,
    "R": lambda case, _: [("rho", 1.0)],
}


def _common(case: Case) -> dict[str, Callable[[], Partials]]:
    rho, L = case.rho, case.rod.L
    return {
        "L": lambda: {"span": 1 / rho},
        "alpha0": lambda: {"alpha": 1.0},
        "gamma0": lambda: {"gamma": 1.0},
        "rho": lambda: {"rho": 1.0, "span": -L / rho**2},
        "A": lambda: {"A": 1.0},
        "ratio": lambda: {"ratio": 1.0},
    }


def _ends_partials(case: Case) -> dict[str, Callable[[], Partials]]:
    """lam = MZ rho/A, mu = M3 rho/A, phi = FZ rho^2/A."""
    (FZ, MZ, M3), A, rho, common = case.loads, case.rod.bending_stiffness, case.rho, _common(case)
    return common | {
        "A": lambda: common["A"]() | {"lam": -MZ * rho / A / A, "mu": -M3 * rho / A / A, "phi": -FZ * rho**2 / A / A},
        "rho": lambda: common["rho"]() | {"lam": MZ / A, "mu": M3 / A, "phi": 2 * FZ * rho / A},
        "FZ": lambda: {"phi": rho**2 / A},
        "MZ": lambda: {"lam": rho / A},
        "M3": lambda: {"mu": rho / A},
        "beta0": lambda: {"beta0": 1.0},
        "betaL": lambda: {"end": 1.0},
    }


def _start_partials(case: Case) -> dict[str, Callable[[], Partials]]:
    """lam = rho^2 FY/A + rho m cos(beta) + sin(beta)^3, mu = rho m, phi = rho^2 FZ/A, with m = M3/A from the twist."""
    given, A, rho = case.given, case.rod.bending_stiffness, case.rho
    assert not isinstance(given, Ends)
    s, c = np.sin(given.beta), np.cos(given.beta)
    FZ, FY, m = given.F2 * s + given.F3 * c, given.F3 * s - given.F2 * c, case.loads[2] / A
    by, common = _twist_partials(case, m, s, c), _common(case)
    square = rho**2 / A

    def twist_by(source: str) -> Partials:
        rate = by.get(source, 0.0)
        return {"lam": rho * c * rate, "mu": rho * rate}

    def plus(source: str, lam: Any = 0.0, mu: Any = 0.0, phi: Any = 0.0, **more: Any) -> Partials:
        found = twist_by(source)
        return {"lam": found["lam"] + lam, "mu": found["mu"] + mu, "phi": phi, **more}

    def beta_partials() -> Partials:
        lam = square * FZ - rho * m * s + 3 * s * s * c
        return plus("beta", lam, phi=-square * FY, beta0=1.0)

    return common | {
        "A": lambda: plus("A", -square * FY / A, phi=-square * FZ / A, **common["A"]()),
        "rho": lambda: plus("rho", 2 * rho * FY / A + m * c, m, 2 * rho * FZ / A, end=given.dbeta, **common["rho"]()),
        "ratio": lambda: plus("ratio", **common["ratio"]()),
        "beta0": beta_partials,
        "dbeta0": lambda: plus("dbeta", end=rho),
        "F2": lambda: {"lam": -square * c, "phi": square * s},
        "F3": lambda: {"lam": square * s, "phi": square * c},
        **{name: partial(twist_by, name) for name in ("F1", "dgamma", "M3")},
    }


def _twist_partials(case: Case, m: Any, s: Any, c: Any) -> Partials:
    """The derivatives of m = M3/A, from whichever of M3, dgamma and F1 is given; eqs. (24), row 6, and (33)."""
    given, A, rho = case.given, case.rod.bending_stiffness, case.rho
    assert not isinstance(given, Ends)
    cos2, sc = (c - s) * (c + s), s * c
    if given.M3 is not None:
        return {"M3": 1 / A, "A": -m / A}
    if given.dgamma is not None:
        one = 1 / case.rod.stiffness_ratio
        return {"dgamma": one, "ratio": -m * one, "beta": cos2 / rho * one, "rho": -sc / rho**2 * one}
    part = given.F1 / (A * given.dbeta)
    by_shape = {"beta": 3 * cos2 / rho, "rho": -3 * sc / rho**2}
    return {"F1": 1 / (A * given.dbeta), "A": -part / A, "dbeta": -part / given.dbeta} | by_shape
