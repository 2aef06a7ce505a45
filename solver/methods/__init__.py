"""The methods, one file each."""

from ..problem.trajectory import Trajectory
from . import heyoka, swing
from .base import Method
from .collocation import COLLOCATION
from .difference import DIFFERENCE
from .dop853 import DOP853
from .euler import EULER
from .lsoda import LSODA
from .orbit import ORBIT
from .rk4 import RK4
from .shooting import SHOOTING
from .verlet import VERLET

METHODS: dict[str, Method] = {
    "orbit": ORBIT,
    "dop853": DOP853,
    "lsoda": LSODA,
    "verlet": VERLET,
    "rk4": RK4,
    "euler": EULER,
    "shooting": SHOOTING,
    "difference": DIFFERENCE,
    "collocation": COLLOCATION,
    **({"swing": swing.SWING} if swing.INSTALLED else {}),
    **({"heyoka": heyoka.HEYOKA} if heyoka.INSTALLED else {}),
}

MISSING = {"heyoka": heyoka.MISSING, "swing": swing.MISSING}  # what to say where they are not installed

__all__ = ["METHODS", "MISSING", "Method", "Trajectory"]
