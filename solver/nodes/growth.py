"""How the shape of a rod was reached, and the way to it: an equilibrium that changes as its loads grow."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..branches.branch_events import Bounds
from ..numerics.arclength import END, POINTS, RISING
from .banded_newton import correct
from .buckling import AHEAD
from .descent import descend, is_near
from .loaded_rod import LoadedRod
from .local_waves import sinusoid
from .node_branch import CurvePoint, NodeCurve, trace_shapes
from .shape_index import index_of_any
from .varying_shapes import Shape

# the least step of a rod with friction, whose branch ends where its waves run. x10: branches end that go on
LEAST_RUBBED = 1e-2
# of the rest of the way: where a sinusoid is tried when a branch ends. x10: beyond the loads that are asked for
SHARES_AHEAD = 1.0, 0.9, 0.7, 0.4
LOADS, FRICTION, ENDS_AT = "these loads", "this friction", "the branch ends at"
STRAIGHT = "the straight rod"


@dataclass(frozen=True, eq=False)
class GrowthWay:
    """How a shape was reached.

    shape: None if none was. index: its Morse index; 0 with friction, which has none. buckled: the share of the loads at
    which the straight rod buckles; None if it does not. jumped: shares at which the branch ended and the rod fell to
    another one. rubbed: whether the straight rod buckles by its friction alone. wound: whether the shape is a helix in
    place of a sinusoid that would lift off. begun: from which rod it continues. why: why no shape, or none under the
    whole loads, was reached. barred: whether this bars every other way too. ended: the share at which the branch ended.
    limit, share: the far end's phi above which a rod with friction has a shape, and the share of its friction with
    which it has one; None where they are not known.
    """

    shape: Shape | None
    index: int = 0
    buckled: float | None = None
    jumped: tuple[float, ...] = ()
    rubbed: bool = False
    wound: bool = False
    begun: str = STRAIGHT
    why: str = ""
    barred: bool = False
    ended: float = 0.0
    limit: float | None = None
    share: float | None = None


def grow(rod_at: Callable[[float], LoadedRod], shape: Shape, share: float = 0.0, target: str = LOADS) -> GrowthWay:
    """The equilibrium reached from one at a share of something while the share grows to 1; a stable one stays stable.

    rod_at: the rod at each share. target: what is whole at 1.
    """
    whole, jumped = rod_at(1.0), list[float]()
    lengths = replace(RISING, least=LEAST_RUBBED) if whole.has_friction else RISING
    curve = NodeCurve(rod_at, 1.0, whole.scale, lengths)
    while share < 1:
        begun = CurvePoint(shape, share, np.append(np.zeros(shape.y.size), 1.0))
        places, stop = trace_shapes(curve, begun, True, Bounds(share, 1.0, (), POINTS))
        if places:
            share, shape = places[-1].p, places[-1].path
        if stop.reason == END:
            break
        below = stable_shape_ahead(rod_at, shape, share)
        if below is None:
            why = f"{ENDS_AT} {share:.3g} of the way to {target}"
            known = share if target == FRICTION else None
            return GrowthWay(None, jumped=tuple(jumped), why=why, ended=share, share=known)
        jumped.append(share)
        share, shape = below
    final = correct(replace(shape, rod=whole))
    if final is None or not is_near(shape, final):
        why = f"Newton's method did not converge at the end of the way to {target}"
        return GrowthWay(None, jumped=tuple(jumped), why=why, ended=1.0)
    return GrowthWay(final, index_of_any(final), jumped=tuple(jumped))


def stable_shape_ahead(rod_at: Callable[[float], LoadedRod], shape: Shape, share: float) -> tuple[float, Shape] | None:
    """Where a branch ends at a share: the farthest stable sinusoid ahead, else the shape to which the rod falls.

    With its own share; None where the rod reaches none.
    """
    for rest in () if rod_at(1.0).has_friction else SHARES_AHEAD:  # that of a rod with friction was tried before
        ahead = 1.0 if rest == 1 else share + rest * (1 - share)
        wave = sinusoid(rod_at(ahead))
        if wave is not None and index_of_any(wave) == 0:
            return ahead, wave
    ahead = min(1.0, share + AHEAD)
    fallen = descend(Shape(rod_at(ahead), shape.t, shape.y))
    return None if fallen is None else (ahead, fallen)
