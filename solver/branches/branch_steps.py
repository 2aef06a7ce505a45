"""Ordinary steps along a branch by the compiled core, many in a call."""

from dataclasses import replace

import numpy as np

from ..core import branches as core
from ..equilibrium.charts import Chart
from ..equilibrium.held_index import held_index
from ..equilibrium.orbit_rates import OrbitRates
from ..levels.line_point import Path
from ..numerics.arclength import Node
from ..numerics.arrays import Array
from ..problem.reduced import EndsProblem
from .branch_events import Bounds, Place
from .branch_states import BranchState
from .equilibrium_curve import EquilibriumCurve
from .family import Family

AT_END, IS_CLOSED = core.AT_END, core.IS_CLOSED


class OrdinarySteps:
    """The steps of one branch on which nothing happens but that the equilibrium changes; the others are not made.

    first: where the branch begins, to tell whether it is closed.
    """

    def __init__(self, steps: core.Steps, bounds: Bounds, first: Place) -> None:
        self._steps, self._rounding = steps, bounds.rounding
        self._halts = np.array(sorted({*bounds.wanted, bounds.low, bounds.high}))
        self._first = np.zeros(1, core.RECORD)
        self._first["p"] = first.p
        for name in ("pin", "sign", "y", "leaving", "turns"):
            self._first[name] = getattr(first.path, name)

    def after(
        self, state: BranchState, step: float, kept: int, most: int
    ) -> tuple[list[Place], BranchState, float, int, int]:
        """At most so many places after a state; the state at the last, the next step, and why there are no more."""
        at, curve = _point_of(state), state.curve
        told = self._first, most, self._halts, self._rounding, curve.loads
        found, rates, step, kept, why = self._steps.run(at, step, kept, *told)
        if not found.size:
            return [], state, step, kept, why
        index = found["index"].tolist() if curve.family.is_dead else _indices_of(curve.family, found, rates)
        return _places(found, index), _state_of(at, curve), step, kept, why


def ordinary_steps(family: Family, bounds: Bounds, first: Place) -> OrdinarySteps | None:
    """None where the problem is not known as numbers."""
    return None if family.steps is None else OrdinarySteps(family.steps, bounds, first)


def _places(found: Array, index: list[int | None]) -> list[Place]:
    paths = zip(*(found[name].tolist() for name in ("pin", "sign", "y", "leaving", "turns")), strict=True)
    numbers = np.ascontiguousarray(found["numbers"].T)[:, :, None]
    each = enumerate(zip(found["p"].tolist(), paths, index, strict=True))
    return [Place(p, Path(*path), EndsProblem(*numbers[:, i]), known) for i, (p, path, known) in each]


def _indices_of(family: Family, found: Array, rates: Array) -> list[int | None]:
    """The Morse indices under the ends that are meant; None where an eigenvalue is zero to rounding."""
    values, rows, by_span, length = core.split(rates)
    problem = replace(EndsProblem(*found["numbers"].T), span=length)
    every = OrbitRates(problem, values, rows, by_span)
    assert family.numbers is not None
    given = [family.numbers(p) for p in found["p"].tolist()]
    ratio = np.array([np.nan if one is None else one[-1] for one in given])
    index = held_index(every, ratio, family.names, found["leaving"], found["turns"])
    return [int(one) if np.isfinite(one) else None for one in index]


def _point_of(state: BranchState) -> core.Point:
    node = state.node
    point = core.Point(sign=node.sign, bend=node.bend, ahead=state.curve.ahead, chart=core.chart_of(state.curve.chart))
    for name, values in (("w", node.w), ("jacobian", node.jacobian), ("tangent", node.tangent)):
        getattr(point, name)[: values.size] = values.ravel().tolist()
    return point


def _state_of(at: core.Point, curve: EquilibriumCurve) -> BranchState:
    """The state at a point; curve: that of another state of the branch."""
    chart, path, n = at.chart, at.chart.at, curve.scales.size
    own = Path(path.pin, path.sign, path.y, path.leaving, path.turns)
    drawn = Chart(core.KINDS[chart.kind], own, chart.scale, bool(chart.logarithmic))
    w, tangent = np.array(at.w[:n]), np.array(at.tangent[:n])
    jacobian = np.array(at.jacobian[: n * (n - 1)]).reshape(n - 1, n)
    return BranchState(replace(curve, chart=drawn, ahead=at.ahead), Node(w, jacobian, tangent, at.sign, at.bend))
