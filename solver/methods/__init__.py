"""The methods; the automatic ones, and the one that a caller names."""

from typing import Any

from ..problem.errors import InputError, choices, known_name, no_such
from .adaptive import DOP853, LSODA, Heyoka
from .collocation import Collocation
from .difference import Difference
from .half_period import OrbitQuadrature, SwingTaylor
from .marching import RK4, Euler, Verlet
from .method import EndsMethod, Method, StartMethod
from .shooting import Shooting

_CLASSES: tuple[type[StartMethod] | type[EndsMethod], ...] = (
    OrbitQuadrature, DOP853, LSODA, Verlet, RK4, Euler, Shooting, Difference, Collocation, SwingTaylor, Heyoka,
)  # fmt: skip
METHODS = {method.name: method for method in _CLASSES}

AUTOMATIC = {"start": "swing", "ends": "shooting"}  # measured, see docs/reference/methods.md

VARYING = {"start": "taylor", "ends": "shooting"}  # of rods with weight or friction
FREE = "uno"  # of rods that may leave the cylinder

__all__ = [
    "AUTOMATIC", "DOP853", "FREE", "LSODA", "METHODS", "RK4", "VARYING", "Collocation", "Difference", "EndsMethod",
    "Euler", "Heyoka", "Method", "OrbitQuadrature", "Shooting", "StartMethod", "SwingTaylor", "Verlet", "available",
    "choose_method", "free_method", "method_on_nodes",
]  # fmt: skip


def available() -> dict[str, type[StartMethod] | type[EndsMethod]]:
    """The methods that can run here: those whose package is installed."""
    return {name: method for name, method in METHODS.items() if method.is_installed()}


def method_on_nodes(kind: str, method: str | Method, knobs: dict[str, Any] | None = None) -> str:
    """The name of the method for rods with weight or friction. Raises `InputError` where another one is asked for."""
    name = VARYING[kind]
    choice = name if isinstance(method, str) and method == name else _name_of(method)
    if choice not in ("auto", name) or knobs:
        raise InputError(f"a rod with weight or friction is solved by {name} alone, without knobs; got {choice!r}")
    return name


def free_method(method: str | Method, knobs: dict[str, Any] | None = None) -> str:
    """The name of the method for rods that may leave the cylinder; `InputError` where another one is asked for."""
    choice = method if isinstance(method, str) else method.name
    if choice not in ("auto", FREE) or knobs:
        raise InputError(f"a rod that may leave the cylinder is solved by {FREE} alone, without knobs; got {choice!r}")
    return FREE


def choose_method(kind: str, method: str | Method, knobs: dict[str, Any] | None = None) -> StartMethod | EndsMethod:
    """The method for a kind of problem that a caller asks for: "auto", a name, or a method with its knobs.

    Raises `InputError` for an unknown name, a method of another kind of problem or not installed, or an invalid knob.
    """
    if isinstance(method, Method) and knobs:
        raise InputError(f"set the knobs {choices(knobs)} in the method, {type(method).__name__}(...), not in solve")
    name = _name_of(method)
    name = AUTOMATIC[kind] if name == "auto" else name
    instance = method if isinstance(method, Method) else METHODS[name].with_knobs(knobs or {})
    if kind not in instance.problems:
        able = [other.name for other in METHODS.values() if kind in other.problems]
        raise InputError(f"method {name!r} does not solve {kind} problems; choose from {choices(able)}")
    assert isinstance(instance, StartMethod | EndsMethod)
    return instance


def _name_of(method: Any) -> str:
    """The name of a method that a caller asks for. Raises `InputError` for an unknown one."""
    if isinstance(method, Method):
        return method.name
    if not known_name(method, ["auto", *METHODS]):
        raise no_such("method", method, ["auto", *METHODS])
    return str(method)
