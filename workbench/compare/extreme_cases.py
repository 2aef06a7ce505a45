"""The named extremes: start problems with extreme parameters, and their references."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solver import Case, Cylinder, Rod, Start

SHARES = (0.25, 0.5, 0.75, 1.0)  # of the length: where answer and reference are compared
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


def _table_1(E: float = 1.07e4, nu: float = 0.25, R: float = 0.75, L: float = 20.0, twist: bool = False) -> Case:
    """Table 1 read force-first/tension/paper; twist: with its twist rate instead of F1."""
    given = {"dgamma": 0.5} if twist else {"F1": 5.0}
    return Case(Rod(E, nu, 0.25, L, "paper"), Cylinder(R), Start(np.pi / 6, 0.5, F3=10.0, **given))


def _reduce(lam: float, mu: float, phi: float, span: float, beta: float, v: float) -> Case:
    """A start problem from its dimensionless numbers; A = 1 and rho = 1 up to rounding."""
    a = 0.25
    rod = Rod(4 / (np.pi * a**4), 0.25, a, span)
    A, s, c = rod.bending_stiffness, np.sin(beta), np.cos(beta)
    FY, FZ = A * (lam - mu * c - s**3), A * phi
    start = Start(beta, v, F2=FZ * s - FY * c, F3=FZ * c + FY * s, dgamma=mu * (1 + rod.nu) - s * c)
    return Case(rod, Cylinder(1 - a), start)


def _materials() -> list[Extreme]:
    return [
        Extreme("Table 1 as printed", "rod", _table_1()),
        Extreme("E = 1e-9 N/cm²", "rod", _table_1(E=1e-9)),
        Extreme("E = 1e15 N/cm²", "rod", _table_1(E=1e15)),
        Extreme("ν = 0.5", "rod", _table_1(nu=0.5, twist=True)),
        Extreme("ν one bit above −1", "rod", _table_1(nu=float(np.nextafter(-1, 0)), twist=True)),
        Extreme("R = 1e-9 a", "cylinder", _table_1(R=0.25e-9)),
        Extreme("R = 1e9 a", "cylinder", _table_1(R=0.25e9)),
    ]


def _lengths() -> list[Extreme]:
    return [
        Extreme(
            f"L/ρ = {span:.0e}".replace("e+0", "e").replace("e-0", "e-"),
            "length",
            _reduce(0.2, 0.1, -0.5, span, 0.7, 0.3),
        )
        for span in (1e-6, 1e3, 1e6, 1e9)
    ]


def _loads() -> list[Extreme]:
    rows = [Extreme("no loads", "loads", _reduce(0, 0, 0, 20.0, np.pi / 6, 0.0))]
    for size in (1e-12, 1e3, 1e6, 1e12):
        name = f"loads {size:.0e}".replace("e+0", "e").replace("e+", "e")
        rows.append(Extreme(name, "loads", _reduce(0.3 * size, 0.2 * size, -0.5 * size, 20.0, 0.7, 0.3)))
    rows.append(Extreme("loads 1e12, short", "loads", _reduce(3e11, 2e11, -5e11, 2e-5, 0.7, 0.3)))
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
    return [Extreme(name, "angle", _reduce(0.3, 0.2, 0.1, 20.0, beta, 0.4)) for name, beta in angles.items()]


def _helices() -> list[Extreme]:
    def lam(beta: float, mu: float, phi: float) -> float:  # H(beta) = 0
        s, c = np.sin(beta), np.cos(beta)
        return float((mu * np.cos(2 * beta) + (phi + 2 * c * s * s) * s) / c)

    return [
        Extreme("on a centre helix", "helix", _reduce(lam(1.1, 0.9, -0.4), 0.9, -0.4, 20.0, 1.1, 0.0)),
        Extreme("centre helix, L = 1e6 ρ", "helix", _reduce(lam(1.1, 0.9, -0.4), 0.9, -0.4, 1e6, 1.1, 0.0)),
        Extreme("on a saddle helix", "helix", _reduce(lam(1.1, 0.4, 0.2), 0.4, 0.2, 20.0, 1.1, 0.0)),
        Extreme("on a steep saddle helix", "helix", _reduce(lam(0.4, -0.3, 0.1), -0.3, 0.1, 40.0, 0.4, 0.0)),
        Extreme("where H only touches zero", "helix", _reduce(-3.0, -3.0, 0.0, 20.0, 1e-6, 0.0)),
    ]


def _separatrices() -> list[Extreme]:
    speed = -float(np.sqrt(2 - _potential(0.5)))
    rows = [Extreme("on a separatrix", "separatrix", _reduce(0, 0, 1.0, 15.0, 0.5, speed))]
    for gap in (1e-4, 1e-8, 1e-12, 1e-16, 1e-100):
        name = f"turns {gap:.0e} before a saddle".replace("e-0", "e-")
        rows.append(Extreme(name, "separatrix", _reduce(0, 0, 1.0, 25.0, gap, 0.0)))
    rows.append(Extreme("passes a saddle at 1e-12", "separatrix", _reduce(0, 0, 1.0, 40.0, 0.0, 1e-12)))
    return rows


def _potential(beta: float, phi: float = 1.0) -> float:
    """G(beta) with lam = mu = 0; its saddle is beta = 0, where G = 2 phi."""
    return float(-(np.sin(beta) ** 4) + 2 * phi * np.cos(beta))


def _tensions() -> list[Extreme]:
    return [
        Extreme("tension φ = 1e4, straight", "tension", _reduce(0, 0, 1e4, 20.0, 0.0, 0.0)),
        Extreme("tension φ = 1e4, 1e-3 off", "tension", _reduce(0, 0, 1e4, 20.0, 1e-3, 0.0)),
        Extreme(
            "tension φ = 1e4, next to e⁻ˢ",
            "tension",
            _reduce(0, 0, 1e4, 0.4, 0.5, -float(np.sqrt(1e4 * 2 - _potential(0.5, 1e4)))),
        ),
        Extreme("tension φ = 1e8, 1e-3 off", "tension", _reduce(0, 0, 1e8, 20.0, 1e-3, 0.0)),
        Extreme("compression φ = −1e8", "tension", _reduce(0, 0, -1e8, 20.0, 1e-3, 0.0)),
    ]
