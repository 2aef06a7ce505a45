"""The kinds of scene: what each reads of a dataset, what it computes of that, and how it colours the rod."""

from dataclasses import dataclass
from typing import Literal

from solver.problem.errors import no_such

from ..geometry import centreline

Tint = Literal["one colour", "contact", "kappa", "stripe", "case"]


@dataclass(frozen=True)
class Kind:
    """A kind of scene.

    reads: variables of the dataset that it opens, beside the case's outcome, caution and arc length. Nothing else is
    read, and of what can be computed along the rod only what `tint` names. cells: what stands on the sheet: one rod
    from two sides, each case of an axis in a cell of its own, or all of them in one scene.
    """

    name: str
    tint: Tint
    cells: Literal["one", "each", "together"]
    reads: frozenset[str]
    says: str


_CURVE = frozenset(centreline.NEEDED)

KINDS = {
    kind.name: kind
    for kind in (
        Kind("plain", "one colour", "one", _CURVE, "the rod on its cylinder"),
        Kind("contact", "contact", "one", _CURVE, "how hard the cylinder pushes, and where it would have to pull"),
        Kind("curvature", "kappa", "one", _CURVE, "how tightly the rod is bent"),
        Kind("twist", "stripe", "one", _CURVE | {"gamma"}, "a stripe on the rod that turns with its material"),
        Kind("ghosts", "case", "together", _CURVE, "every case of an axis in one scene"),
        Kind("grid", "contact", "each", _CURVE, "every case of one axis or two, side by side at one scale"),
        Kind("equilibria", "contact", "each", _CURVE | {"energy", "index"}, "every shape between two ends"),
    )
}


def kind_of(name: str) -> Kind:
    """The kind of that name; raises `InputError` with the choices."""
    if name not in KINDS:
        raise no_such("kind of scene", name, KINDS)
    return KINDS[name]
