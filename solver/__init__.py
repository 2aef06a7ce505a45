"""The mechanics and the numerics of an elastic rod on a cylinder. Needs numpy and scipy, nothing else.

A public name is imported when it is first read, so that a table such as `solver.problem.quantities` needs no numerics.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .equilibria import Equilibrium, equilibria
    from .fits.fit_search import fit
    from .follow import follow
    from .follow_result import Branch
    from .loops import Loop, loops
    from .observe.observables import observe
    from .problem.case import Case, Cylinder, Ends, Rod, Start, weight_in_fluid
    from .problem.errors import InputError
    from .region_map import fold_curves, region_map
    from .solution import Solution
    from .solve import solve
    from .switch import switch
    from .trace_fold import trace_fold

__version__ = "0.3.0"
__all__ = [
    "Branch",
    "Case",
    "Cylinder",
    "Ends",
    "Equilibrium",
    "InputError",
    "Loop",
    "Rod",
    "Solution",
    "Start",
    "equilibria",
    "fit",
    "fold_curves",
    "follow",
    "loops",
    "observe",
    "region_map",
    "solve",
    "switch",
    "trace_fold",
    "weight_in_fluid",
]

# the module of each name that does not stand in one of its own name
_HOMES = {
    "Branch": "follow_result", "Case": "problem.case", "Cylinder": "problem.case", "Ends": "problem.case",
    "Equilibrium": "equilibria", "InputError": "problem.errors", "Loop": "loops", "Rod": "problem.case",
    "Solution": "solution", "Start": "problem.case", "fit": "fits.fit_search", "fold_curves": "region_map",
    "observe": "observe.observables", "weight_in_fluid": "problem.case",
}  # fmt: skip


def __dir__() -> list[str]:
    """The public names: what completion shows."""
    return [*__all__, "__version__"]


if not TYPE_CHECKING:  # a type checker would take every name for one of the package

    def __getattr__(name: str) -> Any:
        """A public name of its module, whatever stands there now."""
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(f"{__name__}.{_HOMES.get(name, name)}"), name)


class _Package(ModuleType):
    """The package, in which a name that a function shares with its module, such as `solve`, is the function."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in __all__ and isinstance(value, ModuleType)):  # what importing a module would set
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
