"""The equilibrium that continues from the straight rod as its loads grow, stable where one is."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..branches.branch_events import Bounds
from ..numerics.arclength import END, Lengths
from ..numerics.roots import halve
from ..problem.case import ALONG_ITSELF
from .buckling import AHEAD, buckle, buckling_shares, lying_rod, straight_index, straight_shape
from .curve import Curve, Point, trace_shapes
from .descent import descend, index_at, index_of_any, is_near
from .loaded_rod import SHORT, LoadedRod
from .local_waves import PASSED, QUIET, leans_and_buckles, lock_up_share, sinusoid, wound_shape
from .newton import correct, is_same
from .taut import taut_shape
from .varying_shapes import Shape

MOST_POINTS = 1000  # of a branch
LENGTHS = Lengths(first=0.1, longest=0.25, least=1e-4)  # of steps
LEAST_RUBBED = 1e-2  # the same of a rod with friction, whose branch ends where its waves run
MOST_FORCES, MOST_FAILED = 20, 3  # that are tried for a held height; of which as many fail
LEAST_BENT = 1e-3  # how much they shorten the rod, of the wanted
FRICTION = "this friction"
HINGES = "hinged ends (M10 and M1L in place of beta0 and betaL)"
AS_A_WHOLE = "a rod that moves as a whole (sliding 'axial-forward' or 'axial-backward')"
LOCKED = (
    "the rod locks up: on {:.3g} of the length from s = L friction lets less than {:.0%} of a change of the axial "
    "force pass"
)
RESTLESS = (
    "the {} rod buckles under its compression with friction, and no sinusoid or helix at rest was found: friction may "
    "drive waves along the rod or wind up its helix"
)
FINE = 2.0**-8  # of the range of a load: how closely it is enclosed
SHARES_AHEAD = 1.0, 0.9, 0.7, 0.4  # of the rest of the way: where a sinusoid is tried when a branch ends


@dataclass(frozen=True, eq=False)
class Path:
    """How a shape was reached.

    shape: None if none was. index: its Morse index; 0 with friction, which has none. buckled: the share of the loads at
    which the straight rod buckles; None if it does not. jumped: shares at which the branch ended and the rod fell to
    another one. rubbed: whether the straight rod buckles by its friction alone. wound: whether the shape is a helix in
    place of a sinusoid that would lift off. taut: whether it continues from a taut rod without weight in place of the
    straight one. why: why no shape, or none under the whole loads, was reached. limit,
    share: the far end's phi above which a rod with friction has a shape, and the share of its friction with which it
    has one; None where they are not known.
    """

    shape: Shape | None
    index: int = 0
    buckled: float | None = None
    jumped: tuple[float, ...] = ()
    rubbed: bool = False
    wound: bool = False
    taut: bool = False
    why: str = ""
    limit: float | None = None
    share: float | None = None


def branch_from_straight(rod: LoadedRod) -> Path:
    """The equilibrium on the branch of the straight rod.

    A straight rod that is stable is the answer. Elsewhere the loads grow from 0, but for the weight across, which is
    whole from the beginning; where the straight rod buckles the path takes the buckled shape, and where it ends, the
    stable shape below it. Friction grows at last, on the shape without it. A long rod whose sinusoid would lift off the
    wall takes the helix.
    """
    if rod.rubbed:
        return branch_with_friction(rod)
    wound = wound_shape(rod)
    if wound is not None:
        return Path(wound, wound=True)
    if "height" in rod.held:
        return branch_to_height(rod)
    t = rod.nodes()
    if not rod.straight:
        return grow(rod.share, straight_shape(rod.share(0.0), t))
    shape = straight_shape(rod, t)
    if index_at(shape) == 0:
        return Path(shape)
    critical = next(buckling_shares(rod, t))[0]
    buckled = buckle(rod, t, critical)
    if buckled is None:
        why = f"no stable equilibrium was found near {critical:.6g} of the loads, where the straight rod buckles"
        return Path(None, buckled=critical, why=why)
    first, share = buckled

    def share_at(x: float) -> float:  # in the root of the distance from the buckling load the branch is smooth
        return 1 - (1 - x * x) * (1 - critical)

    begin = np.sqrt((share - critical) / (1 - critical)) if share < 1 else 1.0
    path = grow(lambda x: rod.share(share_at(x)), first, begin)
    return replace(path, buckled=critical, jumped=tuple(map(share_at, path.jumped)))


def branch_with_friction(rod: LoadedRod) -> Path:
    """The equilibrium of a rod with friction.

    It is straight where that is stable, and near its taut shape where it has one. Elsewhere it is the sinusoid or the
    helix that follows the local compression, or what the shape without friction becomes while friction grows. A shape
    is never straight where the straight rod buckles: then none is known.
    """
    locked = lock_up_share(rod)
    if locked is not None:
        limit = least_tension(rod, lambda pulled: lock_up_share(pulled) is not None)
        return Path(None, why=LOCKED.format(locked, PASSED), limit=limit)
    if rod.straight and not straight_index(rod):
        return Path(straight_shape(rod, rod.nodes()))
    if not rod.straight and (taut := taut_shape(rod)) is not None:
        return Path(None, why=taut) if isinstance(taut, str) else Path(taut, taut=True)
    if (wound := wound_shape(rod)) is not None:
        return Path(wound, wound=True)
    plain = rod.with_friction(0.0)
    alone = rod.straight and not straight_index(plain)
    if (bent := sinusoid(rod)) is not None:
        return Path(bent, rubbed=alone)
    if rod.turning and (bent := sinusoid(rod.with_torque(0.0))) is not None:
        path = grow(rod.with_torque, bent)
        if path.shape is not None:
            return path
    path = Path(None) if alone else grow_friction(rod, branch_from_straight(plain))
    if path.shape is not None and not (rod.straight and is_same(path.shape, straight_shape(rod, path.shape.t))):
        return path
    if not (rod.straight or leans_and_buckles(rod)):
        return path
    hints = [HINGES] * bool({"beta0", "betaL"} & rod.held and not rod.turning) + [AS_A_WHOLE] * bool(
        rod.numbers[4] == ALONG_ITSELF
    )
    why = RESTLESS.format("leaning" if rod.turning else "straight")
    why = f"{why}; {' or '.join(hints)} may have an answer" if hints else why
    is_at_fault = partial(leans_and_buckles, beyond=QUIET) if rod.turning else straight_index
    return Path(None, why=why, limit=least_tension(rod, is_at_fault), share=path.share or 0.0)


def grow_friction(rod: LoadedRod, plain: Path) -> Path:
    """What the shape without friction becomes while friction grows."""
    if plain.shape is None:
        return plain
    path = grow(rod.with_friction, plain.shape, target=FRICTION)
    return replace(path, buckled=plain.buckled, jumped=plain.jumped, wound=plain.wound)


def least_tension(rod: LoadedRod, is_at_fault: Callable[[LoadedRod], object]) -> float:
    """The far end's phi, a little above the least one, at which a rod has a fault no more that it has under its own."""
    low, high = float(rod.far[2]), max(0.0, lying_rod(rod).along * rod.span)
    return halve(lambda phi: not is_at_fault(rod.with_tension(phi)), low, high, (high - low) * FINE)[1]


