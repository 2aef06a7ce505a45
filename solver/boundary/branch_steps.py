"""Ordinary steps along a branch under dead loads by the compiled core, many in a call."""

from typing import Any

import numpy as np

from ..core import branches as core
from ..core.panels import available
from ..numerics.arclength import Node
from ..numerics.arrays import Array
from ..orbit.critical_points import grid
from ..problem.reduced import EndsProblem
from .branch_coordinates import Chart, Path
from .branch_states import Bounds, Place, State
from .equilibrium_curve import EquilibriumCurve, Family
from .transit_times import CUTTING, NODES

AT_END, IS_CLOSED = core.AT_END, core.IS_CLOSED


class OrdinarySteps:
    """The steps of one branch on which nothing happens but that the equilibrium changes; the others are not made.

    first: where the branch begins, to tell whether it is closed.
    """

    def __init__(self, family: Family, bounds: Bounds, first: Place) -> None:
        assert family.numbers is not None
        halts = sorted({*bounds.wanted, bounds.low, bounds.high})
        self._family, self._bounds = family, bounds
        self._steps = core.Steps(family.numbers, family.scale, halts, bounds.rounding, grid(), NODES, CUTTING)
        self._first = np.zeros(1, core.RECORD)
        path = first.path
        for name in ("pin", "sign", "y", "leaving", "turns"):
            self._first[name] = getattr(path, name)
        self._first["p"] = first.p

    def after(self, state: State, step: float, kept: int, most: int) -> tuple[list[Place], State, float, int, int]:
        """At most so many places after a state; the state at the last, the next step, and why there are no more."""
        at = _point_of(state)
        found, step, kept, why = self._steps.run(at, step, kept, self._first, most)
        if not found.size:
            return [], state, step, kept, why
        return _places(found), _state_of(at, self._family), step, kept, why


def ordinary_steps(family: Any, bounds: Bounds, first: Place) -> OrdinarySteps | None:
    """None where the core is missing, the problem is no function of one number, or the ends are held."""
    if not available() or not isinstance(family, Family) or family.numbers is None:
        return None
    return OrdinarySteps(family, bounds, first)


def _places(found: Array) -> list[Place]:
    paths = zip(*(found[name].tolist() for name in ("pin", "sign", "y", "leaving", "turns")), strict=True)
    numbers = np.ascontiguousarray(found["numbers"].T)[:, :, None]
    return [
        Place(p, Path(*path), EndsProblem(*numbers[:, i]), index)
        for i, (p, path, index) in enumerate(zip(found["p"].tolist(), paths, found["index"].tolist(), strict=True))
    ]


def _point_of(state: State) -> core.Point:
    node, chart = state.node, state.curve.chart
    at = core.Path(chart.at.pin, chart.at.sign, chart.at.y, chart.at.leaving, chart.at.turns)
    drawn = core.Chart(core.KINDS.index(chart.kind), chart.logarithmic, 0.0, chart.scale, at)
    pairs = (core.Pair(*value) for value in (node.w, node.jacobian[0], node.tangent))
    return core.Point(*pairs, node.sign, node.bend, state.curve.ahead, drawn)


def _state_of(at: core.Point, family: Family) -> State:
    chart, path = at.chart, at.chart.at
    own = Path(path.pin, path.sign, path.y, path.leaving, path.turns)
    curve = EquilibriumCurve(family, Chart(core.KINDS[chart.kind], own, chart.scale, bool(chart.logarithmic)), at.ahead)
    w, jacobian, tangent = (np.array(pair) for pair in (at.w, at.jacobian, at.tangent))
    return State(curve, Node(w, jacobian[None], tangent, at.sign, at.bend))
