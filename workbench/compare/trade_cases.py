"""The named cases of `workbench trade`, and their references.

The references are Taylor series with forty digits (benchmarks/make_trade_references.py), which no method uses. Tests
compare those of the elliptic and the catenary rod with the closed forms.
"""

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from itertools import product
from typing import Any

import numpy as np

from solver import Case, Cylinder, Ends, InputError, Rod, Start
from solver.benchmark import Reference
from solver.problem.errors import no_such
from studies.language.readings import LOADS, READINGS, TWISTS

GAPS = (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
FILE = "trade_references.json"


@dataclass(frozen=True, eq=False)
class Named:
    """A case, its description, and for an ends problem beta'(0) [rad/length] of the equilibrium to compare."""

    case: Case
    about: str
    slope: float | None = None


def in_units_of_rho(lam: float, mu: float, phi: float, span: float, beta0: float, dbeta0: float) -> Case:
    """A start problem from its dimensionless numbers; A = rho = 1 up to rounding."""
    rod, cylinder = _unit(span)
    s, c = np.sin(beta0), np.cos(beta0)
    A, FY = rod.bending_stiffness, lam - mu * c - s**3
    twist = mu * (1 + rod.nu) - s * c
    return Case(rod, cylinder, Start(beta0, dbeta0, F2=A * (phi * s - FY * c), F3=A * (phi * c + FY * s), dgamma=twist))


def ends_in_units_of_rho(lam: float, mu: float, phi: float, span: float, beta0: float, betaL: float) -> Case:
    """An ends problem from its dimensionless numbers; A = rho = 1 up to rounding."""
    rod, cylinder = _unit(span)
    A = rod.bending_stiffness
    return Case(rod, cylinder, Ends(beta0, betaL, FZ=A * phi, MZ=A * lam, M3=A * mu))


def _unit(span: float) -> tuple[Rod, Cylinder]:
    a = 0.25
    return Rod(E=4 / (np.pi * a**4), nu=0.25, a=a, L=span), Cylinder(1 - a)


def _by_ends(case: Case, betaL: float) -> Case:
    """The rod, beta(0) and loads of a start problem as an ends problem with this beta(L) [rad]."""
    FZ, MZ, M3 = case.loads
    return Case(case.rod, case.cylinder, Ends(case.given.beta, betaL, FZ, MZ, M3))  # type: ignore[union-attr]


def _table_1() -> dict[str, Named]:
    return {
        f"{twist}/{load}": Named(READINGS[f"{twist}/{load}/paper"].case(), "Table 1, the paper's stiffness")
        for twist, load in product(TWISTS, LOADS)
    }


def _cases() -> dict[str, Named]:
    pressed, pulled = READINGS["twist-first/compression/paper"], READINGS["force-first/tension/paper"]
    b, quarter = float(np.pi / 6), float(np.pi / 4)
    near_saddle = (-0.3655, 0.7464, -0.7506, 20.0, b, b)
    return {
        **_table_1(),
        "elliptic": Named(in_units_of_rho(0, 0, 0, 20.0, b, 0.0), "no load, beta'(0) = 0: exact"),
        "catenary": Named(
            in_units_of_rho(0, 0, 0, 20.0, b, float(np.sin(b) ** 2)), "no load, beta is monotonic: exact"
        ),
        **{
            f"gap {gap:.0e}": Named(in_units_of_rho(0, 0, 1.0, 60.0, gap, 0.0), "beta'(0) = 0, that near to a saddle")
            for gap in GAPS
        },
        "long": Named(pulled.case({"L": 400.0}), "force-first/tension, L = 400 cm"),
        "stiff": Named(pressed.case({"E": 1.07e7}), "twist-first/compression, E a thousand times Table 1's"),
        "soft": Named(pressed.case({"E": 107.0}), "twist-first/compression, E a hundredth of Table 1's"),
        "ends elliptic": Named(
            ends_in_units_of_rho(0, 0, 0, 20.0, b, 0.524317117841891221), "the elliptic rod by its two ends", 0.0
        ),
        "ends table 1": Named(_by_ends(pressed.case(), quarter), "twist-first/compression, 45 degrees at the end", 0.5),
        "ends stable 1": Named(
            ends_in_units_of_rho(*near_saddle), "stays near a saddle and is stable: beta'(0) = -1.538", -1.53804
        ),
        "ends stable 2": Named(
            ends_in_units_of_rho(*near_saddle), "stays near a saddle and is stable: beta'(0) = 2.002", 2.00163
        ),
    }


CASES: dict[str, Named] = _cases()


def choose(names: list[str]) -> dict[str, Named]:
    """The cases with these names or first words (gap, ends); default: all. Raises `InputError` for another name."""
    if not names:
        return CASES
    picked: dict[str, Named] = {}
    for name in names:
        cases = {k: v for k, v in CASES.items() if k == name or k.partition(" ")[0] == name}
        if not cases:
            raise no_such("case", name, CASES)
        picked |= cases
    return picked


@cache
def _data() -> dict[str, Any]:
    data: dict[str, Any] = json.loads((files(__package__) / FILE).read_text(encoding="utf-8"))
    return data


def reference(name: str) -> Reference:
    """The reference of a named case. Raises `InputError` if it has none."""
    data = _data()
    if name not in data["cases"]:
        raise InputError(f"no reference for {name!r}: compute it with benchmarks/make_trade_references.py")
    row = data["cases"][name]
    columns = {column: np.array(row[column]) for column in ("beta", "alpha", "z", "contact")}
    return Reference(u=np.array(data["u"]), condition=row["condition"], **columns)
