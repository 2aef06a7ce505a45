"""A point of a branch on its curve, its change to another coordinate of the level, and ordinary steps by the core."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..core import branch_calls as core
from ..core.tuning import AHEAD, LEAST, SHARE, STEEP
from ..numerics.arclength import LEFT, Node, advance, correct_point, node_at
from ..numerics.arrays import NEGLIGIBLE, Array
from ..orbits.boundary import Boundary, Path
from ..problem.dimensionless import EndsProblem
from .branch_events import Bounds, Place
from .charts import Chart, alike, charts, coordinate
from .equilibrium_curve import EquilibriumCurve, curves_through
from .family import Family
from .held_index import held_index
from .orbit_rates import OrbitRates

_PATH = ("pin", "sign", "y", "leaving", "turns")  # of a record of the core
# smallest cosine between a tangent and the direction to the neighbouring point. x10: no tangent has it, and no branch
# is followed in another chart
_PARALLEL = 0.7
# in scales, between the two points that give the direction of travel in another chart: far above the rounding of a
# solved point. x10: where the branch bends the direction is off
_NUDGE = 1e-4
# of a change of p, the shorter one that is tried. x10: one more is tried, and no answer changes; of the derivative, by
# how much the two may differ. x10: every change counts as short, and the branches of a wire stop beside its fold
_SHORTER, _LIKE = 0.01, 0.5


@dataclass(frozen=True, eq=False)
class BranchState:
    """A point of the branch on its curve."""

    curve: EquilibriumCurve
    node: Node

    @property
    def x(self) -> float:
        return float(self.node.w[0] * self.curve.scales[0])

    @property
    def p(self) -> float:
        return float(self.node.w[1] * self.curve.scales[1])

    @property
    def rises(self) -> float:
        """dp along the branch, in scales."""
        return float(self.node.tangent[1])

    def ahead(self, step: float, across: Array | None = None) -> "BranchState | str":
        """The state after a step, as of `arclength.advance`."""
        goal = NEGLIGIBLE if self.curve.family.natural else 0.0  # a point that is only passed needs no more digits
        node = advance(self.curve, self.node, step, across, goal)
        return node if isinstance(node, str) else BranchState(self.curve, node)

    @cached_property
    def at(self) -> tuple[Boundary, Path] | None:
        """The problem under dead loads and the path."""
        return self.curve.at(self.node.w)

    def record(self, kind: str = "") -> Place:
        assert self.at is not None
        boundary, path = self.at
        index = None if self.curve.family.natural else self.curve.index(self.node.w, path, self.node.jacobian)
        return Place(self.p, path, boundary.problem, index, kind)


def begin_at(family: Family, path: Path, p: float, rises: bool) -> BranchState | str:
    """The equilibrium at p, corrected there in the first coordinate that serves, to be travelled with p rising or
    falling; or why it is not in the best one."""
    reason = ""
    for curve, w in curves_through(family, path, p):
        along = np.zeros(w.size)
        along[1] = 1.0 if rises else -1.0
        state = correct_state(curve, w, along)
        if not isinstance(state, str):
            return _with_rate(state, along) if family.is_dead else state
        reason = reason or state
    return reason or LEFT


def _with_rate(state: BranchState, along: Array) -> BranchState:
    """The state, whose derivative by p is taken over so short a change of p that a far shorter one gives the same.

    Where an orbit rests next to a saddle that is about to meet a centre, a longer change leads past a fold: the
    derivative there has the other sign, and the tangent would lead back.
    """
    while state.curve.ahead > LEAST:
        curve = replace(state.curve, ahead=max(_SHORTER * state.curve.ahead, LEAST))
        node = node_at(curve, state.node.w, along)
        if isinstance(node, str):
            break
        rate, rate_nearer = state.node.jacobian[0, 1], node.jacobian[0, 1]
        if abs(rate_nearer - rate) < _LIKE * abs(rate_nearer):
            break
        state = BranchState(curve, node)
    return state


def correct_state(curve: EquilibriumCurve, w: Array, along: Array) -> BranchState | str:
    """The point of the curve next to w, travelled along a direction; p is held, or x where the curve nearly folds."""
    jacobian = curve.jacobian(w)
    if jacobian is None:
        return LEFT
    order = (1, 0) if abs(along[1]) > STEEP else (0, 1)
    reason = LEFT
    for held in order:
        corrected = correct_point(curve, w, np.eye(w.size)[held], jacobian)
        node = corrected if isinstance(corrected, str) else node_at(curve, corrected, along)
        if not isinstance(node, str):
            return BranchState(curve, node)
        reason = node
    return reason


def rechart(state: BranchState, step: float, keep: bool = False) -> BranchState:
    """A state in the coordinate that is best there, where it can be changed; keep: in its own, made anew.

    step: length of the next step.
    """
    ahead = float(np.clip(SHARE * step * abs(state.rises), LEAST, AHEAD))
    state = replace(state, curve=replace(state.curve, ahead=ahead))
    if state.at is None:
        return state
    every = charts(state.at[0].problem, state.at[1])
    if not keep and not alike(every[0], state.curve.chart):
        changed = _change(state, every[0])
        if changed is not None:
            return changed
    for chart in every:
        if alike(chart, state.curve.chart):
            return _rescale(state, chart)
    return state


def in_other_charts(state: BranchState) -> Iterator[BranchState]:
    """A state in each coordinate but its own."""
    for chart in charts(state.at[0].problem, state.at[1]) if state.at is not None else ():
        if not alike(chart, state.curve.chart):
            changed = _change(state, chart)
            if changed is not None:
                yield changed


def _rescale(state: BranchState, chart: Chart) -> BranchState:
    curve, node = replace(state.curve, chart=chart), state.node
    ratio = state.curve.scales / curve.scales
    tangent = node.tangent * ratio
    tangent /= np.linalg.norm(tangent)
    return BranchState(curve, replace(node, w=node.w * ratio, jacobian=node.jacobian / ratio, tangent=tangent))


def _change(state: BranchState, chart: Chart) -> BranchState | None:
    """A state in another chart; the direction of travel is that of two neighbouring points."""
    curve = replace(state.curve, chart=chart)
    for nudge in (_NUDGE, -_NUDGE):
        beyond = state.node.w + nudge * state.node.tangent
        at = state.curve.at(beyond)
        # past beta_t = 0 at an end the rod has another path, and the log of beta_t rises again
        if at is None or (at[1].leaving, at[1].turns) != (chart.at.leaving, chart.at.turns):
            continue
        for candidate in charts(at[0].problem, at[1]):
            if not alike(candidate, chart):
                continue
            w, w_nearby = (
                np.append(coordinate(c), (point * state.curve.scales)[1:]) / curve.scales
                for c, point in ((chart, state.node.w), (candidate, beyond))
            )
            along = (w_nearby - w) / nudge
            size = np.linalg.norm(along)
            if not 0 < size < np.inf:
                continue
            along /= size
            changed = correct_state(curve, w, along)
            if isinstance(changed, str) or changed.node.tangent @ along < _PARALLEL:
                continue
            if changed.rises * state.rises > 0:
                return changed
    return None


def steps_in_core(
    state: BranchState, step: float, kept: int, most: int, first: Place, bounds: Bounds
) -> tuple[list[Place], BranchState, float, int, int]:
    """At most so many places after a state; the state at the last, the next step, and why there are no more.

    On these steps nothing happens but that the equilibrium changes; the others are not made. first: where the branch
    begins, to tell whether it is closed.
    """
    at, curve, begin = _point_of(state), state.curve, np.zeros(1, core.RECORD)
    begin["p"] = first.p
    for name in _PATH:
        begin[name] = getattr(first.path, name)
    halts = np.array(sorted({*bounds.wanted, bounds.low, bounds.high}))
    points, rates, step, kept, why = curve.family.steps.run(
        at, step, kept, begin, most, halts, bounds.round_off, curve.loads
    )
    if not points.size:
        return [], state, step, kept, why
    if curve.family.is_dead:
        index = points["index"].tolist()
    else:
        index = _indices_of(curve.family, points, rates)
    return _places(points, index), _state_of(at, curve), step, kept, why


def _places(records: Array, index: list[int | None]) -> list[Place]:
    paths = zip(*(records[name].tolist() for name in _PATH), strict=True)
    numbers = np.ascontiguousarray(records["numbers"].T)[:, :, None]
    each = enumerate(zip(records["p"].tolist(), paths, index, strict=True))
    return [Place(p, Path(*path), EndsProblem(*numbers[:, i]), known) for i, (p, path, known) in each]


def _indices_of(family: Family, records: Array, rates: Array) -> list[int | None]:
    """The Morse indices under the ends that are meant; None where an eigenvalue is zero to rounding."""
    if family.natural:
        return [None] * len(records)
    values, rows, by_span, length = core.split(rates)
    problem = replace(EndsProblem(*records["numbers"].T), span=length)
    every = OrbitRates(problem, values, rows, by_span)
    given = [family.numbers(p) for p in records["p"].tolist()]
    ratio = np.array([np.nan if rates is None else rates[-1] for rates in given])
    index = held_index(every, ratio, family.names, records["leaving"], records["turns"])
    return [int(number) if np.isfinite(number) else None for number in index]


def _point_of(state: BranchState) -> core.Point:
    node = state.node
    point = core.Point(sign=node.sign, bend=node.bend, ahead=state.curve.ahead, chart=core.chart_of(state.curve.chart))
    for name, values in (("w", node.w), ("jacobian", node.jacobian), ("tangent", node.tangent)):
        getattr(point, name)[: values.size] = values.ravel().tolist()
    return point


def _state_of(at: core.Point, curve: EquilibriumCurve) -> BranchState:
    """The state at a point; curve: that of another state of the branch."""
    chart, path, n = at.chart, at.chart.at, curve.scales.size
    at_path = Path(path.pin, path.sign, path.y, path.leaving, path.turns)
    drawn = Chart(core.KINDS[chart.kind], at_path, chart.scale, chart.nudge, bool(chart.logarithmic))
    w, tangent = np.array(at.w[:n]), np.array(at.tangent[:n])
    jacobian = np.array(at.jacobian[: n * (n - 1)]).reshape(n - 1, n)
    return BranchState(replace(curve, chart=drawn, ahead=at.ahead), Node(w, jacobian, tangent, at.sign, at.bend))
