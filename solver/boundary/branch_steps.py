"""Ordinary steps along a branch under dead loads by the compiled core, many in a call."""

from typing import Any

import numpy as np

from ..core import branches as core
from ..numerics.arclength import Node
from ..numerics.arrays import Array
from ..problem.reduced import EndsProblem
from .branch_coordinates import Chart, Path
from .branch_states import Bounds, Place, State
from .equilibrium_curve import EquilibriumCurve, Family

AT_END, IS_CLOSED = core.AT_END, core.IS_CLOSED


class OrdinarySteps:
    """The steps of one branch on which nothing happens but that the equilibrium changes; the others are not made.

    first: where the branch begins, to tell whether it is closed.
    """

    def __init__(self, family: Family, steps: core.Steps, bounds: Bounds, first: Place) -> None:
        self._family, self._steps, self._rounding = family, steps, bounds.rounding
        self._halts = np.array(sorted({*bounds.wanted, bounds.low, bounds.high}))
        self._first = np.zeros(1, core.RECORD)
        self._first["p"] = first.p
        for name in ("pin", "sign", "y", "leaving", "turns"):
            self._first[name] = getattr(first.path, name)

    def after(self, state: State, step: float, kept: int, most: int) -> tuple[list[Place], State, float, int, int]:
        """At most so many places after a state; the state at the last, the next step, and why there are no more."""
        at = _point_of(state)
        found, step, kept, why = self._steps.run(at, step, kept, self._first, most, self._halts, self._rounding)
        return _places(found), _state_of(at, self._family) if found.size else state, step, kept, why


def ordinary_steps(family: Any, bounds: Bounds, first: Place) -> OrdinarySteps | None:
    """None where the core is missing, the problem is not known as numbers, or the ends are held."""
    steps = family.steps if isinstance(family, Family) else None
    return None if steps is None else OrdinarySteps(family, steps, bounds, first)


def _places(found: Array) -> list[Place]:
    paths = zip(*(found[name].tolist() for name in ("pin", "sign", "y", "leaving", "turns")), strict=True)
    numbers = np.ascontiguousarray(found["numbers"].T)[:, :, None]
    return [
        Place(p, Path(*path), EndsProblem(*numbers[:, i]), index)
        for i, (p, path, index) in enumerate(zip(found["p"].tolist(), paths, found["index"].tolist(), strict=True))
    ]


def _point_of(state: State) -> core.Point:
    node = state.node
    pairs = (core.Pair(*value) for value in (node.w, node.jacobian[0], node.tangent))
    return core.Point(*pairs, node.sign, node.bend, state.curve.ahead, core.chart_of(state.curve.chart))


def _state_of(at: core.Point, family: Family) -> State:
    chart, path = at.chart, at.chart.at
    own = Path(path.pin, path.sign, path.y, path.leaving, path.turns)
    curve = EquilibriumCurve(family, Chart(core.KINDS[chart.kind], own, chart.scale, bool(chart.logarithmic)), at.ahead)
    w, jacobian, tangent = (np.array(pair) for pair in (at.w, at.jacobian, at.tangent))
    return State(curve, Node(w, jacobian[None], tangent, at.sign, at.bend))
