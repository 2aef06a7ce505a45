"""The named extremes: start problems with extreme parameters, and their references."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solver import Case
from studies.language.readings import READINGS

from .trade_cases import in_units_of_rho

SHARES = (0.25, 0.5, 0.75, 1.0)  # of the length: where answer and reference are compared
TWISTED = "twist-first/tension/paper"  # with the twist rate of Table 1 in place of F1
FILE = Path(__file__).with_name("extremes.json")


@dataclass(frozen=True)
class Extreme:
    """A start problem, its name, and the group of the map to which it belongs."""

    name: str
    group: str
    case: Case


@dataclass(frozen=True)
class Reference:
    """beta [rad] at `SHARES` of the length, (4,), and its source; None and empty if no series reaches the end."""

    beta: NDArray[np.float64] | None
    source: str


def extremes() -> list[Extreme]:
    """All extremes, in the order of the map."""
    return [*_materials(), *_lengths(), *_loads(), *_angles(), *_helices(), *_separatrices(), *_tensions()]


@cache
def references() -> dict[str, Reference]:
    """The references by name, which benchmarks/make_extremes.py computed to 25 digits."""
    rows = json.loads(FILE.read_text(encoding="utf-8"))
    return {
        name: Reference(None if row["beta"] is None else np.array(row["beta"]), row["source"])
        for name, row in rows.items()
    }


def _table_1(reading: str = "force-first/tension/paper", **changes: float) -> Case:
    return READINGS[reading].case(changes)


def _materials() -> list[Extreme]:
    return [
        Extreme("Table 1 as printed", "rod", _table_1()),
        Extreme("E = 1e-9 N/cm²", "rod", _table_1(E=1e-9)),
        Extreme("E = 1e15 N/cm²", "rod", _table_1(E=1e15)),
        Extreme("ν = 0.5", "rod", _table_1(TWISTED, nu=0.5)),
        Extreme("ν one bit above −1", "rod", _table_1(TWISTED, nu=float(np.nextafter(-1, 0)))),
        Extreme("R = 1e-9 a", "cylinder", _table_1(R=0.25e-9)),
        Extreme("R = 1e9 a", "cylinder", _table_1(R=0.25e9)),
    ]


def _lengths() -> list[Extreme]:
    return [
        Extreme(
            f"L/ρ = {span:.0e}".replace("e+0", "e").replace("e-0", "e-"),
            "length",
            in_units_of_rho(0.2, 0.1, -0.5, span, 0.7, 0.3),
        )
        for span in (1e-6, 1e3, 1e6, 1e9)
    ]


def _loads() -> list[Extreme]:
    rows = [Extreme("no loads", "loads", in_units_of_rho(0, 0, 0, 20.0, np.pi / 6, 0.0))]
    for size in (1e-12, 1e3, 1e6, 1e12):
        name = f"loads {size:.0e}".replace("e+0", "e").replace("e+", "e")
        rows.append(Extreme(name, "loads", in_units_of_rho(0.3 * size, 0.2 * size, -0.5 * size, 20.0, 0.7, 0.3)))
    rows.append(Extreme("loads 1e12, short", "loads", in_units_of_rho(3e11, 2e11, -5e11, 2e-5, 0.7, 0.3)))
    return rows


def _angles() -> list[Extreme]:
    angles = {
        "β₀ = 0": 0.0,
        "β₀ = 5e-324": 5e-324,
        "β₀ = π/2": np.pi / 2,
        "β₀ one bit above π/2": float(np.nextafter(np.pi / 2, 4)),
        "β₀ = π": np.pi,
        "β₀ one bit below π": float(np.nextafter(np.pi, 0)),
    }
    return [Extreme(name, "angle", in_units_of_rho(0.3, 0.2, 0.1, 20.0, beta, 0.4)) for name, beta in angles.items()]


def _helices() -> list[Extreme]:
    def lam(beta: float, mu: float, phi: float) -> float:  # H(beta) = 0
        s, c = np.sin(beta), np.cos(beta)
        return float((mu * np.cos(2 * beta) + (phi + 2 * c * s * s) * s) / c)

    return [
        Extreme("on a centre helix", "helix", in_units_of_rho(lam(1.1, 0.9, -0.4), 0.9, -0.4, 20.0, 1.1, 0.0)),
        Extreme("centre helix, L = 1e6 ρ", "helix", in_units_of_rho(lam(1.1, 0.9, -0.4), 0.9, -0.4, 1e6, 1.1, 0.0)),
        Extreme("on a saddle helix", "helix", in_units_of_rho(lam(1.1, 0.4, 0.2), 0.4, 0.2, 20.0, 1.1, 0.0)),
        Extreme("on a steep saddle helix", "helix", in_units_of_rho(lam(0.4, -0.3, 0.1), -0.3, 0.1, 40.0, 0.4, 0.0)),
        Extreme("where H only touches zero", "helix", in_units_of_rho(-3.0, -3.0, 0.0, 20.0, 1e-6, 0.0)),
    ]


def _separatrices() -> list[Extreme]:
    speed = -float(np.sqrt(2 - _potential(0.5)))
    rows = [Extreme("on a separatrix", "separatrix", in_units_of_rho(0, 0, 1.0, 15.0, 0.5, speed))]
    for gap in (1e-4, 1e-8, 1e-12, 1e-16, 1e-100):
        name = f"turns {gap:.0e} before a saddle".replace("e-0", "e-")
        rows.append(Extreme(name, "separatrix", in_units_of_rho(0, 0, 1.0, 25.0, gap, 0.0)))
    rows.append(Extreme("passes a saddle at 1e-12", "separatrix", in_units_of_rho(0, 0, 1.0, 40.0, 0.0, 1e-12)))
    return rows


def _potential(beta: float, phi: float = 1.0) -> float:
    """G(beta) with lam = mu = 0; its saddle is beta = 0, where G = 2 phi."""
    return float(-(np.sin(beta) ** 4) + 2 * phi * np.cos(beta))


def _tensions() -> list[Extreme]:
    return [
        Extreme("tension φ = 1e4, straight", "tension", in_units_of_rho(0, 0, 1e4, 20.0, 0.0, 0.0)),
        Extreme("tension φ = 1e4, 1e-3 off", "tension", in_units_of_rho(0, 0, 1e4, 20.0, 1e-3, 0.0)),
        Extreme(
            "tension φ = 1e4, next to e⁻ˢ",
            "tension",
            in_units_of_rho(0, 0, 1e4, 0.4, 0.5, -float(np.sqrt(1e4 * 2 - _potential(0.5, 1e4)))),
        ),
        Extreme("tension φ = 1e8, 1e-3 off", "tension", in_units_of_rho(0, 0, 1e8, 20.0, 1e-3, 0.0)),
        Extreme("compression φ = −1e8", "tension", in_units_of_rho(0, 0, -1e8, 20.0, 1e-3, 0.0)),
    ]
