"""The mechanics and the numerics of an elastic rod on a cylinder. Needs numpy and scipy, nothing else."""

from .case import Case, Cylinder, Ends, Rod, Start
from .equilibria import Equilibrium, equilibria
from .errors import InputError
from .observables import observe
from .solution import Solution
from .solve import solve

__all__ = [
    "Case",
    "Cylinder",
    "Ends",
    "Equilibrium",
    "InputError",
    "Rod",
    "Solution",
    "Start",
    "equilibria",
    "observe",
    "solve",
]