def branch_to_height(rod: LoadedRod) -> Path:
    """The same where the height is held: it changes to the held one from that of a shape bent by an axial force.

    A straight rod does not answer a change of its height.
    """
    size, why, failed = 0.0, "no axial force was found that bends the rod", 0
    for _ in range(MOST_FORCES):
        path = branch_from_straight(rod.with_tension(-size))
        size = 2 * size or float(rod.rate(np.array([rod.span]))[0] ** 2) / 4
        if path.shape is None:
            why, failed = f"no axial force was found that bends the rod: {path.why}", failed + 1
            if failed == MOST_FAILED:
                break
            continue
        height = float(rod.span - path.shape.y[-1, SHORT])
        if rod.span - height < LEAST_BENT * (rod.span - rod.far[2]):
            continue

        def at(share: float, height: float = height) -> LoadedRod:
            held = rod.far.copy()
            held[2] += (1 - share) * (height - held[2])
            return replace(rod, far=held)

        grown = grow(at, Shape(at(0.0), path.shape.t, path.shape.y))
        return replace(grown, buckled=path.buckled, jumped=path.jumped + grown.jumped)
    return Path(None, why=why)


def grow(rod_at: Callable[[float], LoadedRod], shape: Shape, share: float = 0.0, target: str = "these loads") -> Path:
    """The equilibrium reached from one at a share of something while the share grows to 1; a stable one stays stable.

    rod_at: the rod at each share. target: what is whole at 1.
    """
    whole, jumped = rod_at(1.0), list[float]()
    lengths = replace(LENGTHS, least=LEAST_RUBBED) if whole.rubbed else LENGTHS
    curve = Curve(rod_at, 1.0, whole.scale, lengths)
    while share < 1:
        begun = Point(shape, share, np.append(np.zeros(shape.y.size), 1.0))
        places, stop = trace_shapes(curve, begun, True, Bounds(share, 1.0, (), MOST_POINTS))
        if places:
            share, shape = places[-1].p, places[-1].path
        if stop.reason == END:
            break
        below = stable_shape_ahead(rod_at, shape, share)
        if below is None:
            why = f"the branch ends at {share:.3g} of the way to {target}"
            return Path(None, jumped=tuple(jumped), why=why, share=share if target == FRICTION else None)
        jumped.append(share)
        share, shape = below
    final = correct(replace(shape, rod=whole))
    if final is None or not is_near(shape, final):
        why = f"Newton's method did not converge at the end of the way to {target}"
        return Path(None, jumped=tuple(jumped), why=why)
    return Path(final, index_of_any(final), jumped=tuple(jumped))


def stable_shape_ahead(rod_at: Callable[[float], LoadedRod], shape: Shape, share: float) -> tuple[float, Shape] | None:
    """Where a branch ends at a share: the farthest stable sinusoid ahead, else the shape to which the rod falls.

    With its own share; None where the rod reaches none.
    """
    for rest in () if rod_at(1.0).rubbed else SHARES_AHEAD:  # that of a rod with friction was tried before
        ahead = 1.0 if rest == 1 else share + rest * (1 - share)
        wave = sinusoid(rod_at(ahead))
        if wave is not None and index_of_any(wave) == 0:
            return ahead, wave
    ahead = min(1.0, share + AHEAD)
    fallen = descend(Shape(rod_at(ahead), shape.t, shape.y))
    return None if fallen is None else (ahead, fallen)
