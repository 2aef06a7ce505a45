"""The methods, one file each."""

from .base import Method, Trajectory
from .difference import DIFFERENCE
from .dop853 import DOP853
from .orbit import ORBIT
from .shooting import SHOOTING
from .verlet import VERLET

METHODS: dict[str, Method] = {
    "orbit": ORBIT,
    "dop853": DOP853,
    "verlet": VERLET,
    "shooting": SHOOTING,
    "difference": DIFFERENCE,
}

__all__ = ["METHODS", "Method", "Trajectory"]
