"""The methods, one file each."""

from .base import Method, Trajectory
from .collocation import COLLOCATION
from .difference import DIFFERENCE
from .dop853 import DOP853
from .euler import EULER
from .heyoka import HEYOKA, INSTALLED
from .lsoda import LSODA
from .orbit import ORBIT
from .rk4 import RK4
from .shooting import SHOOTING
from .swing import INSTALLED as COMPILED
from .swing import SWING
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
    **({"swing": SWING} if COMPILED else {}),
    **({"heyoka": HEYOKA} if INSTALLED else {}),
}

__all__ = ["METHODS", "Method", "Trajectory"]
