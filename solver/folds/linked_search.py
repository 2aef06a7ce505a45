"""Fold and pitchfork curves that hang together with known equilibria, by the branches along the lines of a lattice."""

from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from ..levels.level_search import Census
from ..numerics.arclength import FOLD, PITCHFORK
from ..numerics.arrays import Array
from .curve_crossings import join_pieces
from .fold_curves import FoldCurves, curves_of
from .fold_search import Searched
from .fold_seeds import Counted, change_beyond
from .lattice_branches import Branches, Equilibrium, Meeting, Node, PlaneSystem, branches_on
from .parameter_plane import ParameterPlane
from .whole_curve import WholeCurve

ASKEW = 0.013  # lines of the lattice stay off lines of symmetry


def lattice_ticks(lattice: int) -> Array:
    """The values of z along both numbers at which the lines of a lattice lie."""
    return np.linspace(0, 1, lattice + 2)[1:-1] + ASKEW / lattice


def search_linked(
    plane: ParameterPlane,
    system: PlaneSystem[Equilibrium],
    ticks: Array,
    begin: dict[Node, list[tuple[Equilibrium, int]]],
) -> FoldCurves:
    """The curves that branches along the lines z = ticks of a lattice meet; begin: equilibria with their indices."""
    branches = branches_on(system, ticks, begin)
    curves, failed = curves_through(system, branches.meetings)
    pieces = join_pieces([curve.dense() for curve in curves], [curve.lower for curve in curves])
    counted = Counted(plane)
    for (i, j), known in branches.known.items():
        index = np.array([index for _, index in known], dtype=np.int64)
        counted.known[float(ticks[i]), float(ticks[j])] = Census(0.0 * index, index, index, False)
    searched = Searched(plane, curves, pieces, counted, [])
    return curves_of(searched, remark_of(searched, branches, failed, ticks))


def curves_through(
    system: PlaneSystem[Equilibrium], meetings: list[Meeting[Equilibrium]]
) -> tuple[list[WholeCurve], int]:
    """The curves through the special points of branches, and how many of these gave none."""
    curves: list[WholeCurve] = []
    failed = 0
    for meeting in meetings:
        kind = FOLD if meeting.stages[1].kind == FOLD else PITCHFORK
        is_known = partial(_is_known, system, tuple(curves), kind)
        if is_known(meeting.z, meeting.stages[1].equilibrium):
            continue
        through = system.curves(meeting, is_known)
        failed += through is None
        curves += through or []
    return curves, failed


def _is_known(system: PlaneSystem[Any], curves: tuple[WholeCurve, ...], kind: str, z: Array, equilibrium: Any) -> bool:
    return any(curve.kind == kind and curve.holds(z, system.signature(equilibrium)) for curve in curves)


def remark_of(searched: Searched, branches: Branches[Any], failed: int, ticks: Array) -> str:
    """What is known of the search, which nothing proves complete."""
    said = [f"not proved complete: {branches.count} branches along {2 * ticks.size} lines were followed"]
    if branches.stopped:
        said.append(f"{branches.stopped} of them could not be followed to the border")
    if not branches.whole:
        said.append("more were met and not followed")
    stopped = sum("stopped" in curve.ends for curve in searched.curves)
    if stopped:
        said.append(f"{stopped} of {len(searched.curves)} curves could not be followed to the border")
    if failed:
        said.append(f"of {failed} points where branches meet no curve was found")
    ends = [(np.array([a, w]), np.array([b, w])) for a, b in pairwise(ticks) for w in ticks]
    ends += [(one[::-1], other[::-1]) for one, other in ends]
    unlike = sum(bool(change_beyond(searched.counted, searched.pieces, *two)) for two in ends)
    if unlike:
        said.append(f"on {unlike} of {len(ends)} pieces of these lines the equilibria do not fit the curves")
    return "; ".join(said)
