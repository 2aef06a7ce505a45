"""The kind contact: the push of the cylinder in colour, and where it would have to pull."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...figures.style import LIFTED
from ...geometry.centreline import Array, Centreline
from ..colours import by_push
from .base import Kind

if TYPE_CHECKING:
    from ..body import Body


def push(line: Centreline, s: Array) -> Array:
    """The cylinder's push at s, (k,) [force/length]."""
    return line.push(s)


def legend(bodies: Sequence["Body"]) -> list[tuple[str, str]]:
    """The colour of lift-off, where a rod has it."""
    pulled = any(body.extremes()[0] < 0 for body in bodies)
    return [(LIFTED, "the cylinder would have to\npull: the rod would lift off")] if pulled else []


KIND = Kind("contact", "how hard the cylinder pushes, and where it would have to pull", "one", value=push,
            paint=by_push, legend=legend)  # fmt: skip
