"""Arrays along the rod of a stored dataset: as stored, else computed from stored ones, else solved again.

Computed arrays are lazy where the stored ones are.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from solver import Case, Cylinder, Solution
from solver.orbits import forces, frames
from solver.orbits.forces import contact_force, push_from
from solver.orbits.potential import Loads, dimensional_slope, potential
from solver.problem.declared_fields import CHOICES, PARTS
from solver.problem.errors import InputError
from studies import Study
from studies.language.study import OUTPUTS

from . import quantity_variables, schema
from .quantity_variables import COMPONENTS
from .schema import axes_left

if TYPE_CHECKING:
    import pandas as pd

    from solver.nodes.pipe_states import StretchState

    from .stored_cases import StoredCases


_VECTOR, _FRAME = ("xyz",), ("director", "xyz")
INNER = {"position": _VECTOR, "tangent": _VECTOR, "normal": _VECTOR, "material_frame": _FRAME}
ARRAYS = (*OUTPUTS, "push", "tangent", "normal", "material_frame")
_LONG_NAMES = {
    "push": "push of the cylinder per length, positive where it pushes",
    "tangent": "unit tangent",
    "normal": "unit normal, towards the axis",
    "material_frame": "directors of the section as rows",
}


@dataclass(frozen=True)
class StoredArrays:
    """What a dataset, or a selection of one, stores of its cases, and what follows from it."""

    ds: xr.Dataset

    def derive(self, name: str, above: tuple[str, ...] = ()) -> Any:
        """The array as stored, or computed from stored ones; None where they do not suffice.

        above: the arrays for which it is needed.
        """
        key = quantity_variables.curve_name(name)
        if key in self.ds.data_vars:
            return self.ds[key]
        if name not in RULES or name in above or (name in BY_LOADS and self._varies(name)):
            return None
        if schema.leaves(self.ds) and name not in ANYWHERE:
            return None
        needs, rule = RULES[name]
        parts = [self.derive(need, (*above, name)) for need in needs]
        return None if any(part is None for part in parts) else rule(self, *parts)

    def _varies(self, name: str) -> bool:
        """Whether the loads of a rule vary along the rod. M3 varies only where a rod turns in place."""
        alone = name in ("F1", "M3_along")
        return schema.loads_vary(self.ds) and (not alone or self.ds.attrs.get("sliding") == "rotating")

    # constants of each case

    def constant(self, name: str) -> xr.DataArray:
        """E, a, rho, FZ, MZ or M3. Raises `InputError` where it is not stored."""
        if name not in self.ds.variables:
            raise InputError("the dataset does not store the loads of its cases")
        return self.ds[name]

    @cached_property
    def rho(self) -> xr.DataArray:
        """Distance from the axis [length]."""
        return self.constant("rho")

    @cached_property
    def A(self) -> xr.DataArray:
        """Bending stiffness [force length^2]."""
        numbers = {name: self.constant(name) for name in schema.stiffness_fields(self.ds)}
        return quantity_variables.bending_stiffness(schema.text_of(self.ds, "stiffness"), numbers)

    @property
    def lmp(self) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
        """The loads over A: l = MZ/A, m = M3/A [1/length], p = FZ/A [1/length^2]."""
        return self.constant("MZ") / self.A, self.constant("M3") / self.A, self.constant("FZ") / self.A

    @cached_property
    def loads(self) -> Loads:
        """The loads of the problem without dimensions."""
        l, m, p = self.lmp
        return Loads(l * self.rho, m * self.rho, p * self.rho**2)


@dataclass(frozen=True)
class StoredRod(StoredArrays):
    """The stored arrays of a rod with its study; case and solution are made only when needed."""

    study: Study
    case: Callable[[], Case]
    solution: Callable[[], Solution]

    def array(self, name: str) -> xr.DataArray:
        """The array of one of `ARRAYS`, (axes, u) and its components, with units. Raises `InputError`."""
        values = self.derive(name)
        if values is None:
            values = self._values_of(name)
        order = [*axes_left(self.ds, self.study), "u", *INNER.get(name, ())]
        kept = {dim: list(COMPONENTS[dim]) for dim in INNER.get(name, ())}
        result = values.transpose(*(dim for dim in order if dim in values.dims)).assign_coords(kept)
        return result.rename(name).assign_attrs(self._labels(name))

    def _values_of(self, name: str) -> xr.DataArray:
        """The array of the cases solved again, NaN where they are not solved."""
        sol = self.solution()
        values = np.asarray(getattr(sol, name))
        solved = np.asarray(sol.solved)
        values = np.where(solved.reshape(solved.shape + (1,) * (values.ndim - solved.ndim)), values, np.nan)
        dims = [*axes_left(self.ds, self.study), "u", *INNER.get(name, ())]
        coords = {key: value for key, value in self.ds.coords.items() if set(value.dims) <= set(dims)}
        if "u" in self.ds.dims or "u" not in self.ds.coords:
            return xr.DataArray(values, coords, dims)
        return xr.DataArray(values, {k: v for k, v in coords.items() if k != "u"}, dims).isel(u=0)

    def _labels(self, name: str) -> dict[str, str]:
        units = self.study.unit_system
        if name in OUTPUTS:
            return quantity_variables.labels(name, units)
        words = quantity_variables.labels("contact" if name == "push" else "u", units)
        return {"units": words["units"], "long_name": _LONG_NAMES[name]}

    def constant(self, name: str) -> xr.DataArray:
        """E, a, rho, FZ, MZ or M3: read, or from the case."""
        if name in self.ds.variables:
            return self.ds[name]
        case = self.case()
        loads = dict(zip(("FZ", "MZ", "M3"), case.loads, strict=True))
        value = {**loads, "rho": case.rho}.get(name, getattr(case.rod, name, None))
        axes = axes_left(self.ds, self.study)
        return xr.DataArray(np.broadcast_to(np.asarray(value, dtype=float), case.shape), dims=axes)


def _contact(at: StoredArrays, FY: Any, beta: Any, dbeta: Any) -> Any:
    l, m, p = at.lmp
    H = dimensional_slope(l, m, p, at.rho, beta)
    return contact_force(at.A, m, at.rho, FY, H, beta, dbeta)


def _FY(at: StoredArrays, beta: Any) -> Any:
    l, m, _ = at.lmp
    return forces.circumferential_force(at.A, l, m, at.rho, beta)


def _vectors(function: Callable[..., Any], name: str, *arrays: Any) -> Any:
    """A function of arrays to vectors in the last axes, block by block where they are lazy."""
    inner = INNER[name]
    sizes = {"output_sizes": dict.fromkeys(inner, 3)}
    return xr.apply_ufunc(
        function,
        *arrays,
        output_core_dims=[list(inner)],
        dask="parallelized",
        output_dtypes=[float],
        dask_gufunc_kwargs=sizes,
    )


ANYWHERE = ("push", "gap", "position")  # rules that hold off the wall too
BY_LOADS = ("FY", "F1", "F2", "F3", "contact", "M3_along", "h")  # rules that take constant loads
# name -> the arrays it needs, and the formula, which is the solver's own
RULES: dict[str, tuple[tuple[str, ...], Callable[..., Any]]] = {
    "dbeta": (("M1",), lambda at, M1: M1 / at.A),
    "kappa": (("beta", "dbeta"), lambda at, b, db: forces.curvature(at.rho, b, db)),
    "FY": (("beta",), _FY),
    "F1": (("beta", "dbeta"), lambda at, b, db: forces.normal_force(at.A, at.lmp[1], at.rho, b, db)),
    "F2": (("FY", "beta"), lambda at, FY, b: forces.surface_forces(FY, at.constant("FZ"), b)[0]),
    "F3": (("FY", "beta"), lambda at, FY, b: forces.surface_forces(FY, at.constant("FZ"), b)[1]),
    "contact": (("FY", "beta", "dbeta"), _contact),
    "push": (("contact",), lambda at, contact: push_from(contact, schema.text_of(at.ds, "side"))),
    "M1": (("dbeta",), lambda at, db: at.A * db),
    "M2": (("beta",), lambda at, b: at.A * np.sin(b) ** 2 / at.rho),
    "M3_along": (("beta",), lambda at, b: at.constant("M3") + 0 * b),
    "h": (("beta", "dbeta"), lambda at, b, db: db**2 + potential(at.loads, b) / at.rho**2),
    "radius": (("alpha",), lambda at, a: at.rho + 0 * a),
    "gap": (("radius",), lambda at, r: abs(r - at.rho)),
    "tilt": (("alpha",), lambda at, a: 0 * a),
    "position": (("radius", "alpha", "z"), lambda at, r, a, z: _vectors(frames.position, "position", r, a, z)),
    "tangent": (("alpha", "beta"), lambda at, a, b: _vectors(frames.tangent, "tangent", a, b)),
    "normal": (("alpha",), lambda at, a: -_vectors(frames.outward, "normal", a)),
    "material_frame": (
        ("alpha", "beta", "gamma"),
        lambda at, a, b, g: _vectors(frames.material, "material_frame", a, b, g),
    ),
}


def azimuths_of(one: "StoredCases", arrays: Mapping[str, Any]) -> Any:
    """The azimuth along a stored rod, (n,), from its arrays s, alpha and, of a rod that may leave the wall, radius: on
    the axis, where it has none, that of the next place. `one`: its case."""
    from solver.nodes.pipe_states import azimuths  # it loads the methods

    if "radius" not in arrays:
        return arrays["alpha"]
    return azimuths(arrays["s"], arrays["alpha"], arrays["radius"], float(one["error"]) * float(arrays["s"][-1]))


def states_of(one: "StoredCases", s: Any, beta: Any, alpha: Any, push: Any = None) -> "tuple[StretchState, ...]":
    """The states along a stored rod with weight or friction, from arrays along it, (n,) each; `one`: its case.

    Without the push no helix is told from what tension draws.
    """
    from solver.nodes.pipe_states import axial_force_along, ends_turn, is_drawn, states  # it loads the methods

    given: dict[str, Any] = {
        name: float(one[name]) for name in PARTS["cylinder"] if name not in CHOICES and name in one
    }
    wall = Cylinder(**given, **{name: one.attrs[name] for name in ("side", "sliding") if name in one.attrs})
    weight, inclination = (float(one[name]) if name in one else 0.0 for name in ("weight", "inclination"))
    turns = ends_turn(bool(weight) and 0 < inclination < np.pi, "azimuth" in one)
    if push is None:
        return states(s, beta, alpha, turns=turns)
    axial = axial_force_along(wall, weight, float(one["FZ"]), s, beta, push)
    return states(s, beta, alpha, is_drawn(axial, push), turns)


MOST = 500_000_000  # numbers of a table: 4 GB


def table(ds: xr.Dataset, arrays: Sequence[xr.DataArray]) -> "pd.DataFrame":
    """One row a case, with everything that is stored of it and what all cases share; with arrays along the rod one row
    a station, with s and them. The axes are the index, and u.

    A component is a column of its own: ``position_x``. Raises `InputError` for a dataset that is not a stored study.
    """
    if "outcome" not in ds:
        raise InputError("the dataset is not a stored study: it has no outcome")
    axes = schema.axes_of(ds)
    if not arrays:
        return _table({str(name): ds[name] for name in ds.variables if set(ds[name].dims) <= {*axes}}, ds, axes)
    columns = {"s": ds["s"]} if "s" in ds.coords else {}
    for array in arrays:
        inner = [str(dim) for dim in array.dims if dim in quantity_variables.COMPONENTS]
        for which in product(*(range(array.sizes[dim]) for dim in inner)):
            words = [quantity_variables.COMPONENTS[dim][i] for dim, i in zip(inner, which, strict=True)]
            columns["_".join([str(array.name), *words])] = array.isel(dict(zip(inner, which, strict=True)), drop=True)
    fields = {str(name): ds[name] for name in ds.coords if ds[name].dims and set(ds[name].dims) <= {*axes}}
    return _table({**fields, **columns}, ds, [*axes, *(["u"] if "u" in ds.dims else [])])


def _table(columns: Mapping[str, xr.DataArray], ds: xr.Dataset, dims: Sequence[str]) -> "pd.DataFrame":
    """The columns over the product of the dimensions, in their order; ``attrs`` holds units and long names.

    Raises `InputError` for more than `MOST` numbers.
    """
    size = len(columns) * prod(ds.sizes[dim] for dim in dims)
    if size > MOST:
        raise InputError(f"the table would have {size:,} numbers, more than {MOST:,}: select from the dataset first")
    data = xr.Dataset({name: array.variable for name, array in columns.items() if name not in dims})
    row = [] if dims else ["row"]
    table = data.assign_coords({dim: ds[dim] for dim in dims}).expand_dims(row).to_dataframe(dim_order=[*dims, *row])
    table = table if dims else table.reset_index(drop=True)
    known = {**{dim: ds[dim] for dim in dims}, **columns}
    table.attrs["units"] = {name: array.attrs["units"] for name, array in known.items() if "units" in array.attrs}
    table.attrs["long_names"] = {
        name: array.attrs["long_name"] for name, array in known.items() if "long_name" in array.attrs
    }
    return table
