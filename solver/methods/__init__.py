"""The methods, one file each."""

from .base import Method, Trajectory
from .dop853 import DOP853
from .orbit import ORBIT
from .verlet import VERLET

METHODS: dict[str, Method] = {
    "orbit": ORBIT,
    "dop853": DOP853,
    "verlet": VERLET,
}

__all__ = ["METHODS", "Method", "Trajectory"]
