"""The equilibrium that continues from the straight rod as its loads grow, stable where one is."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ..numerics.arrays import ROUGHLY
from ..numerics.roots import halve
from ..problem.case import ALONG_ITSELF
from .banded_newton import correct, is_same
from .buckling import (
    buckle,
    index_of_straight,
    rod_without_friction,
    shares_of_buckling,
    straight_index,
    straight_shape,
)
from .growth import ENDS_AT, FRICTION, LOADS, GrowthWay, grow
from .loaded_rod import ALPHA, SHORT, LoadedRod
from .local_waves import QUIET, leans_and_buckles, sinusoid, wants_helix, wound_shape
from .lock_up import PASSED, lock_up_share, lock_up_tension
from .taut import taut_shape
from .varying_shapes import Shape

# that are tried for a held height, each twice the one before; of which as many fail. x10: forces beyond any rod; only
# failures take longer
MOST_FORCES, MOST_FAILED = 20, 2
# shares of the loads; of the way. x10: ten times the loads have other shapes; only time
NEIGHBOURS, NEARLY = (0.99, 1.01), 0.9
TAUT = "the taut rod without weight"
NEEDS_TORQUE = "a straight rod needs MZ = M3, or an azimuth in place of MZ"
FINE = 2.0**-8  # of the range of a load: how closely it is enclosed, as it is only a start. x10: a start farther off


def find_shape(rod: LoadedRod) -> GrowthWay:
    """The equilibrium on the branch of the straight rod; where that branch ends, one that another way reaches.

    Where none does, its reason says where each ended. A rod with friction that is bent by its torque alone is given no
    other way: it may wind up at its end without limit, and with friction no index would show that.
    """
    from_straight = branch_from_straight(rod)
    if from_straight.shape is not None or from_straight.barred:
        return from_straight
    lying = rod.with_friction(0.0)  # what turns in place leans
    bent_by_torque = not (lying.straight or "azimuth" in lying.held) and lying.with_torque_through().straight
    others = from_taut_rod, partial(from_neighbours, way=from_straight), from_tension, from_no_weight
    why = from_straight.why
    for way_by in () if bent_by_torque and rod.has_friction else others:
        other = way_by(rod)
        if other.shape is not None:
            return other
        why += f"; that from {other.begun} ends at {other.ended:.3g} of its way" if other.ended else ""
    if bent_by_torque and NEEDS_TORQUE not in why:  # that without friction says it too
        why += f"; {NEEDS_TORQUE}"
    return replace(from_straight, why=why)


def helix_of(rod: LoadedRod) -> Shape | None:
    """The helix that a rod takes in place of a sinusoid that would lift off; None of another rod.

    Where Newton's method does not lead to it, it is that under a little less or more of the loads, carried back.
    """
    if not wants_helix(rod):
        return None
    shape = wound_shape(rod)
    for share in () if shape is not None else NEIGHBOURS:
        near = wound_shape(rod.share(share))
        if near is not None:
            shape = grow(partial(between_shares, rod, share), near).shape
            if shape is not None:
                break
    return shape


def from_taut_rod(rod: LoadedRod) -> GrowthWay:
    """The shape of a rod that is taut without its weight, which then grows.

    A held azimuth is free until then, and moves at last to where it is held: as the rod is stable without that, it is
    stable with it.
    """
    free = rod.with_torque_through() if "azimuth" in rod.held else rod
    taut = taut_shape(free.with_weight(0.0)) if rod.along or rod.across else None
    way = grow(free.with_weight, taut) if isinstance(taut, Shape) else GrowthWay(None)
    if way.shape is None or free is rod:
        return replace(way, begun=TAUT)
    gained, goal = float(way.shape.y[-1, ALPHA] - rod.near[1]), float(rod.far[1])
    first = correct(replace(way.shape, rod=rod.with_azimuth(gained)))
    if first is None:
        return GrowthWay(None)
    turned = grow(lambda x: rod.with_azimuth(gained + (goal - gained) * x), first)
    begun = f"{TAUT}, whose far end is free to go round at first"
    return replace(turned, jumped=way.jumped + turned.jumped, begun=begun)


def from_neighbours(rod: LoadedRod, way: GrowthWay) -> GrowthWay:
    """The shape of the rod under a little less or more of its loads, carried back; way: that of the rod itself.

    Where the branch of the rod ends far from its loads those of its neighbours do too, and are not followed.
    """
    for share in NEIGHBOURS if way.ended > NEARLY else ():
        near = branch_from_straight(rod.share(share))
        if near.shape is not None:
            back = grow(partial(between_shares, rod, share), near.shape)
            if back.shape is not None:
                return replace(back, begun=f"the rod under {share:g} times these loads")
    return GrowthWay(None)


def between_shares(rod: LoadedRod, share: float, x: float) -> LoadedRod:
    """The rod under a share of its loads at x = 0, and under all of them at 1."""
    return rod.share(share + (1 - share) * x)


def from_tension(rod: LoadedRod) -> GrowthWay:
    """The shape of a rod that more tension holds straight at first."""
    if "height" in rod.held:
        return GrowthWay(None)
    more = float(rod.rate(np.array([0.0, rod.span])).max()) ** 2 + max(0.0, rod.along * rod.span)
    pulled = branch_from_straight(rod.with_tension(rod.tension_known + more))
    if pulled.shape is None:
        return GrowthWay(None)
    return replace(
        grow(lambda x: rod.with_tension(rod.tension_known + more * (1 - x)), pulled.shape),
        begun="the rod under more tension, which is taken off",
    )


def from_no_weight(rod: LoadedRod) -> GrowthWay:
    """The shape of a rod whose weight grows at last."""
    light = branch_from_straight(rod.with_weight(0.0)) if rod.along or rod.across else GrowthWay(None)
    if light.shape is None:
        return GrowthWay(None)
    return replace(grow(rod.with_weight, light.shape), begun="the rod without weight")


def branch_from_straight(rod: LoadedRod) -> GrowthWay:
    """The equilibrium on the branch of the straight rod.

    A straight rod that is stable is the answer. Elsewhere the loads grow from 0, but for the weight across, which is
    whole from the beginning; where the straight rod buckles it takes the buckled shape, and where it ends, the
    stable shape below it. Friction grows at last, on the shape without it. A long rod whose sinusoid would lift off the
    wall takes the helix.
    """
    if rod.has_friction:
        return branch_with_friction(rod)
    wound = helix_of(rod)
    if wound is not None:
        return GrowthWay(wound, wound=True)
    if "height" in rod.held:
        return branch_to_height(rod)
    t = rod.nodes()
    if not rod.straight:
        return grow(rod.share, straight_shape(rod.share(0.0), t))
    shape = straight_shape(rod, t)
    if index_of_straight(rod, t) == 0:
        return GrowthWay(shape)
    critical = next(shares_of_buckling(rod, t))[0]
    buckled = buckle(rod, t, critical)
    if buckled is None:
        why = f"no stable equilibrium was found near {critical:.6g} of the loads, where the straight rod buckles"
        return GrowthWay(None, buckled=critical, why=why)
    first, share = buckled

    def share_at(x: float) -> float:  # in the root of the distance from the buckling load the branch is smooth
        return 1 - (1 - x * x) * (1 - critical)

    begin = np.sqrt((share - critical) / (1 - critical)) if share < 1 else 1.0
    way = grow(lambda x: rod.share(share_at(x)), first, begin)
    ends = way.why.startswith(ENDS_AT)
    why = f"{ENDS_AT} {share_at(way.ended):.3g} of the way to {LOADS}" if ends else way.why
    return replace(way, buckled=critical, jumped=tuple(map(share_at, way.jumped)), why=why)


def branch_with_friction(rod: LoadedRod) -> GrowthWay:
    """The equilibrium of a rod with friction.

    It is straight where that is stable, and near its taut shape where it has one. Elsewhere it is the sinusoid or the
    helix that follows the local compression, or what the shape without friction becomes while friction grows. A shape
    is never straight where the straight rod buckles: then none is known.
    """
    locked = lock_up_share(rod)
    if locked is not None:
        why = (
            f"locked up. A push at s = 0 no longer reaches s = L: less than {100 * PASSED:g} % of a change of it "
            f"passes the last {100 * locked:.3g} % of the length, the reach of this load"
        )
        return GrowthWay(None, why=why, barred=True, limit=lock_up_tension(rod))
    if rod.straight and not straight_index(rod):
        return GrowthWay(straight_shape(rod, rod.nodes()))
    if not rod.straight and (taut := taut_shape(rod)) is not None:
        return GrowthWay(None, why=taut, barred=True) if isinstance(taut, str) else GrowthWay(taut, begun=TAUT)
    if (wound := helix_of(rod)) is not None:
        return GrowthWay(wound, wound=True)
    plain = rod.with_friction(0.0)
    alone = rod.straight and not straight_index(plain)
    if (bent := sinusoid(rod)) is not None:
        return GrowthWay(bent, rubbed=alone)
    turned = 0.0
    if rod.rotates and (bent := sinusoid(rod.with_torque(0.0))) is not None:
        way = grow(rod.with_torque, bent)
        if way.shape is not None:
            return way
        turned = way.ended
    way = GrowthWay(None) if alone else grow_friction(rod, find_shape(plain))
    if way.shape is not None and not (rod.straight and is_same(way.shape, straight_shape(rod, way.shape.t))):
        return way
    if not (rod.straight or leans_and_buckles(rod)):
        return way
    hints = []
    if {"beta0", "betaL"} & rod.held and (turned or not rod.rotates):
        hints.append("hinged ends (M10 and M1L in place of beta0 and betaL)")
    if rod.numbers[4] == ALONG_ITSELF:
        hints.append("a rod that moves as a whole (sliding 'axial-forward' or 'axial-backward')")
    why = (
        f"the {'straight' if rod.straight else 'leaning'} rod buckles under its compression with friction, and no "
        "sinusoid or helix at rest was found: friction may drive waves along the rod or wind up its helix"
    )
    why += f"; with {turned:.2g} of the torque that its rotation adds, as on a shorter rod, one was" if turned else ""
    why = f"{why}; {' or '.join(hints)} may have an answer" if hints else why
    is_at_fault = straight_index if rod.straight else partial(leans_and_buckles, beyond=QUIET)
    return GrowthWay(None, why=why, barred=True, limit=least_tension(rod, is_at_fault), share=way.share or 0.0)


def grow_friction(rod: LoadedRod, plain: GrowthWay) -> GrowthWay:
    """What the shape without friction becomes while friction grows."""
    if plain.shape is None:
        return plain
    way = grow(rod.with_friction, plain.shape, target=FRICTION)
    return replace(way, buckled=plain.buckled, jumped=plain.jumped, wound=plain.wound, begun=plain.begun)


def least_tension(rod: LoadedRod, is_at_fault: Callable[[LoadedRod], object]) -> float:
    """The far end's phi, a little above the least one, at which a rod has a fault no more that it has under its own."""
    low, high = float(rod.far[2]), max(0.0, rod_without_friction(rod).along * rod.span)
    return halve(lambda phi: not is_at_fault(rod.with_tension(phi)), low, high, (high - low) * FINE)[1]


def branch_to_height(rod: LoadedRod) -> GrowthWay:
    """A way to a rod whose height is held: it changes to the held one from that of a shape bent by an axial force.

    A straight rod does not answer a change of its height.
    """
    size, why, failed = 0.0, "no axial force was found that bends the rod", 0
    for _ in range(MOST_FORCES):
        way = (branch_from_straight if failed else find_shape)(rod.with_tension(-size))
        size = 2 * size or float(rod.rate(np.array([rod.span]))[0] ** 2) / 4
        if way.shape is None:
            why, failed = f"no axial force was found that bends the rod: {way.why}", failed + 1
            if failed == MOST_FAILED:
                break
            continue
        height = float(rod.span - way.shape.y[-1, SHORT])
        if rod.span - height < ROUGHLY * (rod.span - rod.far[2]):
            continue

        def at(share: float, height: float = height) -> LoadedRod:
            held = rod.far.copy()
            held[2] += (1 - share) * (height - held[2])
            return replace(rod, far=held)

        grown = grow(at, Shape(at(0.0), way.shape.t, way.shape.y))
        return replace(grown, buckled=way.buckled, jumped=way.jumped + grown.jumped, begun=way.begun)
    return GrowthWay(None, why=why)
