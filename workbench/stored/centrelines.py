"""The centreline of a stored case, from its angles and loads; with weight or friction from its angles and its push, and
of a rod that may leave the cylinder from its places."""

from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import cumulative_trapezoid

from solver.orbits.potential import Loads, slope_rate
from solver.problem.case import ALONG_AXIS, IN_PLACE, SLIDING
from solver.problem.declared_fields import VARY_LOADS
from solver.problem.errors import InputError

from ..geometry.centreline import NEEDED, Array, Centreline, slopes, spline
from ..geometry.varying_lines import FreeLine, VaryingLine
from . import quantity_variables, schema

if TYPE_CHECKING:
    from .stored_cases import StoredCases

# what the curve of a rod with weight or friction needs beside, and of one that may leave the cylinder
VARIES = ("contact", "radius", "inclination", *VARY_LOADS)
ANGLES = 361  # between the least and the largest one, at which rates are compared


def centreline_of(case: "StoredCases") -> Centreline:
    """The centreline of one case, as `StoredStudy.centreline` gives it."""
    if case["outcome"].ndim:
        raise InputError(
            f"a curve is that of one case, and the dataset has {case['outcome'].size}: choose one, as by sel"
        )
    leaves = case.leaves
    varies = leaves or case.loads_vary
    needed = (*NEEDED, *schema.stiffness_fields(case.ds), *["contact"] * varies, *["radius"] * leaves)
    missing = [name for name in needed if name not in case]
    if missing:
        lacks = f"the dataset stores no {', '.join(missing)}, which the curve of the rod needs"
        raise InputError(f"{lacks}: add what is missing to outputs")
    outcome = str(case["outcome"].values)
    along = {name: np.asarray(case[name], dtype=float) for name in ("alpha", "beta", "z")}
    if not case["solved"] or not np.isfinite(list(along.values())).all():
        raise InputError(f"this case has no shape: {outcome}")
    number = {name: float(case[name]) for name in needed[3:] if name not in ("contact", "radius")}
    A = float(quantity_variables.bending_stiffness(str(case.attrs["stiffness"]), number))
    loads = [number[name] / A for name in ("MZ", "M3", "FZ")]
    s = np.asarray(case["s"].values, dtype=float)
    is_stored = "dbeta" in case
    R, a, rho = (number[name] for name in ("R", "a", "rho"))
    if is_stored:
        dbeta = np.asarray(case["dbeta"], dtype=float)
    elif varies:
        dbeta = np.asarray(spline(s, along["beta"])(s, 1))
    else:
        dbeta = slopes(s, along["beta"], rho, *loads)
    l, m, p = (np.nan, loads[1], np.nan) if varies else loads
    side, unit = str(case.attrs["side"]), case.units["length"]
    bore = number.get("inner_radius", 0.0)
    known = (s, along["alpha"], along["beta"], dbeta, along["z"], R, a, rho, A, l, m, p, side, bore, unit, is_stored)
    if varies:
        contact = np.asarray(case["contact"], dtype=float)
        if leaves:
            return FreeLine(*known, stored_contact=contact, radius=np.asarray(case["radius"], dtype=float))
        rate = _fastest(case, s, along["alpha"], along["beta"], contact, A)
        return VaryingLine(*known, stored_contact=contact, rate=rate)
    return Centreline(*known)


def _fastest(case: "StoredCases", s: Array, alpha: Array, beta: Array, contact: Array, A: float) -> float:
    """The largest rate at which beta of a rod with weight or friction can swing or die away [rad/length].

    The rate is that of beta'' = -H(beta) under the local loads, which follow from those of the far end by statics, and
    of the weight that pulls the rod to the low side.
    """
    number = {name: float(case[name]) if name in case else 0.0 for name in ("weight", "inclination", "friction")}
    FZ, MZ, M3, rho = (float(case[name]) for name in ("FZ", "MZ", "M3", "rho"))
    sense, way = SLIDING[str(case.attrs.get("sliding", next(iter(SLIDING))))]
    rubbed = 0.0 if way == IN_PLACE else sense * number["friction"] * np.abs(contact)
    along, across = number["weight"] * np.cos(number["inclination"]), number["weight"] * np.sin(number["inclination"])
    pulled = along + rubbed * (1.0 if way == ALONG_AXIS else np.cos(beta))
    turned = rho * (across * np.sin(alpha) + (0.0 if way == ALONG_AXIS else rubbed * np.sin(beta)))
    rows = [cumulative_trapezoid(np.broadcast_to(each, s.shape), s, initial=0.0) for each in (pulled, turned)]
    p, l = (load / A + (row - row[-1]) / A for load, row in zip((FZ, MZ), rows, strict=True))
    angle = np.linspace(beta.min(), beta.max(), ANGLES)
    lam, phi = np.array([l.min(), l.max()]) * rho, np.array([p.min(), p.max()]) * rho**2
    rates = slope_rate(Loads(lam[:, None, None], M3 / A * rho, phi[:, None]), angle) / rho**2
    return float(np.sqrt(np.abs(rates).max() + np.sqrt(abs(across) / (rho * A)) + np.cbrt((along / A) ** 2)))
