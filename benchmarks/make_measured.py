"""Cut stored runs of `workbench trade`, with and without `--extremes`, down to what the report draws, for shipping.

    workbench trade --out RUN
    workbench trade --extremes --out RUN
    python benchmarks/make_measured.py RUN

Replaces workbench/lab/measured/trade.h5 and extremes.h5. Numbers keep three digits: a diagram shows no more.
"""

import sys
from pathlib import Path

import numpy as np
import xarray as xr

from workbench.lab.measured_runs import SHIPPED
from workbench.run import writing
from workbench.stored import reading

KEPT = {
    "trade": ("seconds", "error", "outcome", "answered", "kind"),
    "extremes": ("verdict", "error", "condition", "span", "group"),
}


def cut(ds: xr.Dataset, name: str) -> xr.Dataset:
    """What is drawn of a stored run; of an outcome what stands before its reason."""
    small = ds[list(KEPT[name])]
    for key, array in small.data_vars.items():
        if array.dtype.kind == "f":
            small[key] = array.copy(data=np.vectorize(lambda value: float(f"{value:.3g}"))(array.values))
    if "outcome" in small:
        small["outcome"] = small["outcome"].copy(
            data=np.char.partition(small["outcome"].values.astype(str), ":")[..., 0]
        )
    return small


if __name__ == "__main__":
    for name in KEPT:
        print(
            writing.write(
                cut(reading.read(Path(sys.argv[1]) / f"{name}.h5", study=False), name), SHIPPED / f"{name}.h5"
            )
        )
