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


def columns(rod: ExportedRod) -> tuple[list[Column], dict[str, Any]]:
    """Every quantity at the stations, and their numbers by name, with what is left out and why.

    A quantity is stored, or follows from what is stored by the equations of statics, or is that of the case solved
    again. Raises `InputError` where beta' is not stored and the stations are too far apart for it.
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
    given, known = case.with_arrays(along), dict(along)
    for name in COMPUTED:
        if (array := given.array(name)) is not None:
            known[name] = np.asarray(array)
    for key in case.variables:
        name, array = quantity_variables.CURVES.get(key, key), case[key]
        if array.dims == ("u",) and name in QUANTITIES:
            known[name] = np.asarray(array.values, dtype=float)
    missing, why = [name for name in COMPUTED if name not in known], "not defined for this rod"
    if missing:  # loads vary along the rod, or it may leave the wall
        try:
            again = case.solve(line.s.size, (*missing, "alpha", "beta", "z"))
            known |= {name: np.asarray(again.along(name), dtype=float) for name in missing}
        except InputError as error:
            why = f"which are not stored: {error}"
    known = {name: values for name, values in known.items() if np.isfinite(values).any()}
    order = [*FIRST, *COMPUTED, *(name for name in known if name not in (*FIRST, *COMPUTED))]
    x, y, _ = line.place.T
    said = {name: (unit_of(name, units), QUANTITIES[name].long_name) for name in known}
    for name, values, azimuth in (("x", x, "0"), ("y", y, "90 deg")):
        known[name], said[name] = values, (units["length"], f"position across the axis, where alpha = {azimuth}")
    table = [Column(name, known[name], *said[name]) for name in order if name in known]
    left_out = [name for name in COMPUTED if name not in known]
    without = {"without": f"{', '.join(left_out)}, {why}"} if left_out else {}
    return table, {"stations": line.s.size, "quantities": len(table), **without}


def write(path: Path, rod: ExportedRod) -> dict[str, Any]:
    """Write every quantity at the stations in full precision; the header has the units: ``beta [rad]``."""
    table, facts = columns(rod)
    heads = [f"{c.name} [{c.unit}]" if c.unit != "1" else c.name for c in table]
    rows = np.stack([c.values for c in table], axis=-1).tolist()
    path.write_text(in_csv([heads, *rows]), encoding="utf-8", newline="")
    return facts


FORMAT = Format(write)
