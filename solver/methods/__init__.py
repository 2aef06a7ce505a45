"""The methods, one file each."""

from .base import EndsMethod, Method, StartMethod
from .collocation import Collocation
from .difference import Difference
from .dop853 import DOP853
from .euler import Euler
from .heyoka import Heyoka
from .lsoda import LSODA
from .orbit import OrbitQuadrature
from .rk4 import RK4
from .shooting import Shooting
from .swing import SwingTaylor
from .verlet import Verlet

METHODS: dict[str, type[StartMethod] | type[EndsMethod]] = {
    "orbit": OrbitQuadrature,
    "dop853": DOP853,
    "lsoda": LSODA,
    "verlet": Verlet,
    "rk4": RK4,
    "euler": Euler,
    "shooting": Shooting,
    "difference": Difference,
    "collocation": Collocation,
    "swing": SwingTaylor,
    "heyoka": Heyoka,
}

__all__ = [
    "DOP853", "LSODA", "METHODS", "RK4", "Collocation", "Difference", "EndsMethod", "Euler", "Heyoka", "Method",
    "OrbitQuadrature", "Shooting", "StartMethod", "SwingTaylor", "Verlet", "available",
]  # fmt: skip


def available() -> dict[str, type[StartMethod] | type[EndsMethod]]:
    """The methods that can run here: those whose package is installed."""
    return {name: method for name, method in METHODS.items() if method.is_installed()}
