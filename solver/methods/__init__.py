"""The methods, one file each."""

from .base import Method, Trajectory
from .dop853 import DOP853
from .verlet import VERLET

METHODS: dict[str, Method] = {
    "dop853": DOP853,
    "verlet": VERLET,
}

__all__ = ["METHODS", "Method", "Trajectory"]
