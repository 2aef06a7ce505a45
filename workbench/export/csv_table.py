"""CSV: one row a station, one column a quantity, the units in the header. VTP has the same columns."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from solver.problem.errors import InputError
from solver.problem.quantities import QUANTITIES, unit_of

from ..geometry.centreline import APART, Array, advice_to_store
from ..stored import quantity_variables
from ..words.escaping import in_csv
from .file_format import ExportedRod, Format

COMPUTED = ("kappa", "F1", "F2", "F3", "FY", "contact", "M1", "M2", "h")
# columns before all others, whatever the study stores
FIRST = ("s", "x", "y", "z", "alpha", "beta", "dbeta")


@dataclass(frozen=True, eq=False)
class Column:
    """A quantity along the rod: values (n,), its unit ("1" for a number) and its name in words."""

    name: str
    values: Array
    unit: str
    words: str


def columns(rod: ExportedRod) -> list[Column]:
    """Every quantity at the stations: what is stored, and what follows from it by the equations of statics.

    Raises `InputError` where beta' is not stored and the stations are too far apart for it.
    """
    stored, line = rod.stored, rod.line
    if line.phase_step > APART and not line.stored_slopes:
        more = int(np.ceil(2 * line.s.size * line.phase_step / APART))
        raise InputError(
            f"{line.s.size} stations are too far apart to tell the rate of beta: {advice_to_store(more)}, or store "
            "dbeta (in outputs)"
        )
    units, case = stored.units, stored.select(rod.where)
    along = {name: getattr(line, name) for name in ("s", "alpha", "beta", "dbeta", "z")}
    given = case.with_arrays(along)
    derived = {name: given.array(name) for name in COMPUTED}
    known = along | {name: np.asarray(array) for name, array in derived.items() if array is not None}
    for key in case.variables:
        name, array = quantity_variables.CURVES.get(key, key), case[key]
        if array.dims == ("u",) and name in QUANTITIES:
            known[name] = np.asarray(array.values, dtype=float)
    order = [*FIRST, *(name for name in known if name not in FIRST)]
    x, y, _ = line.place.T
    said = {name: (unit_of(name, units), QUANTITIES[name].long_name) for name in known}
    for name, values, azimuth in (("x", x, "0"), ("y", y, "90 deg")):
        known[name], said[name] = values, (units["length"], f"position across the axis, where alpha = {azimuth}")
    return [Column(name, known[name], *said[name]) for name in order]


def write(path: Path, rod: ExportedRod) -> dict[str, Any]:
    """Write every quantity at the stations in full precision; the header has the units: ``beta [rad]``."""
    table = columns(rod)
    heads = [f"{c.name} [{c.unit}]" if c.unit != "1" else c.name for c in table]
    rows = np.stack([c.values for c in table], axis=-1).tolist()
    path.write_text(in_csv([heads, *rows]), encoding="utf-8", newline="")
    return {"stations": rod.line.s.size, "quantities": len(table)}


FORMAT = Format(write)
