"""The kinds of scene, one a module; a new kind is a module here and its name in this table."""

from solver.problem.errors import no_such

from . import contact, curvature, equilibria, ghosts, grid, plain, twist
from .base import Kind

__all__ = ["KINDS", "Kind", "kind_of"]

KINDS = {module.KIND.name: module.KIND for module in (plain, contact, curvature, twist, ghosts, grid, equilibria)}


def kind_of(name: str) -> Kind:
    """The kind of that name. Raises `InputError` with the choices."""
    if name not in KINDS:
        raise no_such("kind of scene", name, KINDS)
    return KINDS[name]
