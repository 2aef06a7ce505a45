"""Runs, stores, draws, checks and reports studies; the command line.

Importing it gives datasets their accessor `ds.rod`, in whichever order this and xarray are imported.
"""

import sys
from importlib import import_module
from importlib.util import find_spec
from typing import Any

__version__ = "0.1.0"


class _AfterXarray:
    """Has the accessor registered as soon as xarray is there, so that importing this package loads nothing heavy."""

    @staticmethod
    def find_spec(name: str, path: Any = None, target: Any = None) -> Any:
        """The spec of xarray, whose loading then goes on to the accessor; None for everything else."""
        if name != "xarray":
            return None
        sys.meta_path.remove(_AfterXarray)
        spec = find_spec(name)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def load_both(module: Any) -> None:
                load(module)
                import_module("workbench.accessor")

            spec.loader.exec_module = load_both  # type: ignore[method-assign]
        return spec


if "xarray" in sys.modules:
    import_module("workbench.accessor")
else:
    sys.meta_path.insert(0, _AfterXarray)
