"""Every quantity at the stations of a stored rod, with its unit: the columns of CSV and VTP."""

from dataclasses import dataclass

import numpy as np

from solver.mechanics import frames, statics
from solver.mechanics.potential import Loads, potential
from solver.mechanics.statics import contact_force
from solver.problem.errors import InputError
from solver.problem.quantities import QUANTITIES, unit_of

from ..geometry.centreline import APART, Array, Centreline
from ..store import schema
from .base import Rod

# columns before all others, whatever the study stores
FIRST = ("s", "x", "y", "z", "alpha", "beta", "dbeta")


@dataclass(frozen=True, eq=False)
class Column:
    """A quantity along the rod: values (n,), its unit ("1" for a number) and its name in words."""

    name: str
    values: Array
    unit: str
    words: str


def columns(rod: Rod) -> list[Column]:
    """Every quantity at the stations: what is stored, and what follows from it by the equations of statics.

    Raises `InputError` where beta' is not stored and the stations are too far apart for it.
    """
    ds, line = rod.ds, rod.line
    if line.swing > APART and not line.stored_slopes:
        more = int(np.ceil(2 * line.s.size * line.swing / APART))
        raise InputError(
            f"{line.s.size} stations are too far apart to tell the rate of beta: store about {more} (stations = {more} "
            "in the study), or store dbeta (in outputs)"
        )
    units = {"length": str(ds.attrs["length_unit"]), "force": str(ds.attrs["force_unit"])}
    case = ds.isel(rod.where)
    known = {name: values for name, values in compute(line).items() if np.isfinite(values).all()}
    for stored, array in case.data_vars.items():
        name = schema.CURVES.get(str(stored), str(stored))
        if array.dims == ("u",) and name in QUANTITIES:
            known[name] = np.asarray(array.values, dtype=float)
    order = [*FIRST, *(name for name in known if name not in FIRST)]
    x, y, _ = frames.position(line.rho, line.alpha, line.z).T
    known |= {"x": x, "y": y}
    words = {"x": "position across the axis, where alpha = 0", "y": "position across the axis, where alpha = 90 deg"}
    return [
        Column(name, known[name], units["length"] if name in words else unit_of(name, units),
               words.get(name) or QUANTITIES[name].long_name)
        for name in order
    ]  # fmt: skip


def compute(line: Centreline) -> dict[str, Array]:
    """What the angles at the stations and the loads determine, (n,) each."""
    A, l, m, p, rho, beta, dbeta = line.A, line.l, line.m, line.p, line.rho, line.beta, line.dbeta
    FY = statics.circumferential_force(A, l, m, rho, beta)
    F2, F3 = statics.surface_forces(FY, A * p, beta)
    reduced = Loads(lam=l * rho, mu=m * rho, phi=p * rho**2)
    return {
        "s": line.s, "alpha": line.alpha, "beta": beta, "dbeta": dbeta, "z": line.z,
        "kappa": statics.curvature(rho, beta, dbeta),
        "F1": statics.normal_force(A, m, rho, beta, dbeta), "F2": F2, "F3": F3, "FY": FY,
        "contact": contact_force(A, m, rho, FY, -line.bend, beta, dbeta),
        "M1": A * dbeta, "M2": A * np.sin(beta) ** 2 / rho,
        "h": dbeta**2 + potential(reduced, beta) / rho**2,
    }  # fmt: skip
