"""The mechanics and the numerics of an elastic rod on a cylinder. Needs numpy and scipy, nothing else."""

from .equilibria import Equilibrium, equilibria
from .equilibrium_branch import Branch
from .follow import follow
from .inverse import fit
from .loops import Loop, loops
from .observe import observe
from .problem.case import Case, Cylinder, Ends, Rod, Start
from .problem.errors import InputError
from .problem.rod import weight_in_fluid
from .region_map import fold_curves, region_map
from .solution import Solution
from .solve import solve
from .switch import switch
from .traced_folds import trace_fold

__version__ = "0.2.0"
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


def __dir__() -> list[str]:
    """The public names: what completion shows."""
    return [*__all__, "__version__"]
