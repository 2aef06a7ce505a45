"""The kind curvature: the curvature of the rod in colour."""

from ...geometry.centreline import Array, Centreline
from ..colours import by_curvature
from .base import Kind


def kappa(line: Centreline, s: Array) -> Array:
    """The curvature at s, (k,) [1/length]."""
    return line.kappa(s)


KIND = Kind("curvature", "how tightly the rod is bent", "one", value=kappa, paint=by_curvature)
