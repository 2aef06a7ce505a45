"""CSV: one row a station, one column a quantity, the units in the header."""

import csv
from pathlib import Path
from typing import Any

import numpy as np

from .base import Format, Rod
from .columns import columns


def write(path: Path, rod: Rod) -> dict[str, Any]:
    """Write every quantity at the stations in full precision; the header has the units: ``beta [rad]``."""
    table = columns(rod)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([f"{c.name} [{c.unit}]" if c.unit != "1" else c.name for c in table])
        writer.writerows(np.stack([c.values for c in table], axis=-1).tolist())
    return {"stations": rod.line.s.size, "quantities": len(table)}


FORMAT = Format((".csv",), write)
