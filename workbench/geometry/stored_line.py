"""The centreline of a case, read from its dataset; of a rod with weight or friction from its angles and its push."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from scipy.interpolate import make_interp_spline

from solver.problem.errors import InputError

from ..store import schema
from .centreline import NEEDED, Array, Centreline, slopes


def read(ds: xr.Dataset, where: Mapping[str, int]) -> Centreline:
    """The centreline of one case, by its indices along the axes.

    Raises `InputError` where the dataset lacks one of `NEEDED`, or the case is not solved. Where loads vary along the
    rod the curve needs the contact force in place of the loads.
    """
    varies = schema.loads_vary(ds)
    needed = (*NEEDED, *schema.stiffness_fields(ds), *["contact"] * varies)
    missing = [name for name in needed if name not in ds]
    if missing:
        raise InputError(f"the dataset stores no {', '.join(missing)}, which the curve of the rod needs")
    case = ds.isel(dict(where))
    outcome = str(case["outcome"].values)
    along = {name: np.asarray(case[name], dtype=float) for name in ("alpha", "beta", "z")}
    if not case["solved"] or not np.isfinite(list(along.values())).all():
        raise InputError(f"this case has no shape: {outcome}")
    number = {name: float(case[name]) for name in needed[3:] if name != "contact"}
    A = float(schema.bending_stiffness(str(ds.attrs["stiffness"]), number))
    loads = [number[name] / A for name in ("MZ", "M3", "FZ")]
    s = np.asarray(case["s"].values, dtype=float)
    is_stored = "dbeta" in ds
    R, a, rho = (number[name] for name in ("R", "a", "rho"))
    if is_stored:
        dbeta = np.asarray(case["dbeta"], dtype=float)
    elif varies:
        dbeta = np.asarray(make_interp_spline(s, along["beta"], k=min(5, s.size - 1))(s, 1))
    else:
        dbeta = slopes(s, along["beta"], rho, *loads)
    l, m, p = (np.nan, loads[1], np.nan) if varies else loads
    side, unit = str(ds.attrs["side"]), str(ds.attrs["length_unit"])
    bore = number.get("inner_radius", 0.0)
    known = (s, along["alpha"], along["beta"], dbeta, along["z"], R, a, rho, A, l, m, p, side, bore, unit, is_stored)
    if varies:
        return VaryingLine(*known, stored_contact=np.asarray(case["contact"], dtype=float))
    return Centreline(*known)


def lines_of_solved(ds: xr.Dataset) -> Iterator[Centreline]:
    """The centreline of every solved case of a dataset. Raises `InputError` as `read` does."""
    solved = ds["solved"]
    for place in np.argwhere(np.asarray(solved.values, dtype=bool)):
        yield read(ds, dict(zip(map(str, solved.dims), map(int, place), strict=True)))


DEGREE = 5  # of the splines through the stations


@dataclass(frozen=True, eq=False)
class VaryingLine(Centreline):
    """A centreline along which FZ and MZ vary: l and p are NaN, and beta'' and the contact are those of splines.

    stored_contact: at the stations, (n,).
    """

    stored_contact: Array = field(default_factory=lambda: np.empty(0))

    @cached_property
    def _spline(self) -> Any:
        return make_interp_spline(self.s, self.beta, k=min(DEGREE, self.s.size - 1))

    @property
    def bend(self) -> Array:
        """beta'' at the stations, (n,) [1/length^2]."""
        return np.asarray(self._spline(self.s, 2))

    @cached_property
    def swing(self) -> float:
        """The radians of a swing of beta between stations, at most: from the rates of its three derivatives."""
        beta, rate, bend = (self._spline(self.s, k) for k in range(3))
        sizes = [float(np.ptp(beta)), float(np.abs(rate).max()), float(np.abs(bend).max())]
        if not all(sizes):
            return 0.0
        return float(np.diff(self.s).max() * max(2 * sizes[1] / sizes[0], sizes[2] / sizes[1]))

    def contact(self, s: Array) -> Array:
        """The cylinder's push per length at s, (k,) [force/length], positive outward."""
        return np.asarray(make_interp_spline(self.s, self.stored_contact, k=min(DEGREE, self.s.size - 1))(s))
